"""Casting sheet of a design: everything to weigh, buy, set or wait for as plain data, and the page that shows it.

Values are rounded in the data, once, so that page and data agree. The templates beside this module hold no figure.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import MAX_BRIDGE_MM, OVERHANG_DEG
from fingertip.cad.printing.print_files import parts_on_plates
from fingertip.cad.printing.settings import FDM, LAYER_MM, SLA, choose_profile, print_settings
from fingertip.cad.printing.slicer import HOW_TO_INSTALL, PrintEstimate
from fingertip.cad.shapes.engraving import MIN_STROKE_MM, omitted_lines
from fingertip.cad.verification.mold import PUSH_S
from fingertip.casting import consumables, quantities
from fingertip.casting.hardware import OPEN_OHM, PRESSED_OHM, WEIGHTS_G, bill_of_materials
from fingertip.catalogues.hardware import NOZZLE_DEPTH_MM, find_needle
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.catalogues.print_materials import PRINT_MATERIALS
from fingertip.catalogues.silicones import WANTED_POT_LIFE_MIN, Silicone, find_example, load_silicones, load_sources
from fingertip.design import Design
from fingertip.design.geometry.features import END_ROOM_MM
from fingertip.design.geometry.mold_layout import size_clamp_bolts
from fingertip.design.geometry.seat import min_skin_thickness, worst
from fingertip.design.interfaces import INTERFACES, interface_of
from fingertip.design.interfaces.clevis import tendon_force_per_n
from fingertip.design.interfaces.clevis_solids import stop_height_mm
from fingertip.documents.first.sheet import Step, first_sheet, list_first_steps, render_first_sheet
from fingertip.documents.template import render, render_page, render_rows
from fingertip.filling.mold_filling import MAX_AIR_MM3, find_pose, injected_cm3, place_vents, predict_mold_filling

Data = Mapping[str, Any]

_PAPER_MM = 0.1
"""Thickness of office paper of 80 g/m2 [mm]."""
_TAB_ROOM_MM = 0.3
"""Room that is left beyond soldered tabs [mm]."""
_VISE_BELOW_MM = 2.0
"""Distance of the jaws of a vise from the parting line [mm]: a pry slot, and a jaw's edge. An assumption."""
_PEEL = {"strip_mm": 10.0, "mass_g": WEIGHTS_G[-1], "hold_s": 10}
"""Peel test of the primer: some 0.5 N on each millimetre of a strip. An assumption."""
_SMALL_SHARE = 0.25
"""Share of the mixture below which a component is weighed with one digit more, for the same relative error."""


