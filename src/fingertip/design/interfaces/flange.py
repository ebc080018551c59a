"""Flange: a plate with bolt holes at the end of the bone, and its rules."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.catalogues.hardware import select_thread, standard_length_mm
from fingertip.design.formulas.stress_and_knock import LocalStress, StressFactors, at_foot
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.sizes import BEFORE_FACE, INNER, OUTER, STEP, Circle, Length, Size
from fingertip.design.interfaces import interface
from fingertip.design.interfaces.interface import JointInterface
from fingertip.design.rules.ruleset import SLACK, Limit, Ruleset, Violation, at_least

RULES = Ruleset()

_HEAD_CLEARANCE = 0.3
"""Least gap between the base and the head of a bolt [mm]."""


class Flange(JointInterface):
    """Plate with bolt holes at the proximal end of the base. It bends between base and bolts."""

    name = "flange"
    face_on_plate = "the flange"
    weakest = "the flange, whose root is its weakest section"

    def depth(self, design: DesignTables) -> float:
        return design.bone.flange_thickness_mm + design.bone.foot_radius_mm

    def genus(self, design: DesignTables) -> int:
        return 4 if design.bone.flange_spacing_y_mm else 2

    def sizes(self, design: DesignTables) -> list[Size]:
        bone, y, end = (
            design.bone,
            design.dimensions.base_middle_y,
            -design.bone.base_length_mm,
        )
        x = bone.flange_width_mm / 2
        half = bone.flange_height_mm / 2
        rows = bone.flange_spacing_y_mm / 2
        hole_x = bone.flange_spacing_x_mm / 2
        top = end + bone.flange_thickness_mm
        radius = bone.foot_radius_mm
        corner = (0.0, -design.dimensions.base_flat_depth - radius, top + radius)
        sizes: list[Size] = [
            interface.base_length_size(design),
            Length(
                name="width of the flange",
                growth=OUTER,
                view="end",
                side="below",
                axis="x",
                start=(x, y - half, end),
                end=(-x, y - half, end),
            ),
            Length(
                name="height of the flange",
                growth=OUTER,
                view="end",
                side="left",
                axis="y",
                start=(x, y - half, end),
                end=(x, y + half, end),
            ),
            Length(
                name="thickness of the flange",
                growth=OUTER,
                view="front",
                side="above",
                axis="z",
                start=(0.0, y + half, end),
                end=(0.0, y + half, top),
            ),
            Length(
                name="spacing of the bolt holes",
                growth=STEP,
                view="end",
                side="above",
                axis="x",
                start=(hole_x, y + rows, end),
                end=(-hole_x, y + rows, end),
            ),
            Circle(
                name="bolt holes of the flange",
                growth=INNER,
                view="end",
                axis="z",
                centre=(hole_x, y + rows, end),
                radius=bone.flange_hole_diameter_mm / 2,
                tolerance=interface.bolt_clearance(design, bone.flange_hole_diameter_mm),
                count=self.genus(design),
            ),
            Circle(
                name="fillet at the root of the base",
                growth=BEFORE_FACE,
                view="front",
                axis="x",
                centre=corner,
                radius=radius,
                is_radius=True,
                hidden_deg=((178.0, 452.0),),
            ),
        ]

        if rows:
            low = (-hole_x, y - rows, end)
            high = (-hole_x, y + rows, end)
            sizes.append(
                Length(
                    name="spacing of the rows",
                    growth=STEP,
                    view="end",
                    side="right",
                    axis="y",
                    start=low,
                    end=high,
                )
            )

        return sizes

    def beam_begin_z(self, design: DesignTables, low_z: float) -> float:
        return low_z + design.bone.flange_thickness_mm

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        bone = design.bone
        base = interface.base_size(design.dimensions)
        root = -bone.base_length_mm + bone.flange_thickness_mm
        return at_foot(
            (bone.flange_width_mm, bone.flange_height_mm), base, bone.foot_radius_mm, z - root
        )

    def local_stresses(self, design: DesignTables, load_z: float) -> Iterator[LocalStress]:
        """Find the bending stress of the flange where the base stands on it, which its bolts pull
        off the phalanx.

        A load from the side or from above is held by a couple: bolts on one side, and bolts or the
        flange's edge on the other. The plate is a cantilever between the couple's line and the
        base.
        """
        bone = design.bone
        base_width, base_height = interface.base_size(design.dimensions)
        arm = load_z + bone.base_length_mm
        modulus = bone.flange_thickness_mm**2 / 6
        per_n = []

        for spacing, size, base, across in (
            (bone.flange_spacing_x_mm, bone.flange_width_mm, base_width, bone.flange_height_mm),
            (bone.flange_spacing_y_mm, bone.flange_height_mm, base_height, bone.flange_width_mm),
        ):
            # Without a second row the flange turns about its edge, and the bolts pull in its
            # middle.
            couple = arm / (spacing if spacing else size / 2)
            lever = max((spacing if spacing else size) - base, 0.0) / 2
            per_n.append(couple * lever / (across * modulus))

        stress = math.hypot(*per_n)
        direction = (
            (round(per_n[0] / stress, 6), round(per_n[1] / stress, 6), 0.0)
            if stress
            else (0.0, 1.0, 0.0)
        )
        yield LocalStress(
            "flange", -bone.base_length_mm + bone.flange_thickness_mm, stress, direction=direction
        )

    def bolt(self, design: DesignTables) -> interface.Bolt:
        thread = select_thread(design.bone.flange_hole_diameter_mm)
        across_mm = design.bone.flange_thickness_mm
        length_mm = standard_length_mm(across_mm + interface.MATING_WALL_MM + thread.nut_height_mm)
        return interface.Bolt(thread.diameter_mm, length_mm, across_mm, self.genus(design))


@RULES.at_least("bone.flange_spacing_x_mm")
def flange_bolts_clear_of_base(design: DesignTables) -> Limit | None:
    """The heads of the flange's bolts lie beside the base and its fillet, or above and below it."""
    bone = design.bone
    width, height = interface.base_size(design.dimensions)
    # The heads of machine screws are as wide as the nuts across flats (ISO 4762).
    head = select_thread(bone.flange_hole_diameter_mm).nut_flats_mm / 2 + max(
        _HEAD_CLEARANCE, bone.foot_radius_mm
    )
    if bone.interface != "flange" or bone.flange_spacing_y_mm >= height + 2 * head:
        return None

    return Limit(2 * (width / 2 + head), "leaves no room for bolt heads beside the base")


