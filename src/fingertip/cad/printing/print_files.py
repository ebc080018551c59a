"""Files of the printed parts as they lie on the bed: an STL file each, and plates as 3MF with
slicer settings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, product

from fingertip.cad.files import stl
from fingertip.cad.files.threemf import Item, write_items
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.printing.settings import choose_plate_kind, describe_part, slicer_settings
from fingertip.design import Design

_ROUNDING_MM = 1e-6
"""Overlap that counts as none [mm]."""
_TURNS_TRIED = 256
"""Number of combinations of turns that are tried at most: all those of eight parts."""
_SHIFT_DIGITS = 3
"""Decimals of the shift to the middle of the bed [mm]."""


@dataclass(frozen=True)
class Placed:
    """Part on a plate, as the rectangle that it covers [mm]."""

    name: str
    is_turned: bool
    """True if the part is turned by a quarter turn about the vertical."""
    x: float
    y: float
    width: float
    depth: float

    def distance(self, neighbour: Placed) -> float:
        """Measure the gap to another part along x or y, the larger of both.

        It is negative if they overlap.
        """
        along_x = max(neighbour.x - self.x - self.width, self.x - neighbour.x - neighbour.width)
        along_y = max(neighbour.y - self.y - self.depth, self.y - neighbour.y - neighbour.depth)
        return max(along_x, along_y)


Plate = tuple[Placed, ...]


def arrange(
    footprints: Mapping[str, tuple[float, float]], bed: tuple[float, float], gap: float
) -> tuple[Plate, ...]:
    """Place parts [mm] on as few plates as a simple search finds, mid-bed.

    Those that are too large stand alone.
    """
    # Large parts come first. Turns are tried from none to all, until everything lies on one plate.
    names = sorted(footprints, key=lambda name: (-footprints[name][0] * footprints[name][1], name))
    best: list[list[Placed]] = []

    for turns in islice(product((False, True), repeat=len(names)), _TURNS_TRIED):
        plates: list[list[Placed]] = []
        for name, is_turned in zip(names, turns, strict=True):
            width, depth = footprints[name][::-1] if is_turned else footprints[name]
            _place_part(
                plates,
                Placed(
                    name=name,
                    is_turned=is_turned,
                    x=0.0,
                    y=0.0,
                    width=width,
                    depth=depth,
                ),
                bed,
                gap,
            )

        if not best or len(plates) < len(best):
            best = plates
        if len(best) <= 1:
            break

    return tuple(_centred(plate, bed) for plate in best)


def _place_part(
    plates: list[list[Placed]], part: Placed, bed: tuple[float, float], gap: float
) -> None:
    """Place a part on the first plate with room, as near to its front left corner as possible.

    Without room on any, it begins a new plate.
    """
    for plate in plates:
        # At the left or the front edge of the bed, or right of or behind another part.
        lefts = [0.0, *(placed.x + placed.width + gap for placed in plate)]
        fronts = [0.0, *(placed.y + placed.depth + gap for placed in plate)]
        spots = (replace(part, x=x, y=y) for x, y in product(lefts, fronts))
        free = [
            spot
            for spot in spots
            if spot.x + spot.width <= bed[0] + _ROUNDING_MM
            and spot.y + spot.depth <= bed[1] + _ROUNDING_MM
            and all(spot.distance(placed) >= gap - _ROUNDING_MM for placed in plate)
        ]
        if free:
            plate.append(min(free, key=lambda spot: (spot.y + spot.depth, spot.x)))
            return

    plates.append([part])


def _centred(plate: Sequence[Placed], bed: tuple[float, float]) -> Plate:
    """Move the parts of a plate together to the middle of the bed."""
    right = max(part.x + part.width for part in plate)
    back = max(part.y + part.depth for part in plate)
    dx, dy = (
        round((size - used) / 2, _SHIFT_DIGITS)
        for size, used in zip(bed, (right, back), strict=True)
    )

    return tuple(replace(part, x=part.x + dx, y=part.y + dy) for part in plate)


@dataclass(frozen=True)
class PrintFiles:
    contents: Mapping[str, bytes]
    """File name -> bytes; no file has been written."""
    plates: Mapping[str, tuple[str, ...]]
    """File name of each plate -> its parts."""


def parts_on_plates(design: Design) -> tuple[str, ...]:
    """List the parts on the plates: the bone only if its strength is checked for this printer."""
    holds = design.strength.material.process == choose_plate_kind(design).name
    return tuple(name for name in print_orientations(design) if name != "bone" or holds)


def make_print_files(
    design: Design, meshes: Mapping[str, Mesh], encoded: Mapping[str, str], with_stl: bool
) -> PrintFiles:
    """Make the files of the printed parts.

    Plates are made only if all parts are there: none leaves out a part.
    """
    orientations = print_orientations(design)
    poses = {
        name: bed_pose(meshes[name], orientations[name].rotate_x_deg)
        for name in orientations
        if name in meshes
    }
    contents = {}
    plates = {}

    if with_stl:
        for name, pose in poses.items():
            contents[f"{name}.stl"] = stl.to_bytes(pose.apply(meshes[name]), name)

    if not set(orientations) <= set(encoded):
        return PrintFiles(contents, {})

    kind = choose_plate_kind(design)
    supports = supports_by_part(design)
    material = design.strength.material
    footprints = {name: poses[name].size(meshes[name])[:2] for name in parts_on_plates(design)}
    arranged = arrange(footprints, (design.printer.bed_x_mm, design.printer.bed_y_mm), kind.gap_mm)

    for file, plate in zip(kind.file_names(len(arranged)), arranged, strict=True):
        items = []
        for placed in plate:
            name, pose = (
                placed.name,
                poses[placed.name].turned() if placed.is_turned else poses[placed.name],
            )
            on_bed = pose.on_bed(meshes[name], placed.x, placed.y)
            printed = (kind, name, orientations[name], supports[name])
            note = describe_part(*printed, material)
            settings = slicer_settings(*printed)
            items.append(
                Item(
                    name=name,
                    mesh=encoded[name],
                    note=note,
                    rotation=on_bed.rotation,
                    shift=on_bed.shift,
                    settings=settings,
                )
            )

        contents[file] = write_items(f"{design.name} {file.removesuffix('.3mf')}", items)
        plates[file] = tuple(placed.name for placed in plate)

    return PrintFiles(contents, plates)
