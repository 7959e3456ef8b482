"""Every figure that a diagnosis has to reach, from the scores of many cases."""

from __future__ import annotations

from collections.abc import Sequence

from gearpoly.prove.row import Row, at_least, at_most, figure, once
from gearpoly.prove.said import said_rows
from gearpoly.prove.score import CaseScore, Parameter
from gearpoly.prove.statistics import quantile, share
from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.truth import WRONG_FILE

WAVE_PHYSICS = ("eccentricity", "undulation", "cumulative_pitch")
"""Physics that are one line at a shaft's order, with their amplitude in um along the line of action."""


def rows(scores: Sequence[CaseScore], limits: Thresholds) -> list[Row]:
    """All rows of the scoreboard."""
    healthy = [one for one in scores if one.truth.kind == "none"]
    missing = [one for one in scores if one.truth.kind == "missing"]
    strangers = [one for one in scores if one.truth.kind == "unknown"]
    return [
        *_healthy(healthy, limits),
        *_found(missing, limits),
        *_sets(missing, limits),
        *_smallest(missing, limits),
        *_parameters(missing, limits),
        *_rms(missing, limits),
        *_strangers(strangers, limits),
        *_beside(scores, limits),
        *said_rows(scores, limits),
        *_cost(scores),
    ]


def _healthy(healthy: list[CaseScore], limits: Thresholds) -> list[Row]:
    goal = limits.goal["false_alarms"]
    hard = [one for one in healthy if one.truth.tempting]
    return [
        at_most(
            "false_alarms", "false alarms: healthy, yet something named or left unexplained",
            [(one.name, one.reported) for one in healthy], goal,
        ),
        at_most(
            "false_alarms_60um", "the same, beneath 60 um of eccentricity and in coloured noise",
            [(one.name, one.reported) for one in hard], goal,
        ),
        at_most("false_names", "healthy, yet a physics named", [(one.name, one.claims > 0) for one in healthy], goal),
    ]  # fmt: skip


def _large(one: CaseScore, limits: Thresholds) -> bool:
    return one.truth.over_limit >= limits.detected_from


def _found(missing: list[CaseScore], limits: Thresholds) -> list[Row]:
    large = [one for one in missing if _large(one, limits)]
    single = [one for one in missing if len(one.items) == 1 and one.items[0].item.separable(limits)]
    several = [one for one in missing if len(one.items) > 1 and all(i.item.separable(limits) for i in one.items)]
    teeth = [(one.name, i) for one in missing for i in one.items if i.item.tooth is not None and i.named]
    least = f"{limits.separable:g}"
    return [
        at_least(
            "detected", f"detected from {limits.detected_from:g} times the theoretical limit on",
            [(one.name, one.reported) for one in large], limits.goal["detected"],
        ),
        at_least(
            "named_first", f"right physics and right tooth first, separability times size above {least} of every rival",
            [(one.name, one.items[0].first) for one in single], limits.goal["named_first"],
            note="rivals only, as published until November 2026",
        ),
        at_least(
            "named_first_unknown", "the same, of every rival and of the unknown at its place",
            [(one.name, one.items[0].first) for one in single if one.items[0].item.earned(limits)],
            limits.goal["named_first"],
        ),
        at_least(
            "named_first_shape", "the same, and by what no unknown can make whatever its freedoms cost",
            [(one.name, one.items[0].first) for one in single if one.items[0].item.seen_by_shape(limits)], None,
        ),
        at_least(
            "both_named", "all of several at once named rightly, each separable as above",
            [(one.name, all(i.placed or i.in_set for i in one.items)) for one in several], limits.goal["both_named"],
            note="a look-alike that names the truth as its rival counts",
        ),
        at_least(
            "right_tooth", "right tooth, where the right physics of a tooth was named",
            [(name, i.placed) for name, i in teeth], None,
        ),
        at_most(
            "extras", "single effects with a further claim that stands for nothing",
            [(one.name, one.extras > 0) for one in missing if len(one.items) == 1], None,
        ),
    ]  # fmt: skip


