"""Dimensions derived from a design's parameters: the one source for the rules, the printed parts
and the mold.

Axes: x is the width, +y points dorsally, -y palmarly, z distally [mm]. The parting plane is y = 0.
The skin begins at z = 0.
"""

from __future__ import annotations

import math
from functools import cached_property

from .allowances import LEDGE_MM
from .conic import ConicBody, CrossSection
from .joint import (
    BESIDE_LINE_MM,
    HORN_RADIUS_MM,
    MIN_HORN_RADIUS_MM,
    Joint,
    TendonAnchor,
)
from .profile import (
    Tip,
    depth_with_step,
    depth_with_width,
    farthest_side,
    height_with_width,
    weight_of_fullness,
)
from .skin_dimensions import RAMP_SLOPE, SkinDimensions

KNOT_WIRES = 3.0
"""Least thickness of a knot in both wires, in diameters of one of them. An assumption."""
SHORTER_MM = 2.0
HEAD_MM = 0.2
TAIL_MM = 0.5
"""Sizes by which a laid-in sensor may be shorter, and wider at head and tail than in its catalogue
[mm].
"""
LONGER_MM = 3.0
"""Length by which a laid-in sensor may be longer than in its catalogue [mm]."""
_PAST_HOLE_MM = 0.2
"""Length of the trough past the hole of the wires [mm]."""
TAB_WIDTH_MM = 1.0
"""Width of a solder tab [mm]: an assumption."""
_PIN_ENDS_MM = 2.0
"""Length by which a pin stands out of the eyes, both ends together [mm]."""
_MIN_COLLAR_STEP_MM = 0.4
"""Least step from the base of a bone below a crown to its collar [mm]."""
MAX_PROUD_MM = 1.5
"""Height by which horns and the stop of a bent finger may stand out of the collar's outline [mm].
"""
_HORN_RESERVE = 1.04
"""Reserve of the horns' radius over what their pressure at a grip needs."""
_SHARP = 0.8
"""Thickness over height, or height over thickness, below which an edge counts as sharp: 51 degrees
on the average.
"""
_CORNER_POINTS = 64
"""Intervals of a height at which an outline's distance from the axis is sampled."""


