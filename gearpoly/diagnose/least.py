"""What recordings tell only the least of: a tooth that has left the mesh may stand farther back as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.linear import out_of_mesh
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim

ALIKE_STATES_MISFIT = 1.0
"""Misfit (sum of squares over the noise) below which two states run alike: a tenth of what would count against one."""

BEYOND_LEAST = 1.1
"""Times the least that is stated, so that a small step from it says as little as one from where the fit ended."""

HALVINGS = 6
"""Halvings of the way to nothing in which the least is looked for: to a sixty-fourth of what a fit ended with."""


def runs_alike(search: Fit, claims: Sequence[Claim]) -> bool:
    """Whether the gears run with other ``claims`` as they do with those of the ``search``."""
    model = replace(search.model, claims=tuple(claims))
    try:
        after = model.residuals(model.scenes())
    except GearpolyError:
        return False
    both = zip(search.noises, search.model.residuals(search.scenes), after, strict=True)
    return sum(float(np.sum(noise.whitened(one - other) ** 2)) for noise, one, other in both) < ALIKE_STATES_MISFIT


def brought_to_least(search: Fit) -> Fit:
    """With every claim about a tooth that has left the mesh at the least size with which gears run as they do: a fit
    leaves it wherever its last step took it. Of 40 um by which a tooth stood back 304 were told."""
    claims = list(search.model.claims)
    for k, claim in enumerate(claims):
        if search.over or not out_of_mesh(search.model, search.scenes, claim):
            continue

        def sized(part: float, claim: Claim = claim) -> Claim:
            return replace(claim, values=(part * claim.values[0], *claim.values[1:]))

        low, high = 0.0, 1.0  # parts of the size
        for _ in range(HALVINGS):
            part = 0.5 * (low + high)
            alike = runs_alike(search, [*claims[:k], sized(part), *claims[k + 1 :]])
            low, high = (low, part) if alike else (part, high)
        claims[k] = sized(min(1.0, BEYOND_LEAST * high))
    if tuple(claims) == search.model.claims:
        return search
    there = search.believing(claims=tuple(claims))
    return replace(there, scenes=there.model.scenes()).linearised()
