"""Registry of the fingertip's parts, bought hardware as plain solids for the assembly, and what parameters shape them.

Threads of the hardware are cylinders of their nominal diameter. No check of a part reads these solids.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import cast

from fingertip.cad.shapes import bone, cup, insert, mold, stand
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.insert import axis_z, head_y
from fingertip.catalogues.hardware import Thread
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import size_clamp_bolts
from fingertip.design.geometry.solids import Point3, Solid, cylinder, difference, hexagon, union
from fingertip.design.interfaces.clevis_solids import pin_bore
from fingertip.design.interfaces.interface import middle_y
from fingertip.design.rules.ruleset import RecordingTables
from fingertip.filling.mold_filling import place_vents


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


def _dorsal_hole_count(design: Design) -> int:
    """Count the bolt holes, the vents through the dorsal half, its inlet, and the hole of the chaplet's screw."""
    if design.mold.method == "plunge":
        return 0
    layout = design.mold_layout
    vents = sum(vent.kind == "dorsal" for vent in place_vents(design))
    return len(layout.bolts) + vents + 1 + (design.dimensions.chaplet is not None)


def _palmar_hole_count(design: Design) -> int:
    return 0 if design.mold.method == "plunge" else len(design.mold_layout.bolts)


def _of_mold(name: str) -> Callable[[Design], Solid]:
    """Choose between the cup and the mold that is closed before it is filled."""
    modules = {True: cup, False: mold}
    return lambda design: cast(Solid, getattr(modules[design.mold.method == "plunge"], name)(design))


PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("bone", bone.bone, bone.genus, (0.93, 0.89, 0.80), True, is_in_finger=True),
        Part(
            "lid", bone.lid, lambda design: 0, (0.80, 0.74, 0.62), True,
            exists_in=lambda design: design.dimensions.fold is not None, is_in_finger=True,
        ),
        Part(
            "skin", insert.skin, lambda design: int(design.dimensions.chaplet is not None), (0.87, 0.62, 0.52), False,
            is_in_finger=True,
        ),
        Part("mold_palmar", _of_mold("mold_palmar"), _palmar_hole_count, (0.45, 0.58, 0.70), True),
        Part("mold_dorsal", _of_mold("mold_dorsal"), _dorsal_hole_count, (0.62, 0.72, 0.80), True),
        Part(
            "core", cup.core, lambda design: 0, (0.70, 0.78, 0.62), True,
            exists_in=lambda design: design.is_cast_apart,
        ),
        Part(
            "sensor_insert", lambda design: insert.sensor_insert(design)[0], lambda design: 0, (0.36, 0.55, 0.42), True,
            exists_in=lambda design: design.dimensions.insert is not None, is_in_finger=True,
        ),
        Part(
            "insert_jig", insert.insert_jig, lambda design: 1, (0.55, 0.70, 0.58), True,
            exists_in=lambda design: design.dimensions.insert is not None, is_tool=True,
        ),
        Part(
            "stand", stand.stand, stand.genus, (0.78, 0.72, 0.58), True,
            exists_in=lambda design: design.mold.method == "plunge" and design.bone.interface == "post", is_tool=True,
        ),
    )
}  # fmt: skip


def parts_by_name(design: Design) -> dict[str, Part]:
    return {name: part for name, part in PARTS.items() if part.exists_in(design)}


def print_scale(design: Design, part: Part) -> float:
    """Return the scale of a part's STL and 3MF files: the printer's compensation, or 1 for cast parts."""
    return design.printer.scale_percent / 100.0 if part.is_printed else 1.0


_STEEL, _BRASS, _FILM = (0.55, 0.56, 0.58), (0.78, 0.66, 0.33), (0.20, 0.22, 0.25)


@dataclass(frozen=True)
class HardwareItem:
    name: str
    solid: Solid
    colour: tuple[float, float, float]
    """Red, green and blue in STEP files, 0 to 1."""
    thread_in: tuple[str, ...] = ()
    """Parts in which it cuts its thread; it overlaps no other part."""


