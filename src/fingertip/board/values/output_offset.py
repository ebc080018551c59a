"""Envelope offset: the output offset after a precision rectifier, due to the offset voltages of the amplifiers.

Without a signal, with offsets o1 (Sallen-Key stage), o2 (rectifier) and o3 (envelope), and with the rectifier's
positive diode driven into conduction by them, the envelope is

    E = o1 (R16 / R15) (R6 / R17) - o2 (1 + R16 / R15) (R6 / R17) + o3 (1 + R6 / R17),

that is o1 - 2 o2 + 2 o3. With the diode blocking, R16 and R17 lie in series: E = o3 + (o3 - o2) R6 / (R16 + R17). The
envelope offset is therefore at most five offset voltages upwards, and little more than one downwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.values.amplifiers import LOW_OFFSET_NAME, LOW_OFFSET_V, Amplifier

RECTIFIER_OHM = 10e3
"""Both resistors of the rectifier: gain -1."""
_CONDUCTING_GAINS = (1.0, 2.0, 2.0)
"""Gains of the three offsets while the diode conducts, for R15 = R16 and R6 = R17."""


@dataclass(frozen=True)
class OutputOffset:
    """Envelope offset above signal ground [V] due to the amplifiers' offsets, at 25 degrees Celsius."""

    min_v: float
    """Minimum for the worst offsets of the purchased grade."""
    max_v: float
    """Maximum for the worst offsets of the purchased grade."""
    typical_v: float
    """Root sum of squares for the typical offsets of the data sheets, which are independent."""
    low_offset_amplifier: str
    """Pin-compatible amplifier with rail-to-rail inputs and outputs and less offset."""
    max_low_offset_v: float
    """Maximum with that amplifier."""


def compute_output_offset(amplifier: Amplifier, envelope_ohm: float) -> OutputOffset:
    """Compute the envelope offset of a board with this amplifier and this R_LP [ohm]."""
    blocked_gain = 1.0 + 2.0 * envelope_ohm / (RECTIFIER_OHM + envelope_ohm)
    worst_gain = math.fsum(_CONDUCTING_GAINS)
    return OutputOffset(
        min_v=-blocked_gain * amplifier.max_offset_v,
        max_v=worst_gain * amplifier.max_offset_v,
        typical_v=math.hypot(*_CONDUCTING_GAINS) * amplifier.offset_v,
        low_offset_amplifier=LOW_OFFSET_NAME,
        max_low_offset_v=worst_gain * LOW_OFFSET_V,
    )


def describe_output_offset(offset: OutputOffset, threshold_v: float) -> str:
    """Describe the envelope offset in relation to the threshold."""
    return (
        f"offsets of U1 and U3 cause an envelope offset between {1e3 * offset.min_v:.1f} and "
        f"{1e3 * offset.max_v:.1f} mV (typical offsets: {1e3 * offset.typical_v:.1f} mV; with "
        f"{offset.low_offset_amplifier} below {1e3 * offset.max_low_offset_v:.1f} mV), and the threshold is "
        f"{1e3 * threshold_v:g} mV: measure the envelope offset and add it to the threshold"
    )
