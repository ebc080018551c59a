"""Sizes of the parts that stay in the finger, and of their jig, on their sheets; the mold has a module of its own."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple, replace

from fingertip.cad.shapes import hand_stub, stand
from fingertip.cad.shapes.bone import FOOT_GAP_MM
from fingertip.design import Design
from fingertip.design.geometry.features import INSERT_BASE_MM
from fingertip.design.geometry.sizes import (
    ARROW_DEG,
    BEFORE_FACE,
    BEHIND_FACE,
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
    Tolerance,
    bore,
    clearance,
    located,
    shared_clearance,
    symmetric,
)
from fingertip.design.geometry.solids import Point3
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.interface import bolt_clearance, middle_y
from fingertip.design.interfaces.rigid import Post

ANY_MATERIAL = "any print material that the silicone tolerates"
_PILOT = "narrow: drill it to size; wide: fill it with epoxy and drill again, or print again"


def bone_drawing(design: Design) -> PartDrawing:
    dims, chaplet = design.dimensions, design.dimensions.chaplet
    tip, interface = dims.bone_outline.tip, interface_of(design)
    assert tip
    free = design.is_cast_apart  # nothing of the mold fits the bone
    pocket_end = dims.sensor_z + dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    low = (0.0, 0.0, interface.low_z(design))
    sizes = [
        Length("overall length", OUTER, "front", "below", "z", low, (0.0, 0.0, tip.z)),
        *(replace(size, tolerance=None, action="") if free else size for size in _base_sizes(design)),
        *_pocket_sizes(design),
        *_trough_sizes(design),
        *_chaplet_sizes(design, (0.0, -dims.platform_depth, pocket_end)),
        *interface.sizes(design),
    ]
    axes: tuple[AxisLine, ...] = ()
    if chaplet:
        above, below = chaplet.facet_y + 1.0, chaplet.facet_y - chaplet.pilot_depth - 1.0
        axes = (AxisLine("section", (0.0, above, chaplet.z), (0.0, below, chaplet.z)),)
    return PartDrawing("bone", "Bone", "palmar", _material(design), tuple(sizes), axes, interface.notes(design))


def lid_drawing(design: Design) -> PartDrawing:
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
               _of_lid_and_trough(design), "sand the sides until the lid drops into the trough"),
        Length("height", OUTER, "front", "right", "y", (half, foot, end), (half, top, low), located(design, top - foot),
               "sand the feet: a high lid presses the skin thin, a low one leaves a step"),
        Length("width of the space for the tabs", INNER, "end", "above", "x", (fold.tabs_half_width, tabs, low),
               (-fold.tabs_half_width, tabs, low), None, "narrow: file it, and measure it with calipers"),
        Length("height of the space for the tabs", STEP, "section", "left", "y", (half, foot, end), (0.0, tabs, low),
               None, "file it until crimps and wires pass: the lid must not press on them"),
        Length("height of the space for the film", STEP, "end", "right", "y", (half, foot, end), (half, film, low)),
    )  # fmt: skip
    return PartDrawing("lid", "Lid", "palmar", _material(design), sizes)


def insert_drawing(design: Design) -> PartDrawing:
    dims, z = design.dimensions, design.dimensions.sensor_z
    assert dims.insert
    film, (stem, *caps) = -dims.platform_depth - INSERT_BASE_MM, dims.insert.parts
    height = dims.insert.height - INSERT_BASE_MM
    foot = (0.0, film, z - stem[0])
    sizes: list[Size] = [
        Length(f"diameter of the {'stem' if caps else 'disc'}", OUTER, "section", "below", "z", foot,
               (0.0, film, z + stem[0]), symmetric(0.1), "wide: sand it, or it presses beside the active area",
               is_diameter=True),
        Length("height", OUTER, "section", "right", "y", foot, (0.0, film - height, z), symmetric(0.1),
               "high: sand it, or the skin over it is thin"),
    ]  # fmt: skip
    for radius, _ in caps:
        edge = (0.0, film - height, z - radius)
        sizes += [
            Length("diameter of the cap", OUTER, "front", "below", "z", edge, (0.0, film - height, z + radius),
                   symmetric(0.1), "wide: file its rim until it falls through the jig", is_diameter=True),
            Length("height of the cap", OUTER, "section", "left", "y", edge,
                   (0.0, film - stem[1] + INSERT_BASE_MM, z - radius)),
        ]  # fmt: skip
    return PartDrawing("sensor_insert", "Insert on the sensor", "palmar", ANY_MATERIAL, tuple(sizes))


def jig_drawing(design: Design) -> PartDrawing:
    dims, gap, z = design.dimensions, design.sensor.clearance_mm, design.dimensions.sensor_z
    assert dims.insert
    film, hole, neck = -dims.platform_depth, dims.insert.radius + gap, dims.neck_half_width + gap
    top = (0.0, film - dims.insert.height, z + gap)
    sizes = (
        Circle("hole of the insert", INNER, "palmar", "y", top, hole, clearance(2 * gap - 2 * design.printer.offset_mm),
               "file it until the insert drops through"),
        Length("width between the walls", INNER, "end", "below", "x", (-neck, film, z), (neck, film, z),
               clearance(2 * gap - 2 * design.printer.offset_mm), "file it until it slips over the ramp"),
    )  # fmt: skip
    return PartDrawing("insert_jig", "Jig of the insert", "palmar", ANY_MATERIAL, sizes)


def stand_drawing(design: Design) -> PartDrawing:
    bone, gap, ((_, _, low), (side, _, high)) = design.bone, stand.post_gap_mm(design), astuple(stand.outline(design))
    y, bolt_z, hole = middle_y(design.dimensions), Post().cross_bolt_z(design), bone.cross_bolt_diameter_mm
    sizes = (
        Length("overall length", OUTER, "front", "below", "z", (0.0, y, low), (0.0, y, high)),
        Circle("socket of the post", INNER, "end", "z", (0.0, y, high), bone.post_width_mm / 2 + gap,
               clearance(gap - design.printer.offset_mm), "narrow: file it until the post slides in"),
        Circle("hole of the cross bolt", INNER, "front", "x", (side, y, bolt_z), hole / 2,
               bolt_clearance(design, hole), "narrow: drill it to size"),
        Length("axis of the cross bolt", BEHIND_FACE, "front", "above", "z", (side, y, high), (side, y, bolt_z)),
    )  # fmt: skip
    return PartDrawing("stand", "Stand", "palmar", ANY_MATERIAL, sizes)


def hand_stub_drawing(design: Design) -> PartDrawing:
    joint, (shoulder, bar), way = hand_stub.joint_of(design), hand_stub.bars(design), hand_stub.guide(design)
    (side, _, root), y, half = shoulder.high, joint.axis_y, design.hand.width_mm / 2
    place, growth, remedy = "width of the tongue", OUTER, "wide: sand it until the bone turns"
    if not joint.is_fork:
        place, growth, remedy = "gap of the fork", INNER, "narrow: file it until the bone turns"
    pin: Point3 = (half if joint.is_fork else side, y, joint.axis_z)
    sizes: list[Size] = [
        Length("shoulder to the joint axis", BEFORE_FACE, "front", "above", "z", (side, y, root), pin),
        Circle("bore of the joint's pin", FINISHED, "front", "x", pin, joint.pin_radius, bore(design),
               "narrow: ream it to the pin; wide: take a thicker pin"),
        Length(place, growth, "palmar", "right", "x", (-half, y, joint.axis_z), (half, y, joint.axis_z),
               clearance(2 * joint.clearance - design.printer.offset_mm), remedy),
    ]  # fmt: skip
    if way:
        mouth = way.x[0], way.y, way.mouth_z
        sizes += [
            Length("tendon to the joint axis", STEP, "front", "right", "y", mouth, pin, is_reference=True),
            Length("width of the tendon's slot", INNER, "palmar", "left", "x",
                   (mouth[0] - way.radius, way.y, bar.low[2]), (mouth[0] + way.radius, way.y, bar.low[2])),
        ]  # fmt: skip
    return PartDrawing("hand_stub", "Stub of the hand", "palmar", ANY_MATERIAL, tuple(sizes))


def _material(design: Design) -> str:
    return design.strength.material.label


def _base_sizes(design: Design) -> Iterator[Size]:
    dims, section, collar = design.dimensions, design.dimensions.bone_outline.section, design.dimensions.collar.section
    free, foot = design.is_cast_apart, -design.bone.collar_length_mm
    base = -dims.full_base_length if free else -design.mold.recess_length_mm
    yield Length("width of the base", OUTER, "palmar", "left", "x", (section.half_width, 0.0, base),
                 (-section.half_width, 0.0, base), located(design, 2 * section.half_width),
                 f"wide: scrape the recess until the base drops in; narrow: {SCALE_REMEDY}")  # fmt: skip
    yield Length("width of the collar", OUTER, "palmar", "right", "x", (collar.half_width, 0.0, 0.0),
                 (-collar.half_width, 0.0, 0.0), located(design, 2 * collar.half_width),
                 f"wide: scrape the recess of the collar until the mold closes; narrow: {SCALE_REMEDY}")  # fmt: skip
    yield Length("length of the collar, at the parting plane", OUTER, "front", "above", "z", (0.0, 0.0, foot),
                 (0.0, 0.0, 0.0), located(design, -foot),
                 "long: sand the foot; short: silicone creeps out, print again")  # fmt: skip
    if dims.fold is None:
        yield Length("height of the base", OUTER, "end", "right", "y", (0.0, -dims.base_flat_depth, base),
                     (0.0, section.dorsal, base), located(design, dims.base_flat_depth + section.dorsal),
                     f"high: scrape the floor of the recess until the mold closes; low: {SCALE_REMEDY}")  # fmt: skip


def _pocket_sizes(design: Design) -> Iterator[Size]:
    dims, gap = design.dimensions, design.sensor.clearance_mm
    flat, half = -dims.platform_depth, dims.tail_half_width
    floor, z, head = flat + dims.pocket_depth, dims.sensor_z, dims.sensor.head_diameter_mm / 2 + gap
    begin = 0.0 if dims.tail_passes_collar else dims.tail_end_z
    slot = begin if dims.tail_passes_collar else begin + dims.relief_half_length  # past the relief, which is deeper
    passage, play = -dims.flat_depth + dims.pocket_depth, clearance(2 * gap - design.printer.offset_mm)
    opening = math.degrees(math.asin(min(1.0, half / head))) + ARROW_DEG  # in which the slot meets the pocket
    yield Length("centre of the sensor", BEFORE_FACE, "palmar", "above", "z",
                 (-dims.collar.section.half_width, 0.0, 0.0), (0.0, flat, z))  # fmt: skip
    yield Circle("pocket of the sensor", INNER, "palmar", "y", (0.0, floor, z), head, play,
                 "small: file the wall until the sensor lies flat; large: centre the sensor by eye",
                 hidden_deg=((180.0 - opening, 180.0 + opening),))  # fmt: skip
    yield Length("width of the slot", INNER, "palmar", "left", "x", (half, -dims.flat_depth, begin),
                 (-half, -dims.flat_depth, begin), play, "narrow: file it until the tail lies flat")  # fmt: skip
    if design.bone.platform_mm:
        yield Length("depth of the slot", STEP, "section", "left", "y", (0.0, -dims.flat_depth, slot),
                     (0.0, passage, slot), located(design, dims.pocket_depth),
                     "shallow: scrape the floor until the tail is flush; deep: lay a second film under it")  # fmt: skip
    if dims.tail_passes_collar:
        yield Length("height of the passage through the collar", INNER, "section", "left", "y", (0.0, passage, 0.0),
                     (0.0, passage - dims.passage_height, 0.0), None,
                     "low: file it until a drill of this size passes")  # fmt: skip
    yield Length(f"depth of the {_seat_name(design)}", STEP, "section", "right", "y", (0.0, 0.0, z),
                 (0.0, flat, z + head), is_reference=True)  # fmt: skip
    yield from platform_size(design)
    yield Length("depth of the pocket", STEP, "section", "right", "y", (0.0, flat, z + head), (0.0, floor, z + head),
                 located(design, dims.pocket_depth),
                 "shallow: scrape the floor until the sensor is flush; deep: lay a second film under it")  # fmt: skip


def _trough_sizes(design: Design) -> Iterator[Size]:
    """List what the lid must fit, if the tail is folded; the depth is taken from the edges of trough and collar."""
    dims, fold, half = design.dimensions, design.dimensions.fold, design.dimensions.tail_half_width
    if fold:
        top = dims.collar.dorsal_height_at(half, 0.0)
        yield Length("width of the trough", INNER, "end", "above", "x", (half, top, 0.0), (-half, top, 0.0),
                     _of_lid_and_trough(design), "narrow: file it until the lid drops in")  # fmt: skip
        yield Length("depth of the trough at the collar", STEP, "section", "left", "y", (0.0, top, 0.0),
                     (0.0, fold.floor_y, 0.0), located(design, top - fold.floor_y), "shallow: scrape the floor until "
                     "the lid is flush; deep: lay film under the lid's feet")  # fmt: skip


def _of_lid_and_trough(design: Design) -> Tolerance:
    """Find the tolerance of both widths; both print wrong by the printer's offset."""
    return shared_clearance(2 * (design.sensor.clearance_mm - design.printer.offset_mm))


