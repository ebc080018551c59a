"""Dimensions of the skin and of the seat of its sensor: outer form with its crown, platform and
ramp.

They are those of `Dimensions` that do not depend on the rest of the bone.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

from .conic import ConicBody, CrossSection
from .profile import Crown, Tip, largest_drop, weight_of_fullness

if TYPE_CHECKING:
    from .program_types import Finger, ForceSensor

CROWN_FLANK = math.tan(math.radians(25.0))
"""Slope at which a crown's arc ends towards the tip [mm per mm]: beyond the largest tilt at which a
finger presses.
"""
RAMP_SLOPE = 0.4
"""Slope of the ramp from the platform down to the flat [mm per mm], which the sensor's film
follows. An assumption.
"""
_CROWN_SLACK_MM = 1e-6
_MIN_BEYOND_CROWN_MM = 1.0
"""Length of the tip that is left beyond a crown's arc [mm]."""


class SkinDimensions:
    """Lengths [mm] and outlines of the skin of one finger, and of the seat of its sensor."""

    def __init__(self, finger: Finger) -> None:
        self._finger = finger

    @cached_property
    def sensor(self) -> ForceSensor:
        """Outline of the force-sensing resistor."""
        return self._finger.force_sensor

    @cached_property
    def sensor_z(self) -> float:
        return self._finger.skin.length_mm - self._finger.sensor.distance_from_tip_mm

    @cached_property
    def taper_end_z(self) -> float:
        return self._finger.skin.length_mm - self._finger.skin.tip_length_mm

    @cached_property
    def outer(self) -> ConicBody:
        skin = self._finger.skin
        section = CrossSection(
            half_width=skin.width_mm / 2,
            palmar=skin.semi_axis_palmar_mm,
            dorsal=skin.semi_axis_dorsal_mm,
            palmar_weight=weight_of_fullness(skin.pulp_fullness),
            dorsal_weight=weight_of_fullness(skin.nail_fullness),
        )
        stations = ((0.0, 1.0), (self.taper_end_z, skin.taper_ratio))
        tip = Tip(skin.length_mm, weight_of_fullness(skin.tip_fullness))

        return ConicBody(section, stations, tip, self.crown)

    @cached_property
    def crown(self) -> Crown | None:
        """Crown of the pad; None without one, or where it does not fit between the skin's proximal
        end and its tip.
        """
        skin = self._finger.skin
        apex = self.crown_apex_z

        if (
            not 0.0 < skin.crown_radius_mm <= self.max_crown_radius
            or not 0.0 < apex <= self.taper_end_z
        ):
            return None
        if skin.crown_drop_mm > self.max_crown_drop + _CROWN_SLACK_MM:
            return None

        drop = min(skin.crown_drop_mm, self.max_crown_drop) / skin.semi_axis_palmar_mm
        return Crown(apex, skin.crown_radius_mm, drop, CROWN_FLANK)

    @cached_property
    def crown_apex_z(self) -> float:
        return self.sensor_z - self._finger.skin.crown_offset_mm

    @cached_property
    def max_crown_radius(self) -> float:
        """Largest radius whose arc ends before the tip's apex."""
        room = self._finger.skin.length_mm - _MIN_BEYOND_CROWN_MM - self.crown_apex_z
        return room * math.hypot(1.0, CROWN_FLANK) / CROWN_FLANK

    @cached_property
    def max_crown_drop(self) -> float:
        """Largest drop whose two arcs fit between the crown's apex and the skin's proximal end, and
        are not steep.
        """
        skin = self._finger.skin
        return largest_drop(skin.crown_radius_mm, self.crown_apex_z, skin.semi_axis_palmar_mm)

    @cached_property
    def base_palmar_height(self) -> float:
        """Palmar height of the skin at its proximal end, which a crown lowers."""
        skin = self._finger.skin
        return skin.semi_axis_palmar_mm - (skin.crown_drop_mm if self.crown else 0.0)

    @cached_property
    def platform_depth(self) -> float:
        """Depth of the plane around the sensor's head, at y =
        -platform_depth: the flat's, or that of a platform.
        """
        skin = self._finger.skin
        return (
            skin.semi_axis_palmar_mm * self.outer.palmar_scale_at(self.sensor_z)
            - skin.thickness_palmar_mm
        )

    @cached_property
    def flat_depth(self) -> float:
        """Depth of the bone's palmar flat, on which the tail lies, at y = -flat_depth."""
        return self.platform_depth - self._finger.bone.platform_mm

    @cached_property
    def tail_half_width(self) -> float:
        """Half the width of the tail's slot, and of everything else in which it lies."""
        return self.sensor.tail_width_mm / 2 + self._finger.sensor.clearance_mm

    @cached_property
    def platform_radius(self) -> float:
        """Radius of the platform: that of the pocket, or of a tail that is wider, and of the rim
        around it.
        """
        clearance = self._finger.sensor.clearance_mm
        widest = max(
            self.sensor.head_diameter_mm / 2 + clearance,
            math.hypot(self.tail_half_width, clearance),
        )
        return widest + self._finger.bone.rim_mm

    @cached_property
    def neck_half_width(self) -> float:
        """Half the width of the ramp, on which the tail's slot has a wall on both sides."""
        return min(self.tail_half_width + self._finger.bone.wall_mm, self.platform_radius)

    @cached_property
    def ramp(self) -> tuple[float, float]:
        """Heights z at which the ramp from the flat to the platform begins and ends."""
        high = self.sensor_z - self.platform_radius
        low = high - self._finger.bone.platform_mm / RAMP_SLOPE
        return low, high

    def flat_depth_at(self, z: float) -> float:
        """Return the depth of the flat, of the ramp, or of the platform at a height z [mm], in the
        middle plane.
        """
        below_end = max(0.0, self.ramp[1] - z)
        return max(self.flat_depth, self.platform_depth - RAMP_SLOPE * below_end)

    def platform_half_width_at(self, z: float) -> float:
        """Return half the width of platform or ramp at a height z [mm]; 0 without one."""
        if self._finger.bone.platform_mm == 0.0 or z <= self.ramp[0]:
            return 0.0

        squared = self.platform_radius**2 - (z - self.sensor_z) ** 2
        return max(math.sqrt(max(0.0, squared)), self.neck_half_width if z < self.sensor_z else 0.0)
