"""Form of the pad: heights of skin and bone over the parting plane, and what the silicone is made of.

Heights count from the plane y = 0 and are positive towards the palm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody
from fingertip.foundation.numerics import Array

POISSON = 0.49
"""Poisson's ratio of silicone. Between 0.49 and 0.4999 the share of the sensor changes by 0.001 at the centre and 0.01
beside it: a tenth of a degree of tilt does more."""


@dataclass(frozen=True, eq=False)
class PadForm:
    outer: ConicBody
    bone: ConicBody
    flat_mm: float
    """Height of the bone's flat."""
    raised: Callable[[float], tuple[float, float]]
    """Function from z to half the width of platform or ramp, and its height [mm]."""
    platform_mm: float
    """Height of the plane on which the sensor's active area lies."""
    sensor_z_mm: float
    active_radius_mm: float
    collar: tuple[float, float]
    """Proximal end z of the collar, which is rigid, and its palmar height [mm]."""
    young_mpa: float
    poisson: float = POISSON

    @classmethod
    def of_design(cls, design: Design) -> PadForm:
        dims, modulus = design.dimensions, design.silicone.material.modulus_mpa
        return cls(
            dims.outer, dims.bone_outline, dims.flat_depth,
            lambda z: (dims.platform_half_width_at(z), dims.flat_depth_at(z)), dims.platform_depth, dims.sensor_z,
            dims.sensor.active_diameter_mm / 2, (-design.bone.collar_length_mm, dims.collar.section.palmar),
            math.sqrt(modulus.low * modulus.high),
        )  # fmt: skip

    @property
    def base_slope(self) -> float:
        """Slope of the pad's straight part at the base, towards the parting plane [mm per mm]."""
        span, height = self.outer.spans[0], self.outer.section.palmar
        return height * (span.palmar[0] - span.palmar[2]) / (span.z[2] - span.z[0])

    def skin_mm(self, x: Array, z: Array) -> Array:
        """Return the height of the skin [mm]; -inf where there is none. Units: `x` [mm], `z` [mm]."""
        return _height(self.outer, x, z)

    def bone_mm(self, x: Array, z: Array) -> Array:
        """Return the height of the bone's surface under the skin [mm]; -inf beside it. Units: `x` [mm], `z` [mm]."""
        rows, at = np.unique(z, return_inverse=True)
        half, height = np.array([self.raised(float(row)) for row in rows]).T[:, at.reshape(np.shape(z))]
        return np.minimum(_height(self.bone, x, z), np.where(np.abs(x) <= half, height, self.flat_mm))


def _height(body: ConicBody, x: Array, z: Array) -> Array:
    """Evaluate the palmar height of a body on arrays that broadcast."""
    rows, at = np.unique(z, return_inverse=True)
    at = at.reshape(np.shape(z))
    scale, palmar = (np.array([f(float(row)) for row in rows])[at] for f in (body.scale_at, body.palmar_scale_at))
    section, w = body.section, body.section.palmar_weight
    inside = (scale > 0.0) & (np.abs(x) < section.half_width * scale)
    y = np.where(inside, np.abs(x) / np.where(scale > 0.0, section.half_width * scale, 1.0), 0.0)
    b = 2.0 * y + 4.0 * w * w * (1.0 - y)
    arc = 1.0 - 2.0 * y * y / (b + np.sqrt(np.maximum(b * b - 4.0 * y * y, 0.0)))
    height: Array = np.where(inside, palmar * section.palmar * arc, -math.inf)
    return height
