"""Layout of the mold with what happens in it: where the core is seated, and the pressure of the
silicone.

The shapes of cup and core are those of `models.mold_layout`.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

from fingertip.design.geometry.plunge import estimate_pressure_kpa
from fingertip.models.making import making_of
from fingertip.models.mold_layout import (
    GAP_MM,
    RIDGE_HALF_CREST_MM,
    RIDGE_HEIGHT_MM,
    MoldLayout,
)

POURED = 1.35
"""Silicone in the cup, coats included, over that of the skin:
what is too much shows in all notches.
"""
BAND_N = 1.0
"""Force of a rubber band [N]: two go twice across the seam, one holds the core down.
An assumption.
"""
MAX_BENDING_MM = 0.01
_FREE = 0.36
"""Length of the cup that is free above the silicone before the
core is lowered, over that of the skin.
"""


class Flank(NamedTuple):
    """Flank of a ridge, by the middle of the line in which it meets
    its groove and by its normal into the ridge.
    """

    point_mm: tuple[float, float, float]
    normal: tuple[float, float, float]


class CastingLayout(MoldLayout):
    """Layout of the mold of one design [mm], with its seats and pressures."""

    @property
    def overall_height(self) -> float:
        """Height from the foot to the top of what is seated in the cup: the one reading that tells
        how it sits.
        """
        return self.foot_z - making_of(self._finger).top_z(self._finger)

    @property
    def overall_depth(self) -> float:
        """Depth of the face at the top, whose edges tell how far it leans."""
        low, high = making_of(self._finger).top_y(self._finger)
        return high - low

    @cached_property
    def flanks(self) -> tuple[Flank, ...]:
        """List the six flanks, each of which pushes the core up and sideways, away from
        its groove.
        """
        half = RIDGE_HALF_CREST_MM + (RIDGE_HEIGHT_MM - GAP_MM) / 2
        z = GAP_MM + (RIDGE_HEIGHT_MM - GAP_MM) / 2
        root = 0.5**0.5
        side, dorsal = self.ridge_begins
        x = (side + self.half_width) / 2
        y = (dorsal + self.dorsal_height) / 2
        along_x = (
            Flank((end * x, across * half, z), (0.0, -across * root, -root))
            for end in (-1.0, 1.0)
            for across in (-1.0, 1.0)
        )
        along_y = (
            Flank((across * half, y, z), (-across * root, 0.0, -root)) for across in (-1.0, 1.0)
        )

        return (*along_x, *along_y)

    @cached_property
    def pour_z(self) -> float:
        """Approximate height of the silicone's surface before the core
        is lowered, at the design's size of the skin.
        """
        return _FREE * self._finger.skin.length_mm

    @cached_property
    def plunge_kpa(self) -> float:
        """Pressure of the silicone at the tip of the core while it is
        lowered, up to a tenth more than in the cup.
        """
        lowering_s = making_of(self._finger).lowering_s
        return estimate_pressure_kpa(self._finger, self._dims, self.pour_z, lowering_s)

    @cached_property
    def held_kpa(self) -> float:
        """Pressure at which the cup opens against its bands."""
        return 4e3 * BAND_N / (self.foot_z * self.cavity_half_width * 2)

    def core_bending_mm(self, pressure_kpa: float) -> float:
        """Compute the deflection of the core's tip if the pressure acted on all of one side, and
        none on the other.

        Of its section half counts: the middle is infill.
        """
        section = self._dims.bone_outline.section
        skin = self._finger.skin
        height = section.dorsal + self._dims.flat_depth
        width = 2 * section.half_width
        stiffness = self._finger.strength.material.modulus_mpa * 0.5 * width * height**3 / 12

        return (
            1e-3
            * pressure_kpa
            * width
            * (skin.length_mm - skin.thickness_tip_mm) ** 4
            / (8 * stiffness)
        )
