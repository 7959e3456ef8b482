"""The search: take the strongest find into the fit, fit everything again, and go on until only noise is left."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.courses import follow_courses
from gearpoly.compare.faint import faint_waves
from gearpoly.compare.families import SHARES, log_tail_line
from gearpoly.compare.jump_search import next_jump, put_in_sudden, standing_only
from gearpoly.compare.lines import TIE, find_peaks
from gearpoly.compare.masked import masked_wave, settle_waves
from gearpoly.compare.model import JointModel, State
from gearpoly.compare.noise import mean_innovation
from gearpoly.compare.peak import Peak
from gearpoly.compare.regression import Solution
from gearpoly.compare.sampling import FOOT_OF_PEAK_LINES
from gearpoly.compare.take import SAME_WAVE_LINES, take_tooth, take_waves, without_echoes
from gearpoly.compare.teeth import ToothFind, make_cells, scan_teeth, tooth_information
from gearpoly.threads import each

MOST_ROUNDS = 14
"""Most rounds of find and refit."""

ONE_BY_ONE = 5
"""Rounds in which one tooth at a time is taken, since its neighbours may be its echo; later ones are taken together."""

FAINT_GAIN_PART = 0.005
"""Part of the largest find's gain below which later rounds are not worth their time: what so large a find leaves,
once it is in the pair file, is looked at anew."""

MOST_FINDS = 40
"""Finds after which the search stops: so many mean that the pair file or the alignment is wrong as a whole."""

SHOWN_SAMPLES_PER_MESH, SHOWN_SAMPLES_OF_TOOTH = 2.0, 16.0
"""Samples per mesh below which the mesh itself does not show, and those on a part of a tooth that it takes then. On a
real guide log of 1.1 samples per mesh 8 frames of 611 were told as a tooth 22 um low. A judgement."""

RIVALRY = 30.0
"""Ratio of gains within which a tooth and a wave are both tried before one is taken, and a jump before either."""

CALMER = 0.8
"""Noise over that in which no jump stood, from which on jumps are looked for again, and at the end: a wave that is
found meanwhile leaves them as they were. Looked for after every find, jumps that never stood took 25 of 37 s with two
recordings of worn teeth; the jumps of all tests are found with it."""

OUTLYING, ALONE_SIGMAS = 6.0, 4.0
"""Standard deviations of what was known of a tooth by which the fit may move it, and times what it moves the median
tooth of its gear: a tooth 5 um proud of an inspection to 0.3 um was taken for as built, at 15 of these, and what it did
to hand-overs was told as ten orders and its two neighbours. Of another gear's sheet all teeth are moved alike."""

FOLLOWED_WAVE, FOLLOWED_TOOTH = 0.03, 0.12
"""Parts of the as-built teeth's own signal that the linear sharing does not follow (contact points move, stiffness is
not constant): a wave's amplitude over the rms, and the rms over one tooth's contact. An inspection leaves little to
follow, a grade much."""


def order_candidates(search: JointModel, k: int, solution: Solution) -> list[Peak]:
    """Integer orders in recording ``k``, weighed against all that is fitted already and its priors."""
    s, stack = search.states[k], search.stacks[k]
    searched = s.sampling.searched
    if not np.any(searched):
        return []
    tests = s.sampling.orders.frequency.size * len(search.states)
    frequency = s.sampling.orders.frequency[searched]
    gain = s.noise.gain(frequency, spacing=s.sampling.spacing)
    places, cross, own = stack.against(s.sampling.wave_sums, gain)
    white = s.noise.whitened(solution.left[k])
    total = np.conj(gain) * s.sampling.order_grid.transform(white)[s.sampling.known[searched]]
    score = np.stack([total.real, -total.imag], axis=1)
    rest, count = s.noise.rest_at(frequency)
    alone = own[:, 0, 0].copy()
    # Of the parameters of other recordings a wave of this one knows nothing.
    known = solution.covariance[np.ix_(places, places)]
    for b in range(2):
        taken = known @ cross[:, :, b]
        for a in range(2):
            own[:, a, b] -= np.einsum("ij,ij->j", cross[:, :, a], taken)
    good = np.linalg.eigvalsh(own)[:, 0] > 1e-4 * alone
    z = np.zeros(frequency.size)
    z[good] = 0.5 * np.einsum("fi,fij,fj->f", score[good], np.linalg.inv(own[good]), score[good]) / rest[good]
    log_false = math.log(tests / SHARES.orders) + log_tail_line(z, count)
    # What the simulation itself cannot resolve is no find.
    amplitude = np.zeros(frequency.size)
    amplitude[good] = np.linalg.norm(np.linalg.solve(own[good], score[good][:, :, None])[:, :, 0], axis=1)
    take = (log_false < 0.0) & (amplitude > max(search.floor, FOLLOWED_WAVE * search.built_rms))
    return [
        Peak(domain="order", frequency=float(frequency[j]), std=0.0, gain=2.0 * float(z[j]),
             log_false=float(log_false[j]), known=True)
        for j in np.flatnonzero(take)
    ]  # fmt: skip


