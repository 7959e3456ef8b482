"""One picture of each class: ``python -m gearpoly.proving.life.pictures FOLDER [VARIANT]`` writes real_life_CLASS.png
there."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import FloatArray
from gearpoly.proving.life.base import LifeCase
from gearpoly.proving.life.ground import CLASSES, CLASSES_WITH_SHORT_CASES, make
from gearpoly.proving.physics import PHYSICS_BY_NAME

PICTURES_SEED = 20261125
"""Seed of the cases that are shown; no ground that judges has it."""
MARKED_SIZE_OVER_LIMIT = 7.0
"""Size over the limit from which on a line is marked: so large it is to be located."""
VARIANT_SHOWN = {
    "wander": 0, "coarse": 5, "train": 1, "even": 0, "large": 3, "wrong_file": 3, "outside": 3, "controls": 0,
}  # fmt: skip
"""Variant shown of each class."""


def columns(case: LifeCase, k: int) -> dict[str, FloatArray]:
    """The columns of one recording by name."""
    lines = case.recordings[k].splitlines()
    head = sum(line.startswith("#") for line in lines)
    return dict(zip(lines[head].split(","), np.loadtxt(lines[head + 1 :], delimiter=",").T, strict=True))


def seen(case: LifeCase, k: int) -> tuple[FloatArray, FloatArray]:
    """Driven turns, and transmission error in um about its mean, as whoever believes the pair file takes them."""
    pair: dict[str, Any] = tomllib.loads(case.pair_text)
    z = [pair[side]["teeth"] for side in ("driving", "driven")]
    alpha = np.radians(pair["driven"].get("pressure_angle_deg", 20.0))
    r_b = 0.5 * pair["driven"]["module_mm"] * z[1] * np.cos(alpha)
    read = columns(case, k)
    turns = read["driven_angle_deg"] / 360.0
    if "te_um" in read:
        x = read["te_um"]
    elif "te_arcsec" in read:
        x = np.radians(read["te_arcsec"] / 3600.0) * r_b * 1e3
    else:
        x = np.radians(read["driven_angle_deg"] - read["driving_angle_deg"] * z[0] / z[1]) * r_b * 1e3
    return turns - turns[0], x - x.mean()


def draw(klass: str, variant: int, target: Path) -> None:
    """Transmission error over driven turns, two turns of it closer, and its orders of the driven shaft."""
    cycles = 1.6 if klass in CLASSES_WITH_SHORT_CASES and variant % 2 else 0.0
    entry = CaseEntry(index=0, klass=klass, physics=(), over=30.0, variant=variant, cycles=cycles)
    case = make(PICTURES_SEED, entry)
    figure = Figure(figsize=(7.0, 5.6), layout="constrained")
    FigureCanvasAgg(figure)
    whole, near, orders = figure.subplots(3, 1)
    for k in range(len(case.recordings)):
        turns, x = seen(case, k)
        whole.plot(turns, x, lw=0.5, label=f"recording {k}")
        some = turns < turns[0] + min(1.0, np.ptp(turns))
        near.plot(turns[some], x[some], ".-", lw=0.4, ms=1.5)
        k_max = min(90.0, 0.5 * turns.size / max(np.ptp(turns), 1e-9))
        at = np.arange(0.25, max(k_max, 1.0), 0.05)
        flat = x - np.polyval(np.polyfit(turns, x, 1), turns)
        window = np.hanning(turns.size)
        basis = np.exp(-2j * np.pi * np.outer(at, turns))
        orders.semilogy(at, 2 * np.abs(basis @ (window * flat)) / window.sum(), lw=0.6)
    what = [one.get("physics") or one.get("cause") or one.get("shape") for one in case.truth["truth"]]
    wrong = case.truth.get("file", {}).get("wrong")
    whole.set_title(
        f"{klass}: {wrong or ', '.join(map(str, what)) or 'nothing hidden'}; {case.truth['pair']}", fontsize=9
    )
    whole.set_xlabel("driven turns")
    near.set_xlabel("driven turns, the first")
    orders.set_xlabel("order of the driven shaft")
    for axes in (whole, near):
        axes.set_ylabel("TE, um")
    orders.set_ylabel("amplitude, um")
    for item in (*case.truth["truth"], *case.truth["background"]):
        once = item.get("physics") in PHYSICS_BY_NAME and PHYSICS_BY_NAME[item["physics"]].place == "wave"
        order = item.get("order", 1.0 if once else None)
        if item["over_limit"] >= MARKED_SIZE_OVER_LIMIT and order is not None:
            pair = tomllib.loads(case.pair_text)
            ratio = pair["driven"]["teeth"] / pair["driving"]["teeth"] if item["gear"] == 1 else 1.0
            for shown in (order, *item.get("aliases", ())):
                if shown * ratio < orders.get_xlim()[1]:
                    orders.axvline(shown * ratio, color="k", lw=0.5, ls=":")
    if len(case.recordings) > 1:
        whole.legend(fontsize=7, ncols=3)
    figure.savefig(target, dpi=56, metadata={"Software": None})


def main(folder: Path, shift: int = 0) -> None:
    """A picture of every class."""
    folder.mkdir(parents=True, exist_ok=True)
    for klass in CLASSES:
        draw(klass, VARIANT_SHOWN[klass] + shift, folder / f"real_life_{klass}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
