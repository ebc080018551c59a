"""Post and socket, which hold the bone with a cross bolt, and their rules."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.design.formulas.stress_and_knock import StressFactors, at_foot
from fingertip.design.geometry import DesignTables
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
from fingertip.design.interfaces import interface
from fingertip.design.interfaces.interface import Bolt, CrossBolted
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_most
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally
from fingertip.foundation.numerics import bisect
from fingertip.models import post, socket
from fingertip.models.allowances import MATING_PLAY_MM

RULES = Ruleset()


class Post(CrossBolted):
    """Post on the bone, with two flats. It is held along its length."""

    name = "post"
    face_on_plate = "the end of the post"
    weakest = "the post, its weakest section"

    def cross_bolt_z(self, design: DesignTables) -> float:
        return post.cross_bolt_z(design)

    def low_z(self, design: DesignTables) -> float:
        return post.low_z(design)

    def foot_length(self, design: DesignTables) -> float:
        """Return the length of the fillet at the post's root [mm], with the slope on which the base
        prints.
        """
        return post.post_foot_length(design)

    def genus(self, design: DesignTables) -> int:
        return 1

    def sizes(self, design: DesignTables) -> list[Size]:
        bone = design.bone
        y = design.dimensions.base_middle_y
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
        yield "cross bolt", (self.cross_bolt_z(design), design.dimensions.base_middle_y)

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
        beside_mm = MATING_PLAY_MM + 2 * interface.MATING_WALL_MM
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
        return socket.cross_bolt_z(design)

    def depth(self, design: DesignTables) -> float:
        return design.bone.socket_depth_mm

    def genus(self, design: DesignTables) -> int:
        """Count two: the socket is blind, but it opens into the hole of the cross bolt, which has
        three mouths then.
        """
        return 2

    def sizes(self, design: DesignTables) -> list[Size]:
        bone, y, end = (
            design.bone,
            design.dimensions.base_middle_y,
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
