"""Slow courses without a cause: whatever is slow is met by the plainest curve that does as much."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.infer.unknown import Unknown, slow_courses
from gearpoly.units import FloatArray

N = 400
ALONG = np.linspace(-1.0, 1.0, N)
STD = 0.1


def scene(number: int = 0) -> Any:
    """So much of a scene as slow courses ask for."""
    return SimpleNamespace(samples=SimpleNamespace(along=ALONG, number=number))


def best(course: FloatArray, scenes: list[Any], *, inside: tuple[int, ...] = ()) -> str:
    """The name of the unknown cause that a course (n,) in noise of ``STD`` makes likeliest, by the dense normal
    densities of all samples."""
    y = np.tile(course, len(scenes))

    def log_density(one: Unknown) -> float:
        columns = np.concatenate(one.columns) * one.std
        # The mean is open beside all of them.
        covariance = STD**2 * np.eye(y.size) + columns @ columns.T + 100.0
        _, log_det = np.linalg.slogdet(covariance)
        return float(np.log(one.weight) - 0.5 * log_det - 0.5 * y @ np.linalg.solve(covariance, y))

    return max(slow_courses(cast("Any", scenes), inside), key=log_density).name


@pytest.mark.long
@pytest.mark.parametrize(
    ("course", "name"),
    [
        (0.8 * ALONG, "ramp"),
        (0.9 * np.cos(0.75 * np.pi * ALONG + 0.4), "slow wave"),
        (0.7 * (ALONG > 0.2) - 0.3, "step"),
        # A bend of no period and no corner.
        (0.9 * ALONG**3 - 0.5 * ALONG**2 + 0.3 * ALONG**5, "slow course"),
    ],
)
def test_the_form_that_made_a_course_is_the_likeliest(course: FloatArray, name: str) -> None:
    rng = np.random.default_rng(1)
    found = best(course + rng.normal(0.0, STD, N), [scene()])
    assert found.startswith(name)


def test_forms_share_one_weight() -> None:
    """Were all alike, a cause would be the less likely the more moments a step may have."""
    found = slow_courses(cast("Any", [scene(), scene(1)]), ())
    weight: dict[str, float] = {}
    for one in found:
        kind = one.name.removesuffix(" by recording")
        weight[kind] = weight.get(kind, 0.0) + one.weight
    assert weight == pytest.approx(dict.fromkeys(("ramp", "slow course", "slow wave", "step"), 0.25), abs=1e-12)


def test_outside_of_its_recordings_a_course_is_nothing() -> None:
    for one in slow_courses(cast("Any", [scene(), scene(1)]), (1,)):
        assert not np.any(one.columns[0])
        assert np.any(one.columns[1])
