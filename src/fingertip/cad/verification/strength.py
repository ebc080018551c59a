"""Checks of the bone's strength: safety factors against the design's limits, and warnings where it would break."""

from __future__ import annotations

import math

from fingertip.cad.strength.assess import BoneStrength, Weakness
from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.print_materials import PRINT_MATERIALS, PrintMaterial

FILAMENT_CHECK = "bone.safety_factor.grip_fdm"
"""Name of the check of a bone from the plate for filament printers."""
_BREAKS_BELOW = 1.0
"""Safety factor below which the bone is expected to break at the load."""


def check_strength(design: Design, strength: BoneStrength) -> tuple[Check, ...]:
    """Check the safety factors of the bone. A factor above the design's own limit but below 1 warns."""
    limits = design.strength
    checks = [
        Check(
            "bone.safety_factor.grip", strength.grip_safety_factor, limits.min_grip_factor, "", "at least",
            _warn_of_load(strength, strength.weakest, "grip", limits.grip_force_n, strength.grip_safety_factor),
        ),
        Check(
            "bone.safety_factor.shock", strength.shock_safety_factor, limits.min_shock_factor, "", "at least",
            _warn_of_load(strength, strength.at_shock, "shock", limits.shock_force_n, strength.shock_safety_factor),
        ),
    ]  # fmt: skip
    if strength.material.process != "fdm" or limits.print_direction != "upright":
        # The design sets no limit for a material that it is not made for: the check can only warn.
        factor = filament_grip_factor(design, strength)
        warning = _warn_of_filament(design, strength, factor)
        checks.append(Check(FILAMENT_CHECK, factor, 0.0, "", "at least", warning))
    return tuple(checks)


def filament_grip_factor(design: Design, strength: BoneStrength) -> float:
    """Compute the safety factor at the grip of a bone from the plate for filament printers, on which it stands."""
    return _grip_factor(design, strength, _find_filament())


def _find_filament() -> PrintMaterial:
    """Find the strongest filament of the catalogue across its layers."""
    filaments = [material for material in PRINT_MATERIALS.values() if material.process == "fdm"]
    return max(filaments, key=lambda material: material.across_mpa)


def _grip_factor(design: Design, strength: BoneStrength, material: PrintMaterial) -> float:
    """Safety factor at the grip of a bone that is printed upright from a material."""
    return material.across_mpa / strength.weakest.stress_per_n / design.strength.grip_force_n


def _warn_of_load(strength: BoneStrength, place: Weakness, load: str, force_n: float, factor: float) -> str:
    """Warn of a load at which the bone is expected to break; nothing to say from a factor of 1 on."""
    if factor >= _BREAKS_BELOW:
        return ""
    held = _round_down(force_n * factor)
    return (
        f"the bone is expected to break at strength.{load}_force_n = {force_n:g} N: its safety factor is {factor:.2f} "
        f"in {strength.material.label} (strength.print_material), at the {place.place} at z = {place.z_mm:.1f} mm "
        f"under a load at the {place.load}. It holds {held:g} N: keep harder loads off, and set "
        f"strength.{load}_force_n={held:g} if there are none; strength.min_{load}_factor=1 makes the check fail."
    )


def _warn_of_filament(design: Design, strength: BoneStrength, factor: float) -> str:
    """Warn of a bone that breaks at the grip if it is printed from filament; nothing to say otherwise."""
    if factor >= _BREAKS_BELOW:
        return ""
    force = design.strength.grip_force_n
    strong = [
        material.name
        for material in PRINT_MATERIALS.values()
        if _grip_factor(design, strength, material) >= max(_BREAKS_BELOW, design.strength.min_grip_factor)
    ]
    remedy = f"print it from {' or '.join(strong)}" if strong else "no print material in the catalogue is strong enough"
    return (
        f"plate_fdm gives a bone for trying the fit only: in {_find_filament().label}, upright as it stands there, its "
        f"safety factor is {factor:.2f}, and it is expected to break at {_round_down(force * factor):g} N, below "
        f"strength.grip_force_n = {force:g} N. For a finger that grips, {remedy}. The mold halves of the plate are "
        "for use."
    )


def _round_down(force_n: float) -> float:
    """Round a force down to two digits [N]."""
    step = 10.0 ** (math.floor(math.log10(force_n)) - 1)
    return float(f"{math.floor(force_n / step) * step:.6g}")
