"""Tooth compliance against closed forms, scaling, symmetry and a finite-element tooth.

The finite-element tooth (tests/oracles/fem_tooth.py) is plane strain, m = 2, 18 and 25 teeth, a
closed ring clamped 5 modules below the root, less the ring's own twist. Found there, in per cent
over FEM at tip / pitch point / lowest contact (docs/explanation/compliance.md has the whole table and other
boundaries):

=====================  ===================  ===================
law                    18 teeth             25 teeth
=====================  ===================  ===================
cantilever             +4.6 / +7.4 / +1.4   +6.6 / +11.2 / +7.2
cantilever_published   +7.4 / +7.3 / -1.9   +9.1 / +10.7 / +4.5
weber_banaschek        -2.1 / -0.3 / +3.1   +0.1 / +1.6 / +3.0
potential_energy       +16 / +24 / +21      +26 / +48 / +61
=====================  ===================  ===================

The last is a tooth in plane stress on a ring that twists: it has a test against its own kind.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import GearpolyError, GeometryError, OutOfRangeError
from gearpoly.mesh.compliance import (
    Blank,
    ComplianceLaw,
    ToothSection,
    cantilever,
    find_law,
    law_names,
    load_points,
    potential_energy,
    tooth_compliance,
    tooth_section,
)
from gearpoly.mesh.compliance.beam import ELEMENTS, beam_integrals
from tests.oracles.fem_tooth import FemTooth, RackTooth, lowest_contact, rack_tooth

E, NU, B = 206000.0, 0.3, 20.0
STEEL = {"face_width": B, "youngs_modulus": E, "poisson_ratio": NU}
BEAM_LAWS = ("cantilever", "cantilever_published", "weber_banaschek", "potential_energy")


def section_of(tooth: RackTooth, **changes: object) -> ToothSection:
    known: dict[str, Any] = {
        "radius": tooth.radius,
        "drive": tooth.psi,
        "coast": -tooth.psi,
        "base_radius": tooth.r_b,
        "reference_radius": tooth.r,
        "bore_radius": 5.0 * tooth.m,
        "teeth": tooth.z,
    }
    return tooth_section(**(known | changes))


def flank(tooth: RackTooth, k: int = 30) -> np.ndarray:
    """Radii from lowest contact (against the other gear of 18/25) to the tip."""
    return np.linspace(lowest_contact(tooth, rack_tooth(43 - tooth.z, tooth.m)), tooth.r_a, k)


# A rectangular tooth: a uniform beam -------------------------------------------------------------


def bar(*, base_radius: float, height: float = 6.0, thickness: float = 4.0) -> ToothSection:
    """A bar from x = 20 mm up; the base circle decides how a load on its side is inclined."""
    # A vertex every 0.1 mm, so that a load at a whole millimetre sits on one.
    x = np.linspace(20.0, 20.0 + height, 61)
    psi = np.arctan2(0.5 * thickness, x)
    return tooth_section(
        radius=np.hypot(x, 0.5 * thickness),
        drive=psi,
        coast=-psi,
        base_radius=base_radius,
        reference_radius=22.0,
    )


def parts(section: ToothSection, x_load: float, b: float) -> dict[str, float]:
    """The bar as the law sees it: L to the load, its Y and beta, and both forms' beam part."""
    radius = math.hypot(x_load, 0.5 * float(section.h[0, 0]))
    load, blank = load_points(section, [radius], "drive"), Blank(b=b, E=E, nu=NU)
    rim = cantilever.foundation(
        arm=load.u - section.x_e[:, None],
        h=section.h_e[:, None],
        beta=load.beta,
        wide=cantilever.is_wide(section, blank),
        blank=blank,
    )
    found = {
        "L": float(load.x[0, 0] - section.x_e[0]),
        "Y": float(load.y[0, 0]),
        "beta": float(load.beta[0, 0]),
    }
    forms: tuple[cantilever.Form, ...] = ("symmetric", "published")
    for form in forms:
        whole = cantilever.compliance(section, load, blank, form=form)
        found[form] = float((whole - rim)[0, 0])
    return found


