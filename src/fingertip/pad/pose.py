"""Pose of the finger on a rigid object: the object's shape, and how the finger is turned towards it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fingertip.foundation.numerics import Array

ObjectShape = Literal["plate", "cylinder", "edge", "sphere"]
EDGE_RADIUS_MM = 0.5
"""Radius of a sharp edge [mm]. An assumption: edges of things for the hand are broken."""


@dataclass(frozen=True)
class Pose:
    """Tilt about x (tip down is positive) and roll about z, and what the pad lies on.

    At no tilt and no roll a plate is parallel to the pad's straight part at the base. A cylinder or an edge lies across
    the finger, and like a sphere it stands `place_mm` distal to the sensor's centre.
    """

    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    object: ObjectShape = "plate"
    radius_mm: float = 0.0
    """Radius of a cylinder or a sphere."""
    place_mm: float = 0.0

    def object_mm(self, x: Array, dz: Array) -> Array:
        """Return the height of the object's surface [mm] at x and at distances dz from the sensor, up to a constant.

        Heights count as those of the pad do, positive towards the palm; infinite beside the object.
        """
        plane = math.tan(math.radians(self.roll_deg)) * x - math.tan(math.radians(self.tilt_deg)) * dz
        if self.object == "plate":
            return plane
        radius = EDGE_RADIUS_MM if self.object == "edge" else self.radius_mm
        squared = (dz - self.place_mm) ** 2 + (x * x if self.object == "sphere" else 0.0 * x)
        fallen = np.sqrt(np.maximum(radius * radius - squared, 0.0))
        surface: Array = plane + np.where(squared < radius * radius, radius - fallen, math.inf)
        return surface
