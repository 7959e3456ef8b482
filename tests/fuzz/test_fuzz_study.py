"""Study files made wrong, and a study's own folder damaged: a plan and a table, or one line."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearpoly.study.answers import answer
from gearpoly.study.answers_json import answers_json
from gearpoly.study.pipeline import MadeRow
from gearpoly.study.plan import plan_of
from gearpoly.study.read import read_study
from gearpoly.study.run import plan_study
from gearpoly.study.store import MANIFEST_FILE, ROWS_FOLDER, opened, write_manifest
from tests.fuzz.judge import FUZZ, judged
from tests.fuzz.mutate import damaged, toml, trees
from tests.study_files import GRADES, write_study

HEAD = 'name = "small study"\npair = "pair.toml"\npairs = 6\nseed = 7\npositions_per_mesh = 5\n'
SOBOL = """
samples = 4
outputs = ["te_pp_um", "backlash_mean_um"]
[set]
"pair.torque_nm" = 2.0
[[sweep]]
key = "pair.centre_distance_mm"
method = "sobol"
from = 24.9
to = 25.1
[[limit]]
output = "te_pp_um"
at_most = 20.0
[until]
output = "te_pp_um"
percentile = 95
width = 1.0
"""
ORIGINALS = [tomllib.loads(HEAD + text) for text in ("", GRADES, SOBOL)]


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_a_study_file_gives_a_plan_or_one_line(folder: Path, data: st.DataObject) -> None:
    file = write_study(folder)
    file.write_bytes(data.draw(damaged(toml(data.draw(trees(ORIGINALS))).encode())))
    study = judged("study files", lambda: read_study(file))
    if study is not None:
        judged("studies planned", lambda: plan_study(study))


@pytest.fixture(scope="module")
def finished(folder: Path) -> dict[Path, bytes]:
    """Every file of a finished study of four rows, whose figures are made up."""
    out = folder / "out"
    plan = plan_of(read_study(write_study(folder, 'outputs = ["te_pp_um"]\n', pairs=4)))
    with opened(out, plan) as store:
        for k in range(4):
            store.write([
                MadeRow(index=k, combination=0, draw=k, values={}, seed=k, status="done", reason="", outputs=(1.0 + k,))
            ])  # fmt: skip
        write_manifest(store, rows=4, finished=True, why="all rows")
    return {file: file.read_bytes() for file in (out / MANIFEST_FILE, *(out / ROWS_FOLDER).iterdir())}


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_a_damaged_study_folder_gives_answers_or_one_line(
    folder: Path, finished: dict[Path, bytes], data: st.DataObject
) -> None:
    hurt = data.draw(st.sampled_from(sorted(finished)))
    for file, whole in finished.items():
        file.write_bytes(data.draw(damaged(whole)) if file == hurt else whole)
    judged("study folders", lambda: answers_json(answer(folder / "out")))