@pytest.mark.parametrize(("b", "strain"), [(10.0, 1.0), (100.0, 1.0 - NU**2)], ids=["narrow", "wide"])
def test_uniform_beam_under_a_transverse_load(b: float, strain: float) -> None:
    # base radius = height of the load: its tangent is transverse, beta = 0
    h, x_load = 4.0, 25.0
    found = parts(bar(base_radius=x_load), x_load, b)
    L, area, inertia = found["L"], b * h, b * h**3 / 12.0
    assert found["beta"] == pytest.approx(0.0, abs=1e-12)  # rounding of arccos and arctan
    bending, shear = strain * L**3 / (3.0 * E * inertia), 12.0 * (1.0 + NU) / 5.0 * L / (E * area)
    # Gauss quadrature is exact for this polynomial: 1e-10 is rounding over 300 points.
    assert found["symmetric"] == pytest.approx(bending + shear, rel=1e-10)
    # The published form has the bending right and divides the shear by E/(1-nu^2) where wide.
    assert found["published"] == pytest.approx(bending + strain * shear, rel=1e-10)


def test_uniform_beam_under_an_inclined_load_and_the_published_coupling() -> None:
    h, x_load, b = 4.0, 25.0, 10.0
    found = parts(bar(base_radius=22.5), x_load, b)
    L, Y, beta = found["L"], found["Y"], found["beta"]
    assert beta > 0.2  # else this tests nothing
    area, inertia = b * h, b * h**3 / 12.0
    V, N = math.cos(beta), math.sin(beta)
    # Deflections at the end of a cantilever under end force V, end moment -N Y and thrust N, worked
    # along the load.
    bending = V * (V * L**3 / 3.0 - N * Y * L**2 / 2.0) - N * Y * (V * L**2 / 2.0 - N * Y * L)
    rest = V**2 * 2.4 * (1.0 + NU) * L / (E * area) + N**2 * L / (E * area)
    assert found["symmetric"] == pytest.approx(bending / (E * inertia) + rest, rel=1e-10)
    # What is missing in print: half of the coupling (added back) and the tilt of the load's own
    # arm.
    missing = -V * N * Y * L**2 / 2.0 + N**2 * Y**2 * L
    assert found["symmetric"] - found["published"] == pytest.approx(missing / (E * inertia), rel=1e-9)


def test_energy_form_is_reciprocal_and_the_published_one_is_not() -> None:
    """A load may be moved along its own line: measured from there, the bending is the same."""
    tooth = rack_tooth(18, 2.0)
    section = section_of(tooth)
    load = load_points(section, [19.5], "drive")
    at_flank = beam_integrals(section, start=section.x_e, stop=load.x)
    t = np.tan(load.beta) * load.y
    energy = at_flank.I_2 - 2.0 * t * at_flank.I_1 + t**2 * at_flank.I_0
    # The same moment (u - x), integrated by brute force over the beam up to the flank point.
    x = np.linspace(float(section.x_e[0]), float(load.x[0, 0]), 20001)
    h = np.interp(x, section.x[0], section.h[0])
    brute = np.trapezoid(12.0 * (float(load.u[0, 0]) - x) ** 2 / h**3, x)
    assert float(energy[0, 0]) == pytest.approx(float(brute), rel=1e-5)  # trapezoid error at 20001 points is 1e-6
    published = at_flank.I_2 - t * at_flank.I_1
    assert float(published[0, 0]) > 1.05 * float(energy[0, 0])  # print overstates tip bending


# Finite elements ---------------------------------------------------------------------------------

DEPTH = 5.0  # far boundary, modules below the root
ACROSS = 6  # elements across a tooth: 0.8 % from the limit, a twentieth of the 15 % that is asked of a law


