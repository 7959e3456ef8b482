"""What has been computed and may be asked for again: the contact of a rig is needed for its signal, its limit and its
rivals alike."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Hashable
from typing import Generic, TypeVar

import numpy as np

from gearpoly.proving.gears import FloatArray

T = TypeVar("T")


def digest(*values: FloatArray | float) -> bytes:
    """A key of arrays and numbers that differs where a bit of them does."""
    out = hashlib.blake2b(digest_size=16)
    for value in values:
        array = np.ascontiguousarray(value)
        out.update(repr(array.shape).encode())
        out.update(array.data)
    return out.digest()


class Memo(Generic[T]):
    """The latest answers, as many as fit into a number of bytes. An answer is a pure function of its key, so nothing
    hangs on what is kept but time."""

    def __init__(self, most: int) -> None:
        self.most, self.held = most, 0
        self._answers: OrderedDict[Hashable, tuple[T, int]] = OrderedDict()

    def get(self, key: Hashable) -> T | None:
        """The answer if it is still there."""
        found = self._answers.get(key)
        if found is None:
            return None
        self._answers.move_to_end(key)
        return found[0]

    def put(self, key: Hashable, answer: T, size: int) -> None:
        """Keep an answer of so many bytes; the oldest give way."""
        if key in self._answers:
            self.held -= self._answers.pop(key)[1]
        self._answers[key] = (answer, size)
        self.held += size
        while self.held > self.most and len(self._answers) > 1:
            self.held -= self._answers.popitem(last=False)[1][1]
