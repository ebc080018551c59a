"""Misalignment of bone or core in the mold's recess, and the silicone that remains around it.

The bone stands out of its recess like a cantilever, so that the play of the fit grows along it. A loose bone tilts
until it touches the recess on one side at its top and on the other side at its bottom. A bone that is held down on its
collar tilts less: on one side the collar's foot lies on its shelf, and on the other side it stands off by no more than
the fit's clearance. The casting sheet asks the caster to hold it so. How well that succeeds is an assumption.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.design.geometry.conic import CrossSection
from fingertip.design.geometry.dimensions import Dimensions
from fingertip.design.geometry.skin_thickness import quarter_outline, skin_thicknesses

if TYPE_CHECKING:
    from fingertip.design.parameters import DesignTables

_POINTS, _CHORDS = 10, 20
"""Points and chords of a quarter of a section. A few hundredths of a millimetre are enough here."""
_TIP_SECTIONS = 3
"""Sections of the rounded tip that are sampled."""


@dataclass(frozen=True)
class MisalignedPoint:
    """A point of the skin, and the silicone it loses if the bone lies towards it as far as its fit allows."""

    thickness_mm: float
    """Thickness without misalignment."""
    held_loss: float
    """Loss per millimetre of fit clearance, by shift and tilt of a bone that is held down [mm per mm]."""
    loose_loss: float
    """Loss per millimetre of fit clearance, by shift and tilt of a loose bone [mm per mm]."""


def loose_tilt_slope(design: DesignTables) -> float:
    """Compute the tangent of the tilt angle of a bone that nothing holds down."""
    return 2.0 * design.mold.fit_clearance_mm / _held_length(design)


def held_tilt_slope(design: DesignTables, x: float, y: float) -> float:
    """Compute the tangent of the tilt angle in the direction (x, y), a unit vector, of a bone that is held down."""
    foot = _outline(design.dimensions.collar.section)
    return min(loose_tilt_slope(design), design.mold.fit_clearance_mm / _width_along(foot, x, y))


def min_thickness_held(design: DesignTables) -> float:
    """Compute the minimum skin thickness [mm] with a bone or core that is held down, in its worst position."""
    return min(p.thickness_mm - p.held_loss * design.mold.fit_clearance_mm for p in misaligned_points(design))


def min_thickness_loose(design: DesignTables) -> float:
    """Compute the minimum skin thickness [mm] with a loose bone or core; 0 where it touches the mold."""
    left = min(p.thickness_mm - p.loose_loss * design.mold.fit_clearance_mm for p in misaligned_points(design))
    return max(0.0, left)


def sleeve_inset_mm(design: DesignTables) -> float:
    """Return the inset of the silicone's inside from the bone [mm]: the interference of a sleeve, else 0."""
    return design.mold.sleeve_interference_mm if design.mold.method == "sleeve" else 0.0


def misaligned_points(design: DesignTables) -> Iterator[MisalignedPoint]:
    """Sample the skin where it begins, where its tip begins, and along the tip.

    The bone is taken to tilt straight towards each point. On the tip the distance within a section overstates the
    thickness, which the slope of the surface corrects.
    """
    dims = design.dimensions
    assert dims.bone_outline.tip is not None
    join, apex = dims.bone_outline.stations[-1][0], dims.bone_outline.tip.z
    per_recess, collar = 2.0 / _held_length(design), _outline(dims.collar.section)
    inset = sleeve_inset_mm(design)
    for z in (0.0, join, *(join + (apex - join) * i / (_TIP_SECTIONS + 1) for i in range(1, _TIP_SECTIONS + 1))):
        narrowing = _narrowing(dims, z)
        for sample in skin_thicknesses(dims, z, inset, _POINTS, _CHORDS):
            cosine = 1.0 / math.hypot(1.0, sample.support_mm * narrowing)
            held = min(per_recess, 1.0 / _width_along(collar, sample.x, sample.y))
            yield MisalignedPoint(
                sample.thickness_mm * cosine, cosine * (1.0 + held * z), cosine * (1.0 + per_recess * z)
            )


def _held_length(design: DesignTables) -> float:
    """Length [mm] of the recess in which the base has its full outline. The eyes of a clevis touch nothing."""
    return min(design.mold.recess_length_mm, design.dimensions.full_base_length)


def _outline(section: CrossSection) -> tuple[list[tuple[float, float]], ...]:
    """Points of a section's palmar and dorsal quarter."""
    return tuple(quarter_outline(section, dorsal, _CHORDS) for dorsal in (False, True))


def _width_along(outline: tuple[list[tuple[float, float]], ...], x: float, y: float) -> float:
    """Width [mm] of an outline in the direction (x, y): the length on which a foot of this outline rests."""
    return sum(max(abs(x) * px + abs(y) * py for px, py in points) for points in outline)


def _narrowing(dims: Dimensions, z: float) -> float:
    """Rate at which the outer surface narrows at height z [mm], relative to its size there [1/mm]."""
    step = 1e-3
    here, above = dims.outer.scale_at(z), dims.outer.scale_at(z + step)
    return (here - above) / step / here