@RULES.at_least("bone.flange_width_mm", when=lambda design: design.bone.interface == "flange")
def flange_wide_enough(design: DesignTables) -> Limit:
    bone = design.bone
    minimum = bone.flange_spacing_x_mm + bone.flange_hole_diameter_mm + 2 * bone.wall_mm
    base = 2 * (design.dimensions.bone_outline.section.half_width + interface.MIN_SHOULDER_MM)
    holes = f"leaves less than {bone.wall_mm:g} mm beside the bolt holes"

    return Limit(max(minimum, base), holes if minimum > base else "is less than the base's")


@RULES.at_least("bone.flange_height_mm", when=lambda design: design.bone.interface == "flange")
def flange_high_enough(design: DesignTables) -> Limit:
    bone = design.bone
    minimum = bone.flange_spacing_y_mm + bone.flange_hole_diameter_mm + 2 * bone.wall_mm
    base = interface.base_size(design.dimensions)[1] + 2 * interface.MIN_SHOULDER_MM
    what = (
        "leaves too little above and below the bolt holes"
        if minimum > base
        else "is less than the base's height"
    )

    return Limit(max(minimum, base), what)


@RULES.rule("bone.flange_spacing_y_mm")
def flange_rows_keep_a_wall(design: DesignTables) -> Violation | None:
    bone = design.bone
    minimum = bone.flange_hole_diameter_mm + bone.wall_mm
    if bone.interface != "flange" or not 0.0 < bone.flange_spacing_y_mm < minimum - SLACK:
        return None

    return Violation(
        f"{bone.flange_spacing_y_mm:g} mm leaves less than {bone.wall_mm:g} mm between the rows "
        "of bolt holes",
        ((0.0, 0.0), *at_least(minimum)),
    )


@RULES.at_least("bone.flange_thickness_mm", when=lambda design: design.bone.interface == "flange")
def flange_prints(design: DesignTables) -> Limit:
    return Limit(design.bone.wall_mm, "is thinner than a wall")
