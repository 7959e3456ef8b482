"""From what the fit found to entries: what kind of wave or tooth it is, how large, and how sure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.compare.courses import chances, of_degrees, slow_noise
from gearpoly.compare.entries import IN_TIME, OF_THE_READINGS, Entry, Gear, named
from gearpoly.compare.even import Even, aliases
from gearpoly.compare.families import SHARES
from gearpoly.compare.few_turns import beside_first, beside_order, log_false
from gearpoly.compare.fitted import fitted_wave
from gearpoly.compare.jump_search import has_drift
from gearpoly.compare.lines import TIE
from gearpoly.compare.model import JointModel
from gearpoly.compare.peak import Peak
from gearpoly.compare.regression import Solution
from gearpoly.compare.sampling import SLOWEST
from gearpoly.compare.slow import SLOW_CURVE_TERMS
from gearpoly.keys.also_turns import HALF_A_LINE, SIDE_BANDS
from gearpoly.units import UM

COMPANION = 0.2
"""A second-order companion is at most this part of the wave it comes with: the squares of a deviation over lengths of
the tooth's own size are far smaller."""

ECHO_TOOTH = 0.2
"""Part of the largest tooth find below which another one may be its echo: how far hand-overs move when a tooth is off
is simulated only once that tooth is in the pair file."""

ECHO_GAIN = 0.02
"""The same beside any find, by what it explains."""

ECHO_WAVE = 0.1
"""The same beside the largest wave, which moves all contacts a little."""

PRESENT_CHI2 = 9.2
"""Chi square (2 terms, one chance in a hundred) above which a wave that was found in one recording counts as present in
another."""


def kind_of(search: JointModel, frequency: float) -> tuple[str, Gear | None, float, str, tuple[str, ...]]:
    """Kind, gear, order, label and rivals of a wave at an integer order, ``frequency`` in cycles per mesh."""
    orders = [frequency * search.z_1, frequency * search.z_2]
    whole = [abs(order - round(order)) < 1e-6 * max(order, 1.0) for order in orders]
    if abs(frequency - round(frequency)) < 1e-9:
        return "mesh_order", None, float(round(frequency)), "", ()
    for gear, z in ((0, search.z_1), (1, search.z_2)):
        if not whole[gear]:
            continue
        order = round(orders[gear])
        mesh = round(order / z)
        label = ""
        if mesh >= 1 and abs(order - mesh * z) <= SIDE_BANDS:
            label = f"side band {order - mesh * z:+d} of mesh order {mesh}"
        elif order > z / 2:
            label = "ghost order: no mesh harmonic"
        rivals = (f"order {round(orders[1])} of the driven shaft",) if gear == 0 and whole[1] else ()
        return "shaft_order", GEARS[gear], float(order), label, rivals
    for i in (1, 2):
        for j in (-2, -1, 1, 2):
            if abs(abs(i / search.z_1 + j / search.z_2) - frequency) < 1e-9:
                label = f"{'sum' if j > 0 else 'difference'} of driving order {i} and driven order {abs(j)}"
                return "shaft_order", "driving", orders[0], label, ()
    return (
        "shaft_order",
        "driving",
        orders[0],
        "no integer of either shaft",
        (f"order {orders[1]:.4g} of the driven shaft",),
    )


def label_of(frequency: float, *, z: tuple[int, int], span: float) -> str:
    """What is said of a wave of no known order, ``frequency`` in cycles per mesh, in a record of ``span`` meshes:
    within half a line of a whole order it may be that one."""
    for gear, teeth in zip(GEARS, z, strict=True):
        near = round(frequency * teeth)
        if near > 0 and abs(frequency - near / teeth) * span < HALF_A_LINE:
            return f"within half a line of order {near} of the {gear} shaft"
    return "no integer of either shaft"


