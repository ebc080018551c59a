"""Mold: a cup of two halves that is filled first, and the core on a plate that is
lowered into it.
"""

from __future__ import annotations

from fingertip.cad.shapes.engraving import MIN_STROKE_MM, STROKE_WIDTH, letter_outlines, text_width
from fingertip.cad.shapes.finger import cavity, core_within_skin
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, offset_section
from fingertip.design.geometry.mold_layout import (
    BELT_MM,
    FOOT_CHAMFER_MM,
    GAP_MM,
    KEY_CLEARANCE_MM,
    KEY_TOP_MM,
    LIP_GAP_MM,
    LIP_WIDTH_MM,
    NOTCH_MM,
    PLATE_LEDGE_MM,
    PLATE_MM,
    PRY_MM,
    RIDGE_END_MM,
    RIDGE_HALF_CREST_MM,
    RIDGE_HEIGHT_MM,
    RIDGE_LENGTH_MM,
    STRAP_Y_MM,
)
from fingertip.design.geometry.outlines import HEIGHT, PAST_MM, belt_seat, engrave_letters, extrude
from fingertip.design.geometry.solids import (
    Axis,
    Box,
    Cone,
    Prism,
    Solid,
    SuperconicSolid,
    difference,
    union,
)

_ROOT_MM = RIDGE_HEIGHT_MM + RIDGE_HALF_CREST_MM
"""Half the width of a ridge at the plate [mm]."""
_INTO_HALF_MM = 0.2
"""Depth of a key's root in its half [mm]."""
_TEXT_SHARE = 0.85
"""Length of a line of text over that of its face."""
LABEL = "PAD"


def block(design: Design) -> Box:
    """Build the outer shape of the closed cup, up to the lip around the cavity."""
    m = design.mold_layout
    return Box(
        (-m.half_width, -m.palmar_height, LIP_GAP_MM), (m.half_width, m.dorsal_height, m.foot_z)
    )


def hollow(design: Design) -> Solid:
    """Build everything that is open in the closed cup but the letters and the keys' clearance."""
    cuts = (
        *grooves(design),
        *notches(design),
        *belts(design),
        strap_seats(design)[0],
        *seam_cuts(design),
    )
    return union(cavity(design), _above_rim(design), *cuts)


def _above_rim(design: Design) -> Solid:
    """Build what the rim lies deeper than the lip around the cavity."""
    m = design.mold_layout
    section = offset_section(design.dimensions.outer.section, LIP_WIDTH_MM)
    far = 2 * (m.half_width + m.dorsal_height)
    lip = SuperconicSolid(ConicBody(section, ((-2 * PAST_MM, 1.0), (PAST_MM, 1.0))))

    return difference(Box((-far, -far, -PAST_MM), (far, far, GAP_MM)), lip)


def seam_cuts(design: Design) -> tuple[Solid, ...]:
    """Build the chamfer of the seam at the foot, and at its corners
    the slots in which a blade parts the halves.
    """
    m = design.mold_layout
    (height, depth, half) = PRY_MM
    far = 2 * m.half_width
    low = m.foot_z - FOOT_CHAMFER_MM
    past = m.foot_z + PAST_MM
    wide = FOOT_CHAMFER_MM + PAST_MM
    face = m.half_width
    slot = (
        (past, face + PAST_MM),
        (past, face - depth),
        (m.foot_z - height + depth, face - depth),
        (m.foot_z - height - PAST_MM, face + PAST_MM),
    )
    chamfer = extrude("x", ((low, 0.0), (past, -wide), (past, wide)), -far, far)
    left_slot, right_slot = (
        extrude("y", [(z, way * x) for z, x in slot], -half, half) for way in (-1.0, 1.0)
    )

    return chamfer, left_slot, right_slot


def grooves(design: Design) -> tuple[Solid, ...]:
    """Build the grooves of the rim, open at the outside.

    Their flanks lie in the planes of the ridges' flanks.
    """
    floor = RIDGE_HEIGHT_MM + GAP_MM
    profile = ((-PAST_MM, _ROOT_MM + PAST_MM), (floor, _ROOT_MM - floor))
    return _along_spokes(design, profile, 0.0, RIDGE_LENGTH_MM + PAST_MM)


def ridges(design: Design) -> tuple[Solid, ...]:
    profile = ((-PAST_MM, _ROOT_MM), (0.0, _ROOT_MM), (RIDGE_HEIGHT_MM, RIDGE_HALF_CREST_MM))
    return _along_spokes(design, profile, RIDGE_END_MM, RIDGE_LENGTH_MM - RIDGE_END_MM)


def _along_spokes(
    design: Design, profile: tuple[tuple[float, float], ...], begin: float, end: float
) -> tuple[Solid, ...]:
    """Extrude an outline, given by heights z and half widths,
    along the spokes at 3, 9 and 12 o'clock.
    """
    ring = [(z, -half) for z, half in profile] + [(z, half) for z, half in reversed(profile)]
    side, dorsal = design.mold_layout.ridge_begins
    return (
        extrude("x", ring, side + begin, side + end),
        extrude("x", ring, -side - end, -side - begin),
        extrude("y", ring, dorsal + begin, dorsal + end),
    )


def notches(design: Design) -> tuple[Solid, ...]:
    """Build the overflow notches: two cuts across the rim, which open in all four
    quarters of it.
    """
    m = design.mold_layout
    half = NOTCH_MM[0] / 2
    far = 2 * (m.palmar_height + m.dorsal_height)
    floor = GAP_MM + NOTCH_MM[1]

    return tuple(
        Box((x - half, -far, GAP_MM - PAST_MM), (x + half, far, floor))
        for x in (-m.notch_x, m.notch_x)
    )


