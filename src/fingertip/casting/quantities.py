"""Quantities of a casting: silicone to mix, from the volume that the mold holds, and how the skin and the mold hold."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import insert, mold
from fingertip.cad.verification.lying_skin import pull_off_n
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.design.geometry.cup_layout import POURED
from fingertip.design.geometry.solids import intersection, union
from fingertip.filling.mold_filling import MAX_AIR_MM3, injected_cm3, place_vents, predict_mold_filling

WASTE_FRACTION = 0.25
"""Extra silicone as a fraction of what the mold holds. It stays on cup, stirrer and syringe. A project
choice."""
_LOAD_RATIO = 1.5
"""Silicone in the syringe over what the mold takes: some stays in the nozzle, and some leaves through the vents."""
SCALE_G = 0.01
"""Step of the scale that weighs the components [g]."""
MIN_COMPONENT_G = 1.0
"""Minimum mass of the lighter component [g]. A scale that is off by one step errs by 1 %, and so does the ratio."""
MIN_MIX_G = 10.0
"""Minimum mass of a mixture [g]. Some 0.5 g stays unstirred on cup and stirrer, 5 % of this. An assumption."""


@dataclass(frozen=True)
class SiliconeVolumes:
    """Silicone in the closed mold [cm3]."""

    skin_cm3: float
    """Volume of the cavity minus the insert that the skin is cast around."""
    runners_cm3: float
    """Volume of sprue, runner and vents, filled up to the mold's face or to the nozzle; of a cup, what is
    poured beyond the skin and overflows."""
    gap_cm3: float
    """Volume of the clearance around the base in its recess. It fills only if the fit leaks, and then leaves flash.
    Extra silicone in the cup is cheaper than a void in the skin."""

    @property
    def total_cm3(self) -> float:
        return self.skin_cm3 + self.runners_cm3 + self.gap_cm3


@dataclass(frozen=True)
class Batch:
    """Quantities for one mixing cup [g]."""

    in_mold_g: float
    with_waste_g: float
    """Mass with the extra silicone that stays on cup, stirrer and syringe."""
    total_g: float
    """Mass to mix; more than `with_waste_g` if that is below `smallest_batch_g`."""
    a_g: float
    b_g: float


def measure_volumes(design: Design, evaluator: MeshEvaluator) -> SiliconeVolumes:
    """Measure the silicone volumes of a design's mold, on meshes of the evaluator's tolerance. Raises GeometryError."""
    if design.mold.method == "plunge":
        room, core = (evaluator.manifold(each(design)) for each in (insert.cavity, insert.mold_insert))
        skin_cm3 = float(room.volume() - (room ^ core).volume()) / 1000.0
        return SiliconeVolumes(skin_cm3, (POURED - 1.0) * skin_cm3, 0.0)
    block, cavity = evaluator.manifold(mold.block(design)), evaluator.manifold(insert.cavity(design))
    held = evaluator.manifold(insert.mold_insert(design))
    openings = evaluator.manifold(union(*mold.runners(design)))
    hollow = evaluator.manifold(intersection(mold.cast_hollow(design), mold.block(design)))
    hollow_mm3 = hollow.volume() - (hollow ^ held).volume()
    skin_mm3 = cavity.volume() - (cavity ^ held).volume()
    openings_mm3 = ((openings ^ block) - cavity).volume()
    gap_mm3 = max(0.0, hollow_mm3 - skin_mm3 - openings_mm3)
    return SiliconeVolumes(skin_mm3 / 1000.0, openings_mm3 / 1000.0, gap_mm3 / 1000.0)


def volumes_data(volumes: SiliconeVolumes) -> dict[str, float]:
    """Round the volumes so that the parts add up to the total: the last hundredths go where most was cut off."""
    parts = {"skin": volumes.skin_cm3, "runners": volumes.runners_cm3, "gap": volumes.gap_cm3}
    total = round(100.0 * volumes.total_cm3)
    hundredths = {name: math.floor(100.0 * volume + 1e-9) for name, volume in parts.items()}
    left = total - sum(hundredths.values())
    for name in sorted(parts, key=lambda name: hundredths[name] - 100.0 * parts[name])[:left]:
        hundredths[name] += 1
    return {**{name: count / 100.0 for name, count in hundredths.items()}, "total": total / 100.0}


def mass_g(silicone: Silicone, volume_cm3: float) -> float:
    """Mass [g] of a volume [cm3], at the upper end of the density range."""
    return silicone.density_g_cm3.high * volume_cm3


def is_ratio_assumed(silicone: Silicone) -> bool:
    """Return whether a ratio by volume is taken by weight, because the densities of the components are not known."""
    return silicone.ratio_by == "volume" and _component_densities(silicone) is None


def parts_by_weight(silicone: Silicone) -> tuple[float, float]:
    """Return the mix ratio by weight; one by volume is converted, or taken as it is: see `is_ratio_assumed`."""
    a, b = silicone.parts_a.low, silicone.parts_b.low
    densities = _component_densities(silicone)
    if silicone.ratio_by != "volume" or densities is None:
        return a, b
    return a * densities[0], b * densities[1]


def split_by_mix_ratio(silicone: Silicone, total_g: float) -> tuple[float, float]:
    """Split a total mass [g] into the masses of both components [g]."""
    a, b = parts_by_weight(silicone)
    fraction_b = b / (a + b)
    return total_g * (1.0 - fraction_b), total_g * fraction_b


def load_cm3(design: Design) -> float:
    """Compute the silicone to load into the syringe [cm3]; 0 for a cup, into which it is poured."""
    if design.mold.method == "plunge":
        return 0.0
    return min(_LOAD_RATIO * injected_cm3(predict_mold_filling(design)), design.mold_layout.inlet.syringe.load_cm3)


def bubble_rise_mm_per_min(viscosity_pa_s: float) -> float:
    """Compute how far a bubble of 2 mm rises in a minute by Stokes' law, as a rigid sphere in 1.1 g/cm3 [mm]."""
    return 60e3 * 2.0 / 9.0 * 1100.0 * 9.81 * 1e-6 / viscosity_pa_s


