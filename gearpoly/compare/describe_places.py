"""From what the fit found to entries: single teeth, stretches of the mesh, and conditions that differ."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import chdtrc

from gearpoly.arguments import GEARS
from gearpoly.compare.entries import Entry
from gearpoly.compare.families import SHARES
from gearpoly.compare.model import JointModel
from gearpoly.compare.regression import Solution
from gearpoly.compare.teeth import ToothFind
from gearpoly.units import UM, FloatArray

ANOTHER = 0.02
"""Part by which torque or speed of two recordings differ where the condition is another: rigs keep them to a percent,
and a speed of angles over times is that of its part of a wobble."""

_PHASES = (np.arange(96) + 0.5) / 96.0


def tooth_entries(search: JointModel, solution: Solution, *, numbered: tuple[bool, bool]) -> list[Entry]:
    """One entry for every tooth that stands out, in whatever recordings it does."""
    groups: dict[tuple[int, int, str], list[ToothFind]] = {}
    for find in search.finds:
        groups.setdefault((find.gear, find.tooth, find.flank), []).append(find)
    return [_tooth_entry(search, solution, finds, numbered=numbered) for finds in groups.values()]


def _tooth_entry(
    search: JointModel, solution: Solution, finds: list[ToothFind], *, numbered: tuple[bool, bool]
) -> Entry:
    find = max(finds, key=lambda f: f.gain)
    gear = search.gears[find.gear - 1]
    alike = [j for j, s in enumerate(search.states) if s.data.flank == find.flank]
    members = sorted({j for f in finds for j in (alike if f.recording is None else [f.recording])})
    best = alike[0] if find.recording is None else find.recording
    tooth = next(t for t in search.states[best].teeth if t.find is find)
    knots = search.knots(search.states[best])
    shape = solution.beta[search.places[best][tooth.name]]
    inside = (knots >= find.phase[0] - 1e-9) & (knots <= find.phase[1] + 1e-9)
    rms = float(np.sqrt(np.mean(shape[inside] ** 2))) if inside.any() else abs(find.amplitude)
    rivals: tuple[str, ...] = ()
    if find.rival is not None:
        other, number = find.rival
        name = GEARS[other - 1]
        what = f"{name} tooth {number}" if numbered[other - 1] else f"a tooth of the {name} gear"
        rivals = (f"{what}, which explains nearly as much",)
    sizes = {f.recording: f.amplitude / UM for f in finds if f.recording is not None}
    return Entry(
        kind="tooth",
        gear=GEARS[find.gear - 1],
        tooth=find.tooth if numbered[find.gear - 1] else None,
        encoder_deg=gear.encoder_deg(find.tooth),
        phase=(round(find.phase[0], 4), round(find.phase[1], 4)),
        amplitude_um=find.amplitude / UM,
        std_um=find.std / UM,
        rms_um=rms / UM,
        amplitude_um_by_recording=tuple(sizes[k] for k in sorted(sizes)) if len(sizes) > 1 else None,
        recordings=tuple(members),
        p_value=float(SHARES.teeth * math.exp(min(0.0, find.log_false))),
        rivals=rivals,
        gain=find.gain,
    )


def _mesh_wave(search: JointModel, solution: Solution, k: int) -> FloatArray | None:
    """Mean mesh shape of recording ``k`` by phase, in mm, from its mesh orders; ``None`` without any."""
    s = search.states[k]
    curve = np.zeros(_PHASES.size)
    any_found = False
    for j, peak in enumerate(s.orders):
        if abs(peak.frequency - round(peak.frequency)) < 1e-9:
            a, b = solution.beta[search.places[k]["orders"][2 * j :][:2]]
            angle = 2.0 * np.pi * round(peak.frequency) * _PHASES
            curve += a * np.cos(angle) + b * np.sin(angle)
            any_found = True
    return curve if any_found else None


def phase_entries(search: JointModel, solution: Solution) -> list[Entry]:
    """The stretch of a pitch in which the mean tooth differs most, per flank, and whether one or two pairs carry
    there."""
    out: list[Entry] = []
    for flank in search.flanks:
        members = [k for k, s in enumerate(search.states) if s.data.flank == flank]
        curves = {k: c for k in members if (c := _mesh_wave(search, solution, k)) is not None}
        if not curves:
            continue
        k = max(curves, key=lambda j: float(np.std(curves[j])))
        curve = curves[k] - np.median(curves[k])
        peak = int(np.argmax(np.abs(curve)))
        # Half the peak, same sign: the width at half height.
        inside = curve * np.sign(curve[peak]) > 0.5 * abs(curve[peak])
        if inside.all():
            continue
        low = high = peak
        while inside[(low - 1) % _PHASES.size]:
            low -= 1
        while inside[(high + 1) % _PHASES.size]:
            high += 1
        at = np.arange(low, high + 1) % _PHASES.size
        begin, end = (low / _PHASES.size) % 1.0, ((high + 1) / _PHASES.size - 1e-12) % 1.0
        rms = float(np.sqrt(np.mean(curve[at] ** 2)))
        gains = [p for p in search.states[k].orders if abs(p.frequency - round(p.frequency)) < 1e-9]
        if rms < search.floor:
            continue
        first, last = search.states[k].carried.contact
        middle = _PHASES[at[at.size // 2]]
        double = (middle + math.floor(last - middle)) - (middle + math.ceil(first - middle)) > 0.5
        out.append(
            Entry(
                kind="mesh_phase", phase=(round(begin, 4), round(end, 4)), rms_um=rms / UM,
                recordings=tuple(sorted(curves)),
                p_value=SHARES.orders * math.exp(min(0.0, *(p.log_false for p in gains))),
                label="double contact" if double else "single contact", gain=max(p.gain for p in gains),
            )
        )  # fmt: skip
    return out


def _same_things(search: JointModel, a: int, b: int) -> list[tuple[int, int]]:
    """Places of parameters that mean the same in recordings ``a`` and ``b``: mean, waves fixed to shafts, teeth."""
    one, two = search.places[a], search.places[b]
    pairs = [(int(one["slow"][0]), int(two["slow"][0]))]
    for i, peak in enumerate(search.states[a].orders):
        if peak.known and peak in search.states[b].orders:
            j = search.states[b].orders.index(peak)
            pairs += [(int(one["orders"][2 * i + c]), int(two["orders"][2 * j + c])) for c in (0, 1)]
    for name in one:
        if name.startswith("tooth") and name in two:
            pairs += [(int(x), int(y)) for x, y in zip(one[name], two[name], strict=True)]
    return pairs


def condition_entries(search: JointModel, solution: Solution) -> list[Entry]:
    """Recordings whose difference from simulation is not that of the first of their flank with the least torque."""
    out: list[Entry] = []
    groups = {f: [k for k, s in enumerate(search.states) if s.data.flank == f] for f in search.flanks}
    tests = sum(max(0, len(g) - 1) for g in groups.values()) + (1 if len(groups) > 1 else 0)
    for members in groups.values():
        base = min(members, key=lambda k: (search.states[k].data.torque or 0.0, k))
        for k in members:
            if k != base:
                entry = _condition(search, solution, base, k, tests)
                if entry is not None:
                    out.append(entry)
    return out


def _condition(search: JointModel, solution: Solution, base: int, k: int, tests: int) -> Entry | None:
    pairs = _same_things(search, base, k)
    one, two = np.array(pairs).T
    difference = solution.beta[two] - solution.beta[one]
    c = solution.covariance
    covariance = c[np.ix_(one, one)] + c[np.ix_(two, two)] - c[np.ix_(one, two)] - c[np.ix_(two, one)]
    # The lowest lines' level stands for the noise of the mean, which has no line of its own.
    worst = max(float(np.max(search.states[j].noise.rest_at(np.array([0.0]))[0])) for j in (base, k))
    covariance = covariance * max(1.0, worst)
    values, vectors = np.linalg.eigh(covariance)
    good = values > 1e-9 * values[-1]
    square = float(np.sum((vectors.T @ difference)[good] ** 2 / values[good]))
    p = float(chdtrc(int(good.sum()), square)) * tests
    s, t = search.states[k], search.states[base]
    orders = 2 * sum(1 for peak in t.orders if peak.known and peak in s.orders)
    wave = 0.5 * float(np.sum(difference[1 : 1 + orders] ** 2))
    teeth = float(np.sum(difference[1 + orders :] ** 2)) / max(1, s.carried.z_1 * 12)
    rms = math.sqrt(float(difference[0]) ** 2 + wave + teeth)
    if p > SHARES.condition or rms < search.floor:
        return None
    what = [f"mean {difference[0] / UM:+.2f} um"]
    if wave > 0.0:
        what.append(f"waves {math.sqrt(wave) / UM:.2g} um rms")
    changed = []
    for name, there, here in (("torque", t.data.torque, s.data.torque), ("speed", t.data.speed, s.data.speed)):
        if abs((here or 0.0) - (there or 0.0)) > ANOTHER * max(here or 0.0, there or 0.0):
            changed.append(name)
    return Entry(
        kind="condition", rms_um=rms / UM, recordings=(k,), p_value=p, gain=square,
        turning_um=math.sqrt(wave + teeth) / UM,
        label=f"{', '.join(what)} against recording {base}" + (f"; {' and '.join(changed)} changed" if changed else ""),
    )  # fmt: skip