def all_wave_candidates(search: JointModel, solution: Solution) -> list[list[Peak]]:
    """Waves in what is left of each recording, the strongest first."""
    return each(lambda k: wave_candidates(search, k, solution), range(len(search.states)))


def wave_candidates(search: JointModel, k: int, solution: Solution) -> list[Peak]:
    """Waves in what is left of recording ``k``, the strongest first."""
    s = search.states[k]
    known = order_candidates(search, k, solution)
    white = s.noise.whitened(solution.left[k])
    other = [p for p in find_peaks(s.sampling, white, s.noise, recordings=len(search.states)) if not p.known]
    taken = [p.frequency for p in s.orders]
    fresh = [p for p in known if all(abs(p.frequency - f) * s.sampling.period > 0.01 for f in taken)]
    for p in other:
        if _taken(s, p):
            continue
        # Within a line or so, a wave of any frequency has to explain more than the integer order beside it.
        near = [q for q in fresh if q.known and s.sampling.lines_from(p, q.frequency) < FOOT_OF_PEAK_LINES]
        if _above_floor(search, s, p) and all(p.gain > q.gain + TIE for q in near):
            fresh = [q for q in fresh if q not in near] + [p]
    return sorted(fresh, key=lambda p: -p.gain)


def _taken(s: State, peak: Peak) -> bool:
    """Whether a wave of the fit is as good as this one. What one wave leaves at its own frequency swells or fades,
    and of any number of waves so near each other no size is told."""
    held = s.times if peak.domain == "time" else s.orders
    span = s.sampling.over(peak.domain)[2]
    return any(abs(p.frequency - peak.frequency) * span < SAME_WAVE_LINES for p in held if p.domain == peak.domain)


def _above_floor(search: JointModel, s: State, peak: Peak) -> bool:
    """Whether a wave of any frequency is more than what the simulation does not follow, which repeats with the
    pair."""
    lines = s.sampling
    frequency = lines.per_mesh(peak)
    if lines.strange(np.array([frequency]))[0]:
        return True
    repeats = lines.repeats(np.array([frequency]))[0]
    least = max(search.floor, FOLLOWED_WAVE * search.built_rms if repeats else 0.0)
    gain = float(np.abs(s.noise.gain(np.array([frequency]), spacing=lines.spacing))[0])
    return 2.0 * math.sqrt(0.5 * peak.gain / s.data.u.size) / gain > least


def faint_candidates(search: JointModel, solution: Solution) -> list[list[Peak]]:
    """Waves, per recording, that stand out together only."""
    whites = [s.noise.whitened(left) for s, left in zip(search.states, solution.left, strict=True)]
    found = faint_waves([s.sampling for s in search.states], whites, [s.noise for s in search.states])
    for s, peaks in zip(search.states, found, strict=True):
        for peak in peaks:
            taken = [p for p in (s.times if peak.domain == "time" else s.orders) if p.domain == peak.domain]
            span = s.sampling.over(peak.domain)[2]
            if peak.leads and not _above_floor(search, s, peak):
                return [[] for _ in found]
            if any(abs(peak.frequency - p.frequency) * span < FOOT_OF_PEAK_LINES for p in taken):
                return [[] for _ in found]
    return found


