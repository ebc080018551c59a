"""Thresholds and errors of the comparator, from the voltages that its circuit settles to."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.circuit import Circuit
from fingertip.board.circuits.signal_paths import MEAN, SLIP, THRESHOLD
from fingertip.board.nets import ENVELOPE
from fingertip.board.network import build_network
from fingertip.board.transfer_function import find_stages
from fingertip.design.comparator_data import BIAS_A, COMPARATOR_OFFSET_V, MAX_BIAS_A, MAX_COMPARATOR_OFFSET_V


@dataclass(frozen=True)
class ComparatorLevels:
    """Thresholds [V] of the averaged envelope above the signal ground, and what shifts it."""

    on_v: float
    """Averaged envelope above which the output turns ON, with the trimmer at its midpoint."""
    off_v: float
    """Averaged envelope below which the output turns OFF again."""
    max_on_v: float
    """ON threshold with the trimmer at its end."""
    bias_v: float
    """Typical increase of the mean by the comparator's input bias current."""
    max_bias_v: float
    """Maximum increase of the mean by the comparator's input bias current."""
    threshold_bias_v: float
    """Typical increase of the ON threshold by the current of the other input, if both inputs draw the same."""
    averaging_tau_s: float
    """Time constant of the averaging low-pass [s]."""


def compute_comparator_levels(circuit: Circuit, rails: dict[str, float], signal_ground: str) -> ComparatorLevels:
    """Compute the levels of a comparator.

    Parameters
    ----------
    circuit
        Circuit of a board of variant comparator.
    rails
        Voltages of the rails [V].
    signal_ground
        Net to which the signals refer.
    """

    def threshold_v(is_on: bool, trimmer_ratio: float = 0.5) -> float:
        network = build_network(circuit, trimmer_ratio=trimmer_ratio)
        # While slip is ON the open collector holds the output at ground.
        network = (network.drive(SLIP) if is_on else network).restrict(THRESHOLD, signal_ground)
        volts = network.operating_point({**rails, SLIP: 0.0})
        return volts[THRESHOLD] - volts[signal_ground]

    averaging = build_network(circuit).drive(ENVELOPE)
    (stage,) = find_stages(averaging, ENVELOPE, MEAN)
    constant, slope = stage.evaluate(averaging.values).denominator
    source_ohm = averaging.restrict(MEAN).constant_transfers(MEAN)[MEAN]
    threshold_ohm = build_network(circuit).restrict(THRESHOLD).constant_transfers(THRESHOLD)[THRESHOLD]
    return ComparatorLevels(
        on_v=threshold_v(is_on=False),
        off_v=threshold_v(is_on=True),
        max_on_v=threshold_v(is_on=False, trimmer_ratio=1.0),
        bias_v=BIAS_A * source_ohm,
        max_bias_v=MAX_BIAS_A * source_ohm,
        threshold_bias_v=BIAS_A * threshold_ohm,
        averaging_tau_s=float(slope / constant),
    )


def describe_comparator_levels(levels: ComparatorLevels) -> list[str]:
    """Describe thresholds and errors of the comparator, as sentences."""
    return [
        f"slip is ON above {1e3 * levels.on_v:.1f} mV and OFF below {1e3 * levels.off_v:.1f} mV with the trimmer at "
        f"its midpoint; the trimmer reaches {1e3 * levels.max_on_v:.1f} mV",
        f"the comparator's input bias current raises the mean by {1e3 * levels.bias_v:.2f} mV (at most "
        f"{1e3 * levels.max_bias_v:.2f} mV) in R18; the same current in the other input would raise the threshold by "
        f"{1e3 * levels.threshold_bias_v:.2f} mV; its offset is {1e3 * COMPARATOR_OFFSET_V:g} mV (at most "
        f"{1e3 * MAX_COMPARATOR_OFFSET_V:g} mV)",
    ]
