"""Progress of long simulations."""

from __future__ import annotations

import time

from fingertip.progress import ReportProgress, ShareText, describe_share

LONG_S = 15.0
"""Duration above which a simulation reports its progress [s]."""
_EVERY_S = 1.0
"""Time between two reports [s]."""


class ShareDone:
    """Reports the share of a simulation that is done, and the time left.

    Parameters
    ----------
    name
        Name of the simulation.
    duration_s
        Simulated time in all [s].
    progress
        Receives the messages; None: nobody does.
    """

    def __init__(self, name: str, duration_s: float, progress: ReportProgress | None) -> None:
        self._duration_s = duration_s
        self._progress = progress if duration_s > LONG_S else None
        self._begun = self._reported = time.monotonic()
        if self._progress:
            self._progress(f"{name}, {duration_s:.1f} s:")

    def report(self, simulated_s: float) -> None:
        """Report that so much has been simulated, if the last report is some time ago."""
        now = time.monotonic()
        if not self._progress or now - self._reported < _EVERY_S:
            return
        self._reported = now
        share = simulated_s / self._duration_s
        self._progress(ShareText(describe_share("simulating", share, now - self._begun), share))
