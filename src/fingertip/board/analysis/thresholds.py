"""Thresholds and errors of the comparator, from the voltages that its circuit settles to."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.board.analysis.response import RECTIFYING_DIODE
from fingertip.board.circuits.network import Network, Value, build_network, list_amplifiers
from fingertip.board.circuits.transfer_function import find_stages
from fingertip.board.components.front_end import AMPLIFIERS
from fingertip.board.components.values import MAX_SUPPRESSOR_A
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import ADC_ENVELOPE, ADC_TACTILE, ENVELOPE, MEAN, SLIP, THRESHOLD
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE, LOW_OFFSET_AMPLIFIER
from fingertip.design.formulas import filter as formulas


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
    max_bias_v: float
    """Typical and maximum increase of the mean by the comparator's input bias current."""
    threshold_bias_v: float
    """Typical increase of the ON threshold by an equal current of the other input."""
    averaging_tau_s: float


def compute_comparator_levels(
    circuit: Circuit, rails: dict[str, float], signal_ground: str
) -> ComparatorLevels:

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
    threshold_ohm = (
        build_network(circuit).restrict(THRESHOLD).constant_transfers(THRESHOLD)[THRESHOLD]
    )

    return ComparatorLevels(
        on_v=threshold_v(is_on=False),
        off_v=threshold_v(is_on=True),
        max_on_v=threshold_v(is_on=False, trimmer_ratio=1.0),
        bias_v=formulas.BIAS_A * source_ohm,
        max_bias_v=formulas.MAX_BIAS_A * source_ohm,
        threshold_bias_v=formulas.BIAS_A * threshold_ohm,
        averaging_tau_s=float(slope / constant),
    )


# Envelope offset: the output offset after a precision rectifier, due to the offset voltages of the
# amplifiers.
#
# Without a signal the offsets decide which diode of the rectifier conducts. While the positive one
# (D1) does, the envelope is the sum of the offsets of the Sallen-Key stage, the rectifier and the
# envelope's low-pass times their gains, 1, -2 and 2. While the other one (D4) does, the Sallen-Key
# stage is cut off, and the gains are smaller. The envelope offset is therefore at most five offset
# voltages upwards, and little more than one downwards.

BLOCKING_DIODE = "D4"
"""Diode that conducts while the filtered signal is negative, and cuts the rectifier off."""
_FILTER_AND_RECTIFIER = ("U1", "U3")
"""Amplifiers whose offsets count; that of VMID's buffer shifts envelope and ground alike."""


@dataclass(frozen=True)
class OutputOffset:
    """Envelope offset above signal ground [V] by the amplifiers' offsets, at 25 degrees Celsius."""

    min_v: float
    max_v: float
    """Ends of its range for the worst offsets of the purchased grade."""
    typical_v: float
    """Root sum of squares for the typical offsets of the data sheets, which are independent."""
    low_offset_amplifier: str
    """Pin-compatible amplifier with rail-to-rail inputs and outputs and less offset."""
    max_low_offset_v: float
    """Maximum with that amplifier."""


def compute_output_offset(
    circuit: Circuit, gain_bandwidth_hz: float, signal_ground: str
) -> OutputOffset:
    conducting, blocked = (
        _offset_gains(circuit, gain_bandwidth_hz, signal_ground, diode)
        for diode in (RECTIFYING_DIODE, BLOCKING_DIODE)
    )
    worst_gain = math.fsum(map(abs, conducting))
    amplifier = AMPLIFIERS[circuit.component("U3").symbol.name]
    return OutputOffset(
        min_v=-math.fsum(map(abs, blocked)) * amplifier.max_offset_v,
        max_v=worst_gain * amplifier.max_offset_v,
        typical_v=math.hypot(*conducting) * amplifier.offset_v,
        low_offset_amplifier=LOW_OFFSET_AMPLIFIER,
        max_low_offset_v=worst_gain * AMPLIFIER_CATALOGUE[LOW_OFFSET_AMPLIFIER].max_offset_v,
    )


def _offset_gains(
    circuit: Circuit, gain_bandwidth_hz: float, signal_ground: str, diode: str
) -> list[float]:
    """Return the constant gain from each amplifier's offset to the envelope."""
    network = build_network(circuit, gain_bandwidth_hz, conducting=[diode]).restrict(
        ENVELOPE, signal_ground
    )
    transfers = network.constant_transfers(ENVELOPE, signal_ground)
    outputs = (
        output.net
        for output in list_amplifiers(circuit)
        if output.reference in _FILTER_AND_RECTIFIER
    )

    return [transfers.get(net, 0.0) for net in outputs]


# Mean and worst case of the comparator's threshold: offsets, currents and tolerances from 0 to 50
# degrees Celsius.
#
# The threshold is referred to the envelope: it is the averaged envelope at which the output turns
# ON. All shifts are transfers of one circuit to the difference of the comparator's inputs.

