"""Orders of one shaft that are the sharp shape of one tooth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.compare.comb import of_one_tooth, told_so
from gearpoly.compare.entries import Entry
from gearpoly.units import FloatArray

Z = (19, 47)
ZEROS = (140.0, 20.0)


def encoder_deg(gear: int, tooth: int) -> float:
    return (ZEROS[gear] + 360.0 * tooth / Z[gear]) % 360.0


def line(order: int, wave: complex, *, gear: str = "driving") -> Entry:
    """The order of a spectrum's line a - ib, which is a cos + b sin."""
    return Entry(
        kind="shaft_order", gear=gear, order=float(order), amplitude_um=abs(wave), std_um=0.004,
        phase_deg=-math.degrees(np.angle(wave)), recordings=(0,), p_value=1e-9, gain=abs(wave) ** 2 * 1e4,
    )  # fmt: skip


def edges(tooth: int, *, z: int = Z[0]) -> FloatArray:
    """A pit with sharp walls, 0.3 of a pitch wide, of one tooth in every turn."""
    turn = np.arange(8192) / 8192 - tooth / z
    away = (turn + 0.5) % 1.0 - 0.5
    return np.where(np.abs(away) < 0.15 / z, -4.0, 0.0)


def some(low: int, high: int, count: int) -> list[int]:
    """Orders of which nothing is left here and there. Every third one would look the same at three teeth."""
    return sorted(np.random.default_rng(1).choice(np.arange(low, high), count, replace=False).tolist())


def lines_of(curve: FloatArray, orders: list[int], gear: str = "driving") -> list[Entry]:
    spectrum = 2.0 * np.fft.rfft(curve) / curve.size
    return [line(k, complex(spectrum[k]), gear=gear) for k in orders]


@pytest.mark.parametrize("tooth", [0, 7, 18])
@pytest.mark.parametrize("numbered", [True, False])
def test_some_orders_of_a_pit_are_its_tooth(tooth: int, numbered: bool) -> None:
    """Of teeth that had taken up all slow orders; the first and the last tooth are beside each other."""
    lines = lines_of(edges(tooth), some(40, 130, 30))
    first, *rest = of_one_tooth(lines, z=Z, numbered=(numbered, True), encoder_deg=encoder_deg)
    assert (first.kind, first.gear, first.tooth) == ("tooth", "driving", tooth if numbered else None)
    assert first.encoder_deg == pytest.approx((140.0 + 360.0 * tooth / 19) % 360.0)
    name = f"driving tooth {tooth}" if numbered else "a tooth of the driving gear"
    assert [one.companion_of for one in rest] == [name] * len(lines)
    # Rms over its pitch: all power of the lines, as far as it is there, in 1/19 of the turn.
    whole = math.sqrt(0.5 * sum((one.amplitude_um or 0.0) ** 2 for one in lines) * 19)
    assert first.rms_um is not None
    assert 0.5 * whole < first.rms_um < whole


def test_waves_of_any_phases_stay_what_they_are() -> None:
    """Of 100 sets of 30 waves one in a thousand each may be taken for a tooth."""
    rng = np.random.default_rng(4)
    orders = some(40, 130, 30)
    for _ in range(20):
        lines = [line(k, complex(0.1 * np.exp(2j * np.pi * rng.random()))) for k in orders]
        assert of_one_tooth(lines, z=Z, numbered=(True, True), encoder_deg=encoder_deg) == lines


def test_few_orders_and_those_of_company_or_of_other_parts_are_no_comb() -> None:
    lines = lines_of(edges(7), some(40, 60, 7))
    assert len(lines) < 8
    assert of_one_tooth(lines, z=Z, numbered=(True, True), encoder_deg=encoder_deg) == lines


def test_orders_join_the_tooth_that_is_told_already() -> None:
    """No second entry, on the other gear; ``where`` has them in its company too."""
    told = Entry(kind="tooth", gear="driven", tooth=5, encoder_deg=encoder_deg(1, 5), amplitude_um=-3.0, p_value=1e-9,
                 recordings=(0,), gain=5.0)  # fmt: skip
    lines = lines_of(edges(5, z=47), some(60, 200, 47), gear="driven")
    out = of_one_tooth([*lines, told], z=Z, numbered=(True, True), encoder_deg=encoder_deg)
    assert [one for one in out if one.kind == "tooth"] == [told]
    assert {one.companion_of for one in out if one.kind != "tooth"} == {"driven tooth 5"}
    where = told_so([lines[3]], out)
    assert [one.companion_of for one in where] == ["driven tooth 5", None]
    assert where[1] == told


def test_slow_orders_of_a_gear_of_many_teeth_are_of_no_tooth() -> None:
    """The joint of a tape on a drum: orders 1 to 8 of a sawtooth. None is narrower than eight of 80 teeth; as many
    places as teeth had no room for half a pitch, and a diagnosis ended with a traceback."""
    lines = [line(k, 1j * 7.0 / k) for k in range(1, 9)]
    assert of_one_tooth(lines, z=(80, 47), numbered=(True, True), encoder_deg=encoder_deg) == lines
