"""The figures of a casting sheet: everything a person weighs, buys, sets or waits for, as plain data.

`casting.markdown` turns them into a page. Figures are rounded here, once, so that page and data state the same.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fingertip.cad.printing import print_orientations
from fingertip.cad.shapes.lettering import MIN_STROKE_MM, left_out
from fingertip.casting import hardware
from fingertip.casting.batches import MIN_PART_G, WASTE_FRACTION, batch
from fingertip.casting.materials import SOURCES, Silicone
from fingertip.casting.slicer import LAYER_MM, PrintEstimate
from fingertip.casting.quantities import SiliconeVolumes
from fingertip.design import Design
from fingertip.design.geometry.misalignment import loose_tilt_slope, min_thickness_held, min_thickness_loose
from fingertip.design.geometry.mold_layout import lay_out
from fingertip.design.threads import select_thread


def figures(
    design: Design, volumes: SiliconeVolumes, card: Silicone, prints: Mapping[str, PrintEstimate] | None = None
) -> dict[str, Any]:
    """The sheet of a design as data.

    Parameters
    ----------
    design
        The fingertip.
    volumes
        What its mold takes, from `casting.volumes.measure`.
    card
        The silicone.
    prints
        What the slicer says, by part; None if it was not asked.
    """
    return {
        "design": design.name,
        "method": design.mold.method,
        "sensor": design.dimensions.sensor.label,
        "silicone": _card(card),
        "volumes_cm3": _volumes(volumes),
        "batch": _batch(card, volumes),
        "mold": {
            "made_for_shrinkage_percent": design.mold.silicone_shrinkage_percent,
            "made_for_this_silicone": made_for(design, card),
            "vents": len(lay_out(design, design.dimensions).vents_x),
            "tail_passes_collar": design.dimensions.tail_passes_collar,
            "not_engraved": left_out(design, lay_out(design, design.dimensions)),
            "min_stroke_mm": MIN_STROKE_MM,
        },
        "fit": _fit(design),
        "bill": bill_of_materials(design),
        "printing": _printing(design, prints),
    }


def _fit(design: Design) -> dict[str, float]:
    """How well bone or core is held in the mold's recess, and what that leaves of the silicone."""
    dims = design.dimensions
    return {
        "clearance_mm": design.mold.fit_clearance_mm,
        "thinnest_held_mm": round(min_thickness_held(design, dims), 2),
        "loose_lean_deg": round(math.degrees(math.atan(loose_tilt_slope(design))), 1),
        "thinnest_loose_mm": round(min_thickness_loose(design, dims), 2),
    }


def made_for(design: Design, card: Silicone) -> bool:
    """Whether the mold's shrinkage lies within the silicone's, to half a tenth of a percent."""
    made, range_ = design.mold.silicone_shrinkage_percent, card.shrinkage_percent
    return range_.low - 0.05 <= made <= range_.high + 0.05


def bill_of_materials(design: Design) -> list[dict[str, Any]]:
    """What has to be bought beside the silicone: item, count, and its sizes [mm]."""
    bolts = hardware.clamp_bolts(design)
    thread = bolts.thread
    bone, sensor = design.bone, design.sensor
    cross = select_thread(bone.cross_bolt_diameter_mm).diameter_mm
    around = bone.post_diameter_mm if bone.interface == "plain" else design.dimensions.envelope.section.half_width * 2
    return [
        {"item": "force-sensing resistor", "type": design.dimensions.sensor.label, "count": 1},
        {"item": "adhesive film under the sensor", "thickness_mm": sensor.adhesive_thickness_mm, "count": 1},
        {
            "item": "bolt of the mold", "thread_mm": thread.diameter_mm, "length_mm": bolts.length_mm,
            "count": bolts.count,
        },
        {
            "item": "nut of the mold", "thread_mm": thread.diameter_mm, "across_flats_mm": thread.nut_flats_mm,
            "count": bolts.count,
        },
        {"item": "cross bolt", "thread_mm": cross, "longer_than_mm": round(around, 1), "count": 1},
        {"item": "nut of the cross bolt", "thread_mm": cross, "count": 1},
        {"item": "stranded wire, both together thinner than", "diameter_mm": bone.channel_diameter_mm, "count": 2},
        {"item": "cable tie or thread, thinner than", "diameter_mm": bone.tie_hole_diameter_mm, "count": 1},
    ]  # fmt: skip


def _card(card: Silicone) -> dict[str, Any]:
    values = {
        name: {"low": f.low, "high": f.high, "source": SOURCES[f.source], "verified": f.verified}
        for name, f in card.figures().items()
    }
    return {"name": card.name, "label": card.label, "cure": card.cure, "figures": values}


def _volumes(volumes: SiliconeVolumes) -> dict[str, float]:
    return {
        "skin": round(volumes.skin_cm3, 2),
        "runners": round(volumes.runners_cm3, 2),
        "gap": round(volumes.gap_cm3, 2),
        "total": round(volumes.total_cm3, 2),
    }


def _batch(card: Silicone, volumes: SiliconeVolumes) -> dict[str, float]:
    mixed = batch(card, volumes.total_cm3)
    a, b = round(mixed.a_g, 1), round(mixed.b_g, 2)
    return {
        "in_mold_g": round(mixed.in_mold_g, 2),
        "a_g": a,
        "b_g": b,
        "total_g": round(a + b, 2),
        "waste_percent": round(100.0 * WASTE_FRACTION, 1),
        "min_part_g": MIN_PART_G,
    }


def _printing(design: Design, prints: Mapping[str, PrintEstimate] | None) -> dict[str, Any]:
    parts = []
    for name, how in print_orientations(design).items():
        entry: dict[str, Any] = {
            "part": name, "on_the_plate": how.face_on_plate, "turn_x_deg": how.rotate_x_deg, "supports": how.supports
        }  # fmt: skip
        if prints and name in prints:
            entry |= {"minutes": round(prints[name].minutes), "filament_cm3": round(prints[name].filament_cm3, 1)}
        parts.append(entry)
    data: dict[str, Any] = {"parts": parts}
    if prints:
        data |= {
            "layer_mm": LAYER_MM,
            "minutes": sum(part.get("minutes", 0) for part in parts),
            "filament_cm3": round(sum(part.get("filament_cm3", 0.0) for part in parts), 1),
        }
    return data