_WARMING_K = max(
    formulas.MAX_TEMPERATURE_C - formulas.DATA_SHEET_C,
    formulas.DATA_SHEET_C - formulas.MIN_TEMPERATURE_C,
)
_LEAKAGE_DOUBLES_K = 10.0
"""Rise in temperature that doubles a diode's reverse current [K]."""
TOLERANCES = "tolerances of R19 to R21 and RV1"
_TRIMMER = ("RV1a", "RV1b")
_RESISTORS = ("R19", "R20", "R21")


@dataclass(frozen=True)
class ThresholdShift:
    """Largest shift of the threshold by one cause [V]."""

    cause: str
    worst_v: float


@dataclass(frozen=True)
class ThresholdSpread:
    """Mean and worst case of a comparator's threshold [V], with the trimmer at its midpoint."""

    mean_v: float
    """Threshold with typical currents; offsets and tolerances have no preferred sign."""
    min_v: float
    max_v: float
    trim_v: float
    """Largest shift that the trimmer can undo: to the nearer end of its range."""
    shifts: tuple[ThresholdShift, ...]
    """Largest shift by each cause; their sum is half of the range."""

    @property
    def to_trim_v(self) -> float:
        """Sum of the shifts to trim [V]; tolerances scale threshold and range alike."""
        return math.fsum(shift.worst_v for shift in self.shifts if shift.cause != TOLERANCES)


def compute_threshold_spread(
    circuit: Circuit,
    gain_bandwidth_hz: float,
    levels: ComparatorLevels,
    rails: Mapping[str, float],
    resistor_percent: float,
) -> ThresholdSpread:
    network = build_network(circuit, gain_bandwidth_hz, conducting=[RECTIFYING_DIODE])
    transfers = network.constant_transfers(MEAN, THRESHOLD)
    offset_v = 0.0

    for output in list_amplifiers(circuit):
        data = output.data
        if data:
            offset_v += abs(transfers[output.net]) * (
                data.max_offset_v + data.drift_v_per_k * _WARMING_K
            )

    comparator_v = formulas.MAX_COMPARATOR_OFFSET_V + formulas.COMPARATOR_DRIFT_V_PER_K * _WARMING_K
    leakage_a = MAX_SUPPRESSOR_A * 2.0 ** (
        (formulas.MAX_TEMPERATURE_C - formulas.DATA_SHEET_C) / _LEAKAGE_DOUBLES_K
    )
    input_ohm = abs(transfers[MEAN]), abs(transfers[THRESHOLD])
    mean_v = levels.on_v - formulas.BIAS_A * (input_ohm[0] - input_ohm[1])
    shifts = (
        ThresholdShift("offsets of the amplifiers", offset_v),
        ThresholdShift("offset of the comparator", comparator_v),
        ThresholdShift(
            "input currents of the comparator",
            (formulas.HOT_BIAS_A - formulas.BIAS_A) * max(input_ohm),
        ),
        ThresholdShift(
            "leakage of the suppressors",
            leakage_a * (abs(transfers[ADC_ENVELOPE]) + abs(transfers[ADC_TACTILE])),
        ),
        ThresholdShift(TOLERANCES, _tolerance_v(network, rails, resistor_percent / 100.0)),
    )
    worst_v = math.fsum(shift.worst_v for shift in shifts)

    return ThresholdSpread(
        mean_v=mean_v,
        min_v=mean_v - worst_v,
        max_v=mean_v + worst_v,
        trim_v=min(levels.max_on_v - levels.on_v, levels.on_v),
        shifts=shifts,
    )


def _tolerance_v(network: Network, rails: Mapping[str, float], tolerance: float) -> float:
    """Return the largest change of the threshold by the resistors around it [V]."""
    part = network.restrict(THRESHOLD)

    def threshold_v(values: Mapping[str, Value]) -> float:
        return part.with_values(values).operating_point(rails)[THRESHOLD]

    nominal_v = threshold_v({})
    total_v = 0.0
    groups = [((name,), tolerance) for name in _RESISTORS]
    for names, ratio in (*groups, (_TRIMMER, formulas.TRIMMER_TOLERANCE)):
        changed = {name: part.values[name] / (1.0 + ratio) for name in names}
        total_v += abs(threshold_v(changed) - nominal_v)

    return total_v


def describe_threshold_spread(spread: ThresholdSpread) -> str:
    largest = max(spread.shifts, key=lambda shift: shift.worst_v)
    return (
        f"with the trimmer at its midpoint the threshold of a board is {1e3 * spread.mean_v:.1f} "
        "mV on average and "
        f"between {round(1e3 * spread.min_v, 1) + 0.0:.1f} and {1e3 * spread.max_v:.1f} mV in the "
        "worst case from "
        f"{formulas.MIN_TEMPERATURE_C:g} to {formulas.MAX_TEMPERATURE_C:g} C (largest part: "
        f"{largest.cause}, "
        f"{1e3 * largest.worst_v:.1f} mV); the trimmer can shift it by {1e3 * spread.trim_v:.1f} "
        "mV, and offsets "
        f"and currents need {1e3 * spread.to_trim_v:.1f} mV"
    )
