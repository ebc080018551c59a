"""Form of the pad (stub)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody
from fingertip.foundation.numerics import Array


def _height(body: ConicBody, x: Array, z: Array) -> Array:
    scale = np.vectorize(body.scale_at, otypes=[float])(z)
    w, a, b = body.section.palmar_weight, body.section.half_width, body.section.palmar
    with np.errstate(all="ignore"):
        y = np.abs(x) / (a * scale)
        c = 2.0 * y + 4.0 * w * w * (1.0 - y)
        arc = 1.0 - 2.0 * y * y / (c + np.sqrt(np.maximum(c * c - 4.0 * y * y, 0.0)))
    return np.where((scale > 0.0) & (y < 1.0), b * scale * arc, -math.inf)


@dataclass(frozen=True)
class PadForm:
    outer: ConicBody
    bone: ConicBody
    platform_mm: float
    sensor_z_mm: float
    active_radius_mm: float
    young_mpa: float
    poisson: float = 0.49

    @property
    def base_slope(self) -> float:
        (z0, s0), (z1, s1) = self.outer.stations
        return self.outer.section.palmar * (s0 - s1) / (z1 - z0)

    @property
    def collar(self) -> tuple[float, float]:
        return (-2.0, self.outer.section.palmar - 0.3)

    @classmethod
    def of_design(cls, design: Design) -> PadForm:
        d = design.dimensions
        return cls(d.outer, d.bone_outline, d.flat_depth, d.sensor_z, d.sensor.active_diameter_mm / 2, 1.0)

    def skin_mm(self, x: Array, z: Array) -> Array:
        return _height(self.outer, *np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float)))

    def bone_mm(self, x: Array, z: Array) -> Array:
        return np.minimum(
            _height(self.bone, *np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float))), self.platform_mm
        )
