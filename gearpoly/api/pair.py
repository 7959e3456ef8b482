"""A pair of gears from Python: polygons and contacts, and all that the command line does with it.

Angles are rad and lengths mm, as everywhere inside; keys of pair files keep the file's units.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from pydantic import ValidationError
from shapely.geometry import Polygon

from gearpoly import arguments
from gearpoly.api.given import MAGNIFICATION, POINTS_PER_FLANK, Recorded, row
from gearpoly.api.readings import Maps, read_each, read_one
from gearpoly.api.results import Compared, Simulated, simulated
from gearpoly.api.verdicts import Diagnosed, Planned
from gearpoly.api.viewed import Viewed, view_of
from gearpoly.api.words import told_in_python
from gearpoly.assemble import Assembled, assemble
from gearpoly.course import along, over_turns
from gearpoly.diagnose.budget import USUAL_WORK_S
from gearpoly.diagnose.compare_as_built import compare_as_built
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.plan import plan
from gearpoly.errors import InputFileError, NoGearPassesError, shown
from gearpoly.export.brought import CURVE_FORMS
from gearpoly.export.design import ExportedDesign
from gearpoly.export.drawing import Drawing, Request, draw
from gearpoly.export.formats.svg import svg_text
from gearpoly.export.outline import Detail
from gearpoly.export.write import Exported, export_any
from gearpoly.files.faults import explain
from gearpoly.files.models import PairFile
from gearpoly.files.output import write_text
from gearpoly.files.pairfile import dump_pair, moved, read_pair
from gearpoly.files.sheet_csv import with_sheets
from gearpoly.gear.deviations import Deviations, total
from gearpoly.gear.gear import Gear
from gearpoly.gear.polygon import gear_polygon
from gearpoly.mesh.pair import Flank, GearPair, Mounted
from gearpoly.mesh.transmission import NEAR_PAIR_MM, FlankContacts, contacts
from gearpoly.positions import USUAL_POINTS_PER_MESH
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray, read_only

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GLANCE = Detail(points=24)
"""Detail of pictures in notebooks: under 150 kB a pair, and no edge shows on a screen."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PairGear:
    """One gear of a pair as it was drawn: ``which`` of the ``pair``; shows itself as SVG in notebooks."""

    pair: Pair
    which: Literal["driving", "driven"]

    def __post_init__(self) -> None:
        arguments.check_choice("which", self.which, arguments.GEARS)

    def __repr__(self) -> str:
        gear = self.nominal
        return f"<PairGear: the {self.which} gear, {gear.z} teeth of module {gear.m:g} mm>"

    @property
    def mounted(self) -> Mounted:
        """The drawn gear on its axis: flanks, centre lines, eccentricity."""
        pair = self.pair.mesh
        return pair.driving if self.which == "driving" else pair.driven

    @property
    def nominal(self) -> Gear:
        """The deviation-free gear: ISO 21771 quantities in mm and rad."""
        return self.mounted.gear

    @property
    def deviations(self) -> Deviations:
        """The deviations that its flanks were drawn from."""
        return self.pair.assembled.deviations[0 if self.which == "driving" else 1]

    @cached_property
    def polygon(self) -> Polygon:
        """The whole gear with its bore in mm about its own centre, at rotation 0, at the pair file's full detail."""
        return gear_polygon(self.mounted.flanks, self.mounted.centre_lines)

    def deviation(self, roll_length: FloatArray, *, flank: Flank = "drive") -> FloatArray:
        """Normal deviation (z, n) in mm of every tooth at roll lengths (n,) in mm, pitch included, positive = more
        material. Raises ``OutOfRangeError`` for lengths or a flank that are none."""
        arguments.check_choice("flank", flank, arguments.FLANKS)
        roll_length = row("roll_length", roll_length, "finite length in mm, 0 or more,", least=0.0)
        shapes = self.deviations.drive if flank == "drive" else self.deviations.coast
        rows = np.broadcast_to(roll_length, (self.nominal.z, roll_length.size))
        return read_only(total(shapes, rows, z=self.nominal.z, span=self.mounted.flanks.span))

    def export(self, target: Path | str, *, magnify: float = 1.0, **options: Any) -> Exported | ExportedDesign:
        """Write this gear alone; options as in :meth:`Pair.export`."""
        return self.pair.export(target, which=self.which, magnify=magnify, **options)

    def _repr_svg_(self) -> str:
        return _glance(self.pair.drawing(Request(which=self.which, detail=GLANCE)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Pair:
    """Two error gears in mesh, from a pair file or from a dictionary with its keys; shows itself as SVG in notebooks.

    ``file`` is what was known, ``source`` what messages call it, ``seed`` what draws the rest."""

    file: PairFile
    source: str
    seed: int

    def __post_init__(self) -> None:
        try:
            self.assembled  # noqa: B018 - asked for what it raises; recordings need no gears that keep limits
        except InputFileError as error:
            if not isinstance(error.__context__, NoGearPassesError):
                raise

    def __repr__(self) -> str:
        z_1, z_2 = self.file.driving.teeth, self.file.driven.teeth
        return f'<Pair "{shown(self.file.name)}": {z_1}/{z_2} teeth, seed {self.seed}>'

    @classmethod
    def read(cls, path: Path | str, *, seed: int = 0) -> Self:
        """The pair of a pair file. Raises ``InputFileError`` as ``gearpoly simulate`` does."""
        arguments.check_file("path", path)
        arguments.SEED.check("seed", seed)
        return cls(file=read_pair(path), source=str(path), seed=seed)

    @classmethod
    def of(cls, known: Mapping[str, Any], *, seed: int = 0) -> Self:
        """The pair of which ``known`` states what a pair file would, in the file's keys and units; traces named in it
        are looked for in the working folder. Raises ``InputFileError``."""
        arguments.check_keys("known", known)
        arguments.SEED.check("seed", seed)
        source = "pair"
        raw = with_sheets(dict(known), Path(source))
        try:
            file = PairFile.model_validate(raw)
        except ValidationError as error:
            raise explain(Path(source), raw, error) from None
        return cls(file=file, source=source, seed=seed)

    @cached_property
    def assembled(self) -> Assembled:
        """The pair with its deviations and compliance. Raises ``InputFileError`` where no drawn gear keeps the limits:
        recordings, which tell their own deviations, are compared and diagnosed all the same."""
        return assemble(self.file, path=self.source, seed=self.seed)

    @property
    def mesh(self) -> GearPair:
        """Both gears on their axes, for everything that the facade does not offer."""
        return self.assembled.pair

    @cached_property
    def driving(self) -> PairGear:
        """The driving gear."""
        return PairGear(pair=self, which="driving")

    @cached_property
    def driven(self) -> PairGear:
        """The driven gear."""
        return PairGear(pair=self, which="driven")

    def contacts(
        self, theta_2: FloatArray | float, *, flank: Flank = "drive", near: float = NEAR_PAIR_MM
    ) -> FlankContacts:
        """Certified contacts, unloaded, at driven rotations ``theta_2`` in rad (one or many); pairs within ``near`` mm
        of the first touch are in it too. Raises ``OutOfRangeError`` for angles, a flank or a distance that are none."""
        at = row("theta_2", theta_2, "finite angle in rad")
        arguments.check_choice("flank", flank, arguments.FLANKS)
        arguments.DISTANCE_BETWEEN_TEETH.check("near", near)
        return contacts(self.mesh, at, flank=flank, near=near)

    def transmission_error(self, theta_2: FloatArray | float, *, flank: Flank = "drive") -> FloatArray:
        """Unloaded transmission error (N,) in rad on the driven side at ``theta_2`` (N,) in rad."""
        return self.contacts(theta_2, flank=flank).te

    @told_in_python()
    def simulate(
        self,
        *,
        turns: float | None = None,
        points_per_mesh: int = USUAL_POINTS_PER_MESH,
        torque_nm: float | None = None,
        flank: Flank = "drive",
        fast: bool = False,
    ) -> Simulated:
        """What ``gearpoly simulate`` computes, over ``turns`` of the driven gear (default: a whole hunting cycle).

        Raises ``OutOfRangeError`` for an argument that the command refuses.
        """
        arguments.check_choice("flank", flank, arguments.FLANKS)
        if torque_nm is not None:
            arguments.TORQUE_MAGNITUDE.check("torque_nm", torque_nm)
        course = over_turns(
            self.assembled,
            self.file,
            flank=flank,
            turns=turns,
            points_per_mesh=points_per_mesh,
            torque_nm=torque_nm,
        )
        return simulated(self.assembled, self.file, course, seed=self.seed, fast=fast)

    @told_in_python()
    def simulate_at(
        self,
        recording: Path | str | Recording,
        *,
        map: Path | str | None = None,
        flank: Flank | None = None,
        fast: bool = False,
    ) -> Simulated:
        """What ``gearpoly simulate --at`` computes: the samples of one recording, under its condition; ``flank`` other
        than the recording's where it is given. Raises ``InputFileError`` as the command does."""
        one = read_one(recording, map=map, worm=self.file.worm)
        if flank is not None:
            arguments.check_choice("flank", flank, arguments.FLANKS)
        course = along(self.assembled, self.file, one, flank=flank)
        return simulated(self.assembled, self.file, course, seed=self.seed, fast=fast)

    @told_in_python()
    def compare(self, recordings: Recorded, *, map: Maps = None) -> Compared:
        """Lay recordings of one set-up on the simulation of this pair, as ``gearpoly compare`` does; ``map`` says what
        their columns are, one for all or a list with one for each. Raises ``InputFileError`` as the command does."""
        read = read_each(recordings, map=map, worm=self.file.worm)
        return Compared(comparison=compare_as_built(self.file, read, path=self.source))

    @told_in_python()
    def diagnose(self, recordings: Recorded, *, map: Maps = None, within: float = USUAL_WORK_S) -> Diagnosed:
        """Name the physics that this pair's file leaves out, as ``gearpoly diagnose`` does, looking no longer than
        ``within`` seconds of work. Raises ``InputFileError`` as the command does, ``OutOfRangeError`` for less
        than 1 s."""
        arguments.SECONDS_OF_WORK.check("within", within)
        read = read_each(recordings, map=map, worm=self.file.worm)
        found = diagnose(self.file, read, path=self.source, within=within)
        return Diagnosed(source=self.source, diagnosis=found)

    def plan(self) -> Planned:
        """Which recordings would tell the look-alikes of this pair apart, as ``gearpoly plan`` says."""
        return Planned(plan=plan(self.file, path=self.source))

    @told_in_python()
    def view(
        self,
        *,
        theta_2: float = 0.0,
        recording: Path | str | Recording | None = None,
        map: Path | str | None = None,
        flank: Flank | None = None,
    ) -> Viewed:
        """The contact debugger, as ``gearpoly view`` writes it, opened at ``theta_2`` in rad.

        A ``recording`` brings its mismatch and its flank, and nothing is drawn by chance beside it. Raises
        ``OutOfRangeError`` for a ``flank`` or a ``map`` that does not go with that.
        """
        return view_of(
            self.assembled,
            self.file,
            source=self.source,
            seed=self.seed,
            theta_2=theta_2,
            recording=recording,
            map=map,
            flank=flank,
        )

    @told_in_python()
    def plot(
        self,
        target: Path | str | None = None,
        *,
        what: Literal["mesh", "deviations", "gaps"] = "mesh",
        theta_2: float = 0.0,
        flank: Flank = "drive",
    ) -> Figure:
        """A still picture as ``gearpoly plot`` draws it, at ``theta_2`` in rad; written to ``target`` if given.

        The ``mesh`` close up at a contact, ``deviations`` of all teeth, or ``gaps`` of near pairs.
        """
        from gearpoly.report.gear_plots import PICTURES, pair_figure
        from gearpoly.report.plots import saved

        arguments.check_choice("what", what, PICTURES)
        arguments.ROTATION.check("theta_2", theta_2)
        arguments.check_choice("flank", flank, arguments.FLANKS)
        return saved(pair_figure(self.assembled, what, theta_2, flank=flank, name=self.file.name), target)

    def save(self, target: Path | str) -> None:
        """Write what is known of the pair as a pair file."""
        arguments.check_file("target", target)
        write_text(target, dump_pair(moved(self.file, source=Path(self.source), target=Path(target))))

    @told_in_python()
    def drawing(self, request: Request | None = None) -> Drawing:
        """The gears placed and drawn as ``request`` wants them: polygons, parts, contacts."""
        return draw(self.assembled, request or Request(), title=self.file.name, source=self.source, seed=self.seed)

    @told_in_python()
    def export(
        self,
        target: Path | str,
        *,
        which: Literal["driving", "driven", "both"] = "both",
        theta_2: float = 0.0,
        flank: Flank = "drive",
        apart: bool = False,
        magnify: float = 1.0,
        points: int | None = None,
        chord: float | None = None,
        curves: str | None = None,
    ) -> Exported | ExportedDesign:
        """Write the gears in the format of the ending of ``target``, as ``gearpoly export`` does; a ``.rexs`` file
        holds their design.

        ``theta_2`` in rad, ``chord`` (the chord error) in mm; the others as on the command line. Raises
        ``InputFileError``, ``OutOfRangeError`` or ``MissingExtraError`` with what would do.
        """
        arguments.check_file("target", target)
        arguments.ROTATION.check("theta_2", theta_2)
        MAGNIFICATION.check("magnify", magnify)
        if points is not None:
            POINTS_PER_FLANK.check("points", points)
        if chord is not None:
            arguments.Number(unit="mm").check("chord", chord)
        if curves is not None:
            arguments.check_choice("curves", curves, CURVE_FORMS)
        request = Request(
            which=which,
            at=theta_2,
            flank=flank,
            apart=apart,
            magnify=magnify,
            detail=Detail(points=points, chord=chord),
        )
        return export_any(self.file, self.assembled, target, request, source=self.source, seed=self.seed, curves=curves)

    def _repr_svg_(self) -> str:
        return _glance(self.drawing(Request(detail=GLANCE)))


def _glance(drawing: Drawing) -> str:
    """The drawing as SVG for a page, which wants no XML declaration."""
    return svg_text(drawing).partition("\n")[2]


def load(path: Path | str, *, seed: int = 0) -> Pair:
    """The pair of a pair file; ``seed`` decides what a grade leaves to chance."""
    return Pair.read(path, seed=seed)
