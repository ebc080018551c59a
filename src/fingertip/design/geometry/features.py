"""Features of bone and mold: the chaplet with its screw, the joint of a clevis, and the folded tail of the sensor.

The base alone is a cantilever, whose play grows towards the tip. The chaplet is a second support, a boss on the dorsal
half of the mold: the screw pulls a flat facet of the bone against it, so that neither gap nor pressure of the silicone
moves it. It leaves a round hole in the skin there, which is closed after casting. No object is touched with it.

The fingertip turns on the pin of a clevis. The hand's knuckle, a tongue or a fork, is round about the pin within a
clearance radius, and its shoulder is a plane at that distance behind the pin. The eyes of the bone are round about the
pin too, but a joint clearance smaller. Two flats at the full radius meet the shoulder where the finger is straight and
where it is bent to the end of its travel: they are its hard stops. Without stops the eyes are round all over, and
narrower.

A straight tail makes the base as long as itself. A folded one runs around a web of the bone and ends under the dorsal
side of the skin, so that the base is only as long as the fold. The film bends around a half-round nose, the proximal
end of the web. The nose stands in a window through the base, in which the tail is threaded. Tabs and crimps are stiff,
so they cannot be pushed into a closed passage around a bend: the trough is open, and a lid closes it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.catalogues.hardware import Thread, find_thread
from fingertip.design.geometry.conic import TANGENT_STEP_MM

if TYPE_CHECKING:
    from fingertip.design.geometry.conic import ConicBody
    from fingertip.design.parameters.finger import Sensor


_BESIDE_BOSS_MM = 0.5
"""Width of the facet beside the boss, so that a misplaced bone still rests on it [mm]."""
_STEP_BESIDE_MM = 0.4
"""Distance from the facet to the step at which its flat begins, where there is room [mm]: silicone between boss and
step is thicker than its minimum."""
_FACET_DEPTH_MM = 0.2
_ENGAGED_DIAMETERS = 2.0
"""Engaged length of the self-tapping screw, in diameters. An assumption for printed resin."""
_PILOT_RATIO = 0.8
"""Diameter of the pilot hole over that of the screw. An assumption for printed resin."""
_PILOT_END_MM = 0.7
"""Length of the pilot hole beyond the screw [mm]."""
_POINTS = 16
"""Points of the facet's edge at which the height of the bone is taken."""
_HOLE_CLEARANCE_MM = 0.1
"""Clearance of the screw in its hole, over its diameter [mm]. The hole is drilled, because a print closes it."""
_HEAD_CLEARANCE_MM = 0.3
"""Gap beside the head of the screw [mm]."""
SCREW_LENGTHS_MM = (4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50)
"""Standard lengths of small machine screws (ISO 888)."""


INSERT_BASE_MM = 0.16
"""Height of tape and double-sided film between the sensor and an insert [mm]: 0.06 and 0.1. Assumption."""


@dataclass(frozen=True)
class SensorInsert:
    """Stiff disc on the tape over the sensor; with a cap it is a mushroom, and the disc its stem [mm]."""

    parts: tuple[tuple[float, float], ...]
    """Radius of each part, and the height above the sensor at which it ends, from below."""

    @property
    def radius(self) -> float:
        return max(radius for radius, _ in self.parts)

    @property
    def height(self) -> float:
        return self.parts[-1][1]


@dataclass(frozen=True)
class Chaplet:
    """Boss, facet and screw [mm]. The axis is parallel to y, in the middle plane."""

    z: float
    """Axis, along the finger."""
    facet_y: float
    radius: float
    """Radius of the boss where it meets the facet."""
    facet_radius: float
    flat_z: float
    """Proximal end of the flat of which the facet is a part."""
    thread: Thread

    @property
    def hole_radius(self) -> float:
        return (self.thread.diameter_mm + _HOLE_CLEARANCE_MM) / 2

    @property
    def head_radius(self) -> float:
        """Radius of the counterbore for the screw's head, which is at most as wide as a nut."""
        return self.thread.nut_flats_mm / 2 + _HEAD_CLEARANCE_MM

    @property
    def pilot_radius(self) -> float:
        """Radius that a drill has: drills are sold in steps of 0.1 mm."""
        return round(_PILOT_RATIO * self.thread.diameter_mm, 1) / 2

    @property
    def engaged(self) -> float:
        return _ENGAGED_DIAMETERS * self.thread.diameter_mm

    @property
    def pilot_depth(self) -> float:
        return self.engaged + _PILOT_END_MM

    @property
    def play(self) -> float:
        """Distance by which the bone can shift across the axis, before the screw meets its hole."""
        return _HOLE_CLEARANCE_MM / 2

    def screw_length(self, dorsal_height: float) -> float:
        """Select the longest screw whose head does not stand out of the dorsal face, at this height."""
        longest = dorsal_height - self.facet_y + self.engaged
        return float(max((length for length in SCREW_LENGTHS_MM if length <= longest), default=SCREW_LENGTHS_MM[0]))


