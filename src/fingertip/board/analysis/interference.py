"""Attenuation ahead of the analog-to-digital converter (ADC) of frequencies that alias.

Two poles cannot attenuate a full-scale tone to less than 1 LSB of 16 bits. The signal's content beyond the band,
noise and the skirt of a resonance, is small. `AliasAttenuation` gives the amplitude that a tone may have. A higher
sampling rate with subsequent averaging moves the aliases away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.response import RECTIFYING_DIODE, decibel, find_envelope_pin, find_rectifier
from fingertip.board.circuits.network import build_network
from fingertip.board.components.bridge import MAX_FORCE_N, sensor_conductance_s
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE, ENVELOPE, FILTERED, TACTILE, VCC, VMID
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import BAND_CUTOFFS

_POINTS = 40


@dataclass(frozen=True)
class AliasAttenuation:
    band_hz: float
    """Upper end of the vibrations' band."""
    nyquist_hz: float
    alias_hz: float
    """Lowest frequency that aliases into the band: the sampling rate less `band_hz`."""
    tactile_band_db: float
    """Gain of the tactile voltage's two poles at `band_hz`."""
    tactile_nyquist_db: float
    tactile_alias_db: float
    output_nyquist_db: float
    """Gain from the rectifier (in variant article from the envelope) to the pin at `nyquist_hz`; on a board without an
    envelope that from the filtered signal to its pin."""
    output_alias_db: float
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


def compute_alias_attenuation(circuit: Circuit, design: Design, swing_v: float) -> AliasAttenuation:
    detector = design.detector
    nyquist_hz = detector.sample_rate_hz / 2.0
    band_hz = min(BAND_CUTOFFS * design.board.cutoff_hz, nyquist_hz)
    alias_hz = detector.sample_rate_hz - band_hz
    lsb_v = detector.adc_step_v
    rectifier, network = find_rectifier(circuit), build_network(circuit, conducting=[RECTIFYING_DIODE])
    source, pin = ENVELOPE if rectifier == "diode" else FILTERED, find_envelope_pin(circuit)

    def gains(source: str, pin: str, *f_hz: float) -> list[complex]:
        """Gains from a net to a pin at frequencies, over the constant gain."""
        path = network.drive(source).restrict(pin)
        constant, *values = path.response(np.array([0.0, *f_hz]), {source: 1.0}, pin)[:, 0].tolist()
        return [value / constant for value in values]

    tactile = gains(TACTILE, ADC_TACTILE, band_hz, nyquist_hz, alias_hz)
    envelope = gains(source, pin, nyquist_hz, alias_hz)
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
        output_nyquist_db=decibel(envelope[0]),
        output_alias_db=decibel(envelope[1]),
        filtered_gain=filtered_gain,
        filtered_alias_db=filtered_alias_db,
        required_db=decibel(swing_v / lsb_v),
        swing_v=swing_v,
        one_lsb_tone_v=lsb_v / abs(tactile[2]),
        lsb_v=lsb_v,
    )


# Effect of ripple on the supply.
#
# A bridge that is connected to the supply follows it: the tactile voltage by its own ratio to the supply, and by a
# little more where C7 delays the sensor's arm against the other one. On a board for 3.3 V only what remains of the
# ripple in VMID and in the sensor's bias counts. The filter amplifies ripple in its passband like slip. Variant article
# has no low-pass: there ripple of some kilohertz, as a switching converter has it, is amplified most.

DEAD_ZONE_V = 0.45
"""Voltage at which variant article's diode starts to conduct. Its output is zero below it."""
_MAX_LOW_HZ, RIPPLE_END_HZ = 30.0, 100e3
"""Lower end of the band in which supply ripple counts, at most, and upper end: mains, harmonics, converters [Hz]."""
_FREQUENCIES_PER_DECADE = 28


@dataclass(frozen=True)
class SupplyRipple:
    """Effect of ripple on the positive supply in the worst case of the sensor."""

    low_hz: float
    high_hz: float
    """Ends of the band that is searched: half the cutoff, at most 30 Hz, and 100 kHz."""
    worst_hz: float
    gain: float
    """Largest gain from the supply to the filtered signal in this band [V/V]."""
    max_v: float
    """Peak of the ripple [V] that alone brings the envelope's mean to the detector's threshold, or in variant article
    makes the diode conduct."""
    force_n: float = 0.0
    """Force on the sensor in the worst case [N]; 0: it is open, as always where the supply feeds the bridge."""


def compute_supply_ripple(
    circuit: Circuit,
    gain_bandwidth_hz: float,
    cutoff_hz: float,
    signal_ground: str,
    threshold_v: float,
    envelope_gain: float | None,
) -> SupplyRipple:
    band_hz = min(_MAX_LOW_HZ, cutoff_hz / 2.0), RIPPLE_END_HZ
    # A transimpedance stage amplifies what is left in its bias, the more the lower the sensor's resistance.
    forces_n = (0.0, MAX_FORCE_N) if signal_ground == VMID else (0.0,)
    gain, worst_hz, force_n = max(
        (*_find_largest_gain(circuit, gain_bandwidth_hz, signal_ground, band_hz, force_n), force_n)
        for force_n in forces_n
    )
    # The mean of a half-wave rectified sine is 1/pi of its peak.
    peak_v = DEAD_ZONE_V if envelope_gain is None else math.pi * threshold_v / envelope_gain
    return SupplyRipple(*band_hz, worst_hz=worst_hz, gain=gain, max_v=peak_v / gain, force_n=force_n)


def _find_largest_gain(
    circuit: Circuit, gain_bandwidth_hz: float, signal_ground: str, band_hz: tuple[float, float], force_n: float
) -> tuple[float, float]:
    """Find the largest gain from the supply to the filtered signal at a force [N], and its frequency [Hz]."""
    network = build_network(circuit, gain_bandwidth_hz, sensor_s=sensor_conductance_s(force_n))
    network = network.restrict(FILTERED, signal_ground)
    nets = [FILTERED] if signal_ground in network.inputs else [FILTERED, signal_ground]
    worst_hz, gain = 0.0, 0.0
    low_hz, high_hz = band_hz
    for _ in range(2):  # the second time around the largest gain
        f = np.geomspace(low_hz, high_hz, math.ceil(_FREQUENCIES_PER_DECADE * math.log10(high_hz / low_hz)) + 9)
        volts = network.response(f, {VCC: 1.0}, *nets)
        gains = np.abs(volts[:, 0] - (volts[:, 1] if len(nets) > 1 else 0.0))
        worst = int(gains.argmax())
        worst_hz, gain = float(f[worst]), float(gains[worst])
        low_hz, high_hz = float(f[max(worst - 1, 0)]), float(f[min(worst + 1, len(f) - 1)])
    return gain, worst_hz


def describe_sensor(ripple: SupplyRipple) -> str:
    return f"with {ripple.force_n:g} N on the sensor" if ripple.force_n else "with the sensor open"
