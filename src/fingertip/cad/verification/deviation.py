"""Distance of facets from the exact surface of a superconic body.

The surface consists of patches (tapered side and tip, each palmar and dorsal) and the flat end.
Points are reflected to x >= 0 by symmetry. On each patch the nearest point is found by damped
Gauss-Newton steps in the two parameters of the patch, which are clamped to it. The distance is the
smallest from any patch.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.models.conic import ConicBody
from fingertip.models.profile import Span

_NEARBY_STEPS = 3
"""Gauss-Newton steps that suffice for points very near the surface."""
_REACH_MM = 1.5  # exceeds the deviation of every facet, since the tolerance is at most 1 mm
_PARAMETERS = np.linspace(0.0, 1.0, 4001)
"""Parameters at which curves are sampled for a first estimate of the nearest point."""
_ON_SURFACE_MM = (
    1e-4  # vertices nearer than this lie on the surface; the vertex grid is ten times finer
)


def max_facet_deviation(body: ConicBody, vertices: Array, triangles: NDArray[np.int64]) -> float:
    """Measure the largest distance [mm] of facet centres from the surface.

    Only facets whose corners lie on the surface are measured. A surface of constant curvature is
    farthest from a facet at its centre. Few Gauss-Newton steps are needed so near the surface.
    """
    corners = vertices[triangles]
    patches = [*surface_patches(body)]
    on_surface = (_nearby_distance(patches, vertices) < _ON_SURFACE_MM)[triangles].all(axis=1)
    level = np.ptp(corners[:, :, 2], axis=1) == 0.0  # facets of the flat end are exact
    centres = corners[on_surface & ~level].mean(axis=1)

    return float(_nearby_distance(patches, centres).max()) if len(centres) else 0.0


def _nearby_distance(patches: Iterable[Patch], points: Array) -> Array:
    """Measure the distance [mm] of points near the surface, without its end.

    For other points it is an upper bound.
    """
    folded = points.copy()
    folded[:, 0] = np.abs(folded[:, 0])
    best = np.full(len(points), np.inf)

    for patch in patches:
        nearby = patch.in_range(folded, _REACH_MM)
        best[nearby] = np.minimum(best[nearby], patch.distance(folded[nearby], steps=_NEARBY_STEPS))

    return best


class Patch:
    """Patch of one quadrant of a taper or of the tip: tensor product of a section arc (t) and a
    profile [mm] (v).
    """

    def __init__(
        self,
        a: float,
        b: float,
        weight: float,
        span: Span,
    ) -> None:
        self.a = a
        self.b = b
        self._z = (span.z[0], span.z[2])
        self._section = (weight, (1.0, 1.0, 0.0), (0.0, 1.0, 1.0))
        # Height, scale of the width, and scale of this side's height.
        self._profile = (span.weight, span.z, span.scale, span.scale if b > 0 else span.palmar)

    def evaluate(self, t: Array, v: Array) -> tuple[Array, Array, Array]:
        """Evaluate points of the patch and their derivatives by t and v, each of shape (n, 3)."""
        (x, dx), (y, dy) = _rational(t, *self._section)
        (z, dz), (s, ds), (c, dc) = _rational(v, *self._profile)
        x = self.a * x
        dx = self.a * dx
        y = self.b * y
        dy = self.b * dy
        zero = np.zeros_like(z)

        return (
            np.column_stack((s * x, c * y, z)),
            np.column_stack((s * dx, c * dy, zero)),
            np.column_stack((ds * x, dc * y, dz)),
        )

    def in_range(self, points: Array, reach_mm: float) -> NDArray[np.bool_]:
        """Select points by a mask: those within the height and side of the patch, extended by
        `reach_mm`.
        """
        low, high = self._z
        y = points[:, 1] * np.sign(self.b)
        z = points[:, 2]

        return np.asarray((y >= -reach_mm) & (z >= low - reach_mm) & (z <= high + reach_mm))

    def distance(self, points: Array, steps: int) -> Array:
        if not len(points):
            return np.zeros(0)

        t, v = self._start(points)
        position, by_t, by_v = self.evaluate(t, v)
        best: Array = np.linalg.norm(position - points, axis=1)

        for _ in range(steps):
            # Solve the normal equations of the linearised distance for the step in (t, v), by
            # Cramer's rule.
            r = points - position
            tt, tv, vv = (
                np.einsum("ij,ij->i", p, q) for p, q in ((by_t, by_t), (by_t, by_v), (by_v, by_v))
            )
            rt = np.einsum("ij,ij->i", by_t, r)
            rv = np.einsum("ij,ij->i", by_v, r)
            # The section has zero width at the apex. A small ridge term keeps the step finite
            # there.
            tt = tt + 1e-9 * tt.max()
            vv = vv + 1e-9 * vv.max()
            det = tt * vv - tv * tv
            t = np.clip(t + (vv * rt - tv * rv) / det, 0.0, 1.0)
            v = np.clip(v + (tt * rv - tv * rt) / det, 0.0, 1.0)
            position, by_t, by_v = self.evaluate(t, v)
            best = np.minimum(best, np.linalg.norm(position - points, axis=1))

        return best

    def _start(self, points: Array) -> tuple[Array, Array]:
        """Estimate the parameters of the nearest point: same height, and about the same direction
        from the axis.
        """
        heights, scales, angles = self._samples
        v = np.interp(points[:, 2], heights, _PARAMETERS)
        wide, high = (np.maximum(np.interp(v, _PARAMETERS, values), 1e-9) for values in scales)
        angle = np.arctan2(
            np.maximum(points[:, 1] / (self.b * high), 0.0), points[:, 0] / (self.a * wide)
        )

        return np.interp(angle, angles, _PARAMETERS), v

    @cached_property
    def _samples(self) -> tuple[Array, tuple[Array, Array], Array]:
        """Height [mm] and both scales along the profile, and angle [rad] along the section arc, at
        `_PARAMETERS`.
        """
        (x, _), (y, _) = _rational(_PARAMETERS, *self._section)
        (z, _), (s, _), (c, _) = _rational(_PARAMETERS, *self._profile)
        return z, (s, c), np.arctan2(y, x)


def _rational(
    t: Array, weight: float, *coordinates: tuple[float, float, float]
) -> Iterator[tuple[Array, Array]]:
    """Evaluate each coordinate of a rational quadratic Bezier curve, and its derivative."""
    u = 1.0 - t
    weights = np.array((1.0, weight, 1.0))
    basis = np.array((u * u, 2.0 * u * t, t * t))
    slope = np.array((-2.0 * u, 2.0 * (u - t), 2.0 * t))
    d = weights @ basis
    dd = weights @ slope

    for poles in coordinates:
        value = (poles * weights) @ basis / d
        yield value, ((poles * weights) @ slope - value * dd) / d


def surface_patches(body: ConicBody) -> Iterator[Patch]:
    """List the patches of the side x >= 0 of a body with a tip, dorsal and palmar."""
    assert body.tip is not None
    section = body.section

    for height, weight in (
        (section.dorsal, section.dorsal_weight),
        (-section.palmar, section.palmar_weight),
    ):
        for span in body.spans:
            yield Patch(section.half_width, height, weight, span)
