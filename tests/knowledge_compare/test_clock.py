"""A shaft whose angle was made from time: guide pulses turn it by a part of what they say, its motor at its rate."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.knowledge_compare.made import TURN, Told, pair, standing, teeth, told

pytestmark = pytest.mark.slow

Z = 12, 47
PERIOD = 478.7
"""s per turn of the worm, by the sidereal rate."""
R_B2 = 0.5 * 47 * 0.5 * math.cos(math.radians(20.0))


def log(
    *, share: float = 0.0, rate: float = 1.0, turns: float = 10.0, lines: tuple[tuple[float, float], ...],
    pulses_turns: float = 0.03, per_turn: float = 180.0, noise: float = 0.6, seed: int = 4,
) -> Recording:  # fmt: skip
    """A guided mount: ``lines`` of (order of the worm, um) stand at the angle that was truly turned."""
    rng = np.random.default_rng(seed)
    n = round(turns * per_turn)
    time = (np.arange(n) + rng.uniform(-0.2, 0.2, n)) * PERIOD / per_turn
    angle = time / PERIOD
    walk = np.cumsum(rng.normal(size=n))
    pulses = pulses_turns * walk / np.max(np.abs(walk))
    true = rate * angle + share * pulses
    te: FloatArray = np.asarray(sum(um * np.cos(TURN * order * true + 0.7 * order) for order, um in lines))
    te = te + noise * rng.normal(size=n)
    return Recording(
        source=Path("log.csv"), time_s=time, driven_angle_rad=TURN * angle, te_mm=te * UM,
        driven_correction_rad=TURN * pulses, from_time=("driven",),
    )  # fmt: skip


def seen(recording: Recording) -> Told:
    return told(pair(Z, module_mm=0.5, uncertainty_um=0.2), recording)


OWN = ((1.0, 8.0), (47.0 / 12.0, 6.0), (47.0, 3.0))
"""Lines of the worm, of the driving gear, and of the mesh."""


def whole_lines(found: Told) -> dict[str, float]:
    """Amplitudes in um of the pair's own three lines."""
    out = {}
    for e in standing(found):
        if e["kind"] == "mesh_order" and e["order"] == 1:
            out["mesh"] = e["amplitude_um"]
        elif e["kind"] == "shaft_order" and e["order"] == 1:
            out[e["gear"]] = e["amplitude_um"]
    return out


@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_pulses_turned_the_shaft_by_what_makes_its_lines_sharp(share: float) -> None:
    """A lag in the guider, backlash and declination leave between nothing and all of a pulse: at a wrong share the mesh
    line smears over a turn and a half of phase."""
    found = whole_lines(seen(log(share=share, lines=OWN)))
    assert found.keys() == {"driving", "driven", "mesh"}
    assert found["mesh"] == pytest.approx(3.0, rel=0.1)
    assert found["driving"] == pytest.approx(6.0, rel=0.1)


def test_a_motor_at_the_solar_rate_still_shows_whole_orders() -> None:
    """0.27 % slow: the mesh line lies a line and more beside its order, and is the mesh all the same."""
    found = whole_lines(seen(log(rate=1.0 - 2.7e-3, turns=14.0, pulses_turns=0.001, lines=OWN)))
    assert found.keys() == {"driving", "driven", "mesh"}
    assert found["mesh"] == pytest.approx(3.0, rel=0.1)


def test_another_mount_shows_no_line_of_this_pair() -> None:
    """A worm turned by 10 on 63 teeth: lines at 6.3 and 63, of which none is this pair's."""
    found = seen(log(lines=((1.0, 8.0), (6.3, 6.0), (63.0, 3.0))))
    names = whole_lines(found)
    assert "mesh" not in names
    assert "driving" not in names
    assert teeth(found) == []
