"""The small recordings in ``data/recordings``: ``python -m gearpoly.proving.samples --out data/recordings`` makes them
again.

Five set-ups, each a folder with what an engineer declares and what a rig recorded; what is hidden stands beside it in
NAME.truth.json, as `gearpoly prove --on` reads it. Sizes are chosen here, once, and not fitted to what the diagnosis
finds."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.proving.chain import Chain, RecordedCondition, motion, record
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import GearAsStated, draw, make_pair, pair_file
from gearpoly.proving.effects import Effect, apply, truth
from gearpoly.proving.reliefs import cancelling
from gearpoly.proving.rig import Rig
from gearpoly.proving.scenes import cycle_turns, design_torque

SAMPLE_NOISE_UM = 0.3
"""um rms per sample: two good encoders."""
COUNT_DEG = 1e-5
"""deg, one count of either encoder and the last digit of a file: 4 nm at the base circle of the larger gear, 47 mm, a
hundredth of the noise."""
RECORDED_SAMPLES_PER_MESH = 8
"""Samples per mesh: three mesh harmonics show, and two hunting cycles of 18/25 stay below 0.25 MB."""
GAUGE_STD_UM = 0.2
"""um, standard uncertainty of the inspection that is declared."""
THICKNESS = -60.0
"""um, tooth thickness deviation of all teeth, so that the pair has backlash."""


@dataclass(frozen=True, kw_only=True)
class SampleSetUp:
    """One set-up: name of its folder and title of its pair file, pair and grade, torques (N.m) and flanks recorded, and
    what is hidden in it, of a rig as it is declared."""

    name: str
    title: str
    pair: str
    grade: int
    conditions: tuple[tuple[float, str], ...]
    hidden: Callable[[Rig, float], list[Effect]]
    hides: str


def _nothing(rig: Rig, torque: float) -> list[Effect]:
    return []


def _eccentric_and_low(rig: Rig, torque: float) -> list[Effect]:
    return [
        Effect(physics="eccentricity", gear=2, size=9.0, more={"angle_deg": 130.0}),
        Effect(physics="tooth_pitch", gear=2, size=-6.0, more={"tooth": 11}),
    ]


def _relief_and_deflection(rig: Rig, torque: float) -> list[Effect]:
    return [Effect(physics="tooth_deflection"), *cancelling(replace(rig, deflect=True), torque)]


def _encoder(rig: Rig, torque: float) -> list[Effect]:
    return [Effect(physics="encoder_eccentricity", gear=1, size=400.0, more={"angle_deg": 75.0})]


def _stranger(rig: Rig, torque: float) -> list[Effect]:
    wave = Disturbance(kind="line", amplitude=1.0, gear=1, order=4.41, phase=1.0)
    return [Effect(physics="disturbance", size=1.2, more={"shape": wave})]


LIGHT_TORQUE_NM = 0.5
"""N.m that keep flanks in touch and bend no tooth by more than a few nm."""
FULL_TORQUE_NM = round(design_torque(make_pair("24/36 m1")), 1)

SAMPLE_SET_UPS = (
    SampleSetUp(
        name="healthy", title="healthy pair", pair="18/25 m2", grade=6, conditions=((LIGHT_TORQUE_NM, "drive"),),
        hidden=_nothing, hides="nothing is hidden",
    ),
    SampleSetUp(
        name="eccentric_low_tooth", title="eccentric gear with a low tooth", pair="18/25 m2", grade=6,
        conditions=((LIGHT_TORQUE_NM, "drive"), (LIGHT_TORQUE_NM, "coast")), hidden=_eccentric_and_low,
        hides="index deviations of the same order, as large",
    ),
    SampleSetUp(
        name="relief_and_deflection", title="relief that takes up deflection", pair="24/36 m1", grade=5,
        conditions=tuple((round(part * FULL_TORQUE_NM, 2), "drive") for part in (0.02, 0.5, 1.0)),
        hidden=_relief_and_deflection, hides="each other: at the highest torque the mesh ripple nearly vanishes",
    ),
    SampleSetUp(
        name="encoder_off_centre", title="encoder off centre", pair="24/36 m1", grade=6,
        conditions=((LIGHT_TORQUE_NM, "drive"), (LIGHT_TORQUE_NM, "coast")), hidden=_encoder,
        hides="its likeness to an eccentric gear: only the coast flank tells them apart",
    ),
    SampleSetUp(
        name="unknown", title="something unknown", pair="18/25 m2", grade=6, conditions=((LIGHT_TORQUE_NM, "drive"),),
        hidden=_stranger, hides="no part of a gear pair makes this order",
    ),
)  # fmt: skip


def files(sample: SampleSetUp) -> Iterator[tuple[str, str]]:
    """Paths, relative to the folder of all samples, and texts: pair file, recordings, truth."""
    rng = np.random.default_rng([35, *sample.name.encode()])  # each its own, whatever stands beside it
    pair = make_pair(sample.pair)
    teeth = [draw(pair.gear(index), sample.grade, THICKNESS, rng) for index in (1, 2)]
    declared = Rig(pair=pair, teeth_1=teeth[0], teeth_2=teeth[1])
    top = max(torque for torque, _ in sample.conditions)
    effects = sample.hidden(declared, top)
    rig = declared
    for effect in effects:
        rig = apply(rig, effect)
    chain = Chain(
        noise_um=SAMPLE_NOISE_UM,
        zeros_deg=(float(rng.uniform(0, 360)), float(rng.uniform(0, 360))),
        steps_deg=(COUNT_DEG, COUNT_DEG),
        decimals=5,
        wrapped=True,
    )
    conditions = tuple(
        RecordedCondition(torque=torque, flank=flank, turns=cycle_turns(pair, 2.0), per_mesh=RECORDED_SAMPLES_PER_MESH)
        for torque, flank in sample.conditions
    )
    known = GearAsStated(grade=sample.grade, inspected=True, uncertainty=GAUGE_STD_UM, E_s=THICKNESS)
    yield (
        f"{sample.name}/pair.toml",
        pair_file(
            pair, (teeth[0], teeth[1]), (known, known), torque=top, speed=conditions[0].speed, deflect=False, rng=rng,
            name=sample.title,
        ),
    )  # fmt: skip
    for k, condition in enumerate(conditions):
        yield f"{sample.name}/rec_{k}.csv", record(rig, condition, chain, motion(rig, condition, rng), rng)
    unknown = any(effect.physics == "disturbance" for effect in effects)
    told: dict[str, Any] = {
        "kind": "unknown" if unknown else "missing" if effects else "none",
        "truth": [truth(rig, effect, chain, conditions) for effect in effects],
        "concealed_by": sample.hides,
        "noise_um": SAMPLE_NOISE_UM,
        "recordings": len(conditions),
    }
    yield f"{sample.name}.truth.json", json.dumps(told, indent=1) + "\n"


def write(folder: Path) -> None:
    """Write all samples under folder."""
    for sample in SAMPLE_SET_UPS:
        for name, text in files(sample):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(text.encode())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write the sample recordings.")
    parser.add_argument("--out", type=Path, default=Path("data/recordings"))
    write(parser.parse_args().out)
