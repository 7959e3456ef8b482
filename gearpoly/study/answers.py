"""What a table answers: percentiles, yields, the cheapest grade, what drives each output, and why pairs have none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.study.causes import FailureCause, causes
from gearpoly.study.design import CHANCE_FACTOR, Design
from gearpoly.study.groups import Group, group
from gearpoly.study.models import OutputLimit
from gearpoly.study.pipeline import DONE
from gearpoly.study.statistics import Indices, factorial_indices, saltelli_indices
from gearpoly.study.store import Store, as_numbers, read_store
from gearpoly.study.words import sweep_name
from gearpoly.study.yields import Cheapest, Yield, cheapest, yields


@dataclass(frozen=True, kw_only=True, eq=False)
class Answers:
    """Everything that is read off one table."""

    name: str
    store: Store
    manifest: dict[str, Any]
    confidence: float
    groups: tuple[Group, ...]
    limits: tuple[OutputLimit, ...]
    yields: tuple[Yield, ...]
    cheapest: tuple[Cheapest, ...]
    sensitivity: tuple[tuple[str, tuple[Indices, ...]], ...]
    remarks: tuple[str, ...]
    causes: tuple[FailureCause, ...]
    pairs: int


def answer(folder: Path, *, limits: Sequence[OutputLimit] | None = None, confidence: float = 0.95) -> Answers:
    """Read the table in ``folder``; ``limits`` instead of the study's own.

    Raises ``InputFileError`` where there is no table.
    """
    store, manifest = read_store(folder)
    design, file = store.plan.design, store.plan.file
    found = store.columns(["index", "combination", "status", *file.outputs])
    remarks = [*_remarks(store, manifest, found), *_uneven(store, found)]
    of = found["combination"] // (design.points.shape[0] * design.blocks)
    plain = np.ones(of.size, dtype=bool)
    if file.sensitivity:
        # A and B are independent draws of everything; the other blocks repeat most of theirs.
        plain = found["combination"] % design.blocks < 2
    groups = tuple(
        group(design, k, {name: column[plain & (of == k)] for name, column in found.items()}, confidence=confidence)
        for k in range(math.prod(len(levels) for levels in design.levels))
        if np.any(of == k)
    )
    asked = tuple(file.limit if limits is None else limits)
    kept = yields(asked, groups, confidence=confidence)
    return Answers(
        name=file.name,
        store=store,
        manifest=manifest,
        confidence=confidence,
        groups=groups,
        limits=asked,
        yields=kept,
        cheapest=tuple(one for one in (cheapest(found, groups, design) for found in kept) if one is not None),
        sensitivity=tuple((output, _indices(design, found, output)) for output in file.outputs),
        remarks=tuple(remarks),
        causes=causes(store),
        pairs=int(found["index"].size),
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


def _uneven(store: Store, found: dict[str, Any]) -> list[str]:
    """What is said where sensitivity rests on a part of the draws."""
    design = store.plan.design
    if not (design.file.sensitivity or (design.plain and not design.ranges and design.file.draws == "shared")):
        return []
    block = design.blocks if design.file.sensitivity else design.combinations
    whole = (found["status"] == DONE)[: found["status"].size // block * block].reshape(-1, block).all(axis=1)
    what = "points" if design.file.sensitivity else "draws"
    if not whole.size or whole.all():
        return []
    if not whole.any():
        return [f"no sensitivity: none of {whole.size} {what} has a result in every combination"]
    return [f"sensitivity rests on {int(whole.sum())} of {whole.size} {what}: those of which every pair has a result"]


def _indices(design: Design, found: dict[str, Any], output: str) -> tuple[Indices, ...]:
    """Sobol indices of one output, none where the table is not laid out for them."""
    values = as_numbers(found[output])
    if design.file.sensitivity:
        rows = values[: design.points.shape[0] * design.blocks].reshape(-1, design.blocks)
        rows = rows[np.all(np.isfinite(rows), axis=1)]
        return tuple(saltelli_indices(rows, [*(sweep_name(sweep) for sweep in design.ranges), CHANCE_FACTOR]))
    if design.ranges or not design.plain or design.file.draws != "shared":
        return ()
    draws = values.size // design.combinations
    table = values[: draws * design.combinations].reshape(draws, *(len(levels) for levels in design.levels))
    # A draw that fails anywhere would leave a hole, and a hole leaves no balance.
    whole = np.all(np.isfinite(table), axis=tuple(range(1, table.ndim)))
    table = np.moveaxis(table[whole], 0, -1)
    used = [k for k, levels in enumerate(design.levels) if len(levels) > 1]
    table = table.reshape(*(len(design.levels[k]) for k in used), -1)
    return tuple(factorial_indices(table, [*(sweep_name(design.plain[k]) for k in used), CHANCE_FACTOR]))
