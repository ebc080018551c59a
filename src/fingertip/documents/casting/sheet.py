"""Data of a casting sheet: everything to weigh, buy, set or wait for, as plain data.

`fingertip.documents.casting.markdown` renders it as a page. Values are rounded here, once, so that page and data agree.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import MAX_BRIDGE_MM, OVERHANG_DEG
from fingertip.cad.printing.print_files import LAYER_MM
from fingertip.cad.shapes.engraving import MIN_STROKE_MM, omitted_lines
from fingertip.cad.verification.bone import FILAMENT_CHECK
from fingertip.cad.verification.filling import PUSH_S
from fingertip.casting.hardware import bill_of_materials, mounting_data
from fingertip.casting.quantities import (
    MIN_COMPONENT_G,
    SCALE_G,
    WASTE_FRACTION,
    Batch,
    SiliconeVolumes,
    compute_batch,
    is_ratio_assumed,
    load_cm3,
    mass_g,
    name_retention,
    parts_by_weight,
    pose_tolerance_deg,
    skin_pull_off_n,
    volumes_data,
)
from fingertip.casting.slicer import PrintEstimate, print_settings
from fingertip.casting.tapes import cover_tape_data, seat_tape_data
from fingertip.casting.uses import sensor_limits_data, uses_adhesive
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.catalogues.print_materials import PRINT_MATERIALS
from fingertip.catalogues.silicones import SOURCES, WANTED_POT_LIFE_MIN, Silicone, find_example
from fingertip.catalogues.syringes import NOZZLE_DEPTH_MM, find_needle
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import size_clamp_bolts
from fingertip.design.geometry.seat import sleeve_inset_mm, worst
from fingertip.design.geometry.skin_thickness import min_skin_thickness
from fingertip.design.geometry.tail_fold import END_ROOM_MM
from fingertip.documents.casting.supplies import supplies_data
from fingertip.filling.mold_filling import MAX_AIR_MM3, find_pose, injected_cm3, place_vents, predict_mold_filling

# Plan of the work by days: what waits for a cure, from the data of the silicone and the steps of the design.


Data = Mapping[str, Any]

_HOURS_PER_DAY = 24.0
_ADHESIVE_DAYS = 1
"""Days for which the plan lets adhesive cure, whose time only its maker knows. An assumption."""


def plan_data(data: Data) -> list[dict[str, Any]]:
    """List the stages of the work: the day on which each begins at the earliest, its work, and what it waits for."""
    cure_h = data["silicone"]["properties"]["cure_h"]["high"]
    silicone_days = max(1, math.ceil(cure_h / _HOURS_PER_DAY))
    cured = f"cure of the silicone: {cure_h:g} h"
    adhesive = "cure of the adhesive: as its maker says"
    is_glued, is_patched = uses_adhesive(data), data["chaplet"] is not None
    stages: list[tuple[str, str, int]] = []
    if is_glued:
        stages.append(("spread a sample of the adhesive for the test of the cure", adhesive, _ADHESIVE_DAYS))
    tried = "all parts, the mold and the syringe" if data["filling"]["syringe"] else "all parts and the mold"
    stages.append((f"test the cure; meanwhile try {tried}", cured, silicone_days))
    mounting = "mount and wire the sensor"
    if data["insert"] == "core":
        stages.append(("release the mold, close it around the core, mix and fill", cured, silicone_days))
        opening = f"open the mold and roll the skin off; {mounting}"
        stages += _glue(opening, adhesive, is_glued)
        finishing = f"{'' if is_glued else opening + '; '}cover the sensor and pull the skin on"
    else:
        stages += _glue(f"release the mold, {mounting}", adhesive, is_glued)
        before = "" if is_glued else f"release the mold, {mounting}, "
        primer = "cover the sensor and tape the seat; prime the bone, which dries as the primer's maker says"
        filling = "close, mix and fill within the open time of the primer"
        stages.append((f"{before}{primer}; {filling}", cured, silicone_days))
        finishing = "open the mold and trim the skin"
    patching = "; patch the hole of the screw" if is_patched else ""
    stages.append((f"{finishing}{patching}", cured if is_patched else "", 0))
    plan, day = [], 1
    for work, wait, days in stages:
        plan.append({"day": day, "work": work, "wait": wait})
        day += days
    return plan


def _glue(work: str, adhesive: str, is_glued: bool) -> list[tuple[str, str, int]]:
    """Return the stage that glues; none without adhesive, whose work the next stage then begins with."""
    return [(f"{work}, and seal with adhesive", adhesive, _ADHESIVE_DAYS)] if is_glued else []


_SHRINKAGE_TOLERANCE_PERCENT = 0.05
_PAPER_MM = 0.1
"""Thickness of office paper of 80 g/m2 [mm]."""
_TAB_ROOM_MM = 0.3
"""Room that is left beyond soldered tabs [mm]."""
_SMALL_SHARE = 0.25
"""Share of the mixture below which a component is weighed with one digit more, for the same relative error."""


def casting_sheet_data(
    design: Design,
    volumes: SiliconeVolumes,
    silicone: Silicone,
    prints: Mapping[str, PrintEstimate] | None = None,
    warnings: Sequence[str] = (),
) -> dict[str, Any]:
    """The casting sheet of a design as plain data."""
    bolts = size_clamp_bolts(design.mold, design.mold_layout)
    data: dict[str, Any] = {
        "design": design.name,
        "method": design.mold.method,
        "insert": "core" if design.mold.method == "sleeve" else "bone",
        "interface": design.bone.interface,
        "sensor": design.dimensions.sensor.label,
        "sensor_tail": design.sensor.tail,
        "wires_between_cheeks": design.dimensions.window_opens_into_gap,
        "silicone": _silicone_data(silicone),
        "volumes_cm3": volumes_data(volumes),
        "batch": _batch_data(design, silicone, volumes),
        "mold": {
            "made_for_shrinkage_percent": design.mold.silicone_shrinkage_percent,
            "made_for_this_silicone": mold_matches_silicone(design, silicone),
            "bolts": bolts.count,
            "bolts_stand_out_mm": round(max(0.0, bolts.stand_out_mm(design.mold_layout)), 1),
            "bolt_hole_mm": round(design.mold.bolt_diameter_mm - design.printer.offset_mm, 2),
            "vent_mm": design.mold.vent_diameter_mm,
            "vents": len(place_vents(design)),
            "tail_passes_collar": design.dimensions.tail_passes_collar,
            "not_engraved": omitted_lines(design),
            "min_stroke_mm": MIN_STROKE_MM,
        },
        "filling": _filling_data(design, silicone),
        "chaplet": _chaplet_data(design),
        "fit": _fit_data(design),
        "skin_pull_off_n": round(skin_pull_off_n(design, silicone), 1),
        "skin_held_by": name_retention(design),
        "sensor_limits": sensor_limits_data(),
        "joint": _joint_data(design),
        "bill": bill_of_materials(design),
        "mounting": mounting_data(design),
        "printing": _printing_data(design, prints),
        "print_material": PRINT_MATERIALS[design.strength.print_material].label,
        "print_process": PRINT_MATERIALS[design.strength.print_material].process,
        "filament_bone_breaks": any(warning.startswith(f"{FILAMENT_CHECK}:") for warning in warnings),
        "check_warnings": list(warnings),
    }
    return data | {"supplies": supplies_data(data), "plan": plan_data(data)}


def mold_matches_silicone(design: Design, silicone: Silicone) -> bool:
    """Return whether the mold's shrinkage compensation lies within the silicone's range, within 0.05 %."""
    compensated, shrinkage = design.mold.silicone_shrinkage_percent, silicone.shrinkage_percent
    low, high = shrinkage.low - _SHRINKAGE_TOLERANCE_PERCENT, shrinkage.high + _SHRINKAGE_TOLERANCE_PERCENT
    return low <= compensated <= high


def _joint_data(design: Design) -> dict[str, float] | None:
    """Pin, travel and tendon of a clevis; None for other interfaces."""
    if design.dimensions.joint is None:
        return None
    return {
        "pin_mm": design.hand.pin_diameter_mm,
        "travel_deg": design.hand.travel_deg,
        "tendon_distance_mm": design.hand.tendon_distance_mm,
    }


def _filling_data(design: Design, silicone: Silicone) -> dict[str, Any]:
    """Filling of the mold with a silicone: its time is in proportion to the viscosity."""
    prediction, inlet = predict_mold_filling(design), design.mold_layout.inlet
    viscosity = silicone.viscosity_pa_s.high
    syringe = inlet.syringe if inlet else None
    up = find_pose(design) if inlet else (0.0, 0.0, 1.0)
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
        "runner_side_up": up[0] > 0.0,
        "max_air_mm3": MAX_AIR_MM3,
        "pose_tolerance_deg": _pose_tolerance_deg(design) if inlet else None,
        "push_s": PUSH_S,
        "min_force_n": (
            round(prediction.force_for_time_n(PUSH_S, syringe.bore_mm) * viscosity / prediction.viscosity_pa_s, 1)
            if syringe else None
        ),
        "load_cm3": round(load_cm3(design), 1) if syringe else None,
        "syringe": (
            {
                "volume_ml": syringe.volume_ml, "nozzle_bore_mm": design.mold.nozzle_bore_mm,
                "nozzle_depth_mm": NOZZLE_DEPTH_MM,
                "thumb_n": design.mold.thumb_force_n,
            }
            if syringe else None
        ),
    }  # fmt: skip


def _pose_tolerance_deg(design: Design) -> int | None:
    """Return whole degrees by which the mold may tilt out of its pose; None where none was computed."""
    tolerance = pose_tolerance_deg(design)
    return None if tolerance is None else math.floor(tolerance)


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
        "needle": find_needle(2 * chaplet.pilot_radius),
    }


def _fit_data(design: Design) -> dict[str, Any]:
    """Fit of the sensor in its pocket and of bone or core in the mold, and the skin that they leave."""
    play = round(2 * (design.printed_fit_mm + 2 * design.printer.surface_error_mm), 2)
    room = design.dimensions.relief_half_length - _TAB_ROOM_MM
    losses = design.losses
    return {
        "cover_tape": cover_tape_data(design),
        "seat_tape": seat_tape_data(design),
        "slot_mm": round(2 * design.dimensions.tail_half_width - design.printer.offset_mm, 2),
        "paper_mm": _PAPER_MM,
        "sensor_clearance_mm": round(design.sensor.clearance_mm - design.printer.offset_mm / 2, 3),
        "wire_mm": design.sensor.wire_diameter_mm,
        "max_play_mm": play,
        "papers": max(1, math.floor(play / _PAPER_MM + 1e-6)),
        "tab_room_mm": round(room, 1),
        "tabs_too_long": design.sensor.tab_length_mm > room,
        "crimp_mm": design.sensor.crimp_height_mm,
        "end_room_mm": END_ROOM_MM,
        "clearance_mm": round(design.printed_fit_mm, 3),
        "min_skin_design_mm": round(min_skin_thickness(design.dimensions, sleeve_inset_mm(design)), 2),
        "min_skin_held_mm": round(min(loss.left_mm for loss in losses), 2),
        "surface_error_mm": design.printer.surface_error_mm,
        "retained_over_sensor_percent": round(100 * worst(losses, over_sensor=True).retained),
        "retained_elsewhere_percent": round(100 * worst(losses, over_sensor=False).retained),
    }


def _silicone_data(silicone: Silicone) -> dict[str, Any]:
    properties = {
        name: {"low": p.low, "high": p.high, "source": SOURCES[p.source], "verified": p.verified}
        for name, p in silicone.properties().items()
    }
    return {
        "name": silicone.name,
        "label": silicone.label,
        "example": find_example(silicone),
        "cure": silicone.cure,
        "components": list(silicone.components),
        "ratio": _ratio_data(silicone),
        "properties": properties,
    }


def _ratio_data(silicone: Silicone) -> dict[str, Any]:
    """Mix ratio as the maker states it, and as parts by weight."""
    a_weight, b_weight = parts_by_weight(silicone)
    return {
        "stated_by": silicone.ratio_by,
        "parts": [silicone.parts_a.low, silicone.parts_b.low],
        "verified": silicone.parts_a.verified and silicone.parts_b.verified,
        "parts_by_weight": [round(a_weight, 3), round(b_weight, 3)],
        "assumed_by_weight": is_ratio_assumed(silicone),
    }


def _batch_data(design: Design, silicone: Silicone, volumes: SiliconeVolumes) -> dict[str, Any]:
    """Quantities of one mixture, and the number of mixtures: for the test of the cure, the skin and the patch."""
    batch = compute_batch(silicone, volumes.total_cm3, load_cm3(design))
    a_g, b_g = (round(part_g, 2 if part_g < _SMALL_SHARE * batch.total_g else 1) for part_g in (batch.a_g, batch.b_g))
    mixtures = 3 if design.dimensions.chaplet else 2
    return {
        "in_mold_g": round(batch.in_mold_g, 2),
        "load_g": round(mass_g(silicone, load_cm3(design)), 1),
        "mixtures": mixtures,
        "buy_g": math.ceil(mixtures * (a_g + b_g)),
        "with_waste_g": round(batch.with_waste_g, 1),
        "a_g": a_g,
        "b_g": b_g,
        "total_g": round(a_g + b_g, 2),
        "waste_percent": round(100.0 * WASTE_FRACTION, 1),
        "min_component_g": MIN_COMPONENT_G,
        "scale_g": SCALE_G,
        "is_raised": batch.total_g > batch.with_waste_g,
        "lighter": _name_lighter(silicone, batch),
    }


def _name_lighter(silicone: Silicone, batch: Batch) -> str:
    """Name the component of which least is weighed."""
    if math.isclose(batch.a_g, batch.b_g):
        return "each component"
    return silicone.components[batch.b_g < batch.a_g]


def _printing_data(design: Design, prints: Mapping[str, PrintEstimate] | None) -> dict[str, Any]:
    supports, orientations = supports_by_part(design), print_orientations(design)
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
        "settings": print_settings(orientations),
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
