"""Gate of a board: the conditions under which its circuit works, each with value and limit.

A required condition that fails means that the board cannot work; `fingertip.design.rules.board`
refuses such a design by closed forms before a circuit exists. The converter is the exception: a
design may belong to recordings of another board, so that only its board is refused. An advised
condition that fails is a warning.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from fingertip.board.analysis import loads
from fingertip.board.analysis.limits import VoltageLimits
from fingertip.board.analysis.response import RECTIFYING_DIODE
from fingertip.board.analysis.thresholds import BLOCKING_DIODE, OutputOffset, ThresholdSpread
from fingertip.board.analysis.tolerance import LEAST_YIELD
from fingertip.board.circuits.network import build_network, list_amplifiers
from fingertip.board.components.front_end import MAX_FORCE_N, sensor_conductance_s
from fingertip.board.components.values import SUPPLIES
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.board.parts.nets import FILTERED, STAGE1_OUT, VMID
from fingertip.board.parts.symbols import SYMBOLS
from fingertip.catalogues.electronics import LOW_OFFSET_AMPLIFIER, Amplifier
from fingertip.design import Design
from fingertip.design.formulas import amplifiers
from fingertip.design.formulas.filter import find_preferred_neighbours
from fingertip.design.rules.amplifiers import (
    BANDWIDTH_MARGIN,
    MAX_OFFSET_RATIO,
    MAX_PEAKING_DB,
    MIN_PHASE_MARGIN_DEG,
)
from fingertip.foundation.errors import Issue
from fingertip.foundation.files import format_figure
from fingertip.foundation.validation import Comparison, Relation, round_up

GOOD_OFFSET_RATIO = 0.25
"""Ratio of an output's offset to its swing above which a warning is due."""

Level = Literal["required", "advised"]


@dataclass(frozen=True)
class GateCondition(Comparison):
    subject: str = ""
    level: Level = "required"
    """A board that fails a required condition cannot work; with an advised one it works badly."""
    remedy: str = ""
    """Change that helps where it fails; empty where a rule refuses first."""

    def as_data(self) -> dict[str, Any]:
        keys = ("name", "subject", "value", "limit", "unit")
        data = {key: getattr(self, key) for key in keys} | {
            "bound": self.relation,
            "level": self.level,
        }
        return data | {"passed": self.passed, "remedy": self.remedy}

    @property
    def margin(self) -> float:
        """Ratio of limit to value (inverse for a lower bound); 1 or more if the condition holds."""
        numerator, denominator = (
            (self.limit, self.value) if self.relation == "at most" else (self.value, self.limit)
        )
        if denominator > 0.0:
            return numerator / denominator

        return math.inf if self.passed else 0.0


def _compare(
    relation: Relation,
    name: str,
    subject: str,
    value: float,
    limit: float,
    unit: str,
    level: Level = "required",
    remedy: str = "",
) -> GateCondition:
    return GateCondition(
        name=name,
        value=value,
        limit=limit,
        unit=unit,
        relation=relation,
        subject=subject,
        level=level,
        remedy=remedy,
    )


at_most = functools.partial(_compare, "at most")
at_least = functools.partial(_compare, "at least")

CURRENT = "output current"
OFFSET = "offset over swing"
BANDWIDTH = "gain-bandwidth product"
MARGIN = "phase margin"
PEAKING = "gain beyond the band"
INPUT = "input of the sensor's amplifier"
HIGHEST = "highest tactile voltage"
LOWEST = "lowest tactile voltage"
FLOOR = "envelope's lowest offset"
CLAMP = "voltage at the converter's pins"
SERIES = "capacitors off series E12"
TRIM = "shift to trim"
SUPPLY = "voltage across the amplifier"


def check_gate(
    circuit: Circuit,
    design: Design,
    limits: VoltageLimits,
    rises: bool,
    passband_gain: float,
    rails: Mapping[str, float],
    offset: OutputOffset | None,
    spread: ThresholdSpread | None,
) -> tuple[GateCondition, ...]:
    """Check all conditions of a board.

    `rises`: the tactile voltage rises with the force. Units: `rails` [V].
    """
    board = design.board
    amplifier = amplifiers.choose_amplifier(board)
    needed_hz = BANDWIDTH_MARGIN * board.passband_gain * board.cutoff_hz
    supply_v = amplifiers.total_supply_v(board)
    farads = (parse_component_value(c.value) for c in circuit.components if c.symbol.name == "C")
    odd_capacitors = sum(below != above for below, above in map(find_preferred_neighbours, farads))
    trim = []

    if spread:
        # What offsets and currents shift the comparator's threshold by, and what its trimmer takes
        # back.
        remedy = f"set board.amplifier={LOW_OFFSET_AMPLIFIER}, or raise detector.threshold_v"
        trim = [at_most(TRIM, "RV1", spread.to_trim_v, spread.trim_v, "V", "advised", remedy)]

    return (
        at_most(SUPPLY, "U1", supply_v, amplifier.max_supply_v, "V"),
        at_least(SUPPLY, "U1", supply_v, amplifier.min_supply_v, "V"),
        *_check_currents(circuit, design, limits, rails),
        *_check_offsets(circuit, design, amplifier),
        at_least(BANDWIDTH, "U1", amplifier.bandwidth_hz, needed_hz, "Hz"),
        *_check_stability(circuit, amplifier, passband_gain),
        at_most(INPUT, "U2", limits.max_sensor_input_v, limits.sensor_input_limit_v, "V"),
        *_check_converter(circuit, limits, rises, offset),
        at_most(SERIES, "C1 to C20", float(odd_capacitors), 0.0, ""),
        *trim,
    )


