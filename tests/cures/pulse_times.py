"""Refusals of files of pulse times, and the maps that read them."""

from __future__ import annotations

import numpy as np

from tests.cures.cure import Cure, text

FIRST = np.arange(1, 900) * 0.01 + 1e-4 * np.sin(np.arange(1, 900))
SECOND = np.arange(1, 640) * 0.01 / 0.72
NAMES = ("t_A [s]", "t_B [s]")


def columns(first: np.ndarray = FIRST) -> str:
    rows = [f"{t:.6f}," + (f"{SECOND[k]:.6f}" if k < SECOND.size else "") for k, t in enumerate(first)]
    return "\n".join([",".join(NAMES), *rows, ""])


EVENTS = sorted([(t, 1) for t in FIRST] + [(t, 2) for t in SECOND])
ROWS = "\n".join(["t [s],ch", *(f"{t:.6f},{ch}" for t, ch in EVENTS), ""])
FALLS = FIRST.copy()
FALLS[300] = FALLS[298]
GIVEN = "".join(
    f'columns.{shaft}_pulse_s = {{ from = "{name}", unit = "s" }}\n'
    for shaft, name in zip(("driving", "driven"), NAMES, strict=True)
)
LINES = "keys.driving_lines = 100\nkeys.driven_lines = 100\n"
ONE = 'columns.pulse_time_s = { from = "t [s]", unit = "s" }\n'
CHANNEL = 'columns.pulse_channel = {{ from = "ch", zero = {} }}\n'.format


def mapped(name: str, says: str, content: str, chart: str, cured: str, *, good: str | None = None) -> Cure:
    return text(name, says, content, good, file="log.txt", chart=chart, cured=cured)


CURES = [
    text("pulse times", 'keys.driving_lines = "those on its label"', columns(), file="log.txt", cured=GIVEN + LINES),
    mapped("pulses of a turn", "such as keys.driving_lines = 100 in a map", columns(), GIVEN, GIVEN + LINES),
    mapped(
        "one shaft's pulses",
        "want columns.driven_pulse_s",
        columns(),
        GIVEN.splitlines()[0] + "\n" + LINES,
        GIVEN + LINES,
    ),
    mapped("no channel", "want columns.pulse_channel in the map too", ROWS, ONE + LINES, ONE + CHANNEL(1) + LINES),
    mapped("another channel", "one of them 0", ROWS, ONE + CHANNEL(3) + LINES, ONE + CHANNEL(2) + LINES),
    mapped(
        "few pulses", "want at least 50", columns(FIRST[:20]).rsplit("\n", 1)[0] + "\n", GIVEN + LINES, GIVEN + LINES,
        good=columns(),
    ),
    mapped(
        "pulses that fall", "want times that rise from pulse to pulse", columns(FALLS), GIVEN + LINES, GIVEN + LINES,
        good=columns(),
    ),
]  # fmt: skip