def _train(peak: Peak, unit: str, *, scale: float = 1.0) -> str:
    """The train of pulses that a wave belongs to, in words."""
    if not peak.harmonic:
        return ""
    return f"harmonic {peak.harmonic} of pulses at {peak.frequency / peak.harmonic * scale:.4g} {unit}"


def wave_entry(search: JointModel, solution: Solution, k: int, peak: Peak) -> Entry | None:
    """The entry of a wave first seen in recording ``k``; ``None`` where the joint fit leaves nothing of it."""
    share = {"time": SHARES.time}.get(peak.domain, SHARES.orders if peak.known else SHARES.between)
    p_value = float((SHARES.faint if peak.faint else share) * math.exp(min(0.0, peak.log_false)))
    s = search.states[k]
    if peak.domain == "time":
        if peak.frequency * s.sampling.over("time")[2] < SLOWEST:
            return None  # it has settled where a drift says as much: 4 um of three quarters of a wave were told
        wave = fitted_wave(search, solution, k, peak)
        # Of waves found together the strongest stands for all, and others where they stand out beside it.
        if peak.faint and wave.square < PRESENT_CHI2 and not peak.leads:
            return None
        per_hz = s.sampling.pace * search.z_1
        rivals: tuple[str, ...] = (
            () if peak.gain - peak.rival > TIE else (f"order {peak.frequency * per_hz:.4g} of the driving shaft",)
        )
        also = aliases(peak.frequency, s.data.even.time)
        rivals += _meshes_alike([one * s.sampling.pace for one in also], span=s.sampling.span)
        if peak.gain - peak.image <= TIE and s.sampling.time_grid is not None:
            rivals += (f"{s.sampling.alike(peak.frequency):.4g} Hz, which so few samples show alike",)
        return Entry(
            kind="time", hz=peak.frequency, hz_std=peak.std, amplitude_um=wave.amplitude / UM, std_um=wave.std / UM,
            phase_deg=math.degrees(wave.phase), recordings=(k,), p_value=p_value, rivals=rivals, gain=wave.square,
            label=_train(peak, "Hz"), together=peak.faint, aliases=also,
        )  # fmt: skip
    found = {j: fitted_wave(search, solution, j, peak) for j, other in enumerate(search.states) if peak in other.orders}
    best = max(found, key=lambda j: found[j].square)
    wave = found[best]
    strange = s.sampling.strange(np.array([peak.frequency]))[0]
    if (wave.amplitude < search.floor and not strange) or (wave.square < PRESENT_CHI2 and not peak.leads):
        return None
    kind, gear, order, label, rivals = kind_of(search, peak.frequency)
    if peak.few:
        false = log_false(s.sampling, search.states[best].noise, peak, gain=wave.square, recordings=len(search.states))
        if false > 0.0:
            return None
        p_value, rivals = float(SHARES.orders * math.exp(false)), (*rivals, *beside_order(s.sampling, gear, peak.few))
    if not peak.known:
        label = label_of(peak.frequency, z=(search.z_1, search.z_2), span=s.sampling.span)
    if peak.harmonic:
        label = _train(peak, "of the driving shaft", scale=search.z_1)
    z = search.z_2 if gear == "driven" else search.z_1
    if peak.gain - peak.rival <= TIE and s.sampling.time_grid is not None:
        rivals = (*rivals, f"{peak.frequency / s.sampling.pace:.4g} Hz")
    also = _order_aliases(s.data.even, kind, gear, order, z_1=search.z_1)
    if not peak.known:
        rivals = (*rivals, *_meshes_alike([one / z for one in also], span=s.sampling.span))
    return Entry(
        kind="mesh_order" if kind == "mesh_order" else "shaft_order",
        gear=gear,
        order=order,
        order_std=None if peak.known else peak.std * z,
        amplitude_um=wave.amplitude / UM,
        std_um=wave.std / UM,
        amplitude_um_by_recording=tuple(found[j].amplitude / UM for j in sorted(found)) if len(found) > 1 else None,
        phase_deg=math.degrees(wave.phase),
        # A weak line of a train stands out in none by itself.
        recordings=tuple(j for j in sorted(found) if found[j].square > PRESENT_CHI2) or (k,),
        p_value=p_value,
        label=label,
        rivals=rivals,
        gain=wave.square,
        together=peak.faint,
        aliases=also,
    )


