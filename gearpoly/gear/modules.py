"""Modules that gears are made in."""

from __future__ import annotations

MODULES = (
    *(0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9),
    *(1.0, 1.125, 1.25, 1.375, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0, 9.0),
    *(10.0, 11.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 32.0, 36.0, 40.0, 45.0, 50.0),
)
"""mm. From 1 on both series of ISO 54:1996, below those of DIN 780-1:1977."""

AS_MEASURED = 0.002
"""Part by which a centre distance may be off that of a module: 0.2 mm of 100, as a caliper tells it."""


def module_at(centre_distance: float, *, z: tuple[int, int]) -> float | None:
    """The standard module in mm whose gears of ``z`` teeth, without profile shift, stand so far apart in mm; None where
    there is none."""
    whole = 2.0 * centre_distance / sum(z)
    nearest = min(MODULES, key=lambda one: abs(one - whole))
    return nearest if abs(whole - nearest) < AS_MEASURED * nearest else None
