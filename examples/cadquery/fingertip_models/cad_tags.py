"""Faces of the parts that have a tag in CAD, such as "pocket", by what selects them."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from .bone import cable_channel
from .solids import Point3

if TYPE_CHECKING:
    from .program_types import Finger

PlaneSelectors: TypeAlias = tuple[str | float, ...]
"""Selectors of flat faces, applied one after the other: a text is a selector of CadQuery, and a
number is the height y of a plane [mm].
"""


def list_tagged_planes(finger: Finger, part: str) -> dict[str, PlaneSelectors]:
    """List what selects the flat faces of a part that have a tag, by tag."""
    if part == "bone":
        return _list_bone_planes(finger)
    if part.startswith("mold"):
        return {"parting": (0.0,)}

    return {}


def list_tagged_points(finger: Finger, part: str) -> dict[str, tuple[Point3, ...]]:
    """List points on the curved faces of a part that have a tag (x, y, z) [mm], by tag."""
    if part == "bone":
        return {"channel": _list_channel_points(finger)}

    if part in ("skin", "mold_palmar"):
        sensor_z = finger.dimensions.sensor_z
        height = finger.dimensions.outer.palmar_height_at(0.0, sensor_z)
        return {"pad": ((0.0, -height, sensor_z),)}

    return {}


def _list_bone_planes(finger: Finger) -> dict[str, PlaneSelectors]:
    """List what selects the ends of the bone, the flat below the skin and the sensor's pocket."""
    dims = finger.dimensions
    planes: dict[str, PlaneSelectors] = {}

    if dims.joint:
        planes["cheek_left"] = ("<Z", "<X")
        planes["cheek_right"] = ("<Z", ">X")
    else:
        planes["post"] = ("<Z",)

    planes["flat"] = (-dims.flat_depth,)
    planes["pocket"] = (dims.pocket_depth - dims.platform_depth,)
    return planes


def _list_channel_points(finger: Finger) -> tuple[Point3, Point3]:
    """List the points where the bend of the cable's channel meets its straight pieces [mm]."""
    tube = cable_channel(finger)
    turn_y = tube.start_y + tube.bend_radius
    turn_z = tube.exit_z + tube.bend_radius

    return (
        (0.0, tube.start_y + tube.radius, turn_z),
        (tube.radius, turn_y, tube.exit_z),
    )
