"""An inspector who measures a gear's polygon, knowing nothing of its deviations, and the sheets that he writes.

He looks at a face, turns a tooth up, calls its flanks left and right, counts from it, and takes angles where the
outline crosses circles. ``python -m tests.made_sheets --out data/sheets`` writes the samples of the documentation.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

import gearpoly
from gearpoly.export.design import design_model
from gearpoly.files.rexs.write import xml_text
from gearpoly.units import FloatArray

Side = Literal["left", "right"]
POINTS = 480


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """What the inspector notes: geometry, F_p (z,) by side in um along his direction of counting, tooth z being 0,
    profiles (n,) in um by tooth and side, and where he touched each flank (deg on the gear, from tooth 1)."""

    z: int
    m: float
    alpha: float
    x: float
    b: float
    d_a: float
    start: float
    end: float
    sums: dict[Side, FloatArray]
    profiles: dict[tuple[int, Side], FloatArray]
    touched: dict[Side, FloatArray]

    def single(self, side: Side) -> FloatArray:
        """f_p (z,) in um: tooth n against n - 1."""
        return self.sums[side] - np.roll(self.sums[side], 1)


def crossings(ring: FloatArray, radius: float) -> dict[Side, FloatArray]:
    """Angles at which a counter-clockwise outline (n, 2) crosses a circle, by flank: going on, it falls to the root on
    a left flank and rises to the tip on a right one, for a tooth that points up."""
    p, q = ring[:-1], ring[1:]
    d = q - p
    a, b, c = np.sum(d * d, axis=1), np.sum(p * d, axis=1), np.sum(p * p, axis=1) - radius**2
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(b * b - a * c)
        out: dict[Side, FloatArray] = {}
        for side, t in (("left", (-b - root) / a), ("right", (-b + root) / a)):
            inward = np.hypot(*p.T) > np.hypot(*q.T)
            keep = (t >= 0.0) & (t < 1.0) & (inward if side == "left" else ~inward)
            at = p[keep] + t[keep, None] * d[keep]
            out["left" if side == "left" else "right"] = np.arctan2(at[:, 1], at[:, 0])
    return out


def inspect(
    gear: Any,
    *,
    face: Literal["datum", "other"] = "datum",
    count: str = "clockwise",
    teeth: tuple[int, ...] = (),
    points: int = POINTS,
) -> Seen:
    """Measure ``gear`` (of :class:`gearpoly.api.Pair`), tooth 1 being its tooth 0, seen on one of its faces."""
    nominal = gear.nominal
    ring = np.asarray(gear.polygon.exterior.coords)
    up = float(gear.mounted.centre_lines[0])
    if not gear.polygon.exterior.is_ccw:
        ring = ring[::-1]
    if face == "other":  # turned over: what was left is right
        ring, up = (ring * (-1.0, 1.0))[::-1], math.pi - up
    sense = -1.0 if count == "clockwise" else 1.0  # angles are counter-clockwise
    tau = 2.0 * math.pi / nominal.z

    def by_tooth(radius: float) -> dict[Side, FloatArray]:
        out: dict[Side, FloatArray] = {}
        for side, found in crossings(ring, radius).items():
            # Half a tooth aside of its middle at most: each flank goes to the nearest tooth.
            offset = sense * (found - up) / tau
            number = np.round(offset).astype(int) % nominal.z
            assert sorted(number) == list(range(nominal.z))
            out[side] = np.empty(nominal.z)
            out[side][number] = found
        return out

    def wrapped(angles: FloatArray) -> FloatArray:
        return (angles + math.pi) % (2.0 * math.pi) - math.pi

    middle = by_tooth(nominal.r)
    directions = up + sense * tau * np.arange(nominal.z)
    sums: dict[Side, FloatArray] = {}
    for side, angles in middle.items():
        places = 1e3 * nominal.r * sense * wrapped(angles - directions)
        sums[side] = places - places[-1]
    start, end = 2.0 * nominal.r - 1.1 * nominal.m, 2.0 * nominal.r_a - 0.02 * nominal.m
    start = max(start, 2.0 * math.hypot(nominal.r_b, 0.25 * nominal.m))
    r_b = nominal.r_b
    low, high = (math.sqrt(0.25 * d * d - r_b * r_b) for d in (start, end))
    profiles: dict[tuple[int, Side], list[float]] = {(n, side): [] for n in teeth for side in ("left", "right")}  # type: ignore[misc]
    for l in np.linspace(low, high, points):
        found = by_tooth(math.hypot(r_b, l))
        half = nominal.psi(math.hypot(r_b, l))
        for n in teeth:
            for side, out in (("left", 1.0), ("right", -1.0)):
                wide = out * wrapped(np.atleast_1d(found[side][n - 1] - directions[n - 1]))[0]  # type: ignore[index]
                profiles[n, side].append(1e3 * r_b * (wide - half))  # type: ignore[index]
    return Seen(
        z=nominal.z, m=nominal.m, alpha=math.degrees(nominal.alpha), x=nominal.x, b=nominal.b or 20.0,
        d_a=2.0 * nominal.r_a, start=start, end=end, sums=sums,
        profiles={key: np.array(values) for key, values in profiles.items()},
        touched={side: np.degrees(wrapped(angles - up)) for side, angles in middle.items()},
    )  # fmt: skip


GERMAN = {
    "teeth": "Zähnezahl z",
    "m": "Normalmodul mn [mm]",
    "alpha": "Eingriffswinkel alpha [Grad]",
    "beta": "Schrägungswinkel beta [Grad]",
    "x": "Profilverschiebungsfaktor x",
    "b": "Zahnbreite [mm]",
    "d_a": "Kopfkreisdurchmesser [mm]",
    "start": "Start Messbereich da [mm]",
    "end": "Ende der Messstrecke de [mm]",
}
ENGLISH = {
    "teeth": "No. of teeth z",
    "m": "Normal module mn [mm]",
    "alpha": "Pressure angle alpha [deg]",
    "beta": "Helix angle beta [deg]",
    "x": "Profile shift x",
    "b": "Face width [mm]",
    "d_a": "Tip diameter [mm]",
    "start": "Start of measured range da [mm]",
    "end": "End of measured range de [mm]",
}


def mka(seen: Seen, *, english: bool = False, probes: bool = True, coded: bool = True, turned: bool = True) -> str:
    """The sheet as a file of curves; ``turned``: probed points in the machine's frame, its table having turned."""
    words = ENGLISH if english else GERMAN
    side_word = {"left": "left", "right": "right"} if english else {"left": "links", "right": "rechts"}
    values = {
        "teeth": f"{seen.z}",
        "m": f"{seen.m:.4f}",
        "alpha": f"{seen.alpha:.4f}",
        "beta": "0.0000",
        "x": f"{seen.x:.4f}",
        "b": f"{seen.b:.3f}",
        "d_a": f"{seen.d_a:.4f}",
        "start": f"{seen.start:.4f} {seen.start:.4f}",
        "end": f"{seen.end:.4f} {seen.end:.4f}",
    }
    codes = dict(zip(values, (22, 21, 23, 24, 28, 26, 27, 41, 44), strict=True))
    lines = ["HEADER KS.MK.FILE", "TYPE STI ! type", "SEPARATOR : ! separator", "PROFILE diameter ! abscissa",
             "UNDEFINED -2147483.648 ! undefined", ""]  # fmt: skip
    for key, value in values.items():
        lines.append((f" {codes[key]:3d} :" if coded else "") + f"{words[key]}".ljust(40, ".") + f":  {value}")
    lines.append("")
    if seen.profiles:
        lines.append("Profile:" if english else "Profil:")
    for (tooth, side), curve in seen.profiles.items():
        head = f"Tooth No.: {tooth} {side_word[side]} / {curve.size} values z= 10.000"
        lines += ["", head if english else f"Zahn-Nr.: {tooth} {side_word[side]} / {curve.size}  Werte  z= 10.000"]
        rows = [f"{value:.3f}" for value in curve]
        rows[:2] = ["-2147483.648"] * 2  # the first points of a scan have no reading
        lines += [" ".join(rows[k : k + 12]) for k in range(0, curve.size, 12)]
    lines.append("")
    for side in ("left", "right"):
        title = f"{side} tooth flank" if english else {"left": "linke Zahnflanke", "right": "rechte Zahnflanke"}[side]
        lines += [f"        {title}", "    Tooth-No.  fp   Fp   Fr" if english else "    Zahn-Nr.   fp   Fp   Fr", ""]
        sums = np.round(seen.sums[side], 3)  # type: ignore[index]
        single = sums - np.roll(sums, 1)
        lines += [f"  {n + 1:3d}  {single[n]:9.3f} {sums[n]:9.3f} {0.0:9.3f}" for n in range(seen.z)]
        lines.append("")
    if probes:
        lines += ["Pitch:" if english else "Teilung:", "Z-Nr. Seite   PHI      X      Y      Z"]
        r = 0.5 * seen.z * seen.m
        for n in range(seen.z):
            for side in ("right", "left"):
                phi = seen.touched[side][n]  # type: ignore[index]
                # The table brings each flank to the probe, or the points are given on the gear.
                x, y = (0.12, r) if turned else (-r * math.sin(math.radians(phi)), r * math.cos(math.radians(phi)))
                table = -phi % 360.0
                lines.append(f"  {n + 1:3d} {side[0].upper()} {table:10.4f} {x:10.4f} {y:10.4f} 10.0000")
    return "\r\n".join(lines) + "\r\n"


