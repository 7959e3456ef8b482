"""Where a physics might be, and how large its coordinates are there."""

from __future__ import annotations

from dataclasses import dataclass

from gearpoly.arguments import GEARS

Values = tuple[float, ...]
"""Amplitudes first, then shape, in the units of the pair file."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a physics might be: ``gear`` 0 (driving) or 1, ``tooth``, ``order``, ``flank``, ``recordings`` (none: in
    all), ``form`` (none: as declared, or the plainest); ``shape`` the values of its shape to start from; ``probe`` the
    amplitudes at which its effect is looked at (0: by steps of one unit).
    """

    gear: int | None = None
    tooth: int | None = None
    order: int | None = None
    flank: str | None = None
    recordings: tuple[int, ...] = ()
    form: str | None = None
    shape: Values = ()
    probe: Values = ()

    @property
    def gear_name(self) -> str | None:
        """ "driving" or "driven"."""
        return None if self.gear is None else GEARS[self.gear]
