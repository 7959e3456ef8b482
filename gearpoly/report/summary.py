"""A simulated pair in words and numbers, as a gear engineer reads it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from gearpoly.simulate import Simulation
from gearpoly.units import DEG, NM


def print_summary(
    console: Console,
    simulation: Simulation,
    *,
    name: str,
    defaults: Sequence[tuple[str, object]],
    listed: bool,
    remarks: Sequence[str],
) -> None:
    """Print the key figures of a run; of the ``defaults`` that it stands on their number, or all where
    ``listed`` is wanted."""
    table = Table(title=name, title_justify="left", show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for label, text in _rows(simulation):
        table.add_row(label, text)
    console.print(table)
    if defaults:
        values = ", ".join(f"{key} = {_short(value)}" for key, value in defaults)
        words = f"defaults: {values}" if listed else f"{len(defaults)} values are defaults; --defaults lists them"
        console.print(words, style="dim", highlight=False)
    for remark in remarks:
        console.print(f"note: {remark}", style="yellow", highlight=False)


def _rows(simulation: Simulation) -> list[tuple[str, str]]:
    """The key figures of a run, each with its label."""
    pair, figures = simulation.pair, simulation.summary()
    gears = " and ".join(
        f"{label} z = {mounted.gear.z}, x = {mounted.gear.x:g} ({origin})"
        for label, mounted, origin in zip(
            ("driving", "driven"),
            (pair.driving, pair.driven),
            simulation.assembled.origin,
            strict=True,
        )
    )
    rows = [
        ("gears", f"m = {pair.driving.gear.m:g} mm, {gears}"),
        (
            "mounted",
            f"a = {pair.a:.4f} mm (tight mesh {pair.a_w:.4f} mm), working pressure angle {pair.alpha_w / DEG:.4f} deg",
        ),
        ("flank", f"{simulation.flank}, {load_words(simulation)}, {figures['positions']} positions of the driven gear"),
        (
            "transmission error",
            f"TEpp {figures['te_pp_um']:.4f} um = {figures['te_pp_urad']:.3f} urad = "
            f"{figures['te_pp_arcmin']:.4f} arcmin of the driven shaft, "
            f"mean {figures['te_mean_um']:.4f} um",
        ),
        (
            "backlash j_bn",
            f"mean {figures['backlash_mean_um']:.3f} um, least {figures['backlash_least_um']:.3f} um "
            f"(mean lost motion {figures['lost_motion_mean_arcmin']:.3f} arcmin of the driving shaft, "
            f"{figures['lost_motion_mean_arcmin'] * pair.r_b1 / pair.r_b2:.3f} of the driven)",
        ),
        ("contact ratio", _contact_ratio_words(figures)),
        ("tip corners", f"touch in {figures['corner_contacts']} contacts"),
        (
            "exactness",
            f"{figures['certified']} contacts certified to 2.5e-13 rad, {figures['repaired']} of them solved "
            "again on whole flanks; "
            f"chords let TE lag by at most {1e3 * figures['chord_noise_um']:.3f} nm",
        ),
    ]
    if simulation.load is not None:
        rows.insert(6, ("under load", _bending_words(figures)))
    if "drawn" in simulation.assembled.origin:
        rows.append(("drawn with seed", str(simulation.seed)))
    return rows


def _contact_ratio_words(figures: dict[str, Any]) -> str:
    """How many pairs touch in the mean, and how many would without deviations."""
    counted = figures["contact_ratio"]
    found = "not counted (positions not evenly spaced)" if counted is None else f"{counted:.5f} pairs touch in the mean"
    return f"{found}, theoretical {figures['contact_ratio_theoretical']:.5f} without deviations"


def _bending_words(figures: dict[str, Any]) -> str:
    """What load does to the teeth in the mean."""
    return (
        f"mean deflection {figures['deflection_mean_um']:.3f} um, mean mesh stiffness "
        f"{figures['mesh_stiffness_mean_n_per_um']:.1f} N/um = "
        f"{figures['mesh_stiffness_per_width_n_per_mm_um']:.2f} N/(mm um), largest share "
        f"{figures['share_largest']:.3f}"
    )


def load_words(simulation: Simulation) -> str:
    """The load of a run in words."""
    if simulation.load is not None:
        return f"{simulation.load.torque / NM:g} N.m"
    return "rigid teeth" if simulation.assembled.elasticity is None else "unloaded"


def _short(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)
