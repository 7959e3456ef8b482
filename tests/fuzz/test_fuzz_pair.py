"""Pair files made wrong, the measured traces that they name too: a pair of gears, or one line."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearpoly.assemble import assemble
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.files.traces import read_traces
from tests.fuzz.judge import FUZZ, judged
from tests.fuzz.mutate import damaged, toml, trees
from tests.made_pairfile import CONTRACT, SMALLEST
from tests.study_files import PAIR

ORIGINALS = [tomllib.loads(text) for text in (SMALLEST, CONTRACT, PAIR)]
for original in ORIGINALS:
    for name in ("driving", "driven"):
        original[name]["points_per_flank"] = 60  # so that assembling takes milliseconds

MUCH = 20_000
"""Points on all flanks of both gears above which an assembly is left out: honest work, but not for ten thousand."""

TRACES = "".join(
    f"{tooth},{flank},{length},{0.1 * tooth}\n"
    for tooth in (0, 3)
    for flank in ("drive", "coast")
    for length in (4, 6.5, 9)
)


@FUZZ
@given(data=st.data())
def test_a_pair_file_gives_a_pair_or_one_line(folder: Path, data: st.DataObject) -> None:
    file = folder / "pair.toml"
    (folder / "driving_flanks.csv").write_text(f"tooth,flank,roll_length_mm,deviation_um\n{TRACES}")
    file.write_bytes(data.draw(damaged(toml(data.draw(trees(ORIGINALS))).encode("utf-8", "surrogatepass"))))
    pair = judged("pair files", lambda: read_pair(file))
    if pair is not None:
        file.write_text(dump_pair(pair), encoding="utf-8")
        assert read_pair(file) == pair
        if _points(pair) < MUCH:
            judged("pairs assembled", lambda: assemble(pair, path=file, seed=1))


def _points(pair: PairFile) -> float:
    fine = [gear.points_per_flank or 200 * max(1.0, 0.05 / gear.chord_error_um) ** 0.5 * gear.module_mm**0.5
            for gear in (pair.driving, pair.driven)]  # fmt: skip
    return 2 * sum(n * gear.teeth for n, gear in zip(fine, (pair.driving, pair.driven), strict=True))


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_a_trace_file_gives_traces_or_one_line(folder: Path, data: st.DataObject) -> None:
    file = folder / "flanks.csv"
    rows = data.draw(st.permutations(TRACES.splitlines(keepends=True)))
    cells = ("tooth", "flank", "roll_length_mm", "deviation_um")
    text = ",".join(cells) + "\n" + "".join(rows)
    file.write_bytes(data.draw(damaged(data.draw(damaged(text.encode())))))
    judged("trace files", lambda: read_traces(file, 18))
