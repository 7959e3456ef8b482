"""Small recordings with one thing hidden in each, and the verdict on them as its JSON has it.

A recording is the simulator's transmission error of the true pair, what a case adds to it, and seeded noise. Nothing
here looks into the engine: ``told`` is the only road to it, so another engine is held to the same cases by that line.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

from gearpoly.assemble import Assembled, assemble
from gearpoly.diagnose.compare_as_built import compare_as_built
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Flank, Recording
from gearpoly.report.compare_report import json_text
from gearpoly.units import DEG, RPM, UM, FloatArray
from tests.made_recordings import te_of

Told = dict[str, Any]
Entry = dict[str, Any]
TURN = 2.0 * math.pi
ZEROS = (1.0, 2.0)
"""rad. True zero readings of both encoders."""
Z = (11, 13)
"""Teeth of the pair of most cases: a hunting cycle of 143 meshes, simulated in a second."""


def told(file: PairFile, *recordings: Recording) -> Told:
    """The verdict of a comparison, read back from its JSON."""
    return dict(json.loads(json_text(compare_as_built(file, recordings, path="pair.toml"))))


def pair(
    z: tuple[int, int] = Z,
    *,
    pitch_um: tuple[FloatArray | None, FloatArray | None] = (None, None),
    grade: int | None = None,
    uncertainty_um: float = 0.2,
    bends: bool = False,
    driving: dict[str, Any] | None = None,
    driven: dict[str, Any] | None = None,
    points: int = 150,
    module_mm: float = 2.0,
    measurement: dict[str, Any] | None = None,
) -> PairFile:
    """A pair of inspected gears, or of graded ones, with further keys; rigid teeth unless it ``bends``."""

    def one(teeth: int, pitch: FloatArray | None, more: dict[str, Any] | None) -> dict[str, Any]:
        out: dict[str, Any] = {
            "teeth": teeth, "module_mm": module_mm, "face_width_mm": 20.0, "points_per_flank": points,
        }  # fmt: skip
        if grade is not None:
            out["grade"] = grade
        else:
            sheet: dict[str, Any] = {"tooth_thickness_um": -60.0, "uncertainty_um": uncertainty_um}
            if pitch is not None:
                sheet["pitch_um"] = pitch.round(4).tolist()
            out["inspection"] = sheet
        more = dict(more or {})
        out["inspection"] = {**out.get("inspection", {}), **more.pop("inspection", {})}
        if not out["inspection"]:
            del out["inspection"]
        return out | more

    return PairFile.model_validate(
        {
            "pair": {},
            "model": {"tooth_deflection": bends},
            "driving": one(z[0], pitch_um[0], driving),
            "driven": one(z[1], pitch_um[1], driven),
            **({} if measurement is None else {"measurement": measurement}),
        }
    )


def pitches(seed: int, z: tuple[int, int] = Z, *, scatter_um: float = 2.0) -> tuple[FloatArray, FloatArray]:
    """Index deviations in um of both gears, which tell every tooth from every other."""
    rng = np.random.default_rng(seed)
    first, second = (rng.normal(0.0, scatter_um, teeth) for teeth in z)
    return first, second


def drawn(file: PairFile, seed: int = 0) -> Assembled:
    """The true pair of a file; what a grade leaves open is drawn."""
    return assemble(file, path="pair.toml", seed=seed)


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """Where the pair stands at each sample: ``time`` in s, ``driving`` and ``driven`` turns and ``meshes`` since the
    angle zero, and ``part`` of the recording, 0 to 1, all (n,)."""

    time: FloatArray
    driving: FloatArray
    driven: FloatArray
    meshes: FloatArray
    part: FloatArray


Added = Callable[[Motion], FloatArray]
"""What is added to the transmission error, (n,) in um along the line of action."""


def noise_um(seed: int, n: int, size: float, *, correlation: float = 0.0) -> FloatArray:
    """Gaussian noise (n,) of rms ``size``, white or with this correlation from sample to sample."""
    white = np.random.default_rng(seed).normal(0.0, size, n + 500)
    return np.asarray(lfilter([math.sqrt(1.0 - correlation**2)], [1.0, -correlation], white)[500:])


def wandering(seed: int, um: float) -> Added:
    """A random walk that forgets within 2000 samples, of rms ``um``: what rigs and their rooms do."""

    def made(m: Motion) -> FloatArray:
        white = np.random.default_rng(seed).normal(size=m.part.size + 8000)
        walk = np.asarray(lfilter([1.0], [1.0, -0.9995], white)[8000:])
        return np.asarray(um * math.sqrt(1.0 - 0.9995**2) * walk)

    return made


@cache
def _mesh(true: Assembled, n: int, begin: float, span: float, jitter: float, seed: int, flank: Flank, torque: float,
          wobble: float) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Driven rotation (n,) in rad at samples even but for their ``jitter``, and the true transmission error in rad."""
    rng = np.random.default_rng(seed + 7000)
    place = (np.arange(n) + jitter * rng.uniform(-1.0, 1.0, n)) / n
    turns = begin / TURN + place * span / TURN
    # A percent once a turn, and half a percent more slowly, so that what is fixed in time is not fixed to a shaft.
    turns = turns + wobble / TURN * np.sin(TURN * turns + 0.3)
    turns = turns + 0.5 * wobble / (TURN * 0.13) * np.sin(TURN * 0.13 * turns + 1.1)
    theta_2 = TURN * turns
    return theta_2, te_of(true, theta_2, flank=flank, torque_nm=torque)


