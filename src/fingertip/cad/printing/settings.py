"""Settings with which the parts are printed: layers, walls, infill, brim and supports, and the kinds of plates."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from fingertip.cad.printing.orientations import Orientation, Supports
from fingertip.cad.printing.overhang import OVERHANG_DEG
from fingertip.catalogues.print_materials import PrintMaterial
from fingertip.design import Design


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
class Profile:
    """How the parts of a design are printed in filament."""

    layer_mm: float
    walls: int
    """Lines beside each surface."""
    infill_percent: int
    """Infill of what is not printed solid."""
    solid: tuple[str, ...]
    has_wide_feet: bool = False
    """True if all but the bone stand on faces so wide that they need no brim."""

    @property
    def brim_mm(self) -> float:
        """Width of a brim: those of neighbours on a plate do not meet."""
        return FDM.gap_mm - 1.0 if self.has_wide_feet else FDM.gap_mm / 2 - 0.5


NOZZLE_MM = 0.4
"""Bore of the usual nozzle, for which walls are counted in lines [mm]."""
LAYER_MM = 0.1
FIRST_LAYER_MM = 0.2
"""Least height of the first layer [mm]: thinner ones hardly stick to the bed."""
WALLS = 4
"""Lines beside each surface: silicone finds its way through fewer. An assumption."""
RESIN_LAYER_MM = 0.05
"""Usual layers of resin printers [mm]."""
_SOLID_PERCENT = 100
UNDER_PRESSURE = Profile(LAYER_MM, WALLS, 40, ("bone", "lid", "core", "sensor_insert", "insert_jig"))
"""Profile of molds that silicone is pressed into; their infill is an assumption. The strength of bone, lid and core is
that of solid prints."""
POURED = Profile(0.15, 3, 15, ("bone",), has_wide_feet=True)
"""Profile of cups that are poured full."""


def choose_profile(design: Design) -> Profile:
    return POURED if design.mold.method == "plunge" else UNDER_PRESSURE


def infill_percent(part: str, profile: Profile = UNDER_PRESSURE) -> int:
    return _SOLID_PERCENT if part in profile.solid else profile.infill_percent


def needs_brim(part: str, orientation: Orientation, profile: Profile) -> bool:
    return orientation.rotate_x_deg == 0.0 and (part == "bone" or not profile.has_wide_feet)


def slicer_settings(
    kind: PlateKind, part: str, orientation: Orientation, supports: Supports, profile: Profile = UNDER_PRESSURE
) -> tuple[tuple[str, str], ...]:
    """Set for PrusaSlicer how a part of a plate is printed. Other programs ignore these settings.

    They are settings of the object, so that printer, filament and whatever else is chosen in the slicer stay. Automatic
    supports stand below most bridges too (in version 2.5), in the nut traps as anywhere. Those of the usual style
    spread to other parts and above the collar, which snug ones do not.
    """
    if kind is SLA:
        needed = f"{int(bool(supports.places))}"
        return (("layer_height", f"{RESIN_LAYER_MM:g}"), ("hollowing_enable", "0"), ("supports_enable", needed))
    infill = infill_percent(part, profile)
    settings = [("layer_height", f"{profile.layer_mm:g}"), ("perimeters", f"{profile.walls}")]
    settings.append(("fill_density", f"{infill}%"))
    if infill == _SOLID_PERCENT:
        settings.append(("fill_pattern", "rectilinear"))  # others refuse to fill all
    if needs_brim(part, orientation, profile):
        settings += [("brim_type", "outer_only"), ("brim_width", f"{profile.brim_mm:g}")]
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
    kind: PlateKind, part: str, orientation: Orientation, supports: Supports, material: PrintMaterial, profile: Profile
) -> str:
    """Describe in sentences how a part of a plate is printed, for programs and people that ignore the settings."""
    if kind is FDM:
        text = f"Layers {profile.layer_mm:g} mm, {profile.walls} walls of a {NOZZLE_MM:g} mm nozzle, "
        text += f"infill {infill_percent(part, profile)} %, "
        text += f"brim {profile.brim_mm:g} mm. " if needs_brim(part, orientation, profile) else "no brim. "
    else:
        text = f"Layers {RESIN_LAYER_MM:g} mm, solid, not hollowed. "
    text += f"As it lies here: on {orientation.face_on_plate}. "
    if part == "bone":
        text += f"The strength checks hold for {material.label}. "
    return text + supports.note


def print_settings(
    orientations: Mapping[str, Orientation], on_filament: Collection[str], profile: Profile = UNDER_PRESSURE
) -> dict[str, Any]:
    """Collect the slicer's settings for the parts of a design, for filament (FDM) and resin (SLA).

    Parts that stand on end get a brim.
    """
    upright = [name for name in on_filament if needs_brim(name, orientations[name], profile)]
    lying = [name for name in on_filament if name not in upright]
    return {
        "fdm": {
            "nozzle_mm": NOZZLE_MM,
            "layer_mm": profile.layer_mm,
            "first_layer_mm": FIRST_LAYER_MM,
            "walls": profile.walls,
            "wall_mm": round(profile.walls * NOZZLE_MM, 2),
            "infill_percent": {name: infill_percent(name, profile) for name in on_filament},
            "brim_mm": profile.brim_mm,
            "brim_on": upright,
            "no_brim_on": lying,
        },
        "sla": {"layer_mm": RESIN_LAYER_MM},
        "supports_on": [name for name, lies in orientations.items() if lies.needs_supports],
        "no_supports_on": [name for name, lies in orientations.items() if not lies.needs_supports],
    }
