"""One claim more, fitted to its end with all else, where it stands."""

from __future__ import annotations

from collections.abc import Sequence

from gearpoly.diagnose.exchange import (
    alike_again,
    gained_since,
    promised_more,
    reshaped,
    set_back,
    swapped,
    without_idle,
)
from gearpoly.diagnose.fit import Fit, forgotten, joined, settled, shared
from gearpoly.diagnose.relaxed import relaxed
from gearpoly.diagnose.scan import Candidate, polished
from gearpoly.diagnose.softness import with_best_law, with_declared_law, with_declared_softness
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import order_of
from gearpoly.physics.base import Claim

GROWN = 10.0
"""Times that polishing a shape may make a size larger before that is doubted where it does not stand."""


def claimed(fit: Fit, best: Candidate, found: Sequence[Candidate]) -> Fit | None:
    """With the claim of the ``best`` candidate, or, where that does not stand and has grown while its shape was
    polished, of it ``found`` coarsely and grown less: of a pit as narrow as its walls, columns promise what no
    polygon shows. None where neither stands."""
    there = _standing(fit, best)
    if there is not None:
        return there
    coarse = next((one for one in found if one.claim.key == best.claim.key), None)
    if coarse is None or abs(best.claim.values[0]) <= GROWN * abs(coarse.claim.values[0]):
        return None
    return _standing(fit, polished(fit.model, fit.scenes, fit.linear, coarse, roughly=True, grown=GROWN))


def _standing(fit: Fit, one: Candidate) -> Fit | None:
    """With the claim of a candidate where that leaves the fit better: what was exchanged for it may have gone again,
    and left all worse. A pit that came to rest where it explains less than half of what it promises is of another
    shape."""
    there = accepted(fit, [one.claim])
    if there is None or gained_since(there, fit) <= 2.0 * promised_more(there, one.claim):
        return None
    return there


def accepted(fit: Fit, claims: Sequence[Claim]) -> Fit | None:
    """With ``claims`` and everything fitted again; None where they do not stand, or leave gears that cannot run. What
    was begun before time was over is fitted to its end: an undulation of 3 um was given up five seconds before it."""
    budget = fit.model.budget
    there = _accepted(fit.believing(budget=budget.further), claims)
    return None if there is None else there.believing(budget=budget)


def _accepted(fit: Fit, claims: Sequence[Claim]) -> Fit | None:
    try:
        there = settled(joined(fit, claims))
        single = all(one.place.tooth is not None for one in claims)
        if single and there.model.claims != tuple(claims) and gained_since(there, fit) < 0.0:
            return None  # neither law nor form mends what a single tooth has made worse
        if there.over:
            return None  # nobody knows what it would have been worth
        # A wave or a tooth moves neither the place where all pairs hand over nor how much teeth give.
        of_all = any(shows_in_laws(one) for one in claims)
        there = reshaped(relaxed(there), None if of_all else claims)
        if of_all:
            there = laws_anew(there)
        there = shared(there)
        if there.over:
            return None
        there = without_idle(there)
        if not {one.key for one in claims} <= {one.key for one in there.model.claims}:
            return None
        there = set_back(swapped(there))
        return forgotten(alike_again(there) if of_all else there)
    except GearpolyError:
        return None


def laws_anew(fit: Fit) -> Fit:
    """With how soft teeth are, and by which law they give, asked again."""
    return with_best_law(with_declared_law(with_declared_softness(fit)))


def shows_in_laws(claim: Claim) -> bool:
    """Whether another law of compliance may do what a claim does: what is the same at every mesh, or a mean. A single
    tooth or a wave of one is no law."""
    return claim.place.tooth is None and order_of(claim) is None
