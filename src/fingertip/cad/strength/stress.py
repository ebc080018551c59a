"""Stress concentration at a shoulder with a fillet, and at a hole.

W. C. Young, R. G. Budynas, A. M. Sadegh, Roark's Formulas for Stress and Strain, 8th ed., 2012, table 17.1.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fingertip.design import Design
from fingertip.design.geometry.features import Joint, TendonAnchor
from fingertip.foundation.numerics import Array

MIN_RATIO, MAX_RATIO = 0.25, 20.0
"""Range of the step's height over the fillet's radius in which the formula holds."""


def shoulder_in_bending(large_mm: float, small_mm: float, fillet_mm: float) -> float:
    """Factor at a shoulder between two round shafts. It multiplies the stress of the thinner one."""
    h = (large_mm - small_mm) / 2
    if h <= 0.0:
        return 1.0
    q = min(max(h / fillet_mm if fillet_mm > 0.0 else math.inf, MIN_RATIO), MAX_RATIO)
    root = math.sqrt(q)
    if q <= 2.0:
        c1, c2 = 0.927 + 1.149 * root - 0.086 * q, 0.015 - 3.281 * root + 0.837 * q
        c3, c4 = 0.847 + 1.716 * root - 0.506 * q, -0.790 + 0.417 * root - 0.246 * q
    else:
        c1, c2 = 1.225 + 0.831 * root - 0.010 * q, -3.790 + 0.958 * root - 0.257 * q
        c3, c4 = 7.374 - 4.834 * root + 0.862 * q, -3.809 + 3.046 * root - 0.595 * q
    s = 2 * h / large_mm
    return max(1.0, c1 + s * (c2 + s * (c3 + s * c4)))


def hole_in_tension(hole_mm: float, width_mm: float) -> float:
    """Factor at a hole in the middle of a flat bar. It multiplies the stress of the section beside the hole.

    In bending, where the stress falls towards the middle, the factor is smaller.
    """
    s = min(hole_mm / width_mm, 1.0)
    return 3.0 - 3.13 * s + 3.66 * s * s - 1.53 * s**3


# Properties of a cross-section, from the polygons that bound it.
#
# Areas, first and second moments of polygons follow from Green's theorem (C. Steger, On the calculation of arbitrary
# moments of polygons, TU Munich FGBV-96-05, 1996).


@dataclass(frozen=True, eq=False)
class Section:
    """Cross-section of a beam along z; second moments are about its centroid."""

    area_mm2: float
    centroid_mm: tuple[float, float]
    """x and y of the centroid [mm]."""
    second_xx_mm4: float
    """Integral of y^2 [mm4], which resists bending about x."""
    second_yy_mm4: float
    """Integral of x^2 [mm4], which resists bending about y."""
    second_xy_mm4: float
    """Integral of x y [mm4]; 0 for a section that is symmetric to an axis."""
    edge_mm: Array
    """Corners of the outline, (corners, 2), from the centroid [mm]. Bending stress is largest at one of them."""

    @cached_property
    def inverse_second_per_mm4(self) -> Array:
        """Inverse of the matrix of second moments, (2, 2) [1/mm4]."""
        xx, yy, xy = self.second_xx_mm4, self.second_yy_mm4, self.second_xy_mm4
        return np.array([[xx, -xy], [-xy, yy]]) / (xx * yy - xy * xy)


def measure_section(polygons: Sequence[Array]) -> Section | None:
    """Measure a section bounded by polygons: outlines counter-clockwise, holes clockwise. None if it has no area."""
    area = sx = sy = xx = yy = xy = 0.0
    for polygon in polygons:
        x, y = polygon[:, 0], polygon[:, 1]
        u, v = np.roll(x, -1), np.roll(y, -1)
        cross = x * v - u * y
        area += float(cross.sum()) / 2
        sx += float(((x + u) * cross).sum()) / 6
        sy += float(((y + v) * cross).sum()) / 6
        xx += float(((y * y + y * v + v * v) * cross).sum()) / 12
        yy += float(((x * x + x * u + u * u) * cross).sum()) / 12
        xy += float(((x * v + 2 * x * y + 2 * u * v + u * y) * cross).sum()) / 24
    if area <= 0.0:
        return None
    cx, cy = sx / area, sy / area
    corners = np.concatenate([np.asarray(polygon, dtype=np.float64) for polygon in polygons]) - [cx, cy]
    return Section(area, (cx, cy), xx - area * cy * cy, yy - area * cx * cx, xy - area * cx * cy, corners)


# Stress of a clevis about its pin, and of the anchor of its tendon.
#
# A load on the fingertip turns it about the pin. On a straight finger a hard stop holds it, and the pin then pulls at
# the ends of the eyes. On a bent one the tendon holds it: it pulls at its anchor, and the eyes press on the pin.
# Forces are those of statics; stresses are nominal ones of a lug with a pin (net section, bearing, shear-out), the
# first with the concentration at a hole.


_SHEAR = math.sqrt(3.0)
"""Tensile stress that is equivalent to a shear stress of 1 (von Mises)."""


@dataclass(frozen=True)
class JointStress:
    """Stress at one place of a clevis per newton of load on the fingertip [MPa/N]."""

    place: str
    z_mm: float
    stress_per_n: float
    concentration: float
    at_shock: bool
    """False for the tendon: its drive is assumed to yield above the tendon force of the grip."""


def tendon_force_per_n(design: Design, load_z_mm: float) -> float:
    """Force of the tendon per newton of load on the pad or apex, by their levers about the pin; 0 without a tendon."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    return (load_z_mm - joint.axis_z) / anchor.distance if joint and anchor else 0.0


