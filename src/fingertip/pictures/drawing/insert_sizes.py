"""Sizes of what lies in the mold, bone or core, and of the lid of a folded tail."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.cad.shapes.bone import FOOT_GAP_MM
from fingertip.cad.shapes.insert import axis_z, contact_y
from fingertip.catalogues.print_materials import PRINT_MATERIALS
from fingertip.design import Design
from fingertip.design.geometry.sizes import (
    ARROW_DEG,
    BEFORE_FACE,
    FINISHED,
    INNER,
    OUTER,
    SCALE_REMEDY,
    STEP,
    AxisLine,
    Circle,
    Length,
    PartDrawing,
    Size,
    clearance,
    located,
    symmetric,
)
from fingertip.design.geometry.solids import Point3
from fingertip.design.interfaces import interface_of

_PILOT = "narrow: drill it to size; wide: fill it with epoxy and drill again, or print again"


def bone_drawing(design: Design) -> PartDrawing:
    """List what the sheet of the bone shows."""
    dims, section, pilot = design.dimensions, design.dimensions.bone_outline.section, _pilot_of_bone(design)
    tip, interface = dims.bone_outline.tip, interface_of(design)
    assert tip
    low = (0.0, 0.0, interface.low_z(design))
    sizes = [
        Length("overall length", OUTER, "front", "below", "z", low, (0.0, 0.0, tip.z)),
        *_base_sizes(design),
        *_pocket_sizes(design),
        *_chaplet_sizes(design, pilot, "bone", _distal_end_of_pocket(design)),
        *interface.sizes(design),
    ]
    if not dims.window_opens_into_gap:
        tie = (section.half_width, dims.tie_hole_y, dims.tie_hole_z)
        sizes.append(Circle("hole of the tie", INNER, "front", "x", tie, design.bone.tie_hole_diameter_mm / 2))
    return PartDrawing("bone", "Bone", "palmar", _material(design), tuple(sizes), _axes(pilot))


def core_drawing(design: Design) -> PartDrawing:
    """List what the sheet of a sleeve's core shows."""
    dims, inset, scale = design.dimensions, design.mold.sleeve_interference_mm, design.dimensions.shrinkage
    pilot = _pilot_of_core(design)
    tip = dims.bone_outline.tip
    assert tip
    apex, flat = (tip.z - inset) * scale, -(dims.flat_depth - inset) * scale
    low = dims.base_end_z
    sizes = [
        Length("overall length", OUTER, "front", "below", "z", (0.0, 0.0, low), (0.0, 0.0, apex), symmetric(0.2),
               f"{SCALE_REMEDY}: the skin is thin or thick at the tip"),
        *_base_sizes(design),
        Length("length of the base", OUTER, "front", "below", "z", (0.0, 0.0, low), (0.0, 0.0, 0.0)),
        Length("depth of the palmar flat", STEP, "section", "right", "y", (0.0, 0.0, apex), (0.0, flat, dims.sensor_z),
               is_reference=True),
        *_chaplet_sizes(design, pilot, "core", (0.0, flat, dims.sensor_z)),
    ]  # fmt: skip
    return PartDrawing("core", "Core", "palmar", _material(design), tuple(sizes), _axes(pilot))


def lid_drawing(design: Design) -> PartDrawing:
    """List what the sheet of the lid shows."""
    dims, fold, gap = design.dimensions, design.dimensions.fold, design.sensor.clearance_mm
    closing = 2 * design.printer.offset_mm  # lid and trough both grow
    assert fold
    half = dims.sensor.tail_width_mm / 2
    foot, end, top = fold.floor_y + FOOT_GAP_MM, fold.trough_end_z - gap, dims.collar.section.dorsal
    tabs, film = fold.floor_y + fold.tabs_space_mm, fold.floor_y + fold.film_space_mm
    low = fold.nose_z
    sizes = (
        Length("length", OUTER, "front", "below", "z", (0.0, foot, low), (0.0, foot, end), clearance(gap - closing),
               "sand the distal end until the lid drops into the trough"),
        Length("width", OUTER, "palmar", "left", "x", (half, foot, low), (-half, foot, low),
               clearance(2 * gap - closing),
               "sand the sides until the lid drops into the trough"),
        Length("height", OUTER, "front", "right", "y", (half, foot, end), (half, top, low), located(design, top - foot),
               "sand the feet: a high lid presses the skin thin, a low one leaves a step"),
        Length("width of the space for the tabs", INNER, "end", "above", "x", (fold.tabs_half_width, tabs, low),
               (-fold.tabs_half_width, tabs, low), None, "file it until the crimps pass"),
        Length("height of the space for the tabs", STEP, "section", "left", "y", (half, foot, end), (0.0, tabs, low),
               None, "file it until crimps and wires pass: the lid must not press on them"),
        Length("height of the space for the film", STEP, "end", "right", "y", (half, foot, end), (half, film, low)),
    )  # fmt: skip
    return PartDrawing("lid", "Lid", "palmar", _material(design), sizes)


def _material(design: Design) -> str:
    return PRINT_MATERIALS[design.strength.print_material].label


