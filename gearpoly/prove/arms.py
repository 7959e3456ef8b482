"""Controls and ablations: which cases are diagnosed once more, and in what way otherwise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gearpoly.prove.diagnoser import How
from gearpoly.proving.entry import CaseEntry

PLAIN_ARM = "plain"
"""The arm of the proof itself."""

CASES_PER_ARM = 16
"""Cases per arm: a rate of one half is then known to a quarter, and five arms cost a fifth of the ground."""


@dataclass(frozen=True, kw_only=True)
class Arm:
    """One control or ablation over part of a ground: ``text`` what is done otherwise, ``how`` by case."""

    key: str
    text: str
    how: dict[int, How]


def arms(entries: Sequence[CaseEntry]) -> list[Arm]:
    """The arms of a full ground, chosen by its plan alone."""

    def some(wanted: Callable[[CaseEntry], bool], most: int = CASES_PER_ARM) -> list[int]:
        return [e.index for e in sorted(entries, key=lambda e: (e.klass, e.variant)) if wanted(e)][:most]

    def large(e: CaseEntry) -> bool:
        return e.klass == "single" and e.over >= 7.0

    def loaded(e: CaseEntry) -> bool:
        return e.klass == "cancelling" or (e.klass == "masked" and e.physics[0] == "crack_under_pitch")

    coloured = some(lambda e: e.klass == "false_alarm", CASES_PER_ARM // 2)
    hidden = some(lambda e: e.klass == "masked" and e.physics[0] == "relief_under_eccentricity", CASES_PER_ARM // 3)
    singles = some(large, CASES_PER_ARM // 2)
    load = some(loaded, CASES_PER_ARM // 2) + some(
        lambda e: large(e) and e.physics[0] in ("tooth_crack", "misalignment", "friction", "shaft_windup"),
        CASES_PER_ARM // 2,
    )
    return [
        Arm(
            key="struck",
            text="control: the true physics struck from the catalogue",
            how={k: How(without=entries[k].physics, hurried=True) for k in some(large)},
        ),
        Arm(
            key="known_wrong",
            text="control: Young's modulus, declared eccentricities and reliefs wrong by 5 %",
            how=dict.fromkeys(coloured + singles, How(wrong=True, hurried=True)),
        ),
        Arm(
            key="no_whitening",
            text="ablation: noise taken for white",
            how=dict.fromkeys(coloured + singles, How(whiten=False, hurried=True)),
        ),
        Arm(
            key="no_exact",
            text="ablation: large eccentricities to first order only",
            how=dict.fromkeys(coloured + hidden, How(exact=False, hurried=True)),
        ),
        Arm(
            key="one_torque",
            text="ablation: recordings of the highest torque only",
            how=dict.fromkeys(load, How(one_torque=True, hurried=True)),
        ),
    ]
