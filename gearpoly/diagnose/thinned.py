"""The search on a part of the samples before all of them are looked at.

Every step of a search simulates and linearises all samples that it has. Which physics is missing far fewer tell, so of
long recordings a part proposes, and all of them weigh what it proposed and what only they tell.
"""

from __future__ import annotations

from dataclasses import replace

from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.search import finished, forward, run_search
from gearpoly.diagnose.shortened import in_state_of, sufficing
from gearpoly.errors import GearpolyError


def search_thinned_first(fit: Fit) -> tuple[Fit, list[Candidate]]:
    """As ``run_search``, but of long recordings on a part of their samples first."""
    part = None if fit.over else sufficing(fit.model, fit.foreign)
    if part is None:
        return run_search(fit)
    try:
        proposed, _ = run_search(Fit.begun(*part, fit.step))
        there = fit if not proposed.model.claims else _of_all_samples(fit, proposed)
    except GearpolyError:  # what a part proposes need not run, nor be settled, at all samples
        return run_search(fit)
    there, found, _ = forward(there)
    return finished(there, fit.linear.system.beyond), found


def _of_all_samples(fit: Fit, proposed: Fit) -> Fit:
    """What was ``proposed``, fitted to all samples of a ``fit``. Raises ``GearpolyError`` where gears cannot run so.

    Time that is over for the search is not over for this: a pitch error of 6 um, found on the part, was left 84 short
    of its least misfit by the one step that such a fit takes else, and unseen data refused it for that.
    """
    model = replace(in_state_of(fit.model, proposed.model), budget=fit.model.budget.further)
    return Fit.begun(model, fit.foreign, fit.step).believing(budget=fit.model.budget)