def hardware(design: Design, parts: Collection[str]) -> tuple[HardwareItem, ...]:
    """List the hardware of the given parts: both halves' bolts, in a hand's fork a pin as long as the base is wide."""
    items: list[HardwareItem] = []
    if "bone" in parts:
        items.append(HardwareItem("sensor", sensor_body(design), _FILM))
    if {"mold_palmar", "mold_dorsal"} <= set(parts) and design.mold.method != "plunge":
        items += _mold_bolts(design)
    if "mold_dorsal" in parts and (chaplet := design.dimensions.chaplet):
        held = ("bone",) if "bone" in parts else ()
        length = chaplet.screw_length(design.mold_layout.dorsal_height)
        solid = screw(chaplet.thread, 0.0, axis_z(design), head_y(design), length)
        items.append(HardwareItem("chaplet_screw", solid, _STEEL, held))
    if "bone" in parts and (joint := design.dimensions.joint):
        pin = pin_bore(joint, design.dimensions.pin_length / 2)
        items.append(HardwareItem("joint_pin", pin, _STEEL))
    return tuple(items)


def screw(thread: Thread, x: float, z: float, under_head_y: float, length: float) -> Solid:
    """Build a screw along y below `under_head_y` [mm]; its head has about the sizes of ISO 4762."""
    head = cylinder("y", (z, x), under_head_y, under_head_y + thread.diameter_mm, thread.nut_flats_mm / 2)
    shank = cylinder("y", (z, x), under_head_y - length, under_head_y, thread.diameter_mm / 2)
    return union(head, shank)


def _mold_bolts(design: Design) -> Iterator[HardwareItem]:
    m, bolts = design.mold_layout, size_clamp_bolts(design.mold, design.mold_layout)
    thread, top = bolts.thread, -m.palmar_height + design.mold.nut_depth_mm
    for i, (x, z) in enumerate(m.bolts, 1):
        bolt = screw(thread, x, z, m.dorsal_height, bolts.length_mm)
        outline = hexagon(z, x, thread.nut_flats_mm, top - thread.nut_height_mm, top)
        # The hole reaches past both faces, by a length that scales with the nut.
        low, high = top - 2 * thread.nut_height_mm, top + thread.nut_height_mm
        nut = difference(outline, cylinder("y", (z, x), low, high, thread.diameter_mm / 2))
        yield HardwareItem(f"mold_bolt_{i}", bolt, _STEEL)
        yield HardwareItem(f"mold_nut_{i}", nut, _BRASS)


def find_frames(design: Design) -> dict[str, Point3]:
    """Find the origins [mm] of the interface to the hand, the tip of the skin and the middle of the active area."""
    dims, joint = design.dimensions, design.dimensions.joint
    y, z = (joint.axis_y, joint.axis_z) if joint else (middle_y(dims), -design.bone.base_length_mm)
    return {
        "interface": (0.0, y, z),
        "tip": (0.0, 0.0, design.skin.length_mm),
        "sensor": (0.0, -dims.platform_depth, dims.sensor_z),
    }


_HARDWARE_OF = (("bone",), ("mold_dorsal",), ("mold_palmar", "mold_dorsal"))
"""Parts whose hardware is made apart, so that each item is blamed for little more than it reads itself."""


def shapes_of_parameters(design: Design) -> Mapping[str, tuple[str, ...]]:
    """Find the parts and bought items whose shape reads each parameter, by its name.

    What is read is recorded while a shape is made: a parameter that this design does not use moves nothing, and is left
    out.
    """
    read: dict[str, set[str]] = {}
    for name, part in parts_by_name(design).items():
        recorder = RecordingTables(design)
        part.solid(cast(Design, recorder))
        read[name] = recorder.reads
    for parts in _HARDWARE_OF:
        recorder = RecordingTables(design)
        for item in hardware(cast(Design, recorder), parts):
            read.setdefault(item.name, recorder.reads)
    moved: dict[str, list[str]] = {}
    for item_name, parameters in read.items():
        for parameter in sorted(parameters):
            moved.setdefault(parameter, []).append(item_name)
    return {parameter: tuple(items) for parameter, items in moved.items()}
