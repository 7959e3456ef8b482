"""The proving ground: from a seed alone, the list of concealed cases, and each case written with its truth apart.

A case depends on (seed, index) only, so any number of workers in any order writes the same bytes."""

from __future__ import annotations

import numpy as np

from gearpoly.proving.entry import CaseEntry

SIZES_OVER_LIMIT = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 8.5, 10.0, 14.0, 20.0, 30.0)
"""From half to thirty times the theoretical limit; each case moves its own by up to 12 %."""

BENCH_CASES_BY_CLASS = {
    "healthy": 80, "single": 88, "two": 22, "masked": 20, "cancelling": 8, "one_flank": 12, "look_alike": 22,
    "beside": 24, "stranger": 24, "short": 14, "smallest": 12, "false_alarm": 152,
}  # fmt: skip
"""Cases of the full ground by class. All but the last are the mix (a quarter of it healthy); the last brings the
healthy ones beneath 60 um of eccentricity and in coloured noise to 200.

A quarter of the class healthy has a background too, fainter than its own limit."""

QUICK_CASES_BY_CLASS = {
    "healthy": 3, "single": 4, "two": 1, "masked": 1, "cancelling": 1, "one_flank": 1, "look_alike": 1, "beside": 1,
    "stranger": 1, "short": 1, "smallest": 1,
}  # fmt: skip
"""The same classes for everyday use: 16 cases."""

CLASS_WORDS = {"stranger": "outside"}
"""What tables call a class whose key says less than the word; keys stay, since scoreboards hold them."""

BENCH_CONCEALED_BY = {
    "healthy": "nothing is hidden",
    "single": "beneath the noise per sample",
    "two": "each by the other",
    "masked": "by something larger",
    "cancelling": "by each other at the design torque",
    "one_flank": "on one flank, or told by the other only",
    "look_alike": "by its likeness to something else",
    "beside": "a background that nobody declares: hum, a bearing's line, or both",
    "stranger": "outside the catalogue",
    "short": "in less than two hunting cycles",
    "smallest": "by being small: the least tooth pitch error and order line",
    "false_alarm": "nothing is hidden under 60 um of eccentricity",
}
"""What conceals the effects of a class."""

SINGLE = (
    "eccentricity", "cumulative_pitch", "tooth_pitch", "profile_slope", "profile_crowning", "tip_relief",
    "undulation", "wear",
    "tooth_spall", "tooth_crack", "tooth_deflection", "misalignment", "friction", "centre_distance", "tooth_thickness",
    "shaft_windup", "mesh_resonance", "thermal_drift", "encoder_eccentricity", "encoder_interpolation", "encoder_scale",
)  # fmt: skip
"""What the class single conceals, in turn. The 478 cases are never changed: a physics that is added to the bench later
stands in the real-life ground."""
MASKED = ("relief_under_eccentricity", "crack_under_pitch", "spall_under_pitch")
ONE_FLANK = (
    "tooth_thickness", "tooth_spall", "eccentricity", "encoder_eccentricity", "centre_distance", "cumulative_pitch",
)  # fmt: skip
LOOK_ALIKES = (
    "eccentricity", "encoder_eccentricity", "profile_slope", "wear", "undulation", "centre_distance",
    "cumulative_pitch", "encoder_interpolation", "encoder_scale", "profile_crowning", "thermal_drift",
    "tooth_thickness", "shaft_windup", "tooth_crack",
)  # fmt: skip
SMALLEST = ("tooth_pitch", "undulation")
TWO = (
    ("eccentricity", "tooth_spall"), ("tip_relief", "tooth_pitch"), ("undulation", "eccentricity"),
    ("encoder_interpolation", "tooth_pitch"), ("tooth_crack", "shaft_windup"), ("thermal_drift", "cumulative_pitch"),
    ("friction", "tooth_crack"), ("profile_crowning", "undulation"), ("wear", "encoder_interpolation"),
    ("profile_slope", "eccentricity"), ("misalignment", "tooth_pitch"), ("tooth_spall", "undulation"),
)  # fmt: skip
PHYSICS_BESIDE_BACKGROUND = (
    "tooth_pitch", "tooth_spall", "eccentricity", "tip_relief", "undulation", "tooth_crack", "cumulative_pitch",
    "profile_slope", "friction", "wear", "encoder_eccentricity", "profile_crowning",
)  # fmt: skip
PHYSICS_OF_SHORT_CLASS = (
    "healthy", "eccentricity", "tooth_pitch", "undulation", "healthy", "tooth_spall", "profile_slope",
    "cumulative_pitch",
)  # fmt: skip


