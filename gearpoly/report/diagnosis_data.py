"""What the plots of a diagnosis' page draw: curves, spectra, maps and teeth, packed, in um and deg.

Curves go in whole as long as all recordings together are short enough; of longer ones each stretch is given by the
least and the greatest value in it, so that no peak is lost.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from gearpoly.compare.beside import Aligned
from gearpoly.compare.families import SHARES, line_threshold
from gearpoly.compare.maps import Maps, tooth_maps
from gearpoly.compare.noise import Noise
from gearpoly.compare.slow import slow_curves
from gearpoly.compare.spectrum import SPECTRUM_PLACES_PER_LINE, FrequencyGrid, sample_weights
from gearpoly.diagnose.verdict import BuiltGear, Diagnosis
from gearpoly.page.pack import nearly_even, packed, rounded_log, under_noise
from gearpoly.units import DEG, NM, RPM, UM, FloatArray

CURVE_VALUES = 60_000
"""Values per curve over all recordings: five curves and their angles are then 0.5 MB of text. Three recordings of
18 000 samples are shown sample by sample."""

SPECTRUM_PLACES = 36_000
"""Places per spectrum over all recordings: 0.1 MB with both spectra and the limit."""

MESH_ORDERS_ON_PAGE = 6.5
"""Mesh orders that a spectrum shows; what lies beyond is mostly the rest of steps."""

GAP_SPACINGS = 10.0
"""Middle spacings between samples from which a line would bridge what was not recorded."""


def document(diagnosis: Diagnosis) -> dict[str, Any]:
    """Everything that the page's scripts draw."""
    comparison = diagnosis.comparison
    aligned = comparison.aligned
    pair = comparison.assembled.pair
    z = (pair.driving.gear.z, pair.driven.gear.z)
    points = shares([one.theta_2.size for one in aligned], CURVE_VALUES)
    return {
        "z": z,
        "numbered": comparison.alignment.numbered,
        "noise_um": diagnosis.noise / UM,
        "recordings": [
            {
                "label": recording_label(k, one),
                "coast": one.flank == "coast",
                "noise_um": diagnosis.noise_by_recording[k] / UM,
                "curves": curves(one, left, points=points[k], noise=diagnosis.noise_by_recording[k]),
                "spectrum": spectra(
                    one, left, comparison.located.noises[k], z=z, points=SPECTRUM_PLACES // len(aligned)
                ),
                "maps": maps(one, left, comparison.located.noises[k], z=z),
            }
            for k, (one, left) in enumerate(zip(aligned, diagnosis.left, strict=True))
        ],
        "built": [built(gear, marked(diagnosis, k)) for k, gear in enumerate(diagnosis.built)],
    }


def recording_label(k: int, one: Aligned) -> str:
    """A recording's number, file and condition."""
    speed = "" if one.speed is None else f", {one.speed / RPM:.4g} rpm"
    return f"{k}: {one.cleaned.recording.source.name} ({one.ran}, {one.torque / NM:g} N·m{speed})"


