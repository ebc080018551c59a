"""Positions of inlet, bolts and keys around the mold's cavity, all derived from the parameters.

The mold is held with its proximal face down while it is filled, so that the apex of the tip is the cavity's highest
point. A syringe fills it from below: it stands on the dorsal face, beside the collar. Sprue and runner lead to the side
of the cavity. Its vents stand where the silicone arrives last, on the dorsal side near the tip
(`fingertip.filling.mold_filling`). All of them open with the mold, so that the cured sprue lifts out, and none touches
the pad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from fingertip.catalogues.hardware import LUER_DEPTH_MM, LUER_MOUTH_MM, SYRINGES, Syringe, Thread, select_thread

if TYPE_CHECKING:
    from fingertip.design.geometry.dimensions import Dimensions
    from fingertip.design.parameters import Tables
    from fingertip.design.parameters.parts import Mold


_BESIDE_BARREL_MM = 0.5
"""Gap between the barrel of the syringe and the heads of the bolts [mm]."""
_ABOVE_COLLAR_MM = 0.5
_GATE_END = 0.95
"""End of the runner inside the cavity, relative to the cavity's half width at the top of the runner."""
_ABOVE_RUNNER_MM = 1.0
"""Least length of the sprue between Luer cone and runner [mm]."""


@dataclass(frozen=True)
class Inlet:
    """Luer cone and sprue along y, and the runner along z, then x into the cavity: all in the dorsal half [mm]."""

    syringe: Syringe
    x: float
    z: float
    """Axis of cone and sprue."""
    gate_x: float
    """End of the runner, inside the cavity."""
    gate_z: float
    """Centre of the gate, along the finger."""
    width: float
    depth: float
    """Width and depth of the runner."""


