"""Dimensions derived from a design's parameters: the one source for the rules, the printed parts and the mold.

Axes: x is the width, +y points dorsally, -y palmarly, z distally [mm]. The parting plane is y = 0. The skin begins at
z = 0.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

from fingertip.design.geometry import features
from fingertip.design.geometry.conic import ConicBody, CrossSection, Tip, add_groove, inset_body, weight_of_fullness
from fingertip.design.geometry.foot import LEDGE_MM
from fingertip.design.geometry.skin_dimensions import RAMP_SLOPE, SkinDimensions
from fingertip.foundation.numerics import bisect

MIN_PASSAGE_HEIGHT_MM = 0.8
"""Minimum height of the passage through which the tail leaves the collar [mm]. Lower passages close up in printing. An
assumption."""

KNOT_WIRES = 3.0
"""Least thickness of a knot in both wires, in diameters of one of them. An assumption."""
SHORTER_MM, LONGER_MM, HEAD_MM, TAIL_MM = 2.0, 3.0, 0.2, 0.5
"""How much a sensor that is laid in may be shorter, longer, and wider at head and tail than its catalogue says [mm]."""
_PAST_HOLE_MM = 0.2
_SEAL_MM = 2.0
"""Length of the collar that seals the mold at a folded tail [mm]; the window may lie in what is longer. An
assumption."""
TAB_WIDTH_MM = 1.0
"""Width of a solder tab [mm]: an assumption."""
PIN_LENGTHS_MM = (4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 28, 32)
"""Standard lengths of dowel pins (ISO 8734)."""
_BODY_OVERLAP_MM = 0.2
"""Depth to which the body of a core reaches into the collar [mm]. Solids that only touch would leave
coincident faces."""
_MIN_COLLAR_STEP_MM = 0.4
"""Least step from the base of a bone below a crown to its collar [mm], which the mold's recess follows."""
_SHARP = 0.8
"""Thickness over height, or height over thickness, below which an edge counts as sharp: 51 degrees on the average."""
_RIM_POINTS = 64
"""Intervals at which the flat's margin around the sensor is sampled."""


