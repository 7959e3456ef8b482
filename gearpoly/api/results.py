"""What simulations and comparisons give from Python: numbers in the units of the edge, pictures, tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearpoly.api.tables import data_frame
from gearpoly.assemble import Assembled
from gearpoly.compare.beside import Comparison
from gearpoly.course import Course, remarks_on, simulate_course
from gearpoly.errors import shown
from gearpoly.files.models import PairFile
from gearpoly.files.output import write_text
from gearpoly.files.pairfile import effective_defaults
from gearpoly.mesh.pair import Flank
from gearpoly.simulate import Simulation
from gearpoly.units import DEG, UM, FloatArray, IntArray, read_only

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulated:
    """One pair over its positions (N,): what ``gearpoly simulate`` computes. ``name`` is the pair's; ``simulation`` has
    the rest, in mm and rad. ``defaults`` are the keys that the pair file left to their defaults, with their values."""

    name: str
    simulation: Simulation
    remarks: tuple[str, ...] = ()
    defaults: tuple[tuple[str, object], ...] = ()

    def __repr__(self) -> str:
        figures = (
            f"transmission error {self.te_pp_um:.3g} um peak to peak, mean backlash {self.backlash_mean_um:.3g} um"
        )
        return f'<Simulated "{shown(self.name)}": {self.te_um.size} positions, {self.flank} flank, {figures}>'

    @property
    def flank(self) -> Flank:
        """The flank that carries."""
        return self.simulation.flank

    @property
    def driven_angle_deg(self) -> FloatArray:
        """Driven rotation (N,) in deg."""
        return read_only(self.simulation.contacts.theta_2 / DEG)

    @property
    def driving_angle_deg(self) -> FloatArray:
        """Driving rotation (N,) in deg at which the flank touches."""
        return read_only(self.simulation.theta_1 / DEG)

    @property
    def te_um(self) -> FloatArray:
        """Transmission error (N,) in um along the line of action, positive where the driven gear is ahead."""
        return read_only(self.simulation.te_um)

    @property
    def backlash_um(self) -> FloatArray:
        """Normal backlash j_bn (N,) in um."""
        return read_only(self.simulation.backlash.j_bn / UM)

    @property
    def contact_pairs(self) -> IntArray:
        """Number of touching pairs (N,), of carrying ones under load."""
        return self.simulation.pairs

    @cached_property
    def summary(self) -> Mapping[str, Any]:
        """Key figures by the names that the JSON has, such as ``te_pp_um`` and ``backlash_mean_um``."""
        return self.simulation.summary()

    @property
    def te_pp_um(self) -> float:
        """Transmission error peak to peak in um."""
        return float(self.summary["te_pp_um"])

    @property
    def backlash_mean_um(self) -> float:
        """Mean normal backlash in um."""
        return float(self.summary["backlash_mean_um"])

    @property
    def contact_ratio(self) -> float | None:
        """Mean number of touching pairs; None where the positions are not evenly spaced."""
        return self.simulation.contact_ratio

    def plot(self, target: Path | str | None = None) -> Figure:
        """Transmission error, backlash and touching pairs over the driven angle; written to ``target`` if given."""
        from gearpoly.report.plots import run_figure, saved

        return saved(run_figure(self.simulation, name=self.name), target)

    def to_csv(self, target: Path | str) -> None:
        """Write the columns of ``gearpoly simulate --csv``."""
        from gearpoly.report.simulation_files import csv_text

        write_text(target, csv_text(self.simulation))

    def to_dict(self) -> dict[str, Any]:
        """What ``gearpoly simulate --json`` writes: key figures, curves, every contact."""
        from gearpoly.report.simulation_files import run_json

        return run_json(self.simulation, name=self.name, defaults=self.defaults, remarks=self.remarks)

    def to_json(self, target: Path | str) -> None:
        """Write the same."""
        from gearpoly.report.simulation_files import json_text

        text = json_text(self.simulation, name=self.name, defaults=self.defaults, remarks=self.remarks)
        write_text(target, text)

    def to_pandas(self) -> DataFrame:
        """A row per position, the columns of ``to_csv``."""
        from gearpoly.report.simulation_files import CSV_HEADER

        return data_frame(dict(zip(CSV_HEADER.split(","), self.simulation.table().T, strict=True)))


def simulated(assembled: Assembled, file: PairFile, course: Course, *, seed: int, fast: bool) -> Simulated:
    """The pair of the ``file`` on a ``course``, and nobody watches."""
    made = simulate_course(assembled, course, file, seed=seed, fast=fast, progress=lambda done: None)
    remarks, defaults = remarks_on(file, course, made), tuple(effective_defaults(file))
    return Simulated(name=file.name, simulation=made, remarks=remarks, defaults=defaults)


@dataclass(frozen=True, kw_only=True, eq=False)
class Compared:
    """Recordings beside their simulation: what ``gearpoly compare`` finds. ``comparison`` has the rest (mm, rad)."""

    comparison: Comparison

    def __repr__(self) -> str:
        many = len(self.comparison.aligned)
        figures = f"residual {self.residual_rms_um:.3g} um rms, noise {self.noise_um:.3g} um, {len(self.where)} places"
        return f'<Compared "{shown(self.name)}": {many} recording{"s" * (many > 1)}, {figures}>'

    @property
    def name(self) -> str:
        """The pair's name."""
        return self.comparison.name

    @property
    def residual_rms_um(self) -> float:
        """Rms in um of recorded minus simulated, about each recording's mean."""
        return self.comparison.located.residual_rms / UM

    @property
    def noise_um(self) -> float:
        """Rms in um of what does not repeat with the hunting cycle."""
        return self.comparison.located.noise_level / UM

    @cached_property
    def where(self) -> tuple[Mapping[str, Any], ...]:
        """Places where they differ, most of the mismatch first, with the keys of the verdict."""
        return tuple(self.to_dict()["where"])

    @property
    def says(self) -> tuple[str, ...]:
        """The same in words."""
        from gearpoly.compare.on_sky import sky_of
        from gearpoly.report.compare_report import entry_words

        sky = sky_of(self.comparison)
        return tuple(entry_words(entry, sky) for entry in self.comparison.located.where)

    def plot(self, target: Path | str | None = None) -> Figure:
        """Maps by tooth and mesh phase, order and time spectra; written to ``target`` if given."""
        from gearpoly.report.compare_plots import comparison_figure
        from gearpoly.report.plots import saved

        return saved(comparison_figure(self.comparison), target)

    def to_dict(self) -> dict[str, Any]:
        """What ``gearpoly compare --json`` writes."""
        from gearpoly.report.compare_report import comparison_json

        return comparison_json(self.comparison)

    def to_json(self, target: Path | str) -> None:
        """Write the same."""
        from gearpoly.report.compare_report import json_text

        write_text(target, json_text(self.comparison))

    def to_pandas(self) -> DataFrame:
        """A row per sample: ``recording`` (from 0), ``time_s``, ``driven_angle_deg`` from angle zero, and in um
        ``recorded_um``, ``simulated_um``, ``residual_um``."""
        return samples_of(self.comparison, [one.residual for one in self.comparison.aligned])


def samples_of(comparison: Comparison, left: list[FloatArray] | tuple[FloatArray, ...]) -> DataFrame:
    """Recordings sample by sample, with what is ``left`` (n_k,) in mm of each."""
    import numpy as np

    rows = []
    for k, (one, rest) in enumerate(zip(comparison.aligned, left, strict=True)):
        time = np.full(rest.size, np.nan) if one.time_s is None else one.time_s
        simulated = one.recorded - rest
        number = np.full(rest.size, k, dtype=np.int64)
        rows.append((number, time, one.theta_2 / DEG, one.recorded / UM, simulated / UM, rest / UM))
    names = ("recording", "time_s", "driven_angle_deg", "recorded_um", "simulated_um", "residual_um")
    return data_frame({name: np.concatenate(parts) for name, parts in zip(names, zip(*rows, strict=True), strict=True)})
