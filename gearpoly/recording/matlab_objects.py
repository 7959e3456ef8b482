"""What MATLAB keeps as objects and was not read: what makes plain variables of it in MATLAB."""

from __future__ import annotations

from collections.abc import Mapping

from gearpoly.errors import GearpolyError, InputFileError, MissingExtraError
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

OTHER_CLASS_CURE = "S = struct(...) with one field for each column; save('recording.mat', '-struct', 'S')"


def unread(objects: Mapping[str, str], *, why: GearpolyError | None = None) -> tuple[str, str] | None:
    """The first table among ``objects`` (class by path), or the first of them, as found (with ``why`` it was not read)
    and wished for: with the lines that make plain variables of it. ``None`` where there are no objects."""
    if not objects:
        return None
    name = next((name for name, kind in objects.items() if kind in CURES), next(iter(objects)))
    kind = objects[name]
    found = f"{shorten(name)}, a {shorten(kind or 'class')}, not read"
    lines = CURES.get(kind, OTHER_CLASS_CURE).format(name=shorten(name))
    if isinstance(why, MissingExtraError):
        return found, f"want mat-io, which reads it: pip install gearpoly[matlab]; or in MATLAB: {lines}"
    if isinstance(why, InputFileError):
        found += f" ({why.found})"
    return found, f"want plain variables; in MATLAB: {lines}"
