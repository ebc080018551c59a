"""Pose of the mold while it fills: how far it may tilt before more air stays beside the first vent than the check lets
pass.

Near the vent the cavity is a paraboloid with the curvatures k and K. Tilted by a small angle t, the highest point lies
t^2 / (2 k) above the vent, and the cap above the vent holds pi h^2 / sqrt(k K) of air.
"""

from __future__ import annotations

import math

from fingertip.design import Design
from fingertip.filling.mold_filling import MAX_AIR_MM3, place_vents

_STEP_MM = 0.2
"""Step of the slopes and curvatures of the cavity [mm]."""
_RESERVE = 2.0
"""Factor by which the cap of the paraboloid stays below the limit: away from the vent a cavity is flatter than that."""


def pose_tolerance_deg(design: Design) -> float | None:
    """Compute the angle by which the mold may tilt out of its pose [degrees]; None unless its first vent is dorsal.

    The bone below the cap takes some of its room, so that less air than that stays.
    """
    vent, height = place_vents(design)[0], design.dimensions.outer.dorsal_height_at
    x, y, z = vent.point_mm
    if vent.kind != "dorsal" or y <= 0.0:
        return None
    step = _STEP_MM
    middle, right, left = height(x, z), height(x + step, z), height(x - step, z)
    above, below = height(x, z + step), height(x, z - step)
    corners = (
        height(x + step, z + step)
        - height(x + step, z - step)
        - height(x - step, z + step)
        + height(x - step, z - step)
    )
    slope_x, slope_z = (right - left) / (2 * step), (above - below) / (2 * step)
    bent_x, bent_z = (right - 2 * middle + left) / step**2, (above - 2 * middle + below) / step**2
    twist = corners / (4 * step**2)
    # Mean and Gaussian curvature of a surface that is given by its height.
    squared = 1.0 + slope_x**2 + slope_z**2
    gaussian = (bent_x * bent_z - twist**2) / squared**2
    mean = -((1.0 + slope_z**2) * bent_x - 2.0 * slope_x * slope_z * twist + (1.0 + slope_x**2) * bent_z) / (
        2.0 * squared**1.5
    )
    flattest = mean - math.sqrt(max(0.0, mean**2 - gaussian))
    if flattest <= 0.0:
        return None
    return math.degrees((4.0 * MAX_AIR_MM3 / _RESERVE * flattest**2 * math.sqrt(gaussian) / math.pi) ** 0.25)