def place_chaplet(outline: ConicBody, z: float, diameter: float, screw_mm: float, begin_z: float) -> Chaplet:
    """Place the chaplet at a height of the finger, with its facet as high as the bone allows, distal to `begin_z`."""
    radius = diameter / 2
    facet = radius + _BESIDE_BOSS_MM
    lowest = min(
        outline.dorsal_height_at(facet * math.sin(angle), z + facet * math.cos(angle))
        for angle in (math.pi * i / _POINTS for i in range(_POINTS + 1))
    )
    flat_z = min(max(z - facet - _STEP_BESIDE_MM, begin_z), z - facet)
    return Chaplet(z, lowest - _FACET_DEPTH_MM, radius, facet, flat_z, find_thread(screw_mm))


@dataclass(frozen=True)
class Joint:
    """Joint of a clevis [mm]. All positions are (y, z), in the middle plane of the finger."""

    axis_y: float
    axis_z: float
    """Axis of the pin."""
    pin_radius: float
    radius: float
    """Radius within which the hand's knuckle lies, and distance of its shoulder behind the axis."""
    clearance: float
    is_fork: bool
    """True if the bone is a fork around the hand's tongue, false if it is a tongue in the hand's fork."""
    half_width: float
    """Half the width between the bone's cheeks, or of its tongue."""
    travel_deg: float
    """Angle between the hard stops; 0 without stops."""
    foot: float
    """Radius of the fillet at the root of the eyes; 0 where they are as wide and as high as the base."""

    @property
    def eye_radius(self) -> float:
        return self.radius - self.clearance

    @property
    def shoulder_z(self) -> float:
        """Proximal end of the full base, from which the eyes stand out."""
        return self.axis_z + self.radius + self.clearance + self.foot

    @property
    def low_z(self) -> float:
        return self.axis_z - self.radius

    @property
    def ramp_deg(self) -> float:
        """Angle about the pin along which the eye rises to a stop: a step there would be a notch."""
        return min(math.degrees(math.acos(self.eye_radius / self.radius)), self.travel_deg) / 2

    def stopped_profile(self, reach: float) -> tuple[tuple[float, float], ...]:
        """Return the corners (y, z) of the eye between its stops, counter-clockwise; the arc about the pin is missing.

        In the frame of the bone the hand's shoulder turns about the pin towards the palmar side while the finger bends.
        The dorsal edge is the shoulder of the straight finger, the palmar one that at the end of the travel. What lies
        between them never meets the shoulder on the way: the outline is convex at the stops, and nearer to the pin
        than the shoulder on the ramps.

        Units: `reach` [mm].
        """
        angle, ramp = math.radians(self.travel_deg), math.radians(self.ramp_deg)
        foot = (-self.radius * math.sin(angle), -self.radius * math.cos(angle))
        along = min(reach, reach / math.sin(angle))
        far = (foot[0] - along * math.cos(angle), foot[1] + along * math.sin(angle))
        inside = self.eye_radius - TANGENT_STEP_MM
        ramps = [(-inside * math.sin(at), -inside * math.cos(at)) for at in (angle - ramp, ramp)]
        dorsal = ((0.0, -self.radius), (reach, -self.radius), (reach, reach))
        corners = (*dorsal, (far[0], reach), far, foot, ramps[0], (0.0, 0.0), ramps[1])
        return tuple((self.axis_y + y, self.axis_z + z) for y, z in corners)


