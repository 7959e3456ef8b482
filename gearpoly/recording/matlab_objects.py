"""What MATLAB keeps as objects, which only MATLAB can open: tables, timetables, time series, logs of Simulink."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten

CURES = {
    "table": "S = table2struct({name}, 'ToScalar', true); save('recording.mat', '-struct', 'S')",
    "timetable": (
        "S = table2struct(timetable2table({name}, 'ConvertRowTimes', false), 'ToScalar', true); "
        "S.time_s = seconds({name}.Properties.RowTimes - {name}.Properties.RowTimes(1)); "
        "save('recording.mat', '-struct', 'S')"
    ),
    "timeseries": "S = struct('time_s', {name}.Time, 'te_um', {name}.Data); save('recording.mat', '-struct', 'S')",
    "Simulink.SimulationData.Dataset": (
        "S.time_s = {name}.get(1).Values.Time; S.te_um = {name}.get(1).Values.Data, and so on for each signal under "
        "its column's name; save('recording.mat', '-struct', 'S')"
    ),
}
"""What to type in MATLAB, by class. ``save -struct`` writes the fields as variables of their own."""

OTHER = "S = struct(...) with one field for each column; save('recording.mat', '-struct', 'S')"


def refuse_objects(file: Path, objects: Mapping[str, str]) -> None:
    """Raise ``InputFileError`` where a file without columns holds ``objects`` (class by name): with the lines that make
    plain variables of the first table among them, or of the first."""
    if not objects:
        return
    name = next((name for name, kind in objects.items() if kind in CURES), next(iter(objects)))
    kind = objects[name]
    found = f"no columns, but {shorten(name)}, a {shorten(kind or 'class')}, which only MATLAB can open"
    wish = f"want plain variables; in MATLAB: {CURES.get(kind, OTHER).format(name=shorten(name))}"
    raise InputFileError(file, where="variables", found=found, wish=wish)
