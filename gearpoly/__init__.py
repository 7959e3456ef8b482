"""gearpoly: spur gears with their manufacturing errors as exact polygons, turned until they touch.

``gearpoly.load("pair.toml")`` and ``gearpoly.Pair`` are the way in from Python; they load when they are first asked
for, so that ``import gearpoly`` and the command line's --help stay quick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from gearpoly.api import Pair, PairGear, load

__all__ = ["Pair", "PairGear", "__version__", "load"]


def __getattr__(name: str) -> Any:
    if name in ("Pair", "PairGear", "load"):
        from gearpoly import api

        return getattr(api, name)
    raise AttributeError(f"module 'gearpoly' has no attribute {name!r}")