YIELD = "share of boards within 10 %"


def check_yields(yields: Mapping[str, float]) -> Iterator[GateCondition]:
    """Check the share of boards whose cutoff and gain are near the design's, by quantity."""
    remedy = (
        "set board.capacitor_tolerance_percent=5, board.resistor_tolerance_percent=1 and "
        "board.series=E96"
    )
    for name, subject in (("cutoff_hz", "cutoff"), ("passband_gain", "gain")):
        yield at_least(YIELD, subject, yields[name], LEAST_YIELD, "", "advised", remedy)


def _check_converter(
    circuit: Circuit, limits: VoltageLimits, rises: bool, offset: OutputOffset | None
) -> Iterator[GateCondition]:
    at_top, at_bottom = ("firm", "light") if rises else ("light", "firm")
    yield at_most(
        HIGHEST,
        "TACTILE",
        limits.max_tactile_v,
        limits.adc_range_v,
        "V",
        "required",
        f"the converter is saturated in {at_top} contacts: set "
        f"detector.adc_range_v={round_up(max(limits.max_tactile_v, 0.01)):g}, or divide the "
        "signals ahead of it",
    )
    yield at_least(
        LOWEST,
        "TACTILE",
        limits.min_tactile_v,
        limits.adc_low_v,
        "V",
        "required",
        f"the converter is saturated in {at_bottom} contacts: set detector.adc_polarity=bipolar",
    )

    if offset:
        yield at_least(
            FLOOR,
            "ENVELOPE",
            limits.signal_ground_v + offset.min_v,
            limits.adc_low_v,
            "V",
            "advised",
            "the converter cannot tell how far the envelope lies below its range: set "
            "detector.adc_polarity=bipolar",
        )

    clamps = ", ".join(c.reference for c in circuit.components if c.symbol == SYMBOLS["BAT54S"])
    yield at_most(
        CLAMP,
        clamps or "U1, U2",
        limits.clamp_high_rail_v,
        limits.adc_range_v,
        "V",
        "advised",
        "only the supply of the board limits it, which pins of a smaller range need not bear; "
        "give the converter a "
        "range of the supply or more",
    )


def _check_currents(
    circuit: Circuit, design: Design, limits: VoltageLimits, rails: Mapping[str, float]
) -> Iterator[GateCondition]:
    """Compare the peak output current of each amplifier with its data sheet."""
    supply = SUPPLIES[design.board.variant]
    board = design.board
    amplifier = amplifiers.choose_amplifier(board)
    # The largest vibration is that which reaches the swing, no nearer to a rail than the current is
    # stated for.
    scale = amplifiers.loaded_swing_v(board, amplifier) / amplifiers.input_swing_v(board, amplifier)
    vibration_v = scale * limits.vibration_peak_v
    peak_a = 0.0
    currents = loads.compute_output_currents(circuit, amplifier.bandwidth_hz, board.cutoff_hz)

    if board.variant == "article":
        # The largest peak of the current through the rectifying diode over the band of the
        # vibrations.
        ohm, farad = (parse_component_value(circuit.component(name).value) for name in ("R6", "C4"))
        gain = next(
            np.abs(current.gain) for current in currents if current.output.amplifier == "U1b"
        )
        frequencies = np.geomspace(*loads.signal_band_hz(board.cutoff_hz), len(gain)).tolist()
        peaks_v = (vibration_v * gain).tolist()
        pairs = zip(peaks_v, frequencies, strict=True)
        peak_a = max(
            amplifiers.compute_charging_current_a(peak_v, f_hz, ohm, farad)
            for peak_v, f_hz in pairs
        )

    for current in currents:
        data = current.output.data
        if data is None:
            continue

        linear_a = vibration_v * float(np.abs(current.filter_s).max())
        limit_a = data.output_current_a
        if board.variant != "article":
            linear_a = vibration_v * float(np.abs(current.filter_s + current.diode_s).max())
        elif current.diode_s.any():
            linear_a += peak_a

        if current.output.net == VMID:
            linear_a += _constant_current_a(circuit, supply.signal_ground, rails)
            limit_a *= amplifiers.MID_RAIL_RATIO

        yield at_most(CURRENT, current.output.amplifier, linear_a, limit_a, "A")


