"""Sizes of the mold, a cup and its core, all derived from the parameters.

The cup stands on its foot, tip down, and is open at the proximal end of the skin. The core hangs on
a plate, whose underside is the plane z = 0 in which the skin ends. Three radial ridges of the
plate, at 3, 9 and 12 o'clock, seat in grooves of the rim: six flanks at 45 degrees, which hold it
in all six directions. The rim stays a gap below the plate, so that the flanks alone decide where
the core is; silicone that is too much leaves through gap and notches.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from fingertip.design.geometry.plunge import estimate_pressure_kpa

if TYPE_CHECKING:
    from fingertip.design.geometry.dimensions import Dimensions
    from fingertip.design.parameters import Tables

GAP_MM = 0.3
"""Gap between plate and rim [mm]."""
LIP_GAP_MM = 0.15
LIP_WIDTH_MM = 1.5
"""Gap at the lip around the cavity, and width of the lip [mm]. The core sinks by 0.14 mm by errors
of 0.1 mm of every flank; the narrow gap leaves most of what overflows to the notches.
"""
LAND_MM = 4.5
"""Least width of the rim between cavity and grooves [mm]."""
_OUT = 1.05
_FARTHEST_OUT = 1.5
"""Least and largest distance of the dorsal ridge's middle from the parting plane, over that of the
sensor from the skin's end.
"""
RIDGE_HEIGHT_MM = 2.0
RIDGE_HALF_CREST_MM = 0.4
RIDGE_LENGTH_MM = 4.5
RIDGE_END_MM = 0.5
"""Distance of each end of a ridge from the end of its groove [mm], so that no end locates
the core.
"""
PLATE_MM = 5.0
PLATE_LEDGE_MM = 3.0
"""Thickness of the plate, and width by which it stands out beyond
the cup at both sides, to lift it by [mm].
"""
POURED = 1.35
"""Silicone in the cup, coats included, over that of the skin:
what is too much shows in all notches.
"""
NOTCH_MM = (3.0, 1.5)
"""Width and depth of the overflow notches [mm]."""
BAND_N = 1.0
"""Force of a rubber band [N]: two go twice across the seam, one holds the core down.
An assumption.
"""
BELT_MM = (6.0, 1.0)
"""Height of the belts for rubber bands at their floor, and depth [mm]."""
STRAP_Y_MM = 5.0
"""Middle of the seats of a third band, over plate and foot, between the ridges [mm]."""
KEY_SIZES_MM = (5.0, 4.0)
"""Root diameters of both keys [mm]; their flanks rise at 45
degrees, so that they print on upright halves.
"""
KEY_CLEARANCE_MM = 0.15
"""Gap around a printed key [mm]."""
KEY_TOP_MM = 1.0
"""Diameter of a key at its end [mm]."""
FOOT_CHAMFER_MM = 0.6
"""Chamfer of the seam at the foot, where a print's first layers bulge [mm]."""
MAX_BENDING_MM = 0.01
PRY_MM = (6.5, 2.5, 1.2)
"""Height, depth and half the width of the slots at the foot, in
which a blade parts the halves [mm].
"""
_BESIDE_GROOVE_MM = 1.0
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


class Key(NamedTuple):
    x: float
    z: float
    root_mm: float


class MoldLayout:
    """Positions and outline of cup and core [mm], computed when
    they are first read as in `Dimensions`.
    """

    def __init__(self, design: Tables, dims: Dimensions) -> None:
        self._design = design
        self._dims = dims

    @cached_property
    def cavity_half_width(self) -> float:
        return self._design.skin.width_mm / 2 * self._dims.shrinkage

    @cached_property
    def half_width(self) -> float:
        return self.cavity_half_width + LAND_MM + RIDGE_LENGTH_MM

    @cached_property
    def palmar_height(self) -> float:
        return (
            self._design.skin.semi_axis_palmar_mm * self._dims.shrinkage + self._design.mold.wall_mm
        )

    @cached_property
    def dorsal_height(self) -> float:
        """Height of the dorsal half, on whose rim the third groove lies."""
        around_skin = (
            self._design.skin.semi_axis_dorsal_mm * self._dims.shrinkage + self._design.mold.wall_mm
        )
        return max(self.ridge_begins[1] + RIDGE_LENGTH_MM, around_skin)

    @cached_property
    def foot_z(self) -> float:
        """Height of the face on which the cup stands."""
        return self._design.skin.length_mm * self._dims.shrinkage + self._design.mold.wall_mm

    @property
    def overall_height(self) -> float:
        """Height from the foot to the top of the seated plate: the
        one reading that tells how the core sits.
        """
        return self.foot_z + PLATE_MM

    @cached_property
    def ridge_begins(self) -> tuple[float, float]:
        """Distance from the axis at which the grooves begin: at the sides, and on the dorsal side.

        The dorsal one lies as far out as the sensor is deep: its errors tilt the core. Over a
        sensor at 1 / out of its distance the flanks' errors add up to sqrt(2) (1 + 1 / out) of one:
        it lies farther out where the skin is thin.
        """
        beside = self._design.skin.semi_axis_dorsal_mm * self._dims.shrinkage + LAND_MM
        skin = self._design.skin
        out = min(
            _FARTHEST_OUT, max(_OUT, 1.03 / max(skin.thickness_palmar_mm / 2**0.5 - 1.0, 0.5))
        )

        return self.cavity_half_width + LAND_MM, max(
            beside, out * self._dims.sensor_z - RIDGE_LENGTH_MM / 2
        )

    @cached_property
    def notch_x(self) -> float:
        """Distance of the notches from the middle plane, clear of the dorsal groove."""
        clear = RIDGE_HALF_CREST_MM + RIDGE_HEIGHT_MM + _BESIDE_GROOVE_MM + NOTCH_MM[0] / 2
        return max(clear, self.cavity_half_width / 2)

    @cached_property
    def belts_z(self) -> tuple[float, float]:
        """Middle of the belts for rubber bands."""
        return self.foot_z / 4, 3 * self.foot_z / 4

    @cached_property
    def keys(self) -> tuple[Key, Key]:
        """Keys of unequal sizes at unequal heights, so that no other way round closes the cup."""
        x = (self.half_width - BELT_MM[1] + self.cavity_half_width) / 2
        return Key(-x, 0.4 * self.foot_z, KEY_SIZES_MM[0]), Key(
            x, 0.7 * self.foot_z, KEY_SIZES_MM[1]
        )

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
        return _FREE * self._design.skin.length_mm

    @cached_property
    def plunge_kpa(self) -> float:
        """Pressure of the silicone at the tip of the core while it is
        lowered, up to a tenth more than in the cup.
        """
        return estimate_pressure_kpa(self._design, self._dims, self.pour_z)

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
        skin = self._design.skin
        height = section.dorsal + self._dims.flat_depth
        width = 2 * section.half_width
        stiffness = self._design.strength.material.modulus_mpa * 0.5 * width * height**3 / 12

        return (
            1e-3
            * pressure_kpa
            * width
            * (skin.length_mm - skin.thickness_tip_mm) ** 4
            / (8 * stiffness)
        )
