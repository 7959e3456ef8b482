"""Long recordings are searched on a part of their samples first, and weighed on all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose import shortened, thinned
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.fit import Fit
from gearpoly.physics.undulation import Undulation
from tests.physics_cases import Condition, recorded, rough


def samples_of(fit: Fit) -> int:
    return sum(one.samples.size for one in fit.model.observed)


@pytest.mark.slow
def test_a_part_of_the_samples_proposes_and_all_of_them_weigh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A ghost order of 1 um of a pair that is recorded at 20 samples to the mesh: the same name with the same size,
    however many samples propose it."""
    file = rough()
    (made,) = recorded(
        file.model_copy(
            update={
                "driving": file.driving.model_copy(
                    update={"undulation": (Undulation(order=29, amplitude_um=1.0, angle_deg=20.0),)}
                )
            }
        ),
        (Condition(torque_nm=20.0),),
        np.random.default_rng(3),
    )
    searched: list[int] = []
    run_search = thinned.run_search

    def remembered(fit: Fit) -> Any:
        searched.append(samples_of(fit))
        return run_search(fit)

    monkeypatch.setattr(thinned, "run_search", remembered)
    found = []
    for suffice in (400, 10**6):
        monkeypatch.setattr(shortened, "SUFFICE", suffice)
        (one,) = diagnose(file, [made], path=tmp_path / "pair.toml").findings
        found.append(one)
    first, whole = searched[0], searched[-1]
    assert 350 < first <= 400 and whole > 4 * first
    assert [one.claim.key for one in found] == [found[0].claim.key] * 2
    assert found[0].claim.place.order == 29
    for name, (value, std) in found[1].parameters.items():
        # Both ends are fits of all samples: they rest at one place, to a part of the doubt.
        assert found[0].parameters[name][0] == pytest.approx(value, abs=0.5 * std)
