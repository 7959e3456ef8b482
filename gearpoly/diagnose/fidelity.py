"""How far the simulation itself can be trusted."""

from __future__ import annotations

from gearpoly.units import UM

FAINT = 0.012 * UM
"""mm rms. Effects below this are within what chords, contacts and interpolation leave of the simulation itself."""
