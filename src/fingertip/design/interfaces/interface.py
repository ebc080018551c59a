"""Interface of the bone to the proximal phalanx, and what each brings: shapes, sizes to check,
strength and words.

Its parameters stand in the table [bone], and its rules beside it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.catalogues.hardware import select_thread, standard_length_mm
from fingertip.design.formulas.stress_and_knock import LocalStress, StressFactors, hole_in_tension
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.sizes import (
    BEHIND_FACE,
    INNER,
    OUTER,
    Circle,
    Length,
    Size,
    Tolerance,
    clearance,
)
from fingertip.design.rules.ruleset import SLACK
from fingertip.models.dimensions import Dimensions

_CIRCLE_POINTS = 64
"""Intervals at which half a circle is sampled."""
MATING_WALL_MM = 2.5
"""Wall of a printed mating part [mm]. A recommendation."""
MIN_SHOULDER_MM = 0.1
"""Least height of the step from a post to the base, or from the base to a flange [mm]."""


@dataclass(frozen=True)
class Bolt:
    """Machine screw with a nut [mm]."""

    thread_mm: float
    length_mm: float
    crossed_mm: float
    """Length of the bone that it passes."""
    count: int = 1


class JointInterface:
    """Interface of the bone to the proximal phalanx. All lengths are in mm."""

    name: str
    """Value of bone.interface."""
    face_on_plate: str
    """Face on which the bone stands while it prints, in words."""
    weakest: str
    """Feature that must not be pushed when the finger is taken out of the mold, in words."""
    supports_below = "under the foot of the collar and the end of the base, outside"
    """Places of supports at the proximal end, in words."""
    supports_inside = ""
    """Further places of supports, in words."""
    walled_hollow = ""
    """Name of a hollow in the base around which checks measure the
    walls; the first solid that is removed.
    """

    def genus(self, design: DesignTables) -> int:
        """Count the through holes of the interface."""
        raise NotImplementedError

    def depth(self, design: DesignTables) -> float:
        """Length of the base that the interface takes."""
        return 0.0

    def low_z(self, design: DesignTables) -> float:
        return -design.bone.base_length_mm

    def sizes(self, design: DesignTables) -> list[Size]:
        """List the sizes for the drawing of the bone."""
        raise NotImplementedError

    def notes(self, design: DesignTables) -> tuple[str, ...]:
        """List what the drawing of the bone states in words."""
        return ()

    def features(self, design: DesignTables) -> Iterator[tuple[str, tuple[float, float]]]:
        """Yield what a picture of the section names, with (z, y) of a point on it."""
        yield from ()

    def beam_begin_z(self, design: DesignTables, low_z: float) -> float:
        """Height from which on the bone bends as a beam; `low_z` is its proximal end."""
        return low_z

    def moment_share(self, design: DesignTables, z: float) -> float:
        """Fraction of the bending moment that a section carries,
        because the phalanx holds the interface.
        """
        return 1.0

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        """Find the stress concentration factors at a height; a
        shoulder acts half the thinner side's height far.
        """
        return StressFactors()

    def local_stresses(self, design: DesignTables, load_z: float) -> Iterator[LocalStress]:
        """Yield stresses besides those of bent cross-sections,
        under a load at a height of the finger.
        """
        yield from ()

    def bolt(self, design: DesignTables) -> Bolt | None:
        """Return what holds the bone to the proximal phalanx; None for a joint, which has a pin."""
        return None


def base_size(dims: Dimensions) -> tuple[float, float]:
    section = dims.bone_outline.section
    return 2 * section.half_width, section.dorsal + dims.base_flat_depth


def base_length_size(design: DesignTables) -> Length:
    """Length of a base that ends in a plane."""
    y = design.dimensions.base_middle_y
    end = -design.bone.base_length_mm
    return Length(
        name="length of the base",
        growth=OUTER,
        view="front",
        side="below",
        axis="z",
        start=(0.0, y, end),
        end=(0.0, y, 0.0),
    )


def bolt_clearance(design: DesignTables, hole_mm: float) -> Tolerance:
    """Tolerance of a printed hole that a bolt passes."""
    return clearance(hole_mm - design.printer.offset_mm - select_thread(hole_mm).diameter_mm)


def base_holds_circle(design: DesignTables, radius: float, half_height: float = math.inf) -> bool:
    """Return whether a circle in the middle of the base, with flats at
    `half_height` [mm], stays inside its section.
    """
    section = design.dimensions.bone_outline.section
    flat = design.dimensions.base_flat_depth
    middle = (section.dorsal - flat) / 2
    half_height = min(radius, half_height)
    if half_height >= (section.dorsal + flat) / 2:
        return False

    last = math.asin(half_height / radius) if radius > 0.0 else 0.0
    angles = (last * (2 * i / _CIRCLE_POINTS - 1) for i in range(_CIRCLE_POINTS + 1))
    return all(
        radius * math.cos(angle)
        <= section.half_width_at(max(middle + radius * math.sin(angle), -flat)) + SLACK
        for angle in angles
    )


class CrossBolted(JointInterface):
    """Interface that a bolt across it holds in place."""

    def bolt(self, design: DesignTables) -> Bolt:
        raise NotImplementedError

    def cross_bolt_z(self, design: DesignTables) -> float:
        raise NotImplementedError

    def bolt_sizes(self, design: DesignTables, begin_z: float) -> list[Size]:
        """Place of the cross bolt's axis from a face of the interface, and its hole."""
        dims = design.dimensions
        hole = design.bone.cross_bolt_diameter_mm
        y = dims.base_middle_y
        z = self.cross_bolt_z(design)

        return [
            Length(
                name="axis of the cross bolt",
                growth=BEHIND_FACE,
                view="front",
                side="above",
                axis="z",
                start=(0.0, y, begin_z),
                end=(0.0, y, z),
            ),
            Circle(
                name="hole of the cross bolt",
                growth=INNER,
                view="front",
                axis="x",
                centre=(dims.bone_outline.section.half_width, y, z),
                radius=hole / 2,
                tolerance=bolt_clearance(design, hole),
            ),
        ]

    def hole_factors(self, design: DesignTables, z: float, across_mm: float) -> StressFactors:
        """Factors at the hole of the cross bolt, through a bar of this width."""
        diameter = design.bone.cross_bolt_diameter_mm
        if abs(z - self.cross_bolt_z(design)) > diameter / 2:
            return StressFactors()

        factor = hole_in_tension(diameter, across_mm)
        return StressFactors(factor, factor)

    def choose_bolt(self, design: DesignTables, crossed_mm: float, beside_mm: float) -> Bolt:
        """Choose a bolt with its nut that crosses the
        interface, and `beside_mm` of its mating part.
        """
        thread = select_thread(design.bone.cross_bolt_diameter_mm)
        length_mm = standard_length_mm(crossed_mm + beside_mm + thread.nut_height_mm)
        return Bolt(thread.diameter_mm, length_mm, round(crossed_mm, 1))