def _sets(missing: list[CaseScore], limits: Thresholds) -> list[Row]:
    single = [one for one in missing if len(one.items) == 1 and one.claims]
    sizes = [float(i.set_size) for one in missing for i in one.items if i.set_size is not None]
    alike = [
        (one.name, i.singly) for one in missing for i in one.items
        if i.item.alike(limits) and i.set_size is not None
    ]  # fmt: skip
    middle, goal = quantile(sizes, 0.5), limits.goal["set_size"]
    return [
        at_least(
            "in_reported_set", "truth within the reported set, where anything was named",
            [(one.name, one.items[0].in_set) for one in single], limits.goal["in_reported_set"],
        ),
        figure(
            "set_size", "median size of the reported set", middle, "", goal=f"at most {goal:g}",
            reached=None if middle is None else middle <= goal,
        ),
        at_most(
            "look_alikes_named_singly", "true look-alikes named singly", alike, limits.goal["look_alikes_named_singly"]
        ),
    ]  # fmt: skip


def _smallest(missing: list[CaseScore], limits: Thresholds) -> list[Row]:
    relief = [
        (one.name, i) for one in missing for i in one.items
        if len(one.items) == 1 and i.item.physics == "tip_relief" and one.truth.klass == "masked"
    ]  # fmt: skip
    near = limits.relief_within_um
    return [
        _least(missing, limits, "smallest_tooth_pitch_um", ("tooth_pitch",), "tooth pitch error", "ten hunting cycles"),
        _least(missing, limits, "smallest_order_line_um", WAVE_PHYSICS, "order line of the gears", "ten turns"),
        at_least(
            "relief_named", f"2 um relief under 60 um of eccentricity: named, to {near:g} um",
            [(name, any(p.main and abs(p.off) <= near for p in i.parameters)) for name, i in relief],
            limits.goal["relief_named"],
        ),
        at_least("relief_found", "the same: named, whatever its size", [(n, i.placed) for n, i in relief], None),
    ]  # fmt: skip


def _least(
    missing: list[CaseScore], limits: Thresholds, key: str, physics: tuple[str, ...], what: str, time: str
) -> Row:
    """The smallest size from which on all were named, in the cases that are made to ask for it."""
    sizes = []
    for one in missing:
        for i in one.items:
            um = [abs(v) for name, v in i.item.parameters.items() if name.endswith("_um")]
            if one.truth.klass == "smallest" and i.item.physics in physics and um:
                sizes.append((um[0], one.name, i.placed or i.in_set))
    right = []
    for size, _, good in sorted(sizes, reverse=True):
        if not good:
            break
        right.append(size)
    goal, value = limits.goal[key], min(right, default=None)
    return Row(
        key=key, text=f"smallest {what} from which on all are named ({time}, 1 um of noise)", value=value, unit="um",
        goal=f"at most {goal:g} um", reached=(value is not None and value <= goal + 1e-12) if sizes else None,
        cases=once(name for _, name, good in sorted(sizes) if not good),
        note=f"{sum(good for *_, good in sizes)} of {len(sizes)} of {min(sizes)[0]:.2g} to {max(sizes)[0]:.2g} um named"
        if sizes else "",
    )  # fmt: skip


def _parameters(missing: list[CaseScore], limits: Thresholds) -> list[Row]:
    every = [(one.name, i, p) for one in missing for i in one.items for p in i.parameters]
    main = [(name, i, p) for name, i, p in every if p.main]
    # Where a rival is as good, the size is that of either: only what can be told apart has an error to speak of.
    alone = [(name, p) for name, i, p in main if not i.item.alike(limits)]
    low, high = limits.goal["coverage"]
    two = share([p.within(2.0) for _, _, p in every])
    # Errors stated too small show as a rate below; too large ones only where so many were right that it is no chance.
    covered = low <= two.rate and two.low <= high if two.of else None
    return [
        at_least(
            "parameter_right", f"sizes right to {100 * limits.relative:g} % or {limits.sigmas:g} stated sigma",
            [(name, _right(p, limits)) for name, _, p in main], None,
        ),
        figure(
            "parameter_error", "median relative error of the sizes that no look-alike blurs",
            quantile([p.relative for _, p in alone], 0.5), "",
        ),
        at_least("coverage_1", "1-sigma coverage of stated errors", [(n, p.within(1.0)) for n, _, p in every], None),
        Row(
            key="coverage_2", text="2-sigma coverage of stated errors", share=two,
            goal=f"{100 * low:g} to {100 * high:g} %", reached=covered,
            cases=once(name for name, _, p in every if not p.within(2.0)),
        ),
    ]  # fmt: skip


