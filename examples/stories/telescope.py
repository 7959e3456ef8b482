"""A telescope's drive, on real hardware: what the error of a star's place tells of the gears behind it, and what not.

A mount follows the sky by a worm that a spur pair turns. Its error was recorded on a star, through moving air, by
people who were not testing gears, and the log names two mounts: 12:47 teeth before a worm of 180, or 9:47 before one of
135. Both turn their driving gear once in 122.2 s, but their teeth meet every 10.2 or 13.6 s. A second log is of another
maker's mount."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from story import BLUE, GREEN, GREY, ORANGE, FloatArray, mean_over, seen, told

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.read import read_recording

DAY = 86164.1
"""Sidereal day, s."""
MODULE = 0.5
"""mm; nobody knows it: um are scaled by it, arc seconds are not."""
DRIVEN = 47
READINGS = {"EQ6": ("log01_as_eq6", 12, 180), "HEQ5": ("log01_as_heq5", 9, 135), "control": ("log04_as_eq6", 12, 180)}
"""Recording, teeth of the driving gear, teeth of the worm's wheel."""
HARMONICS = (2, 3, 5)
"""Of the other maker's worm, the lines that stand out beside its own."""

CONCLUDED = (
    "The pair inside is 12:47: the mesh line lies where 47 a turn of the worm belong; 9:47 would put it elsewhere.",
    "Something turns with the driving gear and errs once per turn: the gear, or what reads its angle.",
    "Something turns with the worm's shaft and errs five times per turn, other than a pitch wave of its gear would.",
    "The other mount shows no line of the driving gear or the mesh, and none of its waves gets a name: another worm's.",
)  # fmt: skip
OPEN = (
    "Gear or encoder: one flank of one recording leaves them alike. Only a re-fitted encoder or the other flank tells.",
    "Worm or 47-tooth gear: they share a shaft, and the worm is no part of the pair, so nothing of it can be named.",
    "The mesh line: relief, slope, profile or bending. No torque was varied, and the teeth cannot be placed.",
    "How large in um: module and quality are guesses; only the angles were measured.",
    "The worm's once and twice per turn: the largest waves there are, yet 3.5 turns do not tell them from wander.",
    "The noise: less than two hunting cycles, so nothing repeats; air and wander are modelled, not measured.",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Watched:
    """A diagnosed log (n,): times in s, what the star showed and what the fit leaves of it, arc seconds on the sky."""

    diagnosis: Diagnosis
    time: FloatArray
    sky: FloatArray
    left: FloatArray


def watch(folder: Path, recordings: Path, reading: str) -> Watched:
    """One log, read as one mount: the pair file holds both tooth numbers and a module, no more."""
    name, z_1, wheel = READINGS[reading]
    pair = folder / f"{z_1}_{DRIVEN}.toml"
    pair.write_text(
        f"[driving]\nteeth = {z_1}\nmodule_mm = {MODULE}\n[driven]\nteeth = {DRIVEN}\nmodule_mm = {MODULE}\n"
    )
    found = diagnose(read_pair(pair), [read_recording(recordings / f"{name}.csv")], path=pair)
    (one,) = seen(found)
    time = found.comparison.aligned[0].time_s
    assert time is not None
    # um along the line of action, over the driven base radius, are angles of the worm's shaft.
    arcsec = np.degrees(1e-3 / (0.5 * MODULE * DRIVEN * np.cos(np.radians(20.0)))) * 3600.0 / wheel
    return Watched(
        diagnosis=found, time=time, sky=arcsec * one.recorded, left=arcsec * (one.recorded - one.fitted)
    )  # fmt: skip


def lines(time: FloatArray, values: FloatArray, hz: FloatArray) -> FloatArray:
    """Amplitude (m,) of a wave at each frequency, beside a slow cubic, in the unit of ``values`` (n,)."""
    slow = np.polynomial.legendre.legvander(2.0 * (time - time[0]) / np.ptp(time) - 1.0, 3)
    out = []
    for f in hz:
        columns = np.column_stack([slow, np.cos(2 * np.pi * f * time), np.sin(2 * np.pi * f * time)])
        fit = np.linalg.lstsq(columns, values, rcond=None)[0]
        out.append(np.hypot(*fit[-2:]))
    return np.asarray(out)


def period(one: Watched, shortest: float, longest: float) -> float:
    """Period in s of the strongest wave between two periods, to a hundredth of a line's width."""
    hz = np.arange(1.0 / longest, 1.0 / shortest, 0.01 / np.ptp(one.time))
    return float(1.0 / hz[np.argmax(lines(one.time, one.sky, hz))])


def where(diagnosis: Diagnosis) -> list[str]:
    """Orders that compare locates, with sizes in um at the guessed module."""
    out = []
    for one in diagnosis.comparison.located.entries:
        if one.order is not None and one.amplitude_um is not None:
            of = f"the {one.gear} shaft" if one.gear else "the mesh"
            out.append(f"order {one.order:.4g} of {of}: {one.amplitude_um:.1f} +- {one.std_um:.1f} um")
    return out


def draw(target: Path, eq6: Watched, control: Watched, turn: float, shaft: float, worm: float) -> None:
    """The four steps of the story; turns in s of the driving gear, of the worm, of the other mount's worm."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.4, 7.2), layout="constrained")
    (first, second), (third, fourth) = figure.subplots(2, 2)
    for values, colour, name in ((eq6.sky, BLUE, "as recorded"), (eq6.left, GREEN, "less what was named")):
        x, y = mean_over(eq6.time, values - np.mean(values), period=turn, bins=24)
        first.plot(x, y, "o-", color=colour, label=name, ms=4)
    first.set_xlabel(f"time in the driving gear's turn of {turn:.1f} s, s")
    first.set_title("1  Once per turn of the driving gear: named, its encoder as rival", fontsize=10)
    orders = np.linspace(6.5, 14.5, 641)
    second.plot(orders, lines(eq6.time, eq6.sky, orders / turn), color=BLUE, lw=1.2)
    for z, colour in ((9, ORANGE), (12, GREEN)):
        second.axvline(z, color=colour, ls=":", label=f"mesh of {z} teeth, {turn / z:.2f} s")
    second.set_xlabel("waves per turn of the driving gear")
    second.set_title("2  The mesh line counts its teeth: 12, not 9", fontsize=10)
    orders = np.linspace(0.7, 8.5, 781)
    for values, colour, name in ((eq6.sky, BLUE, "as recorded"), (eq6.left, GREEN, "less what was named")):
        third.plot(orders, lines(eq6.time, values, orders / shaft), color=colour, lw=1.2, label=name)
    for place, text in ((1.0, "worm, 1"), (2.0, "2"), (shaft / turn, "driving\ngear"), (5.0, "5")):
        third.axvline(place, color=GREY, ls=":", lw=1)
        third.annotate(text, (place, 0.99), (3, -3), xycoords=("data", "axes fraction"), textcoords="offset points",
                       fontsize=8, color=GREY, va="top")  # fmt: skip
    third.set_xlabel(f"waves per turn of the worm, {shaft:.1f} s")
    third.set_title("3  Order 5 of the worm's shaft: its encoder's, or the worm's", fontsize=10)
    orders = np.linspace(0.7, 5.5, 961)
    fourth.plot(orders, lines(control.time, control.sky, orders / worm), color=BLUE, lw=1.2)
    for k in (1, *HARMONICS):
        fourth.axvline(k, color=GREY, ls=":", lw=1)
    for place, text in ((worm / shaft, "worm"), (worm / turn, "driving gear")):
        fourth.axvline(place, color=ORANGE, ls="--", lw=1, label=f"12:47 would have its {text} here")
    fourth.set_xlabel(f"waves per {worm:.1f} s")
    fourth.set_title(f"4  Another mount: a worm of {DAY / worm:.0f}, nothing of 12:47", fontsize=10)
    for plot in (first, second, third, fourth):
        plot.set_ylabel("error on the sky, arcsec" if plot is first else "amplitude on the sky, arcsec")
        plot.spines[["top", "right"]].set_visible(False)
        low, high = plot.get_ylim()
        plot.set_ylim(low if plot is first else 0.0, high + 0.3 * (high - low))  # the legend's place
        plot.legend(frameon=False, fontsize=8, loc="upper right")
    figure.savefig(target, dpi=90)


def main(folder: Path, recordings: Path) -> dict[str, object]:
    """Diagnose both logs, the first as either mount, measure their periods, draw what is found."""
    eq6, heq5, control = (watch(folder, recordings, reading) for reading in READINGS)
    z_1, wheel = READINGS["EQ6"][1:]
    # Both mounts turn their driving gear in this time, wherever it is within a quarter; teeth may be 7 to 14 of them.
    shaft = DAY / wheel * z_1 / DRIVEN
    turn = period(eq6, 0.75 * shaft, 1.25 * shaft)
    mesh = period(eq6, turn / 14.4, turn / 6.6)
    # The strongest wave of the other mount, and those that are its harmonics, from the orders at which they lie.
    stated = [entry.order for entry in control.diagnosis.comparison.located.entries
              if entry.kind == "shaft_order" and entry.gear == "driving" and entry.order]  # fmt: skip
    first = stated[0]
    harmonics = {k: shaft * k / min(stated, key=lambda order: abs(order - k * first)) for k in HARMONICS}
    worm = float(np.mean(list(harmonics.values())))
    draw(folder / "telescope.png", eq6, control, turn, mesh * DRIVEN, worm)
    rms = [1e3 * value for value in (eq6.diagnosis.before.unseen, eq6.diagnosis.after.unseen, eq6.diagnosis.noise)]
    return {
        "12:47, located": where(eq6.diagnosis),
        "12:47, named": told(eq6.diagnosis),
        "12:47, unnamed": [entry.kind for entry in eq6.diagnosis.unexplained],
        "12:47, held-out rms before and after, noise, um": rms,
        "9:47, located": where(heq5.diagnosis),
        "9:47, named": told(heq5.diagnosis),
        "driving gear's turn, s": turn,
        "mesh, s": mesh,
        "worm's turn by the mesh, s": mesh * DRIVEN,
        "teeth of the driving gear": turn / mesh,
        "the other mount, named": [one.claim.says for one in control.diagnosis.findings],
        "the other mount, located": len(control.diagnosis.comparison.located.entries),
        "the other mount's worm by its harmonics, s": harmonics,
        "teeth of the other mount's wheel": DAY / worm,
        "concluded": CONCLUDED,
        "cannot be concluded": OPEN,
    }


if __name__ == "__main__":
    if len(sys.argv) < 2 or not (Path(sys.argv[1]) / "log01_as_eq6.csv").is_file():
        sys.exit("telescope: skipped, the recordings are not part of this repository; want RECORDINGS [FOLDER]")
    place = Path(sys.argv[2] if len(sys.argv) > 2 else "out/stories")
    place.mkdir(parents=True, exist_ok=True)
    for key, value in main(place, Path(sys.argv[1])).items():
        if isinstance(value, (list, tuple)) and value and isinstance(value[0], str):
            print(f"{key}:", *value, sep="\n  ")
        else:
            print(f"{key}: {value}")