class MoldLayout:
    """Positions and outline of the mold [mm], computed when they are first read as in `Dimensions`."""

    def __init__(self, design: Tables, dims: Dimensions) -> None:
        self._design, self._dims = design, dims

    @cached_property
    def nut_circumradius(self) -> float:
        return self._design.mold.nut_width_mm / math.sqrt(3)

    @cached_property
    def _half_column(self) -> float:
        """Half the width that bolts, keys and inlet need beside the cavity."""
        return max(self.nut_circumradius, self._design.mold.key_diameter_mm / 2, self.half_inlet)

    @cached_property
    def half_inlet(self) -> float:
        """Half the width of the inlet: of its Luer cone, or of a wider runner."""
        return max(LUER_MOUTH_MM, self._design.mold.runner_width_mm) / 2

    @cached_property
    def _column_x(self) -> float:
        cavity = self._design.skin.width_mm / 2 * self._dims.shrinkage
        return cavity + self._design.mold.land_mm + self._half_column

    @cached_property
    def half_width(self) -> float:
        return self._column_x + self._half_column + self._design.mold.land_mm

    @cached_property
    def palmar_height(self) -> float:
        return self._design.skin.semi_axis_palmar_mm * self._dims.shrinkage + self._design.mold.wall_mm

    @cached_property
    def dorsal_height(self) -> float:
        """Height of the dorsal half. It holds the Luer cone of the syringe above the runner."""
        mold = self._design.mold
        height = self._design.skin.semi_axis_dorsal_mm * self._dims.shrinkage + mold.wall_mm
        return max(height, LUER_DEPTH_MM + _ABOVE_RUNNER_MM + mold.runner_depth_mm)

    @cached_property
    def proximal_z(self) -> float:
        return -self._design.mold.recess_length_mm

    @cached_property
    def distal_z(self) -> float:
        """Distal face of the mold. Inlet, key and bolts beside the cavity can make it longer than the skin."""
        mold = self._design.mold
        around_skin = self._design.skin.length_mm * self._dims.shrinkage + mold.wall_mm
        beside_key = self._key_beside_inlet_z + self._small_key_reach + mold.land_mm + self.nut_circumradius
        past_barrel = self.inlet.z + self._barrel_to_bolt
        return max(around_skin, max(beside_key, past_barrel) + self._end_to_bolt)

    @cached_property
    def _end_to_bolt(self) -> float:
        return self._design.mold.land_mm + self.nut_circumradius

    @cached_property
    def _small_key_radius(self) -> float:
        return 0.4 * self._design.mold.key_diameter_mm

    @cached_property
    def _barrel_to_bolt(self) -> float:
        """Distance of the syringe's axis from that of a bolt, whose head is about as wide as its nut."""
        mold = self._design.mold
        head = select_thread(mold.bolt_diameter_mm).nut_flats_mm
        return (SYRINGES[mold.syringe].barrel_mm + head) / 2 + _BESIDE_BARREL_MM

    @cached_property
    def inlet(self) -> Inlet:
        """Inlet for the syringe, in the column of the bolts at +x."""
        mold = self._design.mold
        bolt_z, half = self.proximal_z + self._end_to_bolt, mold.runner_width_mm / 2
        # Silicone under pressure must not creep to the bolt, as it must not from the cavity.
        gate_z = max(_ABOVE_COLLAR_MM, bolt_z + mold.bolt_diameter_mm / 2 + mold.land_mm) + half
        z = max(bolt_z + self._barrel_to_bolt, gate_z + half + LUER_MOUTH_MM / 2)
        # The runner ends where the cavity is as wide at its top, so that it enters the cavity over its whole depth.
        end = self._dims.outer.half_width_at(mold.runner_depth_mm, gate_z + half)
        return Inlet(
            SYRINGES[mold.syringe], self._column_x, z, _GATE_END * end, gate_z, mold.runner_width_mm,
            mold.runner_depth_mm,
        )  # fmt: skip

    @cached_property
    def _bolts_z(self) -> tuple[float, float]:
        return self.proximal_z + self._end_to_bolt, self.distal_z - self._end_to_bolt

    @cached_property
    def bolts(self) -> tuple[tuple[float, float], ...]:
        return tuple((x, z) for x in (-self._column_x, self._column_x) for z in self._bolts_z)

    def _key_reach(self, root: float) -> float:
        """Reach of a key's socket from its axis, where its draft has widened it most."""
        mold, slope = self._design.mold, self._dims.draft_slope
        return root / 2 + slope * self.dorsal_height / 2 + mold.key_clearance_mm * math.hypot(1.0, slope)

    @property
    def _small_key_reach(self) -> float:
        return self._key_reach(2 * self._small_key_radius)

    def clear_side_z(self, z: float, width: float) -> float:
        """Find the height nearest to `z` [mm] at which a groove of this width passes the bolts and the key at -x."""
        wall = self._design.printer.min_wall_mm + width / 2
        key_z, root = self.keys[0][1], self._key_reach(self.keys[0][2])
        bolt = self._design.mold.bolt_diameter_mm / 2
        around = [(at - bolt - wall, at + bolt + wall) for at in self._bolts_z]
        around.append((key_z - root - wall, key_z + root + wall))
        candidates = [z, *(edge for interval in around for edge in interval)]
        inside = (self.proximal_z + wall, self.distal_z - wall)
        clear = [
            at for at in candidates
            if inside[0] <= at <= inside[1] and not any(low + 1e-9 < at < high - 1e-9 for low, high in around)
        ]  # fmt: skip
        return min(clear, key=lambda at: abs(at - z))

    @cached_property
    def pry_z(self) -> float:
        low, high = self._bolts_z
        return (low + high) / 2

    @cached_property
    def _key_beside_inlet_z(self) -> float:
        """Least height of the key in the column of the inlet."""
        return self.inlet.z + self.half_inlet + self._design.mold.land_mm + self._small_key_reach

    @cached_property
    def keys(self) -> tuple[tuple[float, float, float], ...]:
        """(x, z, root diameter) of each registration key.

        The keys have unequal diameters and sit off the middle by unequal amounts. A half that is turned round finds no
        socket for either of them, so the halves close in one way only.
        """
        mold = self._design.mold
        low, high = self._bolts_z
        shift = (high - low - 2 * self.nut_circumradius - mold.key_diameter_mm - 2 * mold.land_mm) / 4
        # Beside the inlet the second key has no room, and beside the proximal half of the cavity vents open.
        second = max(self.pry_z + shift / 2, self._key_beside_inlet_z)
        first = high - self.nut_circumradius - mold.land_mm - self._key_reach(mold.key_diameter_mm)
        return ((-self._column_x, first, mold.key_diameter_mm), (self._column_x, second, 2 * self._small_key_radius))


_BOLT_LENGTHS_MM = (
    5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 90, 100, 110, 120, 130, 140, 150
)  # fmt: skip
"""Standard lengths of metric bolts (ISO 888)."""


@dataclass(frozen=True)
class ClampBolts:
    """Identical bolts that hold the mold halves together, each with a nut."""

    count: int
    thread: Thread
    length_mm: float
    """Length below the head."""

    def stand_out_mm(self, layout: MoldLayout) -> float:
        """Length by which they stand out of the palmar face; negative if they end below it."""
        return self.length_mm - layout.dorsal_height - layout.palmar_height


def size_clamp_bolts(mold: Mold, layout: MoldLayout) -> ClampBolts:
    """Size the bolts: from the dorsal face through the nuts, at the bottom of their traps in the palmar face."""
    thread = select_thread(mold.bolt_diameter_mm)
    grip_mm = layout.dorsal_height + layout.palmar_height - mold.nut_depth_mm + thread.nut_height_mm
    return ClampBolts(len(layout.bolts), thread, standard_length_mm(grip_mm))


def standard_length_mm(wanted_mm: float) -> float:
    """Return the shortest standard length of a bolt that is at least this long [mm], or the longest of all."""
    return float(next((length for length in _BOLT_LENGTHS_MM if length >= wanted_mm), _BOLT_LENGTHS_MM[-1]))