HORN_RADIUS_MM = 4.0
"""Radius of the shoulders over which the tendon turns from around the base towards the hand [mm]."""
BESIDE_LINE_MM = 0.4
"""Room along the finger beside the tendon in its groove [mm]."""


@dataclass(frozen=True)
class TendonAnchor:
    """Loop of the tendon around the base, in a groove behind the collar [mm].

    Its strands come down both sides, turn over a round shoulder, the horn, and leave along the palmar corners.
    """

    y: float
    """Middle of both strands where they leave towards the hand."""
    distance: float
    line: float
    """Diameter of the tendon."""
    half_width: float
    """Half the width of the base in the groove, on whose sides both strands lie."""
    low_z: float
    """Proximal wall of the groove, where the horns begin."""
    high_z: float
    """Height at which the foot of the collar begins to slope outwards, so that it prints without supports."""

    @property
    def z(self) -> float:
        """Middle of the loop."""
        return self.low_z + self.line / 2

    @property
    def strand_x(self) -> float:
        """Distance of the middle of each strand from the middle plane."""
        return self.half_width + self.line / 2

    @property
    def horn_y(self) -> float:
        """Height of the horns' palmar side, on which the strands lie."""
        return self.y + self.line / 2

    @property
    def horn_low_z(self) -> float:
        return self.low_z - HORN_RADIUS_MM


SLIDING_MM = 0.3
"""Gap beside and above film, crimps and wires [mm]. An assumption."""
CHEEK_FOOT_MM = 1.2
"""Fillet where the cheeks beside a folded tail's window stand on the base [mm]."""
END_ROOM_MM = 1.5
"""Room between the tabs and the end of the trough, for tails longer than stated [mm]. An assumption."""
_BELOW_SEAL_MM = 0.5
"""Distance of the window from the sealing part of the collar [mm]."""


@dataclass(frozen=True)
class TailFold:
    """Course of a folded tail [mm]."""

    nose_y: float
    nose_z: float
    """Axis of the nose, which lies in the distal face of the window."""
    radius: float
    """Radius of the nose, at which the film bends."""
    window_low_z: float
    """Proximal face of the window; crimps and wires pass between it and the nose."""
    floor_y: float
    """Floor of the trough, on which the end of the tail lies."""
    film_end_z: float
    tabs_end_z: float
    film_space_mm: float
    """Height between floor and lid beside the tabs."""
    tabs_space_mm: float
    """Height between floor and lid over the tabs, and of all openings through which they are threaded."""
    tabs_half_width: float
    """Half the width of the higher space."""

    @property
    def trough_end_z(self) -> float:
        return self.tabs_end_z + END_ROOM_MM


def fold_tail(
    sensor: Sensor, film_mm: float, thickness_mm: float, tabs_width_mm: float, pocket_floor_y: float, sensor_z: float,
    seal_length_mm: float,
) -> TailFold:  # fmt: skip
    """Lay the tail around its nose. Its film is `film_mm` long from the centre of the head at `sensor_z` [mm]."""
    radius_mm = sensor.fold_radius_mm
    nose_y = pocket_floor_y + TANGENT_STEP_MM + radius_mm
    nose_z = -(seal_length_mm + _BELOW_SEAL_MM)
    # The neutral line of the film runs half its thickness outside the nose.
    left = film_mm - (sensor_z - nose_z) - math.pi * (radius_mm + thickness_mm / 2)
    film_end_z = nose_z + left
    tabs_space = thickness_mm + sensor.crimp_height_mm + sensor.wire_diameter_mm + SLIDING_MM
    bend_to_foot = thickness_mm + SLIDING_MM / 2 + CHEEK_FOOT_MM  # the fillets begin proximal to the film
    return TailFold(
        nose_y,
        nose_z,
        radius_mm,
        nose_z - radius_mm - max(tabs_space, bend_to_foot),
        nose_y + radius_mm + TANGENT_STEP_MM,
        film_end_z,
        film_end_z + sensor.tab_length_mm,
        thickness_mm + SLIDING_MM,
        tabs_space,
        tabs_width_mm / 2 + SLIDING_MM,
    )
