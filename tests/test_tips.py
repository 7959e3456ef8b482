"""A centre distance that tips within their tolerance would show as well is no finding."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from gearpoly.diagnose.tips import as_tips, it11
from gearpoly.diagnose.unearned import Unearned
from gearpoly.files.models import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from tests.pair_files import pair_file
from tests.physics_cases import scope_of


def with_keys(file: PairFile, **keys: object) -> PairFile:
    """The same with these keys of both gears."""
    both = {name: getattr(file, name).model_copy(update=keys) for name in ("driving", "driven")}
    return file.model_copy(update=both)


@pytest.mark.parametrize(("low", "high", "um"), [(10, 18, 110), (18, 30, 130), (30, 50, 160), (50, 80, 190)])
def test_tolerances_of_grade_11_are_those_of_the_table(low: float, high: float, um: float) -> None:
    """ISO 286-1, table 1, rounded there to 10 um; each range has the factor of its geometric mean."""
    assert it11(math.sqrt(low * high)) * 1e3 == pytest.approx(um, abs=5.0)


def test_only_small_offsets_on_one_flank_of_gears_of_no_stated_grade_are_as_tips() -> None:
    """18 and 25 teeth of module 2: tips of 40 and 54 mm stand off by half of 160 and of 190 um."""
    file = with_keys(pair_file((18, 25)), inspection=None)
    model: Any = SimpleNamespace(declared=file, scope=scope_of(file), as_built=SimpleNamespace(flanks=("drive",)))

    def off(um: float, name: str = "centre_distance") -> Unearned:
        return Unearned(claim=Claim(physics=catalogue()[name], place=Place(), values=(um,)), rms=0.0, posterior=None)

    assert as_tips(model, off(-11.0)) and as_tips(model, off(160.0))
    assert not as_tips(model, off(190.0)) and not as_tips(model, off(11.0, "misalignment"))
    model.as_built.flanks = ("drive", "coast")
    assert not as_tips(model, off(-11.0))
    model.as_built.flanks, model.declared = ("drive",), with_keys(file, grade=7)
    assert not as_tips(model, off(-11.0))
