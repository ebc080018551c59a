"""Core on a plate that is lowered into the filled cup. It leaves the interior of the skin."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .allowances import PAST_MM
from .bone import cut_flat, filled_bone, platform
from .conic import add_groove, inset_body
from .engraving import engrave
from .mold import LABEL, ROOT_MM, along_spokes, strap_seats
from .mold_layout import (
    PLATE_LEDGE_MM,
    PLATE_MM,
    RIDGE_END_MM,
    RIDGE_HALF_CREST_MM,
    RIDGE_HEIGHT_MM,
    RIDGE_LENGTH_MM,
)
from .solids import Box, Cone, Prism, Solid

if TYPE_CHECKING:
    from .program_types import Finger

_INTO_COLLAR_MM = 0.2
"""Depth to which the body of a core reaches into its plate [mm]: solids that only touch have
coincident faces.
"""
_INTO_HOLLOW_MM = 0.3
"""Length by which holes reach past the faces in which they open [mm].
Faces in one plane would leave slivers.
"""


def core(finger: Finger) -> Solid:
    r"""Build the core on its plate, whose lips stand out at both sides to lift it by.

    Section across the finger, as it hangs in the cup, tip down:

           _________________________________________
          |                                         |   plate, PLATE_MM thick
          |_______   _____           _____   _______|   z = 0
                   V      |         |      V            ridges, RIDGE_HEIGHT_MM high
          |<->|           |         |
        PLATE_LEDGE_MM    |         |                   core_within_skin,
                           \       /                    enlarged by the shrinkage
                            '.___.'
    """
    whole = core_within_skin(finger).union(plate(finger), *ridges(finger))
    return whole.cut(*strap_seats(finger)[1:]).cut(*plate_letters(finger))


def top_z(finger: Finger) -> float:
    """Height of the top of the plate."""
    return -PLATE_MM


def top_y(finger: Finger) -> tuple[float, float]:
    """Find the palmar and the dorsal edge of the plate."""
    return -finger.mold_layout.palmar_height, finger.mold_layout.dorsal_height


def plate(finger: Finger) -> Box:
    m = finger.mold_layout
    half = m.half_width + PLATE_LEDGE_MM
    return Box((-half, -m.palmar_height, -PLATE_MM), (half, m.dorsal_height, 0.0))


def plate_letters(finger: Finger) -> tuple[Prism, ...]:
    """Build the design's name in the top of the plate, and over the label of the pad's half the
    same on its edge.
    """
    m = finger.mold_layout
    depth = m.dorsal_height + m.palmar_height
    length = 2 * (m.half_width + PLATE_LEDGE_MM)
    name = engrave(
        finger,
        axis="z",
        text=finger.name,
        height=depth,
        length=length,
        centre=(m.dorsal_height - m.palmar_height) / 2,
        face=-PLATE_MM,
    )

    return (*name, *plate_label(finger))


def plate_label(finger: Finger) -> tuple[Prism, ...]:
    """Build the label of the pad's half in the edge of the plate above it."""
    m = finger.mold_layout
    return engrave(
        finger,
        axis="y",
        text=LABEL,
        height=PLATE_MM,
        length=2 * (m.half_width + PLATE_LEDGE_MM),
        centre=-PLATE_MM / 2,
        face=-m.palmar_height,
    )


def ridges(finger: Finger) -> tuple[Solid, ...]:
    profile = ((-PAST_MM, ROOT_MM), (0.0, ROOT_MM), (RIDGE_HEIGHT_MM, RIDGE_HALF_CREST_MM))
    return along_spokes(finger, profile, RIDGE_END_MM, RIDGE_LENGTH_MM - RIDGE_END_MM)


def core_within_skin(finger: Finger) -> Solid:
    """Build what of a core lies inside the skin, enlarged by the shrinkage; it reaches into the
    plate.
    """
    inset = finger.mold.core_inset_mm
    body = inset_body(finger.dimensions.bone_outline, inset)
    (_, scale), *stations = body.stations
    body = add_groove(finger, replace(body, stations=((-_INTO_COLLAR_MM, scale), *stations)))
    inside = cut_flat(finger, body, inset).union(*platform(finger, body, inset))

    return inside.cut(*bump_recess(finger)).scaled(finger.dimensions.shrinkage)


def core_hollow(finger: Finger) -> Solid:
    """Build what a core leaves open inside the skin.

    The core may be smaller than the bone by an inset, which makes the skin fit tightly.
    """
    return filled_bone(finger, finger.mold.core_inset_mm).cut(*bump_recess(finger))


def bump_recess(finger: Finger) -> tuple[Solid, ...]:
    """Build the recess of a core for the skin's bump over the sensor; none without one.

    Its side slopes by 45 degrees, so that no air stays in it and the bump leaves it.
    """
    skin = finger.skin
    dims = finger.dimensions
    if skin.bump_height_mm == 0.0:
        return ()

    floor = finger.mold.core_inset_mm - dims.platform_depth + skin.bump_height_mm
    reach = skin.bump_height_mm + _INTO_HOLLOW_MM
    centre = (dims.sensor_z, 0.0)
    radius = skin.bump_radius_mm

    return (
        Cone(
            axis="y",
            centre=centre,
            low=floor - reach,
            high=floor,
            low_radius=radius + reach,
            high_radius=radius,
        ),
    )
