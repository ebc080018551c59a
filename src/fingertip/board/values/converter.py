"""The way to the converter: poles ahead of it that follow from its rate, and what they keep from folding back.

What lies above half the rate comes back below it, and the vibrations (`BAND_CUTOFFS` cutoffs) are met first by what
lies at the rate less the band. The tactile voltage gets two poles, both near a quarter of the rate: the second section
has ten times the first's impedance, so that they hardly see each other. The envelope has a pole of its own already (in
variant `article` only for falling voltages), and gets one.

No two poles keep a tone of full size below a step of 16 bits; what is there beyond the band, noise and a resonance's
skirt, is small. `AliasFigures` says how large a tone may be. Sampling faster and averaging moves the fold away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.values.filters import decibel, pole_hz
from fingertip.board.values.preferred import nearest
from fingertip.design.board_rules import BAND_CUTOFFS

POLES_PER_RATE = 0.25
FIRST_OHM, SECOND_OHM = 1e3, 10e3
"""About; with the clamp they limit its current to 1 mA at 10 V beyond the rails."""
CAPACITORS = "E6"
CLAMP_A, MAX_CLAMP_A = 0.1e-6, 2e-6
"""Reverse current of a clamp's diode: that of the SPICE deck's model, and the most a BAT54 may have at 25 V and 25
degrees Celsius (its data sheets; unverified)."""


@dataclass(frozen=True)
class Converter:
    """Resistances [ohm] and capacitances [F] ahead of the converter, preferred values."""

    first_ohm: float
    first_f: float
    """From the tactile voltage to the middle."""
    second_ohm: float
    second_f: float
    """From the middle to the pin."""
    envelope_ohm: float
    envelope_f: float

    def raw(self, f_hz: float) -> complex:
        """From the tactile voltage to its pin, at f [Hz]."""
        s = 2j * math.pi * f_hz
        sum_s = self.first_ohm * (self.first_f + self.second_f) + self.second_ohm * self.second_f
        return 1.0 / (1.0 + s * sum_s + s * self.first_ohm * self.first_f * s * self.second_ohm * self.second_f)

    def enveloped(self, f_hz: float) -> complex:
        """From the envelope to its pin, at f [Hz]."""
        return 1.0 / (1.0 + 1j * f_hz / pole_hz(self.envelope_ohm, self.envelope_f))


@dataclass(frozen=True)
class AliasFigures:
    """What the way to the converter does to what would fold back."""

    band_hz: float
    """Upper end of the vibrations."""
    nyquist_hz: float
    alias_hz: float
    """Rate less the band: from here on it folds into the band."""
    raw_band_db: float
    raw_nyquist_db: float
    raw_alias_db: float
    """Gain of the tactile voltage's two poles at these."""
    envelope_nyquist_db: float
    envelope_alias_db: float
    """Gain from the rectifier (in variant article from the envelope) to the pin."""
    needed_db: float
    """Attenuation that would bring a tone of the board's full swing below one step of the converter."""
    hidden_v: float
    """A tone of this amplitude in the tactile voltage at `alias_hz` becomes one step [V]."""
    step_v: float


def fit_converter(sample_rate_hz: float, series: str) -> Converter:
    """Preferred values for a rate [Hz], the resistors of a series."""
    target_hz = POLES_PER_RATE * sample_rate_hz

    def section(about_ohm: float) -> tuple[float, float]:
        c_f = nearest(pole_hz(about_ohm, target_hz), CAPACITORS, 1e-12, 1e-3)  # 1 / (2 pi R f) is C
        return nearest(pole_hz(target_hz, c_f), series), c_f

    return Converter(*section(FIRST_OHM), *section(SECOND_OHM), *section(SECOND_OHM))


def alias_figures(
    converter: Converter, sample_rate_hz: float, bits: int, range_v: float, cutoff_hz: float, swing_v: float,
    envelope_pole_hz: float | None,
) -> AliasFigures:  # fmt: skip
    """The figures of a converter of plus and minus `range_v` [V].

    Parameters
    ----------
    swing_v
        Largest voltage the board gives.
    envelope_pole_hz
        The envelope's own pole where it is one for rising voltages too; None: variant article's diode.
    """
    nyquist_hz = sample_rate_hz / 2.0
    band_hz = min(BAND_CUTOFFS * cutoff_hz, nyquist_hz)
    alias_hz = sample_rate_hz - band_hz
    step_v = 2.0 * range_v / 2**bits

    def enveloped_db(f_hz: float) -> float:
        own = 1.0 if envelope_pole_hz is None else 1.0 / (1.0 + 1j * f_hz / envelope_pole_hz)
        return decibel(own * converter.enveloped(f_hz))

    return AliasFigures(
        band_hz=band_hz,
        nyquist_hz=nyquist_hz,
        alias_hz=alias_hz,
        raw_band_db=decibel(converter.raw(band_hz)),
        raw_nyquist_db=decibel(converter.raw(nyquist_hz)),
        raw_alias_db=decibel(converter.raw(alias_hz)),
        envelope_nyquist_db=enveloped_db(nyquist_hz),
        envelope_alias_db=enveloped_db(alias_hz),
        needed_db=decibel(swing_v / step_v),
        hidden_v=step_v / abs(converter.raw(alias_hz)),
        step_v=step_v,
    )
