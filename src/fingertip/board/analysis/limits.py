"""Voltage limits of the board: input range of the ADC, and levels at which its signals clip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.analysis.response import RECTIFYING_DIODE, find_envelope_pin, find_rectifier
from fingertip.board.circuits.network import build_network
from fingertip.board.components.front_end import MAX_FORCE_N, sensor_conductance_s
from fingertip.board.components.values import Supply
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import (
    ADC_TACTILE,
    BIAS,
    GND,
    REFERENCE,
    SENSOR,
    TACTILE,
    VCC,
    VEE,
    VMID,
)
from fingertip.catalogues.electronics import Amplifier
from fingertip.design.formulas.amplifiers import DIODE_V
from fingertip.design.parameters.board_and_detector import Detector

# Internal limits of the AD623 (its data sheet, "input and output voltage range"): its input
# followers shift their inputs up by the drop of a diode and must stay clear of both rails, as must
# the output.
_INPUT_SHIFT_V = 0.59
_INTERNAL_MARGIN_V = 0.11
OUTPUT_UPPER_MARGIN_V = 0.5
OUTPUT_LOWER_MARGIN_V = 0.01
_INPUT_UPPER_MARGIN_V = 1.5
"""Distance of the AD623's inputs from its positive supply for which it is specified [V] (its data
sheet, input voltage range; recalled, unverified).
"""


@dataclass(frozen=True)
class FilterSwing:
    """Limits of the filter's amplifiers as voltage followers; voltages against the signal ground.

    An amplifier swings down to where its output or its input ends first.
    """

    peak_v: float
    trough_v: float
    """Limits above and below the signal ground, both positive [V]."""
    guaranteed_trough_v: float
    """Limit below that the data sheet guarantees [V]."""
    has_phase_reversal: bool
    """True if an input ends first: the output then jumps up."""

    @property
    def even_v(self) -> float:
        """Largest amplitude of an oscillation [V]."""
        return min(self.peak_v, self.trough_v)

    @classmethod
    def find(cls, amplifier: Amplifier, supply: Supply, supply_v: float) -> FilterSwing:
        output_v = amplifier.output_from_rail_v
        lower_v = supply.lower_headroom_v(supply_v)
        typical_v, guaranteed_v = amplifier.input_from_lower_v
        return cls(
            peak_v=supply.upper_headroom_v(supply_v) - output_v,
            trough_v=lower_v - max(typical_v, output_v),
            guaranteed_trough_v=lower_v - max(guaranteed_v, output_v),
            has_phase_reversal=typical_v > output_v,
        )


@dataclass(frozen=True)
class VoltageLimits:
    """Voltage limits [V] against ground, unless stated otherwise."""

    signal_ground_v: float
    """Signal ground: supply ground, or VMID (buffered mid-supply)."""
    min_tactile_v: float
    max_tactile_v: float
    """Range of the tactile voltage from an open sensor to its maximum force (20 N)."""
    sensor_amplifier_margin_v: float
    """Smallest margin of the sensor amplifier's voltages to their limits, over all forces."""
    max_sensor_input_v: float
    """Highest voltage at an input of the sensor's amplifier, over all forces."""
    sensor_input_limit_v: float
    """Voltage up to which its inputs are specified."""
    filter_peak_v: float
    """Largest peak of the filtered signal above the signal ground."""
    filter_trough_v: float
    """Largest typical peak of the filtered signal below the signal ground, as a positive number:
    the second stage's output limits it or, on a TL082, its input.
    """
    filter_guaranteed_trough_v: float
    """Guaranteed peak below the signal ground (data sheet), as a positive number."""
    has_phase_reversal: bool
    """True if the output jumps up where the signal goes further down, as a TL082's does."""
    vibration_peak_v: float
    """Peak of the largest tactile vibration that is not clipped where the gain is largest."""
    max_envelope_v: float | None
    """Approximate largest envelope above the signal ground: typical swing less a diode's drop.

    None on boards without an envelope. In variants with a precision rectifier its amplifier (U3a)
    inverts: for an envelope V it goes to V and a drop below the signal ground.
    """
    clamp_high_rail_v: float
    """Supply that limits the ADC pins; clamps conduct one Schottky drop above it."""
    tactile_pin_ohm: float
    """Resistance through which a leakage current at the tactile pin flows [ohm]."""
    output_pin_ohm: float
    """Resistance through which that at the envelope's pin flows [ohm], in variant article with its
    diode blocked; on a board without an envelope that at the filtered signal's pin.
    """
    has_filtered_output: bool
    """True if the filtered signal is at the output connector too."""
    adc_low_v: float
    adc_range_v: float

    @property
    def adc_overrange_v(self) -> float:
        """Voltage by which the pins exceed the range of the ADC [V]; 0 if they do not."""
        pins_v = [self.max_tactile_v]
        if self.max_envelope_v is not None:
            pins_v.append(self.signal_ground_v + self.max_envelope_v)
        if self.has_filtered_output:
            pins_v.append(self.signal_ground_v + self.filter_peak_v)

        return max(*pins_v, self.adc_range_v) - self.adc_range_v

    @property
    def adc_range_text(self) -> str:
        return f"{'plus and minus' if self.adc_low_v else '0 to'} {self.adc_range_v:g} V"


