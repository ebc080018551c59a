"""Tolerances of printed sizes: general ones, and those that follow from a fit of the design."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.threads import MAX_TRAP_RATIO, Thread

GENERAL = "ISO 2768-m"
"""Name of the general tolerances."""
_GENERAL_MM = ((6.0, 0.1), (30.0, 0.2), (120.0, 0.3), (400.0, 0.5))
"""Largest nominal size and its permissible deviation, class m of ISO 2768-1. Its first class begins at 0.5 mm."""
_SHARE = 0.5
"""Share of a clearance that a tolerance may take. An assumption."""
MIN_TOLERANCE_MM = 0.05
"""Least deviation that calipers tell apart on a print [mm]. An assumption: they are accurate to some 0.03 mm."""
FIT = "fit, try"
"""Text in place of a tolerance that calipers cannot check."""


@dataclass(frozen=True)
class Tolerance:
    """Permissible deviations from the nominal size [mm]."""

    low: float
    high: float

    def text(self) -> str:
        """Write the deviations as on a drawing; a fit is tried where calipers cannot check them."""
        if self.high - self.low < 2.0 * MIN_TOLERANCE_MM - 1e-9:
            return FIT
        if round(self.high + self.low, 2) == 0.0:
            return f"±{_deviation_text(self.high)}"
        upper, lower = (_deviation_text(d, "+" if d > 0.0 else "-") for d in (self.high, self.low))
        return f"{upper}/{lower}"


def size_text(value: float) -> str:
    """Write a size to a hundredth of a millimetre."""
    return f"{round(value, 2) + 0.0:g}"


def _deviation_text(deviation: float, sign: str = "") -> str:
    """Write a deviation; what a hundredth cannot express is left out, so that the tolerance is never wider."""
    hundredths = math.floor(abs(deviation) * 100.0 + 1e-6)
    return f"{sign if hundredths else ''}{hundredths / 100.0:g}"


def symmetric(deviation: float) -> Tolerance:
    """Create a tolerance that is equal on both sides."""
    return Tolerance(-deviation, deviation)


def general(size: float) -> Tolerance:
    """Look up the general tolerance of a size [mm]."""
    return symmetric(next((deviation for limit, deviation in _GENERAL_MM if size <= limit), _GENERAL_MM[-1][1]))


def located(design: Design, size: float) -> Tolerance:
    """Tolerance of a size between two surfaces that locate bone or core: the play in the mold counts on it."""
    error = 2.0 * design.printer.surface_error_mm
    return symmetric(max(error, MIN_TOLERANCE_MM)) if error else general(size)


def clearance(gap: float) -> Tolerance:
    """Tolerance of a size that leaves a `gap` [mm] in the print to its counterpart, of which half must be left."""
    return symmetric(_SHARE * max(gap, 0.0))


def shared_clearance(gap: float) -> Tolerance:
    """Tolerance of a size if its counterpart is printed too and takes as much of the `gap` [mm] in the print."""
    return clearance(gap / 2.0)


def bore(design: Design) -> Tolerance:
    """Tolerance of a bore that is reamed to its pin: never wider than the print's error on both sides."""
    return Tolerance(-2.0 * design.printer.surface_error_mm, 0.0) if design.printer.surface_error_mm else symmetric(0.1)


def nut_trap(thread: Thread, width: float) -> Tolerance:
    """Tolerance of a trap's width: the nut goes in, and does not turn."""
    return Tolerance(thread.nut_flats_mm - width, MAX_TRAP_RATIO * thread.nut_flats_mm - width)
