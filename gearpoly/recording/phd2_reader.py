"""Guide logs of PHD2: what a star shows of the gears that turn a telescope's right-ascension axis.

A row holds how far the star stood off, and the pulse that was then sent to bring it back. The error that the mount
would have had unguided is what is left of the star's offset once all pulses before it, and every re-aiming of the
camera, are undone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import check_file, unreadable
from gearpoly.recording.deeds import so_many
from gearpoly.recording.phd2_sections import PER_MS, GuidingSection, Log, read_log
from gearpoly.recording.reader import RECORDING_LIMIT_BYTES, Reader
from gearpoly.recording.table import AXIS_CORRECTION, AXIS_ERROR, Table
from gearpoly.recording.text.encoding import ENCODING_SAMPLE_BYTES, shown
from gearpoly.units import FloatArray

POLE_DEG = 85.0
"""Declination in deg from which a star's motion says nothing of the axis: the cosine of the declination, by which it is
divided, is then wrong by more than a tenth for half a degree."""

LEAST_SECTION_FRAMES = 64
"""Frames of a section below which it is none: calibrations and trials have a few dozen."""

ROUNDED = 0.005
"""px, rms, within which offsets along the right ascension follow from those along the camera's axes, so that these tell
its direction. Numbers have three decimals: logs of PHD2 leave 0.0004 to 0.0013 px."""

AS_SCALE = 0.02
"""Part by which lengths along the right ascension, over those on the camera, may be off the pixel scale and still be
arcsec instead of px (KStars). Scales are written with two decimals."""

FRAMES_BESIDE_REAIMING = 3
"""Frames on either side of a re-aiming whose median is taken: the air moves single ones."""

TORN = 6.0
"""Robust standard deviations of the steps from frame to frame, beyond which a re-aiming is of another size than its
lock position says. Of the ten dithers of a real log none reached 3."""

LEAST_STEP_SCATTER_PX = 0.01
"""px. Least scatter of the steps that is believed: numbers have three decimals."""

SECTIONS_NAMED = 4
"""Sections that are told one by one; more are counted."""


def recognises(head: bytes) -> bool:
    """Whether a file's first bytes are those of a guide log, in one byte a character or in more."""
    text = head.decode(shown(head) or "latin-1", errors="replace")
    marks = ("Guiding Begins at", "Calibration Begins at", "PHD2 log version")
    return any(mark in text for mark in marks) or text.lstrip("\ufeff \r\n").startswith("PHD2 version")


def read_table(file: Path, part: int | None = None) -> Table:
    """Time, error and pulses of guiding section ``part`` of a log, counted from 1, or of the longest that can be used,
    in s and arcsec of the right-ascension axis; the error is positive where the axis is ahead. Raises
    ``InputFileError`` with the line at fault."""
    check_file(file, limit_bytes=RECORDING_LIMIT_BYTES)
    try:
        with file.open("rb") as start:
            encoding = shown(start.read(ENCODING_SAMPLE_BYTES)) or "utf-8"
        with file.open(encoding=encoding, errors="replace") as stream:  # what is replaced is in names alone
            log = read_log(file, stream)
    except OSError as error:
        raise unreadable(file, error) from None
    if not log.sections:
        held = f" ({_calibrations(log)})" if log.calibrations else ""
        wish = f'want a section "Guiding Begins at ..." with at least {LEAST_SECTION_FRAMES} frames'
        raise InputFileError(file, found=f"a guide log without guiding{held}", wish=wish)
    faults = {one.number: fault for one in log.sections if (fault := fault_of(file, one)) is not None}
    chosen = _chosen(file, log, faults, part)
    if chosen.number in faults:
        raise faults[chosen.number]
    return _table(chosen, list(_others(file, log, chosen, faults)))


def _chosen(file: Path, log: Log, faults: dict[int, InputFileError], part: int | None) -> GuidingSection:
    """The section that is asked for, or the longest without a fault; the longest of all where each has one."""
    if part is not None:
        if not 1 <= part <= len(log.sections):
            wish = f"want a number from 1 to {len(log.sections)}, the guiding sections in this log"
            raise InputFileError(file, found=f"section {part} asked for", wish=wish)
        return log.sections[part - 1]
    good = [one for one in log.sections if one.number not in faults]
    return max(good or log.sections, key=lambda one: (one.seconds, len(one.frames)))


