"""What every question of the study shares: the research pair, its error gears, its contacts, and what an answer is.

Table 1 of the paper is lost. Taken in its place: m = 2 mm, b = 20 mm, steel; tooth thickness by ``allowances``; tooth
numbers 18/25 follow from the contact ratio. Set k of a grade is seed k.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gearpoly.errors import JammedError
from gearpoly.gear.deviations import Deviations, Relief, tip_relief
from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import Flanks, draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import form_point
from gearpoly.gear.tolerances import limits_for, tolerances
from gearpoly.mesh.deflection import Elasticity, pair_compliance
from gearpoly.mesh.loaded import LoadedContacts, Sharing, load_reach, loaded
from gearpoly.mesh.pair import Flank, GearPair, active_start, mount, tight_centre_distance
from gearpoly.mesh.transmission import JAM, NEAR_PAIR_MM, FlankContacts, contacts
from gearpoly.studies.paper.allowances import handbook_thickness
from gearpoly.studies.paper.picture import PaperPicture
from gearpoly.units import ARCMIN, DEG, NM, UM, FloatArray, read_only

Verdict = Literal["agrees", "same trend", "does not"]

PAPER_POSITIONS = read_only(np.arange(361) * DEG)
"""rad. The paper's driven angles: 0 to 360 deg in 1 deg steps, both ends; all its counts are whole numbers over 361."""

PAPER_GRADES = (4, 5, 6)
LOADS = (0.0, 5.0, 15.0, 25.0)
"""N.m on the driven shaft."""

PAPER_ELASTICITY = Elasticity(law="cantilever_published", contact="palmgren")
"""Eqs. 8-14 as the paper prints them; steel."""


@dataclass(frozen=True, kw_only=True)
class PaperRow:
    """One line of the table: what is compared, the paper's number, gearpoly's, the verdict and why."""

    what: str
    paper: str
    gearpoly: str
    verdict: Verdict
    why: str


@dataclass(frozen=True, kw_only=True)
class PaperAnswer:
    """The answer to one question: rows of the table, pictures, text in paragraphs, and the ``values`` behind them."""

    rows: tuple[PaperRow, ...]
    pictures: tuple[PaperPicture, ...]
    text: tuple[str, ...]
    values: Mapping[str, npt.ArrayLike]

    def value(self, name: str) -> FloatArray:
        """One of the ``values`` as an array."""
        return np.asarray(self.values[name], dtype=np.float64)


@dataclass(frozen=True, kw_only=True)
class PaperStudy:
    """How much is run: ``sets`` of gears of each grade, ``points`` per flank, ``refine`` divides the finer sweeps."""

    sets: int = 20
    points: int = 2000
    refine: int = 1

    @staticmethod
    def quick() -> PaperStudy:
        """A few small sets, for tests: enough for every trend, not for the statistics."""
        return PaperStudy(sets=3, points=500, refine=4)


@dataclass(frozen=True, kw_only=True)
class Question:
    """One thing that the paper asks: ``order`` in the page, short ``name``, ``title``, and how to ``ask`` it."""

    order: int
    name: str
    title: str
    ask: Callable[[PaperStudy], PaperAnswer]


@dataclass(frozen=True, kw_only=True)
class PairRecipe:
    """How a pair of error gears is drawn (the paper's Eqs. 1-7).

    ``profile``: "scatter" sets every point off on its own (the paper's), "smooth" draws waves, "none" leaves it out.
    ``thickness``: "between" draws each tooth's E_s between E_sns and E_sni, "lower" draws Rand(1) E_sni, as the
    paper can be read too; "none" leaves it out. ``stated`` limits in mm go before the grade's. ``relief``: amount and
    length in mm and shape, on both gears. ``a_error`` in mm beyond tight mesh.
    """

    z: tuple[int, int] = (18, 25)
    m: float = 2.0
    b: float = 20.0
    grade: int = 4
    edition: int = 1995
    pitch: bool = True
    profile: Literal["scatter", "smooth", "none"] = "scatter"
    thickness: Literal["between", "lower", "none"] = "between"
    stated: Mapping[str, float] = field(default_factory=dict)
    relief: tuple[float, float, str] | None = None
    a_error: float = 0.0
    points: int = 2000

    def with_(self, **changes: Any) -> PairRecipe:
        """This recipe with some fields changed."""
        return replace(self, **changes)

    @property
    def gears(self) -> tuple[Gear, Gear]:
        """The deviation-free gears."""
        driving, driven = (Gear(z=z, m=self.m, b=self.b) for z in self.z)
        return driving, driven


def limits_of(recipe: PairRecipe, gear: Gear) -> dict[str, float]:
    """The stated limits (mm) of one gear of ``recipe``: thickness by the handbook rule, and nought for what is left
    out."""
    a = tight_centre_distance(*recipe.gears)
    E_sns, E_sni = handbook_thickness(gear, a=a, grade=recipe.grade, edition=recipe.edition)
    limits = {"E_sns": E_sns, "E_sni": E_sni}
    if recipe.thickness == "lower":
        limits["E_sns"] = 0.0
    limits |= recipe.stated
    if recipe.thickness == "none":
        limits |= {"E_sns": 0.0, "E_sni": 0.0}
    if not recipe.pitch:
        limits |= {"f_pt": 0.0, "F_p": 0.0}
    if recipe.profile == "none":
        limits |= {"F_alpha": 0.0}
    return limits


