"""Data-sheet values of the amplifiers, and the amplifier of each board. No other module repeats these values.

The article's TL082 is used on the article's own board, variant `article` on plus and minus 5 V. Its common-mode input
range ends 3 V above the negative rail (typical; the data sheet guarantees 4 V), and below that its output reverses its
phase and jumps up. A fast press or a knock takes the second stage's input there. All other boards have the TLV2372,
which has rail-to-rail inputs and outputs, the same pins, and a maximum supply of 16 V.
"""

from __future__ import annotations

from dataclasses import dataclass

BOLTZMANN_J_PER_K = 1.380649e-23
TEMPERATURE_K = 300.15
"""Temperature: 27 degrees Celsius, as in SPICE."""


@dataclass(frozen=True)
class Amplifier:
    """Type of operational amplifier."""

    noise_v: float
    """White noise density at the input [V/sqrt(Hz)]."""
    offset_v: float
    """Typical input offset voltage [V]."""
    max_offset_v: float
    """Maximum input offset voltage at 25 degrees Celsius [V], for the grade in `order_name`."""
    output_from_rail_v: float
    """Distance from the rails at which the output stops [V], typical, into a light load (10 kohm)."""
    units: dict[str, tuple[str, str, str]]
    """Unit letter -> pins of non-inverting input, inverting input and output."""
    order_name: str
    """Name to order, with the grade."""
    input_from_lower_v: tuple[float, float] = (0.0, 0.0)
    """Distance from the lower rail that the inputs must keep [V]: typical and guaranteed."""
    bandwidth_hz: float | None = None
    """Gain-bandwidth product [Hz]; None: that of the design."""
    input_f: float = 8e-12
    """Capacitance of each input to ground [F]: the TLV2372's; assumed for the TL082, which states none; unverified."""


OPEN_LOOP_GAIN = 2e5
"""Open-loop gain A0 of the TL082 (typical, its data sheet): 106 dB. The TLV2372's 110 dB give the same response."""

ARTICLE_AMPLIFIER, RAIL_TO_RAIL_AMPLIFIER = "TL082", "TLV2372"
_DUAL = {"a": ("3", "2", "1"), "b": ("5", "6", "7")}

AMPLIFIERS = {
    ARTICLE_AMPLIFIER: Amplifier(18e-9, 3e-3, 3e-3, 1.5, _DUAL, "TL082BC", (3.0, 4.0)),
    RAIL_TO_RAIL_AMPLIFIER: Amplifier(39e-9, 2e-3, 4.5e-3, 0.1, _DUAL, "TLV2372"),
    "TLV2371DBV": Amplifier(39e-9, 2e-3, 4.5e-3, 0.1, {"": ("3", "4", "1")}, "TLV2371DBV", bandwidth_hz=3e6),
}
"""Amplifiers by the name of their symbol. The TL082 without a grade may have 15 mV of offset, the grade BC 3 mV."""

LOW_OFFSET_NAME, LOW_OFFSET_V = "OPA2197", 0.1e-3
"""Pin-compatible dual rail-to-rail amplifier with less offset [V], for boards without calibration."""


def select_dual_amplifier(variant: str, supply: str) -> str:
    """Select the dual amplifier of a board's filter and rectifier, by its name in `AMPLIFIERS`."""
    return ARTICLE_AMPLIFIER if (variant, supply) == ("article", "split") else RAIL_TO_RAIL_AMPLIFIER


AD623_NOISE_V = 35e-9
"""Noise density at the input [V/sqrt(Hz)]."""
AD623_OUTPUT_NOISE_V = 50e-9
"""Noise density at the output in addition to the input's, for a gain of 1 [V/sqrt(Hz)]."""
AD623_OFFSET_V = 200e-6
"""Typical input offset voltage [V]."""
AD623_BANDWIDTH_HZ = 800e3
"""Bandwidth for a gain of 1 [Hz]. It falls with the gain; the data sheet has 10 kHz for 100, slightly above that."""

GAIN_RESISTOR = "R14"
"""Resistor between the gain pins of the bridge's amplifier."""

LOW_NOISE_NAME, LOW_NOISE_V = "INA821", 7e-9
"""Instrumentation amplifier with a lower noise density [V/sqrt(Hz)], for comparison.

It has another footprint and pinout, and another gain equation, so that it requires another R14.
"""
