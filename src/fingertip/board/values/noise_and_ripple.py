"""Noise and supply ripple in the filtered signal, by formulas and without numpy.

Noise: `fingertip.board.analysis.noise` includes every component of the circuit. The formulas here include the causes of
99 % of it and are fast enough for the README of every folder: the bridge's amplifier, its gain resistor and both arms
of the bridge. A test compares the two.

Ripple: the bridge is connected to the supply, so its amplifier's output follows the supply, by the tactile voltage's
own ratio to it (on a single supply by its ratio above VMID, which is filtered), and by a little more where C7
delays the sensor's arm against the other one. The filter amplifies ripple in its passband like slip.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from fingertip.board.values.amplifiers import (
    AD623_BANDWIDTH_HZ,
    AD623_NOISE_V,
    AD623_OUTPUT_NOISE_V,
    BOLTZMANN_J_PER_K,
    TEMPERATURE_K,
)
from fingertip.board.values.bridge import GAIN_CONSTANT_OHM, SENSOR_FILTER_F, Bridge, sensor_conductance_s

NOISE_BAND_HZ = (0.1, 1e6)
"""Band over which noise is integrated."""
NOISE_FORCE_N = 0.8
"""Force on the sensor: the middle one of the article's voltages."""
HALF_WAVE_MEAN = 1.0 / math.sqrt(2.0 * math.pi)
"""Mean of half-wave rectified Gaussian noise, in units of its standard deviation."""
_POINTS_PER_DECADE = 15
"""Integration points per decade: the error of the integral is then at most 0.3 %."""

DEAD_ZONE_V = 0.45
"""Voltage at which variant article's diode starts to conduct. Its output is zero below it."""
RIPPLE_BAND_HZ = (30.0, 1000.0)
"""Band in which supply ripple counts: the mains and its harmonics, from half the article's cutoff."""


@dataclass(frozen=True)
class NoiseLevels:
    """RMS noise over `NOISE_BAND_HZ` [V], for typical data-sheet values."""

    tactile_v: float
    """RMS noise of the tactile voltage."""
    filtered_v: float
    """RMS noise ahead of the rectifier."""
    filtered_without_limit_v: float
    """RMS noise ahead of the rectifier without C20, which ends the first stage's gain above the vibrations."""
    mean_envelope_v: float | None
    """Mean envelope due to noise, after rectification. None in variant article: it is below the diode's threshold."""


def compute_noise_levels(
    bridge: Bridge,
    transfer: Callable[[float], complex],
    transfer_without_limit: Callable[[float], complex],
    has_diode: bool,
) -> NoiseLevels:
    """Compute the noise of a board.

    Parameters
    ----------
    bridge
        Resistors of the bridge.
    transfer, transfer_without_limit
        Transfer functions at f [Hz] from the tactile voltage to the filtered one, with and without C20.
    has_diode
        Whether a bare diode precedes the envelope (variant article).
    """
    low, high = NOISE_BAND_HZ
    steps = round(_POINTS_PER_DECADE * math.log10(high / low))
    width = math.log(high / low) / steps
    totals = [0.0, 0.0, 0.0]
    # Trapezoidal rule over the logarithm of the frequency, df = f d(ln f).
    for i in range(steps + 1):
        f = low * math.exp(i * width)
        square = _tactile_density_squared(bridge, f) * f * width * (0.5 if i in (0, steps) else 1.0)
        for k, gain in enumerate((1.0, abs(transfer(f)), abs(transfer_without_limit(f)))):
            totals[k] += square * gain * gain
    tactile, filtered, without_limit = (math.sqrt(total) for total in totals)
    return NoiseLevels(tactile, filtered, without_limit, None if has_diode else HALF_WAVE_MEAN * filtered)


