"""What a plan says of a pair before anything is measured, against figures measured elsewhere."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gearpoly.diagnose.plan import LookAlike, Plan, plan
from gearpoly.files.pairfile import read_pair
from gearpoly.physics import catalogue
from gearpoly.report.plan_report import json_text
from tests.made_command import Command

pytestmark = pytest.mark.long


GEAR = "teeth = {z}\nmodule_mm = 2.0\nface_width_mm = 20.0\npoints_per_flank = 300\n"
KNOWN = "tooth_thickness_um = -60.0\nuncertainty_um = 0.0\n"


RIGID = "[model]\ntooth_deflection = false\n"


def written(folder: Path, *, z: tuple[int, int] = (18, 25), more: str = "speed_rpm = 30.0\n") -> Path:
    """A pair whose teeth are all known."""
    path = folder / "pair.toml"
    gears = "".join(
        f"[{name}]\n{GEAR.format(z=n)}[{name}.inspection]\n{KNOWN}"
        for name, n in zip(("driving", "driven"), z, strict=True)
    )
    path.write_text(f"[pair]\ntorque_nm = 25.0\n{more}{gears}")
    return path


def made(path: Path) -> Plan:
    return plan(read_pair(path), path=path)


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return made(written(tmp_path_factory.mktemp("known")))


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    return made(written(tmp_path_factory.mktemp("rigid"), z=(12, 16), more=RIGID))


def test_the_command_prints_the_plan(rigid: Plan, tmp_path: Path, gearpoly_command: Command) -> None:
    path = written(tmp_path, z=(12, 16), more=RIGID)
    ran = gearpoly_command("plan", path, "--json", tmp_path / "plan.json")
    assert ran.code == 0, ran.err
    assert json.loads((tmp_path / "plan.json").read_text(encoding="utf-8")) == json.loads(json_text(rigid))
    assert rigid.first.says.rstrip(".") in " ".join(ran.out.split())


def alike(one: Plan, a: str, b: str) -> LookAlike:
    return next(pair for pair in one.look_alikes if {pair.one, pair.other} == {a, b})


def test_every_physics_is_asked_of_a_pair_that_can_show_it(known: Plan, rigid: Plan) -> None:
    """Teeth that bend cannot bend by surprise, and rigid ones neither rub nor crack; at no stated speed there is none
    to compare a resonance at. All else is asked of either pair."""
    assert set(known.not_asked) == {"tooth_deflection"}
    assert set(rigid.not_asked) == {"friction", "misalignment", "mesh_resonance", "tooth_crack"}
    assert set(known.not_asked) & set(rigid.not_asked) == set()
    assert set(known.not_asked) | set(rigid.not_asked) < set(catalogue())


@pytest.mark.parametrize("gear", ["driving", "driven"])
def test_known_teeth_of_an_18_25_pair_are_as_alike_as_was_measured_elsewhere(known: Plan, gear: str) -> None:
    """Sines of another linear model of this pair, at one torque (shared notes, "What one recording cannot tell apart");
    its laws of compliance are others, and nothing was open beside: hundredths of the small ones, a tenth of a crack's,
    all of which is bending."""
    pitch = alike(known, f"cumulative_pitch {gear} order 1", f"eccentricity {gear}")
    assert pitch.first == pytest.approx({"driving": 0.05, "driven": 0.04}[gear], abs=0.02)
    crack = alike(known, f"tooth_crack {gear}", f"tooth_pitch {gear}")
    assert crack.first == pytest.approx(0.41, abs=0.1)
    encoder = alike(known, f"eccentricity {gear}", f"encoder_eccentricity {gear}")
    assert encoder.first == pytest.approx(0.0, abs=0.02)


def test_each_look_alike_is_told_by_the_recording_that_its_physics_asks_for(known: Plan) -> None:
    steps = ("first", *(one.to_json() for one in known.further))

    def told(pair: LookAlike) -> Any:
        """The recording with which the sine goes up most."""
        sines = [sine or 0.0 for sine in (pair.first, *pair.after)]
        return steps[1 + max(range(len(sines) - 1), key=lambda k: sines[k + 1] - sines[k])]

    # Another torque winds shafts up otherwise, and thinner teeth not.
    assert told(alike(known, "shaft_windup", "tooth_thickness driving"))["flank"] == "coast"
    # A ramp over the angle goes back as the pair does, one over time goes on.
    assert told(alike(known, "encoder_scale driving", "thermal_drift"))["reversed"]
    # Both go round with the driving shaft as long as the encoder stays where it is.
    disc = alike(known, "cumulative_pitch driving order 2", "encoder_interpolation driving order 2")
    assert told(disc)["refitted_encoder"] == "driving"
    # One pair of gears shows the difference of their slopes only, and one ratio that of both counts.
    for a, b in (("profile_slope driving", "profile_slope driven"), ("encoder_scale driving", "encoder_scale driven")):
        assert all(sine is not None and sine < 0.2 for sine in (alike(known, a, b).first, *alike(known, a, b).after))


def test_what_the_first_recording_hides_is_said(known: Plan, rigid: Plan) -> None:
    """Wind-up is one offset among others as long as there is nothing to compare with; thickness is behind the teeth."""
    for one in (known, rigid):
        hidden = {each.physics: each for each in one.hidden}
        for name in ("shaft_windup", "tooth_thickness driving", "tooth_thickness driven"):
            assert hidden[name].first < 0.1
            assert hidden[name].after[-1] > 5.0


def test_the_json_keeps_its_keys(known: Plan) -> None:
    document = json.loads(json_text(known))
    assert set(document) == {
        "gearpoly", "pair", "first", "further", "look_alikes", "hidden", "not_asked", "told_apart_from",
    }  # fmt: skip
    steps = len(document["further"])
    for one in document["look_alikes"]:
        assert set(one) == {"one", "other", "separability", "after"}
        assert len(one["after"]) == steps
    for one in document["hidden"]:
        assert set(one) == {"physics", "standard_deviations", "after"}
        assert len(one["after"]) == steps
    assert {"flank", "torque_nm", "says"} <= set(document["first"])