def compute_voltage_limits(
    circuit: Circuit,
    supply: Supply,
    supply_v: float,
    amplifier: Amplifier,
    gain: float,
    detector: Detector,
) -> VoltageLimits:
    """Compute the limits of a board, whose filter has this amplifier and this maximum gain."""
    swing = FilterSwing.find(amplifier, supply, supply_v)
    rectifier = find_rectifier(circuit)
    quiescent = build_network(
        circuit, conducting=[RECTIFYING_DIODE] if rectifier == "precision" else []
    )
    tactile_pin_ohm, output_pin_ohm = (
        quiescent.restrict(pin).constant_transfers(pin)[pin]
        for pin in (ADC_TACTILE, find_envelope_pin(circuit))
    )
    # The voltages are monotonic in the sensor's conductance, so the ends of its range are the worst
    # cases.
    networks = (
        build_network(circuit, sensor_s=sensor_conductance_s(force_n))
        for force_n in (0.0, MAX_FORCE_N)
    )
    rails = {GND: 0.0, VCC: supply_v, VEE: -supply_v}
    open_sensor, pressed = (
        network.restrict(TACTILE, supply.signal_ground).operating_point(rails)
        for network in networks
    )
    has_bridge = REFERENCE in open_sensor
    inputs = (SENSOR, REFERENCE) if has_bridge else (BIAS,)
    far_v = amplifier.output_from_rail_v
    margins_v = [
        _bridge_amplifier_margin_v(volts, supply, supply_v)
        if has_bridge
        else min(supply_v - far_v - volts[TACTILE], volts[TACTILE] - far_v)
        for volts in (open_sensor, pressed)
    ]

    return VoltageLimits(
        signal_ground_v=open_sensor[supply.signal_ground],
        min_tactile_v=min(open_sensor[TACTILE], pressed[TACTILE]),
        max_tactile_v=max(open_sensor[TACTILE], pressed[TACTILE]),
        sensor_amplifier_margin_v=min(margins_v),
        max_sensor_input_v=max(volts[net] for volts in (open_sensor, pressed) for net in inputs),
        sensor_input_limit_v=supply_v - _INPUT_UPPER_MARGIN_V if has_bridge else supply_v,
        filter_peak_v=swing.peak_v,
        filter_trough_v=swing.trough_v,
        filter_guaranteed_trough_v=swing.guaranteed_trough_v,
        has_phase_reversal=swing.has_phase_reversal,
        vibration_peak_v=swing.even_v / gain,
        max_envelope_v={"diode": swing.peak_v - DIODE_V, "precision": swing.even_v - DIODE_V}.get(
            rectifier
        ),
        clamp_high_rail_v=supply_v,
        tactile_pin_ohm=tactile_pin_ohm,
        output_pin_ohm=output_pin_ohm,
        has_filtered_output=supply.signal_ground == VMID,
        adc_low_v=detector.adc_low_v,
        adc_range_v=detector.adc_range_v,
    )


def describe_filter_swing(limits: VoltageLimits) -> str:
    swing = (
        f"the filter swings {limits.filter_peak_v:.1f} V up and {limits.filter_trough_v:.1f} V down"
    )
    if not limits.has_phase_reversal:
        return f"{swing} (typical, into 10 kohm)"

    return (
        f"{swing}, where the TL082's input common-mode range ends (typical, into 10 kohm; "
        f"{limits.filter_guaranteed_trough_v:.1f} V down guaranteed); below that its output jumps "
        "up"
    )


def describe_adc_range(limits: VoltageLimits) -> str:
    adc = f"an ADC with a range of {limits.adc_range_text}"
    over_v = limits.adc_overrange_v
    if not over_v:
        return f"{adc} covers all signals"

    needed = f"set detector.adc_range_v to at least {limits.adc_range_v + over_v:.2f}"
    return f"{adc} clips the top {over_v:.2f} V: divide the signals ahead of it, or {needed}"


def adc_range_warnings(limits: VoltageLimits) -> Iterator[str]:
    """Yield a warning if the ADC clips the tactile voltage: slip does not show then."""
    if limits.max_tactile_v > limits.adc_range_v:
        yield (
            f"the tactile voltage, up to {limits.max_tactile_v:.2f} V, is clipped: "
            f"{describe_adc_range(limits)}."
        )


def _bridge_amplifier_margin_v(volts: dict[str, float], supply: Supply, supply_v: float) -> float:
    """Return the smallest margin of the bridge amplifier's voltages at an operating point [V]."""
    reference_v = volts[REFERENCE]
    sensor_v = volts[SENSOR]
    output_v = volts[TACTILE]
    lower_v = volts[supply.negative_rail]
    common_v = (reference_v + sensor_v) / 2.0
    # The amplified difference of its inputs.
    half_v = abs(output_v - volts[supply.signal_ground]) / 2.0

    return min(
        supply_v - _INTERNAL_MARGIN_V - (common_v + _INPUT_SHIFT_V + half_v),
        common_v + _INPUT_SHIFT_V - half_v - lower_v,
        supply_v - OUTPUT_UPPER_MARGIN_V - output_v,
        output_v - lower_v - OUTPUT_LOWER_MARGIN_V,
    )
