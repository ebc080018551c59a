"""Hardware to buy: bill of materials of a casting, wires of the sensor, and what the interface is mounted with.

A bolt is bought as a machine screw, threaded to the head or not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from fingertip.board import board_circuit
from fingertip.board.bringup.wiring import SENSOR_CONNECTOR
from fingertip.board.components.values import select_components
from fingertip.board.parts.table import PlugWire, find_plug_wire, list_mating_parts
from fingertip.catalogues.threads import select_thread
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import size_clamp_bolts, standard_length_mm

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
    """Wires of a sensor."""

    max_diameter_mm: float
    """Largest diameter of one wire over its insulation."""
    conductor_awg: int
    """Thickest conductor that leaves half of the diameter to the insulation, and that the board's connector takes."""
    thinnest_awg: int
    """Thinnest conductor that the connector takes, or as thin as the diameter asks for."""
    slack_mm: float
    """Length of the loop between the finger and the first place at which the wires are fixed."""


def describe_plug_wires(design: Design, wires: Wires) -> str:
    """Describe which wires fit both the finger and the plug of the board's sensor connector; empty without a plug.

    A board without locking connectors takes the wires of any socket, or none.
    """
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
    all_fit = wires.conductor_awg == plug.min_awg and wires.max_diameter_mm >= plug.max_insulation_mm
    if all_fit and (lead := _find_lead(design)):
        bought["or_lead"] = lead
    return bought


def _find_lead(design: Design) -> str:
    """Find the lead with contacts that the plug takes; empty without one."""
    connector = board_circuit(select_components(design)).component(SENSOR_CONNECTOR)
    for mating in list_mating_parts(connector):
        if mating.part and mating.item.startswith("or leads"):
            return f"{mating.part.manufacturer} {mating.part.number}, one for each wire, its second contact cut off"
    return ""


def size_wires(design: Design) -> Wires:
    """Size the wires: they fit through channel or fold, and cross the joint in a loop that stays loose.

    The gauge number of a diameter d is 36 - 39 log(d / 0.127 mm) / log 92 (ASTM B258).
    """
    dims, joint = design.dimensions, design.dimensions.joint
    # Two equal circles side by side span the channel.
    diameter = design.sensor.wire_diameter_mm if dims.fold else design.bone.channel_diameter_mm / 2
    gauge = math.ceil(36.0 - 39.0 * math.log(diameter / 2 / _AWG_36_MM) / math.log(92.0))
    bend = math.radians(design.hand.travel_deg) * (dims.bone_outline.section.dorsal - joint.axis_y) if joint else 0.0
    plug = _find_plug(design)
    thickest, thinnest = (plug.min_awg, plug.max_awg) if plug else _FLEXIBLE_AWG
    return Wires(diameter, max(gauge, thickest), max(gauge, thinnest), bend + _SLACK_MM)


def _find_plug(design: Design) -> PlugWire | None:
    """Find the wires that the plug of the board's sensor connector takes."""
    return find_plug_wire(board_circuit(select_components(design)).component(SENSOR_CONNECTOR))


OPEN_OHM = 1e6
"""Resistance above which an untouched sensor must stay [ohm]."""
PRESSED_OHM = 30e3
"""Resistance below which a pressed head must fall [ohm]: some 0.2 N by the data sheet's curve."""
WEIGHTS_G = (100.0, 500.0)
"""Weights laid on the pad of the finished finger [g]."""
_MATING_PLAY_MM, _MATING_WALL_MM = 0.2, 2.5
"""Play between the interface and a printed mating part, and the wall of the example [mm]. Recommendations."""
_PIN_PLAY_MM = 0.2
"""Play of the anchor pin in its printed hole [mm]."""


def bill_of_materials(design: Design) -> list[dict[str, Any]]:
    """Items to buy besides the silicone: name, count and sizes [mm]."""
    bolts = size_clamp_bolts(design.mold, design.mold_layout)
    thread = bolts.thread
    sensor = design.sensor
    out_mm = round(bolts.stand_out_mm(design.mold_layout), 1)
    stands_out = {"note": "they stand out of the palmar side"} if out_mm > 0.0 else {}
    strain_relief = {"item": "thread or lacing cord", "thinner_than_mm": design.bone.tie_hole_diameter_mm, "count": 1}
    return [
        {
            "item": "force-sensing resistor", "type": design.dimensions.sensor.label, "count": 1,
            "note": "with adhesive on its back, or without it and with the film below",
        },
        {"item": "adhesive film for the sensor", "thickness_mm": sensor.adhesive_thickness_mm, "count": 1},
        {
            "item": "mold bolt (machine screw)", "thread_mm": thread.diameter_mm, "length_mm": bolts.length_mm,
            "count": bolts.count, **stands_out,
        },
        {
            "item": "mold nut (hexagon nut)", "thread_mm": thread.diameter_mm, "across_flats_mm": thread.nut_flats_mm,
            "count": bolts.count,
        },
        *_mold_hardware(design),
        *_interface_bolts(design),
        {
            "item": "insulated wire" if design.dimensions.fold else "stranded wire", **describe_bought_wires(design),
            "count": 2,
        },
        # In a fork with a folded tail the wires are glued only.
        *([] if design.dimensions.window_opens_into_gap else [strain_relief]),
        *({"item": "calibration weight", "mass_g": mass, "count": 1} for mass in WEIGHTS_G),
    ]  # fmt: skip


