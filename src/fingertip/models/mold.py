"""Mold: a cup of two halves that is filled first."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .allowances import PAST_MM
from .conic import ConicBody, offset_section
from .engraving import engrave
from .mold_layout import (
    BELT_MM,
    FOOT_CHAMFER_MM,
    GAP_MM,
    KEY_CLEARANCE_MM,
    KEY_TOP_MM,
    LIP_GAP_MM,
    LIP_WIDTH_MM,
    NOTCH_MM,
    PLATE_LEDGE_MM,
    PRY_MM,
    RIDGE_HALF_CREST_MM,
    RIDGE_HEIGHT_MM,
    RIDGE_LENGTH_MM,
    STRAP_Y_MM,
)
from .outline import skin_outline
from .solids import Axis, Box, Cone, Prism, Solid, SuperconicSolid, extrude

if TYPE_CHECKING:
    from .program_types import Finger

ROOT_MM = RIDGE_HEIGHT_MM + RIDGE_HALF_CREST_MM
"""Half the width of a ridge at the plate [mm]."""
_INTO_HALF_MM = 0.2
"""Depth of a key's root in its half [mm]."""
LABEL = "PAD"
"""Name of the palmar half."""


def block(finger: Finger) -> Box:
    """Build the outer shape of the closed cup, up to the lip around the cavity."""
    m = finger.mold_layout
    return Box(
        (-m.half_width, -m.palmar_height, LIP_GAP_MM), (m.half_width, m.dorsal_height, m.foot_z)
    )


def hollow(finger: Finger) -> Solid:
    """Build everything that is open in the closed cup but the letters and the keys' clearance."""
    cuts = (
        *grooves(finger),
        *notches(finger),
        *belts(finger),
        strap_seats(finger)[0],
        *seam_cuts(finger),
    )
    return cavity(finger).union(_above_rim(finger), *cuts)


def cavity(finger: Finger, inset_mm: float = 0.0) -> Solid:
    """Build the cavity of the mold: the outer surface, enlarged to allow for the silicone's
    shrinkage.
    """
    return skin_outline(finger, inset_mm).scaled(finger.dimensions.shrinkage)


def _above_rim(finger: Finger) -> Solid:
    """Build what the rim lies deeper than the lip around the cavity."""
    m = finger.mold_layout
    section = offset_section(finger.dimensions.outer.section, LIP_WIDTH_MM)
    far = 2 * (m.half_width + m.dorsal_height)
    lip = SuperconicSolid(ConicBody(section, ((-2 * PAST_MM, 1.0), (PAST_MM, 1.0))))

    return Box((-far, -far, -PAST_MM), (far, far, GAP_MM)).cut(lip)


def seam_cuts(finger: Finger) -> tuple[Solid, ...]:
    """Build the chamfer of the seam at the foot, and at its corners the slots in which a blade
    parts the halves.
    """
    m = finger.mold_layout
    height, depth, half = PRY_MM
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


def grooves(finger: Finger) -> tuple[Solid, ...]:
    """Build the grooves of the rim, open at the outside.

    Their flanks lie in the planes of the ridges' flanks.
    """
    floor = RIDGE_HEIGHT_MM + GAP_MM
    profile = ((-PAST_MM, ROOT_MM + PAST_MM), (floor, ROOT_MM - floor))
    return along_spokes(finger, profile, 0.0, RIDGE_LENGTH_MM + PAST_MM)


def along_spokes(
    finger: Finger, profile: tuple[tuple[float, float], ...], begin: float, end: float
) -> tuple[Solid, ...]:
    """Extrude an outline, given by heights z and half widths, along the spokes at 3, 9 and 12
    o'clock.
    """
    ring = [(z, -half) for z, half in profile] + [(z, half) for z, half in reversed(profile)]
    side, dorsal = finger.mold_layout.ridge_begins
    return (
        extrude("x", ring, side + begin, side + end),
        extrude("x", ring, -side - end, -side - begin),
        extrude("y", ring, dorsal + begin, dorsal + end),
    )


def notches(finger: Finger) -> tuple[Solid, ...]:
    """Build the overflow notches: two cuts across the rim, which open in all its quarters."""
    m = finger.mold_layout
    half = NOTCH_MM[0] / 2
    far = 2 * (m.palmar_height + m.dorsal_height)
    floor = GAP_MM + NOTCH_MM[1]

    return tuple(
        Box((x - half, -far, GAP_MM - PAST_MM), (x + half, far, floor))
        for x in (-m.notch_x, m.notch_x)
    )