def _meshes_alike(per_mesh: Sequence[float], *, span: float) -> tuple[str, ...]:
    """The mesh orders among aliases, in cycles ``per_mesh`` (k,), of a wave in a record of ``span`` meshes, in words:
    above half the sampling rate a mesh order is seen where no pair makes a wave."""
    near = ((one, round(one)) for one in per_mesh)
    return tuple(
        f"mesh order {k}, which so few samples show alike" for one, k in near if abs(one - k) * span < HALF_A_LINE
    )


def _order_aliases(even: Even, kind: str, gear: Gear | None, order: float, *, z_1: int) -> tuple[float, ...]:
    """The orders that samples at even angles show alike: of the shaft of ``gear``, or of the mesh."""
    if kind == "mesh_order":
        return aliases(order, None if even.driving is None else even.driving / z_1)
    return aliases(order, even.driven if gear == "driven" else even.driving)


def with_companions(entries: list[Entry], *, z_1: int, z_2: int, coarse: list[tuple[float, float]]) -> list[Entry]:
    """Mark what a shaft's order 1 brings along by second order: its order 2, side bands of the mesh, and the sums and
    differences with the other shaft; and what the rounding of readings may have made, by the largest wave of it in um
    in each recording, ``coarse``, and the largest at no order of the pair."""
    entries = [_by_rounding(e, z_1=z_1, z_2=z_2, coarse=coarse) for e in entries]
    ones = [e for e in entries if e.kind == "shaft_order" and e.order == 1.0]
    out = []
    for e in entries:
        parent = None
        if e.companion_of is not None:
            out.append(e)
            continue
        if e.kind == "tooth":
            out.append(_echo(e, entries))
            continue
        largest = max(_touching(entries) or [e], key=lambda o: abs(o.amplitude_um or 0.0))
        if (
            e.kind == "shaft_order"
            and e.order_std is None
            and (e.amplitude_um or 0.0) < ECHO_WAVE * abs(largest.amplitude_um or 0.0)
        ):
            out.append(replace(e, companion_of=named(largest)))
            continue
        for one in ones:
            z = z_1 if one.gear == "driving" else z_2
            same = e.gear == one.gear and e.order is not None and e.kind == "shaft_order"
            order = int(e.order) if same and e.order is not None and float(e.order).is_integer() else 0
            second = same and (order == 2 or (order > 2 and min(order % z, -order % z) <= 2))
            mixed = e.label.startswith(("sum of", "difference of"))
            if (second or mixed) and (e.amplitude_um or 0.0) < COMPANION * (one.amplitude_um or 0.0):
                parent = one
        out.append(e if parent is None else replace(e, companion_of=f"order 1 of the {parent.gear} shaft"))
    return out


def _by_rounding(entry: Entry, *, z_1: int, z_2: int, coarse: list[tuple[float, float]]) -> Entry:
    """An entry with its mark if coarse readings could make it, no larger than the first harmonic of their steps: at
    even angles they make waves of any order, and where a shaft turns evenly for a while waves at no order of the pair.
    At the low orders of a shaft, which have no more than half a wave per tooth, it is left to stand: there not one in a
    hundred of such waves falls."""
    size = abs(entry.amplitude_um or 0.0) if entry.rms_um is None else math.sqrt(2.0) * entry.rms_um
    z = z_2 if entry.gear == "driven" else z_1
    low = entry.kind == "shaft_order" and entry.order_std is None and (entry.order or 0.0) <= z / 2
    even, for_a_while = (max(each) for each in zip(*(coarse[k] for k in entry.recordings), strict=True))
    if entry.kind in ("drift", "step"):
        most = for_a_while if for_a_while > even else 0.0  # a pattern without an end leaves neither
    elif entry.kind == "time" or (entry.kind == "shaft_order" and (entry.order or 0.0) % z != 0.0):
        most = for_a_while
    else:
        most = even
    if low or entry.kind == "condition" or size > most:
        return entry
    return replace(entry, companion_of=OF_THE_READINGS)


