"""Recordings of one flank that differ once per turn were not made on one mounting."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.compare.entries import Entry
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.remounted import remounted, without_smaller
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.units import UM, FloatArray
from tests.made_fits import MadeFit

N = 2000
NOISE = 0.3 * UM


def found(*waves: tuple[float, float], flanks: str = "dd", deflection: float = 0.0, apart: float = 0.0) -> Any:
    """What is made of recordings whose driving shaft makes waves of these sizes in um and phases in deg; ``apart``:
    in each a wave of its own is fitted, which was found so far from order 1 (0: none is)."""
    rng = np.random.default_rng(6)
    theta_1 = np.linspace(0.0, 40.0, N)
    names = {"d": "drive", "c": "coast"}
    samples = [SimpleNamespace(size=N, theta_1=theta_1, theta_2=0.72 * theta_1, flank=names[f]) for f in flanks]
    target: list[FloatArray] = [
        um * UM * np.cos(theta_1 - np.radians(deg)) + rng.normal(0.0, NOISE, N) for um, deg in waves
    ]
    own = np.column_stack([f((1.0 + apart) * theta_1) for f in (np.cos, np.sin)])
    strangers = [(2 * k, 2 * k + 1) for k in range(len(target))] if apart else []
    columns = [np.ones((N, 1)) for _ in target]
    if strangers:
        columns = [np.column_stack([np.ones(N), np.kron(np.eye(len(target))[k], own)]) for k in range(len(target))]
    size = columns[0].shape[1]
    system = System(
        white=[full(one / NOISE) for one in columns],
        target=[one / NOISE for one in target],
        precision=np.zeros((size, size)),
        prior=np.zeros(size),
    )
    linear = Linear(
        system=system,
        layout=cast(Any, SimpleNamespace(foreign=slice(1, size))),
        columns=[full(one) for one in columns],
        target=target,
        noises=[cast(Any, SimpleNamespace(whitened=lambda values: values / NOISE))] * len(target),
    )
    model = SimpleNamespace(observed=[SimpleNamespace(samples=one) for one in samples], strangers=tuple(strangers))
    return remounted(cast(Any, model), linear, deflection=deflection * UM)


def test_waves_that_differ_are_two_mountings() -> None:
    """12 um and 15 um the other way: 27 um apart. What 0.3 um of noise in 2000 samples leaves of a wave is 0.01 um."""
    one = found((12.0, 0.0), (15.0, 180.0))
    assert (one.first, one.other, one.gear) == (0, 1, 0)
    assert one.wave / UM == pytest.approx(27.0, abs=0.05)
    assert "mounted anew" in one.says


def test_a_wave_found_beside_once_per_turn_hides_no_mounting() -> None:
    """In 6.4 turns no order within a twentieth is told from the first. Fitted beside it, it left 34 mm of 10 um."""
    one = found((12.0, 0.0), (15.0, 180.0), apart=0.005)
    assert (one.gear, one.wave / UM) == (0, pytest.approx(27.0, abs=0.05))


@pytest.mark.parametrize(
    ("waves", "flanks", "deflection"),
    [
        (((60.0, 0.0), (60.6, 0.0)), "dd", 0.0),  # a hundredth by another torque
        (((12.0, 0.0), (12.0, 40.0)), "dc", 0.0),  # an eccentricity is turned by twice the pressure angle
        (((0.0, 0.0), (0.8, 0.0)), "dd", 8.0),  # a torque that pulses by a tenth
        (((0.0, 0.0), (0.02, 0.0)), "dd", 0.0),  # two standard deviations
    ],
)
def test_what_one_mounting_may_do_is_none(waves: Any, flanks: str, deflection: float) -> None:
    assert found(*waves, flanks=flanks, deflection=deflection) is None


@pytest.mark.parametrize(
    ("turning", "left"), [(7.7, []), (2.0, ["eccentricity"]), (0.2, ["misalignment", "eccentricity"])]
)
def test_nothing_smaller_is_named_than_what_two_recordings_differ_by(
    turning: float, left: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """1 um of a misalignment and 4 um of an eccentricity. Means differ by 9 um: a zero, or friction, and nothing that
    speaks against names."""
    sizes = {"misalignment": 1.0 * UM, "eccentricity": 4.0 * UM}
    linear = SimpleNamespace(system=SimpleNamespace(misfit=0.0), under=lambda noises: linear)
    model = SimpleNamespace(claims=tuple(sizes), rms_of=lambda scenes, one: sizes[one])
    search: Any = MadeFit(model=model, linear=linear)
    monkeypatch.setattr("gearpoly.diagnose.remounted.settled", lambda fit: fit)
    entry = Entry(kind="condition", p_value=0.0, recordings=(1,), rms_um=9.0, turning_um=turning)
    line = Entry(kind="shaft_order", p_value=0.0, recordings=(0,), amplitude_um=50.0)
    stays, says = without_smaller(search, [entry, line])
    assert list(stays.model.claims) == left
    assert bool(says) == (len(left) < 2)
    assert all("mounted anew" in one and f"{turning:.2g} um" in one for one in says)
    assert without_smaller(search, []) == (search, ())
