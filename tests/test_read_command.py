"""``gearpoly read``: what is in a file is counted right, and every command that reads recordings takes its map."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from gearpoly.recording.turning import Turning
from tests.at_hand import SHARED, SHIPPED
from tests.made_command import Command
from tests.made_texts import GERMAN, OWN, FloatArray, own, run, table, written

RUN = run(2000)


def turning(folder: Path, columns: dict[str, FloatArray], which: int = 1) -> Turning:
    found = survey(written(folder, table(list(columns.values()), GERMAN)))[0].channels[which].turning
    assert found is not None
    return found


def test_a_steady_run_is_told_as_it_is(tmp_path: Path) -> None:
    found = survey(written(tmp_path, table(list(RUN.values()), GERMAN)))[0]
    assert found.clock is not None
    # Five decimals of a step of 10 ms.
    assert found.clock.rate_hz == pytest.approx(100.0, rel=1e-3)
    assert (found.clock.gaps, found.clock.backs, found.refusal, found.doubts) == ((), (), "", ())
    driving, driven = found.channels[1].turning, found.channels[2].turning
    assert driving is not None and driven is not None
    assert driving.turns == pytest.approx(0.5 * 1999 / 100.0, rel=1e-6)
    assert driven.turns == pytest.approx(0.72 * 0.5 * 1999 / 100.0, rel=1e-4)
    assert (driving.wraps, driven.wraps) == (9, 7)
    # A step of 1.8 deg, and jumps of a turn less one step.
    assert driving.modulus == pytest.approx(360.0, abs=1e-4)
    assert (driving.stops, driving.reversals, driving.repeats, driving.spikes) == ((), (), 0, 0)
    assert [one.column for one in found.channels] == list(OWN)
    assert all(one.sure and one.why for one in found.channels)


def test_gaps_and_a_clock_that_runs_back(tmp_path: Path) -> None:
    t = RUN["time_s"].copy()
    t[500:] += 0.37
    t[1200:] -= 0.9
    angles = [np.mod(one + np.where(np.arange(2000) < 1200, 0.0, 100.0), 360.0) for one in list(RUN.values())[1:3]]
    found = survey(written(tmp_path, table([t, *angles, RUN["torque_nm"]], GERMAN)))[0]
    assert found.clock is not None
    assert found.clock.gaps == ((500, pytest.approx(0.38, abs=1e-9)),)
    assert found.clock.backs == (1201,)
    drop = {**RUN, "driving_angle_deg": np.where(np.arange(2000) % 400 == 7, np.nan, RUN["driving_angle_deg"])}
    assert survey(written(tmp_path, own(drop), name="own.csv"))[0].channels[1].missing == 5


def test_a_stop_in_the_middle(tmp_path: Path) -> None:
    turned = np.concatenate([1.8 * np.arange(800), np.full(300, 1.8 * 800), 1.8 * np.arange(800, 1700)])
    held = {**RUN, "driving_angle_deg": np.mod(turned, 360.0)}
    (stop,) = turning(tmp_path, held).stops
    # Told by windows of a dozen samples, so known to that.
    assert abs(stop[0] - 801) <= 12 and abs(stop[1] - 1101) <= 12


def test_forth_and_back(tmp_path: Path) -> None:
    turned = 1.8 * np.concatenate([np.arange(900), np.arange(900, 200, -1), np.arange(200, 600)])
    for held in (turned, np.mod(turned, 360.0)):
        found = turning(tmp_path, {**RUN, "driving_angle_deg": held})
        assert (found.reversals, found.stops) == ((901, 1601), ())


def test_readings_that_repeat_and_spikes(tmp_path: Path) -> None:
    held = np.repeat(RUN["driving_angle_deg"][::4], 4)
    found = turning(tmp_path, {**RUN, "driving_angle_deg": held})
    assert (found.repeats, found.stops) == (2000 - 500, ())
    wild = RUN["driving_angle_deg"] + 40.0 * np.isin(np.arange(2000), [333, 1444])
    assert turning(tmp_path, {**RUN, "driving_angle_deg": np.mod(wild, 360.0)}).spikes == 2


def test_everything_is_in_the_json(tmp_path: Path, gearpoly_command: Command) -> None:
    file = written(tmp_path, table(list(RUN.values()), ("Zeit [s]", "Winkel 1 [°]", "Winkel 2 [°]", "Temperatur [°C]")))
    ran = gearpoly_command("read", str(file), "--json", "-")
    assert ran.code == 0 and ran.err == ""
    (one,) = json.loads(ran.out)["recordings"]
    assert [column["taken_for"] for column in one["columns"]] == [
        "time_s", "driving_angle_deg", "driven_angle_deg", None,
    ]  # fmt: skip
    assert [column["sure"] for column in one["columns"]] == [True, False, False, False]
    assert one["columns"][1]["turning"]["wraps"] == 9
    assert "of which shaft" in one["doubts"][0]["says"]
    assert one["doubts"][0]["map"] == ['columns.driving_angle_deg = { from = "Winkel 1 [°]", unit = "deg" }']
    assert "Winkel 1" in one["refused"]


def test_the_terminal_says_what_was_taken_and_why(tmp_path: Path, gearpoly_command: Command) -> None:
    file = written(tmp_path, table(list(RUN.values()), GERMAN), encoding="utf-16")
    ran = gearpoly_command("read", str(file), "--plot", str(tmp_path / "a.png"))
    assert ran.code == 0
    for words in ("19.99 s at 100", "driving_angle_deg", "9.995 turns", "9 times at about 360", "text in utf-16",
                  "to be compared as it is"):  # fmt: skip
        assert words in ran.out, words
    assert (tmp_path / "a.png").stat().st_size > 10_000


def healthy(folder: Path) -> tuple[Path, Path]:
    """The pair file of a shipped recording, and that recording as a German logger writes it, to the same digits."""
    pair = folder / "pair.toml"
    pair.write_bytes((SHIPPED / "healthy" / "pair.toml").read_bytes())
    text = (SHIPPED / "healthy" / "rec_0.csv").read_text(encoding="utf-8")
    head = [line for line in text.splitlines() if line.startswith("#")]
    rows = [line for line in text.splitlines() if not line.startswith("#")]
    names = {"time_s": "t [s]", "driving_angle_deg": "Winkel 1", "driven_angle_deg": "Winkel 2"}
    header = ";".join(names[name] for name in rows[0].split(","))
    body = [row.replace(",", ";").replace(".", ",") for row in rows[1:]]
    return pair, written(folder, "\n".join([*head, header, *body]) + "\n", encoding="utf-16")


def settled(folder: Path, file: Path, command: Command) -> Path:
    """The map that ``gearpoly read`` writes, with what it asks taken as it is offered."""
    target = folder / "map.toml"
    ran = command("read", str(file), "--write", str(target))
    assert ran.code == 0, ran.err
    text = target.read_text(encoding="utf-8")
    assert text.count("\n# columns.") == 2
    target.write_text(re.sub(r"^# (columns\.)", r"\1", text, flags=re.MULTILINE), encoding="utf-8")
    return target


@pytest.mark.slow
def test_compare_takes_the_map_and_finds_the_same_numbers(tmp_path: Path, gearpoly_command: Command) -> None:
    pair, file = healthy(tmp_path)
    refused = gearpoly_command("compare", str(pair), str(file))
    assert refused.code == 2 and "Winkel 1" in refused.err and "--map" in refused.err
    chart = settled(tmp_path, file, gearpoly_command)
    mapped = gearpoly_command("compare", str(pair), str(file), "--map", str(chart), "--json", "-")
    plain = gearpoly_command("compare", str(pair), str(SHIPPED / "healthy" / "rec_0.csv"), "--json", "-")
    assert mapped.code == plain.code == 0, mapped.err

    def numbers(out: str) -> dict[str, Any]:
        return {k: v for k, v in json.loads(out).items() if k in ("noise_um", "alignment", "where", "residual_rms_um")}

    # The same decimals, so the same doubles.
    assert numbers(mapped.out) == numbers(plain.out)


@pytest.mark.long
def test_simulate_at_takes_the_map(tmp_path: Path, gearpoly_command: Command) -> None:
    pair, file = healthy(tmp_path)
    chart = settled(tmp_path, file, gearpoly_command)
    out = [tmp_path / "mapped.csv", tmp_path / "plain.csv"]
    for target, more in zip(
        out, (["--at", str(file), "--map", str(chart)], ["--at", str(SHIPPED / "healthy" / "rec_0.csv")]), strict=True
    ):
        ran = gearpoly_command("simulate", str(pair), "--fast", "--csv", str(target), *more)
        assert ran.code == 0, ran.err
    assert out[0].read_bytes() == out[1].read_bytes()
    ran = gearpoly_command("simulate", str(pair), "--map", str(chart))
    assert ran.code == 2 and "want --at beside it" in ran.err


@pytest.mark.slow
def test_diagnose_and_view_take_the_map(tmp_path: Path, gearpoly_command: Command) -> None:
    pair, file = healthy(tmp_path)
    chart = str(settled(tmp_path, file, gearpoly_command))
    verdicts = []
    for words in ([str(file), "--map", chart], [str(SHIPPED / "healthy" / "rec_0.csv")]):
        ran = gearpoly_command("diagnose", str(pair), *words, "--json", "-")
        assert ran.code == 0, ran.err
        verdicts.append(json.loads(ran.out))
    assert verdicts[0]["status"] == verdicts[1]["status"]
    assert verdicts[0]["fit"] == verdicts[1]["fit"]
    page = tmp_path / "page.html"
    ran = gearpoly_command("view", str(pair), "--recording", str(file), "--map", chart, "--html", str(page))
    assert ran.code == 0, ran.err
    assert page.is_file()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["read", "{file}", "{file}", "--write", "{out}"], "a map is of one file, and 2 are given"),
        (["read", "{file}", "--write", "{file}"], "this is what is read"),
        (["read", "{file}", "--write", "{out}", "--map", "{map}"], "leave out --write"),
        (["read", "{file}", "--map", "{absent}"], "no such file"),
        (["read", "{absent}"], "no such file"),
        (
            ["compare", "{pair}", "{file}", "{file}", "{file}", "--map", "{map}", "--map", "{map}"],
            "2 maps for 3 recordings",
        ),
        (["view", "{pair}", "--map", "{map}", "--html", "{out}.html"], "want --recording beside it"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_message(
    tmp_path: Path, gearpoly_command: Command, words: list[str], message: str
) -> None:
    places = {
        "file": written(tmp_path, own(RUN)), "out": tmp_path / "out", "map": tmp_path / "m.toml",
        "absent": tmp_path / "absent", "pair": SHIPPED / "healthy" / "pair.toml",
    }  # fmt: skip
    places["map"].write_text("", encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    ran = gearpoly_command(*(word.format(**places) for word in words))
    assert ran.code == 2
    assert message in ran.err
    assert ran.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.slow
def test_a_set_in_one_file_is_compared_as_a_set(tmp_path: Path, gearpoly_command: Command) -> None:
    """Both recordings of a pair written one below the other, under names that are sure."""
    folder = SHIPPED / "encoder_off_centre"
    files = sorted(folder.glob("rec_*.csv"))
    both = tmp_path / "both.csv"
    both.write_text("".join(one.read_text(encoding="utf-8") for one in files), encoding="utf-8")
    apart = gearpoly_command("compare", str(folder / "pair.toml"), *map(str, files), "--json", "-")
    together = gearpoly_command("compare", str(folder / "pair.toml"), str(both), "--json", "-")
    assert apart.code == together.code == 0, together.err
    assert json.loads(apart.out)["residual_rms_um"] == json.loads(together.out)["residual_rms_um"]


@pytest.mark.long
@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared recordings are not on this machine")
def test_guide_logs_are_shown_without_a_pair(gearpoly_command: Command) -> None:
    for log in sorted((SHARED / "guide_logs").glob("log*.txt")):
        ran = gearpoly_command("read", str(log), "--json", "-")
        assert ran.code == 0, ran.err
        (one,) = json.loads(ran.out)["recordings"]
        assert one["format"] == "PHD2 guide log"
        assert 0.05 < one["clock"]["rate_hz"] < 5.0
        assert "[worm]" in one["refused"]


def test_a_survey_leaves_the_numbers_as_they_are(tmp_path: Path) -> None:
    file = written(tmp_path, own(RUN))
    found = survey(file)[0]
    assert found.channels[1].span == (pytest.approx(0.0), pytest.approx(358.2))  # deg, not rad
    assert read_recording(file).size == 2000


def test_no_pair_is_spoken_of_where_a_recording_has_gaps(tmp_path: Path) -> None:
    """Rows are missing for whole turns: travels by their ends alone made 0.81 of 18/25, and "the pair's" ratio of it,
    though nobody had named a pair."""
    driving = np.arange(0.0, 18.2 * 360.0, 0.8)
    rows = np.ones(driving.size, dtype=bool)
    for start in range(300, 8000, 700):
        rows[start : start + 280 + start // 20] = False  # 0.6 to 1.5 driving turns
    columns = zip(np.arange(driving.size) / 225.0, driving % 360.0, driving * 18 / 25 % 360.0, strict=True)
    lines = [f"{a:.5f},{b:.5f},{c:.5f}" for (a, b, c), kept in zip(columns, rows, strict=True) if kept]
    (tmp_path / "r.csv").write_text("time_s,driving_angle_deg,driven_angle_deg\n" + "\n".join(lines) + "\n")
    (seen,) = survey(tmp_path / "r.csv")
    assert not seen.refusal
