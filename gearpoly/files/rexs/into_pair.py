"""A stage of a REXS design as a pair file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import cast

from pydantic import ValidationError

from gearpoly.errors import InputFileError, shown
from gearpoly.files.faults import explain
from gearpoly.files.gde import Side
from gearpoly.files.inspection.measured import Which
from gearpoly.files.models import PairFile
from gearpoly.files.output import write_text
from gearpoly.files.pairfile import dump_pair
from gearpoly.files.paths import look
from gearpoly.files.rexs.gear import GearOfDesign, why_not
from gearpoly.files.rexs.model import Component, RexsModel, called
from gearpoly.files.rexs.source import read_model
from gearpoly.keys.kinds import NAME_SHOWN

STAGE_DATA = ("cylindrical_stage_gear_data", "stage_gear_data")
"""What a stage says of one of its gears: the name of today, and that of old versions."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A cylindrical stage with its two gears."""

    stage: Component
    gears: tuple[Component, Component]

    def words(self, model: RexsModel) -> str:
        """The stage in a list to choose from."""
        teeth = " / ".join(
            str(g.attributes["number_of_teeth"].value) if "number_of_teeth" in g.attributes else "?" for g in self.gears
        )
        why = "; ".join(dict.fromkeys(filter(None, (why_not(model, gear) for gear in self.gears))))
        return f"{self.stage.id} ({shown(teeth)} teeth{', ' + why if why else ''})"


def write_design(source: Path, target: Path, *, stage: int | None, first: Which | None) -> list[str]:
    """Write the pair file of one stage of the REXS file ``source``; gives what was taken for what, or left out.

    ``stage`` is the id of the stage, ``first`` what its gear_1 is, where the file does not say. Raises
    ``InputFileError`` asking for them, and for gears that are not spur.
    """
    if look(target) is not None:
        wish = "want a new name, since what was filled in would be lost"
        raise InputFileError(target, found="this file exists", wish=wish)
    model = read_model(source)
    chosen = _chosen(model, stage)
    for gear in chosen.gears:
        why = why_not(model, gear)
        if why:
            others = [one.words(model) for one in stages(model) if not any(why_not(model, g) for g in one.gears)]
            wish = "want external spur gears, which are all that gearpoly simulates" + (
                f"; --stage may name {', '.join(others[:8])}" if others else ""
            )
            raise InputFileError(source, where=f"stage {chosen.stage.id}, {called(gear)}", found=why, wish=wish)
    raw, says = _pair(model, chosen, first)
    try:
        pair = PairFile.model_validate(raw)
    except ValidationError as error:
        raise explain(source, raw, error) from None
    head = [
        f"# A pair file of gearpoly, from {shown(source.name)}, stage {chosen.stage.id}. "
        "All keys: docs/reference/pair_file.md."
    ]
    write_text(
        target, "\n".join([*head, *(f"# {shown(one, width=300)}" for one in says), "", dump_pair(pair).lstrip("\n")])
    )
    return says


def stages(model: RexsModel) -> list[Stage]:
    """The cylindrical stages of a model whose two gears are known."""
    gears: dict[int, list[int]] = {}
    for relation in model.relations:
        stage, gear = relation.role("stage"), relation.role("gear")
        if relation.type == "stage_gear_data" and stage is not None and gear is not None:
            gears.setdefault(stage, []).append(gear)
    for relation in model.relations:
        stage, *both = (relation.role(role) for role in ("stage", "gear_1", "gear_2"))
        if relation.type == "stage" and stage is not None:
            gears[stage] = [gear for gear in both if gear is not None]  # which of them is the first is said here
    out = []
    for one in model.components.values():
        pair = [model.components[gear] for gear in gears.get(one.id, [])]
        if one.type == "cylindrical_stage" and len(pair) == 2:
            out.append(Stage(stage=one, gears=(pair[0], pair[1])))
    return out