def stress_joint(design: Design, load_z_mm: float) -> Iterator[JointStress]:
    """Yield the stresses of eyes and anchor under a load at a height of the finger."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    if joint is None:
        return
    thickness = _eye_thickness(design, joint)
    if joint.travel_deg:
        # The stop pushes the finger away from the hand, and the pin holds it, besides the load itself.
        dorsal = design.dimensions.bone_outline.section.dorsal
        # The pressure on the stop grows outwards, so its force acts at two thirds of the length.
        lever = 2 / 3 * (dorsal - joint.axis_y)
        pull = (load_z_mm - joint.axis_z) / lever + 1.0
        width, bore = 2 * joint.eye_radius, 2 * joint.pin_radius
        factor = hole_in_tension(bore, width)
        yield JointStress("eye", joint.axis_z, factor * pull / (thickness * (width - bore)), factor, True)
        shear = pull / (2 * thickness * (joint.eye_radius - joint.pin_radius))
        yield JointStress("end of the eye", joint.low_z, _SHEAR * shear, 1.0, True)
    if anchor:
        force = tendon_force_per_n(design, load_z_mm)
        yield JointStress(
            "bearing of the pin", joint.axis_z, (force + 1.0) / (thickness * 2 * joint.pin_radius), 1.0, False
        )
        length = _anchor_length(design, anchor)
        yield JointStress("bearing of the anchor", anchor.z, force / (length * 2 * anchor.radius), 1.0, False)
        shear = force / (2 * length * design.bone.wall_mm)
        yield JointStress("wall at the anchor", anchor.z, _SHEAR * shear, 1.0, False)


def _eye_thickness(design: Design, joint: Joint) -> float:
    """Thickness [mm] of both cheeks beside the pin, or of the tongue."""
    if not joint.is_fork:
        return 2 * joint.half_width
    section = design.dimensions.bone_outline.section
    edges = (joint.axis_y - joint.pin_radius, joint.axis_y + joint.pin_radius)
    return 2 * (min(section.half_width_at(y) for y in edges) - joint.half_width)


def _anchor_length(design: Design, anchor: TendonAnchor) -> float:
    """Length [mm] of the anchor's hole in both cheeks together."""
    return 2 * (design.dimensions.collar.section.half_width_at(anchor.y) - anchor.inner_half_width)
