"""Distance of points from the exact surface of a superconic body, to rounding: the ruler of `meshing.py`.

The surface is four kinds of patches (tapered side and tip, palmar and dorsal) and the flat end. A point is folded to
x >= 0 by symmetry; on each patch the nearest point is found by damped Gauss-Newton steps on the patch's two
parameters, clamped to it. The least distance of all patches counts.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fingertip.conic import ConicBody

Array = NDArray[np.float64]
STEPS = 12


def distance(body: ConicBody, points: Array) -> Array:
    """Distance [mm] of each point (n, 3) from the body's surface."""
    folded = points.copy()
    folded[:, 0] = np.abs(folded[:, 0])
    best = _to_end(body, folded)
    for patch in _patches(body):
        best = np.minimum(best, patch.distance(folded))
    return best


class Patch:
    """Section arc (parameter t) times profile (parameter v), one quadrant of a station's span or of the tip."""

    def __init__(self, a: float, b: float, weight: float, profile: tuple[tuple[float, float, float], ...]) -> None:
        self.a, self.b, self.weight, self.profile = a, b, weight, profile

    def at(self, t: Array, v: Array) -> tuple[Array, Array, Array]:
        """Points of the patch and their derivatives by t and v, each (n, 3)."""
        x, dx = _rational(t, ((1.0, 1.0), (1.0, self.weight), (0.0, 1.0)))
        y, dy = _rational(t, ((0.0, 1.0), (1.0, self.weight), (1.0, 1.0)))
        z, dz = _rational(v, tuple((z, w) for z, _, w in self.profile))
        s, ds = _rational(v, tuple((s, w) for _, s, w in self.profile))
        x, dx, y, dy = self.a * x, self.a * dx, self.b * y, self.b * dy
        zero = np.zeros_like(z)
        return (
            np.column_stack((s * x, s * y, z)),
            np.column_stack((s * dx, s * dy, zero)),
            np.column_stack((ds * x, ds * y, dz)),
        )

    def distance(self, points: Array) -> Array:
        """Distance [mm] of points from the patch."""
        t, v = self._start(points)
        here, by_t, by_v = self.at(t, v)
        best = np.linalg.norm(here - points, axis=1)
        for _ in range(STEPS):
            r = points - here
            tt, tv, vv = (np.einsum("ij,ij->i", p, q) for p, q in ((by_t, by_t), (by_t, by_v), (by_v, by_v)))
            rt, rv = np.einsum("ij,ij->i", by_t, r), np.einsum("ij,ij->i", by_v, r)
            # At the apex the section has no width: the small ridge keeps the step finite there.
            tt, vv = tt + 1e-9 * tt.max(), vv + 1e-9 * vv.max()
            det = tt * vv - tv * tv
            t = np.clip(t + (vv * rt - tv * rv) / det, 0.0, 1.0)
            v = np.clip(v + (tt * rv - tv * rt) / det, 0.0, 1.0)
            here, by_t, by_v = self.at(t, v)
            best = np.minimum(best, np.linalg.norm(here - points, axis=1))
        return best

    def _start(self, points: Array) -> tuple[Array, Array]:
        """Parameters of the surface point at the same height and about the same direction."""
        lengthwise = np.linspace(0.0, 1.0, 4001)
        z, _ = _rational(lengthwise, tuple((z, w) for z, _, w in self.profile))
        s, _ = _rational(lengthwise, tuple((s, w) for _, s, w in self.profile))
        v = np.interp(points[:, 2], z, lengthwise)
        scale = np.maximum(np.interp(v, lengthwise, s), 1e-9)
        across = np.linspace(0.0, 1.0, 4001)
        x, _ = _rational(across, ((1.0, 1.0), (1.0, self.weight), (0.0, 1.0)))
        y, _ = _rational(across, ((0.0, 1.0), (1.0, self.weight), (1.0, 1.0)))
        angle = np.arctan2(np.maximum(points[:, 1] / (self.b * scale), 0.0), points[:, 0] / (self.a * scale))
        return np.interp(angle, np.arctan2(y, x), across), v


def _rational(t: Array, poles: tuple[tuple[float, float], ...]) -> tuple[Array, Array]:
    """Value and derivative of the rational Bezier curve with these (value, weight) poles, of degree 1 or 2."""
    u = 1.0 - t
    basis = (u, t) if len(poles) == 2 else (u * u, 2.0 * u * t, t * t)
    slope = (-np.ones_like(t), np.ones_like(t)) if len(poles) == 2 else (-2.0 * u, 2.0 * (u - t), 2.0 * t)
    d = sum(w * b for (_, w), b in zip(poles, basis, strict=True))
    n = sum(p * w * b for (p, w), b in zip(poles, basis, strict=True))
    dd = sum(w * b for (_, w), b in zip(poles, slope, strict=True))
    dn = sum(p * w * b for (p, w), b in zip(poles, slope, strict=True))
    return n / d, (dn - n / d * dd) / d


def _patches(body: ConicBody) -> Iterator[Patch]:
    assert body.tip is not None
    spans = [
        ((z0, s0, 1.0), (z1, s1, 1.0)) for (z0, s0), (z1, s1) in zip(body.stations, body.stations[1:], strict=False)
    ]
    z, s = body.stations[-1]
    tip = ((z, s, 1.0), (body.tip.z, body.tip_control(), body.tip.weight), (body.tip.z, 0.0, 1.0))
    section = body.section
    for height, weight in ((section.dorsal, section.dorsal_weight), (-section.palmar, section.palmar_weight)):
        for profile in (*spans, tip):
            yield Patch(section.half_width, height, weight, profile)


def _to_end(body: ConicBody, points: Array) -> Array:
    """Distance from the plane of the flat end; only points over it count, its rim belongs to the side too."""
    z, scale = body.stations[0]
    over = np.array([body.section.half_width_at(y, scale) for y in points[:, 1]]) >= points[:, 0] - 1e-12
    return np.where(over, np.abs(points[:, 2] - z), np.inf)


def self_test(body: ConicBody) -> float:
    """Largest error [mm] for points put off the surface, along its normal, by known distances, in and outwards.

    Places near the rim of the end and near the planes of symmetry are left out: another patch may be nearer there.
    """
    worst, random = 0.0, np.random.default_rng(1)
    for patch in _patches(body):
        t, v = random.uniform(0.0, 1.0, (2, 500))
        here, by_t, by_v = patch.at(t, v)
        normal = np.cross(by_t, by_v)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        inner = (here[:, 2] > body.stations[0][0] + 0.2) & (here[:, 0] > 0.2) & (np.abs(here[:, 1]) > 0.2)
        for offset in (0.001, -0.001, 0.1, -0.1):
            found = distance(body, (here + offset * normal)[inner])
            worst = max(worst, float(np.abs(found - abs(offset)).max()))
    return worst
