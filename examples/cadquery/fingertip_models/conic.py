"""Superconic bodies in closed form: the outer surface of the finger and the outline of the bone.

A cross-section consists of four rational quadratic arcs, one in each quadrant. The arc from (a, 0)
to (0, b) has the control point (a, b) with weight w. The weight w = sqrt(1/2) gives an ellipse,
larger weights are squarer and smaller ones flatter. Along z the whole section is scaled: linearly
between stations, then by one more conic to the apex of the tip, which continues the last straight
line without a kink (G1 continuity). The palmar height may have a profile of its own along z, the
crown of a pad: conic arcs that share the parameter, and so the weights, of the scale. NURBS
represent all of these exactly, so that mesh and B-rep evaluate the same surface. Every section
widens monotonically towards the plane y = 0. That is why both halves of a mold parted there pull
without an undercut.

Only the math module is used: its results are the same on every processor, while numpy's vector
functions differ in the last bit.

Reference: L. Piegl and W. Tiller, The NURBS Book, 2nd ed., section 7.3 (the quadratic rational
Bezier arc).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

from .profile import (
    Crown,
    Span,
    Tip,
    arc_abscissa,
    arc_point,
    dorsal_height_at,
    half_width_at,
    lay_crown,
    lay_groove,
    lay_spans,
    palmar_scale,
    scale_at,
    tip_control,
)

if TYPE_CHECKING:
    from .program_types import Finger

ELLIPSE = math.sqrt(0.5)


class CrossSection(NamedTuple):
    """Cross-section by half width and two half heights [mm], each half with its own arc weight."""

    half_width: float
    palmar: float
    dorsal: float
    palmar_weight: float
    dorsal_weight: float

    def half_width_at(
        self, y: float, scale: float = 1.0, palmar_scale: float | None = None
    ) -> float:
        """Return the half width [mm] at height y [mm]; 0 outside the
        section, whose palmar half may be scaled apart.
        """
        return half_width_at(self, y, scale, palmar_scale)

    def dorsal_height_at(self, x: float, scale: float = 1.0) -> float:
        """Return the height y [mm] of the dorsal side, whose
        arc is symmetric, at x [mm]; 0 outside.
        """
        return dorsal_height_at(self, x, scale)


@dataclass(frozen=True)
class ConicBody:
    """Section that is scaled along z and then closed, flat or by a tip."""

    section: CrossSection
    stations: tuple[tuple[float, float], ...]
    """Heights [mm] and scales between which the section is scaled linearly."""
    tip: Tip | None = None
    crown: Crown | None = None

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """Pieces of the body along z, from its beginning to the tip's apex."""
        if self.crown and self.tip:
            return lay_crown(self.crown, self.stations, self.tip, self.section.palmar)

        return lay_spans(self.stations, self.tip)

    def palmar_scale_at(self, z: float) -> float:
        """Return the scale of the palmar height at height z [mm]; 0 outside the body."""
        if self.crown is None:
            return self.scale_at(z)

        return palmar_scale(self.spans, z)

    def palmar_height_at(self, x: float, z: float) -> float:
        """Return the height [mm] of the palmar side, positive
        towards the palm, at (x, z) [mm]; 0 outside it.
        """
        width = self.section.half_width * self.scale_at(z)
        if abs(x) >= width:
            return 0.0

        return (
            self.palmar_scale_at(z)
            * self.section.palmar
            * arc_abscissa(abs(x) / width, self.section.palmar_weight)
        )

    def tip_control(self) -> float:
        """Return the scale of the tip's control point."""
        assert self.tip is not None
        return tip_control(self.stations, self.tip)

    def scale_at(self, z: float) -> float:
        """Return the scale of the section at height z [mm]; 0 outside the body."""
        return scale_at(self.stations, self.tip, z)

    def half_width_at(self, y: float, z: float) -> float:
        """Return the half width [mm] of the body at (y, z) [mm]; 0 outside it."""
        return self.section.half_width_at(
            y, self.scale_at(z), palmar_scale(self.spans, z) if self.crown else None
        )

    def dorsal_height_at(self, x: float, z: float) -> float:
        """Return the height y [mm] of the dorsal side at (x, z) [mm]; 0 outside it."""
        return self.section.dorsal_height_at(x, self.scale_at(z))


def offset_section(section: CrossSection, gap_mm: float) -> CrossSection:
    """Enlarge a section: half width and both half heights grow by `gap_mm` [mm]."""
    half_width, palmar, dorsal, *weights = section
    return CrossSection(half_width + gap_mm, palmar + gap_mm, dorsal + gap_mm, *weights)


def inset_body(body: ConicBody, inset: float) -> ConicBody:
    """Shrink section and tip of a body by `inset` [mm]."""
    assert body.tip is not None
    return replace(
        body,
        section=offset_section(body.section, -inset),
        tip=body.tip._replace(z=body.tip.z - inset),
    )


@lru_cache(maxsize=64)
def list_arc_points(count: int, weight: float) -> tuple[tuple[float, float], ...]:
    """Return `count` + 1 points of the unit arc from (1, 0) to
    (0, 1), at equal steps of its parameter.
    """
    return tuple(arc_point(i / count, weight) for i in range(count + 1))


def quarter_outline(section: CrossSection, dorsal: bool, count: int) -> list[tuple[float, float]]:
    """Return `count` + 1 points [mm] of the dorsal or palmar quarter of
    an outline, from its side; both with y >= 0.
    """
    height, weight = (
        (section.dorsal, section.dorsal_weight)
        if dorsal
        else (section.palmar, section.palmar_weight)
    )
    return [(section.half_width * x, height * y) for x, y in list_arc_points(count, weight)]


def add_groove(finger: Finger, body: ConicBody) -> ConicBody:
    """Add a groove around the bone; silicone fills it and keeps the skin from slipping off.

    The flanks rise at 45 degrees at the sides or at the back, whichever is wider. Flanks and floor
    are four more stations of the superconic body, so that no boolean is needed and both kernels
    represent the groove directly.
    """
    bone = finger.bone
    if bone.groove_depth_mm == 0.0:
        return body

    groove = bone.groove_distance_mm, bone.groove_depth_mm, bone.groove_width_mm
    radius = max(body.section.half_width, body.section.dorsal)
    stations = lay_groove(body.stations, body.tip, radius, groove)
    return replace(body, stations=stations)
