"""Effect of ripple on the supply.

The bridge is connected to the supply, so its amplifier's output follows the supply: by the tactile voltage's own ratio
to it, and by a little more where C7 delays the sensor's arm against the other one. On a single supply, what remains of
the ripple in VMID counts too. The filter amplifies ripple in its passband like slip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.board.circuit import Circuit
from fingertip.board.nets import FILTERED, VCC
from fingertip.board.network import build_network

DEAD_ZONE_V = 0.45
"""Voltage at which variant article's diode starts to conduct. Its output is zero below it."""
RIPPLE_BAND_HZ = (30.0, 1000.0)
"""Band in which supply ripple counts: the mains and its harmonics, from half the article's cutoff."""
_FREQUENCIES = 60
"""Number of frequencies at which the gain is evaluated."""


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
    circuit: Circuit, gain_bandwidth_hz: float, signal_ground: str, threshold_v: float, envelope_gain: float | None
) -> SupplyRipple:
    """Compute the effect of supply ripple on a board.

    Parameters
    ----------
    circuit
        Circuit of the board.
    gain_bandwidth_hz
        Gain-bandwidth product of the filter's amplifiers [Hz].
    signal_ground
        Net to which the rectifier refers.
    threshold_v
        Mean of the envelope at which slip is reported.
    envelope_gain
        Constant gain of rectifier and envelope; None for the bare diode of variant article.
    """
    network = build_network(circuit, gain_bandwidth_hz).restrict(FILTERED, signal_ground)
    nets = [FILTERED] if signal_ground in network.inputs else [FILTERED, signal_ground]
    volts = network.response(np.geomspace(*RIPPLE_BAND_HZ, _FREQUENCIES), {VCC: 1.0}, *nets)
    gain = float(np.abs(volts[:, 0] - (volts[:, 1] if len(nets) > 1 else 0.0)).max())
    # The mean of a half-wave rectified sine is 1/pi of its peak.
    peak_v = DEAD_ZONE_V if envelope_gain is None else math.pi * threshold_v / envelope_gain
    return SupplyRipple(gain, peak_v / gain)


def describe_supply_ripple(ripple: SupplyRipple, has_diode: bool) -> str:
    """Describe the requirement on the supply's ripple."""
    low, high = RIPPLE_BAND_HZ
    effect = "makes the diode conduct" if has_diode else "brings the envelope to the threshold"
    return (
        f"ripple on the positive supply reaches the rectifier amplified {ripple.gain:.0f} times: from {low:g} Hz to "
        f"{high:g} Hz a peak of {1e3 * ripple.max_v:.2g} mV alone {effect}"
    )
