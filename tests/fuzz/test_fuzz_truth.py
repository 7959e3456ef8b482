"""Truth files of any shape: a truth that can be scored, or one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearpoly.prove.score import score
from gearpoly.prove.thresholds import read_thresholds
from gearpoly.prove.truth import read_truth
from tests.fuzz.judge import FUZZ, judged
from tests.fuzz.mutate import damaged, trees
from tests.made_pairfile import SMALLEST

ORIGINALS = [
    {"kind": "none", "truth": [], "noise_um": 0.3},
    {
        "kind": "missing", "noise_um": 0.3, "noise_colour": 0.2, "declared_eccentricity_um": [0.0, 12.0],
        "depth": {"over_limit": 9.0}, "hunting_cycles": 1.5, "class": "one", "pair": "18/25",
        "truth": [{
            "physics": "tooth_pitch", "gear": "driven", "tooth": 3, "teeth": 25, "encoder_deg": 12.0,
            "deviation_um": 4.0, "over_limit": 9.0,
            "rivals": [{"physics": "tooth_spall", "gear": "driven", "separability": 0.4, "apart_um": 0.6}],
        }],
        "background": [{"shape": "line", "order": 2.0, "gear": 1}, {"hz": 50.0, "images_hz": [50]}],
    },
]  # fmt: skip
VERDICT = {
    "status": "partly_explained",
    "missing": [{
        "physics": "tooth_pitch", "gear": "driven", "tooth": 3, "encoder_deg": 12.0, "indistinguishable_from": [],
        "parameters": {"deviation_um": {"value": 4.1, "std": 0.1}},
    }],
    "unexplained": [{"kind": "time", "hz": 50.0, "amplitude_um": 0.2, "std_um": 0.02}],
    "where": [], "fit": {"heldout_rms_um": {"before": 2.0, "after": 0.3}},
}  # fmt: skip


@pytest.mark.long
@FUZZ
@given(data=st.data())
def test_a_truth_file_gives_a_score_or_one_line(folder: Path, data: st.DataObject) -> None:
    pair, file = folder / "pair.toml", folder / "case.truth.json"
    pair.write_text(SMALLEST)
    file.write_bytes(data.draw(damaged(json.dumps(data.draw(trees(ORIGINALS))).encode())))
    truth = judged("truth files", lambda: read_truth(file, pair=pair))
    if truth is not None:
        score("case", VERDICT, truth, read_thresholds())