def _calibrations(log: Log) -> str:
    return "1 calibration" if log.calibrations == 1 else f"{log.calibrations} calibrations"


def _others(file: Path, log: Log, chosen: GuidingSection, faults: dict[int, InputFileError]) -> Iterator[str]:
    """What is said of the rest of a log that holds more than one section."""
    if len(log.sections) > 1:
        beside = f" and {_calibrations(log)}" if log.calibrations else ""
        yield (
            f"the log holds {len(log.sections)} guiding sections{beside}; section {chosen.number} was read, begun at "
            f"{chosen.began} (line {chosen.line}, {chosen.seconds / 60.0:.0f} min)"
        )
    good = [one for one in log.sections if one.number not in faults and one is not chosen]
    if good:
        told = [f"{file.name}#{one.number} ({one.seconds / 60.0:.0f} min)" for one in good[:SECTIONS_NAMED]]
        more = f" and {len(good) - SECTIONS_NAMED} more" if len(good) > SECTIONS_NAMED else ""
        yield f"another section is read as {', '.join(told)}{more}: each by itself, since the mount may turn between"
    for number, fault in list(faults.items())[:SECTIONS_NAMED]:
        yield f"section {number} cannot be used: {fault.where}: {fault.found}; {fault.wish}"
    if len(faults) > SECTIONS_NAMED:
        yield f"{len(faults) - SECTIONS_NAMED} more sections cannot be used"


def fault_of(file: Path, section: GuidingSection) -> InputFileError | None:
    """Why a section cannot be used, with a cure; None where it can."""
    if section.fault is not None:
        return section.fault
    where = f"section of line {section.line}"
    if len(section.frames) < LEAST_SECTION_FRAMES:
        found = f"{len(section.frames)} frames, a section without guiding to speak of"
        return InputFileError(file, where=where, found=found, wish=f"want at least {LEAST_SECTION_FRAMES} frames")
    known = section.header
    if not known.get("scale", 0.0) > 0.0:
        wish = (
            'want a line "Pixel scale = 3.22 arc-sec/px" below "Guiding Begins": write your own there, 206.265 times '
            "the pixel in um over the focal length in mm"
        )
        return InputFileError(file, where=where, found="no Pixel scale", wish=wish)
    if section.pulsed and not known.get("rate", 0.0) > 0.0:
        wish = "want xRate = a number above 0, without which pulses are no angle: calibrate PHD2, and guide again"
        found = f"xRate = {known['rate']:g}" if "rate" in known else "no xRate"
        return InputFileError(file, where=where, found=found, wish=wish)
    if abs(known.get("declination", 0.0)) > POLE_DEG:
        wish = f"want a star within {POLE_DEG:g} deg of the equator; beyond, the axis hardly moves it"
        found = f"a declination of {known['declination']:g} deg"
        return InputFileError(file, where=where, found=found, wish=wish)
    if all(math.isnan(frame.offset) for frame in section.frames):
        wish = "want RARawDistance in the frames: choose a star that PHD2 does not lose, calibrate, and guide again"
        return InputFileError(file, where=where, found="no frame with a star", wish=wish)
    return None


def _table(section: GuidingSection, remarks: list[str]) -> Table:
    known = section.header
    if "declination" not in known:
        remarks.append(
            "the log does not state the declination: errors are taken as on the equator, and may be larger; write "
            f'"Dec = 12.0 deg" with your own value below line {section.line}'
        )
    time = np.array([frame.time for frame in section.frames])
    cosine, sine, norm = direction(section)
    offset = np.array([frame.offset for frame in section.frames])
    if abs(norm / known["scale"] - 1.0) <= AS_SCALE and abs(norm - 1.0) > AS_SCALE:
        offset = offset / norm
        remarks.append("offsets along the right ascension are in arcsec in this log, and taken so")
    if section.commas:
        remarks.append("decimal commas: two cells of a row were taken as one number")
    lost = int(np.sum(np.isnan(offset)))
    if lost:
        remarks.append(so_many(lost, "frames without a star left out"))
    rate = known.get("rate", 0.0) * (1000.0 if known.get("rate", 0.0) < PER_MS else 1.0)
    pulses = np.array([frame.pulse for frame in section.frames])
    sent = rate * np.concatenate(([0.0], np.cumsum(pulses)[:-1]))
    arcsec = known["scale"] / math.cos(math.radians(known.get("declination", 0.0)))
    moved = _re_aimed(section, offset + sent, (cosine, sine), remarks)
    if section.paused:
        remarks.append(f"guiding was paused {so_many(section.paused, 'times')}; the worm is taken to have turned on")
    if section.shifted:
        remarks.append("the lock position was shifted along (LOCK SHIFT), which shows as a slow drift")
    undone = f"pulses of {rate:.4g} px/s undone" if section.pulsed else "no pulses were sent"
    remarks.append(f"guide log: {arcsec:.4g} arcsec of the axis per pixel, {undone}")
    return Table(
        # A star that needs a pulse to the west has run ahead of the axis.
        columns={"time_s": time, AXIS_ERROR: -arcsec * (offset + sent + moved), AXIS_CORRECTION: arcsec * sent},
        keys={},
        remarks=remarks,
    )


