"""Hardware to buy: the bill of materials of a casting.

A bolt is bought as a machine screw, threaded to the head or not.
"""

from __future__ import annotations

from typing import Any

from fingertip.casting.wires import describe_bought_wires
from fingertip.design import Design
from fingertip.design.geometry.clamp_bolts import size_clamp_bolts, standard_length_mm
from fingertip.design.threads import select_thread

WEIGHTS_G = (100.0, 500.0)
"""Weights laid on the pad of the finished finger [g]."""
_MATING_PLAY_MM, _MATING_WALL_MM = 0.2, 2.5
"""Play between the interface and a printed mating part, and the wall of the example [mm]. Recommendations."""
_PIN_PLAY_MM = 0.2
"""Play of the anchor pin in its printed hole [mm]."""


def bill_of_materials(design: Design) -> list[dict[str, Any]]:
    """Items to buy besides the silicone: name, count and sizes [mm]."""
    bolts = size_clamp_bolts(design)
    thread = bolts.thread
    sensor = design.sensor
    out_mm = round(bolts.stand_out_mm(design), 1)
    stands_out = {"note": "they stand out of the palmar side"} if out_mm > 0.0 else {}
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
        *_strain_relief(design),
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


def _strain_relief(design: Design) -> list[dict[str, Any]]:
    """List what holds the wires to the bone; in a fork with a folded tail they are glued only."""
    if design.dimensions.window_opens_into_gap:
        return []
    return [{"item": "thread or lacing cord", "thinner_than_mm": design.bone.tie_hole_diameter_mm, "count": 1}]


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
