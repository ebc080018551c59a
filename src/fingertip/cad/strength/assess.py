"""Safety factor of the bone, by beam theory on cross-sections of its mesh.

The bone is a cantilever that is loaded at the pad's centre, at the apex and from the side. A post is held along its
length: the bending moment falls there from its root, in proportion to the distance, to nothing at its end. So it does
along the bore of a socket, from its bottom to its mouth. A flange is a plate that bends between base and bolts. The
eyes of a clevis carry all of it as far as the pin, and the joint beyond has a module of its own.

At each cross-section all load distal to it gives a normal force and two bending moments, and these a stress at every
corner of the section. The stress is linear in the load, so its largest value over all directions of the load is the
length of a vector: no direction is missed, and none is assumed.

Not included: shear and torsion, the skin (too soft to carry anything), creep, fatigue, defects of the print.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.strength.stress import (
    Section,
    hole_in_tension,
    measure_section,
    shoulder_in_bending,
    stress_joint,
    tendon_force_per_n,
)
from fingertip.catalogues.print_materials import PRINT_MATERIALS, PrintMaterial
from fingertip.design import Design
from fingertip.design.geometry.features import Joint
from fingertip.foundation.files import round_for_output
from fingertip.foundation.numerics import Array

STATIONS = 160
"""Number of cross-sections."""
WANTED_AT_GRIP, WANTED_AT_SHOCK = 2.0, 1.2
"""Safety factors below which a build warns."""


@dataclass(frozen=True)
class LoadPoint:
    """Point at which the finger is loaded."""

    name: str
    position_mm: tuple[float, float, float]


@dataclass(frozen=True)
class Weakness:
    """Place and load at which the bone breaks first."""

    load: str
    """Name of the load point."""
    z_mm: float
    """Height of the cross-section."""
    place: str
    """Name of what breaks there."""
    stress_per_n: float
    """Largest tensile stress per newton of load in the worst direction, with stress concentration [MPa/N]."""
    concentration: float
    """Stress concentration factor that it contains."""
    direction: tuple[float, float, float]
    """Worst direction of the load."""
    at_shock: bool = True
    """False for what a shock does not load."""


@dataclass(frozen=True)
class BoneStrength:
    """Safety factors of a bone."""

    material: PrintMaterial
    weakest: Weakness
    by_load: tuple[Weakness, ...]
    """Weakest place for each load point."""
    at_shock: Weakness
    """Weakest place of those that a shock loads."""
    grip_safety_factor: float
    """Strength over the stress at the load of a firm grip."""
    shock_safety_factor: float
    """Strength over the stress at the load of a fall or knock."""
    tendon_force_n: float
    """Force of the tendon at the grip force on the apex; 0 without a tendon."""


def list_load_points(design: Design) -> tuple[LoadPoint, ...]:
    """Pad centre over the sensor, apex, and side of the finger at the sensor's height."""
    dims, skin = design.dimensions, design.skin
    scale = dims.outer.scale_at(dims.sensor_z)
    return (
        LoadPoint("pad centre", (0.0, -skin.semi_axis_palmar_mm * scale, dims.sensor_z)),
        LoadPoint("apex", (0.0, 0.0, skin.length_mm)),
        LoadPoint("side", (skin.width_mm / 2 * scale, 0.0, dims.sensor_z)),
    )


def assess_strength(design: Design, evaluator: MeshEvaluator) -> BoneStrength:
    """Find the weakest place of the bone, and its safety factors. Raises GeometryError."""
    material = PRINT_MATERIALS[design.strength.print_material]
    sections = [(z, section, _find_concentration(design, z)) for z, section in _cut(design, evaluator)]
    places = [
        [
            *_find_weakest_section(design, point, [cut for cut in sections if cut[0] < point.position_mm[2]]),
            *((_bend_flange(design, point),) if design.bone.interface == "flange" else ()),
            *_load_joint(design, point),
        ]
        for point in list_load_points(design)
    ]
    by_load = tuple(_find_weakest(found) for found in places)
    weakest = _find_weakest(by_load)
    at_shock = _find_weakest(place for found in places for place in found if place.at_shock)
    strength = material.across_mpa if design.strength.print_direction == "upright" else material.strength_mpa
    grip, shock = design.strength.grip_force_n, design.strength.shock_force_n
    return BoneStrength(
        material, weakest, by_load, at_shock,
        strength / weakest.stress_per_n / grip, strength / at_shock.stress_per_n / shock,
        grip * tendon_force_per_n(design, design.skin.length_mm),
    )  # fmt: skip


def _find_weakest(places: Iterable[Weakness]) -> Weakness:
    """Find the place with the largest stress per newton."""
    return max(places, key=lambda weakness: weakness.stress_per_n)


def _load_joint(design: Design, point: LoadPoint) -> Iterator[Weakness]:
    """List the places of a clevis that a load at a point stresses, in the plane in which the finger bends."""
    for found in stress_joint(design, point.position_mm[2]):
        yield Weakness(
            point.name,
            found.z_mm,
            found.place,
            found.stress_per_n,
            found.concentration,
            (0.0, 1.0, 0.0),
            found.at_shock,
        )


