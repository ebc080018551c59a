"""README of the library for controllers: use, wiring, costs and accuracy."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.analysis.tactile_response import find_tactile_response
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.channels import split_net
from fingertip.board.components.front_end import POWER_UP_S
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import HOST_CONNECTOR, Circuit
from fingertip.board.parts.nets import GND, POWER_IN
from fingertip.catalogues.electronics import NAMES, ControllerBoard
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design import Design
from fingertip.design.formulas.filter import signal_ground_ratio
from fingertip.documents.template import WIDTH, render_page
from fingertip.documents.wiring import SKETCH_PINS, list_notes, name_signals
from fingertip.firmware.controller_fit import find_warnings
from fingertip.firmware.fingers import (
    BUFFER_SAMPLES,
    CONVERSIONS,
    CYCLES_PER_INSTRUCTION,
    TASK_CONVERSIONS,
    Fingers,
    Load,
    count_fingers,
    find_load,
    list_controllers,
    list_limits,
    list_places,
)
from fingertip.firmware.measured_costs import cost_table, read_costs
from fingertip.firmware.packaging import NAME
from fingertip.slip.detectors.fast_decision import NEED
from fingertip.slip.detectors.fast_settings import TICK_S, FilteredSignal
from fingertip.slip.detectors.fast_table import load_table


@dataclass(frozen=True)
class Pin:
    """Pin of the board's connector, a row of the table of wiring."""

    number: str
    print: str
    signal: str
    input: str | None
    """Input of the controller; None for one that the detector does not read."""
    rail: str
    """Supply pin of the controller that it leads to; empty for a signal."""


@dataclass(frozen=True)
class Capacity:
    """Fingers that a controller carries, a row of the table of controllers."""

    board: ControllerBoard
    fingers: int
    limited_by: tuple[str, ...]
    """Limits at which it carries no more; none if it carries as many as a library can have."""
    load: Load
    """Load of so many fingers, and of one at least."""


def render_readme(design: Design, fingers: Fingers) -> str:
    streamed = (*fingers.designs, design)[0]
    is_bundled = streamed.name in list_bundled_files(DESIGN)
    shared = {
        "design": design,
        "fingers": fingers,
        "warnings": list(find_warnings(design, fingers.controller)),
        "forces": _describe_forces(design, fingers),
        "is_bundled": is_bundled,
        "file": streamed.name if is_bundled else f"{streamed.name}.toml",
    }
    if not design.board.has_filter:
        return render_page(
            "board/divider_firmware.md",
            WIDTH,
            **shared,
            conversions=CONVERSIONS,
            task_conversions=TASK_CONVERSIONS,
        )

    converter = design.detector
    circuit = board_circuit(select_components(design), design.board.channels)

    return render_page(
        "firmware.md",
        WIDTH,
        **shared,
        library_name=NAME,
        reads_filtered=FilteredSignal.from_design(design) is not None,
        power_up_s=POWER_UP_S,
        open_code=round(
            (find_tactile_response(design).open_v - converter.adc_low_v) / converter.adc_step_v
        ),
        rest_code=round(
            signal_ground_ratio(design.board) * design.board.supply_v / converter.adc_step_v
        ),
        capacities=_list_capacities(design),
        cycles_per_instruction=CYCLES_PER_INSTRUCTION,
        buffer_samples=BUFFER_SAMPLES,
        peak_fingers=math.ceil(
            fingers.count / max(1, round(TICK_S * design.detector.sample_rate_hz))
        ),
        connector=HOST_CONNECTOR,
        pins=_list_pins(design, circuit, fingers),
        wiring_notes=list(list_notes(circuit, design.board.supply_v)),
        costs=read_costs(),
        cost_table=cost_table(),
        tick_ms=1e3 * TICK_S,
        trees=load_table().trees,
        need=NEED,
    )


def _list_capacities(design: Design) -> list[Capacity]:
    rate_hz = design.detector.sample_rate_hz
    capacities = []

    for board in list_controllers(design):
        limits = list_limits(board, rate_hz)
        fingers = count_fingers(board, rate_hz)
        nearest = (name for name, limit in limits.items() if limit == fingers)
        capacities.append(
            Capacity(
                board=board,
                fingers=fingers,
                limited_by=tuple(nearest) if fingers < len(NAMES) else (),
                load=find_load(board, rate_hz, max(fingers, 1)),
            )
        )

    return capacities


def _list_pins(design: Design, circuit: Circuit, fingers: Fingers) -> list[Pin]:
    rails = {GND: "ground", POWER_IN: f"{design.board.supply_v:g} V"}
    signals = name_signals(circuit, design.board.supply_v)

    return [
        Pin(
            number=number,
            print=signals[net].print,
            signal=signals[net].far_end,
            input=_find_input(net, fingers),
            rail=rails.get(net, ""),
        )
        for number, net in circuit.list_wires(circuit.component(HOST_CONNECTOR))
    ]


def _describe_forces(design: Design, fingers: Fingers) -> dict[str, list[str]]:
    """Describe how far the forces of the fingers can be trusted; fingers of which the same is true
    stand together.
    """
    designs = fingers.designs or (design,) * fingers.count
    names: dict[str, list[str]] = {}
    for name, finger in zip(fingers.names, designs, strict=True):
        names.setdefault(finger.force_curve.describe(finger.sensor.model), []).append(name)

    return names


def _find_input(net: str, fingers: Fingers) -> str | None:
    channel, own = split_net(net)
    places = list_places(fingers.names)
    if own not in SKETCH_PINS or (channel and channel not in places):
        return None

    if channel:
        return fingers.inputs[places.index(channel)][list(SKETCH_PINS).index(own)]

    return SKETCH_PINS[own]
