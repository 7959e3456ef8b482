"""Refusals of recordings that compare and diagnose find only beside the pair, or beside each other."""

from __future__ import annotations

from pathlib import Path

from tests.cures.cure import BASE, Cure, command, own_run, put
from tests.made_guide_log import made_log

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


def compare(name: str, says: str, bad: tuple[str, ...], good: tuple[str, ...], *, pair: str = PAIR) -> Cure:
    """Recordings that are refused together with the pair, and those that are compared in their place."""

    def attempt(folder: Path, texts: tuple[str, ...]) -> None:
        put(folder, "pair.toml", pair)
        names = [folder / f"rec_{k}.txt" for k in range(len(texts))]
        for file, text in zip(names, texts, strict=True):
            put(folder, file.name, text)
        command("compare", folder / "pair.toml", *names)

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad),
        good=lambda folder, message: attempt(folder, good),
    )


OTHER = own_run(rpm=31.0)
COARSE = own_run(size=24, rate=3.5)

CURES = [
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
