"""Sizes of the printed parts on their sheets: bone, stand, pin and stub, then the halves of the cup and the core."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple

from fingertip.cad.shapes import bench
from fingertip.design import Design
from fingertip.design.geometry import mold_layout as mold
from fingertip.design.geometry.sizes import (
    ARROW_DEG,
    BEFORE_FACE,
    BEHIND_FACE,
    FINISHED,
    INNER,
    MIN_TOLERANCE_MM,
    OUTER,
    SCALE_REMEDY,
    STEP,
    Circle,
    Length,
    PartDrawing,
    Size,
    ViewName,
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
    material = design.strength.material.label
    return PartDrawing("bone", "Bone", "palmar", material, tuple(sizes), notes=interface.notes(design))


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
    seat = "platform" if design.bone.platform_mm else "palmar flat"
    yield Length(f"depth of the {seat}", STEP, "section", "right", "y", (0.0, 0.0, z), (0.0, flat, z + head),
                 is_reference=True)  # fmt: skip
    yield from platform_size(design)
    yield Length("depth of the pocket", STEP, "section", "right", "y", (0.0, flat, z + head), (0.0, floor, z + head),
                 located(design, dims.pocket_depth),
                 "shallow: scrape the floor until the sensor is flush; deep: lay a second film under it")  # fmt: skip


def platform_size(design: Design, inset: float = 0.0, scale: float = 1.0) -> Iterator[Size]:
    """Size the platform above the flat that lies distal to it."""
    dims = design.dimensions
    if design.bone.platform_mm:
        end = (dims.sensor_z + dims.platform_radius - inset) * scale
        flat, top = (-(depth - inset) * scale for depth in (dims.flat_depth, dims.platform_depth))
        yield Length("height of the platform", STEP, "section", "right", "y", (0.0, flat, end), (0.0, top, end),
                     located(design, flat - top),
                     "high: the skin over the sensor is thin; low: it is thick; print again")  # fmt: skip


def palmar_drawing(design: Design) -> PartDrawing:
    gap = 2.0**0.5 * (mold.KEY_CLEARANCE_MM + max(0.0, design.printer.offset_mm))
    sizes = (*_half_sizes(design, "dorsal", -1.0), *_key_sizes(design, "dorsal", gap), *_crown_size(design))
    return PartDrawing("mold_palmar", "Cup, half of the pad", "dorsal", ANY_MATERIAL, sizes)


def dorsal_drawing(design: Design) -> PartDrawing:
    half, high = mold.RIDGE_HALF_CREST_MM + mold.RIDGE_HEIGHT_MM - mold.GAP_MM, design.mold_layout.dorsal_height
    groove = Length("width of the groove at the rim", INNER, "end", "above", "x", (half, high, mold.GAP_MM),
                    (-half, high, mold.GAP_MM), located(design, 2 * half),
                    "out of tolerance: the core leans, measure it as the sheet says")  # fmt: skip
    sizes = (*_half_sizes(design, "palmar", 1.0), *_key_sizes(design, "palmar", 0.0), groove)
    return PartDrawing("mold_dorsal", "Cup, dorsal half", "palmar", ANY_MATERIAL, sizes)


def _half_sizes(design: Design, plan: ViewName, way: float) -> Iterator[Size]:
    m, dims = design.mold_layout, design.dimensions
    outer, growth, half, z = dims.outer, dims.shrinkage, m.half_width, mold.GAP_MM
    face = m.dorsal_height if way > 0.0 else -m.palmar_height
    rim = mold.LIP_GAP_MM
    at = rim / growth
    skin = outer.half_width_at(0.0, at) * growth
    deep = (outer.dorsal_height_at(0.0, at) if way > 0.0 else -outer.palmar_height_at(0.0, at)) * growth
    belt = m.belts_z[0] - mold.BELT_MM[0] / 2
    yield Length("height of the cup", OUTER, plan, "below", "z", (half, 0.0, z), (half, 0.0, m.foot_z),
                 symmetric(0.2), f"{SCALE_REMEDY}: the skin is thin or thick at the tip")  # fmt: skip
    yield Length("width of the cup", OUTER, plan, "right", "x", (half, 0.0, m.foot_z), (-half, 0.0, m.foot_z))
    yield Length("depth of the half", OUTER, "end", "right", "y", (half, 0.0, z), (half, face, z))
    yield Length("width of the cavity at the rim", INNER, plan, "left", "x", (skin, 0.0, rim), (-skin, 0.0, rim), None,
                 f"{SCALE_REMEDY}: the skin follows from it")  # fmt: skip
    yield Length("depth of the cavity at the rim", STEP, "section", "left", "y", (0.0, 0.0, rim), (0.0, deep, rim))
    yield Length(
        "rim to the first belt", STEP, "front", "above", "z", (0.0, face, z), (0.0, face - way * mold.BELT_MM[1], belt)
    )
    yield Length(
        "depth of the belts", STEP, "front", "right", "y", (0.0, face, z), (0.0, face - way * mold.BELT_MM[1], belt)
    )


def _key_sizes(design: Design, plan: ViewName, gap: float) -> Iterator[Size]:
    kind, remedy = ("socket", "narrow: scrape it") if gap else ("key", "wide: sand it")
    tolerance = shared_clearance(2 * mold.KEY_CLEARANCE_MM)
    for key, label in zip(design.mold_layout.keys, ("larger", "smaller"), strict=True):
        yield Circle(f"{label} {kind}, at the parting plane", INNER if gap else OUTER, plan, "y", (key.x, 0.0, key.z),
                     key.root_mm / 2 + gap, tolerance, f"{remedy} until the halves close")  # fmt: skip


def core_drawing(design: Design) -> PartDrawing:
    m, dims, inset = design.mold_layout, design.dimensions, design.mold.core_inset_mm
    tip, half, growth = dims.bone_outline.tip, m.half_width + mold.PLATE_LEDGE_MM, dims.shrinkage
    assert tip
    apex, ridge = (0.0, 0.0, (tip.z - inset) * growth), mold.RIDGE_HALF_CREST_MM + mold.RIDGE_HEIGHT_MM
    end = m.dorsal_height - mold.RIDGE_END_MM
    sizes = (
        Length("plate to tip", STEP, "front", "above", "z", (0.0, m.dorsal_height, 0.0), apex, symmetric(0.2),
               f"{SCALE_REMEDY}: the skin is thin or thick at the tip"),
        Length("overall length", OUTER, "front", "below", "z", (0.0, -m.palmar_height, -mold.PLATE_MM), apex),
        Length("thickness of the plate", OUTER, "front", "below", "z", (0.0, -m.palmar_height, -mold.PLATE_MM),
               (0.0, -m.palmar_height, 0.0)),
        Length("width of the plate", OUTER, "palmar", "right", "x", (half, -m.palmar_height, 0.0),
               (-half, -m.palmar_height, 0.0)),
        Length("depth of the plate", OUTER, "front", "left", "y", (0.0, -m.palmar_height, -mold.PLATE_MM),
               (0.0, m.dorsal_height, -mold.PLATE_MM)),
        Length("height of the ridges", STEP, "section", "above", "z", (0.0, m.dorsal_height, 0.0),
               (0.0, end, mold.RIDGE_HEIGHT_MM)),
        Length("width of the ridges at the plate", OUTER, "end", "above", "x", (ridge, end, 0.0), (-ridge, end, 0.0),
               located(design, 2 * ridge), "out of tolerance: the core leans, measure it as the sheet says"),
        *platform_size(design, inset, growth),
    )  # fmt: skip
    return PartDrawing("core", "Core", "palmar", ANY_MATERIAL, sizes)


def _crown_size(design: Design) -> Iterator[Size]:
    """Size the cavity at the apex of the crown, where it is deepest."""
    dims, growth = design.dimensions, design.dimensions.shrinkage
    if dims.crown:
        z = dims.crown.z * growth
        yield Length("depth of the cavity at the crown's apex", STEP, "section", "right", "y", (0.0, 0.0, z),
                     (0.0, -dims.outer.section.palmar * growth, z), None,
                     "shallow or deep: the skin over the sensor is thin or thick, print again")  # fmt: skip
