"""What data sheets say of the amplifiers, typically: noise, offset, bandwidth; and their pins."""

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
    units: dict[str, tuple[str, str, str]]
    """Letter -> non-inverting input, inverting input, output."""
    bandwidth_hz: float | None = None
    """Gain-bandwidth product; None: that of the design."""


_DUAL = {"a": ("3", "2", "1"), "b": ("5", "6", "7")}

AMPLIFIERS = {
    "TL082": Amplifier(18e-9, 3e-3, _DUAL),
    "TLV2372": Amplifier(39e-9, 2e-3, _DUAL),
    "TLV2371DBV": Amplifier(39e-9, 2e-3, {"": ("3", "4", "1")}, 3e6),
}
"""By the symbol's name; the TL082's figures are of its B version where it has one."""

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
