"""What is said of a slip that was found, or was not."""

from __future__ import annotations

from fingertip.slip.intervals import INCIPIENT_S


def verdict(delay_s: float | None) -> str:
    """How a delay reads [s]: None was missed, and below zero the detector heard incipient slip, or was ON already."""
    if delay_s is None:
        return "missed"
    if -INCIPIENT_S <= delay_s < 0.0:
        return f"found {-1000 * delay_s:.1f} ms before, in incipient slip"
    if delay_s < 0.0:
        return f"ON already, {round(-1000 * delay_s, 1):g} ms before"
    return f"found after {1000 * delay_s:.1f} ms"
