"""Stress concentration at a shoulder with a fillet, and at a hole.

W. C. Young, R. G. Budynas, A. M. Sadegh, Roark's Formulas for Stress and Strain, 8th ed., 2012, table 17.1.
"""

from __future__ import annotations

import math

MIN_RATIO, MAX_RATIO = 0.25, 20.0
"""Range of the step's height over the fillet's radius in which the formula holds."""


def shoulder_in_bending(large_mm: float, small_mm: float, fillet_mm: float) -> float:
    """Factor at a shoulder between two round shafts. It multiplies the stress of the thinner one.

    Parameters
    ----------
    large_mm, small_mm
        Diameters on both sides of the shoulder [mm]. 1 if the shaft does not become thinner.
    fillet_mm
        Radius of the fillet [mm]. Outside the formula's range the end of the range counts, so a sharp corner has the
        factor of a step 20 times as high as its radius.
    """
    h = (large_mm - small_mm) / 2
    if h <= 0.0:
        return 1.0
    q = min(max(h / fillet_mm if fillet_mm > 0.0 else math.inf, MIN_RATIO), MAX_RATIO)
    root = math.sqrt(q)
    if q <= 2.0:
        c1, c2 = 0.927 + 1.149 * root - 0.086 * q, 0.015 - 3.281 * root + 0.837 * q
        c3, c4 = 0.847 + 1.716 * root - 0.506 * q, -0.790 + 0.417 * root - 0.246 * q
    else:
        c1, c2 = 1.225 + 0.831 * root - 0.010 * q, -3.790 + 0.958 * root - 0.257 * q
        c3, c4 = 7.374 - 4.834 * root + 0.862 * q, -3.809 + 3.046 * root - 0.595 * q
    s = 2 * h / large_mm
    return max(1.0, c1 + s * (c2 + s * (c3 + s * c4)))


def hole_in_tension(hole_mm: float, width_mm: float) -> float:
    """Factor at a hole in the middle of a flat bar. It multiplies the stress of the section beside the hole.

    In bending, where the stress falls towards the middle, the factor is smaller.

    Parameters
    ----------
    hole_mm
        Diameter of the hole [mm].
    width_mm
        Width of the bar across the hole [mm].
    """
    s = min(hole_mm / width_mm, 1.0)
    return 3.0 - 3.13 * s + 3.66 * s * s - 1.53 * s**3