def _chosen(model: RexsModel, wanted: int | None) -> Stage:
    found = stages(model)
    if not found:
        wish = "want a cylindrical_stage with two gears"
        raise InputFileError(model.file, found="no cylindrical stage", wish=wish)
    listed = ", ".join(one.words(model) for one in found[:12]) + (", ..." if len(found) > 12 else "")
    if wanted is None and len(found) > 1:
        raise InputFileError(model.file, found=f"{len(found)} stages", wish=f"say which with --stage: {listed}")
    match = [one for one in found if wanted is None or one.stage.id == wanted]
    if not match:
        raise InputFileError(model.file, found=f"no stage {wanted}", wish=f"want --stage with one of {listed}")
    return match[0]


def _pair(model: RexsModel, chosen: Stage, first: Which | None) -> tuple[dict[str, object], list[str]]:
    """The tables of the pair file, and words."""
    data = {gear.id: _data(model, chosen.stage.id, gear.id) for gear in chosen.gears}
    driving, driven = _driving_first(model, chosen, data, first)
    says = [f"the driving gear is {called(driving)}, the driven one {called(driven)}"]
    raw: dict[str, object] = {"name": shown(chosen.stage.name or model.file.stem, width=NAME_SHOWN)}
    pair: dict[str, object] = {}
    a = model.number(chosen.stage, "center_distance", "mm")
    if a is not None:
        pair["centre_distance_mm"] = a
    if any("center_distance_allowance" in name for name in chosen.stage.attributes):
        says.append("allowances of the centre distance are not taken: the nominal one is")
    for key, gear in (("torque_nm", driven), ("torque_driving_nm", driving)):
        of = data[gear.id]
        torque = None if of is None else model.number(of, "torque", "N m")
        if torque and not {"torque_nm", "torque_driving_nm"} & pair.keys():
            pair[key] = abs(torque)
    speed = model.number(driving, "rotational_speed", "1 / min")
    if speed:
        pair["speed_rpm"] = abs(speed)
    if model.load_cases:
        says.append(f"{model.load_cases} load cases are not taken: state torque_nm and speed_rpm in [pair]")
    raw["pair"] = pair
    for name, gear in (("driving", driving), ("driven", driven)):
        of = data[gear.id]
        loaded = None if of is None else of.attributes.get("loaded_tooth_flank")
        side = cast(Side, str(loaded.value)) if loaded is not None and loaded.value in ("left", "right") else None
        one = GearOfDesign(model, gear, side)
        one.read()
        raw[name] = one.keys
        says += [text.replace("[driving.", f"[{name}.") for text in one.says]
    return raw, says


def _data(model: RexsModel, stage: int, gear: int) -> Component | None:
    """What the stage says of one gear."""
    for relation in model.relations:
        if relation.type == "stage_gear_data" and relation.role("stage") == stage and relation.role("gear") == gear:
            one = relation.role("stage_gear_data")
            if one is not None and model.components[one].type in STAGE_DATA:
                return model.components[one]
    return None


def _driving_first(
    model: RexsModel, chosen: Stage, data: dict[int, Component | None], first: Which | None
) -> tuple[Component, Component]:
    """The driving and the driven gear."""
    one, two = chosen.gears
    flags = [None if (d := data[gear.id]) is None else model.truth(d, "is_driving_gear") for gear in (one, two)]
    stated: Which | None = None
    if flags[0] != flags[1] and None not in flags:
        stated = "driving" if flags[0] else "driven"
    if stated is not None and first is not None and stated != first:
        found = f"gear_1 ({called(one)}) is the {stated} one, and --as {first}"
        raise InputFileError(model.file, found=found, wish="leave --as out, the file says which gear drives")
    which = stated or first
    if which is None:
        found = f"stage {chosen.stage.id} does not say which gear drives"
        wish = f"say what its first gear, {called(one)}, is: --as driving or --as driven"
        raise InputFileError(model.file, found=found, wish=wish)
    return (one, two) if which == "driving" else (two, one)
