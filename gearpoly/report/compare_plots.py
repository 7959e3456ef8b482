"""Pictures of a comparison: what is left by tooth and phase for both gears, over shaft orders, and over time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearpoly.compare.beside import Aligned, Comparison
from gearpoly.compare.families import SHARES, line_threshold
from gearpoly.compare.lost_motion import lost_motions
from gearpoly.compare.noise import Noise
from gearpoly.compare.slow import SLOW_CURVE_TERMS, slow_curves
from gearpoly.compare.spectrum import SPECTRUM_PLACES_PER_LINE, FrequencyGrid, sample_weights
from gearpoly.report.lost_motion_report import draw_lost
from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, ShownFigure, save
from gearpoly.units import NM, UM, FloatArray

MESH_ORDERS_IN_SPECTRUM = 6.0
"""Mesh orders that the order spectrum shows; what lies beyond is mostly the rest of steps."""

LABELLED = 6
"""Lines that are named in a spectrum, the largest ones."""


def plot_comparison(comparison: Comparison, *, target: Path) -> None:
    """Write ``comparison_figure`` to ``target``."""
    save(comparison_figure(comparison), target)


def comparison_figure(comparison: Comparison) -> Figure:
    """Maps of the recording with the most left over, and the spectra of all."""
    aligned = comparison.aligned
    timed = [k for k, one in enumerate(aligned) if one.time_s is not None]
    lost = lost_motions(comparison)
    heights = [5, 3, *[3] * bool(timed), *[3] * bool(lost)]
    figure = ShownFigure(figsize=(13.0, float(sum(heights))), layout="constrained")
    rows: Any = figure.subfigures(len(heights), 1, height_ratios=heights)
    worst = int(np.argmax([one.rms for one in aligned]))
    _maps(rows[0], comparison, worst)
    _orders(rows[1].subplots(), comparison)
    if timed:
        _times(rows[2].subplots(), comparison, timed)
    if lost:
        draw_lost(rows[-1], lost)
    one = aligned[worst]
    figure.suptitle(
        f"{comparison.name}: recorded minus simulated, {comparison.located.residual_rms / UM:.3f} um rms, "
        f"noise {comparison.located.noise_level / UM:.3f} um; maps of recording {worst} "
        f"({one.flank} flank, {one.torque / NM:g} N.m)",
        fontsize=11,
    )
    return figure


def _maps(figure: Any, comparison: Comparison, k: int) -> None:
    """What every tooth of both gears differs by from the mean tooth, over the mesh phase, and the mean tooth."""
    maps, numbered = comparison.located.maps[k], comparison.alignment.numbered
    held = [values[np.isfinite(values)] for values in (maps.driving, maps.driven)]
    top = max((float(np.max(np.abs(values))) for values in held if values.size), default=0.0) / UM
    # Below three standard errors of a cell colours would only show noise.
    top = max(top, 3.0 * max(maps.std_driving, maps.std_driven) / UM, 1e-3)
    axes = figure.subplots(1, 3, width_ratios=(4, 4, 3))
    for axis, values, name, std, told in (
        (axes[0], maps.driving, "driving", maps.std_driving, numbered[0]),
        (axes[1], maps.driven, "driven", maps.std_driven, numbered[1]),
    ):
        picture = axis.imshow(
            values / UM, aspect="auto", origin="lower", cmap="RdBu_r", vmin=-top, vmax=top, interpolation="nearest",
            extent=(0.0, 1.0, -0.5, values.shape[0] - 0.5),
        )  # fmt: skip
        axis.set_xlabel("phase / pitches after the pitch point")
        axis.set_ylabel(f"{name} tooth" + ("" if told else " (numbering open)"))
        axis.set_title(f"{name} gear: from the mean tooth; one cell +- {std / UM:.2g} um", fontsize=9)
        step = max(1, values.shape[0] // 12)
        axis.set_yticks(range(0, values.shape[0], step))
    figure.colorbar(picture, ax=axes[1], label="residual / um", shrink=0.9)
    axes[2].axhline(0.0, color=GREY, linewidth=0.8)
    axes[2].stairs(maps.mean / UM, np.linspace(0.0, 1.0, maps.mean.size + 1), baseline=None, color=BLUE)
    axes[2].set_xlim(0.0, 1.0)
    axes[2].set_xlabel("phase / pitches after the pitch point")
    axes[2].set_ylabel("mean tooth / um")
    axes[2].set_title("mean tooth", fontsize=9)
    axes[2].grid(color=GREY, alpha=0.25, linewidth=0.5)
    if maps.note:
        figure.supxlabel(maps.note, fontsize=8)


def _colours(count: int) -> list[str]:
    return [(BLUE, ORANGE, GREEN)[k % 3] for k in range(count)]


def _orders(axis: Any, comparison: Comparison) -> None:
    pair = comparison.assembled.pair
    z_1, z_2 = pair.driving.gear.z, pair.driven.gear.z
    tops: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    lines: list[tuple[float, float]] = []
    for k, (one, colour) in enumerate(zip(comparison.aligned, _colours(len(comparison.aligned)), strict=True)):
        noise = comparison.located.noises[k]
        u = one.theta_2 * (z_2 / (2.0 * np.pi))
        span, spacing = float(np.ptp(u)), float(np.median(np.diff(u)))
        top = min(MESH_ORDERS_IN_SPECTRUM + 0.5, 0.5 / spacing)
        rest, waves = _parted(one)
        frequency, amplitude = _spectrum(u, rest, span, top)
        # The orders of both shafts are the places that were searched.
        places = top * (z_1 + z_2)
        limit = _threshold(noise, frequency, one.residual.size, places, SHARES.orders)
        label = f"recording {k}: {one.flank}, {one.torque / NM:g} N.m"
        axis.semilogy(frequency * z_1, amplitude / UM, color=colour, linewidth=0.6, alpha=0.8, label=label)
        axis.semilogy(frequency * z_1, limit / UM, color=colour, linewidth=1.0, linestyle="--")
        tops.append((frequency * z_1, amplitude / UM, limit / UM))
        for order, size in waves:
            axis.semilogy([order, order], [1e-9, size / UM], color=colour, linewidth=1.4)
            lines.append((order, size / UM))
    for mesh in range(1, int(max(x[-1] for x, _, _ in tops) / z_1) + 1):
        axis.axvline(mesh * z_1, color=GREY, linewidth=0.5, alpha=0.5, zorder=0)
    _name_peaks(axis, tops, lines, lambda order: _order_words(order, z_1, z_2))
    _bottom(axis, tops, lines)
    axis.set_xlabel(f"order of the driving shaft (grey: mesh orders, {z_1} each)")
    axis.set_ylabel("amplitude / um")
    axis.set_title("order spectrum; dashed: what noise exceeds in one of a hundred recordings", fontsize=9)
    axis.legend(fontsize=8, loc="upper right")
    axis.margins(x=0.0)
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)


def _times(axis: Any, comparison: Comparison, timed: list[int]) -> None:
    tops = []
    for k, colour in zip(timed, _colours(len(timed)), strict=True):
        one, noise = comparison.aligned[k], comparison.located.noises[k]
        time = one.time_s
        assert time is not None  # these are the recordings with time
        u = one.theta_2 * (comparison.assembled.pair.driven.gear.z / (2.0 * np.pi))
        span, dt = float(np.ptp(time)), float(np.median(np.diff(time)))
        per_second = float(np.ptp(u)) / span
        top = min((MESH_ORDERS_IN_SPECTRUM + 0.5) * per_second, 0.5 / dt)
        frequency, amplitude = _spectrum(time, _parted(one)[0], span, top)
        limit = _threshold(noise, frequency / per_second, one.residual.size, top * span, SHARES.time)
        label = f"recording {k}: {one.ran}, {one.torque / NM:g} N.m"
        axis.semilogy(frequency, amplitude / UM, color=colour, linewidth=0.6, alpha=0.8, label=label)
        axis.semilogy(frequency, limit / UM, color=colour, linewidth=1.0, linestyle="--")
        tops.append((frequency, amplitude / UM, limit / UM))
    _name_peaks(axis, tops, [], lambda hertz: f"{hertz:.4g} Hz")
    _bottom(axis, tops, [])
    axis.set_xlabel("frequency / Hz")
    axis.set_ylabel("amplitude / um")
    axis.set_title("time spectrum, first orders of the shafts taken off: what is fixed in time is sharp", fontsize=9)
    axis.legend(fontsize=8, loc="upper right")
    axis.margins(x=0.0)
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)


def _spectrum(x: FloatArray, rest: FloatArray, span: float, top: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies (k,) in cycles per unit of ``x`` (n,) and amplitudes (k,) in mm of waves in ``rest`` (n,) in mm."""
    step = 1.0 / (SPECTRUM_PLACES_PER_LINE * span)
    grid = FrequencyGrid(x, step=step, count=max(2, int(top / step)))
    # Each sample counts by the stretch it stands for: a strong line then does not spill over the others.
    weight = sample_weights(x)
    frequency: FloatArray = np.arange(grid.count, dtype=np.float64) * step
    return frequency, 2.0 * np.abs(grid.transform(weight * rest)) / float(np.sum(weight))


