"""Post and socket, which hold the bone with a cross bolt, and their rules."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.design.formulas.stress_and_knock import StressFactors, at_foot
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.conic import ConicBody, offset_section
from fingertip.design.geometry.outlines import (
    LEDGE_MM,
    TANGENT_STEP_MM,
    flat_foot,
    foot_length,
    foot_line,
    round_foot,
)
from fingertip.design.geometry.profile import farthest_corner
from fingertip.design.geometry.sizes import (
    ARROW_DEG,
    BEFORE_FACE,
    INNER,
    OUTER,
    STEP,
    Circle,
    Length,
    Size,
)
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    Prism,
    Solid,
    SuperconicSolid,
    cylinder,
    difference,
    intersection,
)
from fingertip.design.interfaces import interface
from fingertip.design.interfaces.interface import Bolt, CrossBolted, Shapes
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally
from fingertip.foundation.numerics import bisect

RULES = Ruleset()

_OUTLINE_POINTS = 16
_CHAMFER_MM = 0.6
_MIN_FLAT_MM = 0.02
"""Depth of a post's flat below which it is left out [mm]: both kernels fail on slivers."""


class Post(CrossBolted):
    """Post on the bone, with two flats. It is held along its length."""

    name = "post"
    face_on_plate = "the end of the post"
    weakest = "the post, its weakest section"

    def cross_bolt_z(self, design: DesignTables) -> float:
        """Axis of the cross bolt: near the end of the post, where bending is least."""
        hole = design.bone.cross_bolt_diameter_mm
        bone = design.bone
        return self.low_z(design) + min(
            hole / 2 + max(bone.wall_mm, hole / 2), bone.post_length_mm / 2
        )

    def low_z(self, design: DesignTables) -> float:
        return -design.bone.base_length_mm - design.bone.post_length_mm

    def shapes(self, design: DesignTables) -> Shapes:
        """Build a round post with a dorsal and a palmar flat, or
        without them if it is as high as wide.
        """
        y = interface.middle_y(design.dimensions)
        low = self.low_z(design)
        high = design.bone.wall_mm / 2
        high -= design.bone.base_length_mm
        radius = design.bone.post_width_mm / 2
        half = design.bone.post_height_mm / 2
        post: Solid = cylinder(
            "z",
            centre=(0.0, y),
            low=low,
            high=high,
            radius=radius,
        )

        if half <= radius - _MIN_FLAT_MM:
            margin = (
                radius  # past the round sides and the ends, by a length that scales with the design
            )
            post = intersection(
                post,
                Box(
                    (-radius - margin, y - half, low - margin),
                    (radius + margin, y + half, high + margin),
                ),
            )

        if design.prints_without_supports:
            post = intersection(
                post,
                *self._chamfer(
                    y,
                    low=low,
                    up=high - low,
                    radius=radius,
                    half=min(half, radius),
                ),
            )

        return (post, self._foot(design)), (self.bolt_hole(design),)

    def _chamfer(
        self,
        y: float,
        low: float,
        up: float,
        radius: float,
        half: float,
    ) -> tuple[Solid, Solid]:
        """Build what is left of the post by a chamfer of its end, on
        which it prints: the first layers spread.
        """
        least = radius - _CHAMFER_MM
        flat = half - _CHAMFER_MM
        sides = (
            (y - flat, low),
            (y + flat, low),
            (y + flat + up, low + up),
            (y - flat - up, low + up),
        )

        return Cone(
            axis="z",
            centre=(0.0, y),
            low=low,
            high=low + up,
            low_radius=least,
            high_radius=least + up,
        ), Prism("x", sides, -2 * radius, 2 * radius)

    def _foot(self, design: DesignTables) -> Solid:
        """Build the fillet at the post's root, within the outline of the base."""
        dims = design.dimensions
        end = -design.bone.base_length_mm
        bone = design.bone
        y = interface.middle_y(dims)
        top = end + bone.wall_mm / 2
        half = bone.post_height_mm / 2
        margin = dims.bone_outline.section.half_width
        line = foot_line(bone.foot_radius_mm, end, 1.0, self._foot_reach(design))
        low = end - self.foot_length(design) - margin
        # A step inside the outline, because both run along z and would share a face.
        section = offset_section(dims.bone_outline.section, -TANGENT_STEP_MM)
        flat = dims.base_flat_depth
        outline = difference(
            SuperconicSolid(ConicBody(section, ((low, 1.0), (top + margin, 1.0)))),
            Box(
                (-2 * margin, -section.palmar - margin, low - margin),
                (2 * margin, TANGENT_STEP_MM - flat, top + 2 * margin),
            ),
        )
        foot = [outline, round_foot((0.0, y), bone.post_width_mm / 2, line, top)]

        if half <= bone.post_width_mm / 2 - _MIN_FLAT_MM:
            foot.append(
                flat_foot(
                    "x",
                    low_side=y - half,
                    high_side=y + half,
                    foot=line,
                    end=top + margin,
                    reach=2 * margin,
                )
            )

        return intersection(*foot)

    def _foot_reach(self, design: DesignTables) -> float:
        """Return how far a foot without supports stands out: to the
        base's corners, but for a short ledge [mm].
        """
        if not design.prints_without_supports:
            return 0.0

        dims = design.dimensions
        middle = interface.middle_y(design.dimensions)
        section = dims.bone_outline.section
        flat = -dims.base_flat_depth
        corner = farthest_corner(
            section.half_width,
            height=section.dorsal,
            weight=section.dorsal_weight,
            count=_OUTLINE_POINTS,
            middle=middle,
        )
        corner = max(corner, math.hypot(section.half_width_at(flat), flat - middle))

        return max(0.0, corner - design.bone.post_width_mm / 2 - LEDGE_MM)

    def foot_length(self, design: DesignTables) -> float:
        """Return the length of the fillet at the post's root [mm],
        with the slope on which the base prints.
        """
        return foot_length(design.bone.foot_radius_mm, self._foot_reach(design))

    def genus(self, design: DesignTables) -> int:
        return 1

    def sizes(self, design: DesignTables) -> list[Size]:
        bone = design.bone
        y = interface.middle_y(design.dimensions)
        foot = self.low_z(design)
        half = min(bone.post_height_mm, bone.post_width_mm) / 2
        radius = bone.foot_radius_mm
        end = -bone.base_length_mm - self.foot_length(design)
        corner = (design.dimensions.bone_outline.section.half_width, y - half - radius, end)
        flats: tuple[tuple[float, float], ...] = ()

        if bone.post_height_mm < bone.post_width_mm:
            begin = math.degrees(math.asin(bone.post_height_mm / bone.post_width_mm)) - ARROW_DEG
            flats = ((begin, 180.0 - begin), (180.0 + begin, 360.0 - begin))

        return [
            interface.base_length_size(design),
            Circle(
                name="post",
                growth=OUTER,
                view="end",
                axis="z",
                centre=(0.0, y, foot),
                radius=bone.post_width_mm / 2,
                hidden_deg=flats,
            ),
            Length(
                name="height of the post over its flats",
                growth=OUTER,
                view="end",
                side="left",
                axis="y",
                start=(0.0, y - half, foot),
                end=(0.0, y + half, foot),
            ),
            Circle(
                name="fillet at the root of the post",
                growth=BEFORE_FACE,
                view="front",
                axis="x",
                centre=corner,
                radius=radius,
                is_radius=True,
                hidden_deg=((88.0, 420.0),),
            ),
            *self.bolt_sizes(design, foot),
        ]

    def features(self, design: DesignTables) -> Iterator[tuple[str, tuple[float, float]]]:
        yield "cross bolt", (self.cross_bolt_z(design), interface.middle_y(design.dimensions))

    def moment_share(self, design: DesignTables, z: float) -> float:
        """The moment falls from the foot, in proportion to the distance, to nothing at the end."""
        low = self.low_z(design)
        length = design.bone.post_length_mm - self.foot_length(design)
        return min(1.0, max(0.0, (z - low) / length))

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        bone, end = (
            design.bone,
            design.bone.foot_radius_mm - design.bone.base_length_mm - self.foot_length(design),
        )
        across = min(bone.post_height_mm, bone.post_width_mm)
        size = (bone.post_width_mm, across)
        factors = at_foot(
            interface.base_size(design.dimensions), size, bone.foot_radius_mm, end - z
        )

        return factors.combined_with(self.hole_factors(design, z, across))

    def bolt(self, design: DesignTables) -> Bolt:
        beside_mm = interface.MATING_PLAY_MM + 2 * interface.MATING_WALL_MM
        return self.choose_bolt(design, design.bone.post_width_mm, beside_mm)