class Dimensions(SkinDimensions):
    """Derived lengths [mm] and outlines of one design: of bone, joint and mold, beside those of the
    skin.

    Each value is computed when it is first read and then kept. It reads only the parameters it
    depends on, so that a rule which reads a dimension is known to read exactly those parameters.

    Parameters within their own bounds never raise an exception here. A design that cannot be made
    has lengths that the rules refuse, such as a negative radius.
    """

    @cached_property
    def joint(self) -> Joint | None:
        bone = self._finger.bone
        hand = self._finger.hand
        if bone.interface != "clevis":
            return None

        is_fork = hand.knuckle == "tongue"
        return Joint(
            axis_y=hand.axis_height_mm - self.base_palmar_height,
            axis_z=-bone.base_length_mm,
            pin_radius=hand.pin_diameter_mm / 2,
            radius=hand.clearance_radius_mm,
            clearance=bone.joint_clearance_mm,
            is_fork=is_fork,
            half_width=hand.width_mm / 2
            + (bone.joint_clearance_mm if is_fork else -bone.joint_clearance_mm),
            travel_deg=hand.travel_deg,
            foot=0.0 if is_fork and hand.travel_deg else bone.foot_radius_mm,
        )

    @property
    def prints_without_supports(self) -> bool:
        """True for a bone on a post: its collar and base rise on slopes of 45 degrees."""
        return self._finger.bone.interface == "post"

    @cached_property
    def pin_length(self) -> float:
        """Length of the joint's pin through the eyes [mm]: it stands out on both sides, to be
        pushed out.
        """
        section = self.eyes
        joint = self.joint
        axis_y, radius = (joint.axis_y, joint.pin_radius) if joint else (0.0, 0.0)
        across = 2 * min(section.half_width_at(axis_y + side * radius) for side in (-1.0, 1.0))

        return math.ceil(across) + _PIN_ENDS_MM

    @cached_property
    def stops_top_z(self) -> float | None:
        """Height up to which the base of a joint is as wide and high as the collar; None without a
        joint.
        """
        if self.joint is None:
            return None

        return self.anchor.low_z if self.anchor else -self._finger.bone.collar_length_mm

    @property
    def eyes(self) -> CrossSection:
        """Outline of the joint's eyes around the pin."""
        return self.collar.section if self.joint else self.bone_outline.section

    @cached_property
    def base_end_z(self) -> float:
        return self.joint.low_z if self.joint else -self._finger.bone.base_length_mm

    @cached_property
    def full_base_length(self) -> float:
        """Length along which the base has its full outline [mm]. The eyes of a clevis are lower."""
        return -self.joint.shoulder_z if self.joint else self._finger.bone.base_length_mm

    @cached_property
    def anchor(self) -> TendonAnchor | None:
        """Anchor of the tendon; None without a tendon."""
        hand = self._finger.hand
        joint = self.joint
        section = self.collar.section
        if joint is None or hand.tendon_distance_mm == 0.0:
            return None

        line = hand.tendon_diameter_mm
        half = self.joint_base_half_width - 1.5 * hand.tendon_diameter_mm
        corner = farthest_side(
            section.half_width, section.dorsal, section.dorsal_weight, _CORNER_POINTS
        )
        share = (half + LEDGE_MM) / section.half_width
        high = -self._finger.bone.collar_length_mm - corner * (1.0 - min(1.0, share))
        low = high - line - BESIDE_LINE_MM
        y = joint.axis_y - hand.tendon_distance_mm
        back = self.bone_outline.section.dorsal_height_at(half) - 1.5 * line
        # The tendon presses on the horns at a grip: they are rounder where that needs more, and
        # there is room.
        stated = self._finger.strength
        lever = (self._finger.skin.length_mm - joint.axis_z) / hand.tendon_distance_mm
        pressed_n = _HORN_RESERVE * stated.min_grip_factor * stated.grip_force_n * lever / 2
        wanted = max(HORN_RADIUS_MM, pressed_n / line / self._finger.layer_strength_mpa)
        radius = max(MIN_HORN_RADIUS_MM, min(wanted, low - joint.shoulder_z, back - y))

        return TendonAnchor(
            y=y,
            distance=hand.tendon_distance_mm,
            line=line,
            half_width=half,
            low_z=low,
            high_z=high,
            horn_radius=radius,
        )

    @cached_property
    def joint_depth(self) -> float:
        """Depth of the palmar side of a joint's base: that of the collar, or what horns and the
        bent stop need.
        """
        collar = self.collar.section.palmar
        joint = self.joint
        if joint is None:
            return collar

        turned = math.radians(joint.travel_deg)
        stop = (
            joint.radius * math.sin(turned)
            + joint.pin_radius * max(0.0, math.cos(turned))
            - joint.axis_y
        )
        deepest = max(-self.anchor.y if self.anchor else 0.0, stop if joint.travel_deg else 0.0)
        return max(collar, min(deepest, collar + MAX_PROUD_MM))

    @property
    def joint_base_half_width(self) -> float:
        """Half the width of a joint's base at its palmar corners, which stand out of the collar's
        outline.
        """
        return self.collar.section.half_width_at(-self.base_flat_depth)

    @cached_property
    def bone_outline(self) -> ConicBody:
        skin = self._finger.skin
        bone = self._finger.bone
        half_width = skin.width_mm / 2
        section = CrossSection(
            half_width=half_width - skin.thickness_side_mm,
            palmar=skin.semi_axis_palmar_mm - skin.thickness_side_mm,
            dorsal=skin.semi_axis_dorsal_mm - skin.thickness_dorsal_mm,
            palmar_weight=weight_of_fullness(bone.palmar_fullness),
            dorsal_weight=weight_of_fullness(skin.nail_fullness),
        )
        # The taper keeps the side thickness where the tip begins. The base runs straight below the
        # skin.
        tapered = half_width * skin.taper_ratio - skin.thickness_side_mm
        scale = tapered / section.half_width if section.half_width else 0.0

        return ConicBody(
            section,
            ((self.base_end_z, 1.0), (0.0, 1.0), (self.taper_end_z, scale)),
            Tip(skin.length_mm - skin.thickness_tip_mm, weight_of_fullness(skin.tip_fullness)),
        )

    @cached_property
    def max_platform(self) -> float:
        """Largest height of a platform whose ramp begins on the flat: past collar, end of the tail
        and groove.
        """
        bone = self._finger.bone
        low = max(0.0, self.tail_end_z)

        if bone.groove_depth_mm:
            low = max(
                low, bone.groove_distance_mm + 2 * bone.groove_depth_mm + bone.groove_width_mm
            )

        return max(0.0, RAMP_SLOPE * (self.ramp[1] - low))

    @cached_property
    def base_flat_depth(self) -> float:
        """Depth of the palmar flat of the base, at y = -base_flat_depth.

        Proximal to the collar the base is higher than the flat of the bone, and stronger: as high
        as its cheeks beside trough and joint keep a wall, within the collar.
        """
        section = self.bone_outline.section
        joint = self.joint
        between = joint.half_width if joint and joint.is_fork else 0.0
        needed = max(self.tail_half_width, between) + self._finger.bone.wall_mm
        deepest = depth_with_width(section, needed)

        if self.crown:
            # The pad's base is lower than the bone's outline: the corners of the base stay within
            # the collar.
            lowest = min(deepest, self.base_palmar_height - self._finger.skin.thickness_side_mm)
            deepest = min(
                lowest, depth_with_step(self.collar.section, section, _MIN_COLLAR_STEP_MM, lowest)
            )

        return max(self.flat_depth, deepest)

    def collar_step_at(self, depth: float) -> float:
        """Return the step from the base's outline out to the collar's at a depth below the parting
        plane [mm].
        """
        return self.collar.section.half_width_at(-depth) - self.bone_outline.section.half_width_at(
            -depth
        )

    @property
    def base_middle_y(self) -> float:
        """Height of the middle of the base, between its dorsal side and its palmar flat."""
        return (self.bone_outline.section.dorsal - self.base_flat_depth) / 2

    @cached_property
    def pocket_depth(self) -> float:
        return self.sensor.thickness_mm + self._finger.sensor.adhesive_thickness_mm

    @cached_property
    def tail_end_z(self) -> float:
        """End of the tail's film, from which its solder tabs stick out.

        Along a ramp the film is longer.
        """
        along_ramp = (
            self._finger.bone.platform_mm * (math.hypot(1.0, RAMP_SLOPE) - 1.0) / RAMP_SLOPE
        )
        return self.sensor_z + self.sensor.head_diameter_mm / 2 - self.sensor.length_mm + along_ramp

    @cached_property
    def trough_end_z(self) -> float:
        """Proximal end of the trough of the tail, behind the hole of the wires: a knot in both lies
        on its mouth.
        """
        return self.channel_exit_z - self._finger.bone.channel_diameter_mm / 2 - _PAST_HOLE_MM

    @cached_property
    def channel_exit_z(self) -> float:
        """Centre of the channel's dorsal opening.

        It lies behind the tabs of a sensor longer than stated, and behind the collar or the
        tendon's loop.
        """
        bone = self._finger.bone
        channel_radius = bone.channel_diameter_mm / 2
        tabs_end = self.tail_end_z - self._finger.sensor.tab_length_mm - LONGER_MM
        behind = self.anchor.low_z if self.anchor else -bone.collar_length_mm

        return min(tabs_end + channel_radius, behind - channel_radius - bone.wall_mm)

    def blunt_up_to_y(
        self, half_width: float, z: float, outline: ConicBody | None = None
    ) -> float | None:
        """Find where bone beside a slot with a width is as thick as a wall, if its edge above is
        sharp; else None.

        A sharp edge does not print, and is cut off. The outline is the bone's unless another is
        given.
        """
        outline = outline or self.bone_outline
        section = outline.section
        scale = outline.scale_at(z)
        thick_y = height_with_width(section, half_width + self._finger.bone.wall_mm, scale)
        edge_y = height_with_width(section, half_width, scale)

        return thick_y if edge_y - thick_y > _SHARP * self._finger.bone.wall_mm else None

    @cached_property
    def collar(self) -> ConicBody:
        """Flange that carries the skin's end."""
        skin = self._finger.skin
        bone = self._finger.bone
        section = CrossSection(
            half_width=skin.width_mm / 2 - bone.collar_inset_mm,
            palmar=self.base_palmar_height - bone.collar_inset_mm,
            dorsal=skin.semi_axis_dorsal_mm - bone.collar_inset_mm,
            palmar_weight=weight_of_fullness(skin.pulp_fullness),
            dorsal_weight=weight_of_fullness(skin.nail_fullness),
        )

        return ConicBody(section, ((-bone.collar_length_mm, 1.0), (0.0, 1.0)))

    @cached_property
    def shrinkage(self) -> float:
        return 1.0 / (1.0 - self._finger.mold.silicone_shrinkage_percent / 100.0)
