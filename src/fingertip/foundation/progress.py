"""Progress of long work: the share that is done and the time left, as text that carries both.

Whoever does long work takes a function of a text, `ReportProgress`. A `ShareText` is such a text, so that a caller who
knows nothing of shares prints it, and a terminal can draw a bar from it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

ReportProgress = Callable[[str], None]

MIN_SHARE_FOR_ESTIMATE = 0.02
"""Share from which the time left is estimated."""
EVERY_S = 1.0
"""Smallest time between two reports on the same stage [s]."""


class ShareText(str):
    """Message on progress that knows the share of the work that is done, from 0 to 1."""

    share: float

    def __new__(cls, text: str, share: float) -> ShareText:
        """Make a message with the share that is done."""
        made = super().__new__(cls, text)
        made.share = min(1.0, max(0.0, share))
        return made


class Work:
    """Long work of several stages whose relative durations are known."""

    def __init__(self, name: str, stages: Mapping[str, float], progress: ReportProgress | None) -> None:
        self._name = name
        self._stages = dict(stages)
        self._whole = sum(self._stages.values())
        self._progress = progress
        self._stage = ""
        self._before = 0.0
        self._begun = time.monotonic()
        self._reported = -EVERY_S

    def begin(self, stage: str) -> None:
        """Report that a stage begins, and count all stages before it as done."""
        names = list(self._stages)
        self._before = sum(self._stages[name] for name in names[: names.index(stage)])
        self._stage = stage
        self._report(self._before / self._whole)

    def advance(self, share: float) -> None:
        """Report the share of the current stage that is done, unless the last report was a moment ago."""
        if time.monotonic() - self._reported >= EVERY_S:
            self._report((self._before + share * self._stages[self._stage]) / self._whole)

    def _report(self, share: float) -> None:
        self._reported = time.monotonic()
        if self._progress is None:
            return
        label = ": ".join(text for text in (self._name, self._stage) if text)
        self._progress(ShareText(describe_share(label, share, self._reported - self._begun), share))


def describe_share(label: str, share: float, elapsed_s: float) -> str:
    """Describe the share of the work that is done and, where it can be estimated, the time left."""
    text = f"{label}: {100 * share:.0f} % done"
    if share < MIN_SHARE_FOR_ESTIMATE:
        return text
    return f"{text}, {format_duration(max(0.0, elapsed_s * (1 / share - 1)))} left"


def format_duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 100 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