@RULES.at_most("bone.foot_radius_mm", when=lambda design: design.bone.interface == "post")
def foot_clear_of_bolt(design: DesignTables) -> Limit:
    bone = design.bone
    hole_end = Post().cross_bolt_z(design) + bone.cross_bolt_diameter_mm / 2
    beside = Post().foot_length(design) - bone.foot_radius_mm
    return Limit(-bone.base_length_mm - hole_end - beside, "reaches the hole of the cross bolt")


@RULES.rule("bone.post_height_mm", bone_left_at_sides, bone_left_dorsally)
def post_not_higher_than_base(design: DesignTables) -> Violation | None:
    height = min(design.bone.post_height_mm, design.bone.post_width_mm)
    maximum = interface.base_size(design.dimensions)[1] - 2 * interface.MIN_SHOULDER_MM
    if design.bone.interface != "post" or height <= maximum + SLACK:
        return None

    return Violation(f"{height:g} mm is higher than the base with its shoulder", at_most(maximum))


@RULES.rule("bone.post_width_mm", bone_left_at_sides, bone_left_dorsally, post_not_higher_than_base)
def post_within_base(design: DesignTables) -> Violation | None:
    height = design.bone.post_height_mm

    def holds(width: float) -> bool:
        return interface.base_holds_circle(design, (width - SLACK) / 2, height / 2)

    if design.bone.interface != "post" or holds(design.bone.post_width_mm):
        return None

    highest = 2 * design.dimensions.bone_outline.section.half_width
    return Violation(
        f"{design.bone.post_width_mm:g} mm is wider than the base",
        at_most(bisect(holds, 0.0, highest, halvings=18)[0]),
    )


