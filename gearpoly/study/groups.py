"""The rows of a table taken together by combination of the lists and grids, with what each output is like there.

Sobol points vary within a group, as chance does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearpoly.study.design import Design
from gearpoly.study.pipeline import DONE, JAMS, NO_CONTACT, REFUSED
from gearpoly.study.statistics import Interval, mean, percentile
from gearpoly.study.store import as_numbers
from gearpoly.study.words import sweep_name, sweep_words
from gearpoly.units import FloatArray

PERCENTILES = (50.0, 90.0, 95.0, 99.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class GroupSample:
    """One output in one group: sorted ``values`` (n,), their mean, standard deviation and percentiles."""

    output: str
    values: FloatArray
    mean: Interval
    std: float
    percentiles: tuple[tuple[float, Interval], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Group:
    """One combination of lists and grids: its ``label`` by keys, the same in ``words`` with units, its ``values``, how
    many pairs there are and what became of them. ``ran`` (output: (done,)) holds the outputs pair by pair, nan where a
    pair has none."""

    label: str
    words: str
    values: dict[str, Any]
    pairs: int
    done: int
    jams: int
    no_contact: int
    refused: int
    ran: dict[str, FloatArray]
    samples: tuple[GroupSample, ...]

    def sample(self, output: str) -> GroupSample:
        """What was found of one output."""
        return next(sample for sample in self.samples if sample.output == output)


def counted(combinations: int) -> str:
    """How many combinations, in words."""
    return "1 combination" if combinations == 1 else f"{combinations} combinations"


def group(design: Design, k: int, found: dict[str, Any], *, confidence: float) -> Group:
    """Group ``k`` of ``design`` from the columns ``found`` of its rows."""
    values = design.values(k * design.points.shape[0] * design.blocks)
    status = found["status"]
    ran = {name: as_numbers(found[name])[status == DONE] for name in design.file.outputs}
    count = {name: int(np.count_nonzero(status == name)) for name in (DONE, JAMS, NO_CONTACT, REFUSED)}
    return Group(
        label=_label(design, values),
        words=_words(design, values),
        values={key: values[key] for sweep in design.plain for key in sweep.all_keys},
        pairs=int(status.size),
        done=count[DONE],
        jams=count[JAMS],
        no_contact=count[NO_CONTACT],
        refused=count[REFUSED],
        ran=ran,
        samples=tuple(_sample(name, column, confidence) for name, column in ran.items()),
    )


def _sample(name: str, column: FloatArray, confidence: float) -> GroupSample:
    values = np.sort(column[np.isfinite(column)])
    return GroupSample(
        output=name,
        values=values,
        mean=mean(values, confidence=confidence),
        std=float(np.std(values, ddof=1)) if values.size > 1 else math.nan,
        percentiles=tuple((p, percentile(values, p, confidence=confidence)) for p in PERCENTILES),
    )


def _label(design: Design, values: dict[str, Any]) -> str:
    parts = [f"{sweep_name(sweep)} = {shown(values[sweep.all_keys[0]])}" for sweep in design.plain]
    return ", ".join(parts) or "all pairs"


def _words(design: Design, values: dict[str, Any]) -> str:
    parts = []
    for sweep in design.plain:
        name, unit = sweep_words(sweep)
        parts.append(f"{name} = {shown(values[sweep.all_keys[0]])} {unit}".rstrip())
    return ", ".join(parts) or "all pairs"


def shown(value: object) -> str:
    """A swept value as labels have it."""
    return f"{value:g}" if isinstance(value, float) else str(value)
