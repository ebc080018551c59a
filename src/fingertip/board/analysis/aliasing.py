"""Attenuation ahead of the analog-to-digital converter (ADC) of frequencies that alias.

Two poles cannot attenuate a full-scale tone to less than 1 LSB of 16 bits. The signal's content beyond the band,
noise and the skirt of a resonance, is small. `AliasAttenuation` gives the amplitude that a tone may have. A higher
sampling rate with subsequent averaging moves the aliases away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.response import RECTIFYING_DIODE, decibel
from fingertip.board.circuit import Circuit
from fingertip.board.nets import ADC_ENVELOPE, ADC_FILTERED, ADC_TACTILE, ENVELOPE, FILTERED, TACTILE
from fingertip.board.network import build_network
from fingertip.design import Design
from fingertip.design.amplifier_stages import BAND_CUTOFFS

_POINTS = 40


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
    filtered_gain: float | None
    """Largest gain from the tactile voltage to the pin of the filtered signal, in the band; None without such a pin."""
    filtered_alias_db: float | None
    """Level at `alias_hz` over the one at `band_hz`, from the tactile voltage to that pin: both appear at `band_hz`."""
    required_db: float
    """Attenuation that would reduce a tone with the peak `swing_v` to 1 LSB of the ADC."""
    swing_v: float
    """Largest peak of the filtered signal [V]."""
    one_lsb_tone_v: float
    """Amplitude [V] of a tone in the tactile voltage at `alias_hz` that is attenuated to 1 LSB."""
    lsb_v: float
    """Step of the ADC [V]: its least significant bit (LSB)."""


def compute_alias_attenuation(circuit: Circuit, design: Design, swing_v: float, has_diode: bool) -> AliasAttenuation:
    """Compute the attenuation ahead of a design's ADC.

    Parameters
    ----------
    circuit
        Circuit of its board.
    design
        Its cutoff, sampling rate and ADC.
    swing_v
        Largest peak of the filtered signal [V].
    has_diode
        Whether a bare diode precedes the envelope (variant article): its pole acts on falling voltages only.
    """
    detector = design.detector
    nyquist_hz = detector.sample_rate_hz / 2.0
    band_hz = min(BAND_CUTOFFS * design.board.cutoff_hz, nyquist_hz)
    alias_hz = detector.sample_rate_hz - band_hz
    lsb_v = detector.adc_step_v
    network, source = build_network(circuit, conducting=[RECTIFYING_DIODE]), ENVELOPE if has_diode else FILTERED

    def gains(source: str, pin: str, *f_hz: float) -> list[complex]:
        """Gains from a net to a pin at frequencies, over the constant gain."""
        path = network.drive(source).restrict(pin)
        constant, *values = path.response(np.array([0.0, *f_hz]), {source: 1.0}, pin)[:, 0].tolist()
        return [value / constant for value in values]

    tactile = gains(TACTILE, ADC_TACTILE, band_hz, nyquist_hz, alias_hz)
    envelope = gains(source, ADC_ENVELOPE, nyquist_hz, alias_hz)
    filtered_gain = filtered_alias_db = None
    if ADC_FILTERED in circuit.net_by_pin.values():
        f_hz = np.array([*np.geomspace(design.board.cutoff_hz, band_hz, _POINTS), alias_hz])
        path = network.drive(TACTILE).restrict(ADC_FILTERED)
        levels = np.abs(path.response(f_hz, {TACTILE: 1.0}, ADC_FILTERED)[:, 0])
        filtered_gain, filtered_alias_db = float(levels[:-1].max()), decibel(float(levels[-1] / levels[-2]))
    return AliasAttenuation(
        band_hz=band_hz,
        nyquist_hz=nyquist_hz,
        alias_hz=alias_hz,
        tactile_band_db=decibel(tactile[0]),
        tactile_nyquist_db=decibel(tactile[1]),
        tactile_alias_db=decibel(tactile[2]),
        envelope_nyquist_db=decibel(envelope[0]),
        envelope_alias_db=decibel(envelope[1]),
        filtered_gain=filtered_gain,
        filtered_alias_db=filtered_alias_db,
        required_db=decibel(swing_v / lsb_v),
        swing_v=swing_v,
        one_lsb_tone_v=lsb_v / abs(tactile[2]),
        lsb_v=lsb_v,
    )
