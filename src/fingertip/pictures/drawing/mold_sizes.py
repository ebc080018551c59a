"""Sizes of the halves of the cup and of its core on their sheets."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.design import Design
from fingertip.design.geometry.mold_layout import (
    BELT_MM,
    GAP_MM,
    KEY_CLEARANCE_MM,
    LEDGE_MM,
    LIP_GAP_MM,
    PLATE_MM,
    RIDGE_END_MM,
    RIDGE_HALF_CREST_MM,
    RIDGE_HEIGHT_MM,
)
from fingertip.design.geometry.sizes import (
    INNER,
    OUTER,
    SCALE_REMEDY,
    STEP,
    Circle,
    Length,
    PartDrawing,
    Size,
    ViewName,
    located,
    shared_clearance,
    symmetric,
)
from fingertip.pictures.drawing.part_sizes import ANY_MATERIAL, platform_size


def palmar_drawing(design: Design) -> PartDrawing:
    gap = 2.0**0.5 * (KEY_CLEARANCE_MM + max(0.0, design.printer.offset_mm))
    sizes = (*_half_sizes(design, "dorsal", -1.0), *_key_sizes(design, "dorsal", gap), *_crown_size(design))
    return PartDrawing("mold_palmar", "Cup, half of the pad", "dorsal", ANY_MATERIAL, sizes)


def dorsal_drawing(design: Design) -> PartDrawing:
    half, high = RIDGE_HALF_CREST_MM + RIDGE_HEIGHT_MM - GAP_MM, design.mold_layout.dorsal_height
    groove = Length("width of the groove at the rim", INNER, "end", "above", "x", (half, high, GAP_MM),
                    (-half, high, GAP_MM), located(design, 2 * half),
                    "out of tolerance: the core leans, measure it as the sheet says")  # fmt: skip
    sizes = (*_half_sizes(design, "palmar", 1.0), *_key_sizes(design, "palmar", 0.0), groove)
    return PartDrawing("mold_dorsal", "Cup, dorsal half", "palmar", ANY_MATERIAL, sizes)


def _half_sizes(design: Design, plan: ViewName, way: float) -> Iterator[Size]:
    m, dims = design.mold_layout, design.dimensions
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


def _key_sizes(design: Design, plan: ViewName, gap: float) -> Iterator[Size]:
    kind, remedy = ("socket", "narrow: scrape it") if gap else ("key", "wide: sand it")
    tolerance = shared_clearance(2 * KEY_CLEARANCE_MM)
    for key, label in zip(design.mold_layout.keys, ("larger", "smaller"), strict=True):
        yield Circle(f"{label} {kind}, at the parting plane", INNER if gap else OUTER, plan, "y", (key.x, 0.0, key.z),
                     key.root_mm / 2 + gap, tolerance, f"{remedy} until the halves close")  # fmt: skip


def core_drawing(design: Design) -> PartDrawing:
    m, dims, inset = design.mold_layout, design.dimensions, design.mold.core_inset_mm
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


def _crown_size(design: Design) -> Iterator[Size]:
    """Size the cavity at the apex of the crown, where it is deepest."""
    dims, growth = design.dimensions, design.dimensions.shrinkage
    if dims.crown:
        z = dims.crown.z * growth
        yield Length("depth of the cavity at the crown's apex", STEP, "section", "right", "y", (0.0, 0.0, z),
                     (0.0, -dims.outer.section.palmar * growth, z), None,
                     "shallow or deep: the skin over the sensor is thin or thick, print again")  # fmt: skip