class Socket(CrossBolted):
    """Hole for a post of the phalanx, which holds the bone along its bore."""

    name = "socket"
    face_on_plate = "the proximal end, with the socket"
    weakest = "the thin wall of the socket"
    supports_inside = "; inside the socket"
    walled_hollow = "socket"

    def cross_bolt_z(self, design: DesignTables) -> float:
        """Axis of the cross bolt: halfway up the socket."""
        return -design.bone.base_length_mm + design.bone.socket_depth_mm / 2

    def depth(self, design: DesignTables) -> float:
        return design.bone.socket_depth_mm

    def shapes(self, design: DesignTables) -> Shapes:
        radius = design.bone.socket_diameter_mm / 2
        end = -design.bone.base_length_mm
        centre = (0.0, interface.middle_y(design.dimensions))
        bore = cylinder(
            "z",
            centre=centre,
            low=end - radius,
            high=end + design.bone.socket_depth_mm,
            radius=radius,
        )

        return (), (bore, self.bolt_hole(design))

    def genus(self, design: DesignTables) -> int:
        """Count two: the socket is blind, but it opens into the hole of
        the cross bolt, which has three mouths then.
        """
        return 2

    def sizes(self, design: DesignTables) -> list[Size]:
        bone, y, end = (
            design.bone,
            interface.middle_y(design.dimensions),
            -design.bone.base_length_mm,
        )
        return [
            interface.base_length_size(design),
            Circle(
                name="socket",
                growth=INNER,
                view="end",
                axis="z",
                centre=(0.0, y, end),
                radius=bone.socket_diameter_mm / 2,
            ),
            Length(
                name="depth of the socket",
                growth=STEP,
                view="section",
                side="below",
                axis="z",
                start=(0.0, y, end),
                end=(0.0, y, end + bone.socket_depth_mm),
            ),
            *self.bolt_sizes(design, end),
        ]

    def moment_share(self, design: DesignTables, z: float) -> float:
        """The moment falls from the bottom of the bore to nothing at its mouth."""
        bone = design.bone
        return min(1.0, max(0.0, (z + bone.base_length_mm) / bone.socket_depth_mm))

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        return self.hole_factors(
            design, z, design.bone.socket_diameter_mm + 2 * design.bone.wall_mm
        )

    def bolt(self, design: DesignTables) -> Bolt:
        return self.choose_bolt(design, 2 * design.dimensions.bone_outline.section.half_width, 0.0)


@RULES.rule("bone.socket_diameter_mm", bone_left_at_sides, bone_left_dorsally)
def socket_within_base(design: DesignTables) -> Violation | None:
    wall = design.bone.wall_mm
    diameter = design.bone.socket_diameter_mm
    if design.bone.interface != "socket" or interface.base_holds_circle(
        design, (diameter - SLACK) / 2 + wall
    ):
        return None

    _, height = interface.base_size(design.dimensions)
    room = (
        2
        * bisect(
            lambda radius: interface.base_holds_circle(design, radius), 0.0, height, halvings=30
        )[0]
    )
    return Violation(
        f"{diameter:g} mm leaves less than {wall:g} mm of base around it", at_most(room - 2 * wall)
    )


@RULES.at_most("bone.cross_bolt_diameter_mm")
def cross_bolt_within_interface(design: DesignTables) -> Limit | None:
    bone = design.bone
    if bone.interface == "socket":
        across = bone.socket_diameter_mm + bone.wall_mm
        along = bone.socket_depth_mm
    elif bone.interface == "post":
        across = min(bone.post_height_mm, bone.post_width_mm)
        along = bone.post_length_mm
    else:
        return None

    maximum = min(across, along) - 2 * bone.wall_mm
    return Limit(maximum, f"leaves less than {bone.wall_mm:g} mm around it in the {bone.interface}")
