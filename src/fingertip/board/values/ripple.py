"""How much of the supply's ripple the filter takes for vibration.

The bridge hangs on the supply, and so its amplifier's output moves with it: by the tactile voltage's own share of it
(above the middle, which is filtered, on a single supply), and by a little more where C7 delays the sensor's arm
against the other. What of that lies in the passband is amplified as slip is.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from fingertip.board.values.bridge import CABLE_F, Bridge

DEAD_ZONE_V = 0.45
"""From where on variant article's diode conducts: below, nothing of the filtered signal comes out."""
RIPPLE_BAND_HZ = (30.0, 1000.0)
"""Where a supply's ripple counts: around the mains and its harmonics, from half the article's cutoff on."""


@dataclass(frozen=True)
class Ripple:
    """What ripple on the positive supply does, the sensor open, which is the worst."""

    gain: float
    """The largest from the supply to the filtered signal in `RIPPLE_BAND_HZ` [V/V]."""
    max_v: float
    """Peak of the ripple [V] that alone brings the envelope's mean to the detector's threshold; in variant article, that
    makes the diode conduct."""


def ripple_of(
    bridge: Bridge, transfer: Callable[[float], complex], threshold_v: float, diode: bool, points: int = 60
) -> Ripple:
    """The ripple of a board.

    Parameters
    ----------
    transfer
        From the tactile voltage to the filtered one, at f [Hz].
    threshold_v
        Mean of the envelope at which slip is said.
    diode
        Whether the envelope lies behind a bare diode (variant article).
    points
        At how many frequencies.
    """
    low, high = RIPPLE_BAND_HZ
    found = (low * math.pow(high / low, i / (points - 1)) for i in range(points))
    gain = max(abs(_tactile(bridge, f) * transfer(f)) for f in found)
    # A half wave's mean is 1/pi of its peak.
    return Ripple(gain, (DEAD_ZONE_V if diode else math.pi * threshold_v) / gain)


def _tactile(bridge: Bridge, f_hz: float) -> complex:
    """From the supply to the tactile voltage at f [Hz], the sensor open; the middle of a single one stands still."""
    top, shunt, reference = bridge.top_ohm, bridge.shunt_ohm, bridge.low_ohm / (bridge.high_ohm + bridge.low_ohm)
    delay = 1.0 + 2j * math.pi * f_hz * CABLE_F * top * shunt / (top + shunt)
    return bridge.gain * (shunt / (top + shunt) / delay - reference)


def ripple_line(ripple: Ripple, diode: bool) -> str:
    """What the supply must keep."""
    low, high = RIPPLE_BAND_HZ
    harm = "makes the diode conduct" if diode else "brings the envelope to the threshold"
    return (
        f"ripple on the plus supply reaches the rectifier {ripple.gain:.0f} times as large: from {low:g} Hz to "
        f"{high:g} Hz a peak of {1e3 * ripple.max_v:.2g} mV alone {harm}"
    )