def casting_sheet_data(
    design: Design,
    volumes: quantities.SiliconeVolumes,
    silicone: Silicone,
    prints: Mapping[str, PrintEstimate] | None = None,
    warnings: Sequence[str] = (),
) -> dict[str, Any]:
    """Collect the data of a sheet; a skin that is cast around a lowered core has a sheet of its own."""
    if design.mold.method == "plunge":
        return first_sheet(design, volumes, silicone)
    bolts, hand = size_clamp_bolts(design.mold, design.mold_layout), design.hand
    material = PRINT_MATERIALS[design.strength.print_material]
    joint = {
        "pin_mm": hand.pin_diameter_mm, "play_mm": round(2 * design.bone.joint_clearance_mm, 2),
        "travel_deg": hand.travel_deg, "tendon_distance_mm": hand.tendon_distance_mm,
        "knuckle": hand.knuckle, "hand_mm": hand.width_mm, "radius_mm": hand.clearance_radius_mm,
        "stop_mm": round(stop_height_mm(design), 1),
        "anchor_hole_mm": round(design.bone.anchor_diameter_mm, 1),
        "tendon_force_n": round(design.strength.grip_force_n * tendon_force_per_n(design, design.skin.length_mm)),
    }  # fmt: skip
    data: dict[str, Any] = {
        "design": design.name,
        "method": design.mold.method,
        "interface": design.bone.interface,
        "sensor": design.dimensions.sensor.label,
        "sensor_tail": design.sensor.tail,
        "wires_between_cheeks": design.dimensions.window_opens_into_gap,
        "silicone": _silicone_data(silicone) | {"example": _find_example(design, silicone)},
        "aids": consumables.AIDS,
        "volumes_cm3": quantities.volumes_data(volumes),
        "batch": _batch_data(design, silicone, volumes),
        "mold": {
            "made_for_shrinkage_percent": design.mold.silicone_shrinkage_percent,
            "made_for_this_silicone": _is_mold_for(design, silicone),
            "bolts": bolts.count,
            "bolts_stand_out_mm": round(max(0.0, bolts.stand_out_mm(design.mold_layout)), 1),
            "bolt_hole_mm": round(design.mold.bolt_diameter_mm - design.printer.offset_mm, 2),
            "vent_mm": design.mold.vent_diameter_mm,
            "vents": len(place_vents(design)),
            "vise_below_mm": max(_VISE_BELOW_MM, design.mold.pry_height_mm),
            "tail_passes_collar": design.dimensions.tail_passes_collar,
            "not_engraved": omitted_lines(design),
            "min_stroke_mm": MIN_STROKE_MM,
        },
        "filling": _filling_data(design, silicone),
        "chaplet": _chaplet_data(design),
        "peel": _PEEL,
        "fit": _fit_data(design),
        "skin_pull_off_n": round(quantities.skin_pull_off_n(design, silicone), 1),
        "sensor_limits": {"open_mohm": OPEN_OHM / 1e6, "pressed_kohm": PRESSED_OHM / 1e3},
        "joint": joint if design.dimensions.joint else None,
        "grip_force_n": design.strength.grip_force_n,
        "bill": bill_of_materials(design),
        "mounting": interface_of(design).mounting(design),
        "printing": _printing_data(design, prints),
        "print_material": material.label,
        "print_process": material.process,
        "print_strength_mpa": material.strength_along_finger(design.strength.print_direction),
        "print_materials": sorted(set(PRINT_MATERIALS) - {material.name}),
        "check_warnings": list(warnings),
    }
    supplies = [
        supply | {"count": int(supply["count"]) if supply["count"] else None}
        for supply in render_rows("casting/supplies.md", _add_uses(data))
    ]
    plan, day = [], 1  # the day on which a stage begins at the earliest
    for stage in render_rows("casting/plan.md", _add_uses(data)):
        plan.append({"day": day, "work": stage["work"], "wait": stage["wait"]})
        day += int(stage["days"])
    return data | {"supplies": supplies, "plan": plan}


def _filling_data(design: Design, silicone: Silicone) -> dict[str, Any]:
    """Filling of the mold with a silicone: its time is in proportion to the viscosity."""
    prediction, syringe = predict_mold_filling(design), design.mold_layout.inlet.syringe
    viscosity, up = silicone.viscosity_pa_s.high, find_pose(design)
    tolerance_deg = quantities.pose_tolerance_deg(design)
    return {
        "viscosity_pa_s": viscosity,
        "fill_s": round(prediction.fill_s * viscosity / prediction.viscosity_pa_s),
        "pot_life_min": silicone.planned_pot_life_min,
        "wanted_pot_life_min": WANTED_POT_LIFE_MIN,
        "limit_min": round(silicone.filling_limit_s / 60.0, 1),
        "prepare_min": round(silicone.planned_pot_life_min - silicone.filling_limit_s / 60.0, 1),
        "injected_cm3": round(injected_cm3(prediction), 1),
        "up": [round(part, 4) for part in up],
        "tip_deg": round(math.degrees(math.asin(up[2]))),
        "dorsal_up": up[1] >= 0.0,
        "roll_deg": round(math.degrees(math.atan2(abs(up[0]), abs(up[1])))),
        "level_across_deg": round(math.degrees(math.asin(abs(up[0])))),
        "runner_side_up": up[0] > 0.0,
        "max_air_mm3": MAX_AIR_MM3,
        "pose_tolerance_deg": None if tolerance_deg is None else math.floor(tolerance_deg),
        "push_s": PUSH_S,
        "min_force_n": round(
            prediction.force_for_time_n(PUSH_S, syringe.bore_mm) * viscosity / prediction.viscosity_pa_s, 1
        ),
        "load_cm3": round(quantities.load_cm3(design), 1),
        "bubble_rise_mm": round(quantities.bubble_rise_mm_per_min(viscosity)),
        "syringe": {
            "volume_ml": syringe.volume_ml, "nozzle_bore_mm": design.mold.nozzle_bore_mm,
            "nozzle_depth_mm": NOZZLE_DEPTH_MM, "thumb_n": design.mold.thumb_force_n,
        },
    }  # fmt: skip