def direction(section: GuidingSection) -> tuple[float, float, float]:
    """Cosine and sine of the right ascension's direction on the camera, and the length that frames give a pixel along
    it: from the offsets along both camera axes, or from the header where frames do not have them."""
    held = np.array([(f.x, f.y, f.offset) for f in section.frames])
    held = held[np.isfinite(held).all(axis=1)]
    if len(held) >= LEAST_SECTION_FRAMES // 2 and np.linalg.matrix_rank(held[:, :2]) == 2:
        along = np.linalg.lstsq(held[:, :2], held[:, 2], rcond=None)[0]
        norm = float(np.hypot(*along))
        # The middle one, since frames with a changed star may be written with the offset before.
        left = float(np.median(np.abs(held[:, 2] - held[:, :2] @ along)))
        if norm > 0.0 and left <= ROUNDED * norm:
            return float(along[0]) / norm, float(along[1]) / norm, norm
    angle = math.radians(section.header.get("angle", 0.0))
    return math.cos(angle), math.sin(angle), 1.0


def _re_aimed(section: GuidingSection, star: FloatArray, along: tuple[float, float], remarks: list[str]) -> FloatArray:
    """What re-aimings of the camera moved the star by (n,), in px, from its place ``star`` (n,) with all pulses undone.

    A dither moves the lock position and keeps the star, so the star stands off by as much; another star comes with its
    own lock position, and stands off by nothing, which is taken where it leaves the smaller step by more than the air
    makes. Where both leave more, the camera was moved unseen, and the error is taken to go on.
    """
    moved = np.zeros(star.size)
    seen = np.flatnonzero(np.isfinite(star))
    aim = np.array([frame.aim for frame in section.frames])
    changes = np.flatnonzero(np.diff(aim[seen]) != 0) + 1
    if not changes.size:
        return moved
    steps = np.delete(np.diff(star[seen]), changes - 1)
    scatter = (
        max(LEAST_STEP_SCATTER_PX, float(np.median(np.abs(steps))) / 0.6745) if steps.size else LEAST_STEP_SCATTER_PX
    )
    told, other, torn = 0, 0, 0
    for k in changes:
        before, after = section.aims[aim[seen[k - 1]]], section.aims[aim[seen[k]]]
        shift = 0.0
        if before is not None and after is not None:
            shift = (after[0] - before[0]) * along[0] + (after[1] - before[1]) * along[1]
        step = float(
            np.median(star[seen[k : k + FRAMES_BESIDE_REAIMING]])
            - np.median(star[seen[max(0, k - FRAMES_BESIDE_REAIMING) : k]])
        )
        taken = 0.0 if abs(step) + scatter < abs(step + shift) else shift
        if abs(step + taken) > TORN * scatter:
            taken, torn = -step, torn + 1
        elif before != after:
            told, other = told + (taken == shift), other + (taken != shift)
        moved[seen[k] :] += taken
    if told:
        times, dithers = so_many(told, "times"), so_many(section.dithered, "dithers")
        remarks.append(f"the camera was re-aimed {times} ({dithers}), which is undone")
    if other:
        remarks.append(so_many(other, "times another star was taken, which stands where the first would"))
    if torn:
        remarks.append(f"{torn} re-aimings are of another size than the log says: the error is taken to go on there")
    return moved


READER = Reader(name="PHD2 guide log", endings=(".txt", ".log"), recognises=recognises, read=read_table, parts=True)
