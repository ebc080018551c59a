"""Designs whose skin counts as bonded to the bone, with figures
that finite elements found for them.
"""

from __future__ import annotations

from fingertip.design import Design

_BONDED = {"skin.made": "encapsulated", "silicone.product": "addition_40a"}
CROWNED = Design().with_values(_BONDED)
STRAIGHT = CROWNED.with_values(
    {
        "skin.crown_radius_mm": 0.0,
        "bone.platform_mm": 0.0,
        "skin.semi_axis_palmar_mm": 6.0,
        "skin.pulp_fullness": 0.8845,
        "bone.palmar_fullness": 0.9422,
        "skin.thickness_side_mm": 2.0,
        "skin.thickness_tip_mm": 2.5,
        "skin.semi_axis_dorsal_mm": 7.0,
    }
)