def _chaplet_data(design: Design) -> dict[str, Any] | None:
    """Chaplet and its screw; None without one."""
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return None
    return {
        "diameter_mm": 2 * chaplet.radius,
        "thread": chaplet.thread.label,
        "length_mm": chaplet.screw_length(design.mold_layout.dorsal_height),
        "hole_mm": round(2 * chaplet.hole_radius, 2),
        "pilot_mm": round(2 * chaplet.pilot_radius, 2),
        "pilot_depth_mm": round(chaplet.pilot_depth, 1),
        "stands_out_mm": round(chaplet.screw_length(design.mold_layout.dorsal_height) - chaplet.engaged, 1),
        "needle": find_needle(2 * chaplet.pilot_radius),
    }


def _fit_data(design: Design) -> dict[str, Any]:
    """Fit of the sensor in its pocket and of the bone in the mold, and the skin that they leave."""
    play = round(2 * (design.printed_fit_mm + 2 * design.printer.surface_error_mm), 2)
    room = design.dimensions.relief_half_length - _TAB_ROOM_MM
    losses = design.losses
    return {
        "cover_tape": consumables.cover_tape_data(design),
        "sensor_insert": consumables.sensor_insert_data(design),
        "seat_tape": consumables.seat_tape_data(design),
        "slot_mm": round(2 * design.dimensions.tail_half_width - design.printer.offset_mm, 2),
        "paper_mm": _PAPER_MM,
        "sensor_clearance_mm": round(design.sensor.clearance_mm - design.printer.offset_mm / 2, 3),
        "wire_mm": design.sensor.wire_diameter_mm,
        "max_play_mm": play,
        "papers": max(1, math.floor(play / _PAPER_MM + 1e-6)),
        "tab_room_mm": round(room, 1),
        "tabs_too_long": design.sensor.tab_length_mm > room,
        "crimp_mm": design.sensor.crimp_height_mm,
        "crimped_mm": round(design.dimensions.sensor.thickness_mm + design.sensor.crimp_height_mm, 2),
        "end_room_mm": END_ROOM_MM,
        "clearance_mm": round(design.printed_fit_mm, 3),
        "min_skin_design_mm": round(min_skin_thickness(design.dimensions, 0.0), 2),
        "min_skin_held_mm": round(min(loss.left_mm for loss in losses), 2),
        "surface_error_mm": design.printer.surface_error_mm,
        "retained_over_sensor_percent": round(100 * worst(losses, over_sensor=True).retained),
        "retained_elsewhere_percent": round(100 * worst(losses, over_sensor=False).retained),
    }


def _is_mold_for(design: Design, silicone: Silicone) -> bool:
    """Tell whether the mold compensates for the shrinkage of a silicone, to 0.05 %."""
    low, high = silicone.shrinkage_percent.low, silicone.shrinkage_percent.high
    return low - 0.05 <= design.mold.silicone_shrinkage_percent <= high + 0.05


def _find_example(design: Design, silicone: Silicone) -> dict[str, str] | None:
    """Find a product to buy, with what to build for it; None for a product."""
    if (found := find_example(silicone)) is None:
        return None
    product, changes = load_silicones()[found["name"]], f"--set silicone.product={found['name']}"
    if not _is_mold_for(design, product):
        changes += f" --set mold.silicone_shrinkage_percent={product.shrinkage_percent.high:g}"
    return found | {"changes": changes}


def _silicone_data(silicone: Silicone) -> dict[str, Any]:
    properties = {
        name: {"low": p.low, "high": p.high, "source": load_sources()[p.source], "verified": p.verified}
        for name, p in silicone.properties().items()
    }
    return {
        "name": silicone.name,
        "label": silicone.label,
        "cure": silicone.cure,
        "components": list(silicone.components),
        "ratio": {
            "stated_by": silicone.ratio_by,
            "parts": [silicone.parts_a.low, silicone.parts_b.low],
            "verified": silicone.parts_a.verified and silicone.parts_b.verified,
            "parts_by_weight": [round(parts, 3) for parts in quantities.parts_by_weight(silicone)],
            "assumed_by_weight": quantities.is_ratio_assumed(silicone),
        },
        "properties": properties,
    }


