"""Layer model of the pad: contact between a rigid object and a layer of silicone bonded to rigid bone.

The layer is as thick everywhere as at the first touch; its surface keeps the form of the skin. In the Fourier domain
each wave of pressure deforms it on its own, and the compliance C(k), the pressure on the bone T(k), and the pressure on
the bone under a traction along the surface S(k) follow in closed form. With w = k h and ka = 3 - 4 nu

    D(w) = 2 ka cosh 2w + 1 + ka^2 + 4 w^2
    C(k) = 2 (1 - nu^2) / (E k) (2 ka sinh 2w - 4 w) / D
    T(k) = (ka + 1) ((ka + 1) cosh w + 2 w sinh w) / D
    S(k) = (ka + 1) ((ka - 1) sinh w + 2 w cosh w) / D

The contact is found by conjugate gradients on the pressures that are not negative, at a given force (I. A. Polonsky
and L. M. Keer, A numerical method for solving rough contact problems, Wear 231 (1999) 206). Small strain, no friction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.pad.form import PadForm
from fingertip.pad.pose import Pose

GRID_MM = 0.25
_REACH_MM = 1.6
"""Gap before the touch up to which the surface may come into contact [mm]."""
_MARGIN = 2.0
"""Width around that surface on which nothing presses, in thicknesses: waves wrap around the grid's edge."""
_SIZES = tuple(sorted(2**a * 3**b * 5**c for a in range(2, 9) for b in range(4) for c in range(2)))
"""Lengths of a grid for which the Fourier transform is fast."""
_TOLERANCE = 2e-4
"""Share of the load by which the pressures change in the last iteration."""
_MAX_ITERATIONS = 200
_SUPERSAMPLED = 5
"""Points along each side of a cell with which the edge of the active area is followed."""


@dataclass(frozen=True, eq=False)
class Contact:
    """Contact of the pad at one force."""

    force_n: float
    share: float
    """Fraction of the force that presses on the active area of the sensor."""
    shear_share: float
    """The same for a traction towards the tip, in proportion to the pressure: force on the active area over it."""
    depth_mm: float
    stiffness_n_per_mm: float
    area_mm2: float
    peak_mpa: float
    centre_mm: tuple[float, float]
    """Centre of the pressure, as x and as distance distal to the sensor."""
    thickness_mm: float
    """Thickness of the silicone at the first touch."""

    @property
    def strain(self) -> float:
        """Indentation over the thickness of the silicone: a measure of its mean compression."""
        return self.depth_mm / self.thickness_mm


@dataclass(frozen=True, eq=False)
class Scene:
    """Pad in a pose: the gap before the touch on a grid, and the kernels of the layer."""

    gap_mm: Array
    """Gap [mm], shape (x, z); infinite where nothing may press."""
    compliance: Array
    """Compliance C on the grid's waves [mm/MPa]."""
    pressure_map: NDArray[np.complex128]
    """T, and from its imaginary part S along z, on the grid's waves."""
    active: Array
    """Fraction of each cell that the active area covers."""
    x_mm: Array
    dz_mm: Array
    thickness_mm: float
    symmetric_force_n: float = 0.0


def place(form: PadForm, pose: Pose) -> Scene:
    """Bring pad and object to their first touch, and lay the grid around it."""
    half, length = form.outer.section.half_width, form.outer.spans[-1].z[2]
    x = GRID_MM * np.arange(-math.ceil(half / GRID_MM), math.ceil(half / GRID_MM) + 1)[:, None]
    first = math.ceil(-form.sensor_z_mm / GRID_MM)
    dz = GRID_MM * np.arange(first, math.ceil((length - form.sensor_z_mm) / GRID_MM) + 1)[None, :]
    shape = np.broadcast_shapes(x.shape, dz.shape)
    xs, zs = np.broadcast_to(x, shape), np.broadcast_to(dz, shape)
    near = form.skin_mm(xs, zs + form.sensor_z_mm) - pose.object_mm(xs, zs) + form.base_slope * zs
    near = np.where(np.isnan(near), -math.inf, near)
    gap = near.max() - near
    i, j = np.unravel_index(int(near.argmax()), shape)
    at = np.array([[x[i, 0]]]), np.array([[dz[0, j] + form.sensor_z_mm]])
    bone = float(form.bone_mm(*at)[0, 0])
    thickness = float(form.skin_mm(*at)[0, 0]) - max(bone, 0.0)
    used = gap < _REACH_MM
    (low_x, high_x), (low_z, high_z) = (np.flatnonzero(used.any(axis=axis))[[0, -1]] for axis in (1, 0))
    margin = math.ceil(_MARGIN * thickness / GRID_MM)
    sizes = [
        next(n for n in _SIZES if n >= high - low + 1 + margin) for low, high in ((low_x, high_x), (low_z, high_z))
    ]
    # The active area must lie on the grid too, as far as any pressure reaches it.
    field = np.full(sizes, math.inf)
    field[: high_x - low_x + 1, : high_z - low_z + 1] = np.where(used, gap, math.inf)[
        low_x : high_x + 1, low_z : high_z + 1
    ]
    xs1, dz1 = x[0, 0] + GRID_MM * (low_x + np.arange(sizes[0])), dz[0, 0] + GRID_MM * (low_z + np.arange(sizes[1]))
    # Positions wrap around: the margin lies half before and half behind the surface.
    xs1, dz1 = (_unwrap(line, high - low + 1) for line, low, high in ((xs1, low_x, high_x), (dz1, low_z, high_z)))
    compliance, pressure_map = _kernels(sizes, thickness, form.young_mpa, form.poisson)
    return Scene(field, compliance, pressure_map, _cover(xs1, dz1, form.active_radius_mm), xs1, dz1, thickness)


