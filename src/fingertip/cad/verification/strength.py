"""Loads that the bone holds, by beam theory on cross-sections of its mesh.

The bone is a cantilever that is loaded at the pad's centre, at the apex and from the side. Its
interface brings its own stresses, and the share of the bending moment that it carries
(`fingertip.design.interfaces`).

At each cross-section all load distal to it gives a normal force and two bending moments, and these
a stress at every corner of the section. The stress is linear in the load, so its largest value over
all directions of the load is the length of a vector: no direction is missed, and none is assumed.

Not included: shear and torsion, the skin (too soft to carry anything), creep, fatigue, defects of
the print.

Areas, first and second moments of polygons follow from Green's theorem (C. Steger, On the
calculation of arbitrary moments of polygons, TU Munich FGBV-96-05, 1996).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Any, TypeAlias

import numpy as np

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.design import Design
from fingertip.design.formulas.stress_and_knock import (
    AT_CORNER,
    CORNER_REACH_MM,
    PIN,
    PRESSED_N,
    LocalStress,
    Springs,
    StressFactors,
)
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.clevis import tendon_force_per_n
from fingertip.design.parameters.bone_and_mold import Strength
from fingertip.foundation.files import round_for_output
from fingertip.foundation.numerics import Array
from fingertip.models.parts import PARTS
from fingertip.models.solids import Point3
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import REFERENCE_POSE

STATIONS = 160
AT_CHANNEL_MOUTH = 2.7
"""Stress concentration at the channel's mouth.
Own finite elements (tests/cad/test_bone_elements.py): 2.5 to 2.7.
"""


@dataclass(frozen=True, eq=False)
class Section:
    """Cross-section of a beam along z; second moments are about its centroid."""

    area_mm2: float
    centroid_mm: tuple[float, float]
    second_xx_mm4: float
    """Integral of y^2 [mm4], which resists bending about x."""
    second_yy_mm4: float
    """Integral of x^2 [mm4], which resists bending about y."""
    second_xy_mm4: float
    """Integral of x y [mm4]; 0 for a section that is symmetric to an axis."""
    edge_mm: Array
    """Corners of the outline, (corners, 2), from the centroid [mm].
    Bending stress is largest at one of them.
    """

    @cached_property
    def inverse_second_per_mm4(self) -> Array:
        """Inverse of the matrix of second moments, (2, 2) [1/mm4]."""
        xx = self.second_xx_mm4
        yy = self.second_yy_mm4
        xy = self.second_xy_mm4

        return np.array([[xx, -xy], [-xy, yy]]) / (xx * yy - xy * xy)


def measure_section(polygons: Sequence[Array]) -> Section | None:
    """Measure a section bounded by polygons: outlines counter-clockwise, holes clockwise.

    None if it has no area.
    """
    area = sx = sy = xx = yy = xy = 0.0
    for polygon in polygons:
        x = polygon[:, 0]
        y = polygon[:, 1]
        u = np.roll(x, -1)
        v = np.roll(y, -1)
        cross = x * v - u * y
        area += float(cross.sum()) / 2
        sx += float(((x + u) * cross).sum()) / 6
        sy += float(((y + v) * cross).sum()) / 6
        xx += float(((y * y + y * v + v * v) * cross).sum()) / 12
        yy += float(((x * x + x * u + u * u) * cross).sum()) / 12
        xy += float(((x * v + 2 * x * y + 2 * u * v + u * y) * cross).sum()) / 24

    if area <= 0.0:
        return None

    cx = sx / area
    cy = sy / area
    corners = np.concatenate([np.asarray(polygon, dtype=np.float64) for polygon in polygons]) - [
        cx,
        cy,
    ]
    return Section(
        area_mm2=area,
        centroid_mm=(cx, cy),
        second_xx_mm4=xx - area * cy * cy,
        second_yy_mm4=yy - area * cx * cx,
        second_xy_mm4=xy - area * cx * cy,
        edge_mm=corners,
    )


@dataclass(frozen=True)
class Weakness(LocalStress):
    """Largest tensile stress of a load in the worst direction, in a cross-section or at a place of
    the interface.
    """

    load: str = ""
    """Name of the point on which the load acts."""


@dataclass(frozen=True)
class Knock:
    """Knock at one place: what gives way to it, and the forces that break the bone and the joint's
    pin.
    """

    weakest: Weakness
    springs: Springs
    bone_n: float
    pin_n: float
    """Infinite without a pin."""

    def safety_factor(self, stated: Strength) -> float:
        """Return the force that breaks the bone over that of the stated knock, which the pin
        limits.
        """
        return self.bone_n / min(
            self.springs.force_n(stated.hand_mass_kg, stated.knock_speed_m_s), self.pin_n
        )

    def held_speed_m_s(self, stated: Strength) -> float:
        """Return the speed up to which the bone has the safety factor that is wanted.

        It is infinite if the pin saves the bone.
        """
        if not stated.min_knock_factor or self.bone_n >= stated.min_knock_factor * self.pin_n:
            return math.inf

        return self.springs.speed_m_s(stated.hand_mass_kg, self.bone_n / stated.min_knock_factor)


@dataclass(frozen=True)
class BoneStrength:
    stated: Strength
    weakest: Weakness
    knock: Knock
    """Knock at the place where the bone has the least safety factor."""
    held_speed_m_s: float
    """Speed up to which it has the safety factor that is wanted at all places."""
    breaks_n: float
    """Least force on the fingertip that breaks bone or pin."""
    knock_m_s: float
    """Speed of the stated mass whose knock on the fingertip breaks bone or pin."""
    tendon_force_n: float
    """Force of the tendon at the grip force on the apex; 0 without a tendon."""

    @property
    def pin_first(self) -> bool:
        return self.weakest.place.startswith(PIN)

    @property
    def grip_safety_factor(self) -> float:
        return self.breaks_n / self.stated.grip_force_n

    @property
    def knock_safety_factor(self) -> float:
        return self.knock.safety_factor(self.stated)

    @property
    def lighter_loads(self) -> dict[str, float]:
        """Loads that the bone holds, rounded down to two digits, in place of those that are stated
        and too heavy.
        """
        stated = self.stated
        loads = dict[str, float]()

        # The least grip of a design is 1 N.
        if self.grip_safety_factor < stated.min_grip_factor <= self.breaks_n:
            loads["strength.grip_force_n"] = _round_down(self.breaks_n / stated.min_grip_factor)
        if self.knock_safety_factor < stated.min_knock_factor:
            loads["strength.knock_speed_m_s"] = _round_down(self.held_speed_m_s)

        return loads


def _round_down(value: float) -> float:
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / step) * step:.6g}")


def list_load_points(design: Design) -> dict[str, Point3]:
    """Pad centre over the sensor, apex, and side of the finger at the sensor's height [mm]."""
    dims = design.dimensions
    skin = design.skin
    return {
        "pad centre": (0.0, -dims.outer.palmar_height_at(0.0, dims.sensor_z), dims.sensor_z),
        "apex": (0.0, 0.0, skin.length_mm),
        "side": (skin.width_mm / 2 * dims.outer.scale_at(dims.sensor_z), 0.0, dims.sensor_z),
    }


