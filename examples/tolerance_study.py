"""Which of two grades keeps a limit of transmission error: a small study, its table and its answer."""

from __future__ import annotations

import tempfile
from pathlib import Path

import gearpoly

STUDY = f"""
name = "which grade keeps 25 um"
pair = "{(gearpoly.samples() / "pairs" / "graded_18_25.toml").as_posix()}"
pairs = 40
positions_per_mesh = 10
turns = 1.0
outputs = ["te_pp_um"]
[set]
"pair.torque_nm" = 0.0
"driving.points_per_flank" = 150
"driven.points_per_flank" = 150
[[sweep]]
name = "grade"
keys = ["driving.grade", "driven.grade"]
method = "list"
values = [4, 6]
[[limit]]
output = "te_pp_um"
at_most = 25.0
share = 0.9
"""

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "study.toml"
    file.write_text(STUDY, encoding="utf-8")
    made = gearpoly.run_study(file, Path(folder) / "out")
    fine, coarse = (one.value for one in made.answers.yields[0].shares)
    pairs = made.pairs
    made.plot("tolerance_study.png")
print(f"{pairs} pairs: {100 * fine:.0f} % of grade 4 keep 25 um, {100 * coarse:.0f} % of grade 6")
assert pairs == 80
assert fine > 0.9 > coarse