def _cut(design: Design, evaluator: MeshEvaluator) -> Iterator[tuple[float, Section]]:
    """Cut the bone from its proximal end to the rounded tip, which the skin around it loads as a whole."""
    solid = evaluator.manifold(PARTS["bone"].solid(design))
    low, high = solid.bounding_box()[2], design.dimensions.taper_end_z
    if design.bone.interface == "flange":
        low += design.bone.flange_thickness_mm  # the flange itself is a plate, no beam
    if design.dimensions.joint:
        # Past the pin only the joint's own forces act, which are assessed for themselves.
        low = design.dimensions.joint.axis_z + design.dimensions.joint.pin_radius
    for i in range(STATIONS):
        z = low + (i + 0.5) * (high - low) / STATIONS
        section = measure_section([np.asarray(polygon) for polygon in solid.slice(z).to_polygons()])
        if section:
            yield z, section


def _find_weakest_section(design: Design, point: LoadPoint, cuts: Sequence[_CutPlane]) -> Iterator[Weakness]:
    """Find the section with the largest stress that a load at a point gives; none without sections."""

    def largest(cut: _CutPlane) -> float:
        return math.sqrt((_raise_gradients(design, point, *cut)[1] ** 2).sum(axis=1).max())

    if cuts:
        yield _find_stress(design, point, *max(cuts, key=largest))


def _find_stress(design: Design, point: LoadPoint, z: float, section: Section, factors: _Factors) -> Weakness:
    """Find the largest stress that a load at a point gives in a section, over all directions of the load."""
    plain, gradients = _raise_gradients(design, point, z, section, factors)
    sizes = np.linalg.norm(gradients, axis=1)
    worst = int(sizes.argmax())
    direction = gradients[worst] / sizes[worst]
    x, y, along = (round(float(value), 6) + 0.0 for value in direction)
    factor = float(sizes[worst] / np.linalg.norm(plain[worst]))
    return Weakness(point.name, z, "cross-section", float(sizes[worst]), factor, (x, y, along))


def _raise_gradients(
    design: Design, point: LoadPoint, z: float, section: Section, factors: _Factors
) -> tuple[Array, Array]:
    """Stress at each corner of a section per newton in x, y and z, without and with stress concentration [MPa/N]."""
    plain = stress_gradients(section, np.array(point.position_mm), z, _find_moment_share(design, z))
    # A load in x bends the section in its width, one in y in its height. One in z bends it in both.
    return plain, plain * [factors.width, factors.height, max(factors.width, factors.height)]


def stress_gradients(section: Section, point_mm: Array, z_mm: float, moment_share: float = 1.0) -> Array:
    """Stress at each corner of a section per newton in x, y and z of a load at a point, (corners, 3) [MPa/N]."""
    x, y, z = (float(value) for value in point_mm - np.array([*section.centroid_mm, z_mm]))
    # Columns: the moment r x F of a unit force along each axis, turned into the bending of the section along x and y.
    bending = np.array([[-z, 0.0, x], [0.0, -z, y]])
    gradients: Array = section.edge_mm @ (moment_share * (section.inverse_second_per_mm4 @ bending))
    gradients[:, 2] += 1.0 / section.area_mm2
    return gradients


def _find_moment_share(design: Design, z: float) -> float:
    """Fraction of the bending moment that a section of the interface carries, because the phalanx holds it."""
    bone = design.bone
    end = -bone.base_length_mm
    if bone.interface == "post":
        return min(1.0, max(0.0, (z - end) / bone.post_length_mm + 1.0))
    if bone.interface == "socket":
        return min(1.0, max(0.0, (z - end) / bone.socket_depth_mm))
    return 1.0


@dataclass(frozen=True)
class _Factors:
    """Stress concentration factors of a section that is bent in its width and in its height."""

    width: float = 1.0
    height: float = 1.0

    def combined_with(self, other: _Factors) -> _Factors:
        return _Factors(max(self.width, other.width), max(self.height, other.height))


_CutPlane: TypeAlias = tuple[float, Section, _Factors]
"""Height of a section [mm], the section, and the stress concentration there."""


