"""README of the library for controllers: use, wiring, costs and accuracy."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board import board_circuit
from fingertip.board.analysis.board_values import find_tactile_response
from fingertip.board.circuits.channels import split_net
from fingertip.board.components.front_end import POWER_UP_S
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import HOST_CONNECTOR
from fingertip.board.parts.nets import GND, POWER_IN
from fingertip.catalogues.electronics import NAMES
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design import Design
from fingertip.design.formulas.filter import signal_ground_ratio
from fingertip.documents.template import WIDTH, render_page
from fingertip.documents.wiring import SKETCH_PINS, list_notes, name_signals
from fingertip.firmware import fingers as capacity
from fingertip.firmware import packaging
from fingertip.firmware.fingers import Fingers, list_places
from fingertip.slip.detectors.fast_coefficients import load_model
from fingertip.slip.detectors.fast_settings import TICK_S, FilteredSignal


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


def render_readme(design: Design, fingers: Fingers) -> str:
    shared = {
        "design": design,
        "fingers": fingers,
        "packaging": packaging,
        "capacity": capacity,
    }
    shared["forces"] = _describe_forces(design, fingers)
    streamed = (*fingers.designs, design)[0]
    shared["is_bundled"] = is_bundled = streamed.name in list_bundled_files(DESIGN)
    shared["file"] = streamed.name if is_bundled else f"{streamed.name}.toml"
    if not design.board.has_filter:
        return render_page("board/divider_firmware.md", WIDTH, **shared)

    converter = design.detector
    circuit = board_circuit(select_components(design), design.board.channels)
    rails = {GND: "ground", POWER_IN: f"{design.board.supply_v:g} V"}
    pins = circuit.list_wires(circuit.component(HOST_CONNECTOR))
    signals = name_signals(circuit, design.board.supply_v)

    return render_page(
        "firmware.md",
        WIDTH,
        **shared,
        reads_filtered=FilteredSignal.from_design(design) is not None,
        power_up_s=POWER_UP_S,
        open_code=round(
            (find_tactile_response(design).open_v - converter.adc_low_v) / converter.adc_step_v
        ),
        rest_code=round(
            signal_ground_ratio(design.board) * design.board.supply_v / converter.adc_step_v
        ),
        boards=capacity.list_controllers(design),
        most_fingers=len(NAMES),
        peak_fingers=math.ceil(
            fingers.count / max(1, round(TICK_S * design.detector.sample_rate_hz))
        ),
        connector=HOST_CONNECTOR,
        pins=[
            Pin(
                number=number,
                print=signals[net].print,
                signal=signals[net].far_end,
                input=_find_input(net, fingers),
                rail=rails.get(net, ""),
            )
            for number, net in pins
        ],
        wiring_notes=list(list_notes(circuit, design.board.supply_v)),
        tick_ms=1e3 * TICK_S,
        trees=load_model().trees,
    )


def _describe_forces(design: Design, fingers: Fingers) -> dict[str, list[str]]:
    """Describe how far the forces of the fingers can be trusted;
    fingers of which the same is true stand together.
    """
    names: dict[str, list[str]] = {}
    for name, finger in zip(
        fingers.names, fingers.designs or (design,) * fingers.count, strict=True
    ):
        names.setdefault(finger.force_curve.describe(finger.sensor.model), []).append(name)

    return names


def _find_input(net: str, fingers: Fingers) -> str | None:
    channel, own = split_net(net)
    places = list_places(fingers.names)
    if own not in SKETCH_PINS or (channel and channel not in places):
        return None

    return (
        fingers.inputs[places.index(channel)][list(SKETCH_PINS).index(own)]
        if channel
        else SKETCH_PINS[own]
    )