def _right(p: Parameter, limits: Thresholds) -> bool:
    return p.relative <= limits.relative or p.within(limits.sigmas)


def _rms(missing: list[CaseScore], limits: Thresholds) -> list[Row]:
    least = limits.mismatch_over_noise
    removed = [
        (one.name, one.removed) for one in missing
        if _large(one, limits) and one.removed is not None and one.mismatch > (least * one.truth.noise_um) ** 2
    ]  # fmt: skip
    goal = limits.goal["energy_removed"]
    middle = quantile([part for _, part in removed], 0.5)
    ratio = [one.after / one.truth.noise_um for one in missing if one.after is not None and one.truth.noise_um]
    return [
        figure(
            "energy_removed", "repeatable mismatch energy removed on held-out data, median",
            middle, "", goal=f"at least {100 * goal:g} %", reached=None if middle is None else middle >= goal,
        ),
        at_least(
            "energy_removed_share", f"cases in which {100 * goal:g} % of it was removed",
            [(name, part >= goal) for name, part in removed], None,
        ),
        figure("noise_ratio", "held-out rms after the fit over the true noise, median", quantile(ratio, 0.5), ""),
        figure("noise_ratio_95", "the same, 95th percentile", quantile(ratio, 0.95), ""),
    ]  # fmt: skip


def _strangers(strangers: list[CaseScore], limits: Thresholds) -> list[Row]:
    return [
        at_least(
            "strangers_located",
            f"effects outside the catalogue located, from {limits.detected_from:g} times the theoretical limit on",
            [(one.name, one.located) for one in strangers if _large(one, limits)], limits.goal["strangers_located"],
        ),
        at_most(
            "strangers_named", "effects outside the catalogue given a false name",
            [(one.name, one.claims > 0) for one in strangers], limits.goal["strangers_named"],
        ),
    ]  # fmt: skip


def _beside(scores: Sequence[CaseScore], limits: Thresholds) -> list[Row]:
    """What lies beside something concealed, or beside nothing, and is of no physics; no goal was set for it."""
    waves = [(one.name, item, found) for one in scores for item, found in one.background]
    loud = [(name, found) for name, item, found in waves if item.over_limit >= limits.detected_from]
    faint = [one for one in scores if one.truth.kind == "none" and one.background]
    return [
        at_least(
            "background_located",
            f"background located, wave by wave, from {limits.detected_from:g} times its own theoretical limit on",
            loud, None,
        ),
        at_most(
            "background_named", "background beside something concealed, and a name that stands for nothing concealed",
            [(one.name, one.extras > 0) for one in scores if one.truth.kind == "missing" and one.background], None,
        ),
        at_most(
            "false_alarms_background", "healthy beside a faint background, yet more named or left unexplained than it",
            [(one.name, one.reported) for one in faint], None,
        ),
    ]  # fmt: skip


def _cost(scores: Sequence[CaseScore]) -> list[Row]:
    seconds = [one.seconds for one in scores if one.seconds is not None]
    # A file that says what is not so may be refused.
    broken = [(one.name, bool(one.expert.failure or (one.error and one.truth.kind != WRONG_FILE))) for one in scores]
    return [
        figure("seconds", "processor seconds per case, median", quantile(seconds, 0.5), "s"),
        figure("seconds_95", "the same, 95th percentile", quantile(seconds, 0.95), "s"),
        figure("seconds_all", "the same, of all cases", sum(seconds) if seconds else None, "s"),
        at_most(
            "errors", "diagnoses that failed with an error", broken, 0.0, note="they count as having found nothing"
        ),
    ]
