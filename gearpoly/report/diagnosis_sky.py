"""How a telescope shows what was found: how often it comes, and how large the wave is that was located there."""

from __future__ import annotations

from typing import Any

from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import Located
from gearpoly.compare.on_sky import Sky, arcsec_words, seconds_words
from gearpoly.diagnose.verdict import Finding


def finding_json(one: Finding, located: Located, sky: Sky | None) -> dict[str, Any]:
    """``on_sky`` of a finding: its period in s, and the size in arcsec of the wave located there; nothing elsewhere."""
    order = _order(one)
    if sky is None or order is None:
        return {}
    gear = None if one.claim.physics.mean_tooth else one.claim.place.gear_name
    out: dict[str, Any] = {"period_s": sky.period(gear=gear, order=order)}
    wave = _wave(located, gear, order)
    if wave is not None and wave.amplitude_um is not None:
        out["amplitude_arcsec"] = sky.arcsec(abs(wave.amplitude_um))
    return {"on_sky": out}


def finding_words(one: Finding, located: Located, sky: Sky | None) -> str:
    """The same in words; nothing where the pair stands in no telescope, or the finding is no wave."""
    found = finding_json(one, located, sky).get("on_sky")
    if found is None:
        return ""
    size = (
        ""
        if "amplitude_arcsec" not in found
        else f"; the wave located there is {arcsec_words(found['amplitude_arcsec'])}"
    )
    return f"every {seconds_words(found['period_s'])}{size}"


def _order(one: Finding) -> int | None:
    """The order of a finding per turn of its gear, or per mesh; ``None`` where it is no wave."""
    physics, place = one.claim.physics, one.claim.place
    if place.tooth is not None:
        return None
    return 1 if physics.once_per_turn or physics.mean_tooth else place.order


def _wave(located: Located, gear: str | None, order: int) -> Entry | None:
    mine = [
        entry
        for entry in located.where
        if entry.order == order and entry.gear == gear and entry.amplitude_um is not None and entry.of_the_pair
    ]
    return max(mine, key=lambda entry: abs(entry.amplitude_um or 0.0), default=None)
