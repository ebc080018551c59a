"""Pose of the pad on an object (stub)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


EDGE_RADIUS_MM = 0.5


@dataclass(frozen=True)
class Pose:
    """Pose of the finger on a rigid object: tilt about x (tip down is positive) and roll about z [deg]."""

    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    object: Literal["plate", "cylinder", "edge", "sphere"] = "plate"
    radius_mm: float = 0.0
    place_mm: float = 0.0
