"""Figures of a design's board: component values, response, noise, limits, and errata of the
article.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

from fingertip.board.analysis import interference, limits, response, thresholds
from fingertip.board.analysis.gate import GateCondition, check_gate, check_yields
from fingertip.board.analysis.interference import SharedFigures, compute_shared_figures
from fingertip.board.analysis.limits import adc_range_warnings
from fingertip.board.analysis.loads import find_filter_load_ohm
from fingertip.board.analysis.noise import NoiseLevels, compute_noise_levels
from fingertip.board.analysis.tactile_response import TactileResponse, find_tactile_response
from fingertip.board.analysis.tolerance import compute_yields
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import Value, build_network, filter_quantities
from fingertip.board.components.selection import FilterSelection, select_filter
from fingertip.board.components.values import SUPPLIES, ComponentValues, select_components
from fingertip.board.parts.nets import GND, VCC, VEE
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE, ARTICLE_AMPLIFIER
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import choose_amplifier, find_gain_bandwidth_hz
from fingertip.design.parameters.board_and_detector import Board


@dataclass(frozen=True)
class BoardValues(ComponentValues):
    """Component values of one design's board, and the resulting response, noise and limits."""

    tactile_response: TactileResponse
    target_response: response.FrequencyResponse
    achieved_response: response.FrequencyResponse
    """Response of the circuit with preferred values and amplifiers as built."""
    output_offset: thresholds.OutputOffset | None
    """Offset of the envelope; None on boards without a precision rectifier."""
    supply_ripple: interference.SupplyRipple
    noise: NoiseLevels
    comparator_levels: thresholds.ComparatorLevels | None
    """Thresholds of the comparator; None in variants without one."""
    aliasing: interference.AliasAttenuation
    voltage_limits: limits.VoltageLimits
    filter_load_ohm: float
    """Smallest impedance that U1 drives among vibrations, without the rectifying diode."""
    threshold_spread: thresholds.ThresholdSpread | None
    """Mean and worst case of the comparator's threshold; None in variants without one."""
    gate: tuple[GateCondition, ...]
    errata: tuple[Erratum, ...]
    shared: SharedFigures | None
    """Figures that the channels of several fingers share; None on a board of one."""

    def as_data(self) -> dict[str, Any]:
        gate = {"gate": [condition.as_data() for condition in self.gate]}
        plain: dict[str, Any] = _round_to_ten_digits(asdict(self) | gate)
        return plain