@cache
def ring(z: int) -> tuple[np.ndarray, np.ndarray]:
    """Load radii (tip, pitch point, lowest contact) and FEM compliance times E b, 18/25 pair."""
    tooth = rack_tooth(z, 2.0)
    model = FemTooth(tooth, r_inner=tooth.r_f - DEPTH * tooth.m, n=ACROSS)
    loads = [model.load(r) for r in (tooth.r_a, tooth.r, lowest_contact(tooth, rack_tooth(43 - z, 2.0)))]
    return np.array([load.radius for load in loads]), np.array([load.compliance for load in loads])


@pytest.mark.long
@pytest.mark.parametrize("z", [18, 25])
@pytest.mark.parametrize("law", ["cantilever", "cantilever_published", "weber_banaschek"])
def test_against_finite_elements(z: int, law: str) -> None:
    radius, fem = ring(z)
    q = tooth_compliance(section_of(rack_tooth(z, 2.0)), radius=radius, law=law, **STEEL) * B * E
    # 15 % is the accuracy asked; beam theory on a tooth as thick as it is high cannot promise more.
    np.testing.assert_allclose(q, fem, rtol=0.15)


def test_finite_elements_see_a_missing_foundation() -> None:
    """Planted fault: the same law on a rigid rim must leave the band, or the band says nothing."""
    radius, fem = ring(18)
    section, blank = section_of(rack_tooth(18, 2.0)), Blank(b=B, E=E, nu=NU)
    load = load_points(section, radius, "drive")
    rim = cantilever.foundation(
        arm=load.u - section.x_e[:, None],
        h=section.h_e[:, None],
        beta=load.beta,
        wide=np.array([[True]]),
        blank=blank,
    )
    rigid = (cantilever.compliance(section, load, blank) - rim)[0] * B * E
    # The rim is a third of the compliance at the tip and more below: twice the band at least.
    assert (rigid < 0.7 * fem).all()


@pytest.mark.long
def test_finite_element_mesh_is_converged() -> None:
    tooth = rack_tooth(18, 2.0)
    radii = (tooth.r_a, tooth.r, 17.0)
    # A sector has the same tooth, fillet and rim blocks and is cheap to refine.
    coarse, middle, fine = (
        np.array([FemTooth(tooth, r_inner=5.5, n=n, neighbours=1).load(r).compliance for r in radii])
        for n in (ACROSS, 8, 12)
    )
    # 0.7 % at the mesh that the tests use, 20 times below the 15 % asked, half of it at 8; and the error falls.
    np.testing.assert_allclose(coarse, fine, rtol=8e-3)
    np.testing.assert_allclose(middle, fine, rtol=5e-3)
    assert (np.abs(middle - fine) < np.abs(coarse - fine)).all()


@pytest.mark.long
def test_finite_element_boundary_is_as_stated() -> None:
    """A rim of 4 modules takes off up to 7 %, sides clamped at 1.5 pitches up to 20 %."""
    tooth = rack_tooth(18, 2.0)
    radius, fem = ring(18)
    shallow = FemTooth(tooth, r_inner=tooth.r_f - 4.0 * tooth.m, n=ACROSS)
    sector = FemTooth(tooth, r_inner=tooth.r_f - DEPTH * tooth.m, n=ACROSS, neighbours=1)
    for model, least in ((shallow, 0.92), (sector, 0.79)):
        ratio = np.array([model.load(r).compliance for r in (tooth.r_a, tooth.r, float(radius[2]))]) / fem
        # 0.01 below what docs/explanation/compliance.md gives, for the coarser mesh here.
        assert (ratio < 1.0).all()
        assert (ratio > least).all()


@pytest.mark.long
@pytest.mark.parametrize("z", [12, pytest.param(40, marks=pytest.mark.slow)])
def test_undercut_and_many_teeth_against_finite_elements(z: int) -> None:
    tooth = rack_tooth(z, 2.0)
    inner = tooth.r_f - DEPTH * tooth.m
    # A ring of 12 teeth would close upon itself before 5 modules: 4 there.
    inner = inner if inner > 2.0 else tooth.r_f - 4.0 * tooth.m
    model = FemTooth(tooth, r_inner=inner, n=ACROSS)
    loads = [model.load(r) for r in (tooth.r_a, tooth.r)]
    q = tooth_compliance(section_of(tooth, bore_radius=2.0), radius=[load.radius for load in loads], **STEEL) * B * E
    # Other gears than the study's: found +4, +7 % (12 teeth) and +9, +16 % (40 teeth); 20 %
    # keeps a law honest.
    np.testing.assert_allclose(q, [load.compliance for load in loads], rtol=0.20)