def _find_concentration(design: Design, z: float) -> _Factors:
    """Find the stress concentration factors of the bone at a height.

    A shoulder acts about half the height of the thinner side far. The collar is one on both sides.
    """
    dims, bone = design.dimensions, design.bone
    end, fillet = -bone.base_length_mm, design.strength.root_fillet_mm
    section, collar = dims.bone_outline.section, dims.collar.section
    base, body = ((2 * section.half_width, section.dorsal + flat) for flat in (dims.base_flat_depth, dims.flat_depth))
    factors, step = _Factors(), (2 * collar.half_width, collar.palmar + collar.dorsal)
    if 0.0 <= z <= min(body) / 2:
        factors = _at_shoulder(step, body, fillet)
    reach = min(base) / 2
    if -bone.collar_length_mm - reach <= z <= -bone.collar_length_mm:
        factors = _at_shoulder(step, base, fillet)
    if bone.interface == "flange":
        root = end + bone.flange_thickness_mm
        if root <= z <= root + reach:
            factors = factors.combined_with(_at_shoulder((bone.flange_width_mm, bone.flange_height_mm), base, fillet))
        return factors
    if joint := dims.joint:
        if joint.shoulder_z - joint.eye_radius / 2 <= z <= joint.shoulder_z:
            factors = factors.combined_with(_at_shoulder(base, _eye_sizes(design, joint), fillet))
        return factors
    if bone.interface == "post":
        across = min(bone.post_height_mm, bone.post_width_mm)
        if end - across / 2 <= z <= end:
            factors = factors.combined_with(_at_shoulder(base, (bone.post_width_mm, across), fillet))
    else:
        across = bone.socket_diameter_mm + 2 * bone.wall_mm
    if abs(z - dims.cross_bolt_z) <= bone.cross_bolt_diameter_mm / 2:
        hole = hole_in_tension(bone.cross_bolt_diameter_mm, across)
        factors = factors.combined_with(_Factors(hole, hole))
    return factors


def _eye_sizes(design: Design, joint: Joint) -> tuple[float, float]:
    """Width and height of the eyes at their root [mm]: as high as the base if they have stops."""
    dims = design.dimensions
    section = dims.bone_outline.section
    height = section.dorsal + dims.base_flat_depth if joint.travel_deg else 2 * joint.eye_radius
    return (2 * section.half_width if joint.is_fork else 2 * joint.half_width), height


def _at_shoulder(large_mm: tuple[float, float], small_mm: tuple[float, float], fillet_mm: float) -> _Factors:
    """Find the factors of a shoulder, each with the sizes in the direction in which the shaft bends."""
    return _Factors(*(shoulder_in_bending(*sizes, fillet_mm) for sizes in zip(large_mm, small_mm, strict=True)))


def _bend_flange(design: Design, point: LoadPoint) -> Weakness:
    """Find the bending stress of the flange where the base stands on it, which its bolts pull off the phalanx.

    A load from the side or from above is held by a couple: bolts on one side, and bolts or the flange's edge on the
    other. The plate is a cantilever between the couple's line and the base.
    """
    dims, bone = design.dimensions, design.bone
    section = dims.bone_outline.section
    arm = point.position_mm[2] + bone.base_length_mm
    modulus = bone.flange_thickness_mm**2 / 6
    per_n = []
    for spacing, size, base, across in (
        (bone.flange_spacing_x_mm, bone.flange_width_mm, 2 * section.half_width, bone.flange_height_mm),
        (bone.flange_spacing_y_mm, bone.flange_height_mm, section.dorsal + dims.base_flat_depth, bone.flange_width_mm),
    ):
        # Without a second row the flange turns about its edge, and the bolts pull in its middle.
        couple = arm / (spacing if spacing else size / 2)
        lever = max((spacing if spacing else size) - base, 0.0) / 2
        per_n.append(couple * lever / (across * modulus))
    stress = math.hypot(*per_n)
    direction = (round(per_n[0] / stress, 6), round(per_n[1] / stress, 6), 0.0) if stress else (0.0, 1.0, 0.0)
    return Weakness(point.name, -bone.base_length_mm + bone.flange_thickness_mm, "flange", stress, 1.0, direction)


def describe_strength(strength: BoneStrength) -> list[str]:
    """Describe safety factors and weakest place as lines of text."""
    weakest = strength.weakest
    lines = [
        f"bone in {strength.material.label}: safety factor {strength.grip_safety_factor:.2f} at the grip force, "
        f"{strength.shock_safety_factor:.2f} at the shock; weakest at the {weakest.place} at z = {weakest.z_mm:.1f} mm "
        f"under a load at the {weakest.load}"
    ]
    if strength.grip_safety_factor < WANTED_AT_GRIP or strength.shock_safety_factor < WANTED_AT_SHOCK:
        lines.append(
            f"warning: {WANTED_AT_GRIP:g} and {WANTED_AT_SHOCK:g} are wanted; a larger "
            "interface, a shorter finger or a stronger material raises them"
        )
    return lines


def strength_data(strength: BoneStrength) -> dict[str, Any]:
    """Return the entry of report.json."""
    weakest = strength.weakest
    return {
        "material": strength.material.name,
        "strength_mpa": strength.material.strength_mpa,
        "strength_verified": "strength_mpa" in strength.material.verified,
        "grip_safety_factor": round_for_output(strength.grip_safety_factor),
        "shock_safety_factor": round_for_output(strength.shock_safety_factor),
        "tendon_force_n": round_for_output(strength.tendon_force_n),
        "weakest": {
            "load": weakest.load,
            "place": weakest.place,
            "z_mm": round_for_output(weakest.z_mm),
            "stress_concentration": round_for_output(weakest.concentration),
            "stress_mpa_per_n": round_for_output(weakest.stress_per_n),
            "direction": list(weakest.direction),
        },
    }