def compute_batch(silicone: Silicone, volume_cm3: float, load_cm3: float = 0.0) -> Batch:
    """Compute what to mix for a volume [cm3], or a syringe's load if that is more: with waste, and enough to weigh."""
    in_mold_g = mass_g(silicone, volume_cm3)
    with_waste_g = max(in_mold_g, mass_g(silicone, load_cm3)) * (1.0 + WASTE_FRACTION)
    total_g = max(with_waste_g, smallest_batch_g(silicone))
    return Batch(in_mold_g, with_waste_g, total_g, *split_by_mix_ratio(silicone, total_g))


def smallest_batch_g(silicone: Silicone) -> float:
    """Compute the smallest mass to mix [g]: the larger of what can be stirred and what can be weighed."""
    return max(MIN_MIX_G, MIN_COMPONENT_G / min(split_by_mix_ratio(silicone, 1.0)))


def _component_densities(silicone: Silicone) -> tuple[float, float] | None:
    """Densities of both components [g/cm3], each the middle of its range; None if one of them is not known."""
    a, b = silicone.density_a_g_cm3, silicone.density_b_g_cm3
    return ((a.low + a.high) / 2, (b.low + b.high) / 2) if a and b else None


# Force that pulls the skin off the bone, where a groove holds it. A thin ring of silicone is stretched: p = E e t / R,
# with the strain e, the thickness t and the radius R (thin-walled cylinder). Over the groove the ring climbs a flank of
# 45 degrees without friction, so the pull is the force that presses it together. Adhesion is left out: it depends on
# how clean the bone is.


def skin_pull_off_n(design: Design, silicone: Silicone) -> float:
    """Estimate the pull-off force of the skin [N], with the lowest modulus of the silicone; 0 if nothing but adhesion
    holds it."""
    if design.mold.method == "plunge":
        return pull_off_n(design)
    section, bone, skin = design.dimensions.bone_outline.section, design.bone, design.skin
    radius = (section.half_width + (section.dorsal + design.dimensions.flat_depth) / 2) / 2
    thickness = min(skin.thickness_side_mm, skin.thickness_dorsal_mm)
    pressure = silicone.modulus_mpa.low * (bone.groove_depth_mm / radius) * thickness / radius
    return pressure * math.tau * radius * bone.groove_width_mm


# Pose of the mold while it fills: how far it may tilt before more air stays beside the first vent than the check lets
# pass. Near the vent the cavity is a paraboloid with the curvatures k and K. Tilted by a small angle t, the highest
# point lies t^2 / (2 k) above the vent, and the cap above the vent holds pi h^2 / sqrt(k K) of air.

_STEP_MM = 0.2
"""Step of the slopes and curvatures of the cavity [mm]."""
_RESERVE = 2.0
"""Factor by which the cap of the paraboloid stays below the limit: away from the vent a cavity is flatter than that."""


def pose_tolerance_deg(design: Design) -> float | None:
    """Compute the angle by which the mold may tilt out of its pose [degrees]; None unless its first vent is dorsal.

    The bone below the cap takes some of its room, so that less air than that stays.
    """
    vent, height = place_vents(design)[0], design.dimensions.outer.dorsal_height_at
    x, y, z = vent.point_mm
    if vent.kind != "dorsal" or y <= 0.0:
        return None
    step = _STEP_MM
    middle, right, left = height(x, z), height(x + step, z), height(x - step, z)
    above, below = height(x, z + step), height(x, z - step)
    corners = (
        height(x + step, z + step)
        - height(x + step, z - step)
        - height(x - step, z + step)
        + height(x - step, z - step)
    )
    slope_x, slope_z = (right - left) / (2 * step), (above - below) / (2 * step)
    bent_x, bent_z = (right - 2 * middle + left) / step**2, (above - 2 * middle + below) / step**2
    twist = corners / (4 * step**2)
    # Mean and Gaussian curvature of a surface that is given by its height.
    squared = 1.0 + slope_x**2 + slope_z**2
    gaussian = (bent_x * bent_z - twist**2) / squared**2
    mean = -((1.0 + slope_z**2) * bent_x - 2.0 * slope_x * slope_z * twist + (1.0 + slope_x**2) * bent_z) / (
        2.0 * squared**1.5
    )
    flattest = mean - math.sqrt(max(0.0, mean**2 - gaussian))
    if flattest <= 0.0:
        return None
    return math.degrees((4.0 * MAX_AIR_MM3 / _RESERVE * flattest**2 * math.sqrt(gaussian) / math.pi) ** 0.25)
