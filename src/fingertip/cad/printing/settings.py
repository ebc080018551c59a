"""Settings with which the parts are printed (layers, walls, infill, brim, supports), and the print
time they take.

The time is estimated from volume and surface of the parts. Lines beside the surfaces take most of
it: a slicer prints them slowly, and the shorter they are, the slower. The two rates are fitted to
eight plates of five designs, sliced by PrusaSlicer 2.5 at its default speeds. They were within 12 %
of its times and 6 % of its volumes; `first_finger` is 6 % too long. Supports are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import Orientation, Supports, print_orientations
from fingertip.cad.printing.overhang import OVERHANG_DEG, bed_pose
from fingertip.catalogues.materials import PrintMaterial
from fingertip.design import Design
from fingertip.models.parts import PARTS


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


@dataclass(frozen=True)
class Profile:
    """Settings with which the parts of a design are printed in filament."""

    layer_mm: float = 0.15
    walls: int = 3
    """Lines beside each surface."""
    infill_percent: int = 15
    """Infill of what is not printed solid."""
    solid: tuple[str, ...] = ("bone", "pin")
    brim_mm: float = 4.0
    """Width of the brim of bone and pin, which stand on narrow feet: brims of neighbours on a plate
    do not meet.
    """


NOZZLE_MM = 0.4
"""Bore of the usual nozzle, for which walls are counted in lines [mm]."""
RESIN_LAYER_MM = 0.05
"""Usual layers of resin printers [mm]."""
_SOLID_PERCENT = 100
PROFILE = Profile()
"""Settings of every design: a cup is poured full and holds no pressure, so that few walls and
little infill do.
"""


def choose_plate_kind(design: Design) -> PlateKind:
    """Choose the printer of the plate: that of the bone's material, or filament where a service
    prints the bone.
    """
    return SLA if design.strength.material.process == SLA.name else FDM


def infill_percent(part: str) -> int:
    return _SOLID_PERCENT if part in PROFILE.solid else PROFILE.infill_percent


def needs_brim(part: str, orientation: Orientation) -> bool:
    return orientation.rotate_x_deg == 0.0 and part in PROFILE.solid


def slicer_settings(
    kind: PlateKind, part: str, orientation: Orientation, supports: Supports
) -> tuple[tuple[str, str], ...]:
    """Set for PrusaSlicer how a part of a plate is printed. Other programs ignore these settings.

    They are settings of the object, so that printer, filament and whatever else is chosen in the
    slicer stay. Supports of the usual style spread to other parts and above the collar, which snug
    ones do not.
    """
    if kind is SLA:
        needed = f"{int(bool(supports.places))}"
        return (
            ("layer_height", f"{RESIN_LAYER_MM:g}"),
            ("hollowing_enable", "0"),
            ("supports_enable", needed),
        )

    infill = infill_percent(part)
    settings = [("layer_height", f"{PROFILE.layer_mm:g}"), ("perimeters", f"{PROFILE.walls}")]
    settings.append(("fill_density", f"{infill}%"))
    if infill == _SOLID_PERCENT:
        settings.append(("fill_pattern", "rectilinear"))  # others refuse to fill all

    if needs_brim(part, orientation):
        settings += [("brim_type", "outer_only"), ("brim_width", f"{PROFILE.brim_mm:g}")]
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
    kind: PlateKind,
    part: str,
    orientation: Orientation,
    supports: Supports,
    material: PrintMaterial,
) -> str:
    """Describe in sentences how a part of a plate is printed, for programs and people that ignore
    the settings.
    """
    if kind is FDM:
        text = (
            f"Layers {PROFILE.layer_mm:g} mm, {PROFILE.walls} walls of a {NOZZLE_MM:g} mm nozzle, "
        )
        text += f"infill {infill_percent(part)} %, "
        text += f"brim {PROFILE.brim_mm:g} mm. " if needs_brim(part, orientation) else "no brim. "
    else:
        text = f"Layers {RESIN_LAYER_MM:g} mm, solid, not hollowed. "

    text += f"As it lies here: on {orientation.face_on_plate}. "
    if part == "bone":
        text += f"The strength checks hold for {material.label}. "

    return text + supports.note


_COARSE_MM = 0.2
"""Tolerance of the meshes [mm]: finer ones change the time by 0.2 %."""
_LINE_MM = 0.45
_CLOSED_LAYERS = 3
"""Width of a line, and layers without infill above and below [mm]: the slicer's defaults."""
_BESIDE_SURFACE = 12.0
_WITHIN = 4.0
_FITTED_LAYER_MM = 0.15
"""Minutes per cm3 of lines beside surfaces and of what lies between them, in layers of this height.
"""


@dataclass(frozen=True)
class PrintEstimate:
    minutes: float
    filament_cm3: float
    """Volume of the filament, without supports."""


@lru_cache(maxsize=8)
def estimate_print(design: Design) -> PrintEstimate:
    """Estimate one plate with all parts, printed as the design's profile says."""
    evaluator = MeshEvaluator(_COARSE_MM)
    minutes = 0.0
    filament = 0.0

    for name, lies in print_orientations(design).items():
        mesh = evaluator.mesh(PARTS[name].solid(design))
        mesh = bed_pose(mesh, lies.rotate_x_deg).apply(mesh)
        corners = mesh.vertices[mesh.triangles]
        areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2000.0
        # from beside, from above
        upright = np.hypot(areas[:, 0], areas[:, 1]).sum()
        flat = np.abs(areas[:, 2]).sum()
        volume = mesh.volume() / 1000.0
        beside = min(volume, float(upright) * PROFILE.walls * _LINE_MM)
        closed = min(volume - beside, float(flat) * _CLOSED_LAYERS * PROFILE.layer_mm)
        within = closed + (volume - beside - closed) * infill_percent(name) / 100.0
        minutes += (
            (_BESIDE_SURFACE * beside + _WITHIN * within) * _FITTED_LAYER_MM / PROFILE.layer_mm
        )
        filament += beside + within

    return PrintEstimate(minutes, filament)
