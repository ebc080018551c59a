"""Checks of the skin: thickness, deviation of its mesh from the exact surface, stretch as it is put on, and its pad.

Thickness is measured above the plane z = 0, where the skin is cut square: the least gap between bone and outside.

The exact surface consists of patches (tapered side and tip, each palmar and dorsal) and the flat end. Points are
reflected to x >= 0 by symmetry. On each patch the nearest point is found by damped Gauss-Newton steps in the two
parameters of the patch, which are clamped to it. The distance is the smallest from any patch.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.mesh import Manifold, Mesh, MeshEvaluator
from fingertip.cad.shapes.skin import filled_bone, skin_interior, skin_outline
from fingertip.cad.verification.bone import check_strength
from fingertip.cad.verification.check import PLANE_OFFSET_MM, Check, above_z, complement, measure_gap
from fingertip.cad.verification.strength import assess_strength
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody
from fingertip.design.geometry.profile import Span
from fingertip.foundation.errors import DesignError
from fingertip.foundation.numerics import Array
from fingertip.pad.survey import MAX_TURN_ON_N, survey_pad

_NEARBY_STEPS = 3
"""Gauss-Newton steps that suffice for points very near the surface."""
_REACH_MM = 1.5  # exceeds the deviation of every facet, since the tolerance is at most 1 mm
_PARAMETERS = np.linspace(0.0, 1.0, 4001)
"""Parameters at which curves are sampled for a first estimate of the nearest point."""
_ON_SURFACE_MM = 1e-4  # vertices nearer than this lie on the surface; the vertex grid is ten times finer


def max_facet_deviation(body: ConicBody, vertices: Array, triangles: NDArray[np.int64]) -> float:
    """Measure the largest distance [mm] of facet centres from the surface.

    Only facets whose corners lie on the surface are measured. A surface of constant curvature is farthest from a facet
    at its centre. Few Gauss-Newton steps are needed so near the surface.
    """
    corners, patches = vertices[triangles], [*surface_patches(body)]
    on_surface = (_nearby_distance(patches, vertices) < _ON_SURFACE_MM)[triangles].all(axis=1)
    level = np.ptp(corners[:, :, 2], axis=1) == 0.0  # facets of the flat end are exact
    centres = corners[on_surface & ~level].mean(axis=1)
    return float(_nearby_distance(patches, centres).max()) if len(centres) else 0.0


def _nearby_distance(patches: Iterable[Patch], points: Array) -> Array:
    """Measure the distance [mm] of points near the surface, without its end; an upper bound for others."""
    folded = points.copy()
    folded[:, 0] = np.abs(folded[:, 0])
    best = np.full(len(points), np.inf)
    for patch in patches:
        nearby = patch.in_range(folded, _REACH_MM)
        best[nearby] = np.minimum(best[nearby], patch.distance(folded[nearby], steps=_NEARBY_STEPS))
    return best


class Patch:
    """Patch of one quadrant of a taper or of the tip: tensor product of a section arc (t) and a profile [mm] (v)."""

    def __init__(self, a: float, b: float, weight: float, span: Span) -> None:
        self.a, self.b, self._z = a, b, (span.z[0], span.z[2])
        self._section = (weight, (1.0, 1.0, 0.0), (0.0, 1.0, 1.0))
        # Height, scale of the width, and scale of this side's height.
        self._profile = (span.weight, span.z, span.scale, span.scale if b > 0 else span.palmar)

    def evaluate(self, t: Array, v: Array) -> tuple[Array, Array, Array]:
        """Evaluate points of the patch and their derivatives by t and v, each of shape (n, 3)."""
        (x, dx), (y, dy) = _rational(t, *self._section)
        (z, dz), (s, ds), (c, dc) = _rational(v, *self._profile)
        x, dx, y, dy = self.a * x, self.a * dx, self.b * y, self.b * dy
        zero = np.zeros_like(z)
        return (
            np.column_stack((s * x, c * y, z)),
            np.column_stack((s * dx, c * dy, zero)),
            np.column_stack((ds * x, dc * y, dz)),
        )

    def in_range(self, points: Array, reach_mm: float) -> NDArray[np.bool_]:
        """Select points by a mask: those within the height and side of the patch, extended by `reach_mm`."""
        low, high = self._z
        y, z = points[:, 1] * np.sign(self.b), points[:, 2]
        return np.asarray((y >= -reach_mm) & (z >= low - reach_mm) & (z <= high + reach_mm))

    def distance(self, points: Array, steps: int) -> Array:
        if not len(points):
            return np.zeros(0)
        t, v = self._start(points)
        position, by_t, by_v = self.evaluate(t, v)
        best: Array = np.linalg.norm(position - points, axis=1)
        for _ in range(steps):
            # Solve the normal equations of the linearised distance for the step in (t, v), by Cramer's rule.
            r = points - position
            tt, tv, vv = (np.einsum("ij,ij->i", p, q) for p, q in ((by_t, by_t), (by_t, by_v), (by_v, by_v)))
            rt, rv = np.einsum("ij,ij->i", by_t, r), np.einsum("ij,ij->i", by_v, r)
            # The section has zero width at the apex. A small ridge term keeps the step finite there.
            tt, vv = tt + 1e-9 * tt.max(), vv + 1e-9 * vv.max()
            det = tt * vv - tv * tv
            t = np.clip(t + (vv * rt - tv * rv) / det, 0.0, 1.0)
            v = np.clip(v + (tt * rv - tv * rt) / det, 0.0, 1.0)
            position, by_t, by_v = self.evaluate(t, v)
            best = np.minimum(best, np.linalg.norm(position - points, axis=1))
        return best

    def _start(self, points: Array) -> tuple[Array, Array]:
        """Estimate the parameters of the nearest point: same height, and about the same direction from the axis."""
        heights, scales, angles = self._samples
        v = np.interp(points[:, 2], heights, _PARAMETERS)
        wide, high = (np.maximum(np.interp(v, _PARAMETERS, values), 1e-9) for values in scales)
        angle = np.arctan2(np.maximum(points[:, 1] / (self.b * high), 0.0), points[:, 0] / (self.a * wide))
        return np.interp(angle, angles, _PARAMETERS), v

    @cached_property
    def _samples(self) -> tuple[Array, tuple[Array, Array], Array]:
        """Height [mm] and both scales along the profile, and angle [rad] along the section arc, at `_PARAMETERS`."""
        (x, _), (y, _) = _rational(_PARAMETERS, *self._section)
        (z, _), (s, _), (c, _) = _rational(_PARAMETERS, *self._profile)
        return z, (s, c), np.arctan2(y, x)


def _rational(t: Array, weight: float, *coordinates: tuple[float, float, float]) -> Iterator[tuple[Array, Array]]:
    """Evaluate each coordinate of a rational quadratic Bezier curve, and its derivative."""
    u, weights = 1.0 - t, np.array((1.0, weight, 1.0))
    basis, slope = np.array((u * u, 2.0 * u * t, t * t)), np.array((-2.0 * u, 2.0 * (u - t), 2.0 * t))
    d, dd = weights @ basis, weights @ slope
    for poles in coordinates:
        value = (poles * weights) @ basis / d
        yield value, ((poles * weights) @ slope - value * dd) / d


def surface_patches(body: ConicBody) -> Iterator[Patch]:
    """List the patches of the side x >= 0 of a body with a tip, dorsal and palmar."""
    assert body.tip is not None
    section = body.section
    for height, weight in ((section.dorsal, section.dorsal_weight), (-section.palmar, section.palmar_weight)):
        for span in body.spans:
            yield Patch(section.half_width, height, weight, span)


MAX_STRETCH_SHARE = 0.2
"""Share of its elongation at break by which a skin may be stretched: tight ones split after weeks."""
_SECTIONS = 24
"""Sections along the straight part of a skin whose perimeters are measured."""


def check_skin(design: Design, evaluator: MeshEvaluator, mesh: Mesh) -> Iterator[Check]:
    interior, outside = _interior(design, evaluator), _outside(design, evaluator)
    minimum = design.skin.min_thickness_mm - evaluator.tolerance_mm
    yield Check("skin.min_thickness", _thickness(interior, outside), minimum, "mm", "at least")
    deviation = max_facet_deviation(design.dimensions.outer, mesh.vertices, mesh.triangles)
    yield Check("skin.surface_deviation", deviation, evaluator.tolerance_mm, "mm")


def min_thickness(design: Design, evaluator: MeshEvaluator) -> float:
    return _thickness(_interior(design, evaluator), _outside(design, evaluator))


def check_fitting_stretch(design: Design, evaluator: MeshEvaluator) -> Check:
    """Check the stretch [%] of a skin's narrowest section when it is pulled over the widest section of the bone."""
    interior, whole = (evaluator.manifold(s) for s in (skin_interior(design), filled_bone(design)))
    straight_length = design.skin.length_mm - design.skin.tip_length_mm
    heights = [straight_length * (i + 0.5) / _SECTIONS for i in range(_SECTIONS)]
    narrowest = min(_perimeter(interior, z) for z in heights)
    widest = max(_perimeter(whole, z) for z in heights)
    stretch, limit = widest / narrowest - 1.0, MAX_STRETCH_SHARE * design.silicone.material.elongation_percent.low
    return Check("skin.fitting_stretch", 100 * stretch, limit, "%")