class Dimensions(SkinDimensions):
    """Derived lengths [mm] and outlines of one design: of bone, joint and mold, beside those of the skin.

    Each value is computed when it is first read and then kept. It reads only the parameters it depends on, so that a
    rule which reads a dimension is known to read exactly those parameters.

    Parameters within their own bounds never raise an exception here. A design that cannot be made has lengths that the
    rules refuse, such as a negative radius.
    """

    @cached_property
    def joint(self) -> features.Joint | None:
        bone, hand = self._design.bone, self._design.hand
        if bone.interface != "clevis":
            return None
        is_fork = hand.knuckle == "tongue"
        return features.Joint(
            hand.axis_height_mm - self.base_palmar_height, -bone.base_length_mm,
            hand.pin_diameter_mm / 2, hand.clearance_radius_mm, bone.joint_clearance_mm, is_fork,
            hand.width_mm / 2 + (bone.joint_clearance_mm if is_fork else -bone.joint_clearance_mm), hand.travel_deg,
            0.0 if is_fork and hand.travel_deg else bone.foot_radius_mm,
        )  # fmt: skip

    @cached_property
    def pin_length(self) -> float:
        """Length of the joint's pin through the cheeks of a fork: the longest on sale that does not stand out [mm]."""
        section, joint = self.eyes, self.joint
        axis_y, radius = (joint.axis_y, joint.pin_radius) if joint else (0.0, 0.0)
        across = 2 * min(section.half_width_at(axis_y + side * radius) for side in (-1.0, 1.0))
        return float(max((length for length in PIN_LENGTHS_MM if length <= across), default=PIN_LENGTHS_MM[0]))

    @cached_property
    def stops_top_z(self) -> float | None:
        """Height up to which the base of a joint is as wide and high as the collar; None without a joint."""
        if self.joint is None:
            return None
        return self.anchor.low_z if self.anchor else -self._design.bone.collar_length_mm

    @property
    def eyes(self) -> CrossSection:
        """Outline of the joint's eyes around the pin."""
        return self.collar.section if self.joint else self.bone_outline.section

    @cached_property
    def base_end_z(self) -> float:
        return self.joint.low_z if self.joint else -self._design.bone.base_length_mm

    @cached_property
    def full_base_length(self) -> float:
        """Length along which the base has its full outline [mm]. The eyes of a clevis are lower."""
        return -self.joint.shoulder_z if self.joint else self._design.bone.base_length_mm

    @cached_property
    def anchor(self) -> features.TendonAnchor | None:
        """Anchor of the tendon; None without a tendon."""
        hand, joint, section = self._design.hand, self.joint, self.collar.section
        if joint is None or hand.tendon_distance_mm == 0.0:
            return None
        line, half = hand.tendon_diameter_mm, self.joint_half_width - 1.5 * hand.tendon_diameter_mm
        corner = max(
            math.hypot(section.half_width_at(y), y)
            for y in (section.dorsal * i / _RIM_POINTS for i in range(_RIM_POINTS + 1))
        )
        slope = corner * (1.0 - min(1.0, (half + LEDGE_MM) / section.half_width))
        high = -self._design.bone.collar_length_mm - slope
        return features.TendonAnchor(
            joint.axis_y - hand.tendon_distance_mm, hand.tendon_distance_mm, line, half,
            high - line - features.BESIDE_LINE_MM, high,
        )  # fmt: skip

    @property
    def joint_half_width(self) -> float:
        """Half the width of a joint's base at its palmar corners, which stand out of the collar's outline."""
        return self.collar.section.half_width_at(-self.base_flat_depth)

    @cached_property
    def window_opens_into_gap(self) -> bool:
        """True if the window of a folded tail and the gap of a fork are one opening, through which the wires leave."""
        return self.fold is not None and self.joint is not None and self.joint.is_fork

    @cached_property
    def bone_outline(self) -> ConicBody:
        skin, bone = self._design.skin, self._design.bone
        half_width = skin.width_mm / 2
        section = CrossSection(
            half_width - skin.thickness_side_mm,
            skin.semi_axis_palmar_mm - skin.thickness_side_mm,
            skin.semi_axis_dorsal_mm - skin.thickness_dorsal_mm,
            weight_of_fullness(bone.palmar_fullness),
            weight_of_fullness(skin.nail_fullness),
        )
        # The taper keeps the side thickness where the tip begins. The base runs straight below the skin.
        tapered = half_width * skin.taper_ratio - skin.thickness_side_mm
        scale = tapered / section.half_width if section.half_width else 0.0
        return ConicBody(
            section,
            ((self.base_end_z, 1.0), (0.0, 1.0), (self.taper_end_z, scale)),
            Tip(skin.length_mm - skin.thickness_tip_mm, weight_of_fullness(skin.tip_fullness)),
        )

    @cached_property
    def max_platform(self) -> float:
        """Largest height of a platform whose ramp begins on the flat: past collar, solder relief and groove."""
        bone, low = self._design.bone, 0.0
        if self.fold is None:
            low = max(low, self.tail_end_z + self.relief_half_length)
        if bone.groove_depth_mm:
            low = max(low, bone.groove_distance_mm + 2 * bone.groove_depth_mm + bone.groove_width_mm)
        return max(0.0, RAMP_SLOPE * (self.ramp[1] - low))

    @cached_property
    def base_flat_depth(self) -> float:
        """Depth of the palmar flat of the base, at y = -base_flat_depth.

        A straight tail runs on along the flat of the bone. A folded one leaves it at the collar, and one that is laid
        in runs on in an open trough: proximal to the collar the base is stronger, as high as its cheeks beside window,
        trough and joint keep a wall, within the collar.
        """
        if self.fold is None and not self._design.is_cast_apart:
            return self.flat_depth
        section, joint = self.bone_outline.section, self.joint
        between = joint.half_width if joint and joint.is_fork else 0.0
        needed = max(self.tail_half_width, between) + self._design.bone.wall_mm
        deepest = bisect(lambda y: section.half_width_at(-y) >= needed, 0.0, section.palmar, halvings=40)[0]
        if self.crown:
            # The pad's base is lower than the bone's outline: the corners of the base stay within the collar.
            deepest = min(deepest, self.base_palmar_height - self._design.skin.thickness_side_mm)
            within = bisect(lambda y: self.collar_step_at(y) >= _MIN_COLLAR_STEP_MM, 0.0, deepest, halvings=40)[0]
            deepest = min(deepest, within)
        return max(self.flat_depth, deepest)

    def collar_step_at(self, depth: float) -> float:
        """Return the step from the base's outline out to the collar's at a depth below the parting plane [mm]."""
        return self.collar.section.half_width_at(-depth) - self.bone_outline.section.half_width_at(-depth)

    @cached_property
    def pocket_depth(self) -> float:
        return self.sensor.thickness_mm + self._design.sensor.adhesive_thickness_mm

    @cached_property
    def passage_height(self) -> float:
        """Height of the tail's passage through the collar, which film, crimps and wires are threaded through."""
        crimped = self.sensor.thickness_mm + self._design.sensor.crimp_height_mm + features.SLIDING_MM
        threaded = self.fold.tabs_space_mm if self.fold else crimped if self.tail_passes_collar else 0.0
        return max(MIN_PASSAGE_HEIGHT_MM, self.pocket_depth + self._design.sensor.clearance_mm, threaded)

    @cached_property
    def fold(self) -> features.TailFold | None:
        sensor = self._design.sensor
        if sensor.tail == "straight":
            return None
        body = self.sensor
        return features.fold_tail(
            sensor, body.length_mm - body.head_diameter_mm / 2 - self.ramp_excess, body.thickness_mm,
            body.tab_pitch_mm + TAB_WIDTH_MM, self.pocket_depth - self.flat_depth, self.sensor_z,
            min(self._design.bone.collar_length_mm, _SEAL_MM),
        )  # fmt: skip

    @cached_property
    def cable_groove_depth(self) -> float:
        """Depth of the groove in which the cables of a folded tail leave the base: they lie side by side."""
        return self._design.bone.channel_diameter_mm / 2

    @cached_property
    def cable_groove_end_z(self) -> float:
        """Proximal end of this groove, outside the mold's recess and past the window."""
        bone, fold = self._design.bone, self.fold
        inside = max(bone.collar_length_mm, self._design.mold.recess_length_mm)
        return -max(inside, -fold.window_low_z if fold else 0.0) - self.cable_groove_depth

    @cached_property
    def tail_end_z(self) -> float:
        """End of a straight tail, with its solder tabs."""
        return self.sensor_z + self.sensor.head_diameter_mm / 2 - self.sensor.length_mm + self.ramp_excess

    @cached_property
    def tail_passes_collar(self) -> bool:
        """True if the tail leaves through a closed passage in the collar."""
        return self.fold is not None or (self.tail_end_z < 0.0 and not self._design.is_cast_apart)

    @cached_property
    def trough_end_z(self) -> float:
        """Proximal end of the trough of the tail, behind the hole of the wires: a knot in both lies on its mouth."""
        return self.wires_end_z - _PAST_HOLE_MM

    @cached_property
    def relief_half_length(self) -> float:
        """Half the length of the recess for the solder joints, centred on the end of the tail."""
        return self._design.bone.relief_length_mm / 2

    @property
    def relief_proximal_z(self) -> float:
        return self.tail_end_z - self.relief_half_length

    @cached_property
    def channel_depth(self) -> float:
        """Depth of the cable channel below the flat: it starts with its centre at y = -flat_depth + channel_depth."""
        return self._design.bone.wall_mm + self._design.bone.channel_diameter_mm / 2

    @cached_property
    def channel_exit_z(self) -> float:
        """Centre of the channel's dorsal opening: outside the mold, which is closed with the cables in place.

        That of a tail that is laid in lies behind the tabs of a sensor longer than stated, and behind the collar
        or the tendon's loop.
        """
        bone = self._design.bone
        channel_radius = bone.channel_diameter_mm / 2
        if self._design.is_cast_apart:
            tabs_end = self.tail_end_z - self._design.sensor.tab_length_mm - LONGER_MM
            behind = self.anchor.low_z if self.anchor else -bone.collar_length_mm
            return min(tabs_end + channel_radius, behind - channel_radius - bone.wall_mm)
        covered = max(bone.collar_length_mm, self._design.mold.recess_length_mm)
        exit_below_skin = -(covered + channel_radius + bone.wall_mm)
        after_bend = self.tail_end_z - bone.relief_length_mm / 2 - bone.channel_bend_radius_mm
        return min(exit_below_skin, after_bend)

    @cached_property
    def wires_end_z(self) -> float:
        """Height past which the wires lie on the surface of the base: proximal to their channel or groove."""
        return self.cable_groove_end_z if self.fold else self.channel_exit_z - self._design.bone.channel_diameter_mm / 2

    @cached_property
    def cheek_top_y(self) -> float:
        """Height at which the cheeks beside a folded tail's window end, a wall thick: higher ones end in an edge."""
        return self._height_y(self.tail_half_width + self._design.bone.wall_mm, 0.0, self.bone_outline)

    @cached_property
    def lips_top_y(self) -> float | None:
        """Height from which a folded tail's lid is as wide as the bone: the trough's lips would be too thin to print.

        None where they print.
        """
        fold, outline, wall = self.fold, self.bone_outline, self._design.bone.wall_mm
        top = self.blunt_up_to_y(self.tail_half_width, fold.trough_end_z) if fold else None
        if fold is None or top is None:
            return None

        end_z = self.chaplet.flat_z if self.chaplet else self.facet_begin_z

        def width_of_edge(y: float) -> float:
            """Width of the lid's edge over the height of a wall: a low edge is blunt."""
            return outline.half_width_at(y, end_z) - outline.half_width_at(y + wall, end_z)

        blunt = bisect(lambda y: width_of_edge(y) <= _SHARP * wall, 0.0, top, halvings=40)[0]
        return max(blunt, self.chaplet.facet_y if self.chaplet else 0.0, fold.floor_y + fold.film_space_mm)

    def blunt_up_to_y(self, half_width: float, z: float, outline: ConicBody | None = None) -> float | None:
        """Find where bone beside a slot with a width is as thick as a wall, if its edge above is sharp; else None.

        A sharp edge does not print, and is cut off. The outline is the bone's unless another is given.
        """
        outline = outline or self.bone_outline
        thick_y = self._height_y(half_width + self._design.bone.wall_mm, z, outline)
        edge_y = self._height_y(half_width, z, outline)
        return thick_y if edge_y - thick_y > _SHARP * self._design.bone.wall_mm else None

    def _height_y(self, half_width: float, z: float, outline: ConicBody) -> float:
        """Find the dorsal height at which half the width of an outline is this [mm]."""
        return bisect(lambda y: outline.half_width_at(y, z) >= half_width, 0.0, outline.section.dorsal, halvings=40)[0]

    @cached_property
    def collar(self) -> ConicBody:
        """Flange that carries the skin's end; away from the parting plane its foot rises by `draft_slope`."""
        skin, bone = self._design.skin, self._design.bone
        section = CrossSection(
            skin.width_mm / 2 - bone.collar_inset_mm,
            self.base_palmar_height - bone.collar_inset_mm,
            skin.semi_axis_dorsal_mm - bone.collar_inset_mm,
            weight_of_fullness(skin.pulp_fullness),
            weight_of_fullness(skin.nail_fullness),
        )
        return ConicBody(section, ((-bone.collar_length_mm, 1.0), (0.0, 1.0)))

    def insert_body(self) -> tuple[ConicBody, float, float]:
        """Return body with groove, depth of the palmar flat [mm] and scale of the insert within the skin."""
        mold, bone = self._design.mold, self._design.bone
        if not self._design.is_cast_apart:
            return add_groove(bone, self.bone_outline), self.flat_depth, 1.0
        inset = mold.core_inset_mm
        body = inset_body(self.bone_outline, inset)
        (_, scale), *stations = body.stations
        body = add_groove(bone, replace(body, stations=((-_BODY_OVERLAP_MM, scale), *stations)))
        return body, self.flat_depth - inset, self.shrinkage

    @cached_property
    def chaplet(self) -> features.Chaplet | None:
        mold = self._design.mold
        if mold.chaplet_diameter_mm == 0.0 or mold.method == "plunge":
            return None
        return self.place_chaplet(self._design.skin.length_mm - mold.chaplet_from_tip_mm)

    def place_chaplet(self, z: float) -> features.Chaplet:
        mold, screw_mm = self._design.mold, float(self._design.mold.chaplet_screw[1:])
        return features.place_chaplet(self.bone_outline, z, mold.chaplet_diameter_mm, screw_mm, self.facet_begin_z)

    @cached_property
    def facet_begin_z(self) -> float:
        """Least height at which the facet may begin, a wall distal to the groove and to the trough of a tail [mm]."""
        bone = self._design.bone
        groove = bone.groove_distance_mm + 2 * bone.groove_depth_mm + bone.groove_width_mm
        trough_end = self.fold.trough_end_z if self.fold else 0.0
        return max(groove if bone.groove_depth_mm else 0.0, trough_end) + bone.wall_mm

    @cached_property
    def draft_slope(self) -> float:
        """Tangent of the mold's draft angle [mm per mm]. No half rubs along key, base or collar while it is pulled."""
        return math.tan(math.radians(self._design.mold.draft_deg))

    @cached_property
    def shrinkage(self) -> float:
        return 1.0 / (1.0 - self._design.mold.silicone_shrinkage_percent / 100.0)

    def sensor_rim_margin(self, rim_mm: float, clearance_mm: float) -> float:
        """Compute the least margin along x [mm] between the flat's edge and the circle of sensor head and rim."""
        r = self.sensor.head_diameter_mm / 2 + clearance_mm + rim_mm
        margins = []
        for i in range(_RIM_POINTS + 1):
            phi = math.pi * (i / _RIM_POINTS - 0.5)
            z = self.sensor_z + r * math.sin(phi)
            margins.append(self.bone_outline.half_width_at(-self.platform_depth, z) - r * math.cos(phi))
        return min(margins)