def table(seen: Seen) -> str:
    """The sheet as a German spreadsheet writes it."""
    lines = ["Zahn-Nr.;fp links [µm];Fp links [µm];fp rechts [µm];Fp rechts [µm]"]
    columns = [column for side in ("left", "right") for column in (seen.single(side), seen.sums[side])]  # type: ignore[arg-type,index]
    for n in range(seen.z):
        lines.append(";".join([str(n + 1), *(f"{column[n]:.2f}".replace(".", ",") for column in columns)]))
    return "\n".join(lines) + "\n"


def known(seed: int = 5, *, z: tuple[int, int] = (18, 25)) -> dict[str, Any]:
    """A pair of module 2 with its own deviation on every tooth of both flanks, zero in the mean as pitch is."""
    rng = np.random.default_rng(seed)

    def one(teeth: int, x: float) -> dict[str, Any]:
        pitch, coast = (values - values.mean() for values in rng.normal(scale=4.0, size=(2, teeth)))
        return {
            "teeth": teeth, "module_mm": 2.0, "profile_shift": x, "face_width_mm": 20.0,
            "inspection": {
                "pitch_um": pitch.tolist(), "pitch_coast_um": coast.tolist(),
                "profile_slope_um": rng.normal(scale=3.0, size=teeth).tolist(),
                "profile_crowning_um": rng.normal(scale=2.0, size=teeth).tolist(),
                "profile_slope_coast_um": rng.normal(scale=3.0, size=teeth).tolist(),
            },
        }  # fmt: skip

    return {"pair": {"centre_distance_mm": sum(z) + 0.3}, "driving": one(z[0], 0.1), "driven": one(z[1], 0.0)}


def samples() -> dict[str, bytes]:
    """The files of ``data/sheets`` by name: a gear as a machine writes it, one as a spreadsheet does, and a design."""
    pair = gearpoly.Pair.of(known())
    graded = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"
    design = gearpoly.load(graded)
    layout = """\
# What driven.csv leaves open.
count = "clockwise"       # seen on the datum face

[gear]
module_mm = 2.0
pressure_angle_deg = 20.0
profile_shift = 0.0
"""
    return {
        "driving.mka": b"\xef\xbb\xbf" + mka(inspect(pair.driving, teeth=(1, 7, 13))).encode(),
        "driven.csv": table(inspect(pair.driven)).encode("cp1252"),
        "driven_map.toml": layout.encode(),
        "design.rexs": xml_text(design_model(design.file, design.assembled)).encode(),
    }


def main() -> None:
    """Write the samples into a folder."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, required=True)
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in samples().items():
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    main()
