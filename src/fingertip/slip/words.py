"""What is said of a slip that was found, or was not."""

from __future__ import annotations


def verdict(delay_s: float | None) -> str:
    """How a delay reads [s]: None was missed, and below zero the detector was ON already."""
    if delay_s is None:
        return "missed"
    if delay_s < 0.0:
        return f"ON already, {round(-1000 * delay_s, 1):g} ms before"
    return f"found after {1000 * delay_s:.1f} ms"
