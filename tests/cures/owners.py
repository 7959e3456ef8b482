"""Refusals of owners' further files: curves of periodic error, columns that touch, counts that go round, and channels
that begin apart."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.keys.sections import WormSection
from tests.cures.cure import Cure, by_its_lines, text
from tests.cures.formats import h5, written
from tests.made_guide_log import EQ6
from tests.made_texts import run, table

RUN = run(700)
RUN_NAMES = tuple(RUN)
ROWS = 479
ERROR = 5.0 * np.cos(2.0 * np.pi * np.arange(ROWS) / ROWS)
LINES = [f"{k} {int(k * 50133 / ROWS)} {error:.4f}" for k, error in enumerate(ERROR)]
CURVE = "\n".join(["# EQMOD", "!WormPeriod=479", "!StepsPerWorm=50133", *LINES]) + "\n"


def curve(name: str, says: str, bad: str, **more: Any) -> Cure:
    return text(name, says, bad, CURVE, file="pec.txt", worm=EQ6, **more)


SIGN = 'columns.axis_error_arcsec = { from = "PE [arcsec]", unit = "arcsec", sign = 1 }\n'
ERRORS = table([np.arange(ROWS) / 3.6e3, ERROR], ("hours away", "PE [arcsec]"), separator=",", decimal=".")

TOUCH = f"{'Time [s]':>8} {'driving_angle_deg'} {'driven_angle_deg'}\n" + "".join(
    f"{t:6.3f}{10_000.0 + 180.0 * t:9.3f}{10_000.0 + 129.6 * t:9.3f}\n" for t in RUN["time_s"]
)
WIDE = "text.widths = [6, 9, 9]\n"

COUNTS = table(
    [RUN["time_s"], *(np.floor(RUN[one] / 360.0 * 65536) for one in RUN_NAMES[1:3])],
    ("t [s]", "in", "out"), separator=",", decimal=".", digits=(4, 0, 0),
)  # fmt: skip
OF_TURNS = ", ".join(('unit = "rev"', "scale = 1.52587890625e-05", "wraps = 65536"))


COUNTED = COUNTS.replace("t [s],in,out", "time_s,driving_angle_deg,driven_angle_deg")


def beside(names: tuple[str, str]) -> str:
    """A run's time and both angles under ``names``."""
    held = [RUN[one] for one in RUN_NAMES[:3]]
    return table(held, ("Time [s]", *names), separator=",", decimal=".")


def counted(form: str) -> str:
    return "".join(
        f'columns.{column} = {{ from = "{name}", {form} }}\n'
        for column, name in zip(RUN_NAMES[1:3], ("in", "out"), strict=True)
    )


def channels(begins: tuple[str, str]) -> Callable[[Path], None]:
    """A group for each angle, with its own start and step."""

    def fill(root: Any) -> None:
        for name in list(root):
            del root[name]
        for name, begin, column in zip(("Angle In", "Angle Out"), begins, RUN_NAMES[1:3], strict=True):
            root[f"{name}/data"] = RUN[column]
            root[name].attrs.update(unit="deg", dt=0.01, start_time=begin)

    return h5(fill)


OWN_COUNTS = "".join(f'columns.{column} = {{ from = "{column}", {OF_TURNS} }}\n' for column in RUN_NAMES[1:3])


TURNED = 6.0 * 30.0 * np.arange(4000) / 50.0
WAVES = np.degrees(4e-5 * np.sin(np.radians(TURNED)))
QUICK_FROM = (("driving_angle_deg", "Input angle [rev]"), ("driven_angle_deg", "Output angle [rev]"))
QUICK = table(
    [np.arange(4000) / 50.0, TURNED, 0.72 * TURNED + WAVES], ("t [s]", *(name for _, name in QUICK_FROM)),
    separator=",", decimal=".",
)  # fmt: skip


CURES = [
    text(
        "two runs side by side",
        "Run 1 input angle [deg], Run 1 output angle [deg]",
        beside(("Run 1 [deg]", "Run 2 [deg]")),
        beside(("Run 1 input angle [deg]", "Run 1 output angle [deg]")),
    ),
    text(
        "a double-flank test",
        "want a single-flank test: both shafts' angles",
        beside(("Input angle [deg]", "Fi'' [um]")),
        beside(("Input angle [deg]", "Output angle [deg]")),
    ),
    text(
        "one shaft alone",
        "want the readings of both shafts",
        "\n".join(row.rpartition(",")[0] for row in beside(("angle [deg]", "x")).splitlines()) + "\n",
        beside(("Input angle [deg]", "Output angle [deg]")),
    ),
    by_its_lines(
        "an angle and a length",
        'columns.te_um = { from = "a_um", unit = "um", sign = 1 }',
        beside(("Input angle [deg]", "a_um")),
    ),
    text(
        "degrees under a header of turns",
        'unit = "deg"',
        QUICK,
        file="log.txt",
        cured="".join(f'columns.{column} = {{ from = "{name}", unit = "deg" }}\n' for column, name in QUICK_FROM),
    ),
    text("counts under the name of degrees", "count_modulus = 65536", COUNTED, file="log.txt", cured=OWN_COUNTS),
    curve("no period", "want the worm's period in s, above 0", CURVE.replace("Period=479", "Period=0")),
    curve("few rows", "want at least 16 rows", "\n".join(CURVE.splitlines()[:9]) + "\n"),
    curve("rows turned", "want rows in their order", CURVE.replace("\n7 ", "\n5 ")),
    curve("two numbers", "want three numbers", CURVE.replace(LINES[7], "7 700")),
    curve("a word", "want a number", CURVE.replace(LINES[7], "7 700 much")),
    text(
        "another worm",
        "or period_s in its table [worm]",
        CURVE,
        file="pec.txt",
        worm=WormSection(wheel_teeth=135),
        good_worm=WormSection(wheel_teeth=135, period_s=479.0),
    ),
    text(
        "an error alone",
        "want time_s, or worm_angle_deg",
        ERRORS,
        worm=EQ6,
        chart=SIGN,
        cured=SIGN + 'columns.time_s = { from = "hours away", unit = "h" }\n',
    ),
    text("touching", "text.widths = [6, 9, 9]", TOUCH, file="run.dat", cured=WIDE),
    text(
        "widths",
        "the width of every column in characters",
        TOUCH,
        file="run.dat",
        chart="text.widths = [6]\n",
        cured=WIDE,
    ),
    text(
        "widths and separator",
        "want one of the two",
        TOUCH,
        file="run.dat",
        chart=WIDE + 'text.separator = ";"\n',
        cured=WIDE,
    ),
    text("counts as degrees", "want wraps = 65536", COUNTS, chart=counted('unit = "deg"'), cured=counted(OF_TURNS)),
    written(
        "starts",
        "want channels that begin together, or dates",
        channels(("today", "yesterday")),
        channels(("2026-02-03T10:15:00", "2026-02-03T10:15:00.5")),
        "a.h5",
    ),
]
