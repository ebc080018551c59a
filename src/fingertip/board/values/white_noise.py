"""The board's noise by formulas: what the bridge and its amplifier leave, through the filter, without numpy.

`fingertip.board.analysis.noise` takes in every part of the circuit; here is what 99 % of that comes from, quickly
enough for every folder's README: the bridge's amplifier, its gain resistor and both arms of the bridge. A test holds
one against the other.
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
from fingertip.board.values.bridge import CABLE_F, GAIN_CONSTANT_OHM, Bridge, sensor_conductance_s

BAND_HZ = (0.1, 1e6)
NOISE_FORCE_N = 0.8
"""Force on the sensor: the middle of the article's voltages."""
HALF_WAVE_MEAN = 1.0 / math.sqrt(2.0 * math.pi)
"""Mean of a rectified half wave of Gaussian noise, in its standard deviations."""
_POINTS_PER_DECADE = 15
"""The integral is then within 0.3 % of its limit."""


@dataclass(frozen=True)
class WhiteNoise:
    """Root mean square over `BAND_HZ`, typical figures of data sheets [V]."""

    tactile_v: float
    """Of the tactile voltage."""
    filtered_v: float
    """Ahead of the rectifier."""
    open_v: float
    """The same without C20, which ends the first stage's gain above the vibrations."""
    rest_v: float | None
    """Where the envelope rests for it: its rectified mean. None in variant article, whose diode hides it."""


def white_noise(
    bridge: Bridge, transfer: Callable[[float], complex], without: Callable[[float], complex], diode: bool
) -> WhiteNoise:
    """The noise of a board.

    Parameters
    ----------
    transfer, without
        From the tactile voltage to the filtered one at f [Hz], as built and without C20.
    diode
        Whether the envelope lies behind a bare diode (variant article).
    """
    low, high = BAND_HZ
    steps = round(_POINTS_PER_DECADE * math.log10(high / low))
    width = math.log(high / low) / steps
    totals = [0.0, 0.0, 0.0]
    for i in range(steps + 1):
        f = low * math.exp(i * width)
        square = _tactile_square(bridge, f) * f * width * (0.5 if i in (0, steps) else 1.0)
        for k, factor in enumerate((1.0, abs(transfer(f)), abs(without(f)))):
            totals[k] += square * factor * factor
    tactile, filtered, open_ = (math.sqrt(total) for total in totals)
    return WhiteNoise(tactile, filtered, open_, None if diode else HALF_WAVE_MEAN * filtered)


def _tactile_square(bridge: Bridge, f_hz: float) -> float:
    """Square of the density at the bridge's amplifier's output at f [Hz]: V^2/Hz."""
    thermal, gain = 4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K, bridge.gain
    resistors = 1.0 / bridge.top_ohm + 1.0 / bridge.shunt_ohm
    arm_ohm = 1.0 / (resistors + sensor_conductance_s(NOISE_FORCE_N))
    # The sensor itself is taken to be silent, and C7 lies across its arm.
    arm = thermal * resistors * arm_ohm**2 / (1.0 + (math.tau * f_hz * CABLE_F * arm_ohm) ** 2)
    reference = thermal / (1.0 / bridge.high_ohm + 1.0 / bridge.low_ohm)
    own = AD623_NOISE_V**2 + (AD623_OUTPUT_NOISE_V / gain) ** 2
    gain_resistor = thermal * GAIN_CONSTANT_OHM / (gain - 1.0) * ((gain - 1.0) / gain) ** 2
    pole = 1.0 + (f_hz * gain / AD623_BANDWIDTH_HZ) ** 2
    return gain**2 * (arm + reference + own + gain_resistor) / pole


def noise_warning(noise: WhiteNoise, threshold_v: float) -> str:
    """What is wrong where noise alone brings the envelope to the threshold; empty if it does not."""
    if noise.rest_v is None or noise.rest_v < threshold_v:
        return ""
    return (
        f"noise alone lets the envelope rest at {1e3 * noise.rest_v:.1f} mV, and detector.threshold_v is "
        f"{1e3 * threshold_v:g} mV: this board says slip with nothing touching. Raise the threshold, or lower "
        f"board.passband_gain or board.band_limit_hz."
    )