def round_component_g(component_g: float, total_g: float) -> float:
    """Round the mass of a component [g] to what is weighed."""
    return round(component_g, 2 if component_g < _SMALL_SHARE * total_g else 1)


def _batch_data(design: Design, silicone: Silicone, volumes: quantities.SiliconeVolumes) -> dict[str, Any]:
    """Quantities of one mixture, and the number of mixtures: for the test of the cure, the skin and the patch."""
    batch = quantities.compute_batch(silicone, volumes.total_cm3, quantities.load_cm3(design))
    a_g, b_g = (round_component_g(part_g, batch.total_g) for part_g in (batch.a_g, batch.b_g))
    mixtures = 3 if design.dimensions.chaplet else 2
    # The component of which least is weighed.
    lighter = silicone.components[batch.b_g < batch.a_g]
    return {
        "in_mold_g": round(batch.in_mold_g, 2),
        "load_g": round(quantities.mass_g(silicone, quantities.load_cm3(design)), 1),
        "mixtures": mixtures,
        "buy_g": math.ceil(mixtures * (a_g + b_g)),
        "with_waste_g": round(batch.with_waste_g, 1),
        "a_g": a_g,
        "b_g": b_g,
        "total_g": round(a_g + b_g, 2),
        "waste_percent": round(100.0 * quantities.WASTE_FRACTION, 1),
        "smallest_g": round(quantities.smallest_batch_g(silicone), 2),
        "min_mix_g": quantities.MIN_MIX_G,
        "min_component_g": quantities.MIN_COMPONENT_G,
        "scale_g": quantities.SCALE_G,
        "step_percent": round(100.0 * quantities.SCALE_G / quantities.MIN_COMPONENT_G, 1),
        "is_raised": batch.total_g > batch.with_waste_g,
        "lighter": "each component" if math.isclose(batch.a_g, batch.b_g) else lighter,
    }


def _printing_data(design: Design, prints: Mapping[str, PrintEstimate] | None) -> dict[str, Any]:
    supports, orientations = supports_by_part(design), print_orientations(design)
    on_filament, kinds = parts_on_plates(design, FDM), ((FDM, "filament"), (SLA, "resin"))
    data: dict[str, Any] = {
        "folder": PRINT_FOLDER,
        "max_bridge_mm": MAX_BRIDGE_MM,
        "overhang_deg": OVERHANG_DEG,
        "parts": [
            {
                "part": name, "face_on_plate": orientation.face_on_plate, "rotate_x_deg": orientation.rotate_x_deg,
                "needs_supports": orientation.needs_supports, "supports_may_stand": supports[name].may_stand,
                "no_supports_on": supports[name].none_on,
            }
            for name, orientation in orientations.items()
        ],
        "settings": print_settings(orientations, on_filament, choose_profile(design)),
        "plates_without_bone": [word for kind, word in kinds if "bone" not in parts_on_plates(design, kind)],
    }  # fmt: skip
    if prints:
        minutes = {name: round(one.minutes) for name, one in prints.items()}
        volumes = {name: round(one.filament_cm3, 1) for name, one in prints.items()}
        data |= {
            "plates": [{"plate": name, "minutes": minutes[name], "filament_cm3": volumes[name]} for name in prints],
            "layer_mm": LAYER_MM,
            "minutes": sum(minutes.values()),
            "filament_cm3": round(sum(volumes.values()), 1),
        }
    return data


def render_sheet(data: Data, pictures: Sequence[str] = ()) -> str:
    """Render the data of a sheet as a Markdown page, with a picture for each step if there are any."""
    if data["method"] == "plunge":
        return render_first_sheet(data, pictures)
    return render_page("casting/sheet.md", **data, steps=steps(data), pictures=pictures, how_to_install=HOW_TO_INSTALL)


def steps(data: Data) -> list[Step]:
    if data["method"] == "plunge":
        return list_first_steps(data)
    weakest = INTERFACES[data["interface"]].weakest
    _, *pages = render("casting/procedure.md", **_add_uses(data), weakest=weakest).split("## ")
    return [Step(name, " ".join(text.split())) for name, _, text in (page.partition("\n") for page in pages)]


def _add_uses(data: Data) -> Data:
    return {**data, "uses_adhesive": consumables.uses_adhesive(data)}