def flanks_of(recipe: PairRecipe, *, seed: int | None) -> tuple[Flanks, Flanks]:
    """Both drawn gears of ``recipe`` from one ``seed``; None: without any deviation but the relief."""
    gears = recipe.gears
    out = []
    for k, name in enumerate(("driving", "driven")):
        gear = gears[k]
        l_start = active_start(gear, gears[1 - k], l_form=form_point(gear)[1])
        shapes = Deviations()
        if seed is not None:
            grade = tolerances(d=2.0 * gear.r, m=gear.m, b=gear.b, grade=recipe.grade, edition=recipe.edition)
            shapes = draw_deviations(
                gear,
                limits_for(gear, grade=grade, stated=limits_of(recipe, gear)),
                rng=streams(seed)[k],
                which="driving" if name == "driving" else "driven",
                profile_errors="smooth" if recipe.profile == "smooth" else "scatter",
                thickness_errors="independent",
                roll_lengths=np.linspace(l_start, gear.l_a, recipe.points),
            ).deviations
        if recipe.relief is not None:
            amount, length, shape = recipe.relief
            relief: tuple[Relief, ...] = (tip_relief(gear, amount=amount, length=length, shape=shape),)
            shapes = shapes + Deviations(drive=relief, coast=relief)
        out.append(draw_flanks(gear, shapes, l_start=l_start, points=recipe.points))
    return out[0], out[1]


def make_pair(recipe: PairRecipe, *, seed: int | None) -> GearPair:
    """The pair of ``recipe`` on its axes; ``seed`` None: ideal gears."""
    a = tight_centre_distance(*recipe.gears) + recipe.a_error
    return mount(*flanks_of(recipe, seed=seed), a=a)


def touch(pair: GearPair, theta_2: FloatArray, *, flank: Flank = "drive", near: float = NEAR_PAIR_MM) -> FlankContacts:
    """Contacts of the study: the one place that chooses the kernel."""
    return contacts(pair, theta_2, flank=flank, near=near, fast=True)


def backlash(pair: GearPair, theta_2: FloatArray) -> tuple[FlankContacts, FloatArray]:
    """Contacts of the drive flank and normal backlash j_bn (N,) in mm. Raises ``JammedError`` where there is none."""
    drive, coast = touch(pair, theta_2), touch(pair, theta_2, flank="coast")
    j_bn = (coast.te - drive.te) * pair.r_b2
    if float(np.min(j_bn)) < -JAM:
        raise JammedError(f"the gears of this draw jam by {-float(np.min(j_bn)) / UM:.2f} um")
    return drive, j_bn


def along_line_of_action(pair: GearPair, found: FlankContacts) -> FlankContacts:
    """Drive contacts ``found`` with forces along the line of action, (sin alpha_w, cos alpha_w).

    A scattered flank's own normals lean by up to 45 deg at 2000 points and would give lever arms from half of r_b to
    1.2 of it; no force acts so on a flank whose roughness gives way first. Smooth flanks lean by 1e-3.
    """
    normal = np.broadcast_to([math.sin(pair.alpha_w), math.cos(pair.alpha_w)], found.normal.shape)
    return replace(found, normal=normal)


def under_load(
    pair: GearPair, theta_2: FloatArray, torques: tuple[float, ...], *, sharing: Sharing = "paper"
) -> list[LoadedContacts]:
    """The pair at ``torques`` in N.m on the driven shaft, the contacts found once for all of them."""
    bends = pair_compliance(pair, PAPER_ELASTICITY)
    found = along_line_of_action(pair, touch(pair, theta_2, near=NEAR_PAIR_MM + load_reach(bends, max(torques) * NM)))
    return [loaded(found, bends, torque=torque * NM, sharing=sharing) for torque in torques]


def peak_to_peak(te: FloatArray) -> float:
    """TEpp in minutes of arc of ``te`` (N,) in rad."""
    return float(np.ptp(te)) / ARCMIN


def roughness(te: FloatArray, r_b2: float) -> FloatArray:
    """Second differences (N - 2,) in um along the line of action of ``te`` (N,) in rad.

    They say how sharply the curve bends from one position to the next. Waves of 360 deg leave 3e-4 of themselves
    in it, steps all.
    """
    bend: FloatArray = np.diff(te, 2) * r_b2 / UM
    return bend


def rms(values: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def per_cent(new: float, old: float) -> float:
    """By how many per cent ``new`` is above ``old``."""
    return 100.0 * (new / old - 1.0)


def verdict(agrees: bool, trend: bool) -> Verdict:
    """Agrees if it does, else same trend if that holds, else does not."""
    return "agrees" if agrees else "same trend" if trend else "does not"
