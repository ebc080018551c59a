"""Pose of the finger on a rigid object: the object's shape, and how the finger is turned towards it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

ObjectShape = Literal["plate", "cylinder", "edge", "sphere"]
EDGE_RADIUS_MM = 0.5
"""Radius of a sharp edge [mm]. An assumption: edges of things for the hand are broken."""


@dataclass(frozen=True)
class Pose:
    """Tilt about x (tip down is positive) and roll about z, and what the pad lies on.

    At no tilt and no roll a plate is parallel to the pad's straight part at the base. A cylinder or an edge lies across
    the finger.
    """

    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    object: ObjectShape = "plate"
    radius_mm: float = 0.0
    """Radius of a cylinder or a sphere."""
    place_mm: float = 0.0
    """Distance from the sensor's centre, distal, at which a cylinder, an edge or a sphere stands."""
    across_mm: float = 0.0
    """Distance from the middle plane at which a sphere stands."""
