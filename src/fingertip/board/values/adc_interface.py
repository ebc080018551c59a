"""Interface to the analog-to-digital converter (ADC): anti-aliasing poles for its sampling rate, and their attenuation.

Frequencies above half the sampling rate alias to below it. The band of the vibrations ends at `BAND_CUTOFFS` cutoffs,
and the lowest frequency that aliases into it is the sampling rate less that. The tactile voltage passes two poles,
both near a quarter of the sampling rate: the second section has ten times the impedance of the first, so that they
hardly interact. The envelope has a pole of its own already (in variant `article` only for falling voltages), and
passes one.

Two poles cannot attenuate a full-scale tone to less than 1 LSB of 16 bits. The signal's content beyond the band,
noise and the skirt of a resonance, is small. `AliasAttenuation` gives the amplitude that a tone may have. A higher
sampling rate with subsequent averaging moves the aliases away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.values.ideal_response import decibel, pole_hz
from fingertip.board.values.preferred_values import nearest_value
from fingertip.design.rules.board import BAND_CUTOFFS

POLE_PER_SAMPLE_RATE = 0.25
FIRST_OHM, SECOND_OHM = 1e3, 10e3
"""Approximate resistances. Together with the clamp they limit its current to 1 mA at 10 V beyond the rails."""
CAPACITOR_SERIES = "E6"
CLAMP_A, MAX_CLAMP_A = 0.1e-6, 2e-6
"""Reverse current of a clamp's diode [A]: the value of the SPICE deck's model, and the maximum of a BAT54 at 25 V and
25 degrees Celsius (its data sheets; unverified)."""


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

    def tactile_transfer(self, f_hz: float) -> complex:
        """Transfer function from the tactile voltage to its pin at f [Hz]."""
        s = 2j * math.pi * f_hz
        sum_s = self.first_ohm * (self.first_f + self.second_f) + self.second_ohm * self.second_f
        return 1.0 / (1.0 + s * sum_s + s * self.first_ohm * self.first_f * s * self.second_ohm * self.second_f)

    def envelope_transfer(self, f_hz: float) -> complex:
        """Transfer function from the envelope to its pin at f [Hz]."""
        return 1.0 / (1.0 + 1j * f_hz / pole_hz(self.envelope_ohm, self.envelope_f))


@dataclass(frozen=True)
class AliasAttenuation:
    """Attenuation of the frequencies that alias."""

    band_hz: float
    """Upper end of the vibrations' band."""
    nyquist_hz: float
    """Half the sampling rate."""
    alias_hz: float
    """Lowest frequency that aliases into the band: the sampling rate less `band_hz`."""
    tactile_band_db: float
    """Gain of the tactile voltage's two poles at `band_hz`."""
    tactile_nyquist_db: float
    tactile_alias_db: float
    envelope_nyquist_db: float
    """Gain from the rectifier (in variant article from the envelope) to the pin at `nyquist_hz`."""
    envelope_alias_db: float
    required_db: float
    """Attenuation that would reduce a tone of the board's full swing to 1 LSB of the ADC."""
    one_lsb_tone_v: float
    """Amplitude [V] of a tone in the tactile voltage at `alias_hz` that is attenuated to 1 LSB."""
    lsb_v: float
    """Step of the ADC [V]: its least significant bit (LSB)."""


def size_adc_interface(sample_rate_hz: float, series: str) -> AdcInterface:
    """Size the anti-aliasing poles for a sampling rate [Hz], with resistors of a series."""
    target_hz = POLE_PER_SAMPLE_RATE * sample_rate_hz

    def size_section(approximate_ohm: float) -> tuple[float, float]:
        c_f = nearest_value(pole_hz(approximate_ohm, target_hz), CAPACITOR_SERIES, 1e-12, 1e-3)  # 1 / (2 pi R f) is C
        return nearest_value(pole_hz(target_hz, c_f), series), c_f

    return AdcInterface(*size_section(FIRST_OHM), *size_section(SECOND_OHM), *size_section(SECOND_OHM))


def compute_alias_attenuation(
    interface: AdcInterface, sample_rate_hz: float, bits: int, range_v: float, cutoff_hz: float, swing_v: float,
    envelope_pole_hz: float | None,
) -> AliasAttenuation:  # fmt: skip
    """Compute the attenuation ahead of an ADC with a range of plus and minus `range_v` [V].

    Parameters
    ----------
    interface
        Resistances and capacitances ahead of the ADC.
    sample_rate_hz
        Sample rate of the ADC.
    bits
        Resolution of the ADC.
    range_v
        Range of the ADC, plus and minus.
    cutoff_hz
        Cutoff of the filter.
    swing_v
        Largest voltage the board outputs.
    envelope_pole_hz
        Pole of the envelope where it acts on rising voltages too; None for variant article, which has a diode there.
    """
    nyquist_hz = sample_rate_hz / 2.0
    band_hz = min(BAND_CUTOFFS * cutoff_hz, nyquist_hz)
    alias_hz = sample_rate_hz - band_hz
    lsb_v = 2.0 * range_v / 2**bits

    def envelope_db(f_hz: float) -> float:
        own = 1.0 if envelope_pole_hz is None else 1.0 / (1.0 + 1j * f_hz / envelope_pole_hz)
        return decibel(own * interface.envelope_transfer(f_hz))

    return AliasAttenuation(
        band_hz=band_hz,
        nyquist_hz=nyquist_hz,
        alias_hz=alias_hz,
        tactile_band_db=decibel(interface.tactile_transfer(band_hz)),
        tactile_nyquist_db=decibel(interface.tactile_transfer(nyquist_hz)),
        tactile_alias_db=decibel(interface.tactile_transfer(alias_hz)),
        envelope_nyquist_db=envelope_db(nyquist_hz),
        envelope_alias_db=envelope_db(alias_hz),
        required_db=decibel(swing_v / lsb_v),
        one_lsb_tone_v=lsb_v / abs(interface.tactile_transfer(alias_hz)),
        lsb_v=lsb_v,
    )
