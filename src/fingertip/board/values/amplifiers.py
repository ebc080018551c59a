"""What data sheets say of the amplifiers, and which stands on which board: the one source of their figures.

The article's TL082 stands on the board that is the article's, variant `article` on plus and minus 5 V. Its inputs end 3 V
above its negative rail (typically; the data sheet is sure of 4 V), and below, its output jumps up; an ordinary press
takes the second stage's input there. All others have the TLV2372, whose inputs and outputs reach both rails; it has the
same pins and takes 16 V of supply.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.circuit import Circuit, farads_or_ohms
from fingertip.board.values.bridge import GAIN_CONSTANT_OHM

BOLTZMANN_J_PER_K = 1.380649e-23
TEMPERATURE_K = 300.15
"""27 degrees Celsius, as in SPICE."""


@dataclass(frozen=True)
class Amplifier:
    """A type of operational amplifier."""

    noise_v: float
    """Density at the input [V/sqrt(Hz)], white."""
    offset_v: float
    """At the input, typical [V]."""
    max_offset_v: float
    """The same, at most at 25 degrees Celsius [V]; of the grade in `buy`."""
    output_from_rail_v: float
    """How far from its rails the output stops [V], typical, into 2 to 10 kohm."""
    units: dict[str, tuple[str, str, str]]
    """Letter -> non-inverting input, inverting input, output."""
    buy: str
    """What to order."""
    input_from_lower_v: tuple[float, float] = (0.0, 0.0)
    """How far above its lower rail an input must stay [V]: typical, and to be sure."""
    bandwidth_hz: float | None = None
    """Gain-bandwidth product; None: that of the design."""


PAPERS, OTHERS = "TL082", "TLV2372"
_DUAL = {"a": ("3", "2", "1"), "b": ("5", "6", "7")}

AMPLIFIERS = {
    PAPERS: Amplifier(18e-9, 3e-3, 3e-3, 1.5, _DUAL, "TL082BC", (3.0, 4.0)),
    OTHERS: Amplifier(39e-9, 2e-3, 4.5e-3, 0.1, _DUAL, "TLV2372"),
    "TLV2371DBV": Amplifier(39e-9, 2e-3, 4.5e-3, 0.1, {"": ("3", "4", "1")}, "TLV2371DBV", bandwidth_hz=3e6),
}
"""By the symbol's name. The TL082 without a grade may have 15 mV of offset, its BC 3."""

FINER_NAME, FINER_OFFSET_V = "OPA2197", 0.1e-3
"""A dual of the same pins and the same reach, with less offset: for boards that must not be measured first."""


def dual_amplifier(variant: str, supply: str) -> str:
    """Name in `AMPLIFIERS` of the dual amplifier in a board's filter and rectifier."""
    return PAPERS if (variant, supply) == ("article", "split") else OTHERS


AD623_NOISE_V = 35e-9
"""At the input [V/sqrt(Hz)]."""
AD623_OUTPUT_NOISE_V = 50e-9
"""At the output of a gain of 1, beside the input's [V/sqrt(Hz)]."""
AD623_OFFSET_V = 200e-6
AD623_BANDWIDTH_HZ = 800e3
"""Bandwidth at a gain of 1; it falls with the gain (10 kHz at 100 in the data sheet, a little above this rule)."""

GAIN_RESISTOR = "R14"
"""Between the gain pins of the bridge's amplifier."""

QUIET_NAME, QUIET_NOISE_V = "INA821", 7e-9
"""An instrumentation amplifier with less noise, for comparison; its pins are others than the AD623's."""


def bridge_gain(circuit: Circuit) -> float:
    """Gain of the bridge's amplifier, from the resistor between its gain pins."""
    return 1.0 + GAIN_CONSTANT_OHM / farads_or_ohms(circuit.part(GAIN_RESISTOR).value)