def _parted(one: Aligned) -> tuple[FloatArray, list[tuple[float, float]]]:
    """The residual (n,) in mm without its slow curve and the first two orders of both shafts, and those waves as
    (order of the driving shaft, amplitude in mm): far stronger than the rest, they would spill over it."""
    ratio = one.cleaned.ratio
    orders = [1.0, 2.0, ratio, 2.0 * ratio] if ratio != 1.0 else [1.0, 2.0]
    # Waves slower than half a turn of the recording are no lines yet.
    turns = float(np.ptp(one.theta_1)) / (2.0 * np.pi)
    orders = [order for order in orders if order * turns > 1.5]
    waves = [wave(order * one.theta_1) for order in orders for wave in (np.cos, np.sin)]
    columns = np.column_stack([slow_curves(one.theta_2), *waves])
    beta = np.linalg.lstsq(columns, one.residual, rcond=None)[0]
    sizes = np.hypot(beta[SLOW_CURVE_TERMS::2], beta[SLOW_CURVE_TERMS + 1 :: 2])
    return one.residual - columns @ beta, list(zip(orders, sizes.tolist(), strict=True))


def _threshold(noise: Noise, per_mesh: FloatArray, samples: int, places: float, share: float) -> FloatArray:
    """Amplitude (k,) in mm that noise exceeds with chance ``share`` at any of ``places``, at cycles ``per_mesh``."""
    density = np.interp(per_mesh, noise.frequency, noise.density)
    count = max(8.0, float(np.median(noise.count)))
    return 2.0 * np.sqrt(line_threshold(count, places=max(places, 1.0), share=share) * density / samples)


