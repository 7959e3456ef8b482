"""What a rig recorded under one condition, as read: no alignment, no direction, no unwrapping yet.

Every format carries the same columns and keys under the same names. Their rules are kept here, so a
reader of another format only has to find them. Raw encoder channels (``driving_a``, ``driven_count``
and so on) stand in the place of a shaft's angle column; ``raw`` turns them into one.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Literal

import numpy as np

from gearpoly.errors import InputFileError, shown_value
from gearpoly.recording.deeds import in_full
from gearpoly.recording.from_time import is_from_time
from gearpoly.recording.run import Run
from gearpoly.units import ARCSEC, DEG, UM, URAD, FloatArray, read_only

Flank = Literal["drive", "coast"]

TE_COLUMNS = ("te_um", "te_urad", "te_arcsec")
ANGLE_COLUMNS = ("driving_angle_deg", "driven_angle_deg")
CORRECTION_COLUMNS = ("driving_correction_deg", "driven_correction_deg")
PLAIN_COLUMNS = ("time_s", *ANGLE_COLUMNS, *TE_COLUMNS, *CORRECTION_COLUMNS, "torque_nm", "speed_rpm")
SHAFTS = ("driving", "driven")
RAW_CHANNELS = ("a", "b", "index", "count")
RAW_COLUMNS = tuple(f"{shaft}_{channel}" for shaft in SHAFTS for channel in RAW_CHANNELS)
COLUMNS = (*PLAIN_COLUMNS, *RAW_COLUMNS)
"""The columns that a recording may have, in any order."""

PASSED_OVER = ("backlash_um", "contact_pairs")
"""Columns of ``gearpoly simulate``'s own table that no recording needs."""

RAW_SHAFT_KEYS = ("lines", "counts_per_line", "count_bits", "count_modulus")
RAW_KEYS = (*(f"{shaft}_{key}" for shaft in SHAFTS for key in RAW_SHAFT_KEYS), "sample_rate_hz")
KEYS = (
    "torque_nm",
    "speed_rpm",
    "flank",
    "driving_zero_deg",
    "driven_zero_deg",
    "driving_direction",
    "driven_direction",
    "reversed",
    *RAW_KEYS,
)
"""The keys that state the condition and the set-up of a recording."""

LARGEST_NUMBER = 1e300
"""Size from which a number is as good as infinite: a whole number of a file may have more digits than a float."""

ANGLE_LIMIT_DEG = 1e12
"""Largest angle. Beyond it double precision holds an angle to 1e-4 deg, which is as coarse as encoders read; no shaft
makes 3e9 turns while it is recorded. Found by hostile files: sums of such angles overflow.
"""

