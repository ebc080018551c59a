"""Envelope offset: the output offset after a precision rectifier, due to the offset voltages of the amplifiers.

Without a signal the offsets decide which diode of the rectifier conducts. While the positive one (D1) does, the
envelope is the sum of the offsets of the Sallen-Key stage, the rectifier and the envelope's low-pass times their gains,
1, -2 and 2. While the other one (D4) does, the Sallen-Key stage is cut off, and the gains are smaller. The envelope
offset is therefore at most five offset voltages upwards, and little more than one downwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.amplifiers import Amplifier
from fingertip.board.analysis.response import RECTIFYING_DIODE
from fingertip.board.circuit import Circuit
from fingertip.board.components.amplifiers import AMPLIFIERS
from fingertip.board.nets import ENVELOPE
from fingertip.board.network import build_network, list_amplifiers

BLOCKING_DIODE = "D4"
"""Diode that conducts while the filtered signal is negative, and cuts the rectifier off from the filter."""
_FILTER_AND_RECTIFIER = ("U1", "U3")
"""Amplifiers whose offsets count. That of the buffer of VMID moves envelope and signal ground alike."""


@dataclass(frozen=True)
class OutputOffset:
    """Envelope offset above signal ground [V] due to the amplifiers' offsets, at 25 degrees Celsius."""

    min_v: float
    """Minimum for the worst offsets of the purchased grade."""
    max_v: float
    """Maximum for the worst offsets of the purchased grade."""
    typical_v: float
    """Root sum of squares for the typical offsets of the data sheets, which are independent."""
    low_offset_amplifier: str
    """Pin-compatible amplifier with rail-to-rail inputs and outputs and less offset."""
    max_low_offset_v: float
    """Maximum with that amplifier."""


def compute_output_offset(
    circuit: Circuit, gain_bandwidth_hz: float, signal_ground: str, low_offset: Amplifier
) -> OutputOffset:
    """Compute the envelope offset of a board with a precision rectifier.

    Parameters
    ----------
    circuit
        Circuit of the board.
    gain_bandwidth_hz
        Gain-bandwidth product of its amplifiers [Hz].
    signal_ground
        Net to which the envelope refers.
    low_offset
        Amplifier of low offset that works on the board's supply.
    """
    conducting, blocked = (
        _offset_gains(circuit, gain_bandwidth_hz, signal_ground, diode) for diode in (RECTIFYING_DIODE, BLOCKING_DIODE)
    )
    worst_gain, amplifier = math.fsum(map(abs, conducting)), AMPLIFIERS[circuit.component("U3").symbol.name]
    return OutputOffset(
        min_v=-math.fsum(map(abs, blocked)) * amplifier.max_offset_v,
        max_v=worst_gain * amplifier.max_offset_v,
        typical_v=math.hypot(*conducting) * amplifier.offset_v,
        low_offset_amplifier=low_offset.name,
        max_low_offset_v=worst_gain * low_offset.max_offset_v,
    )


def _offset_gains(circuit: Circuit, gain_bandwidth_hz: float, signal_ground: str, diode: str) -> list[float]:
    """Constant gains from the offset voltage of each amplifier to the envelope above the signal ground."""
    network = build_network(circuit, gain_bandwidth_hz, conducting=[diode]).restrict(ENVELOPE, signal_ground)
    envelope = network.constant_transfers(ENVELOPE)
    ground = {} if signal_ground in network.inputs else network.constant_transfers(signal_ground)
    outputs = (output.net for output in list_amplifiers(circuit) if output.reference in _FILTER_AND_RECTIFIER)
    return [envelope.get(net, 0.0) - ground.get(net, 0.0) for net in outputs]


def describe_output_offset(offset: OutputOffset, threshold_v: float) -> str:
    """Describe the envelope offset in relation to the threshold."""
    return (
        f"offsets of U1 and U3 cause an envelope offset between {1e3 * offset.min_v:.1f} and "
        f"{1e3 * offset.max_v:.1f} mV (typical offsets: {1e3 * offset.typical_v:.1f} mV; with "
        f"{offset.low_offset_amplifier} below {1e3 * offset.max_low_offset_v:.1f} mV), and the threshold is "
        f"{1e3 * threshold_v:g} mV: measure the envelope offset and add it to the threshold"
    )
