"""Least-recently-used cache with a weight limit: a worker's memory stays constant however long the sweep is."""

from __future__ import annotations

from collections import OrderedDict
from typing import Generic, TypeVar

K = TypeVar("K")
V = TypeVar("V")


class LruCache(Generic[K, V]):
    """Mapping that evicts the least recently used entries once their total weight exceeds a limit."""

    def __init__(self, max_weight: float) -> None:
        self.max_weight = max_weight
        """Limit of the total weight."""
        self.weight = 0.0
        """Total weight of all entries."""
        self._entries: OrderedDict[K, tuple[V, float]] = OrderedDict()

    def get(self, key: K) -> V | None:
        """Look up a value; None if there is none or it was evicted."""
        entry = self._entries.get(key)
        if entry is None:
            return None
        self._entries.move_to_end(key)
        return entry[0]

    def put(self, key: K, value: V, weight: float = 1.0) -> None:
        """Store a value. The newest entry is never evicted, even if it alone exceeds the limit."""
        if key in self._entries:
            self.weight -= self._entries.pop(key)[1]
        self._entries[key] = value, weight
        self.weight += weight
        while self.weight > self.max_weight and len(self._entries) > 1:
            self.weight -= self._entries.popitem(last=False)[1][1]

    def __len__(self) -> int:
        return len(self._entries)