def recorded(
    true: Assembled,
    *,
    seed: int = 1,
    meshes: float | None = None,
    cycles: float = 2.01,
    per_mesh: float = 12.0,
    noise: float = 0.3,
    correlation: float = 0.0,
    added: Added | None = None,
    jitter: float = 0.3,
    wobble: float = 0.01,
    rpm: float = 30.0,
    begin: float = 0.37,
    flank: Flank = "drive",
    torque_nm: float = 0.0,
    zeros: tuple[float, float] = ZEROS,
    directions: tuple[int, int] = (1, 1),
    stated: tuple[float | None, float | None] | None = ZEROS,
    wrapped: bool = True,
    only: str = "",
    timed: bool = True,
    name: str = "rec.csv",
) -> Recording:
    """One recording of ``cycles`` hunting cycles, or so many ``meshes``, from ``begin`` turns of the driven shaft on.

    ``noise`` in um rms; ``stated`` zeros in rad; ``only``: the one shaft whose angle is kept, beside the transmission
    error; ``timed``: the times are recorded too.
    """
    p = true.pair
    z_1, z_2 = p.driving.gear.z, p.driven.gear.z
    many = p.meshes_per_cycle * cycles if meshes is None else meshes
    n = round(many * per_mesh)
    theta_2, te = _mesh(true, n, TURN * begin, many * TURN / z_2, jitter, seed, flank, torque_nm, wobble)
    part = (np.arange(n) + 0.5) / n
    if jitter:
        part = part + jitter / n * np.random.default_rng(seed + 7000).uniform(-1.0, 1.0, n)
    time = part * many / z_1 / (rpm * RPM / TURN)
    theta_1 = theta_2 / p.ratio
    more = noise_um(seed, n, noise, correlation=correlation)
    if added is not None:
        driven = theta_2 / TURN
        more = more + added(Motion(time=time, driving=theta_1 / TURN, driven=driven, meshes=driven * z_2, part=part))
    te = te + more * UM / p.r_b2
    theta_1 = (theta_2 - te) / p.ratio
    first, second = (zero + way * angle for zero, way, angle in zip(zeros, directions, (theta_1, theta_2), strict=True))
    if wrapped:
        first, second = np.mod(first, TURN), np.mod(second, TURN)
    given = (None, None) if stated is None else stated
    return Recording(
        source=Path(name),
        time_s=time if timed else None,
        driving_angle_rad=None if only == "driven" else first,
        driven_angle_rad=None if only == "driving" else second,
        te_mm=te * p.r_b2 if only else None,
        torque_nm=torque_nm,
        speed_rpm=rpm if timed else None,
        flank=flank,
        driving_zero_rad=given[0],
        driven_zero_rad=given[1],
        driving_direction=1 if directions[0] > 0 else -1,
        driven_direction=1 if directions[1] > 0 else -1,
    )


def off_deg(reading_deg: float | None, true_rad: float, *, every: float = 360.0) -> float:
    """How far a reading in deg lies from the true one in rad, in deg, but for whole multiples of ``every``."""
    assert reading_deg is not None
    return math.remainder(reading_deg - true_rad / DEG, every)


def zero_errors(found: Told, zeros: tuple[float, float] = ZEROS) -> tuple[float, float]:
    """Errors in deg of both zeros of a verdict."""
    alignment = found["alignment"]
    return off_deg(alignment["driving_zero_deg"], zeros[0]), off_deg(alignment["driven_zero_deg"], zeros[1])


def standing(found: Told) -> list[Entry]:
    """What a verdict locates, without what it marks as coming along with another entry or as within the tolerance."""
    return [e for e in found["where"] if not e.get("companion_of") and not e.get("as_built")]


def moments(found: Told) -> list[Entry]:
    """Steps: what changes at one moment and stays."""
    return [e for e in standing(found) if e["kind"] == "step" or e.get("label") == "jump"]


def bursts(found: Told) -> list[Entry]:
    """What shakes for a while and never again."""
    return [e for e in standing(found) if e["kind"] == "burst" or "during_s" in e or "during_turns" in e]


def drifts(found: Told) -> list[Entry]:
    """Slow courses over the whole recording."""
    return [e for e in standing(found) if e["kind"] == "drift" or (e.get("hz") == 0.0 and e not in moments(found))]


def teeth(found: Told, gear: str | None = None) -> list[Entry]:
    """Single teeth, of one gear or of both."""
    kinds = ("tooth", "tooth_curve")
    return [e for e in standing(found) if e["kind"] in kinds and gear in (None, e.get("gear"))]


def waves(found: Told, *, z: tuple[int, int] = Z, rpm: float = 30.0) -> list[tuple[float, Entry]]:
    """Waves with their cycles per driving turn: orders of either shaft and of the mesh, and tones at the mean speed."""
    out = []
    loud = bursts(found)
    for e in standing(found):
        if e in loud:
            continue
        if e.get("hz"):
            out.append((e["hz"] * 60.0 / rpm, e))
        elif e.get("order"):
            per = {"mesh_order": float(z[0]), "mesh_curve": float(z[0])}.get(e["kind"])
            if per is None:
                per = z[0] / z[1] if e.get("gear") == "driven" else 1.0
            out.append((e["order"] * per, e))
    return out


def at(found: Told, cycles: float, *, within: float, z: tuple[int, int] = Z, rpm: float = 30.0) -> list[Entry]:
    """Waves of ``cycles`` per driving turn, to ``within`` of them."""
    return [e for place, e in waves(found, z=z, rpm=rpm) if abs(place - cycles) < within]


def whole(entry: Entry, gear: str, order: int) -> bool:
    """Whether an entry is this whole order of this shaft."""
    return entry["kind"] == "shaft_order" and entry.get("gear") == gear and entry["order"] == order


def says(found: Told, *words: str) -> bool:
    """Whether one remark, or what was done to a recording, has all of these words in it."""
    lines = list(found.get("remarks", []))
    for one in found.get("recordings", []):
        lines += one.get("done", [])
    return any(all(word in line for word in words) for line in lines)