def tooth_candidates(search: JointModel, solution: Solution) -> list[ToothFind]:
    out: list[ToothFind] = []
    taken = {(f.gear, f.tooth, f.recording, f.flank) for f in search.finds}
    precision = search.built_precision()
    for flank_at, flank in enumerate(search.flanks):
        members = [k for k, s in enumerate(search.states) if s.data.flank == flank]
        group = [search.states[k] for k in members]
        scores = [s.noise.score(s.noise.whitened(solution.left[k])) for k, s in zip(members, group, strict=True)]
        samples = min(s.data.u.size for s in group)
        begin, end = zip(*(s.carried.contact for s in group), strict=True)
        contact = min(begin), max(end)
        for gear, first, z in ((1, 0, search.z_1), (2, 2 * search.z_1, search.z_2)):
            cells = []
            for s in group:
                weight = s.carried.weights(search.deviation(s))
                cells.append(make_cells(s.carried, weight, gear=gear, coast=s.coast, samples=samples, contact=contact))
            at = flank_at * search.tooth_parameters + first
            information = tooth_information(
                cells, [s.noise for s in group], precision=(float(precision[at]), float(precision[at + z]))
            )
            beside = search.z_1 + search.z_2 - z + (len(search.flanks) - 1) * (search.z_1 + search.z_2)
            finds = scan_teeth(cells, scores, information, tests_beside=beside)
            for find in finds:
                which = None if find.recording is None else members[find.recording]
                if (find.gear, find.tooth, which, flank) not in taken:
                    out.append(replace(find, recording=which, flank=flank))
    each = sum(s.data.u.size for s in search.states) / len(search.states) / max(search.z_1, search.z_2)
    level = min(s.noise.innovation for s in search.states)
    least = each * (FOLLOWED_TOOTH * search.built_rms / level) ** 2
    out = [f for f in out if abs(f.amplitude) > search.floor and f.gain > least and _is_shown(search, f)]
    return sorted(out, key=lambda f: -f.gain)


def _is_shown(search: JointModel, find: ToothFind) -> bool:
    """Whether enough samples fall on the part of a tooth that stands out, where the mesh itself does not show."""
    z, width = (search.z_1, search.z_2)[find.gear - 1], find.phase[1] - find.phase[0]
    alike = [k for k, s in enumerate(search.states) if s.data.flank == find.flank]
    mine = [search.states[k] for k in (alike if find.recording is None else [find.recording])]
    if any(s.data.u.size >= SHOWN_SAMPLES_PER_MESH * float(np.ptp(s.data.u)) for s in mine):
        return True
    return sum(s.data.u.size for s in mine) * width / z >= SHOWN_SAMPLES_OF_TOOTH


def contradicted_teeth(search: JointModel) -> list[ToothFind]:
    """Teeth that the fit has moved far against what was known of them, where their fellows stay, farthest first:
    they stand out by all of that. What is left beside them are hand-overs of their neighbours, larger than all that
    they still pay."""
    out: list[ToothFind] = []
    taken = {(f.gear, f.tooth, f.flank) for f in search.finds}
    for at, flank in enumerate(search.flanks):
        contact = next(s.carried.contact for s in search.states if s.data.flank == flank)
        for gear, first, z in ((1, 0, search.z_1), (2, 2 * search.z_1, search.z_2)):
            std = search.gears[gear - 1].prior_std[0]
            start = at * search.tooth_parameters + first
            pull = search.beta_built[start : start + z] / std
            tooth = int(np.argmax(np.abs(pull)))
            far = abs(float(pull[tooth]))
            if far < max(OUTLYING, ALONE_SIGMAS * float(np.median(np.abs(pull)))) or (gear, tooth, flank) in taken:
                continue
            find = ToothFind(
                gear=gear, tooth=tooth, phase=contact, amplitude=std * float(pull[tooth]),
                std=std, gain=far**2, log_false=math.log(z / SHARES.teeth) - 0.5 * far**2, recording=None,
                flank=flank,
            )  # fmt: skip
            out.append(find)
    return sorted(out, key=lambda find: -find.gain)


