"""Every tooth its own beam, loads that are refused, and what a pair file says of load."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import assemble
from gearpoly.errors import GeometryError, OutOfRangeError
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.deviations import Deviations, pitch_and_thickness, tip_relief
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.compliance import law_names
from gearpoly.mesh.compliance.contact import CONTACT_LAWS
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.deflection import Elasticity, pair_compliance
from gearpoly.mesh.loaded import SMALL, loaded
from gearpoly.mesh.pair import GearPair, mount
from gearpoly.simulate import Simulation, simulate, strength_remarks
from gearpoly.units import NM, UM, read_only
from tests.made_command import Command
from tests.made_loaded import (
    BALANCE,
    PALMGREN,
    levers,
    make,
    near_contacts,
    one_pitch,
    per_position,
    perfect,
    under,
    wrong,
)


def thin_tooth(b: float, E_s: float) -> GearPair:
    thickness = np.zeros(18)
    thickness[5] = E_s
    deviations = pitch_and_thickness(Gear(z=18, m=2.0), index=read_only(np.zeros(18)), E_s=read_only(thickness))
    return make(b=b, deviations=(deviations, None), points=200)


@pytest.mark.parametrize("law", [name for name in law_names() if name != "iso6336"])
def test_a_thin_tooth_is_softer(law: str) -> None:
    c = pair_compliance(thin_tooth(20.0, -100.0 * UM), Elasticity(law=law)).driving.c
    others = np.delete(c, 5, axis=0)
    # Teeth alike are alike to rounding.
    np.testing.assert_allclose(others, np.broadcast_to(others[0], others.shape), rtol=1e-12)
    assert np.all(c[5] > others[0])
    # Bending goes with 1/h^3: 3 % off the thickness is up to 10 % at the tip.
    assert 1.03 < c[5, -1] / others[0, -1] < 1.12


def test_a_thin_tooth_is_softer_at_any_width() -> None:
    # H_p is 3.138 mm, so 15.65 mm is 4.99 of it: the thin tooth alone counts as wide, 9 % stiffer.
    c = pair_compliance(thin_tooth(15.65, -20.0 * UM), PALMGREN).driving.c
    assert np.all(c[5] > c[0])


def test_coast_flanks_have_tables_of_their_own() -> None:
    relief = Deviations(drive=(tip_relief(Gear(z=18, m=2.0), amount=50.0 * UM, length=1.0, shape="linear"),))
    pair = make(deviations=(relief, None), points=200)
    drive, coast = (pair_compliance(pair, PALMGREN, flank=flank) for flank in ("drive", "coast"))
    assert np.max(np.abs(drive.driving.c - coast.driving.c)) > 0.0
    np.testing.assert_allclose(drive.driven.c, coast.driven.c, rtol=1e-12)


@pytest.mark.parametrize("law", law_names())
@pytest.mark.parametrize("contact", sorted(CONTACT_LAWS))
def test_every_law_runs_and_balances(law: str, contact: str) -> None:
    pair = wrong()
    result = under(pair, 25.0, Elasticity(law=law, contact=contact))
    _, lever_2 = levers(pair, result.contacts)
    np.testing.assert_allclose(per_position(result, result.force * lever_2), 25.0 * NM, rtol=BALANCE)
    per_width = float(np.mean(result.stiffness)) * UM / 20.0
    # ISO 6336-1 gives a mesh of 18/25 (0.75 eps + 0.25) 14.7 = 21 N/(mm um); the laws stand within a quarter of that,
    # and error gears share less.
    assert 12.0 < per_width < 27.0


def test_deflections_that_are_not_small_are_refused() -> None:
    pair = perfect()
    compliance = pair_compliance(pair, PALMGREN)
    with pytest.raises(OutOfRangeError, match="small deflections no longer hold"):
        loaded(near_contacts(pair), compliance, torque=2000.0 * NM)
    # Within the bound it runs, and close to it.
    high = loaded(near_contacts(pair), compliance, torque=600.0 * NM)
    assert 0.7 * SMALL * 2.0 < np.max(high.approach) < SMALL * 2.0


@pytest.mark.parametrize("torque", [-1.0, float("nan")])
def test_a_torque_that_is_none_is_refused(torque: float) -> None:
    with pytest.raises(OutOfRangeError, match="0 or more"):
        loaded(near_contacts(perfect()), pair_compliance(perfect(), PALMGREN), torque=torque)


def test_teeth_without_a_width_do_not_bend() -> None:
    gears = [Gear(z=18, m=2.0), Gear(z=25, m=2.0)]
    with pytest.raises(GeometryError, match=r"driving\.face_width_mm is missing"):
        pair_compliance(mount(*(draw_flanks(gear, points=50) for gear in gears)), PALMGREN)


PAIR = """\
[pair]
torque_nm = {torque}
{model}
[driving]
teeth = 18
module_mm = 2.0
points_per_flank = 150
{width}
[driven]
teeth = 25
module_mm = 2.0
points_per_flank = 150
{width}
"""


def pair_file(folder: Path, *, torque: float = 25.0, model: str = "", width: str = "face_width_mm = 20.0") -> Path:
    path = folder / "pair.toml"
    path.write_text(PAIR.format(torque=torque, model=f"[model]\n{model}\n" if model else "", width=width))
    return path


def run(path: Path, *, torque_nm: float) -> Simulation:
    assembled = assemble(read_pair(path), path=path, seed=0)
    return simulate(
        assembled,
        one_pitch(assembled.pair, 40),
        Condition(flank="drive", torque=torque_nm * NM),
        seed=0,
        evenly=False,
        progress=lambda done: None,
    )


def test_rigid_teeth_stay_rigid(tmp_path: Path) -> None:
    rigid = run(pair_file(tmp_path, model="tooth_deflection = false"), torque_nm=120.0)
    assert rigid.load is None
    np.testing.assert_array_equal(rigid.te, rigid.contacts.te)
    # Rigid teeth need no width either.
    narrow = run(pair_file(tmp_path, model="tooth_deflection = false", width=""), torque_nm=120.0)
    np.testing.assert_array_equal(narrow.te, rigid.te)
    bent = run(pair_file(tmp_path), torque_nm=120.0)
    assert np.all(bent.te < rigid.te)


@pytest.mark.long
def test_the_file_chooses_laws_and_material(tmp_path: Path) -> None:
    plain = run(pair_file(tmp_path, model='contact = "linear"'), torque_nm=50.0)
    soft = run(pair_file(tmp_path, model='contact = "linear"\n[material]\nyoungs_modulus_gpa = 103.0'), torque_nm=25.0)
    assert plain.load is not None
    assert soft.load is not None
    # Half the modulus under half the torque is the same shape; rounding.
    np.testing.assert_allclose(soft.load.approach, plain.load.approach, rtol=1e-9)
    means = {}
    for law in law_names():
        found = run(pair_file(tmp_path, model=f'compliance = "{law}"'), torque_nm=25.0).load
        assert found is not None
        means[law] = float(np.mean(found.approach))
    assert len(set(means.values())) == len(means)


def test_yield_is_remarked_with_its_stress(tmp_path: Path) -> None:
    path = pair_file(tmp_path)
    assert strength_remarks(run(path, torque_nm=25.0)) == []
    (remark,) = strength_remarks(run(path, torque_nm=500.0))
    assert "would yield" in remark
    # Lewis's own section is that with the greatest h/s^2. The remark takes the whole height and the least thickness,
    # which do not belong to one section, and stays above it by up to a quarter.
    flanks = assemble(read_pair(path), path=path, seed=0).pair.driving.flanks
    half = flanks.psi_drive[0]
    height, thickness = flanks.gear.r_a - flanks.r * np.cos(half), 2.0 * flanks.r * np.sin(half)
    stress = 6.0 * (500.0 * NM / 23.4923) / 20.0 * float(np.max(height / thickness**2))
    assert 1.0 < float(remark.split(" is ")[1].split(" MPa")[0]) / stress < 1.3


@pytest.mark.parametrize(
    ("torque", "width", "says"),
    [
        (-5.0, "face_width_mm = 20.0", "torque_nm"),
        (25.0, "face_width_mm = 0.0", "face_width_mm"),
        (25.0, "", "face_width_mm"),
        (1e6, "face_width_mm = 20.0", "small deflections"),
    ],
)
def test_bad_loads_exit_2_and_leave_nothing(
    gearpoly_command: Command, tmp_path: Path, torque: float, width: str, says: str
) -> None:
    out = tmp_path / "out.csv"
    path = pair_file(tmp_path, torque=torque, width=width)
    done = gearpoly_command("simulate", path, "--turns", "0.04", "--points-per-mesh", "4", "--csv", out)
    assert done.code == 2
    assert says in done.err
    assert "Traceback" not in done.err
    assert not out.exists()
