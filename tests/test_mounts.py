"""Telescope mounts that are known: their numbers against each other, and the pair files that are written of them."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.mounts import SIDEREAL_DAY_S, Mount, find_mount, mount_text, mounts
from gearpoly.files.pairfile import read_pair
from tests.made_command import Command
from tests.made_guide_log import made_log

SOLAR_DAY_S = 86400.0


@pytest.mark.parametrize("mount", mounts(), ids=lambda mount: mount.names[0])
def test_a_mount_has_its_sources(mount: Mount) -> None:
    """Every number is of somewhere; the worm's period as it is printed is a day, sidereal or solar, over the teeth."""
    assert mount.worm_source
    assert (mount.driving is None) == (mount.driven is None) == (not mount.gears_source)
    if mount.printed_s is not None:
        decimals = len(f"{mount.printed_s:.10f}".rstrip("0").partition(".")[2])
        off = min(abs(day / mount.wheel_teeth - mount.printed_s) for day in (SIDEREAL_DAY_S, SOLAR_DAY_S))
        # To the last digit that is printed, and to a day of 86164.0905 s at the best.
        assert off <= max(0.5 * 10.0**-decimals, 1e-4)


def test_no_name_is_of_two_mounts() -> None:
    names = [name.lower() for mount in mounts() for name in mount.names]
    assert len(set(names)) == len(names)
    for mount in mounts():
        for name in mount.names:
            assert find_mount(name) is mount
            assert find_mount(f"{mount.maker} {name.lower()}") is mount


def test_the_list_is_part_of_the_package() -> None:
    """What an installed wheel holds is what lies below the package."""
    assert (files("gearpoly") / "data" / "mounts.toml").is_file()


@pytest.mark.parametrize("mount", [one for one in mounts() if one.driving], ids=lambda mount: mount.names[0])
def test_a_known_mount_s_pair_file_reads(mount: Mount, tmp_path: Path) -> None:
    pair = tmp_path / "pair.toml"
    pair.write_text(mount_text(mount), encoding="utf-8")
    read = read_pair(pair)
    assert (read.driving.teeth, read.driven.teeth) == (mount.driving, mount.driven)
    assert read.worm is not None and read.worm.wheel_teeth == mount.wheel_teeth
    assert len(read.also_turns) == len(mount.also_turns)


def test_the_train_of_an_avx_gives_the_periods_that_its_owners_list() -> None:
    """s, of the turns and the meshes, from an independent list (PEMPro's fundamentals of the AVX)."""
    avx = find_mount("AVX")
    turns = {part["name"]: part.get("turns_per_driven") or 2 * part["turns_per_driving"] for part in avx.also_turns}
    teeth = {part["name"]: part["teeth"] for part in avx.also_turns}
    listed = {"motor pinion": 11.081, "first gear": 33.242, "second gear": 99.727, "third gear": 299.181}
    for name, seconds in listed.items():
        assert avx.period_s / turns[name] == pytest.approx(seconds, abs=6e-4)
    meshes = {"motor pinion": 1.231, "first gear": 3.022, "second gear": 9.066, "transfer gear": 19.945}
    for name, seconds in meshes.items():
        assert avx.period_s / (turns[name] * teeth[name]) == pytest.approx(seconds, abs=6e-4)
    assert avx.driven is not None
    assert avx.period_s / avx.driven == pytest.approx(18.699, abs=6e-4)


@pytest.mark.long
def test_the_command_writes_a_file_that_a_guide_log_is_told_with(tmp_path: Path, gearpoly_command: Command) -> None:
    pair, log = tmp_path / "pair.toml", tmp_path / "log.txt"
    ran = gearpoly_command("pair", "--mount", "eq-6", pair)
    assert ran.code == 0, ran.err
    assert "INDI" in pair.read_text(encoding="utf-8")
    log.write_text(made_log(frames=600)[0], encoding="utf-8")
    assert gearpoly_command("compare", pair, log).code == 0


def test_a_mount_without_known_gears_says_what_to_fill_in(tmp_path: Path, gearpoly_command: Command) -> None:
    pair = tmp_path / "pair.toml"
    ran = gearpoly_command("pair", "--mount", "CGX", pair)
    assert ran.code == 0 and "state the teeth" in ran.err
    text = pair.read_text(encoding="utf-8")
    with pytest.raises(InputFileError, match=r"driving\.teeth: missing"):
        read_pair(pair)
    # Filled in as it asks, the file reads.
    pair.write_text(text.replace("# teeth = ", "teeth = 15 # "), encoding="utf-8")
    assert read_pair(pair).driven.teeth == 15


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (("--mount",), "want one of EQ6, NEQ6"),
        (("--mount", "EQ66", "x.toml"), "the nearest known are EQ6"),
        (("--mount", "zzzz", "x.toml"), "known are EQ6"),
        (("--mount", "EQ6"), "want --mount EQ6 PAIR.toml"),
        (("--mount", "EQ6", "--new", "x.toml"), "want one of --new FILE"),
        (("x.toml",), "want one of --new FILE"),
        ((), "want one of --new FILE"),
    ],
)
def test_what_is_not_known_is_one_message(given: tuple[str, ...], says: str, gearpoly_command: Command) -> None:
    ran = gearpoly_command("pair", *given)
    assert ran.code == 2
    assert says in ran.err
    assert not Path("x.toml").exists()


def test_a_file_that_exists_is_kept(tmp_path: Path, gearpoly_command: Command) -> None:
    pair = tmp_path / "pair.toml"
    pair.write_text("mine", encoding="utf-8")
    assert gearpoly_command("pair", "--mount", "EQ6", pair).code == 2
    assert pair.read_text(encoding="utf-8") == "mine"