def _unwrap(line: Array, used: int) -> Array:
    """Count the second half of the margin from the other end of the grid."""
    size, behind = len(line), (len(line) - used) // 2
    return np.where(np.arange(size) < size - behind, line, line - GRID_MM * size)


def _cover(x: Array, dz: Array, radius: float) -> Array:
    inner = GRID_MM * ((np.arange(_SUPERSAMPLED) + 0.5) / _SUPERSAMPLED - 0.5)
    squares = ((x[:, None] + inner) ** 2)[:, None, :, None] + ((dz[:, None] + inner) ** 2)[None, :, None, :]
    share: Array = (squares <= radius * radius).mean(axis=(2, 3))
    return share


def _kernels(sizes: list[int], h: float, young: float, nu: float) -> tuple[Array, NDArray[np.complex128]]:
    kx = 2.0 * math.pi * np.fft.fftfreq(sizes[0], GRID_MM)[:, None]
    kz = 2.0 * math.pi * np.fft.rfftfreq(sizes[1], GRID_MM)[None, :]
    k = np.hypot(kx, kz)
    w, ka = k * h, 3.0 - 4.0 * nu
    # All terms are divided by exp(2 w), which overflows for short waves.
    one, two = np.exp(-w), np.exp(-2.0 * w)
    cosh, sinh = 0.5 * (one + one * two), 0.5 * (one - one * two)
    d = ka * (1.0 + two * two) + (1.0 + ka * ka + 4.0 * w * w) * two
    whole = np.where(k > 0.0, k, 1.0)
    compliance = 2.0 * (1.0 - nu * nu) / (young * whole) * (ka * (1.0 - two * two) - 4.0 * w * two) / d
    compliance[0, 0] = (1.0 + nu) * (1.0 - 2.0 * nu) / (young * (1.0 - nu)) * h
    normal = (ka + 1.0) * ((ka + 1.0) * cosh + 2.0 * w * sinh) / d
    shear = (ka + 1.0) * ((ka - 1.0) * sinh + 2.0 * w * cosh) / d
    return compliance, normal - 1j * shear * kz / whole


def press(scene: Scene, force_n: float, start: Array | None = None) -> tuple[Contact, Array]:
    """Find the pressures [MPa] at a force; `start` are those of a neighbouring one."""
    cell, open_ = GRID_MM**2, np.isfinite(scene.gap_mm)
    gap = np.where(open_, scene.gap_mm, 1e6)
    p = (gap < 0.3) / cell if start is None else start
    p = p * (force_n / (p.sum() * cell))
    direction, before, restart = np.zeros_like(p), 1.0, True
    for _ in range(_MAX_ITERATIONS):
        on = p > 0.0
        error = np.where(open_, _apply(p, scene.compliance) + gap, 0.0)
        error -= error[on].mean()
        squared = float((error[on] ** 2).sum())
        direction = np.where(on, error + (0.0 if restart else squared / before) * direction, 0.0)
        before = squared
        response = _apply(direction, scene.compliance)
        response -= response[on].mean()
        step = float((error * direction)[on].sum() / (response * direction)[on].sum())
        after = np.maximum(np.where(on, p - step * direction, 0.0), 0.0)
        # Cells that the surface has reached without a pressure come into contact, and the search begins anew.
        joined = open_ & (after == 0.0) & (error < 0.0)
        restart = bool(joined.any())
        after = np.where(joined, after - step * error, after)
        after *= force_n / (after.sum() * cell)
        change, p = float(np.abs(after - p).sum()) * cell, after
        if change < _TOLERANCE * force_n:
            break
    return _summarise(scene, force_n, p, gap), p


def _apply(p: Array, kernel: NDArray[np.float64] | NDArray[np.complex128]) -> Array:
    return np.fft.irfft2(np.fft.rfft2(p) * kernel, s=p.shape)


def _summarise(scene: Scene, force_n: float, p: Array, gap: Array) -> Contact:
    cell, on = GRID_MM**2, p > 0.0
    depth = float((_apply(p, scene.compliance) + gap)[on].mean())
    normal = _apply(p, scene.pressure_map.real)
    shear = _apply(p, 1j * scene.pressure_map.imag)
    # Stiffness: the force that a uniform approach of the surfaces in contact adds, by the compliance of that patch.
    return Contact(
        force_n, float((normal * scene.active).sum()) * cell / force_n,
        float((shear * scene.active).sum()) * cell / force_n, depth, 0.0, float(on.sum()) * cell, float(p.max()),
        (float((p * scene.x_mm[:, None]).sum()) * cell / force_n, float((p * scene.dz_mm).sum()) * cell / force_n),
        scene.thickness_mm,
    )  # fmt: skip
