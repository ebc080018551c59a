"""Form of the pad: heights of skin and bone over the parting plane, and what the silicone is made
of.

Heights count from the plane y = 0 and are positive towards the palm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.conic import ConicBody
from fingertip.models.making import making_of

POISSON = 0.49
"""Poisson's ratio of silicone. Between 0.49 and 0.4999 the share of the sensor changes by 0.001 at
the centre and 0.01 beside it: a tenth of a degree of tilt does more.
"""
INNER_FRICTION = 0.3
"""Friction of a skin on the bone that it lies on, as of powdered silicone on a print.
An assumption.
"""


@dataclass(frozen=True)
class PadForm:
    """Shapes of skin and bone, the place of the sensor, and the modulus.

    Forms with equal values are equal.
    """

    outer: ConicBody
    bone: ConicBody
    flat_mm: float
    """Height of the bone's flat."""
    platform_mm: float
    """Height of the plane on which the sensor's active area lies."""
    platform_radius_mm: float
    """Radius of the platform around the sensor; 0 without one."""
    neck_half_width_mm: float
    ramp: tuple[float, float]
    """Heights z at which the ramp from the flat to the platform begins and ends [mm]."""
    sensor_z_mm: float
    active_radius_mm: float
    turn_on_n: float
    """Force on the active area at which the sensor begins to conduct."""
    collar: tuple[float, float]
    """Proximal end z of the collar, which is rigid, and its palmar height [mm]."""
    young_mpa: float
    poisson: float = POISSON
    bonded: bool = True
    """False: the skin was made apart and lies on the bone."""
    gap_mm: float = 0.0
    """Distance of the inside of a skin that was made apart from the bone, where no bump is.
    It is 0 for a skin that lies on the bone.
    """
    bump_radius_mm: float = 0.0
    bump_height_mm: float = 0.0
    """Bump inside that skin over the sensor; above the gap it presses on the sensor at rest."""
    friction: float = INNER_FRICTION
    """Coefficient of friction of a skin that lies on the bone."""

    @classmethod
    def of_design(cls, design: Design, *, is_loose: bool = False) -> PadForm:
        """Take the form from a design: with the tightest fit of a skin that was made apart, or with
        the loosest.

        Each surface of core and bone may be off by its error. A tight skin stretches and lies on,
        so that its bump is proud by its whole height; a loose one stands off by both errors, less
        what it is made smaller by.
        """
        dims = design.dimensions
        modulus = design.silicone.material.modulus_mpa
        bump = design.skin.bump_height_mm
        gap = (
            max(0.0, 2.0 * design.printer.surface_error_mm - design.mold.core_inset_mm)
            if is_loose
            else 0.0
        )
        apart = not making_of(design).is_bonded

        return cls(
            outer=dims.outer,
            bone=dims.bone_outline,
            flat_mm=dims.flat_depth,
            platform_mm=dims.platform_depth,
            platform_radius_mm=dims.platform_radius if design.bone.platform_mm else 0.0,
            neck_half_width_mm=dims.neck_half_width,
            ramp=dims.ramp,
            sensor_z_mm=dims.sensor_z,
            active_radius_mm=dims.sensor.active_diameter_mm / 2,
            turn_on_n=design.force_curve.turn_on_n,
            collar=(-design.bone.collar_length_mm, dims.collar.section.palmar),
            young_mpa=math.sqrt(modulus.low * modulus.high),
            bonded=not apart,
            gap_mm=gap if apart else 0.0,
            bump_radius_mm=design.skin.bump_radius_mm if apart and bump else 0.0,
            bump_height_mm=bump if apart and bump else 0.0,
        )

    @property
    def held_part(self) -> float:
        """Hold of the inside of the skin along the bone, from 0 without friction to 1 where it is
        bonded.
        """
        return 1.0 if self.bonded else math.tanh(self.friction)

    @property
    def base_slope(self) -> float:
        """Slope of the pad's straight part at the base, towards the parting plane [mm per mm]."""
        span = self.outer.spans[0]
        height = self.outer.section.palmar
        return height * (span.palmar[0] - span.palmar[2]) / (span.z[2] - span.z[0])

    @property
    def over_sensor_mm(self) -> float:
        """Thickness of the silicone over the middle of the sensor."""
        return float(self.skin_mm(np.zeros(1), np.array([self.sensor_z_mm]))[0]) - self.platform_mm

    def skin_mm(self, x: Array, z: Array) -> Array:
        """Return the height of the skin [mm]; -inf where there is none.

        Units: `x` [mm], `z` [mm].
        """
        return _height(self.outer, x, z)

    def inner_gap_mm(self, x: Array, z: Array) -> Array:
        """Return how far the inside of the skin stands off the bone.

        The gap [mm] is negative where it overlaps the bone, at the bump.
        """
        on_bump = np.hypot(x, z - self.sensor_z_mm) <= self.bump_radius_mm * (1.0 + 1e-9)
        return np.asarray(np.where(on_bump, self.gap_mm - self.bump_height_mm, self.gap_mm))

    def bone_mm(self, x: Array, z: Array) -> Array:
        """Return the height of the bone's surface under the skin [mm]; -inf beside it.

        Units: `x` [mm], `z` [mm].
        """
        cut = np.full(np.broadcast_shapes(np.shape(x), np.shape(z)), self.flat_mm)
        if self.platform_radius_mm:
            low, high = self.ramp
            rising = self.flat_mm + (self.platform_mm - self.flat_mm) * np.clip(
                (z - low) / (high - low), 0.0, 1.0
            )
            on_neck = (np.abs(x) <= self.neck_half_width_mm) & (z <= self.sensor_z_mm)
            on_disc = np.hypot(x, z - self.sensor_z_mm) <= self.platform_radius_mm
            cut = np.where(on_disc, self.platform_mm, np.where(on_neck, rising, cut))

        return np.asarray(np.minimum(_height(self.bone, x, z), cut))


def _height(body: ConicBody, x: Array, z: Array) -> Array:
    """Evaluate the palmar height of a body on arrays that broadcast."""
    rows, at = np.unique(z, return_inverse=True)

    def along(scale_at: Callable[[float], float]) -> Array:
        return np.asarray(np.array([scale_at(float(row)) for row in rows])[at.reshape(np.shape(z))])

    scale, section, w = along(body.scale_at), body.section, body.section.palmar_weight
    palmar = along(body.palmar_scale_at) if body.crown else scale
    inside = (scale > 0.0) & (np.abs(x) < section.half_width * scale)
    y = np.where(inside, np.abs(x) / np.where(scale > 0.0, section.half_width * scale, 1.0), 0.0)
    b = 2.0 * y + 4.0 * w * w * (1.0 - y)
    arc = 1.0 - 2.0 * y * y / (b + np.sqrt(np.maximum(b * b - 4.0 * y * y, 0.0)))

    return np.asarray(np.where(inside, palmar * section.palmar * arc, -math.inf))
