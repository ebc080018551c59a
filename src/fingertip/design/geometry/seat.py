"""Seat of bone or core in the mold: the tape that seals it, and how far silicone creeps along it until it sets.

Reference of the flow: H. Schlichting, Boundary-Layer Theory, chapter 6 (creeping flow between parallel walls).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingertip.design.parameters import DesignTables

_RIM_MM = 0.5
"""Distance that the tape keeps from the skin, from the foot of the collar and from the end of the recess [mm]."""
_LEAST_GAP_MM = 0.01
"""Gap that is left above the tape, because printed surfaces are not smooth [mm]. An assumption."""


def tape_span_mm(design: DesignTables) -> tuple[float, float] | None:
    """Return where the tape around the seat begins and ends [mm below the skin]; None without one.

    It lies on the collar or on the base below it, where there is more room: it does not pass the foot of the collar.
    """
    collar, recess = design.bone.collar_length_mm, design.mold.recess_length_mm
    if design.mold.seat_tape_mm == 0.0:
        return None
    on_collar, on_base = (_RIM_MM, collar - _RIM_MM), (collar, recess - _RIM_MM)
    return max(on_collar, on_base, key=lambda span: span[1] - span[0])


def creep_mm(integral: float, gap_mm: float, tape_mm: float, span_mm: tuple[float, float] | None) -> float:
    """Compute how far silicone creeps into a gap, of which a tape narrows the part from its beginning on [mm].

    A flow q per width between plates at a distance h loses the pressure 12 mu q / h^3 per length. With x1 from the
    opening to the tape, h1 and h2 the gaps there and above the tape, and x2 the length crept along the tape,

        integral of p / mu over time = 6 (x1 / h1)^2 + 12 h2 x1 x2 / h1^3 + 6 (x2 / h2)^2,

    or 6 (x / h1)^2 where the silicone does not reach the tape.

    Parameters
    ----------
    integral
        Integral of pressure over viscosity over the time until the silicone sets [1].
    gap_mm
        Gap without tape [mm].
    tape_mm
        Thickness of the tape [mm].
    span_mm
        Beginning and end of the tape [mm]; None without tape.
    """
    free = gap_mm * math.sqrt(integral / 6.0)
    if span_mm is None or free <= span_mm[0]:
        return free
    x1, h1, h2 = span_mm[0], gap_mm, min(gap_mm, max(gap_mm - tape_mm, _LEAST_GAP_MM))
    # a x2^2 + b x2 = c, solved in the form that does not cancel.
    a, b, c = 6.0 / h2**2, 12.0 * h2 * x1 / h1**3, integral - 6.0 * (x1 / h1) ** 2
    return x1 + 2.0 * c / (b + math.sqrt(b * b + 4.0 * a * c))