def _tactile_density_squared(bridge: Bridge, f_hz: float) -> float:
    """Squared noise density [V^2/Hz] at the output of the bridge's amplifier at f [Hz]."""
    thermal, gain = 4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K, bridge.gain
    resistors = 1.0 / bridge.sensor_top_ohm + 1.0 / bridge.sensor_shunt_ohm
    arm_ohm = 1.0 / (resistors + sensor_conductance_s(NOISE_FORCE_N))
    # The sensor itself is assumed to be noiseless. C7 lies across its arm.
    arm = thermal * resistors * arm_ohm**2 / (1.0 + (math.tau * f_hz * SENSOR_FILTER_F * arm_ohm) ** 2)
    reference = thermal / (1.0 / bridge.reference_top_ohm + 1.0 / bridge.reference_bottom_ohm)
    amplifier = AD623_NOISE_V**2 + (AD623_OUTPUT_NOISE_V / gain) ** 2
    gain_resistor = thermal * GAIN_CONSTANT_OHM / (gain - 1.0) * ((gain - 1.0) / gain) ** 2
    pole = 1.0 + (f_hz * gain / AD623_BANDWIDTH_HZ) ** 2
    return gain**2 * (arm + reference + amplifier + gain_resistor) / pole


def noise_warning(noise: NoiseLevels, threshold_v: float) -> str:
    """Warn of noise that alone brings the envelope to the threshold; empty if it does not."""
    if noise.mean_envelope_v is None or noise.mean_envelope_v < threshold_v:
        return ""
    return (
        f"noise alone raises the mean envelope to {1e3 * noise.mean_envelope_v:.1f} mV, and "
        f"detector.threshold_v is {1e3 * threshold_v:g} mV: this board reports slip without contact. Raise the "
        "threshold, or lower board.passband_gain or board.band_limit_hz."
    )


@dataclass(frozen=True)
class SupplyRipple:
    """Effect of ripple on the positive supply with the sensor open, which is the worst case."""

    gain: float
    """Largest gain from the supply to the filtered signal in `RIPPLE_BAND_HZ` [V/V]."""
    max_v: float
    """Peak of the ripple [V] that alone brings the envelope's mean to the detector's threshold.

    In variant article: the peak that alone makes the diode conduct.
    """


def compute_supply_ripple(
    bridge: Bridge, transfer: Callable[[float], complex], threshold_v: float, has_diode: bool, points: int = 60
) -> SupplyRipple:
    """Compute the effect of supply ripple on a board.

    Parameters
    ----------
    bridge
        Resistors of the bridge.
    transfer
        Transfer function at f [Hz] from the tactile voltage to the filtered one.
    threshold_v
        Mean of the envelope at which slip is reported.
    has_diode
        Whether a bare diode precedes the envelope (variant article).
    points
        Number of frequencies at which the gain is evaluated.
    """
    low, high = RIPPLE_BAND_HZ
    frequencies = (low * math.pow(high / low, i / (points - 1)) for i in range(points))
    gain = max(abs(_supply_transfer(bridge, f) * transfer(f)) for f in frequencies)
    # The mean of a half-wave rectified sine is 1/pi of its peak.
    return SupplyRipple(gain, (DEAD_ZONE_V if has_diode else math.pi * threshold_v) / gain)


def _supply_transfer(bridge: Bridge, f_hz: float) -> complex:
    """Transfer function from the supply to the tactile voltage at f [Hz], with the sensor open.

    VMID of a single supply is assumed to be free of ripple.
    """
    top, shunt, reference = (
        bridge.sensor_top_ohm,
        bridge.sensor_shunt_ohm,
        bridge.reference_bottom_ohm / (bridge.reference_top_ohm + bridge.reference_bottom_ohm),
    )
    delay = 1.0 + 2j * math.pi * f_hz * SENSOR_FILTER_F * top * shunt / (top + shunt)
    return bridge.gain * (shunt / (top + shunt) / delay - reference)


def describe_supply_ripple(ripple: SupplyRipple, has_diode: bool) -> str:
    """Describe the requirement on the supply's ripple."""
    low, high = RIPPLE_BAND_HZ
    effect = "makes the diode conduct" if has_diode else "brings the envelope to the threshold"
    return (
        f"ripple on the positive supply reaches the rectifier amplified {ripple.gain:.0f} times: from {low:g} Hz to "
        f"{high:g} Hz a peak of {1e3 * ripple.max_v:.2g} mV alone {effect}"
    )