def _base_sizes(design: Design) -> list[Size]:
    """List the sizes that locate bone and core in the recess of the mold."""
    dims, section, collar = design.dimensions, design.dimensions.bone_outline.section, design.dimensions.collar.section
    base, foot = -design.mold.recess_length_mm, -design.bone.collar_length_mm
    sizes: list[Size] = [
        Length("width of the base", OUTER, "palmar", "left", "x", (section.half_width, 0.0, base),
               (-section.half_width, 0.0, base), located(design, 2 * section.half_width),
               f"wide: scrape the recess until the base drops in; narrow: {SCALE_REMEDY}"),
        Length("width of the collar", OUTER, "palmar", "right", "x", (collar.half_width, 0.0, 0.0),
               (-collar.half_width, 0.0, 0.0), located(design, 2 * collar.half_width),
               f"wide: scrape the recess of the collar until the mold closes; narrow: {SCALE_REMEDY}"),
        Length("length of the collar, at the parting plane", OUTER, "front", "above", "z", (0.0, 0.0, foot),
               (0.0, 0.0, 0.0),
               located(design, -foot), "long: sand the foot; short: silicone creeps out, print again"),
    ]  # fmt: skip
    if dims.fold is None:
        sizes.append(
            Length("height of the base", OUTER, "end", "right", "y", (0.0, -dims.base_flat_depth, base),
                   (0.0, section.dorsal, base), located(design, dims.base_flat_depth + section.dorsal),
                   f"high: scrape the floor of the recess until the mold closes; low: {SCALE_REMEDY}")
        )  # fmt: skip
    return sizes


def _pocket_sizes(design: Design) -> list[Size]:
    """List the sizes of the sensor's pocket and slot."""
    dims, gap = design.dimensions, design.sensor.clearance_mm
    flat, half = -dims.flat_depth, dims.tail_half_width
    floor, z, head = flat + dims.pocket_depth, dims.sensor_z, dims.sensor.head_diameter_mm / 2 + gap
    begin = 0.0 if dims.tail_passes_collar else dims.tail_end_z
    opening = math.degrees(math.asin(min(1.0, half / head))) + ARROW_DEG  # in which the slot meets the pocket
    return [
        Length("centre of the sensor", BEFORE_FACE, "palmar", "above", "z",
               (-dims.collar.section.half_width, 0.0, 0.0), (0.0, flat, z)),
        Circle("pocket of the sensor", INNER, "palmar", "y", (0.0, floor, z), head,
               clearance(2 * gap - design.printer.offset_mm),
               "small: file the wall until the sensor lies flat; large: centre the sensor by eye",
               hidden_deg=((180.0 - opening, 180.0 + opening),)),
        Length("width of the slot", INNER, "palmar", "left", "x", (half, flat, begin), (-half, flat, begin),
               clearance(2 * gap - design.printer.offset_mm)),
        Length("depth of the palmar flat", STEP, "section", "right", "y", (0.0, 0.0, z), (0.0, flat, z + head),
               is_reference=True),
        Length("depth of the pocket", STEP, "section", "right", "y", (0.0, flat, z + head), (0.0, floor, z + head),
               located(design, dims.pocket_depth),
               "shallow: scrape the floor until the sensor is flush; deep: lay a second film under it"),
    ]  # fmt: skip


@dataclass(frozen=True)
class _Pilot:
    """Pilot hole of the chaplet's screw in bone or core [mm]."""

    z: float
    facet_y: float
    radius: float
    depth: float


def _pilot_of_bone(design: Design) -> _Pilot | None:
    chaplet = design.dimensions.chaplet
    return _Pilot(chaplet.z, chaplet.facet_y, chaplet.pilot_radius, chaplet.pilot_depth) if chaplet else None


def _pilot_of_core(design: Design) -> _Pilot | None:
    """Pilot hole of the core: that of the bone, enlarged, below a facet that is inset."""
    chaplet, scale = design.dimensions.chaplet, design.dimensions.shrinkage
    if chaplet is None:
        return None
    facet, low = contact_y(design), (chaplet.facet_y - chaplet.pilot_depth) * scale
    return _Pilot(axis_z(design), facet, chaplet.pilot_radius * scale, facet - low)


def _distal_end_of_pocket(design: Design) -> Point3:
    """Point of the palmar flat at which the pocket of the sensor ends."""
    dims = design.dimensions
    return 0.0, -dims.flat_depth, dims.sensor_z + dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm


def _chaplet_sizes(design: Design, pilot: _Pilot | None, insert: str, on_flat: Point3) -> list[Size]:
    """List the sizes of facet and pilot hole; `on_flat` is a point of the palmar flat."""
    chaplet = design.dimensions.chaplet
    if pilot is None or chaplet is None:
        return []
    facet, z, low, radius = pilot.facet_y, pilot.z, pilot.facet_y - pilot.depth, pilot.radius
    bite = (chaplet.thread.diameter_mm - 2 * chaplet.pilot_radius) / 4.0
    return [
        Length("axis of the screw", BEFORE_FACE, "section", "above", "z",
               (0.0, design.dimensions.collar.section.dorsal, 0.0), (0.0, facet, z)),
        Length("height of the facet", STEP, "section", "left", "y", (0.0, 0.0, z), (0.0, facet, z), is_reference=True),
        Length("palmar flat to facet", OUTER, "section", "right", "y", on_flat, (0.0, facet, z),
               located(design, facet - on_flat[1]), f"thick: sand the facet; thin: lay film between {insert} and boss"),
        Length("pilot hole of the screw", FINISHED, "section", "above", "z", (0.0, facet, z - radius),
               (0.0, facet, z + radius),
               symmetric(bite), _PILOT, is_diameter=True),
        Length("depth of the pilot hole", STEP, "section", "right", "y", (0.0, facet, z), (0.0, low, z)),
    ]  # fmt: skip


def _axes(pilot: _Pilot | None) -> tuple[AxisLine, ...]:
    if pilot is None:
        return ()
    z, top = pilot.z, pilot.facet_y
    return (AxisLine("section", (0.0, top + 1.0, z), (0.0, top - pilot.depth - 1.0, z)),)
