"""Layer model of the pad: contact between a rigid object and a layer of silicone on rigid bone.

The layer is as thick everywhere as at the first touch; its surface keeps the form of the skin. In
the Fourier domain each wave of pressure deforms it on its own, and the compliance C(k), the
pressure on the bone T(k), and the pressure on the bone under a traction along the surface S(k)
follow in closed form. With w = k h and ka = 3 - 4 nu

    D(w) = 2 ka cosh 2w + 1 + ka^2 + 4 w^2
    C(k) = 2 (1 - nu^2) / (E k) (2 ka sinh 2w - 4 w) / D
    T(k) = (ka + 1) ((ka + 1) cosh w + 2 w sinh w) / D
    S(k) = (ka + 1) ((ka - 1) sinh w + 2 w cosh w) / D

where the layer is bonded. Where it lies on the bone without friction, it is half of a layer that is
pressed from both sides (K. L. Johnson, Contact Mechanics, 1985, section 5.8), and with D(w) = sinh
2w + 2 w

    C(k) = 2 (1 - nu^2) / (E k) (cosh 2w - 1) / D,    T(k) = 2 (sinh w + w cosh w) / D,    S(k) =
        2 w sinh w / D

Friction mu lies between: tanh mu of the bonded, the rest of the free. By finite elements (1 N on
first_finger, tilted by 2 degrees) the share goes 0.15, 0.30, 0.55 of the way for mu = 0.15, 0.3,
0.6, and the depth 0.16, 0.32, 0.55.

The contact is found by conjugate gradients on the pressures that are not negative, at a given force
(I. A. Polonsky and L. M. Keer, A numerical method for solving rough contact problems, Wear 231
(1999) 206). Small strain, no friction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.pad.loose_skin import Inside, lay_rings
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import Pose, Touch

GRID_MM = 0.25
_FIRST_REACH_MM = 0.8
_MAX_REACH_MM = 6.4
"""Gap before the touch up to which the surface may come into contact: at first, and at most [mm].
"""
_MARGIN = 2.0
"""Width around that surface on which nothing presses, in thicknesses: waves wrap around the grid's
edge.
"""
_SIZES = tuple(sorted(2**a * 3**b * 5**c for a in range(2, 9) for b in range(4) for c in range(2)))
"""Lengths of a grid for which the Fourier transform is fast."""
_TOLERANCE = 2e-4
"""Share of the load by which the pressures change in the last iteration."""
_MAX_ITERATIONS = 400
_SUPERSAMPLED = 5
"""Points along each side of a cell with which the edge of the active area is followed."""
_FREE_SIDES = 0.94
"""Modulus of the layer over that of the silicone, which ends at the sides of the finger: the median
over random forms at 1 N, by finite elements (benchmarks/pad.py).
"""
MAX_STRAIN = 0.5
"""Largest indentation over the thickness of the layer: beyond it, small strain says nothing.
An assumption.
"""


@dataclass(frozen=True)
class Contact:
    force_n: float
    share: float
    """Fraction of the force that presses on the active area of the sensor, beside what presses
    there at rest.
    """
    shear_share: float
    """Force on the active area over a force along the surface, towards the tip, which is spread as
    the pressure is.
    """
    depth_mm: float
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
class _Layout:
    """Gap before the touch on a grid around it, and the layer's kernels for the grid's waves."""

    gap_mm: Array
    """Gap [mm], shape (x, z); infinite where nothing may press."""
    reach_mm: float
    compliance: Array
    """Compliance C [mm/MPa]."""
    to_bone: Array
    """Pressure on the bone T."""
    shear_to_bone: NDArray[np.complex128]
    """Pressure on the bone under a traction towards the tip, from S."""
    active: Array
    """Fraction of each cell that the active area covers."""
    x_mm: Array
    dz_mm: Array
    thickness_mm: float
    grid_mm: float


def find_contacts(
    form: PadForm,
    pose: Pose,
    forces_n: Sequence[float],
    max_strain: float = MAX_STRAIN,
    grid_mm: float = GRID_MM,
) -> list[Contact]:
    """Find the contact at each of some growing forces. Raises TraceError."""
    near = bring(form, pose, grid_mm)
    layout = near.lay_out(_FIRST_REACH_MM)
    pressure = None
    inside = _lay_rings(form)
    contacts: list[Contact] = []

    for force_n in forces_n:
        while True:
            contact, pressure = _press(layout, force_n, pressure)
            # A contact that has grown to the edge of what may press is computed again with more of
            # the surface.
            if contact.depth_mm < 0.9 * layout.reach_mm or layout.reach_mm >= _MAX_REACH_MM:
                break

            layout = near.lay_out(2.0 * layout.reach_mm)
            pressure = None

        if contact.strain > max_strain:
            most = (
                contacts[-1].force_n if contacts else force_n * (max_strain / contact.strain) ** 2
            )
            message = (
                f"{force_n:g} N presses the pad by {contact.strain:.0%} of its thickness; "
                f"at most {most:.2g} N."
            )
            raise TraceError(Issue("force_n", message))

        if inside:  # the inside of the skin meets the bone
            on = pressure > 0.0
            distance = np.hypot(layout.x_mm[:, None], layout.dz_mm[None, :])
            more_n, sunk = inside.compare(pressure[on] * layout.grid_mm**2, distance[on])
            share = contact.share + more_n / contact.force_n
            depth = contact.depth_mm + sunk / contact.force_n
            contact = replace(contact, share=max(0.0, share), depth_mm=depth)

        contacts.append(contact)

    return contacts


def find_rest_n(form: PadForm) -> float:
    """Find the force on the active area when nothing touches the finger, from a bump inside the
    skin [N].
    """
    inside = _lay_rings(form)
    return inside.rest_n if inside else 0.0


def _lay_rings(form: PadForm) -> Inside | None:
    return lay_rings(form, _FREE_SIDES * form.young_mpa)


def map_shares(form: PadForm) -> tuple[Array, Array, Array]:
    """Map the share of a force on a small place: x and distance distal to the sensor [mm], and the
    share at both.

    The pressure T under a force at a place, summed over the active area, is the same as T under a
    pressure of one on the active area, at that place.
    """
    thickness = form.over_sensor_mm
    reach = form.active_radius_mm + 3.0 * thickness
    count = math.ceil(reach / GRID_MM)
    size = next(n for n in _SIZES if n >= 4 * count)
    line = GRID_MM * (np.arange(size, dtype=np.float64) - 2 * count)
    _, to_bone, _ = _kernels(
        [size, size],
        h=thickness,
        young=form.young_mpa,
        nu=form.poisson,
        bond_share=form.held_part,
    )
    shares = _apply(_cover(line, line, form.active_radius_mm), to_bone)
    inside = slice(count, 3 * count + 1)

    return line[inside], line[inside], shares[inside, inside]


@dataclass(frozen=True, eq=False)
class _Approach:
    """Whole pad before an object, at the first touch."""

    form: PadForm
    x_mm: Array
    dz_mm: Array
    gap_mm: Array
    thickness_mm: float
    grid_mm: float

    def lay_out(self, reach_mm: float) -> _Layout:
        """Lay a grid around the part of the pad that lies within reach of the object."""
        used = self.gap_mm < reach_mm
        ends = [np.flatnonzero(used.any(axis=axis))[[0, -1]] for axis in (1, 0)]
        margin = math.ceil(_MARGIN * self.thickness_mm / self.grid_mm)
        counts = [int(high - low) + 1 for low, high in ends]
        sizes = [next(n for n in _SIZES if n >= count + margin) for count in counts]
        gap = np.full(sizes, math.inf)
        inside = tuple(slice(int(low), int(high) + 1) for low, high in ends)
        gap[: counts[0], : counts[1]] = np.where(used, self.gap_mm, math.inf)[inside]
        x, dz = (
            _unwrap(float(line[low]), size, count, self.grid_mm)
            for line, (low, _), size, count in zip(
                (self.x_mm, self.dz_mm), ends, sizes, counts, strict=True
            )
        )
        form = self.form
        grid = self.grid_mm
        kernels = _kernels(
            sizes,
            h=self.thickness_mm,
            young=_FREE_SIDES * form.young_mpa,
            nu=form.poisson,
            bond_share=form.held_part,
            grid_mm=grid,
        )
        active = _cover(x, dz, form.active_radius_mm, grid)

        return _Layout(gap, reach_mm, *kernels, active, x, dz, self.thickness_mm, grid)


def bring(form: PadForm, pose: Pose, grid_mm: float = GRID_MM) -> _Approach:
    """Bring the object of a pose to the pad. Raises TraceError for a pose that cannot be."""
    half = form.outer.section.half_width
    length = form.outer.spans[-1].z[2]
    count = math.ceil(half / grid_mm)
    x = grid_mm * np.arange(-count, count + 1, dtype=np.float64)
    low, high = (math.ceil(z / grid_mm) for z in (-form.sensor_z_mm, length - form.sensor_z_mm))
    dz = grid_mm * np.arange(low, high + 1, dtype=np.float64)
    xs, zs = np.meshgrid(x, dz, indexing="ij")
    surface = form.skin_mm(xs, zs + form.sensor_z_mm)
    on_skin = np.isfinite(surface)
    points = np.column_stack([xs[on_skin], zs[on_skin] + form.sensor_z_mm, surface[on_skin]])
    touch, (at_x, at_z, height) = Touch.of_pose(form, pose, points)
    gap = np.full(xs.shape, math.inf)
    gap[on_skin] = touch.clear_mm(points)
    thickness = float(height - max(form.bone_mm(at_x[None], at_z[None])[0], 0.0))

    return _Approach(
        form=form,
        x_mm=x,
        dz_mm=dz,
        gap_mm=gap,
        thickness_mm=thickness,
        grid_mm=grid_mm,
    )


@lru_cache(maxsize=1024)
def is_possible(form: PadForm, pose: Pose) -> bool:
    with suppress(TraceError):
        bring(form, pose)
        return True

    return False


def _unwrap(start: float, size: int, used: int, grid_mm: float) -> Array:
    """Return the positions of a grid that wraps around: the second half of its margin lies before
    its start.
    """
    index = np.arange(size)
    behind = (size - used) // 2
    return start + grid_mm * np.where(index < size - behind, index, index - size)


def _cover(x: Array, dz: Array, radius: float, grid_mm: float = GRID_MM) -> Array:
    inner = grid_mm * ((np.arange(_SUPERSAMPLED) + 0.5) / _SUPERSAMPLED - 0.5)
    squares = ((x[:, None] + inner) ** 2)[:, None, :, None] + ((dz[:, None] + inner) ** 2)[
        None, :, None, :
    ]
    return np.asarray((squares <= radius * radius).mean(axis=(2, 3)))


def _kernels(
    sizes: list[int],
    h: float,
    young: float,
    nu: float,
    bond_share: float = 1.0,
    grid_mm: float = GRID_MM,
) -> tuple[Array, Array, NDArray[np.complex128]]:
    """Evaluate C, T and S on the waves of a grid.

    All terms are divided by exp(2 w), which overflows.
    """
    kx = 2.0 * math.pi * np.fft.fftfreq(sizes[0], grid_mm)[:, None]
    kz = 2.0 * math.pi * np.fft.rfftfreq(sizes[1], grid_mm)[None, :]
    k = np.hypot(kx, kz)
    w = k * h
    ka = 3.0 - 4.0 * nu
    decay = np.exp(-w)
    two = np.exp(-2.0 * w)
    cosh = 0.5 * decay * (1.0 + two)
    sinh = 0.5 * decay * (1.0 - two)
    whole = np.where(k > 0.0, k, 1.0)
    d = ka * (1.0 + two * two) + (1.0 + ka * ka + 4.0 * w * w) * two
    compliance = (
        2.0 * (1.0 - nu * nu) / (young * whole) * (ka * (1.0 - two * two) - 4.0 * w * two) / d
    )
    compliance[0, 0] = (1.0 + nu) * (1.0 - 2.0 * nu) / (young * (1.0 - nu)) * h
    normal = (ka + 1.0) * ((ka + 1.0) * cosh + 2.0 * w * sinh) / d
    shear = (ka + 1.0) * ((ka - 1.0) * sinh + 2.0 * w * cosh) / d

    if bond_share < 1.0:
        d = np.where(k > 0.0, 0.5 * (1.0 - two * two) + 2.0 * w * two, 1.0)
        free = (1.0 - nu * nu) / (young * whole) * (1.0 - two) ** 2 / d
        free[0, 0] = (1.0 - nu * nu) / young * h
        compliance = bond_share * compliance + (1.0 - bond_share) * free
        passed = np.where(k > 0.0, 2.0 * (sinh + w * cosh) / d, 1.0)
        normal = bond_share * normal + (1.0 - bond_share) * passed
        shear = bond_share * shear + (1.0 - bond_share) * 2.0 * w * sinh / d

    return compliance, normal, -1j * shear * kz / whole


def _press(layout: _Layout, force_n: float, start: Array | None) -> tuple[Contact, Array]:
    """Find the pressures [MPa] at a force; `start` are those of a smaller one."""
    cell = layout.grid_mm**2
    may_press = np.isfinite(layout.gap_mm)
    gap = np.where(may_press, layout.gap_mm, 0.0)
    p = (may_press & (gap < 0.25 * layout.reach_mm)) / cell if start is None else start
    p = p * (force_n / (p.sum() * cell))
    direction = np.zeros_like(p)
    before = 1.0
    restart = True

    for _ in range(_MAX_ITERATIONS):
        on = p > 0.0
        error = _apply(p, layout.compliance) + gap
        error -= error[on].mean()
        squared = float((error[on] ** 2).sum())
        direction = np.where(on, error + (0.0 if restart else squared / before) * direction, 0.0)
        response = _apply(direction, layout.compliance)
        response -= response[on].mean()
        curvature = float((response * direction)[on].sum())
        if squared == 0.0 or curvature <= 0.0:
            break

        before = squared
        step = float((error * direction)[on].sum()) / curvature
        after = np.maximum(np.where(on, p - step * direction, 0.0), 0.0)
        # Cells that the surface has reached without a pressure come into contact, and the search
        # begins anew.
        joined = may_press & (after == 0.0) & (error < 0.0)
        restart = bool(joined.any())
        after = np.where(joined, after - step * error, after)
        after *= force_n / (after.sum() * cell)
        change = float(np.abs(after - p).sum()) * cell
        p = after
        if change < _TOLERANCE * force_n:
            break

    return _summarise(layout, force_n, p, gap), p


def _apply(p: Array, kernel: NDArray[np.float64] | NDArray[np.complex128]) -> Array:
    return np.fft.irfft2(np.fft.rfft2(p) * kernel, s=p.shape)


def _summarise(layout: _Layout, force_n: float, p: Array, gap: Array) -> Contact:
    cell = layout.grid_mm**2
    on = p > 0.0

    def mean(values: Array) -> float:
        return float((p * values).sum()) * cell / force_n

    share, sheared = (
        float((_apply(p, kernel) * layout.active).sum()) * cell / force_n
        for kernel in (layout.to_bone, layout.shear_to_bone)
    )
    depth = float((_apply(p, layout.compliance) + gap)[on].mean())
    centre = mean(layout.x_mm[:, None]), mean(layout.dz_mm[None, :])
    return Contact(
        force_n=force_n,
        share=share,
        shear_share=sheared,
        depth_mm=depth,
        area_mm2=float(on.sum()) * cell,
        peak_mpa=float(p.max()),
        centre_mm=centre,
        thickness_mm=layout.thickness_mm,
    )
