"""Geometry to a file, whole or not at all."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearpoly.assemble import Assembled
from gearpoly.errors import OutOfRangeError, shown
from gearpoly.export.design import ExportedDesign, check_design, export_design, is_design_target
from gearpoly.export.drawing import Drawing, Request, draw, rounded_up
from gearpoly.export.formats import Format, format_for
from gearpoly.files.models import PairFile
from gearpoly.files.output import check_target, written_aside
from gearpoly.units import DEG, UM


@dataclass(frozen=True, kw_only=True, eq=False)
class Exported:
    """What was written where: ``drawing`` to ``target`` with ``curves``, within ``chord_error`` mm of the true
    outlines."""

    target: Path
    drawing: Drawing
    curves: str
    chord_error: float
    remarks: tuple[str, ...] = ()
    """Nothing: a drawing leaves nothing out."""

    def __repr__(self) -> str:
        return f"<Exported {shown(str(self.target))}: {self.says}>"

    @property
    def says(self) -> str:
        """What is in the file, for whoever asked for it."""
        drawing, request = self.drawing, self.drawing.request
        names = " and ".join(gear.name for gear in drawing.gears)
        points = drawing.statement()["points_per_flank"]
        text = f"{names} gear, {points} points per flank, {self.curves} within "
        text += f"{rounded_up(self.chord_error / UM):g} um"
        if drawing.contacts is not None:
            angles = f"{request.at / DEG:g} deg (driving {drawing.theta_1 / DEG:.6f} deg)"
            text += f", {request.flank} flanks in mesh at {angles}"
        return text if request.magnify == 1.0 else f"{text}, deviations magnified {request.magnify:g} times"


def check_any(target: Path, curves: str | None) -> None:
    """``check`` for a drawing or solid, and the same for a design."""
    if is_design_target(target):
        check_design(target, curves)
    else:
        check(target, curves)


def check(target: Path, curves: str | None) -> tuple[Format, str]:
    """The format of ``target`` and how it shall write curves; before any long work.

    Raises ``InputFileError`` for an unknown ending or an unwritable place, ``OutOfRangeError`` for curves that the
    format does not have.
    """
    kind = format_for(target)
    check_target(target)
    if curves is not None and curves not in kind.CURVES:
        raise OutOfRangeError(f"--curves {curves}: {target.suffix} files hold {' or '.join(kind.CURVES)}")
    return kind, curves or kind.CURVES[0]


def export(
    assembled: Assembled,
    target: Path | str,
    request: Request | None = None,
    *,
    title: str = "unnamed pair",
    source: str = "pair",
    seed: int = 0,
    curves: str | None = None,
) -> Exported:
    """Write the gears of ``assembled`` to ``target`` in the format of its ending, and say what was written.

    ``request`` says which gears, where and how fine (default: both, touching at driven angle 0); ``title`` and
    ``seed`` are stated in the file, ``source`` is what messages call the pair. Raises as ``check`` and ``draw`` do,
    ``MissingExtraError`` where a package for this format is not installed.
    """
    path = Path(target)
    kind, wanted = check(path, curves)
    drawing = draw(assembled, request or Request(), title=title, source=source, seed=seed)
    with written_aside(path) as aside:
        error = kind.write(drawing, aside, wanted)
    return Exported(target=path, drawing=drawing, curves=wanted, chord_error=error)


def export_any(
    file: PairFile,
    assembled: Assembled,
    target: Path | str,
    request: Request,
    *,
    source: str,
    seed: int,
    curves: str | None = None,
) -> Exported | ExportedDesign:
    """``export`` of the pair ``assembled`` from ``file``, or its design where the ending of ``target`` asks for one."""
    path = Path(target)
    check_any(path, curves)
    if is_design_target(path):
        return export_design(file, assembled, path, request)
    return export(assembled, path, request, title=file.name, source=source, seed=seed, curves=curves)
