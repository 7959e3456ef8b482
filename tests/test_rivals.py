"""What a rival costs, and which doubts count, when probabilities of one place are shared."""

from __future__ import annotations

import math
from typing import Any

import pytest

from gearpoly.diagnose.contest import Refitted
from gearpoly.diagnose.earned import _doubted
from gearpoly.diagnose.judge import Judged, _behind
from gearpoly.infer.posterior import Posterior
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place

SPALL = (30.0, 47.2, 48.8, 0.01)
CHIP = (1.0, 1.6)


def claim(name: str, values: tuple[float, ...], **place: Any) -> Claim:
    return Claim(physics=catalogue()[name], place=Place(gear=1, tooth=18, **place), values=values)


def test_a_freedom_costs_what_it_might_have_told() -> None:
    """Schwarz (1978): half the log of the data for each; a refit has counted one (Akaike) for each already."""
    spall, chip = claim("tooth_spall", SPALL), claim("tooth_chip", CHIP)
    gain = 14035.5
    two = 2.0 * (math.log(gain) - 2.0)
    assert _behind(chip, Refitted(claim=spall, behind=1.23), gain) == pytest.approx(1.23 + two)
    # The other way round the simpler one is ahead, though it fits a little worse.
    assert _behind(spall, Refitted(claim=chip, behind=1.23), gain) == pytest.approx(1.23 - two)
    assert _behind(spall, Refitted(claim=spall, behind=3.0), gain) == 3.0
    # Data that hardly tell one freedom from none cannot tell two from one.
    assert _behind(chip, Refitted(claim=spall, behind=0.5), 4.0) == 0.5


@pytest.mark.parametrize(("name", "values", "unknown"), [("tooth_crack", (0.6,), 0.9), ("tooth_spall", SPALL, 0.1)])
def test_a_flank_that_fits_worse_speaks_for_no_crack(name: str, values: tuple[float, ...], unknown: float) -> None:
    """Whatever its shape, a flank does the same under every torque: that none fits says nothing for a crack where what
    is free under every torque was likelier. Of a pit the flank fitted to its end says more than columns."""
    one = claim(name, values)
    judged = Judged(gain=100.0, posterior=Posterior(claims=((one, 0.1),), unknown=0.9, nothing=0.0))
    told = _doubted(one, judged, 0.1).posterior
    assert told.unknown == pytest.approx(unknown)
    assert told.of(one) + told.unknown == pytest.approx(1.0)
    assert _doubted(one, judged, None) is judged
