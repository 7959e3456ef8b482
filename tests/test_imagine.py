"""Recordings that are only thought of: what is doubtful of them beside what was recorded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.imagine import LIGHT_TORQUE_N_MM, Imagined, NextRecording, effects, imagined
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.separate import Separation, would_separate
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.scene import Scene
from gearpoly.units import NM, FloatArray
from tests.physics_cases import Condition, recorded, rough


class Trusting(Imagined):
    """The same, taking the compliance laws under a new condition for known."""

    def doubt(self, scene: Scene) -> tuple[FloatArray, FloatArray]:
        shared, own = super().doubt(scene)
        return np.zeros_like(shared), np.zeros((own.shape[0], 0))


def fitted(folder: Path, torque_nm: float) -> Fit:
    """One drive recording of a pair that bends, fitted, with crowned teeth claimed of it."""
    file, path = rough(), folder / "pair.toml"
    recordings = recorded(file, (Condition(torque_nm=torque_nm),), np.random.default_rng(3), per_mesh=12)
    model = prepare(file, compare(file, recordings, path=path), path=path)
    fit = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    crowning = Claim(physics=catalogue()["profile_crowning"], place=Place(gear=0), values=(3.0,))
    return fit.believing(claims=(crowning,)).linearised()


def told(fit: Fit, kind: type[Imagined], made: NextRecording, rival: Claim) -> Separation:
    """What one further recording would leave between crowning and its rival."""
    thought = kind(model=fit.model, laws=fit.laws)
    # In the place of all that it would think of.
    vars(thought)["scenes"] = [(made, imagined(fit.model, made, number=1))]
    found = would_separate(
        fit.model, fit.scenes, fit.linear, 0, [rival], nuisance=fit.nuisance, thought=thought, least=-1.0
    )
    assert found is not None
    return found


GAP = Claim(physics=catalogue()["misalignment"], place=Place(probe=(6.0,)), values=(6.0,))
SLOPE = Claim(physics=catalogue()["profile_slope"], place=Place(gear=1), values=(3.0,))
WEAR = Claim(physics=catalogue()["wear"], place=Place(gear=0), values=(3.0,))
RUB = Claim(physics=catalogue()["friction"], place=Place(probe=(0.05,)), values=(0.05,))
FULL_COAST = NextRecording(flank="coast", torque=20.0 * NM)
FULL, TWICE = NextRecording(flank="drive", torque=20.0 * NM), NextRecording(flank="drive", torque=40.0 * NM)


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return fitted(tmp_path_factory.mktemp("loaded"), 20.0)


@pytest.fixture(scope="module")
def free(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return fitted(tmp_path_factory.mktemp("free"), 0.0)


@pytest.mark.long
@pytest.mark.parametrize("rival", [GAP, SLOPE, WEAR, RUB], ids=lambda one: one.physics.name)
@pytest.mark.parametrize(
    "made",
    [
        TWICE,
        *(
            pytest.param(one, marks=pytest.mark.slow)
            for one in (FULL_COAST, NextRecording(flank="drive", torque=LIGHT_TORQUE_N_MM))
        ),
    ],
    ids=lambda one: one.says,
)
def test_doubt_about_laws_takes_from_what_another_load_would_tell_of_crowning(
    loaded: Fit, rival: Claim, made: NextRecording
) -> None:
    """What is open takes from a signal and adds nothing. (The sine alone may go up: what laws can make may be just what
    both have in common.) Crowning shows where pairs hand over, and so does how each law bends a tooth at its tip."""
    trusting, honest = (told(loaded, kind, made, rival) for kind in (Trusting, Imagined))
    assert honest.told <= trusting.told * (1.0 + 1e-6)  # rounding of a solved system
    if made is TWICE:
        assert honest.told < 0.995 * trusting.told  # of wear, which is told from crowning worst, 0.9905


@pytest.mark.long
def test_unloaded_recordings_first_meet_laws_under_load(free: Fit) -> None:
    """No law is doubted where nothing bends; of the first loaded recording all that laws differ by is its own."""
    assert free.laws is None
    thought = Imagined(model=free.model, laws=None)
    shared, own = thought.doubt(imagined(free.model, FULL, number=1))
    assert shared.shape[1] == 0
    assert own.shape[1] > 1
    nothing = NextRecording(flank="coast", torque=0.0)
    none = thought.doubt(imagined(free.model, nothing, number=1))
    assert [one.shape[1] for one in none] == [0, 0]
    same = (told(free, kind, nothing, SLOPE) for kind in (Trusting, Imagined))
    assert len(set(same)) == 1


@pytest.mark.long
def test_modes_of_laws_go_on_at_the_recorded_condition(loaded: Fit) -> None:
    """Thought of as it was made, a recording shows the modes it showed, sample by sample, and nothing beside them that
    it did not: what was too small for a column stays so."""
    assert loaded.laws is not None
    scene = loaded.scenes[0]
    shared, own = loaded.laws.under(scene)
    # Laws were compared before the last step of the fit moved teeth by hundredths of a micron.
    np.testing.assert_allclose(shared, loaded.laws.parts[0], atol=0.05 * np.max(np.abs(loaded.laws.parts[0])))
    assert own.shape[1] == 0
    wider, _ = loaded.laws.widened(3.0).under(scene)
    np.testing.assert_allclose(wider, 3.0 * shared, atol=1e-12)


@pytest.mark.long
def test_backwards_friction_turns_and_slopes_stay(loaded: Fit) -> None:
    """Flanks then slide the other way: to first order in the coefficient the change of the load's share has the other
    sign. What is cut into the teeth is where it was, and a drift that goes on in time comes from the other end."""
    made = (FULL, NextRecording(flank="drive", torque=20.0 * NM, reversed=True))
    scenes = [imagined(loaded.model, one, number=1) for one in made]
    friction = Claim(physics=catalogue()["friction"], place=Place(probe=(0.05,)), values=(0.02,))
    forth, back = effects(loaded.model, scenes, friction)
    # Second order in a coefficient of 0.02 is a fiftieth of the first, but where a pair begins or ends to carry within
    # the change: one sample in twenty at most.
    assert np.quantile(np.abs(back + forth), 0.95) < 0.05 * np.max(np.abs(forth))
    assert np.max(np.abs(forth)) > 1e-6
    there, here = effects(loaded.model, scenes, SLOPE)
    np.testing.assert_allclose(here, there, atol=1e-12)
    drift = Claim(physics=catalogue()["thermal_drift"], place=Place(recordings=(0,)), values=(2.0, 0.0, 0.0))
    on, off = effects(loaded.model, scenes, drift)
    np.testing.assert_allclose(off, -on, atol=1e-12)
