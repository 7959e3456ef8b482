"""An inspection whose teeth are counted otherwise than they come into mesh: from another tooth, or the other way round.

No physics is missing then, and yet every tooth is wrong, each by a step of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.fit import BETTER, Kept
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.search import Search
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.physics.sheet import column
from gearpoly.units import IntArray

PITCHES = ("cumulative_pitch", "tooth_pitch")
"""Physics that a sheet counted otherwise looks like."""

SEVERAL = 2
"""Claims of them about one inspected gear from which its sheet is doubted: one is a tooth out of its place, or one
wave, and no other count of a sheet looks like that."""


@dataclass(frozen=True, kw_only=True)
class Recounted:
    """How the teeth of ``gear`` (0, 1) are counted where the recordings fit: tooth k of the gear has what the sheet
    says of tooth ``first + k``, or ``first - k`` if ``reversed``; ``looked`` the candidates of the last look."""

    gear: int
    first: int
    reversed: bool
    looked: list[Candidate]

    @property
    def says(self) -> str:
        """What the engineer should check."""
        name = ("driving", "driven")[self.gear]
        way = "counts its teeth the other way round, and " if self.reversed else ""
        return (
            f"the inspection of the {name} gear fits only where it {way}calls tooth {self.first} what is tooth 0 of "
            "the pair: it was taken so, and no physics is claimed for the difference; check how the sheet is numbered"
        )


def recounted(search: Search, begun: Kept) -> Recounted | None:
    """Count the sheet of an inspected gear of which several pitch errors are claimed in all other ways, and search on
    with the one that fits best, from the state ``begun`` before any claim, if that is better than all the claims."""
    for gear in (0, 1):
        mine = [one for one in search.model.claims if one.physics.name in PITCHES and one.place.gear == gear]
        if search.over or len(mine) < SEVERAL or not _listed(search.model.declared, gear):
            continue
        end, declared, scope = search.kept(), search.model.declared, search.model.scope
        search.step("counting the teeth of the inspection otherwise")
        search.restore(begun)
        first, back = _best(search, gear)
        file = _counted(declared, gear, _order(scope.gears[gear].z, first, back=back))
        search.model.declared, search.model.scope = file, replace(scope, file=file)
        try:
            search.settle()
            looked = search.run()
            better = search.gained(end) > BETTER
        except GearpolyError:
            better = False
        if better:
            return Recounted(gear=gear, first=first, reversed=back, looked=looked)
        search.model.declared, search.model.scope = declared, scope
        search.restore(end)
    return None


def _order(z: int, first: int, *, back: bool) -> IntArray:
    """Numbers (z,) on the sheet of the teeth 0, 1, ... of the pair."""
    return np.asarray((first + (-1 if back else 1) * np.arange(z)) % z)


def _best(search: Search, gear: int) -> tuple[int, bool]:
    """The count that fits best to first order: teeth as built are then expected where it has them."""
    built, system = search.model.as_built, search.linear.system
    z = search.model.scope.gears[gear].z
    fits: list[tuple[float, int, bool]] = []
    declared = gear_section(search.model.declared, gear)
    for first, back in ((k, back) for back in (False, True) for k in range(z) if k or back):
        file = _counted(search.model.declared, gear, _order(z, first, back=back))
        off = np.zeros(built.size)
        for flank in built.flanks:
            tail = "_coast_um" if flank == "coast" else "_um"
            for part, key in ((built.pitch, f"pitch{tail}"), (built.slope, f"profile_slope{tail}")):
                part(off, flank, gear)[:] = column(gear_section(file, gear), key) - column(declared, key)
        prior = system.prior.copy()
        prior[search.linear.layout.built] += off
        fits.append((replace(system, prior=prior).misfit, first, back))
    _, first, back = min(fits)
    return first, back


def _counted(file: PairFile, gear: int, order: IntArray) -> PairFile:
    """The pair file with the values per tooth of a gear's inspection in another ``order`` (z,)."""
    sheet = gear_section(file, gear).inspection
    keys = {name: tuple(np.asarray(value)[order].tolist()) for name, value in _listed(file, gear).items()}
    return on_gear(file, gear, inspection=changed(sheet, **keys))


def _listed(file: PairFile, gear: int) -> dict[str, Sequence[float]]:
    """What the inspection of a gear lists tooth by tooth, by its keys: nothing where nobody inspected it, or where all
    teeth have one value, and no count of them matters."""
    sheet = gear_section(file, gear).inspection
    held = {} if sheet is None else sheet.model_dump()
    return {name: value for name, value in held.items() if isinstance(value, (list, tuple))}