def _concealed(klass: str, v: int) -> tuple[tuple[str, ...], float]:
    """What the case v of a class conceals, and its size over the limit (0: fixed)."""
    steps = len(SIZES_OVER_LIMIT)
    if klass in ("healthy", "false_alarm"):
        return (), 0.0
    if klass == "single":
        lap = v // len(SINGLE)
        return (SINGLE[v % len(SINGLE)],), SIZES_OVER_LIMIT[(5 * v + 4 * lap) % steps]
    if klass == "two":
        return TWO[v % len(TWO)], (7.0, 10.0, 14.0, 20.0, 30.0)[v % 5]
    if klass == "masked":
        return (MASKED[v % len(MASKED)],), 0.0
    if klass == "cancelling":
        return ("relief_cancels_deflection",), 0.0
    if klass == "smallest":
        return (SMALLEST[v % len(SMALLEST)],), 0.0
    if klass == "one_flank":
        return (ONE_FLANK[v % len(ONE_FLANK)],), (3.0, 5.0, 10.0, 20.0)[v % 4]
    if klass == "look_alike":
        return (LOOK_ALIKES[v % len(LOOK_ALIKES)],), (8.0, 12.0, 18.0, 25.0)[(v + v // len(LOOK_ALIKES)) % 4]
    if klass == "beside":
        return (PHYSICS_BESIDE_BACKGROUND[v % len(PHYSICS_BESIDE_BACKGROUND)],), (8.5, 10.0, 14.0, 20.0, 30.0)[v % 5]
    if klass == "stranger":
        return ("disturbance",), (5.0, 8.0, 14.0, 25.0, 30.0)[(v + v // 5) % 5]
    what = PHYSICS_OF_SHORT_CLASS[v % len(PHYSICS_OF_SHORT_CLASS)]
    if what == "healthy":
        return (), 0.0
    return (what,), max(SIZES_OVER_LIMIT[(5 * v + v // steps) % steps], 3.0)


def plan(seed: int, *, quick: bool = False) -> list[CaseEntry]:
    """All cases of a ground, in an order that tells nothing (the block of further healthy cases comes last)."""
    rng = np.random.default_rng([seed, 0x9A0])
    turn = int(rng.integers(1000)) if quick else 0  # so that quick grounds of other seeds show other physics
    rows: list[tuple[str, tuple[str, ...], float, int]] = []
    tail: list[tuple[str, tuple[str, ...], float, int]] = []
    for klass, count in (QUICK_CASES_BY_CLASS if quick else BENCH_CASES_BY_CLASS).items():
        for v in range(turn, turn + count):
            physics, over = _concealed(klass, v)
            (tail if klass == "false_alarm" else rows).append((klass, physics, over, v))
    order = rng.permutation(len(rows))
    mixed = [rows[k] for k in order] + tail
    return [
        CaseEntry(index=i, klass=klass, physics=physics, over=over, variant=variant, quick=quick)
        for i, (klass, physics, over, variant) in enumerate(mixed)
    ]


def counts() -> str:
    """Cases of every class as a table in Markdown, the full ground beside the quick one."""
    lines = ["| class | what conceals it | cases | quick | what is concealed |", "| --- | --- | --- | --- | --- |"]
    kinds = {
        "single": ("every physics of the catalogue",), "two": tuple(" and ".join(two) for two in TWO), "masked": MASKED,
        "cancelling": ("deflection and both reliefs",), "one_flank": ONE_FLANK, "look_alike": LOOK_ALIKES,
        "beside": PHYSICS_BESIDE_BACKGROUND,
        "stranger": ("a bearing's order", "hum", "a jump", "a pulse", "a wave that swells"),
        "short": tuple(dict.fromkeys(PHYSICS_OF_SHORT_CLASS)), "smallest": SMALLEST,
    }  # fmt: skip
    for klass, count in BENCH_CASES_BY_CLASS.items():
        what = ", ".join(kinds.get(klass, ("nothing",))).replace("_", " ")
        lines.append(
            f"| {CLASS_WORDS.get(klass, klass)} | {BENCH_CONCEALED_BY[klass]} "
            f"| {count} | {QUICK_CASES_BY_CLASS.get(klass, 0)} | {what} |"
        )
    lines.append(f"| all | | {sum(BENCH_CASES_BY_CLASS.values())} | {sum(QUICK_CASES_BY_CLASS.values())} | |")
    return "\n".join(lines)
