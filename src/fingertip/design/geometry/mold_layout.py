"""Where gate, vents, bolts and keys sit around the cavity: derived, so that nothing is placed twice.

The mold is held with its proximal face down while it is filled, so the tip's apex is the cavity's highest point. Gate
and vents lie on the parting plane: they open with the mold, and the cured sprue lifts out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.geometry.dimensions import Dimensions
from fingertip.design.parameters import DesignTables


@dataclass(frozen=True)
class MoldLayout:
    """Positions and outline of the mold [mm]."""

    half_width: float
    palmar_height: float
    dorsal_height: float
    proximal_z: float
    distal_z: float
    gate_x: float
    vents_x: tuple[float, ...]
    inlet_z: float
    """Gate and vents begin here, inside the cavity."""
    bolts: tuple[tuple[float, float], ...]
    """(x, z) of each clamp bolt."""
    keys: tuple[tuple[float, float, float], ...]
    """(x, z, root diameter) of each key: unequal, so that the halves close in one way only."""
    pry_z: float
    """Middle of the pry slots."""
    nut_circumradius: float
    key_space: float
    """Length along z left for the keys between the nut traps."""


def lay_out(design: DesignTables, dims: Dimensions) -> MoldLayout:
    """Place everything around the cavity."""
    mold, skin = design.mold, design.skin
    nut = mold.nut_width_mm / math.sqrt(3)
    column = skin.width_mm / 2 * dims.shrinkage + mold.land_mm + max(nut, mold.key_diameter_mm / 2)
    half_width = column + max(nut, mold.key_diameter_mm / 2) + mold.land_mm
    proximal = -mold.recess_length_mm
    distal = skin.length_mm * dims.shrinkage + mold.wall_mm + mold.funnel_depth_mm
    low, high = proximal + mold.land_mm + nut, distal - mold.land_mm - nut
    key_space = high - low - 2 * nut
    gate_x = -(mold.vent_diameter_mm / 2 + 1.2 + mold.funnel_diameter_mm / 2)
    second = 0.8 * mold.key_diameter_mm
    # The keys sit off the middle by different amounts: turned round, neither finds its socket.
    shift = (key_space - mold.key_diameter_mm - 2 * mold.land_mm) / 4
    middle = (low + high) / 2
    return MoldLayout(
        half_width=half_width,
        palmar_height=skin.semi_axis_palmar_mm * dims.shrinkage + mold.wall_mm,
        dorsal_height=skin.semi_axis_dorsal_mm * dims.shrinkage + mold.wall_mm,
        proximal_z=proximal,
        distal_z=distal,
        gate_x=gate_x,
        vents_x=(0.0, -gate_x),
        inlet_z=skin.length_mm - skin.tip_length_mm,
        bolts=tuple((x, z) for x in (-column, column) for z in (low, high)),
        keys=((-column, middle - shift, mold.key_diameter_mm), (column, middle + shift / 2, second)),
        pry_z=middle,
        nut_circumradius=nut,
        key_space=key_space,
    )
