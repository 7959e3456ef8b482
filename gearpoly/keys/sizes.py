"""What an owner measures or orders a gear by, as the keys that describe it: diametral pitch, tip and root diameter.

Closed forms of ISO 21771:2007 (4.2, 5.3): d_a = m (z + 2 x + 2 h_aP), d_f = m (z + 2 x - 2 h_fP), m = 25.4 mm / P_d.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeGuard

from gearpoly.keys.kinds import broken

MM_PER_INCH = 25.4

COEFFICIENT_DECIMALS = 12
"""Decimals that are kept of a computed coefficient: what float64 adds beyond them is no part of a gear."""

LEAST_PITCH, MOST_PITCH = 0.254, 508.0
"""Diametral pitches of modules 100 and 0.05 mm, the bounds of a pair file."""


LEAST_TEETH = 5
"""Of a gear in a pair file; fewer are refused there, whatever their sizes are."""


def module_of(P_d: float) -> float:
    """Module in mm of a diametral pitch ``P_d`` in teeth per inch of reference diameter."""
    return MM_PER_INCH / P_d


def profile_shift_of(d_a: float, *, z: int, m: float, h_aP: float) -> float:
    """Profile shift coefficient x of a gear with tip diameter ``d_a`` in mm and an addendum of ``h_aP`` modules."""
    return round(0.5 * (d_a / m - z) - h_aP, COEFFICIENT_DECIMALS)


def addendum_of(d_a: float, *, z: int, m: float, x: float) -> float:
    """Addendum h_aP in modules, any shortening included, of a gear with tip diameter ``d_a`` in mm."""
    return round(0.5 * (d_a / m - z) - x, COEFFICIENT_DECIMALS)


def dedendum_of(d_f: float, *, z: int, m: float, x: float) -> float:
    """Dedendum h_fP in modules of a gear with root diameter ``d_f`` in mm."""
    return round(0.5 * (z - d_f / m) + x, COEFFICIENT_DECIMALS)


def with_sizes(raw: Mapping[str, Any]) -> dict[str, Any]:
    """The table ``raw`` of one gear with its sizes turned into module, profile shift, addendum and dedendum.

    A size that is no number, or lacks what it needs, stays as it is, for the model to refuse. Raises the model's own
    rule error for what is stated twice.
    """
    out = dict(raw)
    pitch = out.get("diametral_pitch")
    if pitch is not None and "module_mm" in out:
        found = f"{pitch}, and module_mm = {out['module_mm']} too"
        broken("diametral_pitch", found, "want one of the two, since module_mm = 25.4 / diametral_pitch")
    if _positive(pitch) and LEAST_PITCH <= pitch <= MOST_PITCH:
        out["module_mm"] = module_of(float(out.pop("diametral_pitch")))
    z, m = out.get("teeth"), out.get("module_mm")
    if isinstance(z, bool) or not isinstance(z, int) or z < LEAST_TEETH or not _positive(m):
        return out
    tip = out.get("tip_diameter_mm")
    if _positive(tip):
        _tip(out, z, m)
    root, x = out.get("root_diameter_mm"), out.get("profile_shift", 0.0)
    if _positive(root) and _number(x):
        if "dedendum" in out:
            found = f"{root}, and dedendum = {out['dedendum']} too"
            broken("root_diameter_mm", found, "want one of the two, since each says how deep the teeth are cut")
        h_fP = dedendum_of(root, z=z, m=m, x=x)
        if not 0.0 < h_fP <= 4.0:
            found = f"{root}, which makes dedendum = {h_fP:.6g}"
            broken(
                "root_diameter_mm", found, f"want a diameter in mm below {m * (z + 2.0 * x):.6g}, by at most 8 modules"
            )
        out["dedendum"] = h_fP
        del out["root_diameter_mm"]
    return out


def _tip(out: dict[str, Any], z: int, m: float) -> None:
    """Turn the tip diameter into what is not stated of addendum and profile shift."""
    d_a, h_aP, x = out["tip_diameter_mm"], out.get("addendum"), out.get("profile_shift")
    if h_aP is None and x is None:
        wish = (
            "want profile_shift beside it, from which it gives the addendum, or addendum (usually 1.0), from which it "
            "gives the profile shift"
        )
        broken("tip_diameter_mm", f"{d_a} alone", wish)
    if h_aP is not None and x is not None:
        found = f"{d_a}, and both addendum = {h_aP} and profile_shift = {x}"
        broken("tip_diameter_mm", found, "want two of the three, since each follows from the others")
    if _number(h_aP):
        name, rest, value, low, high = "profile_shift", h_aP, profile_shift_of(d_a, z=z, m=m, h_aP=h_aP), -5.0, 5.0
    elif _number(x):
        name, rest, value, low, high = "addendum", x, addendum_of(d_a, z=z, m=m, x=x), 0.0, 3.0
    else:
        return
    if not low <= value <= high or (name == "addendum" and value == 0.0):
        span = f"from {m * (z + 2.0 * (rest + low)):.6g} to {m * (z + 2.0 * (rest + high)):.6g}"
        broken("tip_diameter_mm", f"{d_a}, which makes {name} = {value:.6g}", f"want a diameter in mm {span}")
    out[name] = value
    del out["tip_diameter_mm"]


def _number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= 1e6


def _positive(value: object) -> TypeGuard[float]:
    return _number(value) and value > 0
