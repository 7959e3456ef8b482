"""A plane-strain finite-element tooth, and a rack-cut tooth to try it on.

Second implementation of tooth compliance: quadratic triangles (scikit-fem), no beam, no foundation
formula. The element model knows nothing of gearpoly.

Far boundary: a closed ring with all its teeth, clamped on the inner circle (``r_inner``, in the
tests 5 modules below the root), less the twist of that ring under the load's torque, which is no
tooth's own (closed form). A sector with ``neighbours`` teeth on either side, clamped on its radial
sides too, stands beside it: its sides are no part of a gear and stiffen the root.

The deflection of a tooth is read where the line of load meets the tooth's centre line, along that
line. The dent under the load is local and stays on the flank's side, so it is left out, as in Weber
and Banaschek's split into tooth and contact.

``python -m tests.oracles.fem_tooth`` prints the tables of docs/explanation/compliance.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshQuad
from skfem.models.elasticity import lame_parameters, linear_elasticity


@dataclass(frozen=True)
class RackTooth:
    """A symmetric tooth: radius (n,) from root land to tip, half angle psi (n,); mm and rad."""

    z: int
    m: float
    r: float
    r_b: float
    r_f: float
    r_a: float
    radius: np.ndarray
    psi: np.ndarray


def rack_tooth(
    z: int,
    m: float,
    *,
    x: float = 0.0,
    alpha: float = math.radians(20.0),
    h_a: float = 1.0,
    h_f: float = 1.25,
    rho_f: float = 0.38,
    thinning: float = 0.0,
    points: int = 400,
) -> RackTooth:
    """Tooth cut by a rack with rounded corners: exact trochoid and involute (lengths h_a, h_f,
    rho_f, x over m).

    ``thinning`` in mm, along the reference circle, is taken off both flanks of the involute
    together. The trochoid is the envelope of the corner circle: its normal runs through the rolling
    point. Derived here.
    """
    r, r_b = 0.5 * m * z, 0.5 * m * z * math.cos(alpha)
    rho, depth = rho_f * m, (h_f - x - rho_f) * m
    lateral = m * math.pi / 4.0 - h_f * m * math.tan(alpha) - rho * (1.0 - math.sin(alpha)) / math.cos(alpha)
    slant = np.linspace(0.0, math.pi / 2.0 - alpha, points)
    q = depth * np.tan(slant)
    px, py = q + rho * np.sin(slant), r - depth - rho * np.cos(slant)
    radius_t = np.hypot(px, py)
    psi_t = math.pi / z - (np.arctan2(px, py) - (q - lateral) / r)
    half = (math.pi / 2.0 + 2.0 * x * math.tan(alpha)) / z

    def involute(radius: np.ndarray) -> np.ndarray:
        a = np.arccos(np.minimum(1.0, r_b / radius))
        return half + math.tan(alpha) - alpha - (np.tan(a) - a)

    undercut = r * math.sin(alpha) < depth / math.sin(alpha) + rho
    form = float(radius_t[-1])
    if undercut:
        inside = (radius_t > r_b) & (psi_t > involute(radius_t))
        form = float(radius_t[np.argmax(inside)]) if inside.any() else form
    keep = radius_t < form
    r_a = r + (h_a + x) * m
    l_form, l_tip = math.sqrt(max(form**2 - r_b**2, 0.0)), math.sqrt(r_a**2 - r_b**2)
    radius_i = np.sqrt(r_b**2 + np.linspace(l_form, l_tip, points) ** 2)
    psi_i = involute(radius_i) - 0.5 * thinning / r
    psi_t = psi_t - 0.5 * thinning / r * np.clip((radius_t - radius_t[0]) / (form - radius_t[0]), 0.0, 1.0)
    land = np.linspace(math.pi / z, psi_t[0], 5)[:-1]
    return RackTooth(
        z=z,
        m=m,
        r=r,
        r_b=r_b,
        r_f=float(radius_t[0]),
        r_a=r_a,
        radius=np.concatenate((np.full(land.size, radius_t[0]), radius_t[keep], radius_i)),
        psi=np.concatenate((land, psi_t[keep], psi_i)),
    )


@dataclass(frozen=True)
class FemLoad:
    """Deflection per unit line load, times E (a number), and the load's centroid radius, mm."""

    radius: float
    compliance: float


