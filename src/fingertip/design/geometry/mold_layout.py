"""Positions of gate, vents, bolts and keys around the mold's cavity, all derived from the parameters.

The mold is held with its proximal face down while it is filled, so that the apex of the tip is the cavity's highest
point. Gate and vents lie on the parting plane: they open with the mold, and the cured sprue lifts out.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingertip.design.parameters import DesignTables

_GATE_TO_VENT_MM = 1.2
"""Mold left between the funnel's mouth and the vent at the apex [mm]."""


class MoldLayout:
    """Positions and outline of the mold [mm].

    Each value is computed when it is first read, from the parameters it depends on alone, as in `Dimensions`.
    """

    def __init__(self, design: DesignTables) -> None:
        self._design = design

    @cached_property
    def nut_circumradius(self) -> float:
        """Radius of the circle through the corners of a nut trap."""
        return self._design.mold.nut_width_mm / math.sqrt(3)

    @cached_property
    def _half_column(self) -> float:
        """Half the width that bolts and keys need beside the cavity."""
        return max(self.nut_circumradius, self._design.mold.key_diameter_mm / 2)

    @cached_property
    def _column_x(self) -> float:
        """Distance of the bolts and keys from the middle plane."""
        cavity = self._design.skin.width_mm / 2 * self._design.dimensions.shrinkage
        return cavity + self._design.mold.land_mm + self._half_column

    @cached_property
    def half_width(self) -> float:
        """Half the width of the mold."""
        return self._column_x + self._half_column + self._design.mold.land_mm

    @cached_property
    def palmar_height(self) -> float:
        """Height of the palmar half."""
        return self._design.skin.semi_axis_palmar_mm * self._design.dimensions.shrinkage + self._design.mold.wall_mm

    @cached_property
    def dorsal_height(self) -> float:
        """Height of the dorsal half."""
        return self._design.skin.semi_axis_dorsal_mm * self._design.dimensions.shrinkage + self._design.mold.wall_mm

    @cached_property
    def proximal_z(self) -> float:
        """Proximal face of the mold."""
        return -self._design.mold.recess_length_mm

    @cached_property
    def distal_z(self) -> float:
        """Distal face of the mold."""
        mold = self._design.mold
        return self._design.skin.length_mm * self._design.dimensions.shrinkage + mold.wall_mm + mold.funnel_depth_mm

    @cached_property
    def gate_x(self) -> float:
        """Centre of the gate, beside the vent at the apex."""
        mold = self._design.mold
        return -(mold.vent_diameter_mm / 2 + _GATE_TO_VENT_MM + mold.funnel_diameter_mm / 2)

    @cached_property
    def vents_x(self) -> tuple[float, ...]:
        """Centres of the vents: one at the apex, one opposite the gate."""
        return (0.0, -self.gate_x)

    @cached_property
    def inlet_z(self) -> float:
        """Height at which gate and vents begin, inside the cavity."""
        return self._design.dimensions.taper_end_z

    @cached_property
    def _bolts_z(self) -> tuple[float, float]:
        """Heights of the proximal and the distal pair of bolts."""
        margin = self._design.mold.land_mm
        return self.proximal_z + margin + self.nut_circumradius, self.distal_z - margin - self.nut_circumradius

    @cached_property
    def bolts(self) -> tuple[tuple[float, float], ...]:
        """(x, z) of each clamp bolt."""
        return tuple((x, z) for x in (-self._column_x, self._column_x) for z in self._bolts_z)

    @cached_property
    def key_space(self) -> float:
        """Length along z that the nut traps leave for the keys."""
        low, high = self._bolts_z
        return high - low - 2 * self.nut_circumradius

    @cached_property
    def pry_z(self) -> float:
        """Centre of the pry slots."""
        low, high = self._bolts_z
        return (low + high) / 2

    @cached_property
    def keys(self) -> tuple[tuple[float, float, float], ...]:
        """(x, z, root diameter) of each registration key.

        The keys have unequal diameters and sit off the middle by unequal amounts. A half that is turned round finds no
        socket for either of them, so the halves close in one way only.
        """
        mold = self._design.mold
        second = 0.8 * mold.key_diameter_mm
        shift = (self.key_space - mold.key_diameter_mm - 2 * mold.land_mm) / 4
        return (
            (-self._column_x, self.pry_z - shift, mold.key_diameter_mm),
            (self._column_x, self.pry_z + shift / 2, second),
        )