def _touching(entries: list[Entry]) -> list[Entry]:
    """Those that may move contacts: a wave of no whole order, or of time, belongs to nothing that touches."""
    return [e for e in entries if e.kind not in IN_TIME and e.order_std is None]


def _echo(entry: Entry, entries: list[Entry]) -> Entry:
    """A tooth that stands out a little beside something that stands out a lot may be its second order: contacts
    move."""
    size = abs(entry.amplitude_um or entry.rms_um or 0.0)
    teeth = [e for e in entries if e.kind == "tooth" and abs(e.amplitude_um or 0.0) * ECHO_TOOTH > size]
    waves = [e for e in entries if e.kind == "shaft_order" and (e.amplitude_um or 0.0) * ECHO_WAVE > size]
    largest = max(_touching(entries), key=lambda e: e.gain)
    if entry.gain < ECHO_GAIN * largest.gain and not teeth and not waves:
        return replace(entry, companion_of=named(largest))
    for larger in (teeth, waves):
        if larger:
            return replace(entry, companion_of=named(max(larger, key=lambda e: abs(e.amplitude_um or 0.0))))
    return entry


def drift_entry(search: JointModel, solution: Solution, k: int) -> Entry | None:
    """What the slow curve of recording ``k`` (ramp, bow, S, or more) says beyond what the noise wanders."""
    s = search.states[k]
    if s.jumps and not has_drift(search, k, solution):
        return None
    beta = solution.beta[search.places[k]["slow"][1:]]
    x = s.data.u if s.data.time_s is None else s.data.time_s
    curve = s.slow[:, 1:] @ beta
    bent = s.slow.shape[1] > SLOW_CURVE_TERMS
    if bent:
        beta = of_degrees(x, curve)[1:]
    degree = np.arange(1, beta.size + 1)
    # A Legendre polynomial of degree j turns half j times over the record.
    skip = s.noise.cycles
    at, beside = np.asarray(0.5 * degree, dtype=np.float64), degree.size + 1
    level, doubt = slow_noise(x, solution.left[k], at=at, skip=skip, beside=beside)
    few = next((peak for peak in s.orders if peak.few), None)
    if few is not None and wave_entry(search, solution, k, few) is None:
        few = None  # What does not stand out itself takes nothing of the drift.
    size = beta**2 / ((2.0 * degree + 1.0) / s.data.u.size if few is None else beside_first(s.data.u, s.slow, few))
    tail = chances(size, level, doubt)
    p = float(np.min(tail)) * degree.size * len(search.states)
    values = s.data.residual
    # Beside waves of a few turns curves may cancel one another: a drift is what the whole mismatch has of it.
    if float(np.ptp(curve)) > float(np.ptp(values)):
        curve = s.slow[:, 1:] @ np.linalg.lstsq(s.slow, values, rcond=None)[0][1:]
    amplitude = 0.5 * min(float(np.ptp(curve)), float(np.ptp(values)))
    if bent:
        p = min(p, SHARES.drift)  # a course that bends so often was asked for before
    if p > SHARES.drift or amplitude < search.floor:
        return None
    best = int(np.argmin(tail))
    std = amplitude / math.sqrt(size[best] / math.exp(level[best]))
    return Entry(
        kind="drift",
        amplitude_um=amplitude / UM,
        std_um=std / UM,
        rms_um=float(np.std(curve)) / UM,
        recordings=(k,),
        p_value=p,
        label="drift" if s.data.time_s is not None else "drift over the record, no time given",
        gain=float(size[best] / math.exp(level[best])),
    )
