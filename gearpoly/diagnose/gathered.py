"""What several claims of one slow physics say of several recordings, told as one: a rig drifts, each time by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.heldout import cross_validated
from gearpoly.diagnose.verdict import Finding, Rival
from gearpoly.physics.words import Reported


def gathered(search: Fit, findings: Sequence[tuple[int, Finding]], *, hold: list[int]) -> tuple[Finding, ...]:
    """The findings, each beside its claim's number, with those of one slow physics that are about some recordings each
    as one in the place of the first; ``hold`` are the parameters that no part of the recordings tells the other."""
    out: list[Finding] = []
    for k, one in findings:
        # What is said of all recordings at once, as an encoder's count is, stands by itself on each shaft.
        by_recording = one.claim.physics.slow and one.claim.place.recordings
        same = [(j, other) for j, other in findings if other.claim.physics is one.claim.physics]
        if not by_recording or len(same) == 1:
            out.append(one)
        elif same[0][0] == k:
            out.append(_as_one(search, same, hold))
    return tuple(out)


def _as_one(search: Fit, same: Sequence[tuple[int, Finding]], hold: list[int]) -> Finding:
    """Findings of one physics as the first of them, with what they gain and leave out together."""
    linear, layout, first = search.linear, search.linear.layout, same[0][1]
    mine = [place for k, _ in same for place in layout.places(k)]
    claims = tuple(one.claim for _, one in same)
    recordings = {k for claim in claims for k in claim.place.recordings}
    rivals: dict[tuple[object, ...], Rival] = {}
    for _, one in same:
        for rival in one.rivals:
            own = rival.claim.physics is first.claim.physics and recordings.issuperset(rival.claim.place.recordings)
            if not own:
                rivals.setdefault(rival.claim.key, rival)
    separations = [one.separation for _, one in same if one.separation is not None]
    return replace(
        first,
        parameters=_over_recordings(search, [k for k, _ in same], sorted(recordings)),
        gain=linear.without(mine).system.misfit - linear.system.misfit,
        probability=min(one.probability for _, one in same),
        unknown_probability=max(one.unknown_probability for _, one in same),
        without=cross_validated(
            linear,
            [one.fit for one in search.model.observed],
            leave=mine,
            hold=[place for place in hold if place not in mine],
        ),
        rivals=tuple(rivals.values()),
        separation=separations[0] if rivals and separations else None,
        together=claims,
    )


def _over_recordings(search: Fit, same: Sequence[int], recordings: Sequence[int]) -> Reported:
    """The parameters of the recording in which they are largest, and those of every recording by its number."""
    model, layout = search.model, search.linear.layout
    physics = model.claims[same[0]].physics
    out: list[tuple[int, Reported]] = []
    for k in recordings:
        mine = [j for j in same if k in model.claims[j].place.recordings]
        values = np.sum([model.claims[j].values for j in mine], axis=0)
        rows = [np.arange(search.linear.system.size)[layout.claims[j]] for j in mine]
        covariance = np.sum([search.linear.system.covariance[np.ix_(a, b)] for a in rows for b in rows], axis=0)
        out.append((k, physics.report(replace(model.claims[mine[0]].place, recordings=(k,)), values, covariance)))
    _, largest = max(out, key=lambda one: max(abs(value) for value, _ in one[1].values()))
    each = {f"recording_{k}_{name}": told for k, found in out for name, told in found.items()}
    return largest | each
