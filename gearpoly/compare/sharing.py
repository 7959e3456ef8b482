"""Which pairs of teeth carry at each position, and what a small deviation of any tooth does to the transmission error.

Unloaded, the pair that touches first sets the error: x = max over pairs of h_i = e_i - gap_i, with e_i what both teeth
have more of material than was simulated. Loaded, the pairs give until they carry: sum of k_i (h_i - x) over those with
h_i > x equals the force, and each touching pair has a say in the measure of its stiffness (derived here; linear
contact).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from gearpoly.units import FloatArray, IntArray

Flank = Literal["drive", "coast"]

ABSENT_PAIR_GAP_MM = 1e3
"""Gap in mm of a pair that is not there: larger than any tooth, so that it never touches."""

LEAST_APPROACH = 1e-6
"""mm. Least deflection that a stiffness is made of: a nanometre, less than any tooth under any load that is felt."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sharing:
    """The pairs near contact on an even grid over one hunting cycle, first place at u = 0 (u counts meshes).

    ``mesh`` (P, G) numbers of the pairs: mesh n is driving tooth n mod z_1. ``gap`` (P, G) in mm beyond the first
    touch.
    ``share`` (P, G), the part of each pair's deviation that reaches the transmission error under load; ``None``:
    unloaded. ``approach`` (G,) in mm by which the load takes the transmission error back. ``contact`` where in u - n a
    pair's contact begins and ends on the true path.
    """

    z_1: int
    z_2: int
    mesh: IntArray
    gap: FloatArray
    share: FloatArray | None
    contact: tuple[float, float]
    approach: FloatArray | None = None

    @cached_property
    def stiffness(self) -> FloatArray | None:
        """Stiffness (P, G) of each pair over the force, in 1/mm; a pair that does not touch is taken to be as stiff as
        those that do.

        With x the place and w the shares, sum k_i (-gap_i - x) = 1 and k_i = w_i sum k give sum k = 1 / (approach -
        sum w_i gap_i) (derived here).
        """
        if self.share is None or self.approach is None:
            return None
        pressed = self.approach - np.sum(np.where(self.share > 0.0, self.share * self.gap, 0.0), axis=0)
        k = self.share / np.maximum(pressed, LEAST_APPROACH)
        mean = np.sum(k, axis=0) / np.maximum(np.count_nonzero(k, axis=0), 1)
        return np.asarray(np.where(k > 0.0, k, mean))

    @cached_property
    def opening(self) -> FloatArray:
        """Slope (P, G) of each gap in mm per pitch, 0 where the slot's pair comes or goes."""
        lasting = self.mesh == np.roll(self.mesh, 1, axis=1)
        step = np.lcm(self.z_1, self.z_2) / self.mesh.shape[1]
        rise = (self.gap - np.roll(self.gap, 1, axis=1)) / step
        near = (self.gap < ABSENT_PAIR_GAP_MM) & (np.roll(self.gap, 1, axis=1) < ABSENT_PAIR_GAP_MM)
        return np.where(lasting & near, rise, 0.0)

    def at(self, u: FloatArray) -> Carried:
        """The pairs at positions ``u`` (n,) in meshes, by straight lines between the places of the grid: gaps open by
        microns from one to the next."""
        size = self.mesh.shape[1]
        period = float(np.lcm(self.z_1, self.z_2))
        turn = np.floor(u / period)
        place = (u - turn * period) * (size / period)
        low = np.minimum(place.astype(np.int64), size - 1)
        part = place - low
        high = low + 1
        over = high == size
        high = np.where(over, 0, high)
        near = np.where(part < 0.5, low, high)
        mesh = self.mesh[:, near] + ((turn + (over & (part >= 0.5))) * period).astype(np.int64)
        # A slot that changes hands between two places holds a pair too far from touching to matter.
        same = self.mesh[:, low] == self.mesh[:, high] + np.where(over, int(period), 0)
        part = np.where(same, part, part >= 0.5)

        def between(values: FloatArray) -> FloatArray:
            first = values[:, low]
            return np.asarray(first + part * (values[:, high] - first))

        return Carried(
            z_1=self.z_1,
            z_2=self.z_2,
            mesh=mesh,
            phase=u - mesh,
            gap=between(self.gap),
            share=None if self.share is None else between(self.share),
            stiffness=None if self.stiffness is None else between(self.stiffness),
            contact=self.contact,
            opening=between(self.opening),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Carried:
    """The pairs at each sample: ``mesh``, ``phase`` (u - n), ``gap``, ``share``, ``stiffness``, ``opening`` (P, n) as
    in ``Sharing``."""

    z_1: int
    z_2: int
    mesh: IntArray
    phase: FloatArray
    gap: FloatArray
    share: FloatArray | None
    contact: tuple[float, float]
    stiffness: FloatArray | None = None
    opening: FloatArray | None = None
    known: dict[str, np.ndarray[tuple[int, ...], np.dtype[Any]]] = field(default_factory=dict, repr=False)

    def weights(self, deviation: FloatArray) -> FloatArray:
        """Share (P, n) of each pair in the transmission error, where the pairs deviate by ``deviation`` (P, n) in
        mm."""
        height = deviation - self.gap
        if self.stiffness is not None:
            pressed = np.where(height > _balanced(height, self.stiffness), self.stiffness, 0.0)
            return np.asarray(pressed / np.sum(pressed, axis=0))
        if self.share is not None:
            return self.share
        first = np.argmax(height, axis=0)
        return np.asarray(np.arange(self.mesh.shape[0])[:, None] == first, dtype=np.float64)

    def ends(self) -> tuple[FloatArray, FloatArray]:
        """What a shift of the path's begin and of its end by one pitch does to each pair's height (P, n), in mm: beyond
        the path a tip's corner touches, whose gap opens steeply."""
        opening = np.zeros_like(self.phase) if self.opening is None else self.opening
        low, high = self.contact
        return np.where(self.phase < low, opening, 0.0), np.where(self.phase > high, opening, 0.0)

    def change(self, deviation: FloatArray) -> FloatArray:
        """Change (n,) in mm of the transmission error by deviations (P, n) of the pairs."""
        if self.stiffness is not None:
            if "declared" not in self.known:
                self.known["declared"] = _balanced(-self.gap, self.stiffness)
            return np.asarray(_balanced(deviation - self.gap, self.stiffness) - self.known["declared"])
        if self.share is not None:
            return np.asarray(np.sum(self.share * deviation, axis=0))
        return np.asarray(np.max(deviation - self.gap, axis=0) - np.max(-self.gap, axis=0))


def _balanced(height: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Place x (n,) in mm at which pairs of ``height`` (P, n), pressed by ``stiffness`` (P, n) in 1/mm, carry force 1.

    Where all pairs were held they would pull as well as press; let go of those that pull, and x moves forward until no
    more do: each step is one of Newton's, from below, on the force, which bends one way only.
    """
    pressed = stiffness
    for _ in range(len(height)):
        x = (np.sum(pressed * height, axis=0) - 1.0) / np.sum(pressed, axis=0)
        held = np.where(height > x, stiffness, 0.0)
        if np.array_equal(held, pressed):
            break
        pressed = held
    return np.asarray(x)


def nominal_carried(
    u: FloatArray, *, z_1: int, z_2: int, contact: tuple[float, float] = (-0.8, 0.8), flank: Flank = "drive"
) -> Carried:
    """What is known of the pairs without any simulation: each carries from ``contact[0]`` to ``contact[1]`` about its
    pitch point, and where two do, each counts half.

    On the coast flank driving tooth n meets driven tooth n + 1, half a pitch later, to the half backlash.
    """
    late = 0.0 if flank == "drive" else 0.5
    first = np.floor(u - late).astype(np.int64)
    mesh = np.stack([first - 1, first, first + 1, first + 2])
    phase = u - late - mesh
    inside = ((phase >= contact[0]) & (phase <= contact[1])).astype(np.float64)
    share = inside / np.maximum(np.sum(inside, axis=0), 1.0)
    return Carried(z_1=z_1, z_2=z_2, mesh=mesh, phase=phase, gap=np.zeros_like(phase), share=share, contact=contact)


def sharing_from_rows(
    *,
    z_1: int,
    z_2: int,
    theta_2: FloatArray,
    position: IntArray,
    driving: IntArray,
    gap: FloatArray,
    share: FloatArray | None = None,
    contact: tuple[float, float],
    flank: Flank = "drive",
    approach: FloatArray | None = None,
) -> Sharing:
    """Sharing from a simulation's contact rows: ``theta_2`` (G,) in rad, even over one hunting cycle from 0; per row
    (k,) the ``position`` (rising), the ``driving`` tooth, its ``gap`` in mm without load and, under load, its
    ``share``; ``approach`` (G,) in mm as in ``Sharing``.
    """
    u = theta_2 * (z_2 / (2.0 * np.pi))
    late = 0.0 if flank == "drive" else 0.5
    # The tooth's number recurs every z_1 meshes; the contact is the one next to its pitch point.
    mesh_of_row = driving + z_1 * np.rint((u[position] - late - driving) / z_1).astype(np.int64)
    first = np.full(theta_2.size, np.iinfo(np.int64).max)
    np.minimum.at(first, position, mesh_of_row)
    width = int(np.max(mesh_of_row - first[position])) + 1
    # A pair keeps its slot for as long as it is near; an empty one belongs to the pair that is next to come or go.
    slot = np.mod(mesh_of_row, width)
    slots = np.arange(width)[:, None]
    mesh = slots + width * np.rint((u - late - slots) / width).astype(np.int64)
    mesh[slot, position] = mesh_of_row
    gaps = np.full((width, theta_2.size), ABSENT_PAIR_GAP_MM)
    gaps[slot, position] = gap
    shares = None
    if share is not None:
        shares = np.zeros((width, theta_2.size))
        shares[slot, position] = share
    return Sharing(z_1=z_1, z_2=z_2, mesh=mesh, gap=gaps, share=shares, contact=contact, approach=approach)
