"""Small studies that tests write: an 11/13 pair of few points, whose rows take milliseconds."""

from __future__ import annotations

from pathlib import Path

PAIR = """
name = "small pair"

[driving]
teeth = 11
module_mm = 2.0
face_width_mm = 10.0
profile_shift = 0.3
grade = 6
points_per_flank = 60

[driven]
teeth = 13
module_mm = 2.0
face_width_mm = 10.0
profile_shift = 0.2
grade = 6
points_per_flank = 60
"""


def write_study(folder: Path, text: str = "", *, pair: str = PAIR, pairs: int = 6, name: str = "study.toml") -> Path:
    """A study file and its pair file in ``folder``; ``text`` goes below the top keys."""
    (folder / "pair.toml").write_text(pair, encoding="utf-8")
    head = f'name = "small study"\npair = "pair.toml"\npairs = {pairs}\nseed = 7\npositions_per_mesh = 5\n'
    path = folder / name
    path.write_text(head + text, encoding="utf-8")
    return path


THICKNESS = """
outputs = ["te_pp_um", "backlash_least_um", "load_share_peak"]
[[sweep]]
name = "E_sns"
keys = ["driven.limits.E_sns_um", "driven.limits.E_sni_um", "driven.limits.W_kns_um", "driven.limits.W_kni_um"]
method = "list"
values = [[-60, -130, -56, -122], [-60, -90, -10, -20], [-70, -90, -10, -20], [190, 120, 180, 110]]
"""
"""Thicknesses of the driven gear: sound; twice limits of E_s and W_k that no gear keeps, refused at once; so thick that
the gears jam."""

GRADES = """
[[sweep]]
name = "grade"
keys = ["driving.grade", "driven.grade"]
method = "list"
values = [5, 6, 7]
"""