def _mold_hardware(design: Design) -> list[dict[str, Any]]:
    """List the screw of the chaplet, the syringe, and what is rubbed on the mold."""
    items: list[dict[str, Any]] = []
    if chaplet := design.dimensions.chaplet:
        items.append({
            "item": "chaplet screw (machine screw, pan or cylinder head)", "thread_mm": chaplet.thread.diameter_mm,
            "length_mm": chaplet.screw_length(design.mold_layout.dorsal_height), "count": 1,
        })  # fmt: skip
    if inlet := design.mold_layout.inlet:
        items.append({
            "item": "syringe with Luer slip tip, without rubber on its plunger", "volume_ml": inlet.syringe.volume_ml,
            "nozzle_bore_mm": design.mold.nozzle_bore_mm, "count": 1,
        })  # fmt: skip
    release = "for silicone cast in a rigid mold; without silicone oil, which keeps the patch from sticking"
    return [*items, {"item": "mold release for silicone", "count": 1, "note": release}]


def _joint_hardware(design: Design) -> list[dict[str, Any]]:
    """Pin of a clevis, and what holds its tendon."""
    anchor = design.dimensions.anchor
    pin: dict[str, Any] = {
        "item": "joint pin (hardened steel, such as a dowel pin)",
        "diameter_mm": design.hand.pin_diameter_mm,
        "count": 1,
    }
    if design.hand.knuckle == "tongue":  # else it is as long as the hand's fork is wide
        pin["length_mm"] = design.dimensions.pin_length
    items = [pin]
    if anchor:
        items.append({
            "item": "anchor pin of the tendon (spring steel wire)",
            "diameter_mm": round(design.bone.anchor_diameter_mm - _PIN_PLAY_MM, 1),
            "length_mm": round(2 * design.dimensions.collar.section.half_width_at(anchor.y), 1), "count": 1,
        })  # fmt: skip
        items.append({
            "item": "tendon (braided line, as long as the hand needs)",
            "diameter_mm": design.hand.tendon_diameter_mm,
            "count": 1,
        })  # fmt: skip
    return items


def _interface_bolts(design: Design) -> list[dict[str, Any]]:
    """Items that hold the bone to the proximal phalanx."""
    bone = design.bone
    if bone.interface == "clevis":
        return _joint_hardware(design)
    if bone.interface == "flange":
        return [
            {
                "item": "flange bolt (machine screw)",
                "thread_mm": select_thread(bone.flange_hole_diameter_mm).diameter_mm,
                "crossed_mm": bone.flange_thickness_mm, "count": 4 if bone.flange_spacing_y_mm else 2,
            }
        ]  # fmt: skip
    thread_mm = select_thread(bone.cross_bolt_diameter_mm).diameter_mm
    # The cross bolt passes through the post, or through the whole bone where it has a socket.
    crossed_mm = (
        bone.post_width_mm if bone.interface == "post" else design.dimensions.bone_outline.section.half_width * 2
    )
    return [
        {
            "item": "cross bolt (machine screw)", "thread_mm": thread_mm,
            "crossed_mm": round(crossed_mm, 1), "count": 1,
        },
        {"item": "cross bolt nut (hexagon nut)", "thread_mm": thread_mm, "count": 1},
    ]  # fmt: skip


def mounting_data(design: Design) -> dict[str, Any] | None:
    """Describe what the interface fits into; None for a clevis, whose joint the steps fit.

    The clearance of the mating part is a recommendation: the design does not hold one.
    """
    bone, play = design.bone, _MATING_PLAY_MM
    if bone.interface == "clevis":
        return None
    thread = select_thread(bone.cross_bolt_diameter_mm)
    bolt: dict[str, Any]
    if bone.interface == "post":
        shape = (
            f" with two flats, {bone.post_height_mm + play:g} mm apart"
            if bone.post_height_mm < bone.post_width_mm
            else ""
        )
        fit = (
            f"The post goes into a bore of {round(bone.post_width_mm + play, 2):g} mm{shape}, at least "
            f"{bone.post_length_mm:g} mm deep: {play:g} mm of play, recommended for prints. The bone stands on the end "
            "of its post while it prints: file the lip of the first layers off that end before you try it."
        )
        bore = round(bone.post_width_mm + play, 2)
        needed = bore + 2 * _MATING_WALL_MM + thread.nut_height_mm
        from_mm, start = -bone.base_length_mm - design.dimensions.cross_bolt_z, "the shoulder of the post"
        bolt = {"crossed_mm": bore, "walls": 2, "wall_mm": _MATING_WALL_MM}
    elif bone.interface == "socket":
        across = round(2 * design.dimensions.bone_outline.section.half_width, 1)
        fit = (
            f"The socket takes a post of {round(bone.socket_diameter_mm - play, 2):g} mm, at most "
            f"{bone.socket_depth_mm:g} mm long: {play:g} mm of play, recommended for prints. Ream the socket, or sand "
            "the post, until it slides in."
        )
        needed = across + thread.nut_height_mm
        from_mm, start = design.dimensions.cross_bolt_z + bone.base_length_mm, "the rim of the socket"
        bolt = {"crossed_mm": across, "walls": 0, "wall_mm": 0.0}
    else:
        fit = (
            f"The flange lies flat on the mating part: file the lip of the first layers off its face. Its bolts pass "
            f"{bone.flange_thickness_mm:g} mm of it and enter threads or nuts in the mating part."
        )
        return {"fit": fit, "bolt": None, "play_mm": play}
    bolt |= {
        "item": "cross bolt", "thread_mm": thread.diameter_mm, "nut_mm": thread.nut_height_mm,
        "length_mm": standard_length_mm(needed), "from_mm": round(from_mm, 2), "from": start,
    }  # fmt: skip
    return {"fit": fit, "bolt": bolt, "play_mm": play}
