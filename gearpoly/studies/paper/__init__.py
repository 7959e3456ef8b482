"""The study of Liu, Shi, Cura and Mura (J. Cent. South Univ. 27, 2020, 3334-3349), asked again.

Each module that holds a ``QUESTION`` asks one thing of it: a new question is a new file and nothing else.
``python -m gearpoly.studies.paper --out docs`` asks all of them.
"""

from __future__ import annotations

import importlib
import pkgutil

from gearpoly.studies.paper.base import Question


def questions() -> tuple[Question, ...]:
    """All questions that there are, in the order in which the paper asks them."""
    modules = (
        importlib.import_module(f"{__name__}.{info.name}")
        for info in pkgutil.iter_modules(__path__)
        if info.name != "__main__"
    )
    found = [question for module in modules if isinstance(question := getattr(module, "QUESTION", None), Question)]
    return tuple(sorted(found, key=lambda question: question.order))
