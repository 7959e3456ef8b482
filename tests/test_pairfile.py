"""pair.toml and trace files: what is read, what is refused, and what the refusal says."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.errors import GeometryError, InputFileError
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import dump_pair, effective_defaults, moved, profile_csv_path, read_pair
from gearpoly.gear.nominal import nominal_gear
from tests.at_hand import BENCH, SHIPPED, here
from tests.made_pairfile import CONTRACT, PITCH, ROOT, SMALLEST, write


def test_contract_example_is_read_whole(tmp_path: Path) -> None:
    write(tmp_path, "tooth,flank,roll_length_mm,deviation_um\n", "driving_flanks.csv")
    pair = read_pair(write(tmp_path, CONTRACT))
    assert pair.name == "18/25 bench pair"
    assert pair.pair.centre_distance_mm == 43.0
    assert (pair.pair.torque_nm, pair.pair.speed_rpm) == (25.0, 30.0)
    assert pair.model.tooth_deflection
    assert (pair.material.youngs_modulus_gpa, pair.material.poisson_ratio) == (206.0, 0.3)
    driving = pair.driving
    assert (driving.teeth, driving.module_mm, driving.grade) == (18, 2.0, 5)
    assert driving.limits is not None
    assert driving.inspection is not None
    assert (driving.limits.E_sns_um, driving.limits.E_sni_um) == (-40.0, -70.0)
    assert driving.inspection.pitch_um == tuple(PITCH)
    assert driving.inspection.profile_slope_um == 1.2
    assert driving.tip_relief is not None
    assert driving.eccentricity is not None
    assert driving.tip_relief.flank == "both"
    assert driving.eccentricity.angle_deg == 40.0
    assert profile_csv_path(tmp_path / "pair.toml", driving) == tmp_path / "driving_flanks.csv"
    assert pair.driven.limits is None
    assert pair.driven.inspection is None
    assert profile_csv_path(tmp_path / "pair.toml", pair.driven) is None


def test_defaults_are_iso_53_profile_a_and_steel(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST))
    gear = pair.driving
    rack = nominal_gear(gear).rack
    assert (gear.pressure_angle_deg, rack.h_aP, rack.h_fP, rack.rho_fP) == (20.0, 1.0, 1.25, 0.38)
    assert (pair.material.youngs_modulus_gpa, pair.material.poisson_ratio) == (206.0, 0.3)
    assert pair.model.tooth_deflection
    assert pair.pair.torque_nm == 0.0
    assert pair.pair.centre_distance_mm is gear.bore_mm is gear.grade is None


def test_at_other_angles_the_root_is_as_round_as_fits(tmp_path: Path) -> None:
    """At 25 deg and the usual dedendum a round of 0.38 leaves the cutting rack no land: (pi/4 - 1.25 tan 25) cos 25 /
    (1 - sin 25) = 0.3179 does. So it is where a file writes the default out, and no other round is changed."""
    for more in ("", "root_radius = 0.38\n"):
        text = SMALLEST.replace("teeth =", f"pressure_angle_deg = 25.0\n{more}teeth =")
        gear = nominal_gear(read_pair(write(tmp_path, text)).driving)
        assert gear.rack.rho_fP == pytest.approx(0.3179, abs=1e-4)
        assert 0.0 <= gear.rack.half_land < 1e-8
    text = SMALLEST.replace("teeth =", "pressure_angle_deg = 25.0\nroot_radius = 0.37\nteeth =")
    with pytest.raises(GeometryError, match=r"at most 0\.3178"):
        nominal_gear(read_pair(write(tmp_path, text)).driving)


def test_effective_defaults_name_what_was_left_out_and_nothing_else(tmp_path: Path) -> None:
    shown = dict(effective_defaults(read_pair(write(tmp_path, SMALLEST))))
    assert shown["driving.pressure_angle_deg"] == 20.0
    assert shown["model.tooth_deflection"] is True
    assert shown["driven.bore_mm"] == "half the root diameter"
    assert shown["pair.centre_distance_mm"] == "tight mesh of the deviation-free gears"
    assert shown["driving.grade"] == "ideal gear"
    assert "driving.teeth" not in shown
    assert "driving.grade_edition" not in shown  # without a grade it has no effect
    graded = SMALLEST.replace("teeth = 18", "teeth = 18\ngrade = 5\npoints_per_flank = 500")
    shown = dict(effective_defaults(read_pair(write(tmp_path, graded))))
    assert shown["driving.grade_edition"] == 2013
    assert shown["driving.thickness_errors"] == "graded"
    assert "driving.chord_error_um" not in shown  # points_per_flank stands in its place
    assert shown["driven.chord_error_um"] == 0.001


def test_integers_are_accepted_where_floats_are_wanted(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST.replace("2.0", "2")))
    assert pair.driving.module_mm == 2.0
    assert isinstance(pair.driving.module_mm, float)


def test_byte_order_mark_and_crlf_are_fine(tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_bytes(b"\xef\xbb\xbf" + SMALLEST.replace("\n", "\r\n").encode())
    assert read_pair(file).driven.teeth == 25


def test_pair_is_frozen(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST))
    with pytest.raises(ValueError, match="frozen"):
        pair.driving.teeth = 19


def test_every_key_is_described() -> None:
    sections = [PairFile]
    for section in sections:
        for key, info in section.model_fields.items():
            assert info.description, f"{section.__name__}.{key}"


# Writing back.

um = st.floats(-1e4, 1e4)
um_size = st.floats(0.0, 1e4)
length = st.floats(1e-3, 1e5)


@st.composite
def pairs(draw: st.DrawFn) -> PairFile:
    """Any pair that the rules allow, in the file's own structure."""

    def some(**keys: st.SearchStrategy[object]) -> dict[str, object]:
        return draw(st.fixed_dictionaries({}, optional=keys))

    module, angle = draw(st.floats(0.05, 100.0)), draw(st.none() | st.floats(10.0, 35.0))

    def gear() -> dict[str, object]:
        teeth = draw(st.integers(5, 40))
        per_tooth = um | st.lists(um, min_size=teeth, max_size=teeth)
        limits = some(f_pt_um=um_size, F_p_um=um_size, f_Halpha_um=um_size, f_falpha_um=um_size)
        for symbol in ("E_sn", "W_kn"):
            if draw(st.booleans()):
                lower, upper = sorted(draw(st.tuples(um, um)))
                limits |= {f"{symbol}i_um": lower, f"{symbol}s_um": upper}
        keys = ("pitch", "pitch_coast", "profile_slope", "profile_slope_coast", "tooth_thickness")
        tables: dict[str, object] = {
            "limits": limits,
            "inspection": some(uncertainty_um=um_size, **{f"{key}_um": per_tooth for key in keys}),
            "tip_relief": {
                "amount_um": draw(um_size),
                "length_mm": draw(length),
                **some(
                    shape=st.sampled_from(["linear", "parabolic"]),
                    flank=st.sampled_from(["both", "drive", "coast"]),
                ),
            },
            "eccentricity": {"amplitude_um": draw(um_size), **some(angle_deg=st.floats(-360, 360))},
        }
        kept = {name: table for name, table in tables.items() if draw(st.booleans())}
        points: list[dict[str, object]] = [
            {},
            {"points_per_flank": draw(st.integers(8, 200_000))},
            {"chord_error_um": draw(st.floats(1e-6, 10.0))},
        ]
        return {
            "teeth": teeth,
            "module_mm": module,
            "face_width_mm": draw(length),
            **({} if angle is None else {"pressure_angle_deg": angle}),
            **some(
                profile_shift=st.floats(-5.0, 5.0),
                bore_mm=length,
                grade=st.integers(1, 11),
                grade_edition=st.sampled_from([1995, 2013]),
                profile_errors=st.sampled_from(["smooth", "scatter"]),
            ),
            **draw(st.sampled_from(points)),
            **kept,
        }

    raw = some(
        name=st.text(max_size=20),
        pair=st.fixed_dictionaries({}, optional={"torque_nm": um_size, "speed_rpm": length}),
        model=st.fixed_dictionaries({}, optional={"tooth_deflection": st.booleans()}),
    )
    return PairFile.model_validate({**raw, "driving": gear(), "driven": gear()})


