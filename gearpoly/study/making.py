"""Many pairs of one combination: what does not change from draw to draw is made once, the rest compiled.

``assemble`` remains what says how a file becomes a pair. This makes the same pair (to rounding of an angle) in a fifth
of the time where nothing but a draw sets it apart, which is what most of a study is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.assemble import Assembled, assemble, brought_parts, brought_shapes, stated_limits
from gearpoly.errors import GeometryError, NotConvergedError, blamed
from gearpoly.files.models import GearSection, PairFile
from gearpoly.gear.deviations import FormDeviation, Index, Relief, Shape, Slope
from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import SPACING, Flanks, draw_flanks, root_angles
from gearpoly.gear.tolerances import Limits
from gearpoly.mesh.pair import mount
from gearpoly.units import FloatArray, read_only


@dataclass(frozen=True, kw_only=True, eq=False)
class _Blank:
    """One gear before it is drawn: its file section, its deviation-free flanks, and the limits that a draw keeps (None:
    nothing is drawn)."""

    section: GearSection
    flanks: Flanks
    limits: Limits | None

    @property
    def points(self) -> int:
        return int(self.flanks.r.size) - self.flanks.root.n + 1


@dataclass(frozen=True, kw_only=True, eq=False)
class Maker:
    """Pairs of one pair ``file``, by seed."""

    file: PairFile
    path: Path
    bare: Assembled
    blanks: tuple[_Blank, _Blank]

    def make(self, seed: int) -> Assembled:
        """The pair of this seed; raises as ``assemble`` does."""
        flanks = []
        for k, blank in enumerate(self.blanks):
            name = GEARS[k]
            with blamed(self.path, name):
                flanks.append(blank.flanks if blank.limits is None else _drawn(blank, blank.limits, seed, k, name))
        off = brought_parts(self.file).eccentricity
        with blamed(self.path, "pair"):
            pair = mount(
                flanks[0], flanks[1], a=self.file.pair.centre_distance_mm,
                eccentricity_1=off[0], eccentricity_2=off[1],
            )  # fmt: skip
        return replace(self.bare, pair=pair)


def maker(file: PairFile, path: Path) -> Maker:
    """A maker of the pairs of ``file``, read from ``path``. Raises as ``assemble`` does for what no draw can mend."""
    gears = {
        name: section.model_copy(update={"grade": None, "limits": None})
        for name, section in (("driving", file.driving), ("driven", file.driven))
    }
    bare = assemble(file.model_copy(update=gears), path=path, seed=0)
    blanks = []
    for name, section, mounted in zip(
        GEARS, (file.driving, file.driven), (bare.pair.driving, bare.pair.driven), strict=True
    ):
        drawn = section.inspection is None and (section.grade is not None or section.limits is not None)
        with blamed(path, name):
            limits = stated_limits(section, mounted.gear, a=bare.pair.a_w) if drawn else None
        blanks.append(_Blank(section=section, flanks=mounted.flanks, limits=limits))
    return Maker(file=file, path=path, bare=bare, blanks=(blanks[0], blanks[1]))


def _drawn(blank: _Blank, limits: Limits, seed: int, k: int, which: Literal["driving", "driven"]) -> Flanks:
    section, flanks = blank.section, blank.flanks
    gear, span = flanks.gear, flanks.span
    shapes = draw_deviations(
        gear,
        limits,
        rng=streams(seed)[k],
        which=which,
        profile_errors=section.profile_errors,
        thickness_errors=section.thickness_errors,
        roll_lengths=np.linspace(span.l_start, gear.l_a, blank.points),
    ).deviations
    shapes = shapes + brought_shapes(section, gear, k)
    sides = [_side(side) for side in (shapes.drive, shapes.coast)]
    if sides[0] is None or sides[1] is None or shapes.chips:
        return draw_flanks(gear, shapes, l_start=span.l_start, points=blank.points)
    root = flanks.root
    L = np.linspace(root.l_form**SPACING, gear.l_a**SPACING, blank.points) ** (1.0 / SPACING)
    L[0], L[-1] = root.l_form, gear.l_a
    psi = [_angles(flanks, side, L) for side in sides if side is not None]
    if float(np.min(psi[0] + psi[1])) <= 0.0:
        raise GeometryError(
            "the deviations leave nothing of a tooth: both flanks cross; check their size and unit (um)"
        )
    return replace(flanks, psi_drive=read_only(psi[0]), psi_coast=read_only(psi[1]))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Side:
    """The deviations of one side as numbers: (z,) index and slope, (z, K) form, and relief: amount, start, power."""

    p: FloatArray
    s: FloatArray
    a: FloatArray
    relief: tuple[float, float, float]


def _side(shapes: tuple[Shape, ...]) -> _Side | None:
    """``shapes`` as numbers, None where one of them has none here or comes twice."""
    one: dict[type[object], Shape] = {type(shape): shape for shape in shapes}
    if len(one) != len(shapes) or not set(one) <= {Index, Slope, FormDeviation, Relief} or Index not in one:
        return None
    index, slope, form, relief = one[Index], one.get(Slope), one.get(FormDeviation), one.get(Relief)
    assert isinstance(index, Index)
    z = index.p.size
    return _Side(
        p=index.p,
        s=slope.s if isinstance(slope, Slope) else np.zeros(z),
        a=form.a if isinstance(form, FormDeviation) else np.zeros((z, 0)),
        relief=(relief.amount, relief.l_relief, float(relief.power)) if isinstance(relief, Relief) else (0.0, 0.0, 1.0),
    )


def _angles(flanks: Flanks, side: _Side, L: FloatArray) -> FloatArray:
    """Angles (z, n) of one side at all radii, its root turned with it so that both meet."""
    from gearpoly.study.compiled import roll_lengths

    gear, root = flanks.gear, flanks.root
    l, done = roll_lengths(
        L, np.ascontiguousarray(side.p), np.ascontiguousarray(side.s), np.ascontiguousarray(side.a), *side.relief,
        flanks.span.l_start, flanks.span.l_a,
    )  # fmt: skip
    if not done:
        raise NotConvergedError(
            "a profile deviation is so steep that the flank folds over; check its size (um) against its length (mm)"
        )
    involute = gear.psi_b - l / gear.r_b + np.arctan(L / gear.r_b)
    return np.concatenate((root_angles(root, involute[:, :1]), involute[:, 1:]), axis=1)
