"""Refusals of recordings that compare and diagnose find only beside the pair, or beside each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.cures.cure import BASE, HEAD, RATIO, Cure, command, own_run, put
from tests.made_guide_log import made_log
from tests.made_texts import own

PAIR = """\
[model]
tooth_deflection = false
[driving]
teeth = 18
module_mm = 2.0
points_per_flank = 100
[driven]
teeth = 25
module_mm = 2.0
points_per_flank = 100
"""
WORM = f"{PAIR}[worm]\nwheel_teeth = 180\n"
LOG = made_log(frames=400)[0]


COMPARED: set[tuple[tuple[str, ...], str]] = set()
"""Recordings and pair files that were compared: several refusals end in the same, which need not be tried again."""


def compare(
    name: str, says: str, bad: tuple[str, ...], good: tuple[str, ...], *, pair: str = PAIR, good_pair: str = ""
) -> Cure:
    """Recordings that are refused together with the pair, and those that are compared in their place, or with the
    ``good_pair``."""

    def attempt(folder: Path, texts: tuple[str, ...], pair: str) -> None:
        put(folder, "pair.toml", pair)
        names = [folder / f"rec_{k}.txt" for k in range(len(texts))]
        for file, text in zip(names, texts, strict=True):
            put(folder, file.name, text)
        command("compare", folder / "pair.toml", *names)

    def cured(folder: Path, texts: tuple[str, ...], pair: str) -> None:
        if (texts, pair) not in COMPARED:
            attempt(folder, texts, pair)
            COMPARED.add((texts, pair))

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad, pair),
        good=lambda folder, message: cured(folder, good, good_pair or pair),
    )


OTHER = own_run(rpm=31.0)
COARSE = own_run(size=24, rate=3.5)

SWAPPED = BASE.replace(HEAD, HEAD.replace("driving", "x").replace("driven", "driving").replace("x", "driven"), 1)


def of_teeth(z_1: int, z_2: int) -> str:
    """The pair file with other teeth."""
    return PAIR.replace("teeth = 18", f"teeth = {z_1}").replace("teeth = 25", f"teeth = {z_2}")


def travelled(ratio: float, *, scale: float = 1.0, waves: dict[float, float] | None = None) -> str:
    """Twelve driving turns at that ratio by a driving encoder that reads ``scale`` times them, with ``waves`` of so
    many rad by order of the driving shaft, and noise of 2 urad."""
    rng = np.random.default_rng(2)
    theta = np.cumsum(rng.uniform(0.5, 1.5, 3000)) * (12 * 360.0 / 3000)
    te = rng.normal(0.0, 2e-6, theta.size)
    for order, amplitude in (waves or {}).items():
        te += amplitude * np.cos(np.radians(order * theta) + rng.uniform(0.0, 6.0))
    return own({"driving_angle_deg": scale * theta, "driven_angle_deg": ratio * theta + np.degrees(te)}, digits=7)


BARE = travelled(RATIO, scale=1.2)
OF_OTHERS = travelled(
    20 / 27, waves={1: 2e-5, 2: 1e-5, 3: 1e-5, 20 / 27: 2e-5, 40 / 27: 1e-5, 60 / 27: 1e-5, 20: 1e-5, 40: 5e-6}
)

CURES = [
    compare("columns swapped", "exchange driving_angle_deg and driven_angle_deg", (SWAPPED,), (BASE,)),
    compare("gears swapped", "or the two gears in the pair file", (SWAPPED,), (SWAPPED,), good_pair=of_teeth(25, 18)),
    *(
        compare("ratio of no pair", says, (BARE,), (BARE,), good_pair=good)
        for says, good in (
            ("the driving shaft reads 1.2 times its turns", PAIR + "[driving.encoder]\nscale = 1.2\n"),
            ("under [driving.encoder] or [driven.encoder], scale", PAIR + f"[driven.encoder]\nscale = {1.0 / 1.2}\n"),
            ("the teeth are 18/30", of_teeth(12, 20)),
        )
    ),
    compare(
        "other teeth",
        "those of 20 on 27 teeth",
        (OF_OTHERS,),
        (OF_OTHERS,),
        good_pair=of_teeth(20, 27),
    ),
    compare("twins", "want every recording once", (BASE, BASE), (BASE,)),
    compare(
        "zeros apart",
        "or compare them one by one",
        ("# driving_zero_deg = 0.0\n" + BASE, "# driving_zero_deg = 90.0\n" + OTHER),
        ("# driving_zero_deg = 0.0\n" + BASE,),
    ),
    compare(
        "directions apart",
        "or compare one by one",
        (BASE, "# driving_direction = -1\n" + OTHER),
        (BASE,),
    ),
    compare("few samples", "to tell noise from anything", (COARSE,), (BASE,)),
    compare("guided beside another", "want it alone", (LOG, made_log(frames=380)[0]), (LOG,), pair=WORM),
]
