"""Sizes of bone and stand on their sheets; the mold has a module of its own."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple

from fingertip.cad.shapes import bench
from fingertip.design import Design
from fingertip.design.geometry.sizes import (
    ARROW_DEG,
    BEFORE_FACE,
    BEHIND_FACE,
    FINISHED,
    INNER,
    MIN_TOLERANCE_MM,
    OUTER,
    STEP,
    Circle,
    Length,
    PartDrawing,
    Size,
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


def bone_drawing(design: Design) -> PartDrawing:
    tip, interface = design.dimensions.bone_outline.tip, interface_of(design)
    assert tip
    low = (0.0, 0.0, interface.low_z(design))
    sizes = [
        Length("overall length", OUTER, "front", "below", "z", low, (0.0, 0.0, tip.z)),
        *_base_sizes(design),
        *_pocket_sizes(design),
        *interface.sizes(design),
    ]
    return PartDrawing("bone", "Bone", "palmar", _material(design), tuple(sizes), notes=interface.notes(design))


def stand_drawing(design: Design) -> PartDrawing:
    bone, gap = design.bone, bench.post_gap_mm(design)
    (_, _, low), (side, _, high) = astuple(bench.stand_outline(design))
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


def pin_drawing(design: Design) -> PartDrawing:
    radius, length = bench.joint_of(design).printed_pin_radius, design.dimensions.pin_length
    sizes = (
        Length("length of the pin", OUTER, "front", "below", "z", (0.0, 0.0, 0.0), (0.0, 0.0, length)),
        Circle("diameter of the pin", OUTER, "end", "z", (0.0, 0.0, length), radius, symmetric(MIN_TOLERANCE_MM),
               "thick: sand it until it slides; thin: it falls out, print again"),
    )  # fmt: skip
    return PartDrawing("pin", "Pin of the joint", "palmar", design.strength.material.label, sizes)


def hand_stub_drawing(design: Design) -> PartDrawing:
    joint, (shoulder, bar), way = bench.joint_of(design), bench.bars(design), bench.guide(design)
    (side, _, root), y, half = shoulder.high, joint.axis_y, design.hand.width_mm / 2
    place, growth, remedy = "width of the tongue", OUTER, "wide: sand it until the bone turns"
    if not joint.is_fork:
        place, growth, remedy = "gap of the fork", INNER, "narrow: file it until the bone turns"
    pin: Point3 = (half if joint.is_fork else side, y, joint.axis_z)
    sizes: list[Size] = [
        Length("shoulder to the joint axis", BEFORE_FACE, "front", "above", "z", (side, y, root), pin),
        Circle("bore of the joint's pin", FINISHED, "front", "x", pin, bench.stub_bore_radius(joint), bore(design),
               "narrow: ream it to the pin; wide: take a thicker pin"),
        Length(place, growth, "palmar", "right", "x", (-half, y, joint.axis_z), (half, y, joint.axis_z),
               shared_clearance(2 * (joint.clearance - design.printer.offset_mm)), remedy),
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
    base, foot = -dims.full_base_length, -design.bone.collar_length_mm
    yield Length("width of the base", OUTER, "palmar", "left", "x", (section.half_width, 0.0, base),
                 (-section.half_width, 0.0, base))  # fmt: skip
    yield Length("width of the collar", OUTER, "palmar", "right", "x", (collar.half_width, 0.0, 0.0),
                 (-collar.half_width, 0.0, 0.0))  # fmt: skip
    yield Length("length of the collar", OUTER, "front", "above", "z", (0.0, 0.0, foot), (0.0, 0.0, 0.0))
    yield Length("height of the base", OUTER, "end", "right", "y", (0.0, -dims.base_flat_depth, base),
                 (0.0, section.dorsal, base))  # fmt: skip


def _pocket_sizes(design: Design) -> Iterator[Size]:
    dims, gap = design.dimensions, design.sensor.clearance_mm
    flat, half = -dims.platform_depth, dims.tail_half_width
    floor, z, head = flat + dims.pocket_depth, dims.sensor_z, dims.sensor.head_diameter_mm / 2 + gap
    begin, play = dims.tail_end_z, clearance(2 * gap - design.printer.offset_mm)
    opening = math.degrees(math.asin(min(1.0, half / head))) + ARROW_DEG  # in which the slot meets the pocket
    yield Length("centre of the sensor", BEFORE_FACE, "palmar", "above", "z",
                 (-dims.collar.section.half_width, 0.0, 0.0), (0.0, flat, z))  # fmt: skip
    yield Circle("pocket of the sensor", INNER, "palmar", "y", (0.0, floor, z), head, play,
                 "small: file the wall until the sensor lies flat; large: centre the sensor by eye",
                 hidden_deg=((180.0 - opening, 180.0 + opening),))  # fmt: skip
    yield Length("width of the slot", INNER, "palmar", "left", "x", (half, -dims.flat_depth, begin),
                 (-half, -dims.flat_depth, begin), play, "narrow: file it until the tail lies flat")  # fmt: skip
    if design.bone.platform_mm:
        yield Length("depth of the slot", STEP, "section", "left", "y", (0.0, -dims.flat_depth, begin),
                     (0.0, -dims.flat_depth + dims.pocket_depth, begin), located(design, dims.pocket_depth),
                     "shallow: scrape the floor until the tail is flush; deep: lay a second film under it")  # fmt: skip
    yield Length(f"depth of the {_seat_name(design)}", STEP, "section", "right", "y", (0.0, 0.0, z),
                 (0.0, flat, z + head), is_reference=True)  # fmt: skip
    yield from platform_size(design)
    yield Length("depth of the pocket", STEP, "section", "right", "y", (0.0, flat, z + head), (0.0, floor, z + head),
                 located(design, dims.pocket_depth),
                 "shallow: scrape the floor until the sensor is flush; deep: lay a second film under it")  # fmt: skip


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
