"""Settings of the slicer for each printed part: numbers for the casting sheet and for the plates alike."""

from __future__ import annotations

from fingertip.cad.printing.orientations import Orientation
from fingertip.cad.printing.overhang import OVERHANG_DEG
from fingertip.cad.printing.plates import FDM, PlateKind
from fingertip.cad.printing.supports import Supports
from fingertip.print_materials import PrintMaterial

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
    """Infill of a part."""
    return _MOLD_INFILL_PERCENT if part.startswith("mold") else _SOLID_PERCENT


def needs_brim(orientation: Orientation) -> bool:
    """Return whether a part gets a brim: those that stand on end do."""
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