def shares(sizes: list[int], budget: int) -> list[int]:
    """How many of its values each curve may keep when all together may keep ``budget``: short ones stay whole, the
    others share alike what is left."""
    out = [0] * len(sizes)
    left = budget
    for done, k in enumerate(sorted(range(len(sizes)), key=lambda k: sizes[k])):
        out[k] = min(sizes[k], left // (len(sizes) - done))
        left -= out[k]
    return out


def envelope(values: FloatArray, points: int, pack: Callable[[FloatArray], dict[str, Any]]) -> dict[str, Any]:
    """``values`` (n,) whole as ``low`` if they are at most ``points``, else the least and greatest of stretches."""
    starts = stretches(values.size, points)
    if starts is None:
        return {"low": pack(values), "high": None}
    return {"low": pack(np.minimum.reduceat(values, starts)), "high": pack(np.maximum.reduceat(values, starts))}


def stretches(size: int, points: int) -> np.ndarray[Any, np.dtype[np.int64]] | None:
    """Where each stretch of a curve of ``size`` values begins that keeps ``points`` of them, two per stretch; None
    where it is kept whole."""
    if size <= points:
        return None
    count = max(1, points // 2)
    return np.asarray(np.arange(count, dtype=np.int64) * size // count, dtype=np.int64)


def places(x: FloatArray, points: int) -> dict[str, Any]:
    """Places (n,), nearly even; of stretches their middles."""
    starts = stretches(x.size, points)
    if starts is not None:
        ends = np.append(starts[1:], x.size) - 1
        x = 0.5 * (x[starts] + x[ends])
    return nearly_even(x)


def curves(one: Aligned, left: FloatArray, *, points: int, noise: float) -> dict[str, Any]:
    """One recording over the driven angle: recorded, simulated before and after, and both residuals about their means.

    ``left`` (n,) in mm is what nothing explains of it; its ``noise`` in mm says how finely curves are given.
    """
    order = np.argsort(one.theta_2, kind="stable")
    x = one.theta_2[order] / DEG
    starts = stretches(x.size, points)
    means = float(np.mean(one.residual)) / UM, float(np.mean(left)) / UM
    shown = {
        "recorded": one.recorded / UM,
        "simulated_before": one.simulated / UM,
        "simulated_after": (one.recorded - left) / UM,
        "residual_before": one.residual / UM - means[0],
        "residual_after": left / UM - means[1],
    }
    spacing = float(np.median(np.diff(x)))
    fine = partial(under_noise, noise=noise / UM)
    return {
        "samples": int(x.size),
        "per_stretch": 1 if starts is None else round(x.size / starts.size, 1),
        "gap": GAP_SPACINGS * spacing * (1.0 if starts is None else x.size / starts.size),
        "x": places(x, points),
        "mean_before_um": means[0],
        "mean_after_um": means[1],
        **{name: envelope(values[order], points, fine) for name, values in shown.items()},
    }


def spectrum(u: FloatArray, values: FloatArray, *, top: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies (k,) in cycles per mesh up to ``top`` and amplitudes (k,) of the waves in ``values`` (n,) at ``u``
    (n,) meshes, through a Hann window: a strong line then does not spill over the others."""
    weight = window(u)
    step = 1.0 / (SPECTRUM_PLACES_PER_LINE * float(np.ptp(u)))
    grid = FrequencyGrid(u, step=step, count=max(2, int(top / step)))
    mean = float(np.sum(weight * values) / np.sum(weight))
    frequency: FloatArray = np.arange(grid.count, dtype=np.float64) * step
    return frequency, 2.0 * np.abs(grid.transform(weight * (values - mean))) / float(np.sum(weight))


def window(u: FloatArray) -> FloatArray:
    """Weights (n,) of a Hann window over ``u`` (n,), each sample counted by the stretch that it stands for."""
    return np.asarray(sample_weights(u) * np.sin(np.pi * (u - u[0]) / (u[-1] - u[0])) ** 2)


def spectra(one: Aligned, left: FloatArray, noise: Noise, *, z: tuple[int, int], points: int) -> dict[str, Any]:
    """``order_spectra``, packed."""
    orders, before, after, limit = order_spectra(one, left, noise, z=z)
    return {
        "x": places(orders, points),
        "before": envelope(before / UM, points, rounded_log),
        "after": envelope(after / UM, points, rounded_log),
        "limit": envelope(limit / UM, points, rounded_log),
    }


def order_spectra(
    one: Aligned, left: FloatArray, noise: Noise, *, z: tuple[int, int]
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Orders (k,) of the driving shaft, amplitudes (k,) in mm of both residuals there, and what noise alone exceeds in
    one of a hundred recordings or so."""
    order = np.argsort(one.theta_2, kind="stable")
    u = np.maximum.accumulate(one.theta_2[order] * (z[1] / (2.0 * np.pi)))
    top = min(MESH_ORDERS_ON_PAGE, 0.5 / float(np.median(np.diff(u))))
    frequency, before = spectrum(u, one.residual[order], top=top)
    _, after = spectrum(u, left[order], top=top)
    weight = window(u)
    samples = float(np.sum(weight)) ** 2 / float(np.sum(weight**2))
    density = np.interp(frequency, noise.frequency, noise.density)
    count = max(8.0, float(np.median(noise.count)))
    # The orders of both shafts are the places that were searched.
    z_limit = line_threshold(count, places=max(top * sum(z), 1.0), share=SHARES.orders)
    return frequency * z[0], before, after, 2.0 * np.sqrt(z_limit * density / samples)


def maps(one: Aligned, left: FloatArray, noise: Noise, *, z: tuple[int, int]) -> dict[str, Any]:
    """``tooth_residuals``, packed; on coast flanks the rows are the teeth whose coast flanks touch."""
    coast = one.flank == "coast"
    before, after = tooth_residuals(one, left, noise, z=z)
    return {
        "note": before.note,
        "before": _map(before, coast=coast),
        "after": _map(after, coast=coast),
    }


def tooth_residuals(one: Aligned, left: FloatArray, noise: Noise, *, z: tuple[int, int]) -> tuple[Maps, Maps]:
    """Both residuals by tooth and mesh phase for both gears, slow curves taken off.

    Cells run from half a pitch before a tooth's pitch point to half a pitch after it, so that what one tooth does
    stays in its own row.
    """
    # The coast flanks' pitch points pass half a pitch after the drive flanks', driving tooth n on driven n + 1.
    u = one.theta_2 * (z[1] / (2.0 * np.pi)) + (0.0 if one.flank == "coast" else 0.5)
    slow = slow_curves(one.theta_2)

    def parted(values: FloatArray) -> Maps:
        plain = values - slow @ np.linalg.lstsq(slow, values, rcond=None)[0]
        return tooth_maps(u, plain, z_1=z[0], z_2=z[1], noise=noise)

    return parted(one.residual), parted(left)


def _map(found: Maps, *, coast: bool) -> dict[str, Any]:
    return {
        "driving": packed(found.driving / UM, "f4"),
        "driven": packed(by_driven(found, coast=coast) / UM, "f4"),
        "mean": packed(found.mean / UM, "f4"),
        "std": [found.std_driving / UM, found.std_driven / UM],
    }


def by_driven(found: Maps, *, coast: bool) -> FloatArray:
    """The rows of the driven gear; a coast flank's tooth n meets driven tooth n + 1."""
    return np.asarray(np.roll(found.driven, 1 if coast else 0, axis=0))


def built(gear: BuiltGear, teeth: list[int]) -> dict[str, Any]:
    """One gear's teeth as they were built, in um: the drive flanks, or those that were recorded."""
    return {
        "pitch": packed(gear.first.pitch, "f8"),
        "pitch_std": packed(gear.first.pitch_std, "f8"),
        "slope": packed(gear.first.slope, "f8"),
        "slope_std": packed(gear.first.slope_std, "f8"),
        "marked": teeth,
    }


def marked(diagnosis: Diagnosis, gear: int) -> list[int]:
    """Teeth of ``gear`` at which something was found, as the plots count them."""
    places_ = [one.claim.place for one in diagnosis.findings]
    return sorted({place.tooth for place in places_ if place.gear == gear and place.tooth is not None})
