"""A study file read and checked, with the pair file that it varies: one message for the most basic fault."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from gearpoly.errors import GearpolyError, InputFileError, shown, shown_value
from gearpoly.files.faults import explain
from gearpoly.files.models import PairFile, Section
from gearpoly.files.paths import is_file
from gearpoly.files.sheet_csv import with_sheets
from gearpoly.files.toml import parse
from gearpoly.files.traces import nearest, read_text
from gearpoly.study.keys import check_key, with_values
from gearpoly.study.models import OutputLimit, StudyFile, Sweep, Until
from gearpoly.study.outputs import check_output

_SECTIONS: dict[str, type[Section]] = {"sweep": Sweep, "limit": OutputLimit, "until": Until}


@dataclass(frozen=True, kw_only=True)
class Study:
    """A checked study: its ``file``, the tables ``raw`` of its pair file with ``[set]`` applied, and the ``traces``
    that these name, text by file name."""

    path: Path
    file: StudyFile
    raw: dict[str, Any]
    traces: dict[str, str]


def read_study(path: Path | str) -> Study:
    """Read and check a study file and the pair file it names.

    Raises ``InputFileError`` with file, key, what stands there and what would do.
    """
    file = Path(path)
    tables = parse(file, read_text(file))
    try:
        study = StudyFile.model_validate(tables)
    except ValidationError as error:
        raise _explain(file, error) from None
    for where, key in [
        *(("set", key) for key in study.set),
        *((f"sweep[{k}]", key) for k, sweep in enumerate(study.sweep) for key in sweep.all_keys),
    ]:
        try:
            check_key(key)
        except GearpolyError as error:
            raise InputFileError(file, where=where, wish=str(error)) from None
    attainable = []
    for name in study.outputs:
        try:
            check_output(name, whole_cycle=study.turns is None, positions_per_mesh=study.positions_per_mesh)
            attainable.append(name)
        except GearpolyError as error:
            if "outputs" in study.model_fields_set:
                raise InputFileError(file, where="outputs", wish=str(error)) from None
    study = study.model_copy(update={"outputs": tuple(attainable)})
    pair_file = file.parent / study.pair
    if not is_file(pair_file):
        raise InputFileError(file, where="pair", found=f"no such file, {pair_file}", wish="want a pair file")
    raw = with_sheets(with_values(parse(pair_file, read_text(pair_file)), study.set), pair_file)
    raw, traces = _with_traces(raw, pair_file)
    return Study(path=file, file=study, raw=raw, traces=traces)


def check_pair(raw: dict[str, Any], *, blame: Path | str, where: str) -> PairFile:
    """The pair that ``raw`` describes; raises ``InputFileError`` naming ``blame`` and ``where`` for the first fault."""
    try:
        return PairFile.model_validate(raw)
    except ValidationError as error:
        fault = explain(Path("pair"), raw, error)
        raise InputFileError(
            blame, where=where, found=f"{fault.where}: {fault.found}".strip(": "), wish=fault.wish
        ) from None


def _with_traces(raw: dict[str, Any], pair_file: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Measured traces and whole inspection files taken along as text, since a worker elsewhere has no such file."""
    traces: dict[str, str] = {}
    for gear in ("driving", "driven"):
        sheet = raw.get(gear, {}).get("inspection") if isinstance(raw.get(gear), dict) else None
        for key, ending in (("profile_csv", "csv"), ("gde", "gde")):
            name = sheet.get(key) if isinstance(sheet, dict) else None
            if not isinstance(name, str):
                continue
            source, where = pair_file.parent / name, f"{gear}.inspection.{key}"
            if not is_file(source):
                wish = "want the path of a file of measurements, relative to the pair file"
                raise InputFileError(pair_file, where=where, found=f"no such file, {source}", wish=wish)
            traces[f"{gear}.{ending}"] = read_text(source)
            raw = with_values(raw, {where: f"{gear}.{ending}"})
    return raw, traces


def _explain(file: Path, error: ValidationError) -> InputFileError:
    """The one message for the most basic fault: unknown keys, then bad values, then missing keys, then rules."""
    rank = {"extra_forbidden": 0, "missing": 2, "rule": 3}
    fault = min(error.errors(include_url=False), key=lambda fault: rank.get(fault["type"], 1))
    loc = fault["loc"]
    where = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in loc).lstrip(".")
    kind, context = fault["type"], fault.get("ctx", {})
    if kind == "rule":
        return InputFileError(
            file, where=f"{where}.{context['key']}".lstrip("."), found=context["found"], wish=context["wish"]
        )
    model = _SECTIONS.get(str(loc[0]), StudyFile) if len(loc) > 1 else StudyFile
    if kind == "extra_forbidden":
        known = [info.alias or key for key, info in model.model_fields.items()]
        close = nearest(str(loc[-1]), known)
        return InputFileError(file, where=shown(where), found="unknown key", wish=f'the nearest known key is "{close}"')
    return InputFileError(file, where=where, found=_found(fault), wish=f"want {_wish(model, fault)}")


def _found(fault: ErrorDetails) -> str:
    if fault["type"] == "missing":
        return "missing"
    value = fault["input"]
    return "a table" if isinstance(value, dict) else shown_value(value)


def _wish(model: type[Section], fault: ErrorDetails) -> str:
    for key, info in model.model_fields.items():
        if fault["loc"] and str(info.alias or key) in [str(part) for part in fault["loc"]]:
            return info.description or fault["msg"]
    return fault["msg"]
