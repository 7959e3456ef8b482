"""What a table answers: percentiles, yields, the cheapest grade, and what drives each output.

Rows are taken together by *group*: one combination of the lists and grids. Sobol points vary within a group, as chance
does. Pairs that jam or cannot be made have no outputs; they count as bad for a yield, and are counted apart elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.study.design import CHANCE, Design
from gearpoly.study.models import Limit, Sweep
from gearpoly.study.statistics import (
    Indices,
    Interval,
    factorial_indices,
    mean,
    percentile,
    saltelli_indices,
    share,
)
from gearpoly.study.store import Store, as_numbers, read_store
from gearpoly.units import FloatArray

PERCENTILES = (50.0, 90.0, 95.0, 99.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sample:
    """One output in one group: sorted ``values`` (n,), their mean, standard deviation and percentiles."""

    output: str
    values: FloatArray
    mean: Interval
    std: float
    percentiles: tuple[tuple[float, Interval], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Group:
    """One combination of lists and grids: its ``label`` and ``values``, how many pairs there are and how many run."""

    label: str
    values: dict[str, Any]
    pairs: int
    done: int
    jams: int
    refused: int
    samples: tuple[Sample, ...]

    def sample(self, output: str) -> Sample:
        """What was found of one output."""
        return next(sample for sample in self.samples if sample.output == output)


@dataclass(frozen=True, kw_only=True)
class Yield:
    """How many pairs of each group keep one ``limit``: ``shares`` and ``verdicts`` in the order of the groups."""

    limit: Limit
    shares: tuple[Interval, ...]
    verdicts: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Cheapest:
    """The coarsest grade that keeps a limit, for each choice of whatever else is swept."""

    limit: Limit
    says: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Answers:
    """Everything that is read off one table."""

    name: str
    store: Store
    manifest: dict[str, Any]
    confidence: float
    groups: tuple[Group, ...]
    yields: tuple[Yield, ...]
    cheapest: tuple[Cheapest, ...]
    sensitivity: tuple[tuple[str, tuple[Indices, ...]], ...]
    remarks: tuple[str, ...]
    reasons: tuple[tuple[str, int], ...]


def answer(folder: Path, *, limits: Sequence[Limit] | None = None, confidence: float = 0.95) -> Answers:
    """Read the table in ``folder``; ``limits`` instead of the study's own.

    Raises ``InputFileError`` where there is no table.
    """
    store, manifest = read_store(folder)
    design, file = store.plan.design, store.plan.file
    found = store.columns(["index", "combination", "draw", "status", "reason", *file.outputs])
    remarks = _remarks(store, manifest, found)
    of = found["combination"] // (design.points.shape[0] * design.blocks)
    plain = np.ones(of.size, dtype=bool)
    if file.sensitivity:
        # A and B are independent draws of everything; the other blocks repeat most of theirs.
        plain = found["combination"] % design.blocks < 2
    groups = tuple(
        _group(design, k, {name: column[plain & (of == k)] for name, column in found.items()}, confidence)
        for k in range(math.prod(len(levels) for levels in design.levels))
        if np.any(of == k)
    )
    asked = tuple(file.limit if limits is None else limits)
    yields = tuple(_yield(limit, groups, confidence) for limit in asked)
    names, counts = np.unique(found["reason"][found["status"] != "done"].astype(str), return_counts=True)
    order = np.argsort(-counts, kind="stable")[:8]
    return Answers(
        name=file.name,
        store=store,
        manifest=manifest,
        confidence=confidence,
        groups=groups,
        yields=yields,
        cheapest=tuple(one for one in (_cheapest(y, groups, design) for y in yields) if one is not None),
        sensitivity=tuple((output, _indices(design, found, output)) for output in file.outputs),
        remarks=tuple(remarks),
        reasons=tuple((str(names[k]), int(counts[k])) for k in order),
    )


def _remarks(store: Store, manifest: dict[str, Any], found: dict[str, Any]) -> list[str]:
    out = []
    if not manifest.get("finished"):
        out.append(f"the study is not finished: {found['index'].size} of {manifest['rows']} pairs are there")
    elif manifest.get("why") not in ("", "all rows"):
        out.append(f"the study stopped because {manifest['why']}")
    if len(store.plan.design.plain) and store.plan.file.draws == "shared":
        out.append(
            "all combinations share their random numbers, so differences between them are better known than the "
            "intervals of each say"
        )
    return out


def _name(sweep: Sweep) -> str:
    """A short name of what a sweep varies: common parts of its keys once."""
    keys = sweep.all_keys
    if sweep.name is not None:
        return sweep.name
    if len(keys) == 1:
        return keys[0]
    first = keys[0].split(".")[-1]
    return first if len(keys) == 2 and keys[1].endswith("." + first) else f"{first} and {len(keys) - 1} more"


def _label(design: Design, values: dict[str, Any]) -> str:
    parts = []
    for sweep in design.plain:
        mine = [values[key] for key in sweep.all_keys]
        shown = _shown(mine[0])
        parts.append(f"{_name(sweep)} = {shown}")
    return ", ".join(parts) or "all pairs"


def _shown(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _group(design: Design, k: int, found: dict[str, Any], confidence: float) -> Group:
    values = design.values(k * design.points.shape[0] * design.blocks)
    plain = {key: values[key] for sweep in design.plain for key in sweep.all_keys}
    status = found["status"]
    done = status == "done"
    samples = []
    for name in design.file.outputs:
        column = as_numbers(found[name])[done]
        column = np.sort(column[np.isfinite(column)])
        samples.append(
            Sample(
                output=name,
                values=column,
                mean=mean(column, confidence=confidence),
                std=float(np.std(column, ddof=1)) if column.size > 1 else math.nan,
                percentiles=tuple((p, percentile(column, p, confidence=confidence)) for p in PERCENTILES),
            )
        )
    return Group(
        label=_label(design, values),
        values=plain,
        pairs=int(status.size),
        done=int(np.count_nonzero(done)),
        jams=int(np.count_nonzero(status == "jams")),
        refused=int(np.count_nonzero(status == "refused")),
        samples=tuple(samples),
    )


def _yield(limit: Limit, groups: tuple[Group, ...], confidence: float) -> Yield:
    shares, verdicts = [], []
    for group in groups:
        values = group.sample(limit.output).values
        if limit.at_most is not None:
            good = int(np.count_nonzero(values <= limit.at_most))
        else:
            good = int(np.count_nonzero(values >= (limit.at_least or 0.0)))
        found = share(good, group.pairs, confidence=confidence)
        shares.append(found)
        if found.low >= limit.share:
            verdicts.append("keeps it")
        elif found.high < limit.share:
            verdicts.append("does not")
        else:
            verdicts.append("probably keeps it" if found.value >= limit.share else "probably does not")
    return Yield(limit=limit, shares=tuple(shares), verdicts=tuple(verdicts))


def words(limit: Limit) -> str:
    """A limit in words."""
    bound = f"at most {limit.at_most:g}" if limit.at_most is not None else f"at least {limit.at_least:g}"
    return f"{limit.output} {bound} in {100.0 * limit.share:g} % of pairs"


def _cheapest(found: Yield, groups: tuple[Group, ...], design: Design) -> Cheapest | None:
    """Coarser is cheaper: of the groups that differ in nothing but their grades, the coarsest that keeps the limit."""
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
        sure = next((k for k in mine if found.verdicts[k] == "keeps it"), None)
        likely = next((k for k in mine if found.verdicts[k] in ("keeps it", "probably keeps it")), None)
        where = ", ".join(f"{key} = {_shown(value)}" for key, value in rest)
        says.append((f"{where}: " if where else "") + _says(found, groups, sure, likely))
    return Cheapest(limit=found.limit, says=tuple(says))


def _says(found: Yield, groups: tuple[Group, ...], sure: int | None, likely: int | None) -> str:
    def grades(k: int) -> str:
        mine = {key.split(".")[0]: value for key, value in groups[k].values.items() if key.endswith(".grade")}
        if len(set(mine.values())) == 1 and len(mine) == 2:
            return f"grade {next(iter(mine.values()))}"
        return " and ".join(f"{gear} gear of grade {value}" for gear, value in mine.items())

    def kept(k: int) -> str:
        one = found.shares[k]
        return f"{100.0 * one.value:.4g} % keep it ({100.0 * one.low:.4g} to {100.0 * one.high:.4g} %)"

    if sure is not None and sure == likely:
        return f"{grades(sure)} is the coarsest that keeps it: {kept(sure)}"
    if likely is not None:
        text = f"{grades(likely)} probably keeps it, which so few pairs do not settle: {kept(likely)}"
        return text + (f"; {grades(sure)} surely does: {kept(sure)}" if sure is not None else "")
    return "none of the grades keeps it"


def _indices(design: Design, found: dict[str, Any], output: str) -> tuple[Indices, ...]:
    """Sobol indices of one output, none where the table is not laid out for them."""
    values = as_numbers(found[output])
    if design.file.sensitivity:
        rows = values[: design.points.shape[0] * design.blocks].reshape(-1, design.blocks)
        rows = rows[np.all(np.isfinite(rows), axis=1)]
        return tuple(saltelli_indices(rows, [*(_name(sweep) for sweep in design.ranges), CHANCE]))
    if design.ranges or not design.plain or design.file.draws != "shared":
        return ()
    draws = values.size // design.combinations
    table = values[: draws * design.combinations].reshape(draws, *(len(levels) for levels in design.levels))
    # A draw that fails anywhere would leave a hole, and a hole leaves no balance.
    whole = np.all(np.isfinite(table), axis=tuple(range(1, table.ndim)))
    table = np.moveaxis(table[whole], 0, -1)
    used = [k for k, levels in enumerate(design.levels) if len(levels) > 1]
    table = table.reshape(*(len(design.levels[k]) for k in used), -1)
    return tuple(factorial_indices(table, [*(_name(design.plain[k]) for k in used), CHANCE]))
