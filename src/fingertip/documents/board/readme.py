"""Data of the README in a board's folder, whose text is `readme.md`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from fingertip.board.analysis import interference
from fingertip.board.analysis.board_values import TOUCHES, BoardValues
from fingertip.board.analysis.limits import describe_adc_range
from fingertip.board.analysis.noise import NOISE_FORCE_N, noise_warning
from fingertip.board.circuits.channels import PLACES, describe_sockets, list_sockets
from fingertip.board.components import values as ratings
from fingertip.board.components.front_end import (
    MAX_FORCE_N,
    POWER_UP_S,
    Bridge,
    sensor_conductance_s,
)
from fingertip.board.fabrication import bom
from fingertip.board.kicad import project
from fingertip.board.kicad.project import StoredProject
from fingertip.board.parts import table
from fingertip.board.parts.circuit import SENSOR_CONNECTOR, Circuit, Component
from fingertip.board.parts.symbols import CAPACITOR, RESISTOR
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE, NAMES
from fingertip.design import Design
from fingertip.design.formulas import filter as formulas
from fingertip.design.rules.amplifiers import CONTROLLER_RANGE_V
from fingertip.documents import wiring
from fingertip.documents.template import render
from fingertip.foundation.errors import join_words

_ELSEWHERE = "none: its maker or a distributor"
_NO_DIRECTION = (RESISTOR, CAPACITOR)
"""Symbols of components that may be turned by 180 degrees."""


def folder_readme(
    circuit: Circuit, stored: StoredProject, values: BoardValues, design: Design
) -> bytes:
    placement = stored.placement
    limits = values.voltage_limits
    channels = design.board.channels
    adc_range = describe_adc_range(limits)

    return render(
        "board/readme.md",
        **collect_board(values, design),
        response=values.achieved_response,
        channels=channels,
        places=PLACES,
        fingers=[f"{k} {name}" for k, name in enumerate(NAMES[:channels], start=1)],
        sockets="; ".join(describe_sockets()[:channels]),
        size_mm=f"{placement.width:g} x {placement.height:g}",
        unlabelled=[
            name
            for name, part in placement.parts.items()
            if name[0] in "RC" and not part.is_labelled
        ],
        all_unlabelled=not any(
            part.is_labelled for name, part in placement.parts.items() if name[0] in "RC"
        ),
        name=circuit.name,
        project=project,
        cables=list(_list_cables(circuit, design)),
        plug_wires=[
            (join_words(references), wire, table.load_sources()[wire.source].title)
            for wire, references in table.group_plug_wires(circuit).items()
        ],
        limits=limits,
        adc_range=adc_range[:1].upper() + adc_range[1:],
        amplifier=AMPLIFIER_CATALOGUE[values.amplifier],
        touches=TOUCHES,
        pin_ohm=max(limits.tactile_pin_ohm, limits.output_pin_ohm),
        ratings=ratings,
        circuit=circuit,
        crosstalk=()
        if values.bridge or values.shared
        else interference.compute_cable_crosstalk(circuit, design.board),
        idle_v=values.tactile_response.open_v,
        pressed_v=values.tactile_response.tactile_v(sensor_conductance_s(MAX_FORCE_N)),
        wiring=wiring,
        supply_range_v=CONTROLLER_RANGE_V,
        power_up_s=POWER_UP_S,
        noise_force_n=NOISE_FORCE_N,
        noise_warning=noise_warning(values.noise, design.detector.threshold_v),
        interference=interference,
        **_collect_order(circuit, stored),
        bridge_shift_v=_find_bridge_shift_v(values.bridge, design.board.supply_v)
        if values.bridge
        else 0.0,
        missing_numbers=bom.missing_numbers_note(circuit),
        unconfirmed=table.UNCONFIRMED,
        cost_usd=bom.estimate_cost(circuit),
        extended=bom.list_extended(circuit),
        rotations=table.load_sources()[bom.load_rotations()[0].source],
    ).encode()


def collect_board(values: BoardValues, design: Design) -> dict[str, Any]:
    """Data that every document of a board refers to."""
    return {
        "values": values,
        "board": design.board,
        "changes": f" --set board.channels={design.board.channels}"
        if design.board.channels > 1
        else "",
        "detector": design.detector,
        "supply": ratings.SUPPLIES[values.variant],
        "is_for_controller": design.board.is_for_controller,
        "has_envelope": design.board.has_envelope,
        "has_slip": values.comparator_levels is not None,
        "levels": values.comparator_levels,
        "formulas": formulas,
    }


def _list_cables(circuit: Circuit, design: Design) -> Iterator[tuple[str, ...]]:
    """Yield what to buy for each connector's cable, with its
    numbers or the reason why there are none.
    """
    sensors = {SENSOR_CONNECTOR, *list_sockets()}
    plug = table.find_plug_wire(
        circuit.component(SENSOR_CONNECTOR if design.board.channels == 1 else list_sockets()[0])
    )
    # Bought leads, which are as thick as their plug takes, may not pass the finger.
    takes_leads = plug is not None and design.sensor.wire_diameter_mm >= plug.max_insulation_mm
    # Sockets of one size take the same plugs, and are one line.
    groups: dict[str, list[Component]] = {}
    for connector in table.list_connectors(circuit):
        groups.setdefault(connector.footprint, []).append(connector)

    for alike in groups.values():
        names = join_words([connector.reference for connector in alike])
        for mating in table.list_mating_parts(alike[0]):
            # The cable of a sensor is its own wires.
            is_sensor = alike[0].reference in sensors
            if is_sensor and mating.kind == "cable":
                continue
            if is_sensor and mating.kind == "leads" and not takes_leads:
                continue

            part = mating.part
            numbers = (
                (f"{part.manufacturer} {part.number}", part.lcsc or _ELSEWHERE)
                if part
                else (mating.reason, "")
            )
            count = mating.count(len(circuit.list_wires(alike[0])))
            # Where the cable is left out, its plug is no alternative.
            is_alternative = not (is_sensor and mating.kind == "plug")
            item = f"{mating.choice} {mating.item}".lstrip() if is_alternative else mating.item
            yield (names, str(count * len(alike)), item, *numbers)


def _collect_order(circuit: Circuit, stored: StoredProject) -> dict[str, Any]:
    """Figures that board house and assembly house ask for, and the parts that need care."""
    components = bom.purchased_components(circuit)
    assembled = [c for c in components if bom.is_assembled(c)]
    placement = stored.placement
    pads = {reference: part.pads for reference, part in placement.parts.items()}
    through_hole = [
        c for c in components if any(pad.drill and pad.is_plated for pad in pads[c.reference])
    ]

    return {
        "components": components,
        "assembled": assembled,
        "layout": placement,
        "clearance_mm": stored.clearance_mm,
        "unplated_mm": sorted(
            {
                pad.drill
                for group in pads.values()
                for pad in group
                if pad.drill and not pad.is_plated
            }
        ),
        "by_house": [c.reference for c in through_hole if c in assembled],
        "by_hand": [c.reference for c in components if c not in assembled],
        "unknown_rotations": [
            c.reference
            for c in assembled
            if c.symbol not in _NO_DIRECTION and bom.find_rotation(c.footprint) is None
        ],
    }


def _find_bridge_shift_v(bridge: Bridge, supply_v: float) -> float:
    """Largest shift of the tactile voltage by an error of 1 % in one resistor of the bridge [V]."""
    idle_v = bridge.tactile_v(0.0, supply_v)
    names = ("sensor_top_ohm", "sensor_shunt_ohm", "reference_top_ohm", "reference_bottom_ohm")
    changed = (replace(bridge, **{name: 1.01 * getattr(bridge, name)}) for name in names)

    return max(abs(each.tactile_v(0.0, supply_v) - idle_v) for each in changed)