def belts(design: Design) -> tuple[Solid, ...]:
    """Build the seats of the rubber bands around the closed cup,
    with sides at 45 degrees that print upright.
    """
    m = design.mold_layout
    (height, depth) = BELT_MM
    far = 2 * (m.half_width + m.dorsal_height)
    faces: tuple[tuple[Axis, float], ...] = (
        ("y", m.half_width),
        ("y", -m.half_width),
        ("x", m.dorsal_height),
        ("x", -m.palmar_height),
    )

    return tuple(
        belt_seat(
            axis,
            face=face,
            z=z,
            size=(height, depth),
            far=far,
        )
        for z in m.belts_z
        for axis, face in faces
    )


def strap_seats(design: Design) -> tuple[Solid, ...]:
    """Build the seats of the band that holds the core down: across
    the foot, and in both lips of the plate.
    """
    m = design.mold_layout
    (width, depth) = BELT_MM
    low = STRAP_Y_MM - width / 2
    high = STRAP_Y_MM + width / 2
    far = 2 * m.half_width
    lip = m.half_width + PLATE_LEDGE_MM - depth
    foot = Box((-far, low, m.foot_z - depth), (far, high, m.foot_z + PAST_MM))

    return foot, *(
        Box((min(x, y), low, -far), (max(x, y), high, far)) for x, y in ((-far, -lip), (lip, far))
    )


def key_frustums(design: Design, clearance_mm: float = 0.0) -> tuple[Solid, ...]:
    """Build the keys of the dorsal half, enlarged by a clearance [mm] on all sides but the root."""
    inside = _INTO_HALF_MM
    offset = clearance_mm * 2.0**0.5
    found = []

    for key in design.mold_layout.keys:
        top = (KEY_TOP_MM - key.root_mm) / 2 - clearance_mm
        radius = key.root_mm / 2 + offset
        found.append(
            Cone(
                axis="y",
                centre=(key.z, key.x),
                low=top,
                high=inside,
                low_radius=radius + top,
                high_radius=radius + inside,
            )
        )

    return tuple(found)


def key_sockets(design: Design) -> tuple[Solid, ...]:
    return key_frustums(design, KEY_CLEARANCE_MM + max(0.0, design.printer.offset_mm))


def label(design: Design) -> tuple[Prism, ...]:
    """Build the letters that name the palmar half, upright on the standing cup."""
    m = design.mold_layout
    (low, high) = m.belts_z
    (height, depth) = BELT_MM
    free = high - low - height - 2 * depth

    return _engrave(
        design,
        axis="y",
        text=LABEL,
        height=free,
        length=2 * m.half_width,
        centre=(low + high) / 2,
        face=-m.palmar_height,
    )


def plate_letters(design: Design) -> tuple[Prism, ...]:
    """Build the design's name in the top of the plate, and over the
    label of the pad's half the same on its edge.
    """
    m = design.mold_layout
    depth = m.dorsal_height + m.palmar_height
    length = 2 * (m.half_width + PLATE_LEDGE_MM)

    return (
        *_engrave(
            design,
            axis="z",
            text=design.name,
            height=depth,
            length=length,
            centre=(m.dorsal_height - m.palmar_height) / 2,
            face=-PLATE_MM,
        ),
        *_engrave(
            design,
            axis="y",
            text=LABEL,
            height=PLATE_MM,
            length=length,
            centre=-PLATE_MM / 2,
            face=-m.palmar_height,
        ),
    )


def _engrave(
    design: Design,
    axis: Axis,
    text: str,
    height: float,
    length: float,
    centre: float,
    face: float,
) -> tuple[Prism, ...]:
    """Build letters in the face at a negative y or z, around x =
    0; none where they are too small to read.
    """
    unit = min(
        design.mold.engraving_height_mm / HEIGHT,
        _TEXT_SHARE * height / (HEIGHT + STROKE_WIDTH),
        _TEXT_SHARE * length / text_width(text),
    )
    if not design.mold.engraving_depth_mm or STROKE_WIDTH * unit < MIN_STROKE_MM:
        return ()

    low = face - PAST_MM
    high = face + design.mold.engraving_depth_mm
    up = 1.0 if axis == "z" else -1.0  # on the plate y is up, on the standing cup -z
    at = text_width(text) / 2, centre, unit, up * unit

    return engrave_letters(
        axis,
        letters=letter_outlines(text, STROKE_WIDTH),
        at=at,
        low=low,
        high=high,
    )


def mold_palmar(design: Design) -> Solid:
    whole = block(design)
    half = Box(whole.low, (whole.high[0], 0.0, whole.high[2]))
    return difference(half, hollow(design), *key_sockets(design), *label(design))


def mold_dorsal(design: Design) -> Solid:
    whole = block(design)
    half = Box((whole.low[0], 0.0, whole.low[2]), whole.high)
    return difference(union(half, *key_frustums(design)), hollow(design))


def core(design: Design) -> Solid:
    """Build the core on its plate, whose lips stand out at both sides to lift it by."""
    m = design.mold_layout
    half = m.half_width + PLATE_LEDGE_MM
    plate = Box((-half, -m.palmar_height, -PLATE_MM), (half, m.dorsal_height, 0.0))
    whole = union(core_within_skin(design), plate, *ridges(design))

    return difference(whole, *plate_letters(design), *strap_seats(design)[1:])
