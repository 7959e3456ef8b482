"""gearpoly: spur gears with their manufacturing errors as exact polygons, turned until they touch.

``gearpoly.load("pair.toml")`` is the way in from Python. What is listed in ``__all__`` is documented and kept; it loads
when it is first asked for, so that ``import gearpoly`` and the command line's --help stay quick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.2.0"

if TYPE_CHECKING:
    from gearpoly.api import (
        Compared,
        Diagnosed,
        GearpolyError,
        GeometryError,
        InputFileError,
        JammedError,
        MadeFiles,
        MissingExtraError,
        NoContactError,
        OutOfRangeError,
        Pair,
        PairGear,
        Planned,
        Recording,
        Simulated,
        Studied,
        Surveyed,
        Viewed,
        copy_samples,
        load,
        mounts,
        new_pair,
        open_study,
        pair_from,
        pair_of_mount,
        read,
        run_study,
        samples,
        survey,
    )

__all__ = [
    "Compared",
    "Diagnosed",
    "GearpolyError",
    "GeometryError",
    "InputFileError",
    "JammedError",
    "MadeFiles",
    "MissingExtraError",
    "NoContactError",
    "OutOfRangeError",
    "Pair",
    "PairGear",
    "Planned",
    "Recording",
    "Simulated",
    "Studied",
    "Surveyed",
    "Viewed",
    "__version__",
    "copy_samples",
    "load",
    "mounts",
    "new_pair",
    "open_study",
    "pair_from",
    "pair_of_mount",
    "read",
    "run_study",
    "samples",
    "survey",
]


def __getattr__(name: str) -> Any:
    if name in __all__:
        from gearpoly import api

        return getattr(api, name)
    raise AttributeError(f"module 'gearpoly' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
