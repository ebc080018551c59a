"""Sizes of the printed parts on their sheets."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple

from fingertip.design import Design
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
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.interface import bolt_clearance
from fingertip.design.interfaces.post_and_socket import Post
from fingertip.models import encapsulation, holder
from fingertip.models import mold_layout as mold
from fingertip.models.hand_stub import bars, guide, stub_bore_radius
from fingertip.models.joint import joint_of
from fingertip.models.solids import Point3
from fingertip.models.stand import post_gap_mm, stand_outline

ANY_MATERIAL = "any print material that the silicone tolerates"


def bone_drawing(design: Design) -> PartDrawing:
    tip = design.dimensions.bone_outline.tip
    interface = interface_of(design)
    assert tip
    low = (0.0, 0.0, interface.low_z(design))
    sizes = [
        Length(
            name="overall length",
            growth=OUTER,
            view="front",
            side="below",
            axis="z",
            start=low,
            end=(0.0, 0.0, tip.z),
        ),
        *_base_sizes(design),
        *_pocket_sizes(design),
        *interface.sizes(design),
    ]
    material = design.strength.material.label

    return PartDrawing(
        part="bone",
        title="Bone",
        plan="palmar",
        material=material,
        sizes=tuple(sizes),
        notes=interface.notes(design),
    )


def _post_hole(design: Design, name: str, end_z: float) -> Circle:
    """Size what takes the post of a bone, and opens at a height z [mm]."""
    gap = post_gap_mm(design)
    return Circle(
        name=name,
        growth=INNER,
        view="end",
        axis="z",
        centre=(0.0, design.dimensions.base_middle_y, end_z),
        radius=design.bone.post_width_mm / 2 + gap,
        tolerance=clearance(gap - design.printer.offset_mm),
        action="narrow: file it until the post slides in",
    )


def _cross_bolt_hole(design: Design, side_x: float, bolt_z: float) -> Circle:
    """Size the hole of the cross bolt beside the post, in a face at x [mm]."""
    hole = design.bone.cross_bolt_diameter_mm
    return Circle(
        name="hole of the cross bolt",
        growth=INNER,
        view="front",
        axis="x",
        centre=(side_x, design.dimensions.base_middle_y, bolt_z),
        radius=hole / 2,
        tolerance=bolt_clearance(design, hole),
        action="narrow: drill it to size",
    )


def stand_drawing(design: Design) -> PartDrawing:
    (_, _, low), (side, _, high) = astuple(stand_outline(design))
    y = design.dimensions.base_middle_y
    bolt_z = Post().cross_bolt_z(design)
    sizes = (
        Length(
            name="overall length",
            growth=OUTER,
            view="front",
            side="below",
            axis="z",
            start=(0.0, y, low),
            end=(0.0, y, high),
        ),
        _post_hole(design, "socket of the post", high),
        _cross_bolt_hole(design, side, bolt_z),
        Length(
            name="axis of the cross bolt",
            growth=BEHIND_FACE,
            view="front",
            side="above",
            axis="z",
            start=(side, y, high),
            end=(side, y, bolt_z),
        ),
    )

    return PartDrawing(
        part="stand",
        title="Stand",
        plan="palmar",
        material=ANY_MATERIAL,
        sizes=sizes,
    )


def pin_drawing(design: Design) -> PartDrawing:
    radius = joint_of(design).printed_pin_radius
    length = design.dimensions.pin_length
    sizes = (
        Length(
            name="length of the pin",
            growth=OUTER,
            view="front",
            side="below",
            axis="z",
            start=(0.0, 0.0, 0.0),
            end=(0.0, 0.0, length),
        ),
        Circle(
            name="diameter of the pin",
            growth=OUTER,
            view="end",
            axis="z",
            centre=(0.0, 0.0, length),
            radius=radius,
            tolerance=symmetric(MIN_TOLERANCE_MM),
            action="thick: sand it until it slides; thin: it falls out, print again",
        ),
    )
    return PartDrawing(
        part="pin",
        title="Pin of the joint",
        plan="palmar",
        material=design.strength.material.label,
        sizes=sizes,
    )


def hand_stub_drawing(design: Design) -> PartDrawing:
    joint = joint_of(design)
    shoulder, bar = bars(design)
    tendon_guide = guide(design)
    side, _, root = shoulder.high
    y = joint.axis_y
    half = design.hand.width_mm / 2
    name = "width of the tongue"
    growth = OUTER
    remedy = "wide: sand it until the bone turns"

    if not joint.is_fork:
        name = "gap of the fork"
        growth = INNER
        remedy = "narrow: file it until the bone turns"

    pin: Point3 = (half if joint.is_fork else side, y, joint.axis_z)
    sizes: list[Size] = [
        Length(
            name="shoulder to the joint axis",
            growth=BEFORE_FACE,
            view="front",
            side="above",
            axis="z",
            start=(side, y, root),
            end=pin,
        ),
        Circle(
            name="bore of the joint's pin",
            growth=FINISHED,
            view="front",
            axis="x",
            centre=pin,
            radius=stub_bore_radius(joint),
            tolerance=bore(design),
            action="narrow: ream it to the pin; wide: take a thicker pin",
        ),
        Length(
            name=name,
            growth=growth,
            view="palmar",
            side="right",
            axis="x",
            start=(-half, y, joint.axis_z),
            end=(half, y, joint.axis_z),
            tolerance=shared_clearance(2 * (joint.clearance - design.printer.offset_mm)),
            action=remedy,
        ),
    ]
    if tendon_guide:
        mouth = tendon_guide.x[0], tendon_guide.y, tendon_guide.mouth_z
        sizes += [
            Length(
                name="tendon to the joint axis",
                growth=STEP,
                view="front",
                side="right",
                axis="y",
                start=mouth,
                end=pin,
                is_reference=True,
            ),
            Length(
                name="width of the tendon's slot",
                growth=INNER,
                view="palmar",
                side="left",
                axis="x",
                start=(mouth[0] - tendon_guide.radius, tendon_guide.y, bar.low[2]),
                end=(mouth[0] + tendon_guide.radius, tendon_guide.y, bar.low[2]),
            ),
        ]

    return PartDrawing(
        part="hand_stub",
        title="Stub of the hand",
        plan="palmar",
        material=ANY_MATERIAL,
        sizes=tuple(sizes),
    )


def _base_sizes(design: Design) -> Iterator[Size]:
    dims = design.dimensions
    collar = design.dimensions.collar.section
    section = design.dimensions.bone_outline.section
    base = -dims.full_base_length
    foot = -design.bone.collar_length_mm
    yield Length(
        name="width of the base",
        growth=OUTER,
        view="palmar",
        side="left",
        axis="x",
        start=(section.half_width, 0.0, base),
        end=(-section.half_width, 0.0, base),
    )
    yield Length(
        name="width of the collar",
        growth=OUTER,
        view="palmar",
        side="right",
        axis="x",
        start=(collar.half_width, 0.0, 0.0),
        end=(-collar.half_width, 0.0, 0.0),
    )
    yield Length(
        name="length of the collar",
        growth=OUTER,
        view="front",
        side="above",
        axis="z",
        start=(0.0, 0.0, foot),
        end=(0.0, 0.0, 0.0),
    )
    yield Length(
        name="height of the base",
        growth=OUTER,
        view="end",
        side="right",
        axis="y",
        start=(0.0, -dims.base_flat_depth, base),
        end=(0.0, section.dorsal, base),
    )


def _pocket_sizes(design: Design) -> Iterator[Size]:
    dims = design.dimensions
    gap = design.sensor.clearance_mm
    flat = -dims.platform_depth
    half = dims.tail_half_width
    floor = flat + dims.pocket_depth
    z = dims.sensor_z
    head = dims.sensor.head_diameter_mm / 2 + gap
    begin = dims.tail_end_z
    play = clearance(2 * gap - design.printer.offset_mm)
    # The slot meets the pocket in this angle.
    opening = math.degrees(math.asin(min(1.0, half / head))) + ARROW_DEG
    yield Length(
        name="centre of the sensor",
        growth=BEFORE_FACE,
        view="palmar",
        side="above",
        axis="z",
        start=(-dims.collar.section.half_width, 0.0, 0.0),
        end=(0.0, flat, z),
    )
    yield Circle(
        name="pocket of the sensor",
        growth=INNER,
        view="palmar",
        axis="y",
        centre=(0.0, floor, z),
        radius=head,
        tolerance=play,
        action="small: file the wall until the sensor lies flat; large: centre the sensor by eye",
        hidden_deg=((180.0 - opening, 180.0 + opening),),
    )
    yield Length(
        name="width of the slot",
        growth=INNER,
        view="palmar",
        side="left",
        axis="x",
        start=(half, -dims.flat_depth, begin),
        end=(-half, -dims.flat_depth, begin),
        tolerance=play,
        action="narrow: file it until the tail lies flat",
    )

    if design.bone.platform_mm:
        yield Length(
            name="depth of the slot",
            growth=STEP,
            view="section",
            side="left",
            axis="y",
            start=(0.0, -dims.flat_depth, begin),
            end=(0.0, -dims.flat_depth + dims.pocket_depth, begin),
            tolerance=located(design, dims.pocket_depth),
            action="shallow: scrape the floor until the tail is flush; deep: lay a second film "
            "under it",
        )

    seat = "platform" if design.bone.platform_mm else "palmar flat"
    yield Length(
        name=f"depth of the {seat}",
        growth=STEP,
        view="section",
        side="right",
        axis="y",
        start=(0.0, 0.0, z),
        end=(0.0, flat, z + head),
        is_reference=True,
    )
    yield from platform_size(design)
    yield Length(
        name="depth of the pocket",
        growth=STEP,
        view="section",
        side="right",
        axis="y",
        start=(0.0, flat, z + head),
        end=(0.0, floor, z + head),
        tolerance=located(design, dims.pocket_depth),
        action="shallow: scrape the floor until the sensor is flush; deep: lay a second film "
        "under it",
    )


def platform_size(design: Design, inset: float = 0.0, scale: float = 1.0) -> Iterator[Size]:
    """Size the platform above the flat that lies distal to it."""
    dims = design.dimensions
    if design.bone.platform_mm:
        end = (dims.sensor_z + dims.platform_radius - inset) * scale
        flat, top = (-(depth - inset) * scale for depth in (dims.flat_depth, dims.platform_depth))
        yield Length(
            name="height of the platform",
            growth=STEP,
            view="section",
            side="right",
            axis="y",
            start=(0.0, flat, end),
            end=(0.0, top, end),
            tolerance=located(design, flat - top),
            action="high: the skin over the sensor is thin; low: it is thick; print again",
        )


def palmar_drawing(design: Design) -> PartDrawing:
    gap = 2.0**0.5 * (mold.KEY_CLEARANCE_MM + max(0.0, design.printer.offset_mm))
    sizes = (
        *_half_sizes(design, "dorsal", -1.0),
        *_key_sizes(design, "dorsal", gap),
        *_crown_size(design),
    )
    return PartDrawing(
        part="mold_palmar",
        title="Cup, half of the pad",
        plan="dorsal",
        material=ANY_MATERIAL,
        sizes=sizes,
    )


def dorsal_drawing(design: Design) -> PartDrawing:
    half = mold.RIDGE_HALF_CREST_MM + mold.RIDGE_HEIGHT_MM - mold.GAP_MM
    high = design.mold_layout.dorsal_height
    groove = Length(
        name="width of the groove at the rim",
        growth=INNER,
        view="end",
        side="above",
        axis="x",
        start=(half, high, mold.GAP_MM),
        end=(-half, high, mold.GAP_MM),
        tolerance=located(design, 2 * half),
        action="out of tolerance: the core leans, measure it as the sheet says",
    )
    sizes = (*_half_sizes(design, "palmar", 1.0), *_key_sizes(design, "palmar", 0.0), groove)

    return PartDrawing(
        part="mold_dorsal",
        title="Cup, dorsal half",
        plan="palmar",
        material=ANY_MATERIAL,
        sizes=sizes,
    )


def _half_sizes(design: Design, plan: ViewName, sign: float) -> Iterator[Size]:
    layout = design.mold_layout
    dims = design.dimensions
    outer = dims.outer
    growth = dims.shrinkage
    half = layout.half_width
    z = mold.GAP_MM
    face = layout.dorsal_height if sign > 0.0 else -layout.palmar_height
    rim = mold.LIP_GAP_MM
    unshrunk_rim = rim / growth
    skin = outer.half_width_at(0.0, unshrunk_rim) * growth
    height_at = outer.dorsal_height_at if sign > 0.0 else outer.palmar_height_at
    depth = sign * height_at(0.0, unshrunk_rim) * growth
    belt = layout.belts_z[0] - mold.BELT_MM[0] / 2
    yield Length(
        name="height of the cup",
        growth=OUTER,
        view=plan,
        side="below",
        axis="z",
        start=(half, 0.0, z),
        end=(half, 0.0, layout.foot_z),
        tolerance=symmetric(0.2),
        action=f"{SCALE_REMEDY}: the skin is thin or thick at the tip",
    )
    yield Length(
        name="width of the cup",
        growth=OUTER,
        view=plan,
        side="right",
        axis="x",
        start=(half, 0.0, layout.foot_z),
        end=(-half, 0.0, layout.foot_z),
    )
    yield Length(
        name="depth of the half",
        growth=OUTER,
        view="end",
        side="right",
        axis="y",
        start=(half, 0.0, z),
        end=(half, face, z),
    )
    yield Length(
        name="width of the cavity at the rim",
        growth=INNER,
        view=plan,
        side="left",
        axis="x",
        start=(skin, 0.0, rim),
        end=(-skin, 0.0, rim),
        tolerance=None,
        action=f"{SCALE_REMEDY}: the skin follows from it",
    )
    yield Length(
        name="depth of the cavity at the rim",
        growth=STEP,
        view="section",
        side="left",
        axis="y",
        start=(0.0, 0.0, rim),
        end=(0.0, depth, rim),
    )
    yield Length(
        name="rim to the first belt",
        growth=STEP,
        view="front",
        side="above",
        axis="z",
        start=(0.0, face, z),
        end=(0.0, face - sign * mold.BELT_MM[1], belt),
    )
    yield Length(
        name="depth of the belts",
        growth=STEP,
        view="front",
        side="right",
        axis="y",
        start=(0.0, face, z),
        end=(0.0, face - sign * mold.BELT_MM[1], belt),
    )


def _key_sizes(design: Design, plan: ViewName, gap: float) -> Iterator[Size]:
    kind, remedy = ("socket", "narrow: scrape it") if gap else ("key", "wide: sand it")
    tolerance = shared_clearance(2 * mold.KEY_CLEARANCE_MM)
    for key, label in zip(design.mold_layout.keys, ("larger", "smaller"), strict=True):
        yield Circle(
            name=f"{label} {kind}, at the parting plane",
            growth=INNER if gap else OUTER,
            view=plan,
            axis="y",
            centre=(key.x, 0.0, key.z),
            radius=key.root_mm / 2 + gap,
            tolerance=tolerance,
            action=f"{remedy} until the halves close",
        )


def _plate_sizes(design: Design) -> Iterator[Size]:
    """Size the plate with its ridges, of a core or a holder."""
    layout = design.mold_layout
    half = layout.half_width + mold.PLATE_LEDGE_MM
    ridge = mold.RIDGE_HALF_CREST_MM + mold.RIDGE_HEIGHT_MM
    end = layout.dorsal_height - mold.RIDGE_END_MM
    yield Length(
        name="thickness of the plate",
        growth=OUTER,
        view="front",
        side="below",
        axis="z",
        start=(0.0, -layout.palmar_height, -mold.PLATE_MM),
        end=(0.0, -layout.palmar_height, 0.0),
    )
    yield Length(
        name="width of the plate",
        growth=OUTER,
        view="palmar",
        side="right",
        axis="x",
        start=(half, -layout.palmar_height, 0.0),
        end=(-half, -layout.palmar_height, 0.0),
    )
    yield Length(
        name="depth of the plate",
        growth=OUTER,
        view="front",
        side="left",
        axis="y",
        start=(0.0, -layout.palmar_height, -mold.PLATE_MM),
        end=(0.0, layout.dorsal_height, -mold.PLATE_MM),
    )
    yield Length(
        name="height of the ridges",
        growth=STEP,
        view="section",
        side="above",
        axis="z",
        start=(0.0, layout.dorsal_height, 0.0),
        end=(0.0, end, mold.RIDGE_HEIGHT_MM),
    )
    yield Length(
        name="width of the ridges at the plate",
        growth=OUTER,
        view="end",
        side="above",
        axis="x",
        start=(ridge, end, 0.0),
        end=(-ridge, end, 0.0),
        tolerance=located(design, 2 * ridge),
        action="out of tolerance: the core leans, measure it as the sheet says",
    )


def core_drawing(design: Design) -> PartDrawing:
    layout = design.mold_layout
    dims = design.dimensions
    inset = design.mold.core_inset_mm
    tip = dims.bone_outline.tip
    growth = dims.shrinkage
    assert tip
    apex = (0.0, 0.0, (tip.z - inset) * growth)
    sizes = (
        Length(
            name="plate to tip",
            growth=STEP,
            view="front",
            side="above",
            axis="z",
            start=(0.0, layout.dorsal_height, 0.0),
            end=apex,
            tolerance=symmetric(0.2),
            action=f"{SCALE_REMEDY}: the skin is thin or thick at the tip",
        ),
        Length(
            name="overall length",
            growth=OUTER,
            view="front",
            side="below",
            axis="z",
            start=(0.0, -layout.palmar_height, -mold.PLATE_MM),
            end=apex,
        ),
        *_plate_sizes(design),
        *platform_size(design, inset, growth),
    )

    return PartDrawing(
        part="core",
        title="Core",
        plan="palmar",
        material=ANY_MATERIAL,
        sizes=sizes,
    )


def holder_drawing(design: Design) -> PartDrawing:
    bone = design.bone
    layout = design.mold_layout
    top = holder.top_z(design)
    bolt_z = Post().cross_bolt_z(design) - holder.DRAW_MM
    sizes = (
        Length(
            name="overall height",
            growth=OUTER,
            view="front",
            side="below",
            axis="z",
            start=(0.0, -layout.palmar_height, top),
            end=(0.0, layout.dorsal_height - mold.RIDGE_END_MM, mold.RIDGE_HEIGHT_MM),
        ),
        *_plate_sizes(design),
        _post_hole(design, "hole of the post", top),
        _cross_bolt_hole(design, bone.post_width_mm / 2, bolt_z),
    )

    return PartDrawing(
        part="holder",
        title="Holder of the bone",
        plan="palmar",
        material=ANY_MATERIAL,
        sizes=sizes,
    )


def plug_drawing(design: Design) -> PartDrawing:
    dims = design.dimensions
    half = dims.tail_half_width - encapsulation.PLUG_GAP_MM
    begin = encapsulation.plug_begin_z(design)
    end = encapsulation.roof_end_z(design)
    surface = -dims.flat_depth
    sizes = (
        Length(
            name="overall length",
            growth=OUTER,
            view="front",
            side="below",
            axis="z",
            start=(0.0, surface, begin),
            end=(0.0, surface, end),
        ),
        Length(
            name="width in the collar",
            growth=OUTER,
            view="palmar",
            side="left",
            axis="x",
            start=(half, surface, begin),
            end=(-half, surface, begin),
            tolerance=shared_clearance(2 * encapsulation.PLUG_GAP_MM),
            action="wide: sand it until it drops into the notch",
        ),
    )

    return PartDrawing(
        part="plug",
        title="Plug over the tail",
        plan="palmar",
        material=ANY_MATERIAL,
        sizes=sizes,
    )


def _crown_size(design: Design) -> Iterator[Size]:
    """Size the cavity at the apex of the crown, where it is deepest."""
    dims = design.dimensions
    growth = design.dimensions.shrinkage

    if dims.crown:
        z = dims.crown.z * growth
        yield Length(
            name="depth of the cavity at the crown's apex",
            growth=STEP,
            view="section",
            side="right",
            axis="y",
            start=(0.0, 0.0, z),
            end=(0.0, -dims.outer.section.palmar * growth, z),
            tolerance=None,
            action="shallow or deep: the skin over the sensor is thin or thick, print again",
        )
