"""Thickness of the silicone over the bone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from fingertip.design.geometry.sections import Quarters, measure_gaps
from fingertip.foundation.numerics import bisect

if TYPE_CHECKING:
    from fingertip.design.parameters import Tables
    from fingertip.foundation.numerics import Array
    from fingertip.models.dimensions import Dimensions

_OUTLINE_POINTS = 24
_OUTLINE_CHORDS = 48
"""Points and chords of a quarter of an outline. The sag of a chord is 1e-3 mm on a finger."""

_POINTS = 5
_SURFACE_CHORDS = 20
"""The same, where the slope of the surface counts too."""
_FLAT_SHARES = (0.7, 0.97, 0.99)
"""Sections of the tip, as shares of the way to the end of the flat."""
_STEP_MM = 1e-3
"""Step over which this slope is taken."""


def min_skin_thickness(design: Tables, dims: Dimensions) -> float:
    """Compute the minimum skin thickness [mm] in sections.

    Up to the tip, only a crown and a platform bend the outlines, on the palmar side; they bring
    sections of their own. On the tip the skin is thinnest beside the rounded end of the flat.
    """
    inner = dims.bone_outline
    join, _, apex = inner.spans[-1].z
    flat_end, _ = bisect(
        lambda z: inner.section.palmar * inner.scale_at(z) > dims.flat_depth,
        join,
        apex,
        halvings=16,
    )
    bends = [*_bends(dims), *(join + share * (flat_end - join) for share in _FLAT_SHARES)]
    middle = (join + apex) / 2
    dorsal = (0.0, join, middle)
    quarters = Quarters(dims, design.mold.core_inset_mm, dorsal, (*dorsal, *bends))

    return min(
        design.skin.thickness_tip_mm,
        _min_in_sections(quarters, join),
        _min_across_slope(quarters),
    )


def _bends(dims: Dimensions) -> list[float]:
    """List the heights at which a crown, or the palmar side of the
    bone, bends over the skin's length [mm].
    """
    knots = [span.z[0] for span in dims.outer.spans if dims.crown]
    if dims.platform_half_width_at(dims.sensor_z):
        # Behind the sensor a ramp leads on; ahead of it the platform ends in a half circle,
        # steepest at its end.
        along_radius = (-0.7, 0.0, 0.4, 0.7, 0.9, 0.999)
        knots += [
            *dims.ramp,
            *(dims.sensor_z + share * dims.platform_radius for share in along_radius),
        ]

    return sorted({z for z in knots if 0.0 < z < dims.outer.spans[-1].z[2]})


def _min_in_sections(quarters: Quarters, join: float) -> float:
    """Compute the minimum thickness in the planes of the sections up to the tip [mm]."""
    core, surface = _outline(quarters, _OUTLINE_POINTS, _OUTLINE_CHORDS)
    straight = [row for row, z in enumerate(quarters.heights) if z <= join]
    thickness, _ = measure_gaps(core[:, straight], surface[:, straight])

    return float(thickness.min())


def _min_across_slope(quarters: Quarters) -> float:
    """Compute the minimum thickness across the outer surface, which narrows along z [mm]."""
    import numpy as np  # noqa: PLC0415

    thickness, support = measure_gaps(*_outline(quarters, _POINTS, _SURFACE_CHORDS))
    dorsal = [z + _STEP_MM for z in quarters.dorsal]
    palmar = [z + _STEP_MM for z in quarters.palmar]
    beyond = replace(quarters, dorsal=dorsal, palmar=palmar)
    # The rates at which the surface narrows, relative to its size there [1/mm].
    rises = quarters.surface_rises
    # A crown or a platform of a design that rules refuse may bend past the tip.
    is_open = rises > 0.0
    rates = (1.0 - beyond.surface_rises[is_open] / rises[is_open]) / _STEP_MM
    slope = support[is_open] * rates[:, None]

    return float((thickness[is_open] / np.sqrt(1.0 + slope * slope)).min())


def _outline(quarters: Quarters, points: int, chords: int) -> tuple[Array, Array]:
    """List points of the core, cut at its flat and its platform, and of the surface around it."""
    import numpy as np  # noqa: PLC0415

    edge = quarters.flat_edges[..., None]
    platform = quarters.platform_edges[..., None]
    corner = np.where(platform[0] > 0.0, platform - quarters.inset, edge)
    core = np.concatenate((quarters.core(points), edge, corner), axis=2)

    return core, quarters.surface(chords)