def _order_words(order: float, z_1: int, z_2: int) -> str:
    for value, name in ((order / z_1, "mesh"), (order, "driving"), (order * z_2 / z_1, "driven")):
        if abs(value - round(value)) < 0.02 and round(value) > 0:
            return f"{name} {round(value)}"
    return f"{order:.3f}"


Curves = list[tuple[FloatArray, FloatArray, FloatArray]]
"""Frequency, amplitude and threshold of each recording."""


def _name_peaks(axis: Any, curves: Curves, lines: list[tuple[float, float]], words: Callable[[float], str]) -> None:
    """Name the largest lines above their threshold, each place once."""
    last = max(float(x[-1]) for x, _, _ in curves)
    found = [(size, at) for at, size in lines if any(size > float(np.interp(at, x, limit)) for x, _, limit in curves)]
    for x, amplitude, limit in curves:
        inner = np.flatnonzero(
            (amplitude[1:-1] >= amplitude[:-2]) & (amplitude[1:-1] >= amplitude[2:]) & (amplitude[1:-1] > limit[1:-1])
        )
        found += [(float(amplitude[k + 1]), float(x[k + 1])) for k in inner[x[inner + 1] > 3.0 * x[1]]]
    named: list[float] = []
    for height, at in sorted(found, reverse=True):
        if len(named) < LABELLED and all(abs(at - other) > 0.06 * last for other in named):
            named.append(at)
            axis.annotate(words(at), (at, height), textcoords="offset points", xytext=(3, 4), fontsize=7)


def _bottom(axis: Any, curves: Curves, lines: list[tuple[float, float]]) -> None:
    """Cut the floor off: a tenth of the threshold is far inside the noise."""
    low = min(float(np.min(limit)) for _, _, limit in curves) / 10.0
    high = max([float(np.max(amplitude[1:])) for _, amplitude, _ in curves] + [size for _, size in lines]) * 2.0
    axis.set_ylim(low, max(high, 20.0 * low))
    axis.set_xlim(0.0, max(float(x[-1]) for x, _, _ in curves))
