"""Hardware to buy: bill of materials of a casting, wires of the sensor, and what the interface is mounted with.

A bolt is bought as a machine screw, threaded to the head or not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

from fingertip.board import board_circuit
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import SENSOR_CONNECTOR
from fingertip.board.parts.table import PlugWire, find_plug_wire, list_mating_parts
from fingertip.design import Design
from fingertip.design.geometry.dimensions import THREAD_MM
from fingertip.design.geometry.mold_layout import size_clamp_bolts
from fingertip.design.interfaces import interface_of

_SLACK_MM = 10.0
"""Slack of the wires besides what a joint takes up [mm]. An assumption."""
MIN_LENGTH_MM = 150.0
"""Least length of each wire, from the solder joint to the plug of the board [mm]. An assumption."""
_FLEXIBLE_AWG = (28, 32)
"""Thickest and thinnest conductor if the board has no plug for the sensor. An assumption: it stays flexible."""
_AWG_36_MM = 0.127
"""Diameter of AWG 36, from which all others follow [mm] (ASTM B258)."""


@dataclass(frozen=True)
class Wires:
    max_diameter_mm: float
    """Largest diameter of one wire over its insulation."""
    conductor_awg: int
    """Thickest conductor that leaves half of the diameter to the insulation, and that the board's connector takes."""
    thinnest_awg: int
    """Thinnest conductor that the connector takes, or as thin as the diameter asks for."""
    slack_mm: float
    """Length of the loop between the finger and the first place at which the wires are fixed."""


def describe_plug_wires(design: Design, wires: Wires) -> str:
    """Describe which wires fit both the finger and the plug of the board's sensor connector; empty without a plug."""
    plug = _find_plug(design)
    if plug is None:
        return ""
    common = plug.describe_common(wires.max_diameter_mm, wires.conductor_awg)
    return f"The plug of the board ({plug.series} at {SENSOR_CONNECTOR}) takes {plug.description}; {common}."


def describe_bought_wires(design: Design) -> dict[str, Any]:
    """Describe the wires to buy: what fits the finger and, where it can, the plug of the board."""
    wires, plug = size_wires(design), _find_plug(design)
    bought: dict[str, Any] = {
        "conductor_awg": [wires.conductor_awg, wires.thinnest_awg],
        "min_length_mm": max(MIN_LENGTH_MM, round(wires.slack_mm + design.dimensions.sensor.length_mm, -1)),
    }
    if plug is None or wires.max_diameter_mm < plug.min_insulation_mm:
        return bought | {"thinner_than_mm": wires.max_diameter_mm}
    bought["insulation_mm"] = [plug.min_insulation_mm, min(plug.max_insulation_mm, wires.max_diameter_mm)]
    if wires.conductor_awg == plug.min_awg and wires.max_diameter_mm >= plug.max_insulation_mm:
        connector = board_circuit(select_components(design)).component(SENSOR_CONNECTOR)
        matings = (mating for mating in list_mating_parts(connector) if mating.item.startswith("or leads"))
        if lead := next((mating.part for mating in matings if mating.part), None):
            bought["or_lead"] = f"{lead.manufacturer} {lead.number}, one for each wire, its second contact cut off"
    return bought


def size_wires(design: Design) -> Wires:
    """Size the wires: they fit through channel or fold, and cross the joint in a loop that stays loose.

    The gauge number of a diameter d is 36 - 39 log(d / 0.127 mm) / log 92 (ASTM B258).
    """
    dims, joint = design.dimensions, design.dimensions.joint
    # Two equal circles side by side span the channel.
    diameter = design.sensor.wire_diameter_mm if dims.fold else design.bone.channel_diameter_mm / 2
    gauge = math.ceil(36.0 - 39.0 * math.log(diameter / 2 / _AWG_36_MM) / math.log(92.0))
    bend = math.radians(design.hand.travel_deg) * (dims.eyes.dorsal - joint.axis_y) if joint else 0.0
    plug = _find_plug(design)
    thickest, thinnest = (plug.min_awg, plug.max_awg) if plug else _FLEXIBLE_AWG
    return Wires(diameter, max(gauge, thickest), max(gauge, thinnest), bend + _SLACK_MM)


def _find_plug(design: Design) -> PlugWire | None:
    """Find the wires that the plug of the board's sensor connector takes; None for a divider."""
    if not design.board.has_filter:
        return None
    return find_plug_wire(board_circuit(select_components(design)).component(SENSOR_CONNECTOR))


OPEN_OHM = 1e6
"""Resistance above which an untouched sensor must stay [ohm]."""
PRESSED_OHM = 30e3
"""Resistance below which a pressed head must fall [ohm]: some 0.2 N by the data sheet's curve."""
WEIGHTS_G = (100.0, 500.0)
"""Weights laid on the pad of the finished finger [g]."""


Use = Literal["finger", "mold", "bench"]
"""Use of a bought item: each finger, each mold, or the bench, where one serves all."""


def bill_of_materials(design: Design) -> list[dict[str, Any]]:
    """Items to buy besides the silicone: name, count and sizes [mm]."""
    return [item for _, item in list_hardware(design)]


def list_hardware(design: Design) -> Iterator[tuple[Use, dict[str, Any]]]:
    bolts = size_clamp_bolts(design.mold, design.mold_layout)
    thread = bolts.thread
    yield "finger", {
        "item": "force-sensing resistor", "type": design.dimensions.sensor.label, "count": 1,
        "note": "with solder tabs, not with female contacts; with adhesive on its back, or without it and with the "
                "film below",
    }  # fmt: skip
    thickness_mm = design.sensor.adhesive_thickness_mm
    yield "finger", {"item": "adhesive film for the sensor", "thickness_mm": thickness_mm, "count": 1}
    stands_out = round(bolts.stand_out_mm(design.mold_layout), 1) > 0.0
    yield "mold", {
        "item": "mold bolt (machine screw)", "thread_mm": thread.diameter_mm, "length_mm": bolts.length_mm,
        "count": bolts.count, **({"note": "they stand out of the palmar side"} if stands_out else {}),
    }  # fmt: skip
    yield "mold", {
        "item": "mold nut (hexagon nut)", "thread_mm": thread.diameter_mm, "across_flats_mm": thread.nut_flats_mm,
        "count": bolts.count,
    }  # fmt: skip
    if chaplet := design.dimensions.chaplet:
        yield "mold", {
            "item": "chaplet screw (machine screw, pan or cylinder head)", "thread_mm": chaplet.thread.diameter_mm,
            "length_mm": chaplet.screw_length(design.mold_layout.dorsal_height), "count": 1,
        }  # fmt: skip
    yield "finger", {  # silicone cures in the syringe, so each finger takes one
        "item": "syringe with Luer slip tip, without rubber on its plunger",
        "volume_ml": design.mold_layout.inlet.syringe.volume_ml, "nozzle_bore_mm": design.mold.nozzle_bore_mm,
        "count": 1,
    }  # fmt: skip
    release = "for silicone cast in a rigid mold; without silicone oil, which keeps the patch from sticking"
    yield "bench", {"item": "mold release for silicone", "count": 1, "note": release}
    for bolt in interface_of(design).bolts(design):
        yield "finger", bolt
    yield "finger", {"item": "stranded wire", **describe_bought_wires(design), "count": 2}
    if not design.dimensions.window_opens_into_gap:  # in a fork with a folded tail the wires are glued only
        yield "finger", {"item": "thread or lacing cord", "thinner_than_mm": THREAD_MM, "count": 1}
    for mass_g in WEIGHTS_G:
        yield "bench", {"item": "calibration weight", "mass_g": mass_g, "count": 1}
