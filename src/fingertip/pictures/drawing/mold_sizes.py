"""Sizes of the halves of mold or cup on their sheets, and of the core of a cup."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.shapes.insert import axis_z, contact_y, head_y
from fingertip.cad.shapes.mold import recess_half_width
from fingertip.catalogues.hardware import LUER_MOUTH_MM, select_thread
from fingertip.design import Design
from fingertip.design.geometry.cup_layout import (
    BELT_MM,
    GAP_MM,
    LEDGE_MM,
    LIP_GAP_MM,
    PLATE_MM,
    RIDGE_END_MM,
    RIDGE_HALF_CREST_MM,
    RIDGE_HEIGHT_MM,
)
from fingertip.design.geometry.features import Chaplet
from fingertip.design.geometry.sizes import (
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
    ViewName,
    clearance,
    located,
    nut_trap,
    shared_clearance,
    symmetric,
)
from fingertip.pictures.drawing.part_sizes import ANY_MATERIAL, platform_size


def palmar_drawing(design: Design) -> PartDrawing:
    m, mold = design.mold_layout, design.mold
    low, thread = -m.palmar_height, select_thread(mold.bolt_diameter_mm)
    x, z = max(m.bolts)
    half, top = mold.nut_width_mm / 2, low + mold.nut_depth_mm
    dims, recess = design.dimensions, recess_half_width(design)
    floor, deep = -dims.base_flat_depth - mold.fit_clearance_mm, dims.base_palmar_height * dims.shrinkage
    at_end = " at the skin's end" if dims.crown else ""
    sizes = [
        *_common_sizes(design, "dorsal", low),
        *_key_sizes(design, "dorsal", mold.key_clearance_mm, "socket"),
        Length("depth of the recess", STEP, "end", "left", "y", (recess, 0.0, m.proximal_z),
               (recess, floor, m.proximal_z),
               located(design, -floor), "shallow: sand the floor until the bone lies level; deep: print again"),
        Length(f"depth of the cavity{at_end}", STEP, "section", "left", "y", (0.0, 0.0, 0.0), (0.0, -deep, 0.0)),
        *_crown_size(design),
        Length("width of the nut traps across flats", INNER, "dorsal", "above", "z", (x, low, z - half),
               (x, low, z + half), nut_trap(thread, mold.nut_width_mm - design.printer.offset_mm),
               "narrow: file it until the nut drops in; wide: glue the nut in"),
        Length("depth of the nut traps", STEP, "front", "right", "y", (x, low, z), (x, top, z)),
    ]  # fmt: skip
    axes = tuple(_mold_axes(design, low))
    return PartDrawing("mold_palmar", "Mold, palmar half", "dorsal", ANY_MATERIAL, tuple(sizes), axes)


def _crown_size(design: Design) -> Iterator[Size]:
    """Size the cavity at the apex of the crown, where it is deepest."""
    dims, growth = design.dimensions, design.dimensions.shrinkage
    if dims.crown:
        z = dims.crown.z * growth
        yield Length("depth of the cavity at the crown's apex", STEP, "section", "right", "y", (0.0, 0.0, z),
                     (0.0, -dims.outer.section.palmar * growth, z), None,
                     "shallow or deep: the skin over the sensor is thin or thick, print again")  # fmt: skip


def dorsal_drawing(design: Design) -> PartDrawing:
    m, mold, chaplet = design.mold_layout, design.mold, design.dimensions.chaplet
    high = m.dorsal_height
    sizes = [*_common_sizes(design, "palmar", high), *_key_sizes(design, "palmar", 0.0, "key")]
    dims, recess = design.dimensions, recess_half_width(design)
    top, deep = dims.bone_outline.section.dorsal + mold.fit_clearance_mm, dims.outer.section.dorsal * dims.shrinkage
    sizes += [
        Length("depth of the recess", STEP, "end", "left", "y", (recess, 0.0, m.proximal_z), (0.0, top, m.proximal_z),
               located(design, top)),
        Length("depth of the cavity", STEP, "section", "left", "y", (0.0, 0.0, 0.0), (0.0, deep, 0.0)),
    ]  # fmt: skip
    key_x, key_z, root = m.keys[0]
    tip = key_z + root / 2 - design.dimensions.draft_slope * mold.key_height_mm
    sizes.append(
        Length("height of the keys", STEP, "front", "right", "y", (key_x, 0.0, tip), (key_x, -mold.key_height_mm, tip))
    )
    inlet, mouth = m.inlet, LUER_MOUTH_MM / 2
    sizes.append(
        Length("mouth of the Luer cone", INNER, "front", "above", "z", (inlet.x, high, inlet.z - mouth),
               (inlet.x, high, inlet.z + mouth), is_diameter=True)
    )  # fmt: skip
    if chaplet:
        sizes += _screw_sizes(design, chaplet, high)
    axes = tuple(_mold_axes(design, high))
    return PartDrawing("mold_dorsal", "Mold, dorsal half", "palmar", ANY_MATERIAL, tuple(sizes), axes)


def _common_sizes(design: Design, plan: ViewName, outer: float) -> list[Size]:
    m, mold, dims = design.mold_layout, design.mold, design.dimensions
    x, (low, high) = max(m.bolts)[0], sorted({z for _, z in m.bolts})
    collar = recess_half_width(design, of_collar=True)
    foot = -design.bone.collar_length_mm - mold.fit_clearance_mm * math.hypot(1.0, dims.draft_slope)
    recess, skin = recess_half_width(design), dims.outer.section.half_width * dims.shrinkage
    bolt = mold.bolt_diameter_mm
    bolt_tolerance = clearance(bolt - design.printer.offset_mm - select_thread(bolt).diameter_mm)
    return [
        Length("length of the block", OUTER, plan, "below", "z", (x, 0.0, m.proximal_z), (x, 0.0, m.distal_z)),
        Length("width of the block", OUTER, plan, "right", "x", (m.half_width, 0.0, m.distal_z),
               (-m.half_width, 0.0, m.distal_z)),
        Length("height of the block", OUTER, "end", "right", "y", (m.half_width, 0.0, m.proximal_z),
               (m.half_width, outer, m.proximal_z)),
        Length("width of the recess", INNER, plan, "left", "x", (recess, 0.0, m.proximal_z),
               (-recess, 0.0, m.proximal_z),
               located(design, 2 * recess), f"narrow: sand until the bone's base drops in; wide: {SCALE_REMEDY}"),
        Length("width of the collar's recess", INNER, plan, "left", "x", (collar, 0.0, foot), (-collar, 0.0, foot),
               located(design, 2 * collar),
               "narrow: scrape it until the taped collar drops in; wide: lay a second layer of tape there"),
        Length("proximal face to the skin's end", OUTER, plan, "above", "z", (skin, 0.0, m.proximal_z),
               (skin, 0.0, 0.0)),
        Length("step in the recess to the skin's end, at the parting plane", STEP, plan, "above", "z",
               (collar, 0.0, foot), (skin, 0.0, 0.0)),
        Length("width of the cavity", INNER, plan, "right", "x", (skin, 0.0, 0.0), (-skin, 0.0, 0.0), None,
               f"{SCALE_REMEDY}: skin and play in the mold follow from it"),
        Length("spacing of the bolts, across", STEP, plan, "right", "x", (x, 0.0, high), (-x, 0.0, high),
               bolt_tolerance, f"{SCALE_REMEDY}, until the bolts pass both halves"),
        Length("spacing of the bolts, along", STEP, plan, "below", "z", (x, 0.0, low), (x, 0.0, high),
               bolt_tolerance, f"{SCALE_REMEDY}, until the bolts pass both halves"),
        Length("first bolt", BEHIND_FACE, plan, "below", "z", (x, 0.0, m.proximal_z), (x, 0.0, low)),
        Circle("bolt holes", INNER, plan, "y", (x, 0.0, low), bolt / 2,
               bolt_tolerance, "narrow: drill them to size", count=len(m.bolts)),
    ]  # fmt: skip


def _key_sizes(design: Design, plan: ViewName, gap: float, kind: str) -> Iterator[Size]:
    m, mold = design.mold_layout, design.mold
    offset = gap * math.hypot(1.0, design.dimensions.draft_slope)
    tolerance = shared_clearance(2 * (mold.key_clearance_mm - design.printer.offset_mm))
    remedy = "wide: sand it until the halves close" if kind == "key" else "narrow: scrape it until the halves close"
    for (x, z, root), label in zip(m.keys, ("larger", "smaller"), strict=True):
        action = f"{remedy}; loose: {SCALE_REMEDY}" if label == "larger" else ""
        yield Circle(f"{label} {kind}, at the parting plane", OUTER if kind == "key" else INNER, plan, "y",
                     (x, 0.0, z), root / 2 + offset, tolerance, action)  # fmt: skip
        yield Length(f"axis of the {label} {kind}", BEHIND_FACE, plan, "above", "z", (x, 0.0, m.proximal_z),
                     (x, 0.0, z))  # fmt: skip


def _screw_sizes(design: Design, chaplet: Chaplet, high: float) -> Iterator[Size]:
    z, contact, floor = axis_z(design), contact_y(design), head_y(design)
    hole, head = chaplet.hole_radius, chaplet.head_radius
    yield Length("parting plane to the boss", STEP, "section", "right", "y", (0.0, 0.0, z), (0.0, contact, z),
                 located(design, contact), "less: sand the boss; more: lay film between bone and boss")  # fmt: skip
    yield Length("hole of the screw", FINISHED, "section", "below", "z", (0.0, contact, z - hole),
                 (0.0, contact, z + hole), symmetric(chaplet.play), f"drill it to {2 * hole:g} mm: a print closes it",
                 is_diameter=True)  # fmt: skip
    yield Length("axis of the screw", BEHIND_FACE, "section", "below", "z",
                 (0.0, contact, design.mold_layout.proximal_z), (0.0, contact, z))  # fmt: skip
    if floor < high:
        yield Length("counterbore of the screw", INNER, "section", "above", "z", (0.0, high, z - head),
                     (0.0, high, z + head), is_diameter=True)  # fmt: skip
        yield Length("depth of the counterbore", STEP, "section", "left", "y", (0.0, high, z), (0.0, floor, z))


def _mold_axes(design: Design, outer: float) -> Iterator[AxisLine]:
    past, inlet = math.copysign(1.0, outer), (design.mold_layout.inlet.z,) if outer > 0.0 else ()
    for z in (*sorted({z for _, z in design.mold_layout.bolts}), *inlet):
        yield AxisLine("front", (0.0, -past, z), (0.0, outer + past, z))
    if outer > 0.0 and design.dimensions.chaplet:
        z = axis_z(design)
        yield AxisLine("section", (0.0, contact_y(design) - 1.0, z), (0.0, outer + 1.0, z))


def cup_palmar_drawing(design: Design) -> PartDrawing:
    gap = 2.0**0.5 * design.mold.key_clearance_mm
    sizes = (*_half_sizes(design, "dorsal", -1.0), *_cup_key_sizes(design, "dorsal", gap), *_crown_size(design))
    return PartDrawing("mold_palmar", "Cup, half of the pad", "dorsal", ANY_MATERIAL, sizes)


def cup_dorsal_drawing(design: Design) -> PartDrawing:
    half, high = RIDGE_HALF_CREST_MM + RIDGE_HEIGHT_MM - GAP_MM, design.cup_layout.dorsal_height
    groove = Length("width of the groove at the rim", INNER, "end", "above", "x", (half, high, GAP_MM),
                    (-half, high, GAP_MM), located(design, 2 * half),
                    "out of tolerance: the core leans, measure it as the sheet says")  # fmt: skip
    sizes = (*_half_sizes(design, "palmar", 1.0), *_cup_key_sizes(design, "palmar", 0.0), groove)
    return PartDrawing("mold_dorsal", "Cup, dorsal half", "palmar", ANY_MATERIAL, sizes)


def _half_sizes(design: Design, plan: ViewName, way: float) -> Iterator[Size]:
    m, dims = design.cup_layout, design.dimensions
    outer, growth, half, z = dims.outer, dims.shrinkage, m.half_width, GAP_MM
    face = m.dorsal_height if way > 0.0 else -m.palmar_height
    rim = LIP_GAP_MM
    at = rim / growth
    skin = outer.half_width_at(0.0, at) * growth
    deep = (outer.dorsal_height_at(0.0, at) if way > 0.0 else -outer.palmar_height_at(0.0, at)) * growth
    belt = m.belts_z[0] - BELT_MM[0] / 2
    yield Length("height of the cup", OUTER, plan, "below", "z", (half, 0.0, z), (half, 0.0, m.foot_z),
                 symmetric(0.2), f"{SCALE_REMEDY}: the skin is thin or thick at the tip")  # fmt: skip
    yield Length("width of the cup", OUTER, plan, "right", "x", (half, 0.0, m.foot_z), (-half, 0.0, m.foot_z))
    yield Length("depth of the half", OUTER, "end", "right", "y", (half, 0.0, z), (half, face, z))
    yield Length("width of the cavity at the rim", INNER, plan, "left", "x", (skin, 0.0, rim), (-skin, 0.0, rim), None,
                 f"{SCALE_REMEDY}: the skin follows from it")  # fmt: skip
    yield Length("depth of the cavity at the rim", STEP, "section", "left", "y", (0.0, 0.0, rim), (0.0, deep, rim))
    yield Length(
        "rim to the first belt", STEP, "front", "above", "z", (0.0, face, z), (0.0, face - way * BELT_MM[1], belt)
    )
    yield Length(
        "depth of the belts", STEP, "front", "right", "y", (0.0, face, z), (0.0, face - way * BELT_MM[1], belt)
    )


def _cup_key_sizes(design: Design, plan: ViewName, gap: float) -> Iterator[Size]:
    kind, remedy = ("socket", "narrow: scrape it") if gap else ("key", "wide: sand it")
    tolerance = shared_clearance(2 * (design.mold.key_clearance_mm - design.printer.offset_mm))
    for key, label in zip(design.cup_layout.keys, ("larger", "smaller"), strict=True):
        yield Circle(f"{label} {kind}, at the parting plane", INNER if gap else OUTER, plan, "y", (key.x, 0.0, key.z),
                     key.root_mm / 2 + gap, tolerance, f"{remedy} until the halves close")  # fmt: skip


def core_drawing(design: Design) -> PartDrawing:
    m, dims, inset = design.cup_layout, design.dimensions, design.mold.core_inset_mm
    tip, half, growth = dims.bone_outline.tip, m.half_width + LEDGE_MM, dims.shrinkage
    assert tip
    apex, ridge = (0.0, 0.0, (tip.z - inset) * growth), RIDGE_HALF_CREST_MM + RIDGE_HEIGHT_MM
    end = m.dorsal_height - RIDGE_END_MM
    sizes = (
        Length("plate to tip", STEP, "front", "above", "z", (0.0, m.dorsal_height, 0.0), apex, symmetric(0.2),
               f"{SCALE_REMEDY}: the skin is thin or thick at the tip"),
        Length("overall length", OUTER, "front", "below", "z", (0.0, -m.palmar_height, -PLATE_MM), apex),
        Length("thickness of the plate", OUTER, "front", "below", "z", (0.0, -m.palmar_height, -PLATE_MM),
               (0.0, -m.palmar_height, 0.0)),
        Length("width of the plate", OUTER, "palmar", "right", "x", (half, -m.palmar_height, 0.0),
               (-half, -m.palmar_height, 0.0)),
        Length("depth of the plate", OUTER, "front", "left", "y", (0.0, -m.palmar_height, -PLATE_MM),
               (0.0, m.dorsal_height, -PLATE_MM)),
        Length("height of the ridges", STEP, "section", "above", "z", (0.0, m.dorsal_height, 0.0),
               (0.0, end, RIDGE_HEIGHT_MM)),
        Length("width of the ridges at the plate", OUTER, "end", "above", "x", (ridge, end, 0.0), (-ridge, end, 0.0),
               located(design, 2 * ridge), "out of tolerance: the core leans, measure it as the sheet says"),
        *platform_size(design, inset, growth),
    )  # fmt: skip
    return PartDrawing("core", "Core", "palmar", ANY_MATERIAL, sizes)
