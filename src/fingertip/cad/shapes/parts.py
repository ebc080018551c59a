"""Registry of the fingertip's parts, bought hardware as plain solids for the assembly, and what
parameters shape them.

Threads of the hardware are cylinders of their nominal diameter. No check of a part reads these
solids.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import cast

from fingertip.cad.shapes import bench, finger, mold
from fingertip.cad.shapes.finger import sensor_body
from fingertip.design import Design
from fingertip.design.geometry.solids import Point3, Solid, cylinder
from fingertip.design.interfaces.adapter import read_adapter
from fingertip.design.interfaces.interface import middle_y
from fingertip.design.rules.ruleset import record_reads


@dataclass(frozen=True)
class Part:
    name: str
    solid: Callable[[Design], Solid]
    """Function that builds the part for a design."""
    genus: Callable[[Design], int]
    """Function that counts the through holes the solid must have."""
    colour: tuple[float, float, float]
    """Red, green and blue in pictures and STEP files, 0 to 1."""
    is_printed: bool
    exists_in: Callable[[Design], bool] = lambda design: True
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
            solid=finger.bone,
            genus=finger.genus,
            colour=(0.93, 0.89, 0.80),
            is_printed=True,
            is_in_finger=True,
        ),
        Part(
            name="skin",
            solid=finger.skin,
            genus=lambda design: 0,
            colour=(0.87, 0.62, 0.52),
            is_printed=False,
            is_in_finger=True,
        ),
        Part(
            name="mold_palmar",
            solid=mold.mold_palmar,
            genus=lambda design: 0,
            colour=(0.45, 0.58, 0.70),
            is_printed=True,
        ),
        Part(
            name="mold_dorsal",
            solid=mold.mold_dorsal,
            genus=lambda design: 0,
            colour=(0.62, 0.72, 0.80),
            is_printed=True,
        ),
        Part(
            name="core",
            solid=mold.core,
            genus=lambda design: 0,
            colour=(0.70, 0.78, 0.62),
            is_printed=True,
        ),
        Part(
            name="stand",
            solid=bench.stand,
            genus=lambda design: 2,
            colour=(0.78, 0.72, 0.58),
            is_printed=True,
            exists_in=lambda design: design.bone.interface == "post",
            is_tool=True,
        ),
        Part(
            name="pin",
            solid=bench.pin,
            genus=lambda design: 0,
            colour=_PIN,
            is_printed=True,
            exists_in=lambda design: (
                design.bone.interface == "clevis" and design.hand.pin == "printed"
            ),
            is_tool=True,
        ),
        Part(
            name="hand_stub",
            solid=bench.hand_stub,
            genus=bench.stub_genus,
            colour=(0.74, 0.74, 0.70),
            is_printed=True,
            exists_in=lambda design: design.bone.interface == "clevis",
            is_tool=True,
        ),
    )
}


def parts_by_name(design: Design) -> dict[str, Part]:
    return {name: part for name, part in PARTS.items() if part.exists_in(design)}


def exact_parts(design: Design, names: Iterable[str]) -> tuple[str, ...]:
    """List the parts with an exact solid: a bone with an adapter of an STL file has none."""
    is_mesh = design.bone.interface == "file" and not read_adapter(design).brep
    return tuple(name for name in names if name != "bone" or not is_mesh)


def print_scale(design: Design, part: Part) -> float:
    """Return the scale of a part's STL and 3MF files: the
    printer's compensation, or 1 for cast parts.
    """
    return design.printer.scale_percent / 100.0 if part.is_printed else 1.0


@dataclass(frozen=True)
class HardwareItem:
    name: str
    solid: Solid
    colour: tuple[float, float, float]
    """Red, green and blue in STEP files, 0 to 1."""


def hardware(design: Design, parts: Collection[str]) -> tuple[HardwareItem, ...]:
    """List what lies in the given parts: the sensor, and the pin of a joint."""
    items: list[HardwareItem] = []
    if "bone" in parts:
        items.append(HardwareItem("sensor", sensor_body(design), _FILM))

    if "bone" in parts and (joint := design.dimensions.joint):
        radius = joint.printed_pin_radius
        half = design.dimensions.pin_length / 2
        solid = cylinder(
            "x",
            centre=(joint.axis_y, joint.axis_z),
            low=-half,
            high=half,
            radius=radius,
        )
        items.append(
            HardwareItem("joint_pin", solid, _PIN if design.hand.pin == "printed" else _STEEL)
        )

    return tuple(items)


def find_frames(design: Design) -> dict[str, Point3]:
    """Find the origins [mm] of the interface to the hand, the tip of
    the skin and the middle of the active area.
    """
    dims = design.dimensions
    joint = design.dimensions.joint
    y, z = (joint.axis_y, joint.axis_z) if joint else (middle_y(dims), -design.bone.base_length_mm)

    return {
        "interface": (0.0, y, z),
        "tip": (0.0, 0.0, design.skin.length_mm),
        "sensor": (0.0, -dims.platform_depth, dims.sensor_z),
    }


def tagged_faces(design: Design, part: str) -> dict[str, tuple[str | float, ...]]:
    """Find what selects flat faces one after the other, by tag:
    cadquery's selectors, and planes across y [mm].
    """
    dims = design.dimensions
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


def shapes_of_parameters(design: Design) -> Mapping[str, tuple[str, ...]]:
    """Find the parts and bought items whose shape reads each parameter, by its name.

    What is read is recorded while a shape is made: a parameter that this design does not use moves
    nothing, and is left out.
    """
    moved: dict[str, tuple[str, ...]] = {}

    def add(name: str, reads: Iterable[str]) -> None:
        moved.update({parameter: (*moved.get(parameter, ()), name) for parameter in sorted(reads)})

    for name, part in parts_by_name(design).items():
        tables, reads = record_reads(design)
        part.solid(cast(Design, tables))
        add(name, reads)

    tables, reads = record_reads(design)
    for item in hardware(cast(Design, tables), ("bone",)):
        add(item.name, reads)

    return moved
