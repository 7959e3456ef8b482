"""Refusals of guide logs."""

from __future__ import annotations

from typing import Any

from tests.cures.cure import Cure, text
from tests.made_guide_log import EQ6, made_log

LOG = made_log(frames=400)[0]
LOG_HEAD, LOG_FRAMES = LOG.split("Frame,Time", 1)


def log(name: str, says: str, bad: str, good: str = LOG, **more: Any) -> Cure:
    return text(name, says, bad, good, file="a.log", worm=EQ6, **more)


FRAME = next(line for line in LOG.splitlines() if line.startswith("30,"))

CURES = [
    text("no worm", "want a table [worm] in the pair file", LOG, file="a.log", good_worm=EQ6),
    log("no guiding", 'want a section "Guiding Begins at', "PHD2 version 2.6\nCalibration Begins at 2026\n"),
    log("few frames", "want at least", "\n".join(LOG.splitlines()[:12]) + "\n"),
    log("no scale", 'want a line "Pixel scale = 3.22 arc-sec/px" below', LOG.replace("Pixel scale", "Scale")),
    log("no rate", "calibrate PHD2, and guide again", LOG.replace("xRate = 2.4", "xRate = 0.0")),
    log("pole", "deg of the equator", LOG.replace("Dec = 12.0 deg", "Dec = 89.0 deg")),
    log(
        "no star",
        "want RARawDistance in the frames",
        "\n".join(
            ",".join([*line.split(",")[:3], '""', '""', '""', *line.split(",")[6:]]) if line[:1].isdigit() else line
            for line in LOG.splitlines()
        ).replace('""', ""),
    ),
    log("old columns", "want a log of PHD2 2.0 or later", LOG.replace("RARawDistance", "RaRaw")),
    log("long line", "want a guide log with lines", LOG + "x" * 20_000 + "\n"),
    log("optics", "want a log without adaptive optics", LOG.replace('"Mount"', '"AO"')),
    log("a word", "want a number", LOG.replace(FRAME, FRAME.replace(FRAME.split(",")[1], "soon"))),
    log(
        "a pulse without direction",
        "want durations of 0 ms or more, with W or E",
        LOG.replace(FRAME, ",".join([*FRAME.split(",")[:10], "Ost", *FRAME.split(",")[11:]])),
    ),
    log("infinite", "want finite numbers", LOG.replace(FRAME, FRAME.replace(FRAME.split(",")[1], "1e999"))),
    log(
        "clock",
        "cut the log there, and begin it with a header",
        LOG.replace(FRAME, FRAME.replace(FRAME.split(",")[1], "1.5")),
    ),
    text("section", "want a number from 1 to 1", LOG, file="a.log#4", to="a.log#1", worm=EQ6),
]