@pytest.mark.long
@settings(max_examples=30, deadline=None)
@given(pair=pairs())
def test_dumped_pair_reads_back_equal(pair: PairFile) -> None:
    with tempfile.TemporaryDirectory() as folder:
        again = read_pair(write(Path(folder), dump_pair(pair)))
    assert again == pair
    # What the file left out is still left out, so that `simulate` still shows it as a default.
    assert effective_defaults(again) == effective_defaults(pair)


def test_changed_copy_is_dumped_with_its_changes(tmp_path: Path) -> None:
    pair = read_pair(write(tmp_path, SMALLEST))
    driven = pair.driven.model_copy(update={"profile_shift": 0.1})
    fitted = pair.model_copy(update={"driven": driven})
    assert read_pair(write(tmp_path, dump_pair(fitted))) == fitted


def test_moved_pair_still_finds_its_traces(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    write(tmp_path, "tooth,flank,roll_length_mm,deviation_um\n", "driving_flanks.csv")
    source, target = write(tmp_path, CONTRACT), tmp_path / "out" / "fitted.toml"
    pair = moved(read_pair(source), source=source, target=target)
    write(target.parent, dump_pair(pair), target.name)
    traces = profile_csv_path(target, read_pair(target).driving)
    assert traces is not None
    assert traces.samefile(tmp_path / "driving_flanks.csv")


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(CONTRACT)))
    stop = data.draw(st.integers(start, min(len(CONTRACT), start + 30)))
    text = CONTRACT[:start] + data.draw(st.text(max_size=8)) + CONTRACT[stop:]
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder), "", "driving_flanks.csv")
        try:
            read_pair(write(Path(folder), text))
        except InputFileError as error:
            assert error.wish


@pytest.mark.parametrize("name", ["paper_18_25", "ideal_18_25", "ottewill_18_18"])
def test_shipped_pairs_are_read(name: str) -> None:
    pair = read_pair(ROOT / "data" / "pairs" / f"{name}.toml")
    assert (pair.driving.teeth, pair.driven.teeth) == tuple(int(z) for z in name.split("_")[1:])


def test_pairs_of_recordings_are_read_and_written_back(tmp_path: Path) -> None:
    files = [file for folder in here(SHIPPED, BENCH) for file in sorted(folder.glob("*/pair.toml"))]
    assert files
    for file in files:
        pair = read_pair(file)
        assert read_pair(write(tmp_path, dump_pair(pair))) == pair
