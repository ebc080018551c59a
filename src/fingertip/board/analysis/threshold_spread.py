"""Mean and worst case of the comparator's threshold: offsets, currents and tolerances from 0 to 50 degrees Celsius.

The threshold is referred to the envelope: it is the averaged envelope at which the output turns ON. All shifts are
transfers of one circuit to the difference of the comparator's inputs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.board.analysis.response import RECTIFYING_DIODE
from fingertip.board.analysis.thresholds import ComparatorLevels
from fingertip.board.circuit import Circuit
from fingertip.board.circuits.signal_paths import MEAN, THRESHOLD
from fingertip.board.components.amplifiers import AMPLIFIERS
from fingertip.board.components.anti_aliasing import MAX_CLAMP_A
from fingertip.board.nets import ADC_ENVELOPE, ADC_TACTILE
from fingertip.board.network import Network, Value, build_network, list_amplifiers
from fingertip.design.comparator_data import (
    BIAS_A,
    COMPARATOR_DRIFT_V_PER_K,
    DATA_SHEET_C,
    HOT_BIAS_A,
    MAX_COMPARATOR_OFFSET_V,
    MAX_TEMPERATURE_C,
    MIN_TEMPERATURE_C,
    TRIMMER_TOLERANCE,
)

_WARMING_K = max(MAX_TEMPERATURE_C - DATA_SHEET_C, DATA_SHEET_C - MIN_TEMPERATURE_C)
_LEAKAGE_DOUBLES_K = 10.0
"""Rise in temperature that doubles a diode's reverse current [K]."""
TOLERANCES = "tolerances of R19 to R21 and RV1"
_TRIMMER, _RESISTORS = ("RV1a", "RV1b"), ("R19", "R20", "R21")


@dataclass(frozen=True)
class ThresholdShift:
    """Largest shift of the threshold by one cause [V]."""

    cause: str
    worst_v: float


@dataclass(frozen=True)
class ThresholdSpread:
    """Mean and worst case of a comparator's threshold above the signal ground [V], with the trimmer at its midpoint."""

    mean_v: float
    """Threshold with typical currents; offsets and tolerances have no preferred sign."""
    min_v: float
    max_v: float
    trim_v: float
    """Largest shift in either direction that the trimmer can take back: to the nearer end of its range."""
    shifts: tuple[ThresholdShift, ...]
    """Largest shift by each cause; their sum is half of the range."""

    @property
    def to_trim_v(self) -> float:
        """Sum of the shifts that trimming takes back [V]; tolerances scale the threshold and the range alike."""
        return math.fsum(shift.worst_v for shift in self.shifts if shift.cause != TOLERANCES)


def compute_threshold_spread(
    circuit: Circuit,
    gain_bandwidth_hz: float,
    levels: ComparatorLevels,
    rails: Mapping[str, float],
    resistor_percent: float,
) -> ThresholdSpread:
    """Compute mean and worst case of a board's threshold.

    Parameters
    ----------
    circuit
        Circuit of a board of variant comparator.
    gain_bandwidth_hz
        Gain-bandwidth product of its amplifiers [Hz].
    levels
        Its nominal levels.
    rails
        Voltages of the rails [V].
    resistor_percent
        Tolerance of the filter's resistors, which R19 to R21 share.
    """
    network = build_network(circuit, gain_bandwidth_hz, conducting=[RECTIFYING_DIODE])
    mean, threshold = (network.constant_transfers(net) for net in (MEAN, THRESHOLD))
    transfers = {net: mean[net] - threshold[net] for net in network.nets}
    offset_v = 0.0
    for _, reference, net in list_amplifiers(circuit):
        data = AMPLIFIERS.get(circuit.component(reference).symbol.name)
        if data:
            offset_v += abs(transfers[net]) * (data.max_offset_v + data.drift_v_per_k * _WARMING_K)
    leakage_a = MAX_CLAMP_A * 2.0 ** ((MAX_TEMPERATURE_C - DATA_SHEET_C) / _LEAKAGE_DOUBLES_K)
    input_ohm = abs(transfers[MEAN]), abs(transfers[THRESHOLD])
    mean_v = levels.on_v - BIAS_A * (input_ohm[0] - input_ohm[1])
    shifts = (
        ThresholdShift("offsets of the amplifiers", offset_v),
        ThresholdShift("offset of the comparator", MAX_COMPARATOR_OFFSET_V + COMPARATOR_DRIFT_V_PER_K * _WARMING_K),
        ThresholdShift("input currents of the comparator", (HOT_BIAS_A - BIAS_A) * max(input_ohm)),
        ThresholdShift(
            "reverse current of the clamps", leakage_a * (abs(transfers[ADC_ENVELOPE]) + abs(transfers[ADC_TACTILE]))
        ),
        ThresholdShift(TOLERANCES, _tolerance_v(network, rails, resistor_percent / 100.0)),
    )
    worst_v = math.fsum(shift.worst_v for shift in shifts)
    return ThresholdSpread(
        mean_v, mean_v - worst_v, mean_v + worst_v, min(levels.max_on_v - levels.on_v, levels.on_v), shifts
    )


def _tolerance_v(network: Network, rails: Mapping[str, float], tolerance: float) -> float:
    """Largest change of the threshold by the resistors around it [V]."""
    part = network.restrict(THRESHOLD)

    def threshold_v(values: Mapping[str, Value]) -> float:
        return part.with_values(values).operating_point(rails)[THRESHOLD]

    nominal_v, total_v = threshold_v({}), 0.0
    for names, ratio in (*(((name,), tolerance) for name in _RESISTORS), (_TRIMMER, TRIMMER_TOLERANCE)):
        changed = {name: part.values[name] / (1.0 + ratio) for name in names}
        total_v += abs(threshold_v(changed) - nominal_v)
    return total_v


def describe_threshold_spread(spread: ThresholdSpread) -> str:
    """Describe mean, worst case and the trimmer's reach."""
    largest = max(spread.shifts, key=lambda shift: shift.worst_v)
    return (
        f"with the trimmer at its midpoint the threshold of a board is {1e3 * spread.mean_v:.1f} mV on average and "
        f"between {round(1e3 * spread.min_v, 1) + 0.0:.1f} and {1e3 * spread.max_v:.1f} mV in the worst case from "
        f"{MIN_TEMPERATURE_C:g} to {MAX_TEMPERATURE_C:g} C (largest part: {largest.cause}, "
        f"{1e3 * largest.worst_v:.1f} mV); the trimmer can shift it by {1e3 * spread.trim_v:.1f} mV, and offsets "
        f"and currents need {1e3 * spread.to_trim_v:.1f} mV"
    )