def assess_strength(
    design: Design, evaluator: MeshEvaluator, stations: int = STATIONS
) -> BoneStrength:
    """Find the weakest place of the bone, and what it holds. Raises GeometryError."""
    stated = design.strength
    interface = interface_of(design)
    stress = attrgetter("stress_per_n")
    cuts = [
        (z, section, _find_concentration(design, z))
        for z, section in _cut(design, evaluator, stations)
    ]
    (pressed,) = find_contacts(PadForm.of_design(design), REFERENCE_POSE, (PRESSED_N,), math.inf)
    places: list[Weakness] = []
    knocks: list[Knock] = []

    for load, at in list_load_points(design).items():
        proximal = [cut for cut in cuts if cut[0] < at[2]]
        weaknesses = (
            *_find_weakest_section(design, at, proximal),
            *interface.local_stresses(design, at[2]),
        )
        here = [Weakness(**vars(place), load=load) for place in weaknesses]
        worst = max((place for place in here if place.at_knock), key=stress)
        springs = Springs(pressed.depth_mm, _bending_stiffness(design, at[2], proximal))
        held_n = {place.place: stated.material.strength_mpa / place.stress_per_n for place in here}
        knocks.append(Knock(worst, springs, held_n[worst.place], held_n.get(PIN, math.inf)))
        places += here

    weakest = max(places, key=stress)
    return BoneStrength(
        stated=stated,
        weakest=weakest,
        knock=min(knocks, key=lambda knock: knock.safety_factor(stated)),
        held_speed_m_s=min(knock.held_speed_m_s(stated) for knock in knocks),
        breaks_n=stated.material.strength_mpa / weakest.stress_per_n,
        knock_m_s=min(
            knock.springs.speed_m_s(stated.hand_mass_kg, min(knock.bone_n, knock.pin_n))
            for knock in knocks
        ),
        tendon_force_n=stated.grip_force_n * tendon_force_per_n(design, design.skin.length_mm),
    )


