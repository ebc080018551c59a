"""Flow of the silicone past the core that is lowered into the cup, and its pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fingertip.design.geometry.sections import Quarters, measure_gaps

if TYPE_CHECKING:
    from fingertip.design.parameters import Tables
    from fingertip.foundation.numerics import Array
    from fingertip.models.dimensions import Dimensions

_SAFE = 1.01
"""Factor on the estimate, which is up to 0.8 % below what sections of the solids give."""
_SECTIONS = 12
_ARC_POINTS = 4
_CHORDS = 8
_FLAT_POINTS = 4
"""Sections of the core, and points and chords of each quarter
of an outline, and points of the flat.
"""


def estimate_pressure_kpa(
    design: Tables, dims: Dimensions, pour_z: float, lowering_s: float
) -> float:
    """Compute the pressure at the tip at the end of the way by lubrication: dp/dz = 12 mu v (A + g
    / 2) / c.

    A is the area of the core's section, g and c the integrals of the gap and of its cube around it.
    The recesses of the core are left out: the pressure is up to a tenth larger than with them.
    """
    import numpy as np  # noqa: PLC0415

    assert dims.bone_outline.tip is not None
    inset = design.mold.core_inset_mm
    length = dims.bone_outline.tip.z - inset
    heights = [length * (i + 0.5) / _SECTIONS for i in range(_SECTIONS)]
    quarters = Quarters(dims, inset, heights, heights)
    core = _outline_core(quarters)
    quarter = quarters.surface(_CHORDS)
    surface = _join(quarter[:, :_SECTIONS], quarter[:, _SECTIONS:])

    # Of one side, x >= 0.
    ax, ay = core[..., :-1]
    bx, by = core[..., 1:]
    g, _ = measure_gaps((core[..., :-1] + core[..., 1:]) / 2, surface)
    ds = np.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
    area = (np.abs(ax * by - ay * bx) / 2).sum(axis=1)
    gaps = (g * ds).sum(axis=1)
    cubes = (g * g * g * ds).sum(axis=1)
    fallen = float((12.0 * (area + gaps / 2) / cubes).sum()) * length / _SECTIONS

    speed = (length * dims.shrinkage - pour_z) / lowering_s
    return (
        _SAFE
        * 1e-3
        * design.silicone.material.viscosity_pa_s.high
        * speed
        * fallen
        / dims.shrinkage
    )


def _outline_core(quarters: Quarters) -> Array:
    """List points (x, y) of the core's sections, from the middle of their palmar flat to their
    dorsal end.
    """
    import numpy as np  # noqa: PLC0415

    arc = quarters.core(_ARC_POINTS)
    edge = quarters.flat_edges[:, _SECTIONS:, None]
    half_width, depth = quarters.platform_edges[:, _SECTIONS:, None] - quarters.inset
    raised = np.minimum(half_width, edge[0])
    # The middle of the flat is raised by a platform.
    x = np.where(raised > 0.0, raised, edge[0])
    y = np.where(raised > 0.0, depth, edge[1])
    shares = np.linspace(1.0, 0.0, _FLAT_POINTS + 1)
    flat = np.array((x * shares, y + 0.0 * shares))
    palmar = np.concatenate((arc[:, _SECTIONS:], edge, np.array((x, edge[1])), flat), axis=2)

    return _join(arc[:, :_SECTIONS], palmar)


def _join(dorsal: Array, palmar: Array) -> Array:
    """Join points (x, |y|) of both quarters to outlines of points (x, y), from the palmar end."""
    import numpy as np  # noqa: PLC0415

    below = palmar[..., ::-1] * [[[1.0]], [[-1.0]]]
    return np.concatenate((below, dorsal[..., 1:]), axis=2)