def _constant_current_a(circuit: Circuit, buffered: str, rails: Mapping[str, float]) -> float:
    """Largest constant current of the buffer of a net [A], over all forces on the sensor."""
    largest_a = 0.0
    for force_n in (0.0, MAX_FORCE_N):
        network = build_network(
            circuit, sensor_s=sensor_conductance_s(force_n), conducting=[RECTIFYING_DIODE]
        )
        volts = network.operating_point(rails)
        total_a = 0.0

        for component in circuit.components:
            if component.symbol.name == "R" or component.value == "FSR":
                first, second = (circuit.net_by_pin[component.reference, pin] for pin in "12")
                if buffered in (first, second):
                    far_end = first if second == buffered else second
                    siemens = float(network.values[component.reference])
                    total_a += siemens * (volts[far_end] - volts[buffered])

        largest_a = max(largest_a, abs(total_a))

    return largest_a


def _check_offsets(
    circuit: Circuit, design: Design, amplifier: Amplifier
) -> Iterator[GateCondition]:
    """Compare the offset of each filter output with its swing, which the offset reduces."""
    ground = SUPPLIES[design.board.variant].signal_ground
    network = build_network(circuit, amplifier.bandwidth_hz)
    swing_v = amplifiers.input_swing_v(design.board, amplifier)

    for net in (STAGE1_OUT, FILTERED):
        transfers = network.restrict(net, ground).constant_transfers(net, ground)
        offset_v = 0.0
        for output in list_amplifiers(circuit):
            if output.data:
                offset_v += abs(transfers.get(output.net, 0.0)) * output.data.max_offset_v

        yield at_most(OFFSET, net, offset_v / swing_v, MAX_OFFSET_RATIO, "")
        yield at_most(
            OFFSET,
            net,
            offset_v / swing_v,
            GOOD_OFFSET_RATIO,
            "",
            "advised",
            "set board.variant=precision, which does not amplify the offset, or lower "
            "board.passband_gain",
        )


def _check_stability(
    circuit: Circuit, amplifier: Amplifier, passband_gain: float
) -> Iterator[GateCondition]:
    """Check the phase margin of each loop with either diode, and the gain beyond the band."""
    margins: dict[str, float] = {}
    has_rectifier = any(part.reference == BLOCKING_DIODE for part in circuit.components)
    diodes = [RECTIFYING_DIODE, BLOCKING_DIODE] if has_rectifier else [""]
    networks = [
        build_network(circuit, amplifier.bandwidth_hz, conducting=[diode]) for diode in diodes
    ]

    for network in networks:
        for name, margin_deg in loads.compute_phase_margins_deg(circuit, network).items():
            margins[name] = min(margin_deg, margins.get(name, math.inf))

    for name, margin_deg in margins.items():
        # A loop whose gain never reaches 1 cannot oscillate, and has no phase margin.
        if margin_deg == math.inf:
            continue

        yield at_least(MARGIN, name, margin_deg, MIN_PHASE_MARGIN_DEG, "degree")
        yield at_least(
            MARGIN,
            name,
            margin_deg,
            amplifiers.GOOD_PHASE_MARGIN_DEG - 1e-6,
            "degree",
            "advised",
            "lower board.r5_ohm, or choose another board.amplifier",
        )

    peaking_db = loads.compute_peaking_db(circuit, networks[0], passband_gain)
    yield at_most(PEAKING, "FILTERED", peaking_db, MAX_PEAKING_DB, "dB")


def find_smallest_margin(conditions: Iterable[GateCondition], *names: str) -> float:
    """Find the smallest margin of the required conditions, or of those with certain names."""
    if names:
        chosen = [condition for condition in conditions if condition.name in names]
    else:
        chosen = [
            condition
            for condition in conditions
            if condition.level == "required" and condition.limit > 0.0
        ]

    return min((condition.margin for condition in chosen), default=math.nan)


def gate_warnings(conditions: Iterable[GateCondition]) -> Iterator[str]:
    """Describe the failed conditions; an advised one yields to a required one about the same."""
    failures = [condition for condition in conditions if not condition.passed]
    required = {
        (condition.name, condition.subject)
        for condition in failures
        if condition.level == "required"
    }

    for condition in failures:
        if condition.level == "required" or (condition.name, condition.subject) not in required:
            remedy = f"; {condition.remedy}" if condition.remedy else ""
            yield f"{describe_condition(condition)}{remedy}."


def find_refusals(conditions: Iterable[GateCondition]) -> Iterator[Issue]:
    """Yield the failed required conditions as issues; a board with one is not made."""
    for condition in conditions:
        if condition.level == "required" and not condition.passed:
            field = "detector.adc_range_v" if condition.name == HIGHEST else "detector.adc_polarity"
            yield Issue(
                field if condition.remedy else "board",
                f"{describe_condition(condition)}; {condition.remedy}.",
            )


def describe_condition(condition: GateCondition) -> str:
    unit = f" {condition.unit}" if condition.unit else ""
    value, limit = (format_figure(number, 3) for number in (condition.value, condition.limit))
    if condition.passed:
        verb = "is"
    elif condition.level == "required":
        verb = "must be"
    else:
        verb = "should be"

    return (
        f"{condition.name} ({condition.subject}): {value}{unit}, {verb} {condition.relation} "
        f"{limit}{unit}"
    )
