"""Sizes on the sky and periods in seconds, against values worked out by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from gearpoly.compare.entries import Entry
from gearpoly.compare.on_sky import Sky, sky_of
from gearpoly.diagnose.verdict import Finding
from gearpoly.keys.also_turns import Part
from gearpoly.report.compare_report import entry_words
from gearpoly.report.diagnosis_sky import finding_json
from tests.made_command import Command
from tests.made_diagnosis import findings, made_comparison
from tests.made_guide_log import PERIOD, made_log

PAIR = """name = "EQ6"
[driving]
teeth = 12
module_mm = 0.5
[driven]
teeth = 47
module_mm = 0.5
[worm]
wheel_teeth = 180
"""

# By hand: r_b2 = 47 x 0.5 / 2 x cos 20 deg = 11.0414 mm. 1 um there is 9.0568e-5 rad of the worm, 18.681 arcsec, and a
# 180th of it on the axis. 1 um / 11.0414 mm x 206264.8 / 180 = 0.10378 arcsec.
PER_UM = 0.1037837
EQ6 = Sky(arcsec_per_um=PER_UM, seconds=478.69, z=(12, 47))


def wave(**more: object) -> Entry:
    plain = {"kind": "shaft_order", "p_value": 1e-9, "recordings": (0,), "amplitude_um": 10.0, "std_um": 1.0}
    return Entry(**{**plain, **more})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("entry", "seconds"),
    [
        (wave(gear="driven", order=1.0), 478.69),
        (wave(gear="driven", order=2.0), 239.345),
        (wave(gear="driving", order=1.0), 122.219),  # 478.69 x 12 / 47
        (wave(kind="mesh_order", order=1.0), 10.185),  # 478.69 / 47
        (wave(kind="time", hz=0.05), 20.0),
        (wave(kind="drift"), None),
        (wave(kind="tooth", gear="driven", tooth=3), None),
    ],
)
def test_periods_in_seconds(entry: Entry, seconds: float | None) -> None:
    """Of both shafts, the mesh and a wave of time, as the numbers of teeth have them (five figures)."""
    found = EQ6.period_of(entry)
    assert found == (None if seconds is None else pytest.approx(seconds, rel=1e-4))


def test_a_guide_log_is_told_in_arcsec_and_seconds(tmp_path: Path, gearpoly_command: Command) -> None:
    """The error that went in: 5 arcsec once a turn of the worm, 0.4 arcsec 47 times; through um and back."""
    pair, log, out = tmp_path / "pair.toml", tmp_path / "log.txt", tmp_path / "out.json"
    pair.write_text(PAIR, encoding="utf-8")
    log.write_text(made_log(frames=1500, dithered=(-1, 0.0), lost=-1)[0], encoding="utf-8")
    ran = gearpoly_command("compare", pair, log, "--json", out)
    assert ran.code == 0, ran.err
    found = json.loads(out.read_text(encoding="utf-8"))
    worm = next(one for one in found["where"] if one["kind"] == "shaft_order" and one["gear"] == "driven")
    # A mesh by time and by angle are the same here but for the pulses' share.
    mesh = next(one for one in found["where"] if abs(one.get("period_s", 0.0) - PERIOD / 47) < 0.01)
    # A drift goes beside the worm's wave, of which six turns were seen; the mesh is written to 0.002 arcsec.
    assert worm["amplitude_arcsec"] == pytest.approx(5.0, rel=0.02)
    assert worm["period_s"] == pytest.approx(PERIOD, rel=2e-3)
    assert mesh["amplitude_arcsec"] == pytest.approx(0.4, rel=0.05)
    assert mesh["amplitude_arcsec"] == pytest.approx(PER_UM * mesh["amplitude_um"], rel=1e-4)
    assert found["residual_rms_arcsec"] == pytest.approx(PER_UM * found["residual_rms_um"], rel=1e-4)
    assert mesh["as_often_as"] == ["the mesh"]
    assert mesh["kind"] == "mesh_order" or "every 10.2 s, as often as the mesh, 0.4 arcsec on the sky" in ran.out
    assert "as often as the worm's turn" in ran.out
    assert "rms on the sky" in ran.out


def test_words_of_a_wave_and_of_a_shape() -> None:
    assert entry_words(wave(gear="driving", order=1.0), EQ6).endswith(": every 122 s, 1 arcsec on the sky")
    tooth = wave(kind="tooth", gear="driven", tooth=3, amplitude_um=None, std_um=None, rms_um=2.0)
    assert entry_words(tooth, EQ6).endswith(": 0.21 arcsec rms on the sky")
    assert "sky" not in entry_words(tooth, None)


MOTOR = Part(name="motor", turns=47.1, teeth=None)

NAMED = [
    # Of 5 turns a line is 0.2 orders of the worm wide, half of it 0.1: 0.0979 Hz is order 46.86, 0.0982 order 47.01.
    (wave(kind="time", hz=0.0982, hz_std=1e-5), (), ("the mesh",)),
    (wave(kind="time", hz=0.0979, hz_std=1e-5), (), ()),
    (wave(kind="time", hz=0.0979, hz_std=1e-4), (), ("the mesh",)),  # 3 x 0.048 orders of doubt
    (wave(kind="time", hz=0.19637, hz_std=1e-5), (), ("mesh order 2",)),
    (wave(kind="shaft_order", gear="driving", order=11.99, order_std=0.001), (), ("the mesh",)),
    (wave(kind="time", hz=0.0983, hz_std=1e-5), (MOTOR,), ("the mesh", "the motor's turn")),  # 47.06, between both
    (wave(kind="time", hz=0.00209, hz_std=1e-6), (), ("the worm's turn",)),
    (wave(gear="driving", order=1.0), (), ("the driving gear's turn", "order 4 of the worm")),  # 3.917
    (wave(gear="driven", order=4.0), (), ("the driving gear's turn", "order 4 of the worm")),
    (wave(gear="driven", order=9.0), (), ()),
    (wave(kind="drift"), (), ()),
]


@pytest.mark.parametrize(("entry", "parts", "names"), NAMED)
def test_a_period_has_the_names_of_what_comes_so_often(
    entry: Entry, parts: tuple[Part, ...], names: tuple[str, ...]
) -> None:
    """To half a line, or three standard errors; where two parts of the drive fit, both are told."""
    sky = replace(EQ6, parts=parts, turns=5.0)
    assert sky.names(entry) == names
    assert sky.to_json(entry).get("as_often_as", []) == list(names)
    assert (f"as often as {' or '.join(names)}, " in entry_words(entry, sky)) == bool(names)


def test_a_longer_log_tells_two_names_apart() -> None:
    """The driving gear turns 3.917 times a turn of the worm: a line of ten turns is 0.1 wide."""
    assert replace(EQ6, turns=10.0).names(wave(gear="driving", order=1.0)) == ("the driving gear's turn",)
    assert "as often as" not in entry_words(wave(kind="mesh_order", order=1.0), replace(EQ6, turns=10.0))


@pytest.mark.long
def test_without_a_worm_nothing_is_said_of_the_sky() -> None:
    _, comparison = made_comparison()
    assert sky_of(comparison) is None
    assert finding_json(findings()[0], comparison.located, None) == {}


def test_a_named_wave_is_told_with_its_period(tmp_path: Path) -> None:
    """A finding of order 1 of the driving gear comes once per turn of it; a tooth's has no period."""
    _, comparison = made_comparison()

    def found(one: Finding) -> object:
        return finding_json(one, comparison.located, EQ6).get("on_sky", {}).get("period_s")

    told = {one.claim.physics.name: (one, found(one)) for one in findings()}
    for one, seconds in told.values():
        place = one.claim.place
        if place.tooth is not None:
            assert seconds is None
        elif one.claim.physics.once_per_turn:
            assert seconds == pytest.approx(478.69 * (12 / 47 if place.gear == 0 else 1.0))
    assert any(one.claim.physics.once_per_turn for one, _ in told.values())
