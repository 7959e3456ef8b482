"""The verdict: plain frozen data, ready for terminal, JSON and page."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.diagnose.heldout import Checked, Rms
from gearpoly.diagnose.limits import Exceeded
from gearpoly.diagnose.separate import Separation
from gearpoly.files.models import PairFile
from gearpoly.mesh.pair import Flank
from gearpoly.physics.base import Claim
from gearpoly.physics.words import Reported
from gearpoly.units import FloatArray

Status = Literal["nothing_missing", "explained", "partly_explained", "unexplained"]

LIKELIER_THAN_NOT = 0.5
"""Probability above which the likeliest of look-alikes stands for them alone: it is then likelier than all others
together."""


def _said(claim: Claim, tooth: int | None) -> str:
    """A claim as a sentence about ``tooth``."""
    return claim.physics.says(replace(claim.place, tooth=tooth), claim.values)


@dataclass(frozen=True, kw_only=True)
class Rival:
    """What else a claim could be, with the parameters that it would have and its ``probability``; ``tooth`` (None where
    the numbering is open) and where that passes on the encoder."""

    claim: Claim
    parameters: Reported
    probability: float
    tooth: int | None = None
    encoder_deg: float | None = None

    @property
    def says(self) -> str:
        """The rival as a sentence; it names no tooth where the numbering is open."""
        return _said(self.claim, self.tooth)


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One missing physics: the ``claim``, its ``parameters`` (value, standard error), where its ``tooth`` passes on the
    encoder, ``gain`` in misfit, its ``probability`` and that of a cause that nobody knows, rms in mm on unseen samples
    ``without`` and ``with_`` it, its ``rivals`` and the recording that would decide. ``at_least``: its size may be
    larger, for teeth do not touch there; ``foretold``: by how much less of a misfit each torque and flank is foretold
    by the others with it (None where there is one condition only). ``together``: all claims of one slow physics, each
    about some of the recordings, of which ``claim`` is the first (none: it stands alone)."""

    claim: Claim
    parameters: Reported
    tooth: int | None
    encoder_deg: float | None
    gain: float
    probability: float
    unknown_probability: float
    without: Rms
    with_: Rms
    rivals: tuple[Rival, ...]
    separation: Separation | None
    at_least: bool = False
    foretold: float | None = None
    together: tuple[Claim, ...] = ()

    @property
    def says(self) -> str:
        """The finding as a sentence, or one for each claim; it names no tooth where the numbering is open. Where it is
        no likelier than its rivals together, it is one of them."""
        said = " ".join(_said(claim, self.tooth) for claim in self.claims)
        if self.rivals and self.probability <= LIKELIER_THAN_NOT:
            return f"One of {1 + len(self.rivals)} that look alike here, of which none is likelier than not: {said}"
        return said

    @property
    def claims(self) -> tuple[Claim, ...]:
        """All that is claimed."""
        return self.together or (self.claim,)

    @property
    def recordings(self) -> tuple[int, ...]:
        """Numbers of the recordings that it is about (none: all)."""
        return tuple(sorted({k for claim in self.claims for k in claim.place.recordings}))


@dataclass(frozen=True, kw_only=True, eq=False)
class BuiltFlank:
    """Every tooth of one gear's flank as it was built, (z,) in um with standard errors: index deviations ``pitch``
    about their mean, and profile ``slope``."""

    flank: Flank
    pitch: FloatArray
    pitch_std: FloatArray
    slope: FloatArray
    slope_std: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class BuiltGear:
    """One gear as the recordings show it: its recorded ``flanks``, drive first, without what is claimed of it, and the
    mean tooth ``thickness`` deviation in um with its standard error (None: one flank only was recorded).

    ``grade_needed`` (None: worse than all) is the finest ISO 1328-1 grade that does not surely exclude the gear as it
    runs: with the pitch, pitch waves and slopes that are claimed, since a gear with one tooth 20 um off its place does
    not run as grade 5, whatever its other teeth are. ``grade_kept`` (None: none) is the finest that it keeps whatever
    the errors are. ``exceeded`` are limits of the pair file that it breaks, counted in the same way.
    ``estimated``: its teeth were open to the fit, each by itself. ``ungraded``: why no grade is told of it, in words,
    if none is; both grades are then None, and nothing is ``exceeded``."""

    flanks: tuple[BuiltFlank, ...]
    thickness: tuple[float, float] | None
    grade_needed: int | None
    grade_edition: int
    grade_kept: int | None = None
    exceeded: tuple[Exceeded, ...] = ()
    estimated: bool = True
    ungraded: str = ""

    @property
    def first(self) -> BuiltFlank:
        """The drive flank, or the coast flank where only that was recorded."""
        return self.flanks[0]

    @property
    def coast(self) -> BuiltFlank | None:
        """The coast flank, if it was recorded."""
        return next((one for one in self.flanks if one.flank == "coast"), None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnosis:
    """All that a diagnosis found.

    ``before`` the declared simulation, ``as_built_only`` with as-built teeth, ``after`` with everything; rms in mm.
    ``unseen`` what unseen data say of the names (None: nothing was to be named).
    ``left`` (n_k,) in mm what is left of every recording. ``fitted`` the pair file with it all.
    """

    comparison: Comparison
    status: Status
    findings: tuple[Finding, ...]
    unexplained: tuple[Entry, ...]
    built: tuple[BuiltGear, BuiltGear]
    compliance_scale: tuple[float, float] | None
    noise: float
    noise_by_recording: tuple[float, ...]
    before: Rms
    as_built_only: Rms
    after: Rms
    held_out_by: str
    left: tuple[FloatArray, ...]
    fitted: PairFile
    not_excluded: tuple[str, ...]
    remarks: tuple[str, ...]
    unseen: Checked | None = None
    stopped: bool = False
    seconds: tuple[tuple[str, float], ...] = field(default=())
