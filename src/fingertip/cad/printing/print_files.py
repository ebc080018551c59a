"""Files of the printed parts as they lie on the bed: an STL file each, and plates as 3MF with slicer settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from fingertip.cad.files import stl
from fingertip.cad.files.threemf import Item, write_items
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.orientations import Orientation, Supports, print_orientations, supports_by_part
from fingertip.cad.printing.overhang import OVERHANG_DEG, bed_pose
from fingertip.catalogues.print_materials import PRINT_MATERIALS, PrintMaterial
from fingertip.design import Design

_ROUNDING_MM = 1e-6
"""Overlap that counts as none [mm]."""
_SHIFT_DIGITS = 3
"""Decimals of the shift to the middle of the bed [mm]."""


@dataclass(frozen=True)
class PlateKind:
    name: str
    gap_mm: float
    """Distance between two parts, seen from above [mm]."""

    def file_names(self, count: int) -> tuple[str, ...]:
        """Names of the files of a number of plates; a single plate has no number."""
        numbers = [""] if count == 1 else [f"_{number}" for number in range(1, count + 1)]
        return tuple(f"plate_{self.name}{number}.3mf" for number in numbers)


FDM = PlateKind("fdm", 5.0)
"""Filament: room for the nozzle, and for a brim around each part."""
SLA = PlateKind("sla", 2.5)
"""Resin: room for supports and their raft around each part."""
PLATE_KINDS = (FDM, SLA)


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

    def distance(self, other: Placed) -> float:
        """Measure the gap to another part along x or y, the larger of both; negative if they overlap."""
        along_x = max(other.x - self.x - self.width, self.x - other.x - other.width)
        along_y = max(other.y - self.y - self.depth, self.y - other.y - other.depth)
        return max(along_x, along_y)


Plate = tuple[Placed, ...]


def arrange(footprints: Mapping[str, tuple[float, float]], bed: tuple[float, float], gap: float) -> tuple[Plate, ...]:
    """Place parts [mm] on as few plates as a simple search finds, mid-bed; those that are too large stand alone."""
    # Large parts come first. Turns are tried from none to all, until everything lies on one plate.
    names = sorted(footprints, key=lambda name: (-footprints[name][0] * footprints[name][1], name))
    best: list[list[Placed]] = []
    for turns in product((False, True), repeat=len(names)):
        plates: list[list[Placed]] = []
        for name, is_turned in zip(names, turns, strict=True):
            width, depth = footprints[name][::-1] if is_turned else footprints[name]
            _place_part(plates, Placed(name, is_turned, 0.0, 0.0, width, depth), bed, gap)
        if not best or len(plates) < len(best):
            best = plates
        if len(best) <= 1:
            break
    return tuple(_centred(plate, bed) for plate in best)


def _place_part(plates: list[list[Placed]], part: Placed, bed: tuple[float, float], gap: float) -> None:
    """Place a part on the first plate with room, as near to its front left corner as possible; else on a new one."""
    for plate in plates:
        # At the left or the front edge of the bed, or right of or behind another part.
        spots = (
            Placed(part.name, part.is_turned, x, y, part.width, part.depth)
            for x in (0.0, *(other.x + other.width + gap for other in plate))
            for y in (0.0, *(other.y + other.depth + gap for other in plate))
        )
        free = [
            spot
            for spot in spots
            if spot.x + spot.width <= bed[0] + _ROUNDING_MM
            and spot.y + spot.depth <= bed[1] + _ROUNDING_MM
            and all(spot.distance(other) >= gap - _ROUNDING_MM for other in plate)
        ]
        if free:
            plate.append(min(free, key=lambda spot: (spot.y + spot.depth, spot.x)))
            return
    plates.append([part])


def _centred(plate: Sequence[Placed], bed: tuple[float, float]) -> Plate:
    """Move the parts of a plate together to the middle of the bed."""
    right, back = max(part.x + part.width for part in plate), max(part.y + part.depth for part in plate)
    dx, dy = (round((size - used) / 2, _SHIFT_DIGITS) for size, used in zip(bed, (right, back), strict=True))
    return tuple(
        Placed(part.name, part.is_turned, part.x + dx, part.y + dy, part.width, part.depth) for part in plate
    )  # fmt: skip


NOZZLE_MM = 0.4
"""Bore of the usual nozzle, for which walls are counted in lines [mm]."""
LAYER_MM = 0.1
FIRST_LAYER_MM = 0.2
"""Least height of the first layer [mm]: thinner ones hardly stick to the bed."""
WALLS = 4
"""Lines beside each surface: silicone finds its way through fewer. An assumption."""
RESIN_LAYER_MM = 0.05
"""Usual layers of resin printers [mm]."""
BRIM_MM = FDM.gap_mm / 2 - 0.5
"""Width of a brim [mm]: the brims of neighbours on a plate do not meet."""
_MOLD_INFILL_PERCENT, _SOLID_PERCENT = 40, 100
"""Infill of the mold, an assumption, and of bone, lid and core, whose strength is that of solid prints."""


def infill_percent(part: str) -> int:
    return _MOLD_INFILL_PERCENT if part.startswith("mold") else _SOLID_PERCENT


def needs_brim(orientation: Orientation) -> bool:
    return orientation.rotate_x_deg == 0.0


def slicer_settings(part: str, orientation: Orientation, supports: Supports) -> tuple[tuple[str, str], ...]:
    """Set for PrusaSlicer how a part of the filament plate is printed. Other programs ignore these settings.

    They are settings of the object, so that printer, filament and whatever else is chosen in the slicer stay. Automatic
    supports stand below most bridges too (in version 2.5), in the nut traps as anywhere. Those of the usual style
    spread to other parts and above the collar, which snug ones do not.
    """
    infill = infill_percent(part)
    settings = [("layer_height", f"{LAYER_MM:g}"), ("perimeters", f"{WALLS}"), ("fill_density", f"{infill}%")]
    if infill == _SOLID_PERCENT:
        settings.append(("fill_pattern", "rectilinear"))  # others refuse to fill all
    if needs_brim(orientation):
        settings += [("brim_type", "outer_only"), ("brim_width", f"{BRIM_MM:g}")]
    else:
        settings.append(("brim_type", "no_brim"))
    if not supports.places:
        return (*settings, ("support_material", "0"))
    return (
        *settings,
        ("support_material", "1"),
        ("support_material_threshold", f"{OVERHANG_DEG:g}"),
        ("support_material_buildplate_only", "1"),
        ("support_material_style", "snug"),
    )


def describe_part(
    kind: PlateKind, part: str, orientation: Orientation, supports: Supports, material: PrintMaterial
) -> str:
    """Describe in sentences how a part of a plate is printed, for programs and people that ignore the settings."""
    if kind is FDM:
        text = f"Layers {LAYER_MM:g} mm, {WALLS} walls of a {NOZZLE_MM:g} mm nozzle, infill {infill_percent(part)} %, "
        text += f"brim {BRIM_MM:g} mm. " if needs_brim(orientation) else "no brim. "
    else:
        text = f"Layers {RESIN_LAYER_MM:g} mm, solid, not hollowed. "
    text += f"As it lies here: on {orientation.face_on_plate}. "
    if part == "bone":
        text += f"The strength checks hold for {material.label}. "
    return text + supports.note


PRINT_FOLDER = "print"
"""Folder of these files, inside that of the parts."""


@dataclass(frozen=True)
class PrintFiles:
    contents: Mapping[str, bytes]
    """File name -> bytes; no file has been written."""
    plates: Mapping[str, tuple[str, ...]]
    """File name of each plate -> its parts."""


def make_print_files(
    design: Design, meshes: Mapping[str, Mesh], encoded: Mapping[str, str], with_stl: bool
) -> PrintFiles:
    """Make the files of the printed parts; plates only if all parts are there, so that none leaves out a part."""
    orientations = print_orientations(design)
    poses = {name: bed_pose(meshes[name], lies.rotate_x_deg) for name, lies in orientations.items() if name in meshes}
    contents, plates = {}, {}
    if with_stl:
        contents = {f"{name}.stl": stl.to_bytes(pose.apply(meshes[name]), name) for name, pose in poses.items()}
    if set(orientations) <= set(encoded):
        footprints = {name: pose.size(meshes[name])[:2] for name, pose in poses.items()}
        supports, material = supports_by_part(design), PRINT_MATERIALS[design.strength.print_material]
        for kind in PLATE_KINDS:
            arranged = arrange(footprints, (design.printer.bed_x_mm, design.printer.bed_y_mm), kind.gap_mm)
            for file, plate in zip(kind.file_names(len(arranged)), arranged, strict=True):
                items = []
                for part in plate:
                    stands, lies, pose = supports[part.name], orientations[part.name], poses[part.name]
                    pose = (pose.turned() if part.is_turned else pose).on_bed(meshes[part.name], part.x, part.y)
                    settings = slicer_settings(part.name, lies, stands) if kind is FDM else ()
                    note = describe_part(kind, part.name, lies, stands, material)
                    items.append(Item(part.name, encoded[part.name], note, pose.rotation, pose.shift, settings))
                contents[file] = write_items(f"{design.name} {file.removesuffix('.3mf')}", items)
                plates[file] = tuple(part.name for part in plate)
    return PrintFiles(contents, plates)