def _bending_stiffness(design: Design, load_z: float, cuts: Sequence[_CutPlane]) -> float:
    """Stiffness of the bone under a load from the side on which it is stiffer [N/mm]."""
    step = cuts[1][0] - cuts[0][0]
    interface = interface_of(design)
    bent = np.array([((load_z - z) * interface.moment_share(design, z)) ** 2 for z, _, _ in cuts])
    seconds = np.array([(section.second_xx_mm4, section.second_yy_mm4) for _, section, _ in cuts])

    return float(
        design.strength.material.modulus_mpa / (step * (bent[:, None] / seconds).sum(axis=0).min())
    )


def _cut(
    design: Design, evaluator: MeshEvaluator, stations: int
) -> Iterator[tuple[float, Section]]:
    """Cut the bone from its proximal end to the rounded tip, which the skin around it loads as a
    whole.
    """
    solid = evaluator.manifold(PARTS["bone"].solid(design))
    low = solid.bounding_box()[2]
    high = design.dimensions.taper_end_z
    low = interface_of(design).beam_begin_z(design, low)

    for i in range(stations):
        z = low + (i + 0.5) * (high - low) / stations
        section = measure_section([np.asarray(polygon) for polygon in solid.slice(z).to_polygons()])
        if section:
            yield z, section


def _find_weakest_section(
    design: Design, point: Point3, cuts: Sequence[_CutPlane]
) -> Iterator[LocalStress]:
    """Find the largest stress that a load at a point gives in a section, over all directions of the
    load.
    """

    def largest(cut: _CutPlane) -> float:
        return math.sqrt((_raise_gradients(design, point, *cut)[1] ** 2).sum(axis=1).max())

    if not cuts:
        return

    weakest = max(cuts, key=largest)
    plain, gradients = _raise_gradients(design, point, *weakest)
    sizes = np.linalg.norm(gradients, axis=1)
    worst = int(sizes.argmax())
    x, y, along = (round(float(value), 6) + 0.0 for value in gradients[worst] / sizes[worst])
    factor = float(sizes[worst] / np.linalg.norm(plain[worst]))
    yield LocalStress(
        "cross-section", weakest[0], float(sizes[worst]), factor, direction=(x, y, along)
    )


