"""Where the envelope rests behind a rectifier without dead zone: what its amplifiers' offsets leave there.

With offsets o1 (Sallen-Key stage), o2 (rectifier) and o3 (envelope) and nothing to rectify, the rectifier's positive
diode conducts where the offsets drive it, and then

    E = o1 (R16 / R15) (R6 / R17) - o2 (1 + R16 / R15) (R6 / R17) + o3 (1 + R6 / R17),

which is o1 - 2 o2 + 2 o3. Where it does not, R16 and R17 lie in series: E = o3 + (o3 - o2) R6 / (R16 + R17). So the
rest is off by up to five offsets upwards and by little more than one downwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.values.amplifiers import FINER_NAME, FINER_OFFSET_V, Amplifier

RECTIFIER_OHM = 10e3
"""Both resistors of the rectifier: gain -1."""
_CONDUCTING = (1.0, 2.0, 2.0)
"""How often the three offsets are in the envelope while the diode conducts, R15 = R16 and R6 = R17."""


@dataclass(frozen=True)
class Rest:
    """Where the envelope rests for its amplifiers' offsets, above where signals rest [V], at 25 degrees Celsius."""

    min_v: float
    max_v: float
    """All offsets at the worst ends of the grade that is bought."""
    typical_v: float
    """Offsets as data sheets call typical, added as what does not hang together."""
    finer_name: str
    """An amplifier of the same pins and reach with less offset."""
    max_finer_v: float
    """As `max_v`, with that one."""


def rest_of(amplifier: Amplifier, envelope_ohm: float) -> Rest:
    """The rest of a board with this amplifier and this R_LP [ohm]."""
    blocked = 1.0 + 2.0 * envelope_ohm / (RECTIFIER_OHM + envelope_ohm)
    worst = math.fsum(_CONDUCTING)
    return Rest(
        min_v=-blocked * amplifier.max_offset_v,
        max_v=worst * amplifier.max_offset_v,
        typical_v=math.hypot(*_CONDUCTING) * amplifier.offset_v,
        finer_name=FINER_NAME,
        max_finer_v=worst * FINER_OFFSET_V,
    )


def rest_line(rest: Rest, threshold_v: float) -> str:
    """Where the envelope rests, beside the threshold."""
    return (
        f"offsets of U1 and U3 let the envelope rest between {1e3 * rest.min_v:.1f} and {1e3 * rest.max_v:.1f} mV "
        f"(typically within {1e3 * rest.typical_v:.1f} mV; with {rest.finer_name} below {1e3 * rest.max_finer_v:.1f} "
        f"mV), and the threshold is {1e3 * threshold_v:g} mV: measure the rest and set the threshold above it"
    )
