"""How far bone or core can lean in the mold's recess, and how much silicone that leaves around it.

It stands out of the recess like a cantilever, so that the fit's small play grows along it. Loose, it leans until it
touches the recess on one side at its top and on the other at its bottom. Held down on its collar it leans less: on one
side the collar's foot lies on its shelf, and on the other it stands off by no more than the fit's clearance. To hold it
so is the caster's part, and the casting sheet says so; how well that succeeds is an assumption.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.design.geometry.conic import CrossSection
from fingertip.design.geometry.dimensions import Dimensions
from fingertip.design.geometry.skin_thickness import quarter, skin_thicknesses
from fingertip.design.parameters import DesignTables

_POINTS, _CHORDS = 10, 20  # of a quarter of a section: a few hundredths of a millimetre are not the question here
_TIP_SECTIONS = 3  # that are looked at


@dataclass(frozen=True)
class Place:
    """A place of the skin, and what a fit of one millimetre takes of its silicone if the bone lies that way."""

    cover_mm: float
    shifted: float
    """By a shift within the recess [mm per mm]."""
    held: float
    """By that and the tilt of a bone that is held down [mm per mm]."""
    loose: float
    """By that and the tilt of one that is not [mm per mm]."""


def loose_tilt_slope(design: DesignTables) -> float:
    """Tangent of the tilt where nothing holds the collar down."""
    return 2.0 * design.mold.fit_clearance_mm / design.mold.recess_length_mm


def held_tilt_slope(design: DesignTables, dims: Dimensions, x: float, y: float) -> float:
    """Tangent of the tilt in the direction (x, y), a unit vector, where the collar is held down."""
    return min(loose_tilt_slope(design), design.mold.fit_clearance_mm / _across(_outline(dims.collar.section), x, y))


def min_thickness_held(design: DesignTables, dims: Dimensions) -> float:
    """Silicone [mm] at the thinnest place when a bone or core that is held down lies as badly as its fit allows."""
    return min(p.cover_mm - p.held * design.mold.fit_clearance_mm for p in places(design, dims))


def min_thickness_loose(design: DesignTables, dims: Dimensions) -> float:
    """The same [mm] when nothing holds it down; 0 where it touches the mold."""
    return max(0.0, min(p.cover_mm - p.loose * design.mold.fit_clearance_mm for p in places(design, dims)))


def inset_mm(design: DesignTables) -> float:
    """How much smaller than the bone the silicone's inside is [mm]: the interference of a sleeve."""
    return design.mold.sleeve_interference_mm if design.mold.method == "sleeve" else 0.0


def places(design: DesignTables, dims: Dimensions) -> Iterator[Place]:
    """Places around the bone where the skin begins, where its tip begins, and up the tip.

    The bone is taken to lean straight towards each. On the tip the distance within a section overstates the silicone,
    and is eased by the surface's slope.
    """
    assert dims.envelope.tip is not None
    join, apex = dims.envelope.stations[-1][0], dims.envelope.tip.z
    per_recess, collar = 2.0 / design.mold.recess_length_mm, _outline(dims.collar.section)
    for z in (0.0, join, *(join + (apex - join) * i / (_TIP_SECTIONS + 1) for i in range(1, _TIP_SECTIONS + 1))):
        narrowing = _narrowing(dims, z)
        for cover in skin_thicknesses(dims, z, inset_mm(design), _POINTS, _CHORDS):
            eased = 1.0 / math.hypot(1.0, cover.reach_mm * narrowing)
            held = min(per_recess, 1.0 / _across(collar, cover.x, cover.y))
            yield Place(cover.gap_mm * eased, eased, eased * (1.0 + held * z), eased * (1.0 + per_recess * z))


def _outline(section: CrossSection) -> tuple[list[tuple[float, float]], ...]:
    """Points of a section's palmar and dorsal quarter."""
    return tuple(quarter(section, dorsal, _CHORDS) for dorsal in (False, True))


def _across(outline: tuple[list[tuple[float, float]], ...], x: float, y: float) -> float:
    """Width [mm] of an outline in the direction (x, y): what a foot of this form rests on."""
    return sum(max(abs(x) * px + abs(y) * py for px, py in points) for points in outline)


def _narrowing(dims: Dimensions, z: float) -> float:
    """How fast the outer form narrows at height z [mm], as a share of its size there [1/mm]."""
    step = 1e-3
    here, above = dims.outer.scale_at(z), dims.outer.scale_at(z + step)
    return (here - above) / step / here
