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

if TYPE_CHECKING:
    from .dimensions import Dimensions
    from .program_types import Finger

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
NOTCH_MM = (3.0, 1.5)
"""Width and depth of the overflow notches [mm]."""
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
PRY_MM = (6.5, 2.5, 1.2)
"""Height, depth and half the width of the slots at the foot, in
which a blade parts the halves [mm].
"""
_BESIDE_GROOVE_MM = 1.0


class Key(NamedTuple):
    x: float
    z: float
    root_mm: float


class MoldLayout:
    """Positions and outline of cup and core [mm], computed when
    they are first read as in `Dimensions`.
    """

    def __init__(self, finger: Finger, dims: Dimensions) -> None:
        self._finger = finger
        self._dims = dims

    @cached_property
    def cavity_half_width(self) -> float:
        return self._finger.skin.width_mm / 2 * self._dims.shrinkage

    @cached_property
    def half_width(self) -> float:
        return self.cavity_half_width + LAND_MM + RIDGE_LENGTH_MM

    @cached_property
    def palmar_height(self) -> float:
        return (
            self._finger.skin.semi_axis_palmar_mm * self._dims.shrinkage + self._finger.mold.wall_mm
        )

    @cached_property
    def dorsal_height(self) -> float:
        """Height of the dorsal half, on whose rim the third groove lies."""
        around_skin = (
            self._finger.skin.semi_axis_dorsal_mm * self._dims.shrinkage + self._finger.mold.wall_mm
        )
        return max(self.ridge_begins[1] + RIDGE_LENGTH_MM, around_skin)

    @cached_property
    def foot_z(self) -> float:
        """Height of the face on which the cup stands."""
        return self._finger.skin.length_mm * self._dims.shrinkage + self._finger.mold.wall_mm

    @cached_property
    def ridge_begins(self) -> tuple[float, float]:
        """Distance from the axis at which the grooves begin: at the sides, and on the dorsal side.

        The dorsal one lies as far out as the sensor is deep: its errors tilt the core. Over a
        sensor at 1 / out of its distance the flanks' errors add up to sqrt(2) (1 + 1 / out) of one:
        it lies farther out where the skin is thin.
        """
        beside = self._finger.skin.semi_axis_dorsal_mm * self._dims.shrinkage + LAND_MM
        skin = self._finger.skin
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