def _seat_name(design: Design) -> str:
    return "platform" if design.bone.platform_mm else "palmar flat"


def platform_size(design: Design, inset: float = 0.0, scale: float = 1.0) -> Iterator[Size]:
    """Size the platform above the flat that lies distal to it."""
    dims = design.dimensions
    if design.bone.platform_mm:
        end = (dims.sensor_z + dims.platform_radius - inset) * scale
        flat, top = (-(depth - inset) * scale for depth in (dims.flat_depth, dims.platform_depth))
        yield Length("height of the platform", STEP, "section", "right", "y", (0.0, flat, end), (0.0, top, end),
                     located(design, flat - top),
                     "high: the skin over the sensor is thin; low: it is thick; print again")  # fmt: skip


def _chaplet_sizes(design: Design, on_flat: Point3) -> list[Size]:
    """List the sizes of facet and pilot hole; `on_flat` is a point of the palmar flat."""
    if (chaplet := design.dimensions.chaplet) is None:
        return []
    z, facet, radius = chaplet.z, chaplet.facet_y, chaplet.pilot_radius
    bite = (chaplet.thread.diameter_mm - 2 * radius) / 4.0
    return [
        Length("axis of the screw", BEFORE_FACE, "section", "above", "z",
               (0.0, design.dimensions.collar.section.dorsal, 0.0), (0.0, facet, z)),
        Length("height of the facet", STEP, "section", "left", "y", (0.0, 0.0, z), (0.0, facet, z), is_reference=True),
        Length(f"{_seat_name(design)} to facet", OUTER, "section", "right", "y", on_flat, (0.0, facet, z),
               located(design, facet - on_flat[1]), "thick: sand the facet; thin: lay film between bone and boss"),
        Length("pilot hole of the screw", FINISHED, "section", "above", "z", (0.0, facet, z - radius),
               (0.0, facet, z + radius), symmetric(bite), _PILOT, is_diameter=True),
        Length("depth of the pilot hole", STEP, "section", "right", "y", (0.0, facet, z),
               (0.0, facet - chaplet.pilot_depth, z)),
    ]  # fmt: skip