def _round_to_ten_digits(data: Any) -> Any:
    """Round all numbers to ten significant digits: their last bits differ between processors."""
    if isinstance(data, dict):
        return {key: _round_to_ten_digits(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_round_to_ten_digits(value) for value in data]

    return float(f"{data:.10g}") if isinstance(data, float) else data


def compute_filter(board: Board) -> tuple[FilterSelection, response.FrequencyResponse]:
    """Compute the filter alone: its components and the response they achieve.

    A sweep computes thousands of them.
    """
    selection = select_filter(board)
    amplifier = choose_amplifier(board)
    model, values = _model_variant(board.variant)
    values = {**values, **filter_quantities(selection.by_reference(), amplifier)}

    return selection, response.compute_response(
        model, values, amplifier.bandwidth_hz, board.envelope_cutoff_hz
    )


@functools.cache
def _model_variant(variant: str) -> tuple[response.FilterModel, Mapping[str, Value]]:
    """Return the filter model of a variant; its designs differ in values only."""
    design = Design(board={"variant": variant, "supply_v": SUPPLIES[variant].nominal_v})
    circuit = board_circuit(select_components(design))
    network = build_network(circuit, find_gain_bandwidth_hz(design.board))

    return response.model_filter(circuit), network.values


@functools.lru_cache(maxsize=16)
def board_values(design: Design) -> BoardValues:
    """Compute the board's figures. The last few designs are remembered."""
    board = design.board
    detector = design.detector
    components = select_components(design)
    amplifier = AMPLIFIER_CATALOGUE[components.amplifier]
    bandwidth_hz = amplifier.bandwidth_hz
    circuit = board_circuit(components)
    supply = SUPPLIES[board.variant]
    rectifier = response.find_rectifier(circuit)
    model = response.model_filter(circuit)
    network = build_network(circuit, bandwidth_hz)
    achieved = response.compute_response(
        model, network.values, bandwidth_hz, board.envelope_cutoff_hz
    )
    envelope_gain = response.find_envelope_gain(model, circuit, network.values)
    voltage_limits = limits.compute_voltage_limits(
        circuit,
        supply=supply,
        supply_v=board.supply_v,
        amplifier=amplifier,
        gain=achieved.passband_gain,
        detector=detector,
    )
    offset = None
    if rectifier == "precision":
        offset = thresholds.compute_output_offset(circuit, bandwidth_hz, supply.signal_ground)

    rails = {GND: 0.0, VCC: board.supply_v, VEE: -board.supply_v}
    levels = spread = None
    if components.comparator_stage:
        levels = thresholds.compute_comparator_levels(circuit, rails, supply.signal_ground)
        spread = thresholds.compute_threshold_spread(
            circuit,
            gain_bandwidth_hz=bandwidth_hz,
            levels=levels,
            rails=rails,
            resistor_percent=board.resistor_tolerance_percent,
        )

    ripple = interference.compute_supply_ripple(
        circuit,
        gain_bandwidth_hz=bandwidth_hz,
        cutoff_hz=board.cutoff_hz,
        signal_ground=supply.signal_ground,
        threshold_v=detector.threshold_v,
        envelope_gain=envelope_gain,
    )
    tactile_response = find_tactile_response(design)
    return BoardValues(
        **{field.name: getattr(components, field.name) for field in fields(components)},
        tactile_response=tactile_response,
        target_response=response.target_response(board),
        achieved_response=achieved,
        output_offset=offset,
        supply_ripple=ripple,
        noise=compute_noise_levels(circuit, bandwidth_hz, envelope_gain),
        comparator_levels=levels,
        aliasing=interference.compute_alias_attenuation(circuit, design),
        voltage_limits=voltage_limits,
        filter_load_ohm=find_filter_load_ohm(circuit, bandwidth_hz, board.cutoff_hz),
        threshold_spread=spread,
        gate=(
            *check_gate(
                circuit,
                design=design,
                limits=voltage_limits,
                rises=tactile_response.rises,
                passband_gain=achieved.passband_gain,
                rails=rails,
                offset=offset,
                spread=spread,
            ),
            *check_yields(compute_yields(model, network.values, circuit, board)),
        ),
        errata=board_errata(components.amplifier, rectifier),
        shared=(
            compute_shared_figures(board_circuit(components, board.channels), bandwidth_hz, board)
            if board.channels > 1
            else None
        ),
    )


def find_range_warnings(design: Design) -> Iterator[str]:
    """Yield a warning if the converter clips the tactile voltage."""
    board = design.board
    converter = design.detector

    if board.has_filter:
        yield from adc_range_warnings(board_values(design).voltage_limits)
    elif board.supply_v > converter.adc_range_v:
        yield (
            f"the divider's voltage, up to {board.supply_v:g} V, exceeds the converter's "
            f"{converter.adc_range_text}; "
            f"use --set board.supply_v={converter.adc_range_v:g}, from the pin of the converter's "
            "reference."
        )


# Errata of the article about its own board.

TOUCHES = (
    "in simulations of the article's board a press to 1.5 N takes the filtered signal to -2.4 V "
    "if the force rises "
    "within 30 ms and to -4.4 V within 20 ms, but only to -0.1 V within 200 ms; a knock of 0.25 N "
    "within 4 ms on a "
    "held object takes it to -3.0 V"
)
"""Response of the filtered signal to touches; simulated in `tests/board/test_touches.py`."""


@dataclass(frozen=True)
class Erratum:
    """One error of the article about its own board.

    Its components are C1 = C2 = C3 = 1 uF, R1 = 2.4k, R2 = 1.2k, R3 = 4.7k, R4 = 1.5k, R5 = 100k,
    R_LP = 2k and C_LP = 2.2 uF.
    """

    subject: str
    statement: str
    """Statement or omission of the article."""
    correction: str
    """Correct statement, with a note if it does not apply to the board at hand."""


def load_errata() -> tuple[Erratum, ...]:
    rows = json.loads((Path(__file__).parent / "errata.json").read_text("utf-8"))
    return tuple(
        Erratum(**row | {"correction": row["correction"].format(touches=TOUCHES)}) for row in rows
    )


def board_errata(amplifier: str, rectifier: response.Rectifier) -> tuple[Erratum, ...]:
    notes = {}
    if amplifier != ARTICLE_AMPLIFIER:
        notes["input range of the amplifiers"] = (
            f"it has a {AMPLIFIER_CATALOGUE[amplifier].order_name} with rail-to-rail inputs"
        )

    if rectifier != "diode":
        notes["offset"] = "C14 is such a capacitor"
        instead = {
            "precision": "it has a precision rectifier and a low-pass",
            "software": "software computes it",
        }
        notes |= dict.fromkeys(("envelope, eq. (11)", "rectifier"), instead[rectifier])

    errata = []
    for erratum in load_errata():
        note = notes.get(erratum.subject)
        if note:
            correction = f"{erratum.correction} (does not apply to this board: {note})"
            erratum = replace(erratum, correction=correction)

        errata.append(erratum)

    return tuple(errata)
