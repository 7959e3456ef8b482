"""Which pair has which number: combinations, streams and chunks, from seed and index alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.study.design import Design
from gearpoly.study.keys import is_whole, known_keys, with_values
from gearpoly.study.models import StudyFile
from gearpoly.study.plan import StudyPlan, plan_of, size_at
from gearpoly.study.read import read_study
from tests.study_files import GRADES, write_study


def _design(**keys: object) -> Design:
    return Design(file=StudyFile.model_validate({"pair": "p.toml", **keys}))


LIST = {"keys": ["driving.grade", "driven.grade"], "method": "list", "values": [4, [5, 6]]}
GRID = {"key": "pair.centre_distance_mm", "method": "grid", "from": 43.0, "to": 43.2, "steps": 3}
SOBOL = {"key": "pair.torque_nm", "method": "sobol", "from": 5.0, "to": 25.0}
TEETH = {"key": "driven.teeth", "method": "sobol", "from": 20.0, "to": 23.0}


def test_combinations_are_all_of_list_and_grid() -> None:
    design = _design(sweep=[LIST, GRID], pairs=2)
    found = {tuple(design.values(k).values()) for k in range(design.combinations)}
    assert found == {(a, b, c) for a, b in ((4, 4), (5, 6)) for c in (43.0, 43.1, 43.2)}
    assert design.rows == 12


def test_rows_run_through_combinations_first_so_that_more_pairs_only_add_rows() -> None:
    few, many = _design(sweep=[LIST, GRID], pairs=2), _design(sweep=[LIST, GRID], pairs=50)
    assert [few.place(k) for k in range(few.rows)] == [many.place(k) for k in range(few.rows)]
    assert [few.seed(k) for k in range(few.rows)] == [many.seed(k) for k in range(few.rows)]


def test_shared_draws_repeat_over_combinations_and_own_ones_never() -> None:
    shared, own = _design(sweep=[LIST], pairs=30), _design(sweep=[LIST], pairs=30, draws="own")
    assert shared.seed(0) == shared.seed(1) != shared.seed(2)
    seeds = [own.seed(k) for k in range(own.rows)]
    assert len(set(seeds)) == len(seeds)
    assert all(0 <= seed < 2**63 for seed in seeds)
    # Another study seed: another stream everywhere.
    assert not {*seeds} & {_design(sweep=[LIST], pairs=30, draws="own", seed=1).seed(k) for k in range(own.rows)}


def test_sobol_points_fill_their_ranges_evenly() -> None:
    design = _design(sweep=[SOBOL, TEETH], samples=64)
    values = [design.values(k) for k in range(design.combinations)]
    torque = np.array([v["pair.torque_nm"] for v in values])
    # One point in every 64th of the range: what makes a Sobol sequence one, scrambled or not.
    assert sorted(((torque - 5.0) / 20.0 * 64).astype(int)) == list(range(64))
    teeth = [v["driven.teeth"] for v in values]
    assert all(isinstance(t, int) for t in teeth)
    assert [teeth.count(t) for t in (20, 21, 22, 23)] == [16, 16, 16, 16]


def test_sensitivity_blocks_swap_one_factor_each() -> None:
    design = _design(sweep=[SOBOL, TEETH], samples=8, sensitivity=True)
    assert design.blocks == 5
    for point in range(8):
        A, B, first, second, chance = (design.values(5 * point + k) for k in range(5))
        assert first == {"pair.torque_nm": B["pair.torque_nm"], "driven.teeth": A["driven.teeth"]}
        assert second == {"pair.torque_nm": A["pair.torque_nm"], "driven.teeth": B["driven.teeth"]}
        assert chance == A
        seeds = [design.seed(5 * point + k) for k in range(5)]
        assert seeds[0] == seeds[2] == seeds[3] != seeds[1] == seeds[4]


@pytest.mark.parametrize("rows", [1, 3, 399, 400, 401, 5000, 200_000])
def test_chunks_cover_every_missing_row_once(rows: int) -> None:
    plan = StudyPlan("{}")
    done = [(0, 2), (5, 6), (300, 420)]
    cuts = [7, 100, 350, 100_000]
    seen = list(plan.chunks(rows=rows, done=done, cuts=cuts))
    covered = np.zeros(rows, dtype=int)
    for start, stop in seen:
        covered[start:stop] += 1
        assert 0 < stop - start <= size_at(start)
        assert not any(start < cut < stop for cut in cuts)
    for start, stop in done:
        covered[start:stop] += 1
    assert np.all(covered == 1)


def test_every_key_of_a_pair_file_can_be_swept() -> None:
    assert {"driving.tip_relief.amount_um", "pair.torque_nm", "driven.limits.E_sns_um"} <= known_keys().keys()
    assert {"driving.eccentricity.angle_deg", "driven.inspection.pitch_um", "model.compliance"} <= known_keys().keys()
    assert is_whole("driving.grade")
    assert is_whole("driven.teeth")
    assert not is_whole("pair.torque_nm")
    raw = {"driving": {"teeth": 11}}
    changed = with_values(raw, {"driving.tip_relief.amount_um": 5.0, "driving.teeth": 12})
    assert changed == {"driving": {"teeth": 12, "tip_relief": {"amount_um": 5.0}}}
    assert raw == {"driving": {"teeth": 11}}


def test_questions_do_not_change_what_is_computed(tmp_path: Path) -> None:
    asked = '\n[[limit]]\noutput = "te_pp_um"\nat_most = 9.0\n'
    one = plan_of(read_study(write_study(tmp_path, GRADES)))
    two = plan_of(read_study(write_study(tmp_path, GRADES.replace('grade"\n', 'class"\n', 1) + asked, pairs=9)))
    assert one.what == two.what
    assert one.text != two.text
    three = plan_of(read_study(write_study(tmp_path, GRADES.replace("[5, 6, 7]", "[5, 6, 8]"))))
    assert one.what != three.what