def _interior(design: Design, evaluator: MeshEvaluator) -> Manifold:
    return above_z(evaluator.manifold(skin_interior(design)), PLANE_OFFSET_MM)


def _outside(design: Design, evaluator: MeshEvaluator) -> Manifold:
    """Everything around the skin, but not beyond its flat end, where the skin is open."""
    return above_z(complement(evaluator, skin_outline(design)), PLANE_OFFSET_MM)


def _thickness(interior: Manifold, outside: Manifold) -> float:
    """Measure the smallest thickness [mm] between a skin's interior and its outside; 0 where they meet."""
    return measure_gap(interior, outside, 1.0)


def _perimeter(solid: Manifold, z: float) -> float:
    """Compute the perimeter [mm] of a solid's section at height `z` [mm]."""
    outlines = solid.slice(z).to_polygons()
    return sum(math.dist(a, b) for outline in outlines for a, b in pairwise([*outline, outline[0]]))


WANTED_TURN_ON_N = 1.0
"""Force on the pad at which the sensor must be on, at every tilt of a wide range [N]. An assumption."""
_STEPS = {"bone.collar_inset_mm": 0.05, "sensor.distance_from_tip_mm": 0.5}
"""Lengths that let skin, not collar, meet a plate that is tilted tip up -> step of which eight are tried [mm]."""


def check_pad(design: Design) -> Check:
    """Check that the sensor feels a light touch. What else a pad does stands in the report's section `pad`."""
    force = survey_pad(design).worst_turn_on_n
    remedy = _find_mend(design) if force > WANTED_TURN_ON_N else ""
    value, is_beyond = min(force, MAX_TURN_ON_N), force > MAX_TURN_ON_N
    return Check("pad.turn_on_force", value, WANTED_TURN_ON_N, "N", remedy=remedy, is_beyond=is_beyond)


def _find_mend(design: Design) -> str:
    """Find a setting with which the sensor turns on in time, and the bone still holds its loads; empty if none does."""
    for name, value in (
        (name, round(design.value(name) + i * _STEPS[name], 2)) for name in _STEPS for i in range(1, 9)
    ):
        with suppress(DesignError):
            tried = Design.without_remedies(**design.with_values({name: value}).model_dump())
            if survey_pad(tried).worst_turn_on_n > WANTED_TURN_ON_N:
                continue
            if all(one.passed for one in check_strength(tried, assess_strength(tried, MeshEvaluator(0.02)))):
                return f"{name}={value:g}"
    return ""
