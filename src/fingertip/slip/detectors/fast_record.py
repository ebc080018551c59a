"""What an ON of `fast` is worth: how often one of its strength was slip on real signals.

`python -m benchmarks.slip.real FOLDER --record` writes the record, from slides and grasps of public
sets on which nothing was tuned (docs/slip_benchmark.md).
"""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from importlib import resources

RECORD = "fast_record.json"


@dataclass(frozen=True)
class Trust:
    """Record of the ON of one class of strength."""

    name: str
    least_ratio: float
    """Least ratio of statistic to threshold in the first `FastRecord.opening_s` of ON."""
    slides: int
    """ON that a real slide began."""
    others: int
    """ON that anything else began."""
    delay_s: tuple[float, float, float]
    """Time from the slide to ON: in 1, 5 and 9 of 10 cases at most [s]."""

    def describe(self) -> str:
        """Describe it as a sentence for people."""
        low_s, _, high_s = self.delay_s
        return (
            f"{self.name}: {self.slides} of {self.slides + self.others} such ON were slip on real "
            f"recordings of a BioTac, {1000 * low_s:.0f} to {1000 * high_s:.0f} ms after it began"
        )


@dataclass(frozen=True)
class FastRecord:
    """Record of all classes, the weakest first."""

    opening_s: float
    """Time from the begin of ON in which its strength is taken [s]."""
    classes: tuple[Trust, ...]

    def find(self, strength: float) -> Trust:
        """The record of ON of this strength; of the weakest class, of a weaker one."""
        found = [one for one in self.classes if strength >= one.least_ratio]
        return found[-1] if found else self.classes[0]


@functools.cache
def load_record() -> FastRecord:
    """Load the record of the package."""
    text = resources.files(__package__).joinpath(RECORD).read_text(encoding="utf-8")
    data = json.loads(text)
    classes = []
    for one in data["classes"]:
        low_ms, middle_ms, high_ms = one["delays_ms"]
        classes.append(
            Trust(
                name=one["class"],
                least_ratio=one["least_ratio"],
                slides=one["slides"],
                others=one["others"],
                delay_s=(low_ms / 1000, middle_ms / 1000, high_ms / 1000),
            )
        )

    return FastRecord(data["opening_ms"] / 1000, tuple(classes))