COUNT_BITS_LIMIT = 53
"""Widest counter; beyond it a count is no longer exact in double precision."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """The samples of one recording and the condition under which it was made.

    All arrays are (n,), float64 and read-only, and ``nan`` marks a drop-out. ``time_s`` in s.
    ``driving_angle_rad`` and ``driven_angle_rad``: encoder readings in rad, wrapped or not,
    increasing with the encoder's own count. Transmission error, where the rig computed it:
    ``te_rad``, the angle on the driven side in rad, or ``te_mm``, the same times the driven base
    radius in mm, since only the pair file knows that radius (whether both agree is seen there).
    ``torque_samples_nm`` in N.m and ``speed_samples_rpm`` in rpm per sample. ``driving_correction_rad`` and
    ``driven_correction_rad``: what that shaft may have turned beside the stated angle, in rad (guide pulses).

    ``torque_nm`` (N.m on the driven shaft) and ``speed_rpm`` (driving shaft) are the stated
    condition. ``driving_zero_rad`` and ``driven_zero_rad`` are the readings in rad at angle zero,
    to about half a tooth; ``None`` = unknown. A direction of -1 says that the encoder counts down
    while the pair runs forward. ``backward``: the pair ran backwards, so both angles fall while
    ``time_s`` rises; ``flank`` is still the one that touches. ``from_time``: shafts of which no encoder was read, since
    their angle is nothing but time at one rate, beside a transmission error. ``last_places`` holds, by column of the
    file, half of the last place it was written to, in rad or mm, where columns follow from one another. ``own_zero``:
    a transmission error whose zero no recording shares but runs beside it in one file. ``run`` says
    which part of its file it is, where the shafts turned forth and back there. ``entries`` are the lines of a map that
    give columns as they were taken, by column. ``remarks`` say what a reader found, assumed or left out.

    Raises ``ValueError`` where the arrays are not of one length or the angles do not suffice.
    """

    source: Path
    time_s: FloatArray | None = None
    driving_angle_rad: FloatArray | None = None
    driven_angle_rad: FloatArray | None = None
    te_rad: FloatArray | None = None
    te_mm: FloatArray | None = None
    driving_correction_rad: FloatArray | None = None
    driven_correction_rad: FloatArray | None = None
    torque_samples_nm: FloatArray | None = None
    speed_samples_rpm: FloatArray | None = None
    torque_nm: float | None = None
    speed_rpm: float | None = None
    flank: Flank = "drive"
    driving_zero_rad: float | None = None
    driven_zero_rad: float | None = None
    driving_direction: Literal[1, -1] = 1
    driven_direction: Literal[1, -1] = 1
    backward: bool = False
    from_time: tuple[str, ...] = ()
    last_places: Mapping[str, float] = field(default_factory=dict)
    own_zero: bool = False
    run: Run | None = None
    entries: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shapes = set()
        for one in fields(self):
            value = getattr(self, one.name)
            if isinstance(value, np.ndarray):
                object.__setattr__(self, one.name, _held(value))
                shapes.add(value.shape)
        if len(shapes) != 1 or len(next(iter(shapes))) != 1:
            raise ValueError(f"the arrays of a recording share one length, not the shapes {sorted(shapes)}")
        angles = (self.driving_angle_rad is not None) + (self.driven_angle_rad is not None)
        errors = self.te_rad is not None or self.te_mm is not None
        if angles + errors < 2:
            raise ValueError("a recording has both angles, or a transmission error and an angle")

    @property
    def size(self) -> int:
        """Number of samples, drop-outs among them."""
        held = (self.driving_angle_rad, self.driven_angle_rad)
        return next(array.size for array in held if array is not None)

    def te_in_rad(self, r_b2: float | None) -> FloatArray | None:
        """The transmission error (n,) in rad that the rig computed, if it did; along the line of action it takes the
        driven base radius ``r_b2`` in mm, without which ``ValueError`` is raised."""
        if self.te_rad is not None or self.te_mm is None:
            return self.te_rad
        if r_b2 is None:
            raise ValueError("a transmission error in um needs the driven base radius r_b2 to become an angle")
        return self.te_mm / r_b2

    @property
    def computed(self) -> bool:
        """Whether the rig computed the transmission error itself."""
        return self.te_rad is not None or self.te_mm is not None


def _held(values: FloatArray) -> FloatArray:
    """``values`` as nobody can write to them; copied unless they are so already, since recordings are large."""
    whole = values.dtype == np.float64 and values.flags.aligned and values.flags.c_contiguous
    owner: object = values
    while isinstance(owner, np.ndarray):
        if owner.flags.writeable:
            return read_only(values)
        owner = owner.base
    sealed = owner is None or (isinstance(owner, memoryview) and isinstance(owner.obj, bytes))
    return values if whole and sealed else read_only(values)


def _taken_over(values: FloatArray, unit: float) -> FloatArray:
    """``values`` times ``unit``, in place where they can be written to, and sealed so that no copy is needed."""
    if unit != 1.0:
        in_place = values.flags.writeable and values.flags.c_contiguous
        with np.errstate(invalid="ignore", under="ignore"):  # a damaged file may hold signalling nans
            values = np.multiply(values, unit, out=values if in_place else None)
    owner: object = values
    while isinstance(owner, np.ndarray):
        owner.setflags(write=False)
        owner = owner.base
    return values


def raw_channels(names: Iterable[str], shaft: str) -> tuple[str, ...]:
    """The raw channels (``a``, ``b``, ``index``, ``count``) of one shaft among the column names."""
    held = set(names)
    return tuple(channel for channel in RAW_CHANNELS if f"{shaft}_{channel}" in held)


def check_complete(file: Path, where: str, names: Collection[str]) -> None:
    """Raise ``InputFileError`` unless the columns suffice: both angles, or a transmission error
    and one angle; raw channels ``a`` or ``count`` stand for an angle.
    """
    te = [name for name in names if name in TE_COLUMNS]
    missing = []
    for shaft, angle in zip(SHAFTS, ANGLE_COLUMNS, strict=True):
        ways = [angle] if angle in names else []
        raw = raw_channels(names, shaft)
        ways += [f"{shaft}_{channel}" for channel in ("a", "count") if channel in raw]
        if not ways and raw:
            wish = f"want the pulses in {shaft}_a, or the counts in {shaft}_count"
            raise InputFileError(file, where=where, found=f"column {shaft}_{raw[0]} alone", wish=wish)
        if f"{shaft}_b" in names and f"{shaft}_a" not in names:
            wish = f"want both, {shaft}_a and {shaft}_b (or the only channel as {shaft}_a)"
            raise InputFileError(file, where=where, found=f"column {shaft}_b without {shaft}_a", wish=wish)
        if not ways:
            missing.append(angle)
    if len(missing) > (1 if te else 0):
        both, any_te = " and ".join(ANGLE_COLUMNS), ", ".join(TE_COLUMNS)
        wish = f"want both {both}, or one of them and a column of {any_te}"
        if te and "time_s" in names:
            wish += (
                "; where the shaft turns evenly and its time alone was logged, add a column "
                "driven_angle_deg = 360 time_s / (seconds of a turn)"
            )
        raise InputFileError(file, where=where, found=f"no column {' and no '.join(missing)}", wish=wish)


def check_key(file: Path, where: str, key: str, value: object) -> None:
    """Raise ``InputFileError`` unless the known key ``key`` may have ``value``, in the units of the
    file.
    """
    number = math.nan
    if isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value) if abs(value) < LARGEST_NUMBER else math.inf
    if key == "flank":
        good, want = value in ("drive", "coast"), '"drive" or "coast"'
    elif key == "reversed":
        # Formats that know no truth values hold 1 or 0.
        good, want = isinstance(value, bool) or number in (0.0, 1.0), "true where the pair ran backwards, or false"
    elif key.endswith("_direction"):
        good, want = number in (1.0, -1.0), "1, or -1 where the encoder counts down"
    elif key.endswith("_zero_deg"):
        good, want = math.isfinite(number), "the reading in deg at angle zero, a finite number"
    elif key == "torque_nm":
        good, want = 0.0 <= number < math.inf, "a torque in N.m, 0 or more (the flank says which way it acts)"
    elif key.endswith("_lines"):
        good, want = (
            number >= 1.0 and number.is_integer(),
            "the lines of the encoder's disc, a whole number as on its label or data sheet: 1024",
        )
    elif key.endswith("_counts_per_line"):
        good, want = number in (1.0, 2.0, 4.0), "1, 2 or 4 counts per line, as the counter was set"
    elif key.endswith("_count_bits"):
        good = 2.0 <= number <= COUNT_BITS_LIMIT and number.is_integer()
        want = f"the width of the counter in bits, a whole number from 2 to {COUNT_BITS_LIMIT}"
    elif key.endswith("_count_modulus"):
        good = 2.0 <= number <= 2.0**COUNT_BITS_LIMIT and number.is_integer()
        want = "the number at which the counter goes round to 0, a whole number from 2"
    elif key == "sample_rate_hz":
        good, want = 0.0 < number < math.inf, "samples per second, above 0"
    else:
        good, want = 0.0 < number < math.inf, "a speed in rpm, above 0 (leave it out where it is not known)"
    if not good:
        raise InputFileError(file, where=where, found=f"{key} = {shown_value(value)}", wish=f"want {want}")


def _check_angles(file: Path, name: str, values: FloatArray) -> None:
    """Raise ``InputFileError`` with the row where an angle (n,) in deg is none that an encoder counts to."""
    with np.errstate(over="ignore", invalid="ignore"):
        if float(np.dot(values, values)) <= ANGLE_LIMIT_DEG**2:  # one quick pass; nan where any reading is
            return
    if max(float(np.fmax.reduce(values)), -float(np.fmin.reduce(values))) <= ANGLE_LIMIT_DEG:
        return
    row = int(np.nanargmax(np.abs(values)))
    wish = f"want an angle of at most {ANGLE_LIMIT_DEG:g} deg; leave that reading out (an empty cell or nan)"
    raise InputFileError(file, where=f"column {name}, row {row + 1}", found=f"{in_full(values[row])} deg", wish=wish)


def recording_from_columns(
    file: Path,
    columns: Mapping[str, FloatArray],
    keys: Mapping[str, object],
    remarks: Iterable[str] = (),
    *,
    places: Mapping[str, float] | None = None,
    entries: Mapping[str, str] | None = None,
) -> Recording:
    """The recording that a reader found under the contract's names and units.

    ``columns`` holds arrays (n,) by column name, complete as :func:`check_complete` wants, without raw channels; the
    arrays are taken over and may be written to. ``keys`` holds values that passed :func:`check_key`, ``places`` half of
    the last place of columns that follow from others, ``entries`` the lines of a map that give columns. Raises
    ``InputFileError`` where a column holds no number at all.
    """
    for name, values in columns.items():
        if np.isnan(values[0]) and np.isnan(values).all():
            wish = "want numbers in it, or no such column"
            raise InputFileError(file, where=f"column {name}", found="not one number", wish=wish)
        if name in ANGLE_COLUMNS:
            _check_angles(file, name, values)

    def scaled(name: str, unit: float) -> FloatArray | None:
        return _taken_over(columns[name], unit) if name in columns else None

    def stated(key: str, unit: float = 1.0) -> float | None:
        value = keys.get(key)
        return float(value) * unit if isinstance(value, int | float) else None

    te_unit = {"te_urad": URAD, "te_arcsec": ARCSEC}
    time = columns.get("time_s")
    computed = any(name in columns for name in TE_COLUMNS)
    steady = tuple(
        shaft for shaft, name in zip(SHAFTS, ANGLE_COLUMNS, strict=True)
        if computed and time is not None and name in columns and is_from_time(time, columns[name])
    )  # fmt: skip
    units = {**te_unit, "te_um": UM, "driving_angle_deg": DEG, "driven_angle_deg": DEG}
    return Recording(
        source=file,
        time_s=scaled("time_s", 1.0),
        driving_angle_rad=scaled("driving_angle_deg", DEG),
        driven_angle_rad=scaled("driven_angle_deg", DEG),
        te_rad=next((scaled(name, unit) for name, unit in te_unit.items() if name in columns), None),
        te_mm=scaled("te_um", UM),
        driving_correction_rad=scaled("driving_correction_deg", DEG),
        driven_correction_rad=scaled("driven_correction_deg", DEG),
        torque_samples_nm=scaled("torque_nm", 1.0),
        speed_samples_rpm=scaled("speed_rpm", 1.0),
        torque_nm=stated("torque_nm"),
        speed_rpm=stated("speed_rpm"),
        flank="coast" if keys.get("flank") == "coast" else "drive",
        driving_zero_rad=stated("driving_zero_deg", DEG),
        driven_zero_rad=stated("driven_zero_deg", DEG),
        driving_direction=-1 if stated("driving_direction") == -1.0 else 1,
        driven_direction=-1 if stated("driven_direction") == -1.0 else 1,
        backward=bool(keys.get("reversed", False)),
        from_time=steady,
        last_places={name: half * units[name] for name, half in (places or {}).items()},
        entries=dict(entries or {}),
        remarks=tuple(remarks),
    )
