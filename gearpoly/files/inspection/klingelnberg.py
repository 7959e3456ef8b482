"""Klingelnberg's exports as one measured gear: what each label, curve and table means.

Deviations are taken as ISO 1328-1 and VDI/VDE 2612 have them: profiles positive outwards, slopes positive where
material rises to the tip, f_p positive where the pitch from tooth n - 1 to n is too large, F_p their running sum.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Profile, Side, Turn
from gearpoly.files.inspection.klingelnberg_header import RANGE, gear_header
from gearpoly.files.inspection.klingelnberg_text import (
    NOT_AVAILABLE,
    NOT_MEASURED,
    SIDE_WORDS,
    Export,
    Field,
    PitchTable,
    SheetCurve,
    number,
    read_export,
)
from gearpoly.files.inspection.measured import SIDES, MeasuredGear, closed
from gearpoly.files.inspection.probes import counting
from gearpoly.files.traces import DEVIATION_LIMIT_UM
from gearpoly.keys.kinds import NAME_SHOWN

SHAPE_LABELS = {"profile_slope_um": r"f_?Ha(?:lpha)?m?", "profile_crowning_um": r"C_?a(?:lpha)?m?"}
SPAN, PINS = r"W_?k?\b|Zahnweite|span", r"M_?dK\b|Zweikugelma|Zweirollenma|over (balls|pins)"
BALL = r"(kugel|rollen|ball|pin|wire)\w*[- ]?(durchmesser|dia)|\bD_?M\b"

ROUNDING = 1.5
"""Printed digits by which f_p and the steps of F_p may differ: three roundings of half a digit each."""


def read_klingelnberg(file: Path, *, known: Mapping[str, float], count: Turn | None) -> MeasuredGear:
    """One gear from a ``.mka`` or ``.mew`` file.

    ``known`` are keys of a pair file that somebody states beside the file, with ``start_mm`` and ``end_mm``, the
    diameters between which profiles were measured; ``count`` is the direction of counting, if it is stated. Raises
    ``InputFileError`` for a gear that is not spur, a file that is cut off or contradicts itself, and for what it lacks.
    """
    export = read_export(file)
    header = gear_header(export, known)
    z = header["teeth"]
    build = _Gear(export, header, int(z))
    found, told = counting(export.probes, int(z))
    if found is not None and count is not None and found != count:
        wish = f"leave --count, or count in the map, out; the probed points of left and right flanks run {found}"
        raise InputFileError(file, found=f"teeth counted {found}, and {count} is stated", wish=wish)
    arcs, profiles = build.arcs(), build.profiles()
    shapes, sizes = build.shapes(), build.sizes()
    if not (arcs or profiles or shapes or sizes):
        wish = "want pitch tables or profile curves (.mka), or profile slopes, spans or sizes over balls (.mew)"
        raise InputFileError(file, found="nothing in it that a pair file holds", wish=wish)
    says = [*build.says, *([f"{told}"] if arcs or profiles else [])]
    if export.unread:
        some = ", ".join(str(line) for line in export.unread[:5]) + (", ..." if len(export.unread) > 5 else "")
        says.append(f"{len(export.unread)} lines are of no known form and were left out: {some}")
    return MeasuredGear(
        file=file,
        name=shown(
            next((f.value for f in export.fields if re.search(r"^ME/|part no|teile-?nr", f.label, re.I)), file.stem)
            or file.stem,
            width=NAME_SHOWN,
        ),
        geometry={key: value for key, value in header.items() if key not in RANGE},
        count=found or count,
        arcs=arcs,
        profiles=profiles,
        shapes=shapes,
        sizes=sizes,
        says=tuple(says),
    )


@dataclass
class _Gear:
    """The parts of a gear of ``z`` teeth in one export with this ``header``; ``says`` grows."""

    export: Export
    header: dict[str, float]
    z: int

    def __post_init__(self) -> None:
        self.says: list[str] = []

    def fault(self, line: int, found: str, wish: str) -> InputFileError:
        return InputFileError(self.export.file, where=f"line {line}" if line else "", found=found, wish=wish)

    def need(self, key: str, called: str) -> float:
        if key not in self.header:
            wish = f"want it in the header, or [gear] {key} in a file that --map names"
            raise self.fault(0, f"profile curves, and no {called}", wish)
        return self.header[key]

    def arcs(self) -> dict[Side, tuple[float, ...]]:
        """Where the flanks of each measured side stand along the circle, um."""
        out: dict[Side, tuple[float, ...]] = {}
        for table in self.export.tables:
            if table.side in out:
                raise self.fault(table.line, f"a second pitch table of the {table.side} flank", "want one of each")
            out[table.side] = self.places(table)
            if "Fr" in table.names and "runout" not in "".join(self.says):
                self.says.append("runout Fr is not taken: pitch of both flanks holds it already")
        return out

    def places(self, table: PitchTable) -> tuple[float, ...]:
        want = f"want teeth 1 to {self.z}, each once; measure all teeth"
        if sorted(table.rows) != list(range(1, self.z + 1)):
            if sorted(table.rows) == list(range(1, len(table.rows) + 1)) and len(table.rows) > self.z:
                want = f"want {self.z}, as the gear has; or put its number of teeth right where it is stated"
            raise self.fault(table.line, f"a pitch table of {len(table.rows)} teeth", want)
        columns = {name: [table.rows[n][k] for n in range(1, self.z + 1)] for k, name in enumerate(table.names)}
        for name in ("fp", "Fp"):
            for n, value in enumerate(columns.get(name, ()), start=1):
                if value in (NOT_MEASURED, NOT_AVAILABLE) or abs(value) > DEVIATION_LIMIT_UM:
                    raise self.fault(table.line, f"{name} = {value:g} of tooth {n}", "want every tooth measured, in um")
        digit = _digit([value for name in ("fp", "Fp") for value in columns.get(name, ())])
        where = f"pitch table of the {table.side} flank, line {table.line}"
        if "Fp" not in columns:
            return closed(self.export.file, where, columns["fp"], digit=digit)
        sums = columns["Fp"]
        if "fp" in columns:
            for n, f_p in enumerate(columns["fp"]):
                step = sums[n] - sums[n - 1]
                if abs(step - f_p) > ROUNDING * digit + 1e-9:
                    wish = "want Fp(n) - Fp(n-1) = fp(n), the pitch from tooth n - 1 to tooth n; export the file again"
                    raise self.fault(table.line, f"fp = {f_p:g} of tooth {n + 1}, and Fp steps by {step:g}", wish)
        return tuple(sums)

    def profiles(self) -> tuple[Profile, ...]:
        """One profile of each measured flank, levelled at the reference circle."""
        curves = [curve for curve in self.export.curves if curve.kind == "profile"]
        if len(curves) < len(self.export.curves):
            self.says.append("lead and twist curves are not taken: gearpoly works in the transverse plane")
        if not curves:
            return ()
        kept = self.middle(curves)
        r = 0.5 * self.z * self.need("module_mm", "module")
        r_b = r * math.cos(math.radians(self.need("pressure_angle_deg", "pressure angle")))
        low = _roll(self.need("start_mm", "start of the measured range (da)"), r_b)
        high = _roll(self.need("end_mm", "end of the measured range (de)"), r_b)
        if not low < high or high > 3.0 * r:
            found = f"a measured range from {self.header['start_mm']:g} to {self.header['end_mm']:g} mm"
            raise self.fault(
                0, found, "want diameters, the first (da) smaller: state [gear] start_mm and end_mm in a map"
            )
        l_r = math.sqrt(r * r - r_b * r_b)
        out = []
        for curve in kept:
            n = len(curve.values)
            points = [
                (low + (high - low) * k / (n - 1), d) for k, d in enumerate(curve.values) if n > 1 and math.isfinite(d)
            ]
            if len(points) < 2 or any(abs(d) > DEVIATION_LIMIT_UM for _, d in points):
                raise self.fault(
                    curve.line, f"a profile with {len(points)} points in um", "want at least 2; measure it"
                )
            # Pitch says where the flank stands; the level of a trace depends on how the machine was set to zero.
            level = float(np.interp(l_r, [l for l, _ in points], [d for _, d in points]))
            out.append(
                Profile(
                    tooth=curve.tooth,
                    flank=curve.side,
                    roll_length=tuple(round(l, 6) for l, _ in points),
                    deviation=tuple(round(d - level, 4) for _, d in points),
                )
            )
        self.says += [
            f"profiles run from {self.header['start_mm']:g} to {self.header['end_mm']:g} mm diameter in even steps of "
            "roll length, positive = more material",
            "profiles are set to 0 at the reference circle, since pitch says where flanks stand",
        ]
        return tuple(out)

    def middle(self, curves: list[SheetCurve]) -> list[SheetCurve]:
        """Of several profiles of a flank the one nearest the middle of the face."""
        middle = 0.5 * self.header.get("face_width_mm", 2.0 * curves[0].place)
        best: dict[tuple[int, Side], SheetCurve] = {}
        for curve in curves:
            if not 1 <= curve.tooth <= self.z:
                raise self.fault(curve.line, f"tooth {curve.tooth}", f"want teeth 1 to {self.z}")
            key = (curve.tooth, curve.side)
            again = key in best and (best[key].place, best[key].letter) == (curve.place, curve.letter)
            if again and not np.array_equal(best[key].values, curve.values, equal_nan=True):
                found = f"tooth {curve.tooth} {curve.side} at z = {curve.place:g} mm again, after line {best[key].line}"
                raise self.fault(curve.line, found, "want one profile at each place of a flank")
            if key not in best or abs(curve.place - middle) < abs(best[key].place - middle):
                best[key] = curve
        if len(best) < len(curves):
            self.says.append(f"of several profiles on one flank the one nearest z = {middle:g} mm is taken")
        return list(best.values())

    def results(self, pattern: str) -> list[tuple[Field, float]]:
        """Results whose label begins with ``pattern`` and that were measured."""
        out = []
        for line in self.export.results:
            value = number(line.value)
            if value is not None and value not in (NOT_MEASURED, NOT_AVAILABLE) and re.match(pattern, line.label):
                out.append((line, value))
        return out

    def shapes(self) -> dict[str, dict[Side, float]]:
        """Mean slope and crowning of each side from a file of values, um."""
        out: dict[str, dict[Side, float]] = {}
        signs = next(
            (f for f in self.export.fields if re.search(r"FHA\b", f"{f.label} {f.value}") and "-" in f.value), None
        )
        for key, pattern in SHAPE_LABELS.items():
            for side in SIDES:
                names = "|".join(word for word, one in SIDE_WORDS.items() if one == side and len(word) > 1)
                each = [v for _, v in self.results(rf"{pattern}\s+(?:{names})\s+\d+$")]
                mean = [v for _, v in self.results(rf"{pattern}\s+(?:{names})(?:\s*m)?$")]
                if not (mean or each):
                    continue
                if key == "profile_slope_um" and signs is not None and re.search(r"\b[LR]\s*:\s*-", signs.value):
                    self.says.append(
                        f"profile slopes are not taken: line {signs.line} turns their sign on some flanks; state "
                        "profile_slope_um in the pair file"
                    )
                    return {}
                out.setdefault(key, {})[side] = mean[0] if mean else sum(each) / len(each)
        if out:
            self.says.append("slopes are taken as ISO 1328-1 has them: positive = material rises to the tip")
        return out

    def sizes(self) -> dict[str, float]:
        """A base tangent length or a size over balls, mm."""
        spans, pins = self.results(SPAN), self.results(PINS)
        m, alpha = self.header.get("module_mm"), self.header.get("pressure_angle_deg")
        if spans and m and alpha is not None:
            W = sum(value for _, value in spans) / len(spans)
            k = teeth_spanned(W, z=self.z, m=m, alpha=math.radians(alpha), x=self.header.get("profile_shift", 0.0))
            self.says.append(f"a span of {W:.4f} mm is over {k} teeth, the only number that comes near it")
            return {"span_mm": round(W, 5), "span_teeth": float(k)}
        if pins:
            ball = next(
                (f.numbers()[0] for f in self.export.fields if re.search(BALL, f.label, re.I) and f.numbers()), None
            )
            if ball is None or ball <= 0.0:
                self.says.append("sizes over balls are not taken: the header does not state the diameter of the balls")
                return {}
            M = sum(value for _, value in pins) / len(pins)
            return {"over_pins_mm": round(M, 5), "pin_diameter_mm": ball}
        return {}


def teeth_spanned(W: float, *, z: int, m: float, alpha: float, x: float) -> int:
    """Number k of teeth that a base tangent length ``W`` in mm spans, W = m cos(alpha) ((k - 1/2) pi + z inv(alpha)) +
    2 x m sin(alpha) (ISO 21771:2007, 7.3) turned round: the nearest whole number, since a tooth more adds pi m
    cos(alpha)."""
    rest = W / (m * math.cos(alpha)) - z * (math.tan(alpha) - alpha) - 2.0 * x * math.tan(alpha)
    return max(2, round(rest / math.pi + 0.5))


def _roll(d: float, r_b: float) -> float:
    """Roll length in mm at diameter ``d`` in mm."""
    return math.sqrt(max(0.0, 0.25 * d * d - r_b * r_b))


def _digit(values: list[float]) -> float:
    """The step in um in which values are printed, 0.001 or more."""
    digits = itertools.chain([0], (len(repr(round(value, 3)).partition(".")[2].rstrip("0")) for value in values))
    return float(10.0 ** -max(digits))
