"""How many pairs keep limits, one by one and all together, and the coarsest grade that does.

A yield is of the pairs that were drawn. One that jams or comes out of mesh is bad. One that was refused is no pair at
all, and one that has no such output (no load, no load share) cannot be judged by it: neither counts for or against.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearpoly.study.design import Design
from gearpoly.study.groups import Group, shown
from gearpoly.study.models import OutputLimit
from gearpoly.study.statistics import Interval, share
from gearpoly.study.words import key_words

KEEPS, PROBABLY, PROBABLY_NOT, DOES_NOT = "keeps it", "probably keeps it", "probably does not", "does not"
NONE_DRAWN, NO_VALUE = "no pair could be drawn", "no pair has this output"
"""Verdicts on one group."""


@dataclass(frozen=True, kw_only=True)
class Yield:
    """How many pairs of each group keep all of ``limits``, in the order of the groups: ``shares`` of the ``judged``
    pairs, and ``verdicts``. ``share`` is what is asked."""

    limits: tuple[OutputLimit, ...]
    share: float
    judged: tuple[int, ...]
    shares: tuple[Interval, ...]
    verdicts: tuple[str, ...]

    @property
    def words(self) -> str:
        """The question in words."""
        return f"{self.short} in {100.0 * self.share:g} % of pairs"

    @property
    def short(self) -> str:
        """The question without the share that is asked."""
        bounds = " and ".join(bound_words(limit) for limit in self.limits)
        return bounds if len(self.limits) == 1 else f"all {len(self.limits)} limits together: {bounds}"


@dataclass(frozen=True, kw_only=True)
class Cheapest:
    """The coarsest grade that keeps what ``found`` asks, for each choice of whatever else is swept."""

    found: Yield
    says: tuple[str, ...]


def bound_words(limit: OutputLimit) -> str:
    """A limit without its share, in words."""
    bound = f"at most {limit.at_most:g}" if limit.at_most is not None else f"at least {limit.at_least:g}"
    return f"{limit.output} {bound}"


def yields(limits: tuple[OutputLimit, ...], groups: tuple[Group, ...], *, confidence: float) -> tuple[Yield, ...]:
    """The yield against each of ``limits``, and last against all of them together where there is more than one.

    Together, the least of the shares is asked: pairs that keep all are never more than those that keep one.
    """
    asked = [*((limit,) for limit in limits), *([limits] if len(limits) > 1 else [])]
    return tuple(_yield(these, groups, confidence) for these in asked)


def _yield(limits: tuple[OutputLimit, ...], groups: tuple[Group, ...], confidence: float) -> Yield:
    asked = min(limit.share for limit in limits)
    judged, shares, verdicts = [], [], []
    for group in groups:
        good, n = _counted(limits, group)
        found = share(good, n, confidence=confidence)
        judged.append(n)
        shares.append(found)
        verdicts.append(_verdict(found, asked) if n else NO_VALUE if group.done else NONE_DRAWN)
    return Yield(limits=limits, share=asked, judged=tuple(judged), shares=tuple(shares), verdicts=tuple(verdicts))


def _counted(limits: tuple[OutputLimit, ...], group: Group) -> tuple[int, int]:
    """Pairs of ``group`` that keep all of ``limits``, of how many that can be judged."""
    values = np.stack([group.ran[limit.output] for limit in limits])
    bounds = [(-np.inf if one.at_least is None else one.at_least, np.inf if one.at_most is None else one.at_most)
              for one in limits]  # fmt: skip
    low, high = np.array(bounds).T[:, :, None]
    known = np.all(np.isfinite(values), axis=0)
    good = known & np.all((low <= values) & (values <= high), axis=0)
    n = int(np.count_nonzero(known))
    # Where none of the pairs that run has the output, those that do not run say nothing of it.
    return int(np.count_nonzero(good)), n + group.jams + group.no_contact if n or not group.done else 0


def _verdict(found: Interval, asked: float) -> str:
    if found.low >= asked:
        return KEEPS
    if found.high < asked:
        return DOES_NOT
    return PROBABLY if found.value >= asked else PROBABLY_NOT


def cheapest(found: Yield, groups: tuple[Group, ...], design: Design) -> Cheapest | None:
    """Coarser is cheaper: of the groups that differ in nothing but their grades, the coarsest that keeps the limits.
    None where no grade is swept."""
    graded = [sweep for sweep in design.plain if any(key.endswith(".grade") for key in sweep.all_keys)]
    if not graded:
        return None
    with_grade = {key for sweep in graded for key in sweep.all_keys}

    def others(group: Group) -> tuple[tuple[str, Any], ...]:
        return tuple((key, value) for key, value in group.values.items() if key not in with_grade)

    says = []
    for rest in dict.fromkeys(others(group) for group in groups):
        mine = [k for k, group in enumerate(groups) if others(group) == rest]
        # Both gears count: a pair of grades 5 and 6 is finer than one of 6 and 6.
        mine.sort(key=lambda k: -sum(v for key, v in groups[k].values.items() if key.endswith(".grade")))
        where = ", ".join(_stated(key, value) for key, value in rest)
        says.append((f"{where}: " if where else "") + _says(found, groups, mine))
    return Cheapest(found=found, says=tuple(says))


def _stated(key: str, value: Any) -> str:
    words, unit = key_words(key)
    return f"{words} = {shown(value)} {unit}".rstrip()


def _says(found: Yield, groups: tuple[Group, ...], mine: list[int]) -> str:
    """What is said of the groups ``mine``, the coarsest of which comes first."""
    sure = next((k for k in mine if found.verdicts[k] == KEEPS), None)
    likely = next((k for k in mine if found.verdicts[k] in (KEEPS, PROBABLY)), None)

    def grades(k: int) -> str:
        mine = {key.split(".")[0]: value for key, value in groups[k].values.items() if key.endswith(".grade")}
        if len(set(mine.values())) == 1 and len(mine) == 2:
            return f"grade {next(iter(mine.values()))}"
        return " and ".join(f"{gear} gear of grade {value}" for gear, value in mine.items())

    def kept(k: int) -> str:
        return f"{share_words(found.shares[k])} keep {'it' if len(found.limits) == 1 else 'them'}"

    if sure is not None and sure == likely:
        text = f"{grades(sure)} is the coarsest that keeps {'it' if len(found.limits) == 1 else 'them'}: {kept(sure)}"
    elif likely is not None:
        text = f"{grades(likely)} is probably enough, which so few pairs do not settle: {kept(likely)}"
        text += f"; {grades(sure)} surely is: {kept(sure)}" if sure is not None else ""
    elif not any(found.judged[k] for k in mine):
        return "no grade can be judged, since no pair has a result"
    else:
        text = "none of the grades keeps " + ("it" if len(found.limits) == 1 else "them")
    left_out = [grades(k) for k in reversed(mine) if not found.judged[k]]
    return text + (f"; not judged, since no pair has a result: {', '.join(left_out)}" if left_out else "")


def share_words(one: Interval) -> str:
    """A share with its interval, in per cent."""
    return f"{_per_cent(one.value)} % ({_per_cent(one.low)} to {_per_cent(one.high)} %)"


def _per_cent(x: float) -> str:
    """A share in per cent, with one decimal, and two within 1 % of none and of all."""
    return f"{round(100.0 * x, 1 if 0.01 <= x <= 0.99 else 2):g}"


def yield_words(found: Yield, groups: tuple[Group, ...], k: int) -> str:
    """What became of group ``k``: the share and of how many pairs, or why there is none."""
    group, n = groups[k], found.judged[k]
    refused = f"; {group.refused} refused" if group.refused else ""
    blank = group.pairs - group.refused - n
    without = f"; {blank} without this output" if blank else ""
    share_of = f"{share_words(found.shares[k])} of {n} drawn" if n else f"0 of {group.pairs} pairs judged"
    return share_of + refused + without