@pytest.mark.long
def test_potential_energy_is_a_ring_in_plane_stress() -> None:
    """Against its own kind of tooth (plane stress, ring clamped at the bore, twist in): 6, 10 and
    10 %.

    In plane strain without the twist it is 26 to 61 % off at 25 teeth: that gap is the model's and
    not the integration's.
    """
    tooth = rack_tooth(25, 2.0)
    model = FemTooth(tooth, r_inner=10.0, n=ACROSS, plane="stress")
    loads = [model.load(r, with_body=True) for r in (tooth.r_a, tooth.r, lowest_contact(tooth, rack_tooth(18, 2.0)))]
    q = (
        tooth_compliance(
            section_of(tooth),
            radius=[load.radius for load in loads],
            law="potential_energy",
            **STEEL,
        )
        * B
        * E
    )
    ratio = q / np.array([load.compliance for load in loads])
    # 15 % as for the others; it errs to the soft side since beam and ring meet twice at the root.
    assert (ratio > 1.0).all()
    assert (ratio < 1.15).all()


# Limits, signs and scaling -----------------------------------------------------------------------


@pytest.mark.parametrize("law", BEAM_LAWS)
def test_grows_from_root_to_tip_and_is_convex(law: str) -> None:
    for z in (18, 25):
        tooth = rack_tooth(z, 2.0)
        q = tooth_compliance(section_of(tooth), radius=flank(tooth), law=law, **STEEL)
        assert (q > 0.0).all()
        assert (np.diff(q) > 0.0).all()
        assert (np.diff(q, 2) > 0.0).all()


@pytest.mark.parametrize("law", BEAM_LAWS)
def test_thinner_tooth_is_softer_most_of_all_at_the_tip(law: str) -> None:
    radius = flank(rack_tooth(18, 2.0))
    q = [
        tooth_compliance(section_of(rack_tooth(18, 2.0, thinning=t)), radius=radius, law=law, **STEEL)
        for t in (0.0, 0.05, 0.10)
    ]
    rise = q[1] - q[0]
    assert (rise > 0.0).all()
    assert rise[-1] > 3.0 * rise[0]
    # 50 um are 1.6 % of the thickness; bending goes with its cube, so the rise is nearly linear: 10
    # % of curvature at most.
    np.testing.assert_allclose((q[2] - q[0])[-1], 2.0 * rise[-1], rtol=0.1)


@pytest.mark.parametrize("law", law_names())
def test_similar_teeth_of_any_module_and_width(law: str) -> None:
    small, large = rack_tooth(18, 2.0), rack_tooth(18, 6.0)
    radius = flank(small)
    q = tooth_compliance(section_of(small), radius=radius, law=law, **STEEL)
    tripled = {**STEEL, "face_width": 3.0 * B}
    # Compliance times face width is a pure number over E: only rounding, carried through tan and
    # arccos.
    np.testing.assert_allclose(
        tooth_compliance(section_of(large), radius=3.0 * radius, law=law, **tripled) * 3.0,
        q,
        rtol=1e-9,
    )
    half = {**STEEL, "youngs_modulus": 0.5 * E}
    np.testing.assert_allclose(tooth_compliance(section_of(small), radius=radius, law=law, **half), 2.0 * q, rtol=1e-12)


def test_narrow_is_softer_than_wide_by_plane_strain() -> None:
    tooth = rack_tooth(18, 2.0)
    section = section_of(tooth)
    limit = 5.0 * float(section.H_p[0])
    wide, narrow = (
        tooth_compliance(section, radius=flank(tooth), **{**STEEL, "face_width": b}) * b
        for b in (limit * 1.001, limit * 0.999)
    )
    # Bending and rotation go by 1/(1-nu^2) = 1.099, the l/h term of the foundation by 1.75, shear
    # not at all.
    assert (narrow / wide > 1.03).all()
    assert (narrow / wide < 1.2).all()


