"""Pose of the finger on a rigid object, the object at its first touch, and poses in which it would
miss the skin.

An object approaches along the normal of a plate in the same pose. At no tilt that plate is parallel
to the straight part of the pad at its base, not to the finger's axis. Positive tilt presses with
the tip, positive roll with x < 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.pad.pad_geometry import PadForm

ObjectShape = Literal["plate", "cylinder", "edge", "sphere"]
EDGE_RADIUS_MM = 0.5
"""Radius of a sharp edge [mm]. An assumption: edges of things for the hand are broken."""
X, Z, PALM = range(3)
"""Axes of points, nodes and displacements."""
MAX_ANGLE_DEG = 60.0
"""Largest tilt and roll. Beyond, objects touch tip or side rather than the pad."""
_ROUND = 0.8
"""Part of its radius up to which an object is round. Beyond, it goes on along the tangent."""
_BONE_MM = np.arange(-60.0, 60.0, 0.5)
"""Grid on which the bone is looked up, both ways from the proximal end of the skin [mm]."""


@dataclass(frozen=True)
class Pose:
    """Tilt about x (tip down is positive) and roll about z, and what the pad lies on.

    At no tilt and no roll a plate is parallel to the pad's straight part at the base. A cylinder or
    an edge lies across the finger.
    """

    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    object: ObjectShape = "plate"
    radius_mm: float = 0.0
    """Radius of a cylinder or a sphere."""
    place_mm: float = 0.0
    """Distance from the sensor's centre, distal, at which a cylinder, an edge or a sphere stands.
    """
    across_mm: float = 0.0
    """Distance from the middle plane at which a sphere stands."""


@dataclass(frozen=True, eq=False)
class Touch:
    """Object of a pose at its first touch with the undeformed skin."""

    pose: Pose
    radius_mm: float
    slopes: tuple[float, float]
    """Slopes of a plate in this pose along x and z."""
    sensor_z_mm: float
    height_mm: float = 0.0
    """Height of a plate in this pose, at the sensor, on which the object would lie."""
    rigid_mm: float = math.inf
    """Travel after which the object would reach bone or collar."""

    @classmethod
    def of_pose(cls, form: PadForm, pose: Pose, surface: Array) -> tuple[Touch, Array]:
        """Bring an object to points of the surface, and return it with the point that it touches
        first.

        Raises TraceError where it meets bone or collar before, or the skin beside the pad.
        """
        if not (abs(pose.tilt_deg) <= MAX_ANGLE_DEG and abs(pose.roll_deg) <= MAX_ANGLE_DEG):
            angles = f"{pose.tilt_deg:g} and a roll of {pose.roll_deg:g} degrees"
            raise _refuse(
                "tilt_deg",
                f"{angles}: neither may exceed +-{MAX_ANGLE_DEG:g}; turn the finger less.",
            )

        radius = EDGE_RADIUS_MM if pose.object == "edge" else pose.radius_mm
        is_plate = pose.object == "plate"
        if not (is_plate or 0.0 < radius < math.inf):
            raise _refuse(
                "radius_mm", f"{radius:g} mm is no radius of a {pose.object}; use one above 0."
            )

        slopes = (
            math.tan(math.radians(pose.roll_deg)),
            -math.tan(math.radians(pose.tilt_deg)) - form.base_slope,
        )
        touch = cls(pose, radius, slopes, form.sensor_z_mm)
        clear = touch._rise(surface)[0] - surface[:, PALM]
        point = surface[np.argmin(clear)]
        height = -float(clear.min())

        if not (is_plate or np.linalg.norm(touch._off_axis(point[None])) <= _ROUND * radius):
            where = (
                f"the {pose.object} meets x = {point[X]:.1f}, z = {point[Z]:.1f} mm, beside the pad"
            )
            raise _refuse("place_mm", f"at {pose.place_mm:g} {where}; choose one nearer to 0.")

        rigid = _rigid_points(form)
        travel = float((height + touch._rise(rigid)[0] - rigid[:, PALM]).min()) / math.hypot(
            1.0, *slopes
        )
        if travel <= 0.0:
            before = (
                f"at {pose.tilt_deg:g} degrees the {pose.object} meets bone or collar "
                f"{-travel:.2g} mm before skin"
            )
            raise _refuse("tilt_deg", f"{before}; choose one nearer to 0.")

        return replace(touch, height_mm=height, rigid_mm=travel), point

    @property
    def approach(self) -> Array:
        """Unit vector along which the pad moves into the object."""
        return np.array([-self.slopes[0], -self.slopes[1], 1.0]) / math.hypot(1.0, *self.slopes)

    def clear_mm(self, points: Array) -> Array:
        """Return how high the object lies over points [mm]."""
        return np.asarray(self.height_mm + self._rise(points)[0] - points[:, PALM])

    def gaps(self, points: Array) -> tuple[Array, Array, Array]:
        """Return gaps over points, unit vectors into the object, and what 1 mm of travel closes of
        them.
        """
        rise, slopes = self._rise(points)
        into = np.column_stack([-slopes, np.ones(len(points))])
        into /= np.linalg.norm(into, axis=1)[:, None]
        gap = (self.height_mm + rise - points[:, PALM]) * into[:, PALM]

        return gap, into, into[:, PALM] * math.hypot(1.0, *self.slopes)

    def _off_axis(self, points: Array) -> Array:
        """Offsets along x and z from the axis or the centre of a round object."""
        off = points[:, [X, Z]] - np.array(
            [self.pose.across_mm, self.sensor_z_mm + self.pose.place_mm]
        )
        return np.asarray(off if self.pose.object == "sphere" else off * (0.0, 1.0))

    def _rise(self, points: Array) -> tuple[Array, Array]:
        """Heights of the object over points, above `height_mm`, and its slopes along x and z."""
        plane = (points[:, [X, Z]] - np.array([0.0, self.sensor_z_mm])) @ self.slopes
        if self.pose.object == "plate":
            return plane, np.broadcast_to(self.slopes, (len(points), 2))

        off = self._off_axis(points)
        distance = np.linalg.norm(off, axis=1)
        inner = np.minimum(distance, _ROUND * self.radius_mm)
        deep = np.sqrt(self.radius_mm**2 - inner**2)
        rise = self.radius_mm - deep + (distance - inner) * inner / deep

        return plane + rise, self.slopes + off * (inner / deep / np.maximum(distance, 1e-12))[
            :, None
        ]


def _refuse(name: str, message: str) -> TraceError:
    return TraceError(Issue(f"pose.{name}", message))


@lru_cache(maxsize=8)
def _rigid_points(form: PadForm) -> Array:
    """Points of the bone's palmar side, also proximal of the skin, and of the collar's ridge."""
    x, z = (axis.ravel() for axis in np.meshgrid(_BONE_MM, _BONE_MM))
    bone = np.column_stack([x, z, form.bone_mm(x, z)])
    return np.concatenate(
        [
            bone[np.isfinite(bone[:, PALM])],
            [(0.0, z, form.collar[1]) for z in (form.collar[0], 0.0)],
        ]
    )
