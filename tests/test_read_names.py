"""A torque that only the name of a file says: it is offered, and taken where its owner confirms it."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearpoly.recording.in_name import in_name
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from tests.made_texts import chart, own, run, written

RUN = run(800)
BARE = {name: held for name, held in RUN.items() if name != "torque_nm"}


@pytest.mark.parametrize(
    ("name", "ask"),
    [
        ("run_20Nm_drive.csv", ("keys.torque_nm = 20.0", 'keys.flank = "drive"')),
        ("10Nm.csv", ("keys.torque_nm = 10.0",)),
        ("-5 N.m.csv", ("keys.torque_nm = 5.0", 'keys.flank = "coast"')),
        ("test_-5Nm.csv", ("keys.torque_nm = 5.0", 'keys.flank = "coast"')),
        ("run-5Nm.csv", ("keys.torque_nm = 5.0",)),
        ("T5Nm_30rpm_coast.csv", ("keys.torque_nm = 5.0", 'keys.flank = "coast"')),
        ("2026-10-25 12,5 Nm Schub.txt", ("keys.torque_nm = 12.5", 'keys.flank = "coast"')),
        ("pair3_500Nmm.csv", ("keys.torque_nm = 0.5",)),
        ("load_0.2kNm.csv", ("keys.torque_nm = 200.0",)),
        ("M_15_N-m_2.csv", ("keys.torque_nm = 15.0",)),
        ("0Nm.csv", ("keys.torque_nm = 0.0",)),
        ("20Nm_20Nm.csv", ("keys.torque_nm = 20.0",)),
    ],
)
def test_the_torque_that_a_name_says(tmp_path: Path, name: str, ask: tuple[str, ...]) -> None:
    file = written(tmp_path, own(BARE), name=name)
    (found,) = survey(file)
    assert not found.refusal
    assert [one.ask for one in found.doubts] == [ask]
    plain = read_recording(file)
    assert plain.torque_nm is None and plain.flank == "drive"
    assert any(ask[0] in remark for remark in plain.remarks)
    confirmed = map_text(found).replace("# keys.", "keys.")
    read = read_recording(file, chart=chart(tmp_path, confirmed))
    assert read.torque_nm == float(ask[0].split(" = ")[1])
    assert read.flank == ("coast" if 'keys.flank = "coast"' in ask else "drive")
    assert not any("keys." in remark for remark in read.remarks)


@pytest.mark.parametrize(
    "name", ["rec_0.csv", "20Nm_to_50Nm.csv", "run20.csv", "20Newmarket.csv", "3Nmap.csv", "10 m.csv"]
)
def test_names_that_say_no_torque(name: str) -> None:
    assert in_name(Path(name), {}, ["time_s"]) == []


def test_what_the_file_states_is_not_asked_again(tmp_path: Path) -> None:
    assert survey(written(tmp_path, own(RUN), name="10Nm.csv"))[0].doubts == ()
    assert survey(written(tmp_path, "# torque_nm = 9.8\n" + own(BARE), name="10 Nm.csv"))[0].doubts == ()


def test_a_speed_is_asked_for_where_no_time_tells_it(tmp_path: Path) -> None:
    assert in_name(Path("a_30rpm.csv"), {}, ["time_s"]) == []
    (one,) = in_name(Path("a_30rpm.csv"), {}, [])
    assert one.ask == ("keys.speed_rpm = 30.0",)
    (other,) = in_name(Path("Versuch 120 U_min.csv"), {}, [])
    assert other.ask == ("keys.speed_rpm = 120.0",)
