"""gearpoly from Python: what ``import gearpoly`` offers, in one place. All of it is documented and kept."""

from gearpoly.api.pair import Pair, PairGear, load
from gearpoly.api.readings import Surveyed, read, survey
from gearpoly.api.results import Compared, Simulated
from gearpoly.api.studied import Studied, open_study, run_study
from gearpoly.api.verdicts import Diagnosed, Planned
from gearpoly.api.viewed import Viewed
from gearpoly.api.written import mounts, new_pair, pair_from, pair_of_mount
from gearpoly.errors import (
    GearpolyError,
    GeometryError,
    InputFileError,
    JammedError,
    MissingExtraError,
    NoContactError,
    OutOfRangeError,
)
from gearpoly.files.pair_from import MadeFiles
from gearpoly.files.samples import copy_samples, samples
from gearpoly.recording.recording import Recording

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
