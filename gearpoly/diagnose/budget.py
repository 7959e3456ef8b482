"""How long a diagnosis may look, and how long it has: every stage asks, and ends with what there is."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

WEIGHING_OVER_SEARCH = 4.0 / 3.0
"""By how much longer what was found is weighed than was searched: a name is given only where its look-alikes and an
unknown cause were fitted to their ends beside it."""

USUAL_WORK_S = 70.0
"""Seconds of work after which a diagnosis looks no further by itself: weighing takes a third as long again at most,
telling up to 25 s where teeth are printed, so that nobody waits longer than two minutes."""

Step = Callable[[str], None]

Reached = Callable[[int, int], None]
"""Called with the stages that are done, and with how many there are."""

STAGES = ("compare", "prepare", "search", "rivals", "leftovers")
"""The stages of every diagnosis; between rivals, the next recording is thought of."""


def _now() -> tuple[float, float]:
    """Seconds by the clock, and of this process' own work."""
    return time.monotonic(), time.process_time()


@dataclass(frozen=True, kw_only=True)
class Budget:
    """So many ``seconds``, from ``begun`` on. Time in which the machine works for others does not count: a verdict is
    not to depend on what else runs. ``prolonged``: they are longer already than was searched."""

    seconds: float = math.inf
    begun: tuple[float, float] = field(default_factory=_now)
    prolonged: bool = False

    @property
    def over(self) -> bool:
        """Whether the time is over; where it never is, a diagnosis depends on its files alone."""
        return self.past(1.0)

    def past(self, part: float) -> bool:
        """Whether more than this part of the time is over."""
        spent = min(b - a for a, b in zip(self.begun, _now(), strict=True))
        return self.seconds < math.inf and spent > part * self.seconds

    @property
    def further(self) -> Budget:
        """The same with as much longer as weighing takes what was found; itself where it has that already."""
        return self if self.prolonged else replace(self, seconds=WEIGHING_OVER_SEARCH * self.seconds, prolonged=True)

    @property
    def says(self) -> str:
        """A word about a search that did not come to its end."""
        return (
            f"the search was stopped after {self.seconds:g} s of work: this is what was found till then, and more may "
            "be missing; give it longer with --within SECONDS, or shorter recordings"
        )


class Watch:
    """Tells the user what is done, and remembers how long each stage took."""

    def __init__(self, step: Step, reached: Reached) -> None:
        self._reached = reached
        self._step, self._stage, self._since = step, "", time.perf_counter()
        self._spent: dict[str, float] = {}

    def stage(self, name: str) -> Step:
        """A step function for the stage ``name``, which begins now."""
        self._close()
        self._stage = name
        if name in STAGES:
            self._reached(STAGES.index(name), len(STAGES))
        return self._step

    def _close(self) -> None:
        now = time.perf_counter()
        if self._stage:
            self._spent[self._stage] = self._spent.get(self._stage, 0.0) + now - self._since
        self._since = now

    def seconds(self) -> tuple[tuple[str, float], ...]:
        """Seconds spent in every stage."""
        self._close()
        return tuple(self._spent.items())