@pytest.mark.parametrize("law", BEAM_LAWS)
def test_quadrature_and_outline_are_converged(law: str) -> None:
    radius = flank(rack_tooth(18, 2.0))
    coarse, fine = (
        tooth_compliance(section_of(rack_tooth(18, 2.0, points=n)), radius=radius, law=law, **STEEL)
        for n in (150, 3000)
    )
    # A polyline's sagitta goes with 1/n^2: 150 points leave 1e-4 of the thickness at the fillet.
    np.testing.assert_allclose(coarse, fine, rtol=1e-3)


def test_elements_are_enough() -> None:
    section = section_of(rack_tooth(18, 2.0, points=2000))
    load = load_points(section, flank(rack_tooth(18, 2.0)), "drive")
    default = beam_integrals(section, start=section.x_e, stop=load.x)
    double = beam_integrals(section, start=section.x_e, stop=load.x, elements=2 * ELEMENTS)
    np.testing.assert_allclose(default.I_2, double.I_2, rtol=1e-5)  # stated at ELEMENTS
    np.testing.assert_allclose(default.A, double.A, rtol=1e-5)


def test_integrals_are_those_of_brute_force_in_whatever_order_loads_come() -> None:
    section = section_of(rack_tooth(25, 2.0))
    load = load_points(section, flank(rack_tooth(25, 2.0)), "drive")
    shuffled = np.random.default_rng(5).permutation(load.x.shape[1])
    found = beam_integrals(section, start=section.x_e, stop=load.x[:, shuffled])
    for at, stop in enumerate(load.x[0, shuffled]):
        x = np.linspace(float(section.x_e[0]), stop, 20001)
        per_inertia = 12.0 / np.interp(x, section.x[0], section.h[0]) ** 3
        for power, mine in enumerate((found.I_0, found.I_1, found.I_2)):
            # Trapezoids at 20001 points are good to 1e-6, elements to 1e-5.
            assert mine[0, at] == pytest.approx(float(np.trapezoid((stop - x) ** power * per_inertia, x)), rel=1e-5)


def test_error_gear_tooth_by_tooth() -> None:
    """Every tooth by its own outline; an index deviation turns a tooth and does not soften it."""
    tooth = rack_tooth(25, 2.0)
    rng = np.random.default_rng(7)
    thin, turn = rng.uniform(0.0, 2e-3, 25)[:, None], rng.uniform(-1e-3, 1e-3, 25)[:, None]
    drive, coast = tooth.psi + turn, turn - tooth.psi + thin * (tooth.radius > 23.0)
    section = section_of(tooth, drive=drive, coast=coast)
    radius = flank(tooth)
    for law in BEAM_LAWS:
        q = tooth_compliance(section, radius=radius, law=law, **STEEL)
        assert q.shape == (25, radius.size)
        one = tooth_compliance(section_of(tooth, drive=drive[3], coast=coast[3]), radius=radius, law=law, **STEEL)
        np.testing.assert_allclose(q[3], one, rtol=1e-14)  # sums run in another order
        order = np.argsort(thin[:, 0])
        assert (np.diff(q[order, -1]) > 0.0).all()
    np.testing.assert_allclose(section.centre, turn[:, 0] + 0.5 * thin[:, 0], atol=1e-12)  # rounding


def test_both_flanks_of_a_symmetric_tooth_are_alike() -> None:
    tooth = rack_tooth(18, 2.0)
    section = section_of(tooth)
    for law in BEAM_LAWS:
        drive, coast = (
            tooth_compliance(section, radius=flank(tooth), law=law, flank=side, **STEEL) for side in ("drive", "coast")
        )
        np.testing.assert_allclose(drive, coast, rtol=1e-12)  # rounding


