"""A scene as the plain values that the page reads: flanks, simulated curves, and a recording's mismatch.

Flanks travel as one ideal flank per gear in float64 and each tooth's deviation from it: the deviation at the form
point in float64, what varies along the flank in steps of 0.0001 nm. That is a hundredth of a pixel of a view 10 nm
wide, which thus still shows the polygons that were simulated.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gearpoly import __version__
from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry, says
from gearpoly.compare.zeros import Zeros
from gearpoly.gear.flank import Flanks
from gearpoly.mesh.pair import Mounted
from gearpoly.page.pack import Kind, nearly_even, packed, rounded, under_noise
from gearpoly.page.typeset import typeset
from gearpoly.simulate import Simulation
from gearpoly.units import DEG, NM, UM, FloatArray
from gearpoly.view.scene import ViewScene

MOST_SAMPLES = 120_000
"""Most samples of a recording in a page; of longer ones every k-th is shown. 266 a mesh of an 18/25 cycle."""

FORCE_STEP = 2e-5
"""Of forces and stiffness, as a part of the greatest: a fifth of the fourth figure, the last that the page prints."""

FINE_UM = 1e-3
"""Of backlash, in um: as fine as the page prints it."""

TE_UM = 1e-5
"""Of transmission error, in um: a hundredth of what the page prints, since its own kernel is held against it."""

FLANK_UM = 1e-7
"""Of what varies along a flank, in um. Neighbouring vertices touch within nanometres of each other: in steps of 1e-6
another one led at one in 256 positions, 1.2 um aside."""

CHECKS = 256
"""Positions whose contact points the page carries to compare its own kernel with."""


def document(scene: ViewScene) -> dict[str, Any]:
    """Everything that the page needs, sizes in mm, angles in rad, deviations, gaps and TE in um, forces in N."""
    simulation = scene.simulation
    pair = simulation.pair
    return {
        "gearpoly": __version__,
        "name": scene.name,
        "flank": simulation.flank,
        "torque_nm": simulation.torque / NM,
        "seed": simulation.seed,
        "at": scene.theta_2,
        "a": pair.a,
        "alpha_w": pair.alpha_w,
        "cycle": pair.cycle,
        "meshes": pair.meshes_per_cycle,
        "per_mesh": scene.per_mesh,
        "chord_noise_um": pair.chord_noise / UM,
        "remarks": list(scene.remarks),
        "gears": [
            _gear(name, mounted, origin)
            for name, mounted, origin in zip(
                ("driving", "driven"), (pair.driving, pair.driven), simulation.assembled.origin, strict=True
            )
        ],
        "samples": _samples(simulation),
        "check": _check(simulation),
        "recording": None if scene.comparison is None else _recording(scene.comparison),
    }


def _gear(name: str, mounted: Mounted, origin: str) -> dict[str, Any]:
    gear, flanks = mounted.gear, mounted.flanks
    psi = ideal_psi(flanks, flanks.r)
    return {
        "name": name,
        "origin": origin,
        "z": gear.z,
        "m": gear.m,
        "r": gear.r,
        "r_b": gear.r_b,
        "r_a": gear.r_a,
        "r_f": gear.r_f,
        "r_bore": 0.5 * (gear.r_f if gear.d_bore is None else gear.d_bore),
        "sign": mounted.sign,
        "root": flanks.root.n,
        "l_start": flanks.span.l_start,
        "centre": mounted.centre.tolist(),
        "centre_lines": packed(mounted.centre_lines, "f8"),
        "radius": packed(flanks.r, "f8"),
        "psi": packed(psi, "f8"),
        "drive": _deviation(flanks, flanks.psi_drive - psi),
        "coast": _deviation(flanks, flanks.psi_coast - psi),
        "chipped": [_chipped(flanks, tooth) for tooth in sorted(flanks.chipped)],
    }


def ideal_psi(flanks: Flanks, r: FloatArray) -> FloatArray:
    """Angle (n,) in rad of the deviation-free flank from its centre line at the radii ``r`` (n,) in mm, whose first are
    those of the root."""
    gear, n = flanks.gear, flanks.root.n
    xi = np.sqrt(np.maximum(0.0, (r[n:] - gear.r_b) * (r[n:] + gear.r_b))) / gear.r_b
    return np.concatenate((flanks.root.psi, gear.psi_b - (xi - np.arctan(xi))))


def _chipped(flanks: Flanks, tooth: int) -> dict[str, Any]:
    """A tooth whose tip is missing, on its own radii; beside it the whole one travels with all others."""
    own = flanks.tooth(tooth)
    psi = ideal_psi(flanks, own.r)
    return {
        "tooth": tooth,
        "radius": packed(own.r, "f8"),
        "psi": packed(psi, "f8"),
        "drive": _deviation(flanks, own.drive[None] - psi),
        "coast": _deviation(flanks, own.coast[None] - psi),
    }


def _deviation(flanks: Flanks, turned: FloatArray) -> dict[str, Any]:
    """Deviations (z, n) in um of one side: that at the form point, and the rest. An angle times r_b is a normal
    deviation, exactly so for involutes."""
    d = turned * flanks.gear.r_b / UM
    level = d[:, flanks.root.n - 1]
    return {"level": packed(level, "f8"), "rest": rounded(d - level[:, None], to=FLANK_UM)}


def _samples(simulation: Simulation) -> dict[str, Any]:
    """The simulated cycle: unloaded TE, backlash, touching pairs; under load how far the driving gear turns on and
    who carries what."""
    load, found = simulation.load, simulation.contacts
    out = {
        "te_um": rounded(found.te * simulation.pair.r_b2 / UM, to=TE_UM),
        "backlash_um": rounded(simulation.backlash.j_bn / UM, to=FINE_UM),
        "pairs": packed(simulation.pairs, "u1"),
    }
    if load is None:
        return out
    carrying = load.force > 0.0
    return out | {
        "approach_um": rounded(load.approach / UM, to=TE_UM),
        "stiffness_n_per_um": rounded(load.stiffness * UM, to=FORCE_STEP * float(np.max(load.stiffness)) * UM),
        "carrying": packed(np.bincount(found.position[carrying], minlength=found.theta_2.size), "u1"),
        "driven": packed(found.driven[carrying], few(simulation.pair.driven.gear.z)),
        "driving": packed(found.driving[carrying], few(simulation.pair.driving.gear.z)),
        "force_n": rounded(load.force[carrying], to=FORCE_STEP * float(np.max(load.force))),
    }


def few(z: int) -> Kind:
    """How numbers of ``z`` teeth are packed."""
    return "u1" if z <= 256 else "u2"


def _check(simulation: Simulation) -> dict[str, Any]:
    """First touches of evenly chosen positions as ``simulate`` has them, for the page to compare its own with."""
    found = simulation.contacts
    position = np.unique(np.linspace(0, found.theta_2.size - 1, CHECKS).astype(np.int64))
    first = np.searchsorted(found.position, position)
    return {
        "position": packed(position, "u4"),
        "driving": packed(found.driving[first], "u2"),
        "driven": packed(found.driven[first], "u2"),
        "point": packed(found.point[first], "f8"),
    }


def _recording(comparison: Comparison) -> dict[str, Any]:
    one = comparison.aligned[0]
    pair = comparison.assembled.pair
    turns = np.mod(one.theta_2, pair.cycle)
    every = max(1, math.ceil(turns.size / MOST_SAMPLES))
    chosen = np.arange(0, turns.size, every)
    order = chosen[np.argsort(turns[chosen], kind="stable")]
    source = one.cleaned.recording.source
    noise = comparison.located.noise_level / UM
    return {
        "file": source.name,
        "samples": int(turns.size),
        "every": every,
        "cycles": one.cycles,
        "noise_um": comparison.located.noise_level / UM,
        "rms_um": one.rms / UM,
        "mean_um": one.mean / UM,
        "theta_2": nearly_even(turns[order]),
        "recorded_um": under_noise(one.recorded[order] / UM, noise=noise),
        "mismatch_um": under_noise(one.residual[order] / UM, noise=noise),
        "open": [
            name for name, told in zip(("driving", "driven"), comparison.alignment.numbered, strict=True) if not told
        ],
        "where": [_entry(entry, comparison) for entry in comparison.located.where],
    }


def _entry(entry: Entry, comparison: Comparison) -> dict[str, Any]:
    """One place where they differ: in words, and the tooth to jump to where there is one."""
    out: dict[str, Any] = {"kind": entry.kind, "says": typeset(says(entry)), "gear": None, "tooth": None, "phase": None}
    if entry.phase is not None:
        out["phase"] = list(entry.phase)
    if entry.kind == "tooth" and entry.gear is not None:
        out["gear"] = entry.gear
        out["tooth"] = entry.tooth if entry.tooth is not None else _shown_tooth(entry, comparison)
    return out


def _shown_tooth(entry: Entry, comparison: Comparison) -> int | None:
    """Which drawn tooth stands where an unnumbered one was found: the picture's numbers, not the gear's."""
    zeros: Zeros = comparison.alignment.zeros
    k = 0 if entry.gear == "driving" else 1
    zero = zeros.driving if k == 0 else zeros.driven
    if entry.encoder_deg is None or zero is None:
        return None
    recording = comparison.aligned[0].cleaned.recording
    direction = recording.driving_direction if k == 0 else recording.driven_direction
    pair = comparison.assembled.pair
    gear = (pair.driving, pair.driven)[k].gear
    return round(direction * (entry.encoder_deg * DEG - zero) / gear.tau) % gear.z
