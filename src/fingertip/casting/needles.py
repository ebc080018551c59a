"""Blunt needles that fill the hole of the chaplet's screw from its bottom."""

from __future__ import annotations

_OUTER_MM = {14: 2.11, 16: 1.65, 18: 1.27, 20: 0.91, 22: 0.72}
"""Nominal outer diameters of needles by gauge [mm], as ISO 9626 gives them (unverified)."""
_PLAY_MM = 0.2
"""Least play of the needle in the hole: air must leave beside it [mm]. An assumption."""


def find_needle(hole_mm: float) -> dict[str, float] | None:
    """Find the thickest needle that enters a hole [mm]; None if none does."""
    fitting = [gauge for gauge, outer in _OUTER_MM.items() if outer <= hole_mm - _PLAY_MM + 1e-9]
    return {"gauge": min(fitting), "outer_mm": _OUTER_MM[min(fitting)]} if fitting else None
