"""Files that owners write: columns other than the bench's own, in the contract's names."""

from __future__ import annotations

import numpy as np

from gearpoly.proving.chain import ZERO_STD, Chain, Motion, RecordedCondition, noise, te
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray
from gearpoly.proving.rig import Rig

Table = dict[str, tuple[FloatArray, str]]
"""Column name: values and their format."""


def heading(condition: RecordedCondition, chain: Chain, rng: np.random.Generator) -> list[str]:
    """Comment lines: the condition, and zeros read by eye where the chain has them."""
    head = [
        f"# torque_nm = {condition.torque:g}", f"# speed_rpm = {condition.speed:g}",
        f'# flank = "{condition.flank}"',
    ]  # fmt: skip
    if chain.known:
        rough = [(z + e) % 360.0 for z, e in zip(chain.zeros_deg, rng.normal(0, ZERO_STD, 2), strict=True)]
        head += [f"# driving_zero_deg = {rough[0]:.3f}", f"# driven_zero_deg = {rough[1]:.3f}"]
    return head


def text(head: list[str], table: Table) -> str:
    """A CSV with its comment lines."""
    line = ",".join(form for _, form in table.values())
    rows = [line % row for row in zip(*(values.tolist() for values, _ in table.values()), strict=True)]
    return "\n".join([*head, ",".join(table), *rows]) + "\n"


def angles(
    rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Both readings in deg, noise and encoder errors in them and counts not yet."""
    r_1, r_2 = rig.pair.driving.r_b, rig.pair.driven.r_b
    lies = noise(chain, path.time.size, rng)
    x = te(rig, condition, path) + lies
    theta_2 = path.theta_2 + rig.encoder_2.error(path.theta_2) + 0.5 * lies / r_2
    theta_1 = (r_2 * theta_2 - x) / r_1
    one, two = (
        zero + direction * theta / RAD_PER_DEG
        for zero, direction, theta in zip(chain.zeros_deg, chain.directions, (theta_1, theta_2), strict=True)
    )
    return one, two


def both_angles(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
    """Times and both angles, rounded to counts."""
    return text(heading(condition, chain, rng), angle_table(rig, condition, chain, path, rng))


def angle_table(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> Table:
    """Its columns."""
    readings = angles(rig, condition, chain, path, rng)
    one, two = (
        np.round(values / step) * step if step else values
        for values, step in zip(readings, chain.steps_deg, strict=True)
    )
    return {
        "time_s": (path.time, "%.6f"), "driving_angle_deg": (one, "%.8f"), "driven_angle_deg": (two, "%.8f"),
    }  # fmt: skip


def te_table(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> Table:
    """Times, the driven angle without noise, and the transmission error in um, as a rig states it that computed it."""
    x = te(rig, condition, path) + noise(chain, path.time.size, rng)
    two = chain.zeros_deg[1] + path.theta_2 / RAD_PER_DEG
    return {"time_s": (path.time, "%.6f"), "driven_angle_deg": (two, "%.8f"), "te_um": (x / MM_PER_UM, "%.5f")}
