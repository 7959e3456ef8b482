"""Backlash comes from thinner teeth and from a larger centre distance, each by a closed form."""

from __future__ import annotations

import math

from matplotlib.figure import Figure

import gearpoly

E_S_UM, FURTHER_MM = -60.0, 0.05
gear = {"module_mm": 2.0, "points_per_flank": 400, "inspection": {"tooth_thickness_um": E_S_UM}}
known = {"driving": {"teeth": 18, **gear}, "driven": {"teeth": 25, **gear}}


def backlash_um(centre_distance_mm: float) -> float:
    """Mean normal backlash of the pair at a centre distance."""
    pair = gearpoly.Pair.of(known | {"pair": {"centre_distance_mm": centre_distance_mm}})
    return pair.simulate(turns=0.2, fast=True).backlash_mean_um


def inv(alpha: float) -> float:
    """Involute function."""
    return math.tan(alpha) - alpha


alpha, a = math.radians(20.0), 43.0
by_thickness = -2.0 * E_S_UM * math.cos(alpha)


def by_distance_um(further_mm: float) -> float:
    """What a larger centre distance adds to the normal backlash."""
    wider = math.acos(a * math.cos(alpha) / (a + further_mm))
    return 2e3 * a * math.cos(alpha) * (inv(wider) - inv(alpha))


by_distance = by_distance_um(FURTHER_MM)

found, further = backlash_um(a), backlash_um(a + FURTHER_MM)
print(f"thin teeth {found:.3f} um, closed form {by_thickness:.3f} um")
print(f"{1e3 * FURTHER_MM:g} um further apart {further - found:.3f} um more, closed form {by_distance:.3f} um")
assert abs(found - by_thickness) < 0.01  # um: chords of 400 points on both sides
assert abs(further - found - by_distance) < 0.01

figure = Figure(layout="constrained")
axis = figure.subplots()
places = [0.01 * k for k in range(11)]
axis.plot(places, [by_thickness + by_distance_um(mm) for mm in places], label="closed forms")
axis.plot([0.0, FURTHER_MM], [found, further], "o", label="simulated")
axis.set_xlabel("centre distance beyond 43 mm / mm")
axis.set_ylabel("normal backlash / um")
axis.legend()
figure.savefig("backlash.png")
