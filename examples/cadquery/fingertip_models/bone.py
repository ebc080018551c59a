"""Bone with the channel for its cables, its flat, platform and collar.

The pocket of the sensor is `sensor_pocket`, the joint or post one of `interfaces`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from . import sensor_pocket
from .allowances import LEDGE_MM
from .conic import ConicBody, add_groove, inset_body
from .interfaces import shapes_of
from .profile import farthest_corner
from .solids import (
    Box,
    ElbowTube,
    Solid,
    SuperconicSolid,
    cylinder,
)

if TYPE_CHECKING:
    from .program_types import Finger

_ALONG_FLOOR_MM = 1.0
"""Length of the channel before its bend, in the floor of the trough [mm]."""
_NECK_OVERLAP_MM = 0.5
"""Length by which the ramp's solid begins below the flat, proximal to the ramp [mm]."""
_INTO_BASE = 0.01
"""Part of its size by which the foot of a sloping collar begins inside the base."""
_OUTLINE_POINTS = 16
_STEP_IN_COLLAR_MM = 0.3
"""Depth of the step between both flats in the collar, which rules keep longer than this [mm]."""


def bone(finger: Finger) -> Solid:
    r"""Build the bone: its outline with collar and platform, the interface, recess and channel.

    Section at x = 0, back up, tip to the right:

                        collar_length_mm
                             |<->|
           |<-base_length_mm---->|<------ length_mm - thickness_tip_mm ------>|
                              ___
                 | |         |   |__    __________________________
            _____| |_________|      |__|                          ``-.
           |     | |               groove                             `.    y
           |     | |                                                    |   ^
        interface \ \  cable channel                                    |   +--> z
           |       \ \_________________ trough                         /
           |________\_________________ \_________        _______    .'
                             |___|   flat        `------| pocket|--'
                                             ramp,  platform_mm
    """
    added, removed = shapes_of(finger)
    return (
        filled_bone(finger)
        .union(*added)
        .cut(sensor_pocket.sensor_recess(finger), cable_channel(finger), *removed)
    )


def cable_channel(finger: Finger) -> ElbowTube:
    r"""Build the cable channel: from the floor of the trough by one bend to the back of the base.

    Section at x = 0, back up, tip to the right:

          |   |   end_y, past the back of the base
          |   |
          |   |   channel_diameter_mm
          |   |
           \   \________
            \           |   start_y, floor of the trough
             '-.________|
            ^           ^
         exit_z      start_z        bend of the middle: channel_bend_radius_mm
    """
    dims = finger.dimensions
    bone = finger.bone
    assert bone.channel_bend_radius_mm > bone.channel_diameter_mm / 2, (
        "the channel folds into itself"
    )

    return ElbowTube(
        start_y=-dims.flat_depth + dims.pocket_depth,
        start_z=dims.channel_exit_z + bone.channel_bend_radius_mm + _ALONG_FLOOR_MM,
        exit_z=dims.channel_exit_z,
        end_y=dims.bone_outline.section.dorsal + bone.channel_diameter_mm,
        bend_radius=bone.channel_bend_radius_mm,
        radius=bone.channel_diameter_mm / 2,
    )


def filled_bone(finger: Finger, inset_mm: float = 0.0) -> Solid:
    """Build the bone without hollows; all surfaces but the collar's may lie deeper by an inset."""
    body = add_groove(finger, inset_body(finger.dimensions.bone_outline, inset_mm))
    return cut_flat(finger, body, inset_mm).union(*platform(finger, body, inset_mm), collar(finger))


def cut_flat(finger: Finger, body: ConicBody, inset_mm: float) -> Solid:
    section = body.section
    dims = finger.dimensions
    # The cutting boxes extend past the outline by a length that scales with the design: its half
    # width.

    def below(depth: float, low: float) -> Box:
        return Box(
            (-2 * section.half_width, -section.palmar - section.half_width, low),
            (2 * section.half_width, -depth, finger.skin.length_mm + section.half_width),
        )

    flat = dims.flat_depth - inset_mm
    base = dims.base_flat_depth
    low = body.stations[0][0] - section.half_width
    below_base = below(base, low)
    if base == dims.flat_depth:
        return SuperconicSolid(body).cut(below_base)

    below_flat = below(flat, -_STEP_IN_COLLAR_MM)
    return SuperconicSolid(body).cut(below_base, below_flat)


def platform(finger: Finger, body: ConicBody, inset_mm: float) -> tuple[Solid, ...]:
    r"""Build the platform under the sensor's head, and the ramp of its tail, within the outline.

    There is none without platform_mm.

    Seen from the palm, tip to the right:

                               ______
                             .'      '.
             _______________/          \
            |     ramp      |     +     |   platform_radius
            |_______________|           |   2 neck_half_width
            |               |\         /
         ramp[0]         ramp[1]'____.'
                               sensor_z
    """
    dims = finger.dimensions
    if finger.bone.platform_mm == 0.0:
        return ()

    radius = dims.platform_radius - inset_mm
    half = dims.neck_half_width - inset_mm
    disc = cylinder(
        "y",
        centre=(dims.sensor_z, 0.0),
        low=inset_mm - dims.platform_depth,
        high=0.0,
        radius=radius,
    )
    neck = sensor_pocket.flat_slab(
        finger,
        low_mm=inset_mm,
        high_mm=dims.platform_depth,
        half_width=half,
        begin=dims.ramp[0] - _NECK_OVERLAP_MM,
        end=dims.sensor_z,
    )

    return (SuperconicSolid(body).intersect(disc.union(neck)),)


def collar(finger: Finger) -> Solid:
    """Build the collar: the flange proximal to the skin, on which the skin ends.

    Section at x = 0, back up, tip to the right; a bone on a post, which prints standing, has the
    slope:

                   |<-->|  collar_length_mm
                    ____
                  .'    |      collar_inset_mm below the skin
            ____.'      |____
            base        |     bone
                      z = 0
    """
    return (
        _sloping_collar(finger)
        if finger.dimensions.prints_without_supports
        else SuperconicSolid(finger.dimensions.collar)
    )


def _sloping_collar(finger: Finger) -> Solid:
    """Build a collar whose foot rises from the base at 45 degrees or more, but for a short palmar
    ledge.
    """
    slope = find_collar_slope(finger)
    section = finger.dimensions.collar.section
    return SuperconicSolid(
        ConicBody(section, ((slope.begin_z, slope.share), (slope.end_z, 1.0), (0.0, 1.0)))
    )


class CollarSlope(NamedTuple):
    """Slope from the base out to a collar: heights z at which it begins and ends [mm], and the
    collar's scale at its beginning.
    """

    begin_z: float
    end_z: float
    share: float


def find_collar_slope(finger: Finger) -> CollarSlope:
    dims = finger.dimensions
    base = finger.dimensions.bone_outline.section
    section = finger.dimensions.collar.section
    palm = (dims.base_flat_depth + LEDGE_MM) / section.palmar
    share = (
        min(base.half_width / section.half_width, base.dorsal / section.dorsal, palm) - _INTO_BASE
    )
    corner = farthest_corner(
        section.half_width, section.dorsal, section.dorsal_weight, _OUTLINE_POINTS
    )
    low = dims.collar.stations[0][0]

    return CollarSlope(low - corner * (1.0 - share), low, share)
