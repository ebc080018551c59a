"""Progress of long work: a text with the share that is done and the time left.

A function that does long work takes a function of a text, `ReportProgress`. A `ShareText` is a text
with a number: a simple caller prints it, and a terminal draws a bar from it.
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
    """Message on progress: what is done now, and the share of the work that is done, from 0 to 1.

    Any other text that work reports is a note, which remains on the screen after the work.
    """

    label: str
    share: float

    def __new__(cls, label: str, share: float, elapsed_s: float = 0.0) -> ShareText:
        """Make a message with the share, and with the time left if it can be estimated."""
        message = super().__new__(cls, describe_share(label, share, elapsed_s))
        message.label = label
        message.share = min(1.0, max(0.0, share))

        return message


class Work:
    """Long work of several stages whose relative durations are known."""

    def __init__(
        self, name: str, stages: Mapping[str, float], progress: ReportProgress | None
    ) -> None:
        self._name = name
        self._stages = dict(stages)
        self._whole = sum(self._stages.values())
        self._progress = progress
        self._stage = self._detail = ""
        self._before = 0.0
        self._begun = time.monotonic()
        self._reported = -EVERY_S

    def begin(self, stage: str) -> None:
        """Report that a stage begins, and count all stages before it as done."""
        names = list(self._stages)
        self._before = sum(self._stages[name] for name in names[: names.index(stage)])
        self._stage = stage
        self._report(0.0, "")

    def within(self, stage: str) -> ReportProgress:
        """Begin a stage, and return the function to which its work reports its own progress."""
        self.begin(stage)

        def report(message: str) -> None:
            if isinstance(message, ShareText):
                self.advance(message.share, message.label)
            elif self._progress is not None:
                self._progress(message)

        return report

    def advance(self, share: float, detail: str = "") -> None:
        """Report the share of the current stage that is done, at most once in `EVERY_S`."""
        if detail != self._detail or time.monotonic() - self._reported >= EVERY_S:
            self._report(share, detail)

    def _report(self, share: float, detail: str) -> None:
        self._reported = time.monotonic()
        self._detail = detail
        if self._progress is not None:
            label = ": ".join(text for text in (self._name, detail or self._stage) if text)
            done = (self._before + share * self._stages[self._stage]) / self._whole
            self._progress(ShareText(label, done, self._reported - self._begun))


def describe_share(label: str, share: float, elapsed_s: float) -> str:
    """Describe the share of the work that is done and, where it can be estimated, the time left."""
    text = f"{label}: {100 * share:.0f} % done"
    if share < MIN_SHARE_FOR_ESTIMATE or not elapsed_s:
        return text

    return f"{text}, {format_duration(max(0.0, elapsed_s * (1 / share - 1)))} left"


def format_duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 100 * 60:
        return f"{seconds / 60:.0f} min"

    return f"{seconds / 3600:.1f} h"