class FemTooth:
    """The tooth repeated with pitch 2 pi/z on a rim down to ``r_inner`` mm, factorised once for any
    number of loads.

    ``n`` sets the mesh: elements across the tooth; everything else goes with it.
    ``neighbours=None`` is the closed ring; with a number the radial sides lie at +-(neighbours +
    1/2) pitches and are clamped. ``plane`` is ``"strain"`` or ``"stress"``.
    """

    def __init__(
        self,
        tooth: RackTooth,
        *,
        r_inner: float,
        n: int = 12,
        neighbours: int | None = None,
        nu: float = 0.3,
        plane: str = "strain",
    ) -> None:
        self.tooth = tooth
        # Plane stress is plane strain with these constants (same shear modulus).
        E, nu_plane = (1.0, nu) if plane == "strain" else ((1.0 + 2.0 * nu) / (1.0 + nu) ** 2, nu / (1.0 + nu))
        # Rigid turn of the ring's outside per unit line load at arm r_b, times that arm: T/(4 pi G)
        # (1/r_i^2 - 1/r_f^2).
        twist = tooth.r_b**2 / (2.0 * math.pi) * (1.0 + nu) * (1.0 / r_inner**2 - 1.0 / tooth.r_f**2)
        self.twist = twist if neighbours is None else 0.0
        others = range(tooth.z) if neighbours is None else range(-neighbours, neighbours + 1)
        mesh = _mesh(tooth, r_inner=r_inner, n=n, others=others).to_meshtri()
        self.basis = Basis(mesh, ElementVector(ElementTriP2()))
        stiffness = linear_elasticity(*lame_parameters(E, nu_plane)).assemble(self.basis)
        edge = math.inf if neighbours is None else (neighbours + 0.5) * 2.0 * math.pi / tooth.z

        def clamped(p: np.ndarray) -> np.ndarray:
            near = 1e-6 * tooth.m  # far above rounding, far below an element
            side = np.abs(np.abs(np.arctan2(p[1], p[0])) - edge) * np.hypot(p[0], p[1]) < near
            return (np.hypot(p[0], p[1]) < r_inner + near) | side

        facets = mesh.facets_satisfying(clamped, boundaries_only=True)
        self.free = self.basis.complement_dofs(self.basis.get_dofs(facets))
        # Symmetric and positive definite: pivots stay on the diagonal, and so few entries fill in.
        self.factor = splu(
            stiffness[self.free][:, self.free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        self.dofs = self.free.size

    def load(self, radius: float, *, half_width: float | None = None, with_body: bool = False) -> FemLoad:
        """Unit line load on the drive flank along the base tangent, a parabola of pressure over
        +-``half_width`` mm (0.1 m).

        At the tip the patch is cut off by the corner; the centroid that is returned says where the
        load really stands. ``with_body`` leaves the ring's twist in.
        """
        half_width = 0.1 * self.tooth.m if half_width is None else half_width
        t = self.tooth
        mesh = self.basis.mesh

        def on_flank(p: np.ndarray) -> np.ndarray:
            rr, angle = np.hypot(p[0], p[1]), np.arctan2(p[1], p[0])
            return (rr > t.r_f + 0.2 * t.m) & (np.abs(angle - np.interp(rr, t.radius, t.psi)) * rr < 2e-3 * t.m)

        facets = mesh.facets_satisfying(on_flank, boundaries_only=True)
        boundary = FacetBasis(mesh, self.basis.elem, facets=facets, intorder=16)
        # Arc length from the load radius, to first order: the patch is small.
        x = boundary.global_coordinates()
        slope = math.cos(math.acos(min(1.0, t.r_b / radius)))
        s = (np.hypot(x[0], x[1]) - radius) / math.sqrt(max(1.0 - slope**2, 0.01))
        weight = np.maximum(0.0, 1.0 - (s / half_width) ** 2)
        total = float((weight * boundary.dx).sum())
        r_c = float((weight * boundary.dx * np.hypot(x[0], x[1])).sum() / total)
        psi_c = float(np.interp(r_c, t.radius, t.psi))
        beta = math.acos(t.r_b / r_c) - psi_c
        direction = np.array([-math.sin(beta), -math.cos(beta)])

        @LinearForm
        def traction(v: Any, w: Any) -> Any:
            return w.p / total * (direction[0] * v[0] + direction[1] * v[1])

        force = traction.assemble(boundary, p=weight)
        u = np.zeros(self.basis.N)
        u[self.free] = self.factor.solve(force[self.free])
        on_centre = r_c * (math.cos(psi_c) - math.sin(psi_c) * math.tan(beta))
        probe = self.basis.probes(np.array([[on_centre], [0.0]])) @ u
        body = 0.0 if with_body else self.twist
        return FemLoad(radius=r_c, compliance=float(direction @ probe.reshape(2)) - body)


def _mesh(t: RackTooth, *, r_inner: float, n: int, others: range) -> MeshQuad:
    """Blocks in polar coordinates: under each tooth, the tooth, under each gap, node on node."""
    pitch = 2.0 * math.pi / t.z
    # The tooth is cut off its rim where the fillet climbs at 45 degrees, so that no block has a
    # sharp corner.
    climb = np.gradient(t.radius) / np.maximum(-np.gradient(t.psi) * t.radius, 1e-12)
    cut = int(np.argmax((t.radius > t.r_f * (1 + 1e-9)) & ((climb > 1.0) | (np.gradient(t.psi) >= 0.0))))
    r_c, psi_c = float(t.radius[cut]), float(t.psi[cut])
    # Radial spacing of the rim grows inwards; s = 1 is the outer side.
    s = 1.0 - np.linspace(1.0, 0.0, 2 * n + 1) ** 1.7
    # Levels up the tooth at equal arc length.
    side = np.column_stack((t.radius * np.cos(t.psi), t.radius * np.sin(t.psi)))[cut:]
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(side, axis=0).T))))
    levels = np.linspace(0.0, arc[-1], 3 * n + 1)
    r_level, psi_level = np.interp(levels, arc, t.radius[cut:]), np.interp(levels, arc, t.psi[cut:])
    cross = np.linspace(-1.0, 1.0, n + 1)
    # Fillet and land between two teeth: radius over angle, on one side, then mirrored; half a gap
    # has n/2 elements.
    foot_psi, foot_r = t.psi[: cut + 1][::-1], t.radius[: cut + 1][::-1]
    gap = np.linspace(psi_c, 0.5 * pitch, n // 2 + 1)
    gap_r = np.interp(gap, foot_psi, foot_r)
    gap_r[0] = r_c
    blocks = []
    for k in others:
        turn = k * pitch
        blocks.append(
            (
                r_inner + s[:, None] * (r_c - r_inner) + 0.0 * cross,
                turn + psi_c * cross + 0.0 * s[:, None],
            )
        )
        blocks.append((r_level[:, None] + 0.0 * cross, turn + psi_level[:, None] * cross))
        for sign in (-1.0, 1.0):
            order = slice(None) if sign > 0 else slice(None, None, -1)
            blocks.append(
                (
                    (r_inner + s[:, None] * (gap_r - r_inner))[:, order],
                    (turn + sign * gap + 0.0 * s[:, None])[:, order],
                )
            )
    points, cells, offset = [], [], 0
    for rr, angle in blocks:
        rows, columns = rr.shape
        index = offset + np.arange(rows * columns).reshape(rows, columns)
        points.append(np.column_stack(((rr * np.cos(angle)).ravel(), (rr * np.sin(angle)).ravel())))
        cells.append(
            np.column_stack(
                (
                    index[:-1, :-1].ravel(),
                    index[1:, :-1].ravel(),
                    index[1:, 1:].ravel(),
                    index[:-1, 1:].ravel(),
                )
            )
        )
        offset += rows * columns
    p = np.vstack(points)
    # Blocks share edges node on node; nodes nearer than 1e-7 m are one.
    _, first, same = np.unique(
        np.round(p / (1e-7 * t.m)).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return MeshQuad(p[first].T.copy(), same.ravel()[np.vstack(cells)].T.copy())


def lowest_contact(tooth: RackTooth, mate: RackTooth) -> float:
    """Radius in mm at which the mate's tip meets the flank, at the reference centre distance."""
    alpha = math.acos(tooth.r_b / tooth.r)
    return math.hypot(tooth.r_b, (tooth.r + mate.r) * math.sin(alpha) - math.sqrt(mate.r_a**2 - mate.r_b**2))


def _tables() -> None:
    from gearpoly.mesh.compliance import (
        ContactPair,
        Mate,
        contact_deflection,
        law_names,
        tooth_compliance,
        tooth_section,
    )

    b, E, nu = 20.0, 206000.0, 0.3
    teeth = {18: rack_tooth(18, 2.0), 25: rack_tooth(25, 2.0)}
    places = ("tip", "pitch", "lowest")

    def row(name: str, values: np.ndarray, reference: np.ndarray | None = None) -> None:
        text = " | ".join(f"{v / E * 1e6:.2f}" for v in values)
        if reference is not None:
            text += " | " + " | ".join(f"{v:+.1f}" for v in 100.0 * (values / reference - 1.0))
        print(f"| {name} | {text} |")

    at_pitch: dict[str, float] = dict.fromkeys(law_names(), 0.0)
    for z, tooth in teeth.items():
        mate = teeth[43 - z]
        radii = (tooth.r_a, tooth.r, lowest_contact(tooth, mate))
        rings: dict[str, dict[str, Any]] = {}
        for depth in (3, 4, 5):
            rings[f"ring, {depth} m below the root"] = {"r_inner": tooth.r_f - depth * tooth.m}
        rings["sector +-1.5 pitches, 5 m"] = {"r_inner": tooth.r_f - 5 * tooth.m, "neighbours": 1}
        rings["sector +-2.5 pitches, 5 m"] = {"r_inner": tooth.r_f - 5 * tooth.m, "neighbours": 2}
        rings["ring clamped at its bore of 20 mm"] = {"r_inner": 10.0}
        bore = {"strain": "plane strain", "stress": "plane stress"}
        print(f"\n### {z} teeth, against {43 - z}\n")
        print(f"| | {' | '.join(places)} | {' | '.join(f'{p} %' for p in places)} |")
        print("|---|---|---|---|---|---|---|")
        found = {}
        for name, options in rings.items():
            model = FemTooth(tooth, n=10, **options)
            loads = [model.load(r) for r in radii]
            found[name] = np.array([load.compliance for load in loads])
        reference = found["ring, 5 m below the root"]
        for name, values in found.items():
            row(f"FEM, {name}", values, reference)
        for plane, text in bore.items():
            model = FemTooth(tooth, n=10, r_inner=10.0, plane=plane)
            values = np.array([model.load(r, with_body=True).compliance for r in radii])
            row(f"FEM, ring at its bore with its twist, {text}", values, reference)
        section = tooth_section(
            radius=tooth.radius,
            drive=tooth.psi,
            coast=-tooth.psi,
            base_radius=tooth.r_b,
            reference_radius=tooth.r,
            bore_radius=10.0,
            teeth=z,
            mate=Mate(teeth=43 - z, profile_shift=0.0, dedendum=1.25),
        )
        for law in law_names():
            q = tooth_compliance(
                section,
                radius=[load.radius for load in loads],
                face_width=b,
                youngs_modulus=E,
                poisson_ratio=nu,
                law=law,
            )
            row(law, q * b * E, reference)
            at_pitch[law] += float(q[1])
    W = 250.0 * b
    Q_h = float(contact_deflection(W, ContactPair(b=b, E_1=E, E_2=E))[0]) / W
    print("\n### Single pair at the pitch point, 250 N/mm\n\n| law | N/(mm um) |\n|---|---|")
    for law, q in at_pitch.items():
        print(f"| {law} | {1e-3 / (b * (q + (0.0 if law == 'iso6336' else Q_h))):.2f} |")


if __name__ == "__main__":
    _tables()
