"""What was used last is kept, up to a weight: the memory of a worker stays flat however long its sweep is."""

from __future__ import annotations

from collections import OrderedDict
from typing import Generic, TypeVar

K = TypeVar("K")
V = TypeVar("V")


class Memory(Generic[K, V]):
    """A mapping that forgets what was not used for longest."""

    def __init__(self, maximum: float) -> None:
        self.maximum = maximum
        """Weight that is kept."""
        self.weight = 0.0
        self._kept: OrderedDict[K, tuple[V, float]] = OrderedDict()

    def get(self, key: K) -> V | None:
        """What is kept under a key, if it still is."""
        found = self._kept.get(key)
        if found is None:
            return None
        self._kept.move_to_end(key)
        return found[0]

    def put(self, key: K, value: V, weight: float = 1.0) -> None:
        """Keep a value; the last one stays, whatever it weighs."""
        if key in self._kept:
            self.weight -= self._kept.pop(key)[1]
        self._kept[key] = value, weight
        self.weight += weight
        while self.weight > self.maximum and len(self._kept) > 1:
            self.weight -= self._kept.popitem(last=False)[1][1]

    def __len__(self) -> int:
        return len(self._kept)
