"""The `Check` record with the parameters to change if it fails, and checks of the distance between two solids."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.design.geometry.solids import Box, Solid, difference
from fingertip.foundation.comparison import Comparison
from fingertip.foundation.files import round_for_output

_BUG = ()
"""A design that the rules accept never fails these checks: it would be a fault of the program."""

_CAUSES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("*.build_volume_excess", ("printer.bed_x_mm", "printer.bed_y_mm", "printer.bed_z_mm", "skin.length_mm")),
    ("plate.bed_excess", ("printer.bed_x_mm", "printer.bed_y_mm", "printer.bed_z_mm", "skin.length_mm")),
    ("plate.*", _BUG),
    ("*.overhang", ("bone.groove_depth_mm", "bone.platform_mm", "skin.bump_height_mm", "bone.interface")),
    ("skin.min_thickness", ("skin.thickness_side_mm", "bone.palmar_fullness", "skin.min_thickness_mm")),
    ("skin.fitting_stretch", ("bone.groove_depth_mm", "mold.core_inset_mm")),
    ("pad.turn_on_force", ("sensor.distance_from_tip_mm", "bone.collar_inset_mm", "skin.crown_radius_mm")),
    ("pad.rest_force", ("skin.bump_height_mm", "skin.bump_radius_mm")),
    ("mold.palmar_error", ("printer.surface_error_mm", "skin.thickness_palmar_mm")),
    ("mold.plunge_pressure", ("silicone.product", "silicone.viscosity_pa_s")),
    ("mold.core_bending", ("silicone.product", "silicone.viscosity_pa_s")),
    ("mold.creep", ("printer.surface_error_mm", "silicone.product", "silicone.viscosity_pa_s")),
    ("mold.seat_film", ("silicone.product", "silicone.viscosity_pa_s")),
    ("mold.trapped_air", ("skin.bump_height_mm", "bone.groove_depth_mm")),
    ("mold.wall", ("mold.wall_mm", "mold.engraving_depth_mm")),
    ("bone.wall.channel*", ("bone.channel_diameter_mm", "bone.wall_mm")),
    ("bone.wall.sensor*", ("bone.rim_mm", "bone.wall_mm", "skin.width_mm")),
    ("bone.wall.pin*", ("hand.pin_diameter_mm", "hand.clearance_radius_mm")),
    ("bone.wall.socket*", ("bone.socket_diameter_mm", "bone.socket_depth_mm")),
    ("bone.wall.cheek", ("hand.width_mm",)),
    ("bone.wall.tongue", ("hand.width_mm",)),
    ("joint.tendon_overlap", ("hand.tendon_distance_mm", "hand.tendon_diameter_mm")),
    ("joint.*", ("hand.travel_deg", "bone.joint_clearance_mm", "hand.clearance_radius_mm")),
    ("sensor.pocket_clearance", ("sensor.clearance_mm", "sensor.adhesive_thickness_mm")),
    ("sensor.[rvw]*", ("sensor.clearance_mm", "bone.channel_diameter_mm", "bone.base_length_mm")),
    ("sensor.*", ("sensor.distance_from_tip_mm", "bone.base_length_mm")),
    (
        "bone.safety_factor.*",
        ("sensor.model", "bone.base_length_mm", "skin.length_mm", "skin.width_mm", "strength.print_material"),
    ),
    ("hand_stub.*", ("hand.travel_deg", "hand.axis_height_mm", "hand.tendon_distance_mm")),
    ("stand.*", ("printer.surface_error_mm", "printer.offset_mm", "bone.cross_bolt_diameter_mm")),
    *((pattern, _BUG) for pattern in ("*.stl.*", "*.3mf.*", "*.step.*", "step.*", "volume_balance.*", "overlap.*")),
    *((pattern, _BUG) for pattern in ("skin.surface_deviation", "mold.*", "demolding_overlap.*")),
)
"""Pattern of names, and parameters; the first pattern that matches counts."""


def list_causes(check: str) -> tuple[str, ...]:
    """List the parameters behind a failing check; none if it were a fault of the program. Raises LookupError."""
    for pattern, parameters in _CAUSES:
        if fnmatchcase(check, pattern):
            return parameters
    raise LookupError(check)


VOLUME_TOLERANCE_MM3 = 1e-3
"""Largest volume that counts as zero [mm3]. Rounding 10 000 mm2 of surface to a grid of 8 nm stays below it."""
PLANE_OFFSET_MM = 0.02
"""Distance of a cut from a plane on which solids end [mm]. In the plane itself they would touch."""


_REACH_GROWTH = 1.25
"""Factor from one search for a distance to the next. The time of a search grows with about the cube of its reach."""
_MIN_REACH_MM = 0.1
"""Reach of a search for a distance of nothing or less, which a coarse mesh leaves of a limit [mm]."""
_MAX_REACH_MM = 500.0
"""Reach of a search that exceeds the size of every design [mm]."""


@dataclass(frozen=True)
class Check(Comparison):
    """Verified property of a built part."""

    remedy: str = ""
    """Settings with which the check passes if it fails, joined by --set; empty if none is known."""
    is_beyond: bool = False
    """True if the value was looked for up to the limit only, and is larger."""

    @classmethod
    def zero_volume(cls, name: str, volume_mm3: float) -> Check:
        return cls(name, volume_mm3, VOLUME_TOLERANCE_MM3, "mm3")

    @classmethod
    def min_distance(cls, name: str, first: Manifold, second: Manifold, min_mm: float) -> Check:
        """Check that two solids are at least `min_mm` apart: on both sides of a wall, they give its thickness."""
        return cls(name, measure_gap(first, second, 2.0 * min_mm), min_mm, "mm", "at least")

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of this check in report.json."""
        return {
            "name": self.name,
            "value": round_for_output(self.value),
            "limit": round_for_output(self.limit),
            "unit": self.unit,
            "relation": self.relation,
            "passed": self.passed,
            **({} if self.passed else {"change": [*list_causes(self.name)]}),
        }


def count_checks(checks: Sequence[Check]) -> str:
    """Say how many checks failed, or that all passed."""
    failed = sum(not check.passed for check in checks)
    return f"{failed} of {len(checks)} checks failed" if failed else f"all {len(checks)} checks passed"


def measure_gap(first: Manifold, second: Manifold, first_reach_mm: float) -> float:
    return search_distance(lambda reach_mm: first.min_gap(second, reach_mm), first_reach_mm)


def search_distance(measure: Callable[[float], float], first_reach_mm: float) -> float:
    """Measure a distance [mm] by a search that takes longer the farther it reaches. Units: `measure` [mm]."""
    reach_mm = max(first_reach_mm, _MIN_REACH_MM)
    while (distance := measure(reach_mm)) >= reach_mm and reach_mm < _MAX_REACH_MM:
        reach_mm *= _REACH_GROWTH
    return distance


def complement(evaluator: MeshEvaluator, solid: Solid) -> Manifold:
    """Evaluate the complement of a solid within a box that extends past it on all sides by the solid's width."""
    inner = evaluator.manifold(solid)
    low_x, low_y, low_z, high_x, high_y, high_z = inner.bounding_box()
    margin = high_x - low_x
    box = Box((low_x - margin, low_y - margin, low_z - margin), (high_x + margin, high_y + margin, high_z + margin))
    return evaluator.manifold(difference(box, solid))


def above_z(solid: Manifold, z: float) -> Manifold:
    """Cut off everything below the height `z` [mm]."""
    return solid.trim_by_plane((0.0, 0.0, 1.0), z)
