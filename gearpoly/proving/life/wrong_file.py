"""A file says what is not so: the geometry, another gear's sheet, a column's meaning or unit, one common set-up."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np

from gearpoly.proving.case import limit_of
from gearpoly.proving.chain import Chain, Motion, RecordedCondition, campaign_turns
from gearpoly.proving.drawn import draw, make_pair
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import RAD_PER_DEG
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.limit import DetectionLimit
from gearpoly.proving.recipes import Recipe
from gearpoly.proving.rig import Rig
from gearpoly.proving.scenes import campaign

SAYS: dict[str, tuple[str, ...]] = {
    "profile_shift": ("profile shift", "profile_shift"),
    "pressure_angle": ("pressure angle", "pressure_angle"),
    "sheet": ("sheet", "inspection", "pitch_um"),
    "columns_swapped": ("swap", "exchange", "other shaft"),
    "te_sign": ("sign",),
    "radians": ("rad",),
    "milliseconds": ("ms", "milli"),
    "remounted": ("mount", "zero"),
}
"""What is wrong, and words of which a remark or a refusal has to have one."""
ALWAYS = ("columns_swapped", "radians", "milliseconds", "remounted", "te_sign")
"""What shows in any recording: ratio, unit and order of the readings do not fit; the other kinds have a limit."""


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case."""
    v = entry.variant
    what = tuple(SAYS)[v % len(SAYS)]
    name = "15/28 m1.5 shifted" if what == "profile_shift" else "18/25 m2" if v % 16 < 8 else "17/22 m4 22.5deg"
    pair = make_pair(name)
    loaded = what in ("profile_shift", "pressure_angle", "remounted")
    conditions = campaign_turns(
        campaign("two" if loaded else "free", pair, rng, cycles=1.0), turns(entry, name, 2.2 * pair.hunting_turns)
    )
    zeros = (float(rng.uniform(0, 360)), float(rng.uniform(0, 360)))
    chain = Chain(noise_um=0.3, known=True, zeros_deg=zeros, steps_deg=(1e-5, 1e-5))
    made = plain_recipe(
        entry, name, conditions, chain, grade=7, inspected=what in ("sheet", "te_sign"), deflect=loaded, fixed=True,
        concealed_by="a file that says what is not so",
    )  # fmt: skip
    says = SAYS[what]
    file: dict[str, Any] = {"wrong": what, "says": list(says), "over_limit": None}
    sheet = draw(pair.driven, 7, -60.0, rng).p
    shown: list[float] = []

    def rig(drawn: Rig) -> Rig:
        """The honest rig; how large the wrong statement is over the limit is asked of it."""
        if what not in ALWAYS:
            shown.append(_over(what, drawn, made, sheet, np.random.default_rng([seed, entry.index, 3])))
        return drawn

    def declared(text: str) -> str:
        if what == "profile_shift":
            return re.sub(r"profile_shift = \S+", "profile_shift = 0", text)
        if what == "pressure_angle":
            return re.sub(r"pressure_angle_deg = \S+", f"pressure_angle_deg = {_wrong_angle(pair):g}", text)
        if what == "sheet":
            head, last = text.rsplit("pitch_um = [", 1)
            return head + "pitch_um = [" + ", ".join(f"{p:.2f}" for p in sheet) + last[last.index("]") :]
        return text

    def record(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
        mounted = chain
        if what == "remounted" and condition is made.conditions[-1]:  # taken out and put back some teeth on
            mounted = replace(chain, zeros_deg=((zeros[0] + 360.0 * 5 / pair.driving.z) % 360.0, zeros[1]))
        head = records.heading(condition, chain, rng)
        if what == "te_sign":
            table = records.te_table(rig, condition, mounted, path, rng)
            table["te_um"] = (-table["te_um"][0], "%.5f")
            return records.text(head, table)
        table = records.angle_table(rig, condition, mounted, path, rng)
        one, two = table["driving_angle_deg"], table["driven_angle_deg"]
        if what == "columns_swapped":
            table = table | {"driving_angle_deg": two, "driven_angle_deg": one}
        if what == "radians":
            table = table | {
                "driving_angle_deg": (one[0] * RAD_PER_DEG, "%.10f"),
                "driven_angle_deg": (two[0] * RAD_PER_DEG, "%.10f"),
            }
        if what == "milliseconds":
            table = table | {"time_s": (1000.0 * table["time_s"][0], "%.3f")}
        return records.text(head, table)

    setting = Setting(made=made, record=record, declared=declared, rig=rig, kind="wrong_file", told={"file": file})
    case = finish(seed, entry, setting, rng)
    if shown:
        file["over_limit"] = round(shown[0], 3)
    return replace(case, truth=case.truth | {"file": file})


def _wrong_angle(pair: Any) -> float:
    return 20.0 if pair.driving.alpha_deg != 20.0 else 22.5


def _over(what: str, rig: Rig, made: Recipe, sheet: Any, rng: np.random.Generator) -> float:
    """Size over the limit of what the wrong statement foretells less what is so."""
    from gearpoly.proving.chain import motion

    paths = tuple(motion(rig, condition, rng) for condition in made.conditions)
    limit: DetectionLimit = limit_of(rig, made, paths)
    if what == "sheet":
        return limit.size_of(limit.index_signal(2, sheet - rig.teeth_2.p))
    pair = rig.pair
    if what == "profile_shift":
        gears = [replace(gear, x=0.0) for gear in (pair.driving, pair.driven)]
    else:
        gears = [replace(gear, alpha_deg=_wrong_angle(pair)) for gear in (pair.driving, pair.driven)]
    return limit.over(replace(rig, pair=replace(pair, driving=gears[0], driven=gears[1])))