def _raise_gradients(
    design: Design,
    point: Point3,
    z: float,
    section: Section,
    factors: StressFactors,
) -> tuple[Array, Array]:
    """Stress at each corner of a section per newton in x, y and z, without and with stress
    concentration [MPa/N].
    """
    plain = stress_gradients(
        section, np.array(point), z, interface_of(design).moment_share(design, z)
    )
    # A load in x bends the section in its width, one in y in its height. One in z bends it in both.
    return plain, plain * [factors.width, factors.height, max(factors.width, factors.height)]


def stress_gradients(
    section: Section, point_mm: Array, z_mm: float, moment_share: float = 1.0
) -> Array:
    """Stress at each corner of a section per newton in x, y and z of a load at a point, (corners,
    3) [MPa/N].
    """
    x, y, z = (float(value) for value in point_mm - np.array([*section.centroid_mm, z_mm]))
    # Columns: the moment r x F of a unit force along each axis, turned into the bending of the
    # section along x and y.
    bending = np.array([[-z, 0.0, x], [0.0, -z, y]])
    gradients: Array = section.edge_mm @ (moment_share * (section.inverse_second_per_mm4 @ bending))
    gradients[:, 2] += 1.0 / section.area_mm2

    return gradients


_CutPlane: TypeAlias = tuple[float, Section, StressFactors]
"""Height of a section [mm], the section, and the stress concentration there."""


def _find_concentration(design: Design, z: float) -> StressFactors:
    """Find the stress concentration at a height: beside collar and notches, at the cable channel,
    of the joint.
    """
    dims = design.dimensions
    foot = -design.bone.collar_length_mm
    radius = design.bone.channel_diameter_mm / 2
    factors = StressFactors()
    if foot - CORNER_REACH_MM <= z <= foot or 0.0 <= z <= CORNER_REACH_MM:
        factors = AT_CORNER
    if abs(z - dims.channel_exit_z) <= radius:
        factors = factors.combined_with(StressFactors(height=AT_CHANNEL_MOUTH))

    return factors.combined_with(interface_of(design).stress_factors(design, z))


def describe_loads(strength: BoneStrength) -> str:
    """Say in a sentence what the finger holds."""
    return (
        f"grip: at most {strength.stated.grip_force_n:g} N; breaks at {strength.breaks_n:.0f} N "
        f"({strength.stated.material.label}), or by a knock of {strength.stated.hand_mass_kg:g} kg "
        f"at {strength.knock_m_s:.2f} m/s"
    )


def strength_data(strength: BoneStrength) -> dict[str, Any]:
    """Return the entry of report.json."""
    knock = strength.knock
    stated = strength.stated
    return {
        "loads": {
            "breaks_n": round(strength.breaks_n),
            "knock_m_s": round(strength.knock_m_s, 2),
            "pin_first": strength.pin_first,
            "grip_n": stated.grip_force_n,
            "mass_kg": stated.hand_mass_kg,
        },
        "breaks_at_knock_n": round_for_output(knock.bone_n),
        "material": stated.material.name,
        "strength_mpa": stated.material.strength_mpa,
        "strength_verified": "strength_mpa" in stated.material.verified,
        "grip_safety_factor": round_for_output(strength.grip_safety_factor),
        "knock_safety_factor": round_for_output(strength.knock_safety_factor),
        "pad_mm_at_50_n": round_for_output(knock.springs.pad_mm),
        "bone_n_per_mm": round_for_output(knock.springs.bone_n_per_mm),
        "tendon_force_n": round_for_output(strength.tendon_force_n),
        "weakest": _weakness_data(strength.weakest),
        "weakest_at_knock": _weakness_data(knock.weakest),
    }


def _weakness_data(weakness: Weakness) -> dict[str, Any]:
    return {
        "load": weakness.load,
        "place": weakness.place,
        "z_mm": round_for_output(weakness.z_mm),
        "stress_concentration": round_for_output(weakness.concentration),
        "stress_mpa_per_n": round_for_output(weakness.stress_per_n),
        "direction": list(weakness.direction),
    }
