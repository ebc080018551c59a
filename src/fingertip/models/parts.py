"""Registry of the fingertip's parts, bought hardware as plain solids for the assembly, and places
on both.

Threads of the hardware are cylinders of their nominal diameter. No check of a part reads these
solids.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .bone import bone, cable_channel
from .core import core
from .hand_stub import hand_stub
from .mold import mold_dorsal, mold_palmar
from .pin import pin
from .sensor_pocket import sensor_body
from .skin import skin
from .solids import Point3, Solid, cylinder
from .stand import stand

if TYPE_CHECKING:
    from .program_types import Finger


@dataclass(frozen=True)
class Part:
    name: str
    solid: Callable[[Finger], Solid]
    """Function that builds the part for a finger."""
    colour: tuple[float, float, float]
    """Red, green and blue in pictures and STEP files, 0 to 1."""
    is_printed: bool
    exists_in: Callable[[Finger], bool] = lambda finger: True
    """Function that tells whether a design has this part."""
    is_in_finger: bool = False
    """True for what a finished finger consists of; the others serve to make it."""
    is_tool: bool = False
    """True for what helps to assemble the finger, and lies nowhere in it or in its mold."""

    @property
    def note(self) -> str:
        """Note in the part's files: a skin must not go to the printer."""
        return "" if self.is_printed else "cast in silicone, not to be printed"


_PIN = (0.88, 0.80, 0.45)
_STEEL = (0.55, 0.56, 0.58)
_FILM = (0.20, 0.22, 0.25)
PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part(
            name="bone",
            solid=bone,
            colour=(0.93, 0.89, 0.80),
            is_printed=True,
            is_in_finger=True,
        ),
        Part(
            name="skin",
            solid=skin,
            colour=(0.87, 0.62, 0.52),
            is_printed=False,
            is_in_finger=True,
        ),
        Part(
            name="mold_palmar",
            solid=mold_palmar,
            colour=(0.45, 0.58, 0.70),
            is_printed=True,
        ),
        Part(
            name="mold_dorsal",
            solid=mold_dorsal,
            colour=(0.62, 0.72, 0.80),
            is_printed=True,
        ),
        Part(
            name="core",
            solid=core,
            colour=(0.70, 0.78, 0.62),
            is_printed=True,
        ),
        Part(
            name="stand",
            solid=stand,
            colour=(0.78, 0.72, 0.58),
            is_printed=True,
            exists_in=lambda finger: finger.bone.interface == "post",
            is_tool=True,
        ),
        Part(
            name="pin",
            solid=pin,
            colour=_PIN,
            is_printed=True,
            exists_in=lambda finger: (
                finger.bone.interface == "clevis" and finger.hand.pin == "printed"
            ),
            is_tool=True,
        ),
        Part(
            name="hand_stub",
            solid=hand_stub,
            colour=(0.74, 0.74, 0.70),
            is_printed=True,
            exists_in=lambda finger: finger.bone.interface == "clevis",
            is_tool=True,
        ),
    )
}


def parts_by_name(finger: Finger) -> dict[str, Part]:
    return {name: part for name, part in PARTS.items() if part.exists_in(finger)}


def print_scale(finger: Finger, part: Part) -> float:
    """Return the scale of a part's STL and 3MF files: the
    printer's compensation, or 1 for cast parts.
    """
    return finger.printer.scale_percent / 100.0 if part.is_printed else 1.0


@dataclass(frozen=True)
class HardwareItem:
    name: str
    solid: Solid
    colour: tuple[float, float, float]
    """Red, green and blue in STEP files, 0 to 1."""


def hardware(finger: Finger, parts: Collection[str]) -> tuple[HardwareItem, ...]:
    """List what lies in the given parts: the sensor, and the pin of a joint."""
    items: list[HardwareItem] = []
    if "bone" in parts:
        items.append(HardwareItem("sensor", sensor_body(finger), _FILM))

    if "bone" in parts and (joint := finger.dimensions.joint):
        radius = joint.printed_pin_radius
        half = finger.dimensions.pin_length / 2
        solid = cylinder(
            "x",
            centre=(joint.axis_y, joint.axis_z),
            low=-half,
            high=half,
            radius=radius,
        )
        items.append(
            HardwareItem("joint_pin", solid, _PIN if finger.hand.pin == "printed" else _STEEL)
        )

    return tuple(items)


class UnknownPartError(ValueError):
    """The finger has no part or bought item of a name."""


def find_solid(finger: Finger, name: str) -> Solid:
    """Build the solid of a part or of a bought item. Raises UnknownPartError for another name."""
    parts = parts_by_name(finger)
    if name in parts:
        return parts[name].solid(finger)

    bought = {item.name: item.solid for item in hardware(finger, parts)}
    if name not in bought:
        raise UnknownPartError(f"this finger has no {name}; it has {', '.join((*parts, *bought))}.")

    return bought[name]


def find_frames(finger: Finger) -> dict[str, Point3]:
    """Find the origins [mm] of the interface to the hand, the tip of
    the skin and the middle of the active area.
    """
    dims = finger.dimensions
    joint = finger.dimensions.joint
    y = joint.axis_y if joint else dims.base_middle_y
    z = joint.axis_z if joint else -finger.bone.base_length_mm

    return {
        "interface": (0.0, y, z),
        "tip": (0.0, 0.0, finger.skin.length_mm),
        "sensor": (0.0, -dims.platform_depth, dims.sensor_z),
    }


def list_tagged_planes(finger: Finger, part: str) -> dict[str, tuple[str | float, ...]]:
    """Find what selects flat faces one after the other, by tag:
    cadquery's selectors, and planes across y [mm].
    """
    dims = finger.dimensions
    if part != "bone":
        return {"parting": (0.0,)} if part.startswith("mold") else {}

    ends = (
        {"cheek_left": ("<Z", "<X"), "cheek_right": ("<Z", ">X")}
        if dims.joint
        else {"post": ("<Z",)}
    )
    return {
        **ends,
        "flat": (-dims.flat_depth,),
        "pocket": (dims.pocket_depth - dims.platform_depth,),
    }


def list_tagged_points(finger: Finger, part: str) -> dict[str, tuple[Point3, ...]]:
    """List points of the curved faces that have a tag [mm]."""
    points: dict[str, tuple[Point3, ...]] = {}
    if part in ("skin", "mold_palmar"):
        z = finger.dimensions.sensor_z
        points["pad"] = ((0.0, -finger.dimensions.outer.palmar_height_at(0.0, z), z),)

    if part == "bone":  # where the bend of the channel meets its straight pieces
        tube = cable_channel(finger)
        turn_y = tube.start_y + tube.bend_radius
        turn_z = tube.exit_z + tube.bend_radius
        points["channel"] = (
            (0.0, tube.start_y + tube.radius, turn_z),
            (tube.radius, turn_y, tube.exit_z),
        )

    return points
