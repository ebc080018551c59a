"""Settings with which the parts are printed: layers, walls, infill, brim and supports, and the kinds of plates."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from fingertip.cad.printing.orientations import Orientation, Supports
from fingertip.cad.printing.overhang import OVERHANG_DEG
from fingertip.catalogues.print_materials import PrintMaterial


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


def slicer_settings(
    kind: PlateKind, part: str, orientation: Orientation, supports: Supports
) -> tuple[tuple[str, str], ...]:
    """Set for PrusaSlicer how a part of a plate is printed. Other programs ignore these settings.

    They are settings of the object, so that printer, filament and whatever else is chosen in the slicer stay. Automatic
    supports stand below most bridges too (in version 2.5), in the nut traps as anywhere. Those of the usual style
    spread to other parts and above the collar, which snug ones do not.
    """
    if kind is SLA:
        needed = f"{int(bool(supports.places))}"
        return (("layer_height", f"{RESIN_LAYER_MM:g}"), ("hollowing_enable", "0"), ("supports_enable", needed))
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


def print_settings(orientations: Mapping[str, Orientation], on_filament: Collection[str]) -> dict[str, Any]:
    """Collect the slicer's settings for the parts of a design, for filament (FDM) and resin (SLA).

    Parts that stand on end get a brim.
    """
    upright = [name for name in on_filament if needs_brim(orientations[name])]
    lying = [name for name in on_filament if name not in upright]
    return {
        "fdm": {
            "nozzle_mm": NOZZLE_MM,
            "layer_mm": LAYER_MM,
            "first_layer_mm": FIRST_LAYER_MM,
            "walls": WALLS,
            "wall_mm": round(WALLS * NOZZLE_MM, 2),
            "infill_percent": {name: infill_percent(name) for name in on_filament},
            "brim_mm": BRIM_MM,
            "brim_on": upright,
            "no_brim_on": lying,
        },
        "sla": {"layer_mm": RESIN_LAYER_MM},
        "supports_on": [name for name, lies in orientations.items() if lies.needs_supports],
        "no_supports_on": [name for name, lies in orientations.items() if not lies.needs_supports],
    }
