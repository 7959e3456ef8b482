"""gearpoly from Python: what ``import gearpoly`` offers, in one place. All of it is documented and kept."""

from gearpoly.api.pair import Pair, PairGear, load, read
from gearpoly.api.results import Compared, Simulated
from gearpoly.api.studied import Studied, open_study, run_study
from gearpoly.api.verdicts import Diagnosed, Planned
from gearpoly.errors import (
    GearpolyError,
    GeometryError,
    InputFileError,
    JammedError,
    MissingExtraError,
    NoContactError,
    OutOfRangeError,
)
from gearpoly.files.samples import copy_samples, samples
from gearpoly.recording.recording import Recording

__all__ = [
    "Compared",
    "Diagnosed",
    "GearpolyError",
    "GeometryError",
    "InputFileError",
    "JammedError",
    "MissingExtraError",
    "NoContactError",
    "OutOfRangeError",
    "Pair",
    "PairGear",
    "Planned",
    "Recording",
    "Simulated",
    "Studied",
    "copy_samples",
    "load",
    "open_study",
    "read",
    "run_study",
    "samples",
]
