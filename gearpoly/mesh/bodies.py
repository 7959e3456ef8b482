"""Toothed bodies as the contact kernel sees them: faces as points, half teeth as solids, and pairs of them under way.

Nothing here knows what a gear is. A body is a ring of teeth; each shows one *face*, a polyline from root to tip
corner with material on its clockwise side. Points are complex numbers in mm, so that a rotation is a product.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
import numpy.typing as npt
import shapely

from gearpoly.units import BoolArray, FloatArray, IntArray

ComplexArray = npt.NDArray[np.complex128]
Geometries = npt.NDArray[np.object_]

WINDOW_VERTICES = 15
"""Vertices per window. Distance queries cost the product of both windows' sizes; 15 span more than one stride of the
coarser level on either side, which is where the contact can be."""

COARSEST_VERTICES = 13
"""Vertices on a whole working face at the coarsest level."""

REFINE = 6
"""Ratio of strides from level to level: a window of 15 then covers +-1.2 strides of the level above."""

BACK_OFF = 0.01
"""rad. How far before its guess a search starts at most; costs one or two cheap coarse steps and must only exceed the
usual scatter of contacts around the guess (0.2 mm on a radius of 20 mm). Pairs that overlap there retreat further."""

BACK_OFF_SHARE = 0.03
"""The same as a share of the turning teeth's pitch, for many teeth: further back, a search would find the tooth
before."""

WIDE_SHARE = 0.25
"""Share of the pitch within which a guess must lie. A contact outside the back-off is searched for again this far
around, since teeth that the first look left out might touch before it."""

THIN_SHARE = 0.02
"""Share of the pitch below which a tip counts as pointed. It bounds the steps in which a lost contact is looked for;
half the tip of a standard tooth takes a tenth of the pitch."""

LOST_TURN = 0.5
"""rad. A pair that has turned further than this from its guess, or than three quarters of a pitch, is not going to
touch."""


def coordinates(points: ComplexArray) -> FloatArray:
    """Complex points (...) as coordinates (..., 2)."""
    return np.ascontiguousarray(points).view(np.float64).reshape(*points.shape, 2)


def complex_points(coords: FloatArray) -> ComplexArray:
    """Coordinates (..., 2) as complex points (...)."""
    return np.asarray(coords[..., 0] + 1j * coords[..., 1], dtype=np.complex128)


def lines(points: ComplexArray) -> Geometries:
    """Rows of complex points (jobs, k) as line strings (jobs,)."""
    return np.asarray(shapely.linestrings(coordinates(points)), dtype=object)


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """The faces that one body shows to the other, in the body's own frame with its axis of rotation at the origin.

    ``faces`` (z, n, 2) in mm: each from root to tip corner with material on its clockwise side. ``backs`` (z, k, 2):
    the points that close each face to a solid half tooth, on from the tip corner; of more than two the last two are at
    the hub, those before on the tip. ``working``: index of the first
    vertex that contact usually uses; windows look there first, certificates look everywhere.
    """

    faces: FloatArray
    backs: FloatArray
    working: int = 0

    @cached_property
    def points(self) -> ComplexArray:
        """Faces as complex numbers (z, n)."""
        return np.ascontiguousarray(self.faces[..., 0] + 1j * self.faces[..., 1])

    @cached_property
    def reach(self) -> float:
        """Largest distance in mm of any face from the axis."""
        return float(np.max(self.reaches))

    @cached_property
    def reaches(self) -> FloatArray:
        """The same (z,) of each face."""
        return np.asarray(np.max(np.abs(self.points), axis=1))

    @cached_property
    def solids(self) -> Geometries:
        """Half teeth as prepared polygons (z,)."""
        solids = np.asarray(shapely.polygons(np.concatenate((self.faces, self.backs), axis=1)), dtype=object)
        shapely.prepare(solids)
        return solids

    @cached_property
    def hulls(self) -> FloatArray:
        """Rectangles (z, 4, 2) that hold each face, turned along its chord, so that they stay narrow wherever they
        stand."""
        return self._rectangles(self.points)

    @cached_property
    def solid_hulls(self) -> FloatArray:
        """The same of half teeth: what has gone in deep is out of its face's rectangle."""
        return self._rectangles(np.concatenate((self.points, complex_points(self.backs)), axis=1))

    def _rectangles(self, points: ComplexArray) -> FloatArray:
        chord = self.points[:, -1] - self.points[:, 0]
        unit = (chord / np.abs(chord))[:, None]
        local = points * unit.conj()
        low = local.real.min(axis=1) + 1j * local.imag.min(axis=1)
        high = local.real.max(axis=1) + 1j * local.imag.max(axis=1)
        corners = np.stack((low, high.real + 1j * low.imag, high, low.real + 1j * high.imag), axis=1)
        return coordinates(corners * unit)

    @cached_property
    def pitch(self) -> float:
        """The least angle in rad about the axis between the tip corners of two teeth; a whole turn for a single
        tooth."""
        angle = np.sort(np.angle(self.points[:, -1]))
        return float(np.min(np.diff(angle, append=angle[0] + 2.0 * np.pi)))

    @cached_property
    def tip(self) -> float:
        """The least angle in rad about the axis that half a tip takes, but no less than a share of the pitch."""
        over = complex_points(self.backs[:, : max(1, self.backs.shape[1] - 2)])
        half = np.max(np.abs(np.angle(self.points[:, -1:] * over.conj())), axis=1)
        return max(float(np.min(half)), THIN_SHARE * self.pitch)

    @cached_property
    def strides(self) -> list[int]:
        """Strides between the vertices of windows, coarse to fine, ending at every vertex."""
        stride = (self.faces.shape[1] - 1 - self.working) // (COARSEST_VERTICES - 1)
        out = []
        while stride > 1:
            stride = -(-stride // REFINE)
            out.append(stride)
        return out or [1]

    def sagitta(self, stride: int) -> float:
        """The most that a face stands off its chords over ``stride`` edges, measured at each chord's middle vertex,
        mm."""
        if stride < 2:
            return 0.0
        points = self.points[:, self.working :]
        chord = points[:, stride:] - points[:, :-stride]
        middle = points[:, stride // 2 : stride // 2 + chord.shape[1]] - points[:, :-stride]
        return float(np.max(np.abs((middle * chord.conj()).imag / np.abs(chord)), initial=0.0))

    @cached_property
    def lever(self) -> float:
        """A lower bound of the lever arm of contact normals about the axis in mm: half the least distance of the
        working faces."""
        return 0.5 * float(np.min(np.abs(self.points[:, self.working :])))

    @cached_property
    def tangents(self) -> ComplexArray:
        """Unit tangents (z, n) of the smooth face at its vertices, root to tip; second order inside, extrapolated at
        the ends."""
        edge = np.diff(self.points, axis=1)
        length = np.abs(edge)
        unit = edge / length
        # The circle through three points has this tangent at the middle one.
        share = length[:, :-1] / (length[:, :-1] + length[:, 1:])
        inner = unit[:, :-1] * (1.0 - share) + unit[:, 1:] * share
        first, last = (
            1.5 * unit[:, :1] - 0.5 * unit[:, 1:2],
            1.5 * unit[:, -1:] - 0.5 * unit[:, -2:-1],
        )
        tangents = np.concatenate((first, inner, last), axis=1)
        return np.asarray(tangents / np.abs(tangents))


@dataclass(frozen=True, kw_only=True, eq=False)
class Meeting:
    """Two bodies that face each other: ``turning`` about the origin, ``fixed`` about (``a``, 0) in mm."""

    turning: Body
    fixed: Body
    a: float

    @cached_property
    def levels(self) -> tuple[tuple[int, int, float], ...]:
        """Strides of both bodies' windows, coarse to fine, and how much earlier (rad) finer faces can touch than such
        windows do."""
        pair = self.turning.strides, self.fixed.strides
        count = max(map(len, pair))
        strides = [tuple(s[max(0, level - count + len(s))] for s in pair) for level in range(count)]
        return tuple((s, t, self.stand_off(s, t)) for s, t in strides)

    @cached_property
    def grids(self) -> tuple[IntArray, IntArray]:
        """Vertices of both working faces thinned to COARSE."""
        mine, mates = (
            np.rint(np.linspace(body.working, body.faces.shape[1] - 1, COARSEST_VERTICES)).astype(np.int64)
            for body in (self.turning, self.fixed)
        )
        return mine, mates

    @cached_property
    def coarse_stand_off(self) -> float:
        """``stand_off`` of the thinned working faces."""
        mine, mates = (int(np.max(np.diff(grid))) for grid in self.grids)
        return self.stand_off(mine, mates)

    @property
    def back_off(self) -> float:
        """How far before its guess a search starts, rad."""
        return min(BACK_OFF, BACK_OFF_SHARE * self.turning.pitch)

    @property
    def wide(self) -> float:
        """How far from its guess a contact may lie, rad."""
        return min(WIDE_SHARE * self.turning.pitch, LOST_TURN)

    @property
    def lost(self) -> float:
        """Beyond this rotation from the guess a pair does not touch any more, rad."""
        return min(LOST_TURN, 0.75 * self.turning.pitch)

    def stand_off(self, stride_turning: int, stride_fixed: int) -> float:
        """Both sagittas of chords over so many edges, as a rotation in rad."""
        sagitta = self.turning.sagitta(stride_turning) + self.fixed.sagitta(stride_fixed)
        return sagitta / (2.0 * self.turning.lever)


@dataclass
class Jobs:
    """Pairs of teeth under way, one row each: where the search for their touch stands."""

    pose: IntArray
    turning: IntArray
    fixed: IntArray
    turn: ComplexArray  # pose of the fixed body, as exp(i angle)
    back: ComplexArray  # guess of the turning body, as exp(-i angle)
    rotation: FloatArray  # beyond the guess, rad
    at_turning: IntArray  # vertex nearest to the contact
    at_fixed: IntArray

    def take(self, rows: IntArray | BoolArray) -> Jobs:
        """The jobs of ``rows``, copied."""
        return Jobs(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    def joined(self, others: Jobs) -> Jobs:
        """These jobs and ``others``."""
        return Jobs(**{f.name: np.concatenate((getattr(self, f.name), getattr(others, f.name))) for f in fields(self)})

    def __len__(self) -> int:
        return int(self.pose.size)

    def seen(self, m: Meeting, points: ComplexArray, rotation: FloatArray) -> ComplexArray:
        """Points (jobs, k) of the fixed body's frame in the frame of the turning body at ``rotation`` (jobs,) beyond
        the guess."""
        frame = self.back * np.exp(-1j * rotation)
        return np.asarray(points * (self.turn * frame)[:, None] + (m.a * frame)[:, None])

    def windows(self, m: Meeting, strides: tuple[int, int] = (1, 1)) -> tuple[IntArray, IntArray]:
        """Vertex numbers (jobs, k) of both faces around the contact."""
        return window(m.turning, self.at_turning, strides[0]), window(m.fixed, self.at_fixed, strides[1])


def window(body: Body, centre: IntArray, stride: int) -> IntArray:
    """Vertex numbers (jobs, k) around ``centre``, shifted where needed so that the tip corner stays in.

    Thinned windows keep to the working face: chords across a concave fillet stand outside the material and touch too
    early.
    """
    last = body.faces.shape[1] - 1
    lowest = body.working if stride > 1 else 0
    size = min(WINDOW_VERTICES, 1 + (last - lowest) // stride)
    start = np.clip(centre - stride * (size // 2), lowest, last - stride * (size - 1))
    return np.asarray(start[:, None] + stride * np.arange(size))