def belts(finger: Finger) -> tuple[Solid, ...]:
    """Build the seats of the rubber bands around the closed cup, with sides at 45 degrees that
    print upright.
    """
    m = finger.mold_layout
    far = 2 * (m.half_width + m.dorsal_height)
    faces: tuple[tuple[Axis, float], ...] = (
        ("y", m.half_width),
        ("y", -m.half_width),
        ("x", m.dorsal_height),
        ("x", -m.palmar_height),
    )

    return tuple(_belt_seat(axis, face, z, far) for z in m.belts_z for axis, face in faces)


def _belt_seat(axis: Axis, face: float, z: float, far: float) -> Prism:
    """Build the seat of a band in a face of the cup, at a height z."""
    height, depth = BELT_MM
    inner = face - math.copysign(depth, face)
    outer = face + math.copysign(PAST_MM, face)
    floor = height / 2
    opening = height / 2 + depth + PAST_MM
    profile = (
        (z - opening, outer),
        (z - floor, inner),
        (z + floor, inner),
        (z + opening, outer),
    )

    return extrude(axis, profile, -far, far)


def strap_seats(finger: Finger) -> tuple[Solid, ...]:
    """Build the seats of the band that holds the core down: across the foot, and in both lips of
    the plate.
    """
    m = finger.mold_layout
    width, depth = BELT_MM
    low = STRAP_Y_MM - width / 2
    high = STRAP_Y_MM + width / 2
    far = 2 * m.half_width
    lip = m.half_width + PLATE_LEDGE_MM - depth
    foot = Box((-far, low, m.foot_z - depth), (far, high, m.foot_z + PAST_MM))

    return foot, *(
        Box((min(x, y), low, -far), (max(x, y), high, far)) for x, y in ((-far, -lip), (lip, far))
    )


def key_frustums(finger: Finger, clearance_mm: float = 0.0) -> tuple[Solid, ...]:
    """Build the keys of the dorsal half, enlarged by a clearance [mm] on all sides but the root."""
    inside = _INTO_HALF_MM
    offset = clearance_mm * 2.0**0.5
    found = []

    for key in finger.mold_layout.keys:
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


def key_sockets(finger: Finger) -> tuple[Solid, ...]:
    return key_frustums(finger, KEY_CLEARANCE_MM + max(0.0, finger.printer.offset_mm))


def label(finger: Finger) -> tuple[Prism, ...]:
    """Build the letters that name the palmar half, upright on the standing cup."""
    m = finger.mold_layout
    low, high = m.belts_z
    height, depth = BELT_MM
    free = high - low - height - 2 * depth

    return engrave(
        finger,
        axis="y",
        text=LABEL,
        height=free,
        length=2 * m.half_width,
        centre=(low + high) / 2,
        face=-m.palmar_height,
    )


def mold_palmar(finger: Finger) -> Solid:
    r"""Build the half of the cup below the pad, with the sockets of the keys and its label.

    The closed cup, section at x = 0, tip down:

          -palmar_height          y = 0           dorsal_height
               |                    :                   |
               |_______ lip _       :      _ lip __   __|       LIP_GAP_MM below the plate
                             |      :     |        \ /          groove of a ridge
               ]             |      :     |                [    belt
               |             |   cavity   |             |
               ]              \     :    /                 [    belt
               |               '._  : _.'               |
               |___________________':'__________________|       foot_z, mold.wall_mm below the tip
                                  seam
    """
    whole = block(finger)
    half = Box(whole.low, (whole.high[0], 0.0, whole.high[2]))
    return half.cut(hollow(finger), *key_sockets(finger)).cut(*label(finger))


def mold_dorsal(finger: Finger) -> Solid:
    r"""Build the half of the cup above the back, with the keys.

    Seen from the seam, tip down; the keys of both sides differ in size and height:

             _______________          _______________
            |               |        |               |
            |               |        |           (o) |   keys of unequal sizes
            | (O)           | cavity |               |
            |                \      /                |
            |                 '.__.'                 |
            |________________________________________|   foot_z
            |<------------ 2 half_width ------------>|
    """
    whole = block(finger)
    half = Box((whole.low[0], 0.0, whole.low[2]), whole.high)
    return half.union(*key_frustums(finger)).cut(hollow(finger))
