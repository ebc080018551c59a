"""Components between the board and the analog-to-digital converter (ADC): anti-aliasing poles for its sampling rate.

Frequencies above half the sampling rate alias to below it. The band of the vibrations ends at `BAND_CUTOFFS` cutoffs,
and the lowest frequency that aliases into it is the sampling rate less that. The tactile voltage passes two poles,
both near a quarter of the sampling rate: the second section has ten times the impedance of the first, so that they
hardly interact. The envelope has a pole of its own already (in variant `article` only for falling voltages), and
passes one.

`fingertip.board.analysis.aliasing` computes what they attenuate.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.components.capacitor_choice import nearest_capacitance
from fingertip.board.components.filter import pole_hz
from fingertip.board.components.preferred_values import nearest_value

POLE_PER_SAMPLE_RATE = 0.25
FIRST_OHM, SECOND_OHM = 1e3, 10e3
"""Approximate resistances. Together with the clamp they limit its current to 1 mA at 10 V beyond the rails."""
CLAMP, LOW_LEAKAGE_CLAMP = "BAT54S", "BAV199"
"""Clamps of the ADC pins. The second serves boards for a controller, whose outputs stay within the supply anyway."""
CLAMP_A, MAX_CLAMP_A = 0.1e-6, 2e-6
"""Reverse current of a clamp's diode [A]: the value of the SPICE deck's model, and the maximum of a BAT54 at 25 V and
25 degrees Celsius (its data sheets; unverified)."""
LOW_LEAKAGE_A, MAX_LOW_LEAKAGE_A = 3e-12, 5e-9
"""The same of a BAV199: typical, and maximum at 75 V and 25 degrees Celsius (its data sheets; unverified)."""


@dataclass(frozen=True)
class AdcInterface:
    """Preferred resistances [ohm] and capacitances [F] between the board's outputs and the ADC pins."""

    first_ohm: float
    first_f: float
    """First section, from the tactile voltage to the node between the sections."""
    second_ohm: float
    second_f: float
    """Second section, from the node between the sections to the tactile pin."""
    envelope_ohm: float
    envelope_f: float
    """Section from the envelope to its pin."""

    def by_reference(self) -> dict[str, float]:
        """Value of each component [ohm, F] by its reference designator."""
        return {
            "R7": self.envelope_ohm, "C8": self.envelope_f, "R8": self.first_ohm, "C9": self.first_f,
            "R9": self.second_ohm, "C19": self.second_f,
        }  # fmt: skip

    def filtered_by_reference(self) -> dict[str, float]:
        """Value of each component of the filtered signal's section, which equals the envelope's."""
        return {"R27": self.envelope_ohm, "C25": self.envelope_f}


def size_adc_interface(sample_rate_hz: float, series: str, capacitor_series: str = "given") -> AdcInterface:
    """Size the anti-aliasing poles for a sampling rate [Hz], with resistors and capacitors of these series."""
    target_hz = POLE_PER_SAMPLE_RATE * sample_rate_hz

    def size_section(approximate_ohm: float) -> tuple[float, float]:
        c_f = nearest_capacitance(pole_hz(approximate_ohm, target_hz), capacitor_series)  # 1 / (2 pi R f) is C
        return nearest_value(pole_hz(target_hz, c_f), series), c_f

    return AdcInterface(*size_section(FIRST_OHM), *size_section(SECOND_OHM), *size_section(SECOND_OHM))