def run_search(
    search: JointModel, over: Callable[[], bool] = lambda: False, *, likely: Sequence[float] = ()
) -> Solution:
    """Look until nothing stands out, or until time is ``over``: the strongest finds are taken even then. ``likely``:
    whole orders in cycles per mesh that were found before, which are taken as soon as they stand out again."""
    put_in_sudden(search)
    solution = search.fit(passes=3)
    for _ in range(2):
        search.renew_noise(solution)
        solution = search.fit(passes=1)
    solution = standing_only(search, solution)
    largest, refused_at = 0.0, math.inf
    for turn in range(MOST_ROUNDS):
        against = contradicted_teeth(search)
        if against:
            take_tooth(search, against)
            solution = _settled_waves(search, search.fit(passes=3))
            continue
        if len(search.finds) + max(len(s.orders) + len(s.times) + len(s.jumps) for s in search.states) > MOST_FINDS:
            break
        if turn >= ONE_BY_ONE and over():
            break
        waves = all_wave_candidates(search, solution)
        teeth = tooth_candidates(search, solution)
        best_wave = max((w[0].gain for w in waves if w), default=0.0)
        best_tooth = teeth[0].gain if teeth else 0.0
        best = max(best_wave, best_tooth)
        # A jump raises the noise under its own gain more than under a wave's, until it is fitted.
        if noise_level(search) < CALMER * refused_at:
            solution, jumped = next_jump(search, solution, least=best / RIVALRY)
            if jumped:
                continue
            refused_at = noise_level(search)
        if best == 0.0:
            waves = faint_candidates(search, solution)
            best_wave = best = max((peaks[0].gain for peaks in waves if peaks), default=0.0)
            # A train of pulses comes first: the one of its lines that stands out would be taken for a wave.
            if best == 0.0:
                solution, more = next_masked(search, solution)
                if not more:  # last, since curves that bend so often would take slow waves as well
                    solution, more = follow_courses(search, solution)
                if more:
                    continue
        largest = max(largest, best)
        if best == 0.0 or (turn >= ONE_BY_ONE and best < FAINT_GAIN_PART * largest):
            if noise_level(search) == refused_at:
                break
            solution, jumped = next_jump(search, solution, least=best / RIVALRY)
            if not jumped:
                break
            continue
        search.refused = []
        faint = list[Peak]()
        if _tooth_first(search, waves, best_wave, teeth):
            for _ in range(1 if turn < ONE_BY_ONE else 4):
                if teeth:
                    take_tooth(search, teeth)
                    teeth = [t for t in teeth[1:] if (t.gear, t.tooth) != (teeth[0].gear, teeth[0].tooth)]
        else:
            faint = take_waves(search, waves, best_wave, likely=likely)
        solution = _settled_waves(search, search.fit(passes=3 if search.finds else 2))
        if without_echoes(search, solution, faint):
            solution = search.fit(passes=1)
    return solution


def noise_level(search: JointModel) -> float:
    """Rms in mm of the innovations of all recordings."""
    return mean_innovation([s.noise for s in search.states])


def _settled_waves(search: JointModel, solution: Solution) -> Solution:
    """The noise renewed and the waves of no known order moved to where everything else leaves them."""
    search.renew_noise(solution)
    solution = search.fit(passes=1)
    if settle_waves(search, solution):
        search.renew_noise(search.fit(passes=1))
        solution = search.fit(passes=1)
    return solution


def next_masked(search: JointModel, solution: Solution) -> tuple[Solution, bool]:
    """Take the strongest wave of every recording that hides in the noise it raised; the solution, and whether there
    is one."""
    unmasked = False
    for s, left, places in zip(search.states, solution.left, search.places, strict=True):
        # In noise that seems to wander slow curves are hardly weighed: they are drawn anew.
        whole = left + s.slow @ solution.beta[places["slow"]]
        found = masked_wave(s.sampling, s.estimator, s.slow, whole, recordings=len(search.states), floor=search.floor)
        if found is None:
            continue
        peak, s.noise = found.peak, found.noise
        held = s.times if peak.domain == "time" else s.orders
        if not any(p.domain == peak.domain and p.frequency == peak.frequency for p in held):
            held.append(peak)
            unmasked = True
    return (_settled_waves(search, search.fit(passes=1)), True) if unmasked else (solution, False)


def _tooth_first(search: JointModel, waves: list[list[Peak]], best_wave: float, teeth: list[ToothFind]) -> bool:
    """Whether the best tooth explains more than the best waves.

    Where neither is far ahead both are tried: a score says how likely a find is if all else is as fitted, and teeth
    that stand in for a wave not yet found are not.
    """
    best_tooth = teeth[0].gain if teeth else 0.0
    if not RIVALRY * best_wave > best_tooth > best_wave / RIVALRY:
        return best_tooth > best_wave
    misfit = []
    for tooth in (True, False):
        kept = [(list(s.orders), list(s.times), list(s.teeth), dict(s.wander)) for s in search.states]
        finds = list(search.finds)
        built = search.beta_built.copy()
        if tooth:
            take_tooth(search, teeth)
        else:
            take_waves(search, waves, best_wave)
        misfit.append(search.fit(passes=1).misfit)
        for s, (orders, times, shapes, wander) in zip(search.states, kept, strict=True):
            s.orders, s.times, s.teeth, s.wander = orders, times, shapes, wander
        search.finds, search.beta_built = finds, built
    return misfit[0] < misfit[1]