def test_tip_relief_softens_only_a_little() -> None:
    tooth = rack_tooth(18, 2.0)
    relief = 0.008 / tooth.r * np.clip((tooth.radius - 19.3) / 0.7, 0.0, 1.0)
    plain, relieved = (
        tooth_compliance(
            section_of(tooth, drive=tooth.psi - d, coast=d - tooth.psi),
            radius=flank(tooth),
            **STEEL,
        )
        for d in (0.0 * relief, relief)
    )
    rise = relieved / plain - 1.0
    # 16 um of 1.4 mm at the tip, where the moment is nought: bounded by the cube of that thinning.
    assert (rise >= -1e-12).all()
    assert rise[-1] < 3.0 * 0.016 / 1.3


def test_root_land_may_waver_by_rounding() -> None:
    tooth = rack_tooth(18, 2.0)
    radius = tooth.radius * np.where(np.arange(tooth.radius.size) % 2, 1.0, 1.0 + 2e-16)
    q, wavering = (
        tooth_compliance(section_of(tooth, radius=r), radius=[18.0], **STEEL) for r in (tooth.radius, radius)
    )
    np.testing.assert_allclose(wavering, q, rtol=1e-12)  # rounding


def test_low_load_lifts_the_tooth() -> None:
    """At the base circle the load is inclined by minus the half angle: it pulls on the tooth."""
    tooth = rack_tooth(18, 2.0)
    load = load_points(section_of(tooth), [tooth.r_b, tooth.r_a], "drive")
    psi_b = math.pi / 36.0 + math.tan(math.radians(20.0)) - math.radians(20.0)
    # The fillet reaches just above the base circle here and stands 1e-4 rad clear of the involute.
    assert float(load.beta[0, 0]) == pytest.approx(-psi_b, abs=2e-4)
    assert load.u[0, 0] > load.x[0, 0]
    assert load.u[0, 1] < load.x[0, 1]


# Names and bad input -----------------------------------------------------------------------------


def test_laws_are_found_by_name() -> None:
    assert {
        "cantilever",
        "cantilever_published",
        "iso6336",
        "potential_energy",
        "weber_banaschek",
    } <= set(law_names())
    for name in law_names():
        law = find_law(name)
        assert isinstance(law, ComplianceLaw)
        assert law.name == name
        assert law.source
    with pytest.raises(OutOfRangeError, match="cantilever"):
        find_law("cantilevr")


@pytest.mark.parametrize(
    "wrong",
    [
        {"face_width": 0.0},
        {"face_width": -1.0},
        {"face_width": math.nan},
        {"youngs_modulus": 0.0},
        {"poisson_ratio": 0.5},
        {"radius": [21.0]},
        {"radius": [16.0]},
        {"radius": [math.nan]},
    ],
)
def test_bad_numbers_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(OutOfRangeError):
        tooth_compliance(
            section_of(rack_tooth(18, 2.0)),
            **({"radius": [18.0]} | STEEL | wrong),
        )


def test_bad_outlines_are_refused() -> None:
    tooth = rack_tooth(18, 2.0)
    with pytest.raises(GeometryError, match="pinched"):
        section_of(tooth, coast=-tooth.psi + 0.1)
    with pytest.raises(GeometryError, match="fall"):
        section_of(tooth, radius=tooth.radius[::-1])
    with pytest.raises(GeometryError, match="fit"):
        section_of(tooth, coast=-tooth.psi[1:])
    with pytest.raises(GeometryError, match="bore"):
        section_of(tooth, bore_radius=16.0)
    with pytest.raises(GeometryError, match="finite"):
        section_of(tooth, drive=np.full_like(tooth.psi, np.nan))
    for law, lack in (("potential_energy", {"bore_radius": None}), ("iso6336", {"teeth": None})):
        with pytest.raises(GeometryError):
            tooth_compliance(section_of(tooth, **lack), radius=[18.0], law=law, **STEEL)
    with pytest.raises(GearpolyError, match="polynomials"):
        potential_energy.compliance(
            section_of(rack_tooth(400, 2.0), bore_radius=300.0),
            load_points(section_of(rack_tooth(400, 2.0)), [400.0], "drive"),
            Blank(b=B, E=E, nu=NU),
        )
