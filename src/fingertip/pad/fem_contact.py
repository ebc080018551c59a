"""Contact of the pad with rigid objects, and what of the force reaches the sensor, by finite
elements.

Small strains, no friction, skin bonded to rigid bone; one that lies on it is pressed at large
strain. Where there is no bone below, at the sides and the tip, it is held at the parting plane; its
proximal end slides on the collar. Pressures are linear between the nodes of the surface and act
along the normal of the object. With the compliance of the surface they solve a complementarity
problem: pressure >= 0, gap >= 0, and one of both is 0 (N. Kikuchi and J. T. Oden, Contact Problems
in Elasticity, 1988).

The load on the sensor's active area is a linear functional of these pressures. By Betti's theorem
its weights are the displacements of the surface that a unit displacement of the active area would
cause: one solution serves all contacts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.pad.fem_elastic import Body, Surface, triangle_shapes
from fingertip.pad.fem_mesh import MeshSize, mesh_skin
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import PALM, Pose, Touch, X, Z

MAX_DEPTH = 0.45
MAX_STRAIN = 0.3
"""Depth relative to the skin's thickness at first touch, and principal strain, to which small
strains are trusted.
"""
_BATCH = 64
"""Columns of the compliance that are solved for at a time."""
_ALONG = 0.025
"""Part of the normals along an axis, below which it is left out of the compliance: its square
counts.
"""
_SEED = 12
_GROWTH = 1.4
"""Nodes with which the search for a patch begins, and growth of the depth that it may reach, until
it lies within.
"""
_MAX_STEPS = 80
"""Largest number of steps of the search for a patch; five are usual.
In the second half one node changes a step.
"""


@dataclass(frozen=True)
class PadContact:
    """Contact of the pad under a force, and what it does to the skin.

    The share is the load on the active area, normal to the sensor's plane, over the force. Depth is
    the object's travel after the first touch; the centre of pressure is x and the distance distal
    to the sensor. Strain is the largest principal one by magnitude, in the middle of an element;
    shear and tension at the bond are the largest means of an element's face. At edges of the bone
    finer meshes see more.
    """

    share: float
    shear_share: float
    """Load on the active area over a force along the surface, towards the tip, which is spread as
    the pressure is.
    """
    force_n: float
    depth_mm: float
    stiffness_n_per_mm: float
    centre_mm: tuple[float, float]
    area_mm2: float
    strain: float
    bond_shear_mpa: float
    bond_tension_mpa: float


class PadModel:
    """Meshed skin, the compliance of its surface as far as asked for, and the weights of the share.

    What costs time is computed at its first use: a pose may be refused before.
    """

    def __init__(self, form: PadForm, size: MeshSize, *, is_half: bool) -> None:
        self.form = form
        self.copies = 2.0 if is_half else 1.0
        self.mesh, self._is_bonded = mesh_skin(form, size, is_half)
        nodes = self.mesh.nodes
        count = self.mesh.count
        self._triangles = self.mesh.triangles
        self._upper = slice(len(nodes) - count, None)
        self._lower = slice(0, count)
        self.top, self.bond = (
            Surface.of_nodes(nodes[part], self._triangles) for part in (self._upper, self._lower)
        )
        self.area = np.asarray(self.top.trace.sum(axis=0)).ravel()
        self.at_rest: tuple[float, Array] | None = None
        """Force on the sensor and displacements while nothing touches, once a contact at large
        strain needs them.
        """
        self._solved = np.full((3, len(self.area)), -1)
        self._columns = [np.zeros((3, len(self.area), 0)) for _ in range(3)]

    @cached_property
    def body(self) -> Body:
        nodes = self.mesh.nodes
        is_fixed = np.zeros(nodes.shape, bool)
        is_fixed[self._lower] = True
        is_fixed[self._find_loose()] = False
        is_fixed[nodes[:, Z] <= 0.0, Z] = True
        is_fixed[nodes[:, X] <= 0.0, X] |= self.copies > 1.0
        everywhere = np.ones(len(self.mesh.wedges))
        young = self.form.young_mpa * everywhere
        poisson = self.form.poisson * everywhere

        return Body(self.mesh, young, poisson, is_fixed)

    def _find_loose(self) -> NDArray[np.int64]:
        """Find the nodes of the lower surface that lie on the bone without a bond."""
        x, z, _ = self.bond.points.T
        return np.flatnonzero(np.isfinite(self.form.bone_mm(x, z)) & (not self.form.bonded))

    def find_bone_planes(self) -> tuple[Any, Array, Array]:
        """Find trace, unit vectors into the bone, and mean gaps of the nodes that lie on it without
        a bond.
        """
        points = self.bond.points
        nodes = self._find_loose()
        a, b, c = points[self._triangles[:, :3]].transpose(1, 0, 2)
        normals = np.zeros_like(points)
        np.add.at(normals, self._triangles, np.cross(c - a, b - a)[:, None])
        normals = (normals / np.linalg.norm(normals, axis=1)[:, None])[nodes]
        trace = self.bond.trace[:, nodes]
        gap = self.form.inner_gap_mm(points[:, X], points[:, Z])
        mean = (trace.T @ gap) / np.asarray(trace.sum(axis=0)).ravel()

        return trace, -normals * np.sign(normals[:, [PALM]]), mean

    @cached_property
    def step(self) -> Array:
        """Displacements of all nodes: 1 towards the skin on the active area, and 0 elsewhere.

        The step is projected to the shape functions: the load is then the integral of the traction
        over the disc, without a part of the elements around it.
        """
        arm = np.hypot(self.bond.points[:, X], self.bond.points[:, Z] - self.form.sensor_z_mm)
        disc = (arm[self._triangles] <= self.form.active_radius_mm * (1.0 + 1e-9)).all(axis=1)
        inside = Surface.of_nodes(self.bond.points, self._triangles[disc]).mass.sum(axis=1)
        step = np.zeros(self.mesh.nodes.shape)
        step[self._lower, PALM] = self.bond.project(np.asarray(inside).ravel())

        return step

    @cached_property
    def _weights(self) -> Array:
        """Displacements of the surface for a unit step of the active area."""
        step = self.step[..., None]
        return self.body.move(np.zeros_like(step), step)[self._upper, :, 0]

    def compliance(self, nodes: NDArray[np.int64], into: Array) -> Array:
        """Displacements at nodes of the surface under unit pressures at them, both along the
        vectors `into`.
        """
        total = np.zeros((len(nodes), len(nodes)))
        along = np.abs(into).max(axis=0) > _ALONG
        into = into * along

        for axis in np.flatnonzero(along):
            new = nodes[self._solved[axis, nodes] < 0]
            self._solved[axis, new] = self._columns[axis].shape[2] + np.arange(len(new))
            parts = [self._columns[axis]]

            for start in range(0, len(new), _BATCH):
                load = self.top.trace[:, new[start : start + _BATCH]].toarray()
                loads = np.zeros((*self.mesh.nodes.shape, load.shape[1]))
                loads[self._upper, axis] = load
                moved = self.body.move(loads)[self._upper]
                parts.append(np.stack([self.top.trace.T @ moved[:, axis] for axis in range(3)]))

            self._columns[axis] = np.concatenate(parts, axis=2)
            block = self._columns[axis][:, nodes[:, None], self._solved[axis, nodes]]
            total += np.einsum("ic,cij->ij", into, block) * into[:, axis]

        return total

    def fine_surface(self) -> Array:
        """Return points of the curved surface, finer than its nodes."""
        steps = np.array([(i, j) for i in range(7) for j in range(7 - i)]) / 6
        points = np.einsum(
            "qa,eai->eqi", triangle_shapes(steps)[0], self.top.points[self._triangles]
        )
        return np.asarray(points.reshape(-1, 3))

    def sense(self, tractions: Array) -> float:
        """Load on the active area [N] under tractions of the surface."""
        return -self.copies * float((self.top.trace @ tractions * self._weights).sum())

    def map_shares(self, step_mm: float) -> tuple[Array, Array, Array]:
        """Map the share of a force on a small place on a grid: x and distance distal to the sensor,
        and the share.
        """
        from scipy.interpolate import griddata  # noqa: PLC0415

        x = self.top.points[:, X]
        dz = self.top.points[:, Z] - self.form.sensor_z_mm
        reach = step_mm * math.ceil((self.form.active_radius_mm + 9.0) / step_mm)
        line = np.arange(-reach, reach + step_mm / 2, step_mm)
        at = np.meshgrid(np.abs(line), line, indexing="ij")
        shares = griddata((x, dz), self._weights[:, PALM], tuple(at), fill_value=0.0)

        return line, line, np.round(shares, 3)

    def strain(self, tractions: Array) -> tuple[float, float, float]:
        """Return the largest strain, and shear and tension at the bond [MPa], under tractions of
        the surface.
        """
        load = np.zeros((*self.mesh.nodes.shape, 1))
        load[self._upper, :, 0] = self.top.trace @ tractions
        moved = self.body.move(load)[:, :, 0]
        forces = self.body.support(moved)[self._lower]
        if self.copies > 1.0:
            forces[self.bond.points[:, X] <= 0.0, X] = 0.0  # of the other half, not of the bone

        bond_forces = self.bond.project(forces)
        faces = self._triangles[self._is_bonded]
        a, b, c = self.bond.points[faces[:, :3]].transpose(1, 0, 2)
        normal = np.cross(c - a, b - a)
        normal *= (np.sign(normal[:, PALM]) / np.linalg.norm(normal, axis=1))[:, None]
        mean = bond_forces[faces[:, 3:]].mean(axis=1)  # exact for quadratic functions
        along = (mean * normal).sum(axis=1)
        shear = np.linalg.norm(mean - along[:, None] * normal, axis=1)

        return (
            float(np.abs(self.body.strains(moved)).max()),
            float(shear.max()),
            max(0.0, -float(along.min())),
        )


class Patch:
    """Contact of a pose, with the nodes of the surface that it can have reached so far."""

    def __init__(self, model: PadModel, pose: Pose) -> None:
        self._model = model
        surface = model.top.points
        touch, point = Touch.of_pose(model.form, pose, model.fine_surface())
        nearest = int(np.argmin(np.linalg.norm(surface - point, axis=1)))
        thickness = float(surface[nearest, PALM] - model.bond.points[nearest, PALM])
        self._limit, self._reason = min(
            (MAX_DEPTH * thickness, f"{MAX_DEPTH:g} of the skin's {thickness:.2g} mm"),
            (touch.rigid_mm, "where the object reaches bone or collar"),
        )
        gap, self._into, closing = touch.gaps(surface)
        self._travel = gap / closing
        self._reach = float(np.partition(self._travel, _SEED)[_SEED])
        self._weight = model.area * closing
        # The normal is that at the node, as in the work of its pressure; the distance is averaged
        # around the node.
        self._gap = model.top.trace.T @ (gap / self._into[:, PALM]) * self._into[:, PALM]
        self._active = self._travel <= self._reach

    def press(self, force_n: float, *, with_strain: bool = True) -> PadContact:
        """Press with a force, larger than the one before. Raises TraceError beyond small strains.

        Without strain, which needs another solution, strain, shear and tension are NaN.
        """
        if not 0.0 < force_n < math.inf:
            raise TraceError(
                Issue("force_n", f"{force_n:g} N does not press; use a force above 0.")
            )

        model = self._model
        while True:
            nodes = np.flatnonzero(self._travel <= self._reach)
            into = self._into[nodes]
            pressure, depth, slope, active = find_patch(
                model.compliance(nodes, into),
                gap=self._gap[nodes],
                weight=self._weight[nodes],
                force_n=force_n / model.copies,
                active=self._active[nodes],
            )
            self._active[nodes] = active
            if depth <= self._reach:
                break
            if self._reach >= self._limit:
                raise _refuse(
                    force_n,
                    f"presses {depth:.2g} mm deep, beyond {self._limit:.2g} mm, {self._reason}",
                )

            self._reach = min(_GROWTH * self._reach, depth, self._limit)

        tractions = np.zeros_like(self._into)
        tractions[nodes] = -pressure[:, None] * into
        strain, shear, tension = model.strain(tractions) if with_strain else (math.nan,) * 3

        if strain > MAX_STRAIN:
            raise _refuse(
                force_n,
                f"strains the skin by {strain:.2f}, beyond the {MAX_STRAIN:g} of small strains",
            )

        flow = pressure * self._weight[nodes]
        along = np.zeros_like(tractions)
        along[nodes, Z] = pressure
        spread = model.copies * model.area[nodes]
        x, z = flow @ model.top.points[nodes][:, [X, Z]] / flow.sum()

        return PadContact(
            share=model.sense(tractions) / force_n,
            shear_share=model.sense(along) / float(spread @ pressure),
            force_n=force_n,
            depth_mm=depth,
            stiffness_n_per_mm=model.copies / slope,
            centre_mm=(0.0 if model.copies > 1.0 else float(x), float(z) - model.form.sensor_z_mm),
            area_mm2=float(spread[pressure > 0.0].sum()),
            strain=strain,
            bond_shear_mpa=shear,
            bond_tension_mpa=tension,
        )


def _refuse(force_n: float, problem: str) -> TraceError:
    return TraceError(
        Issue("force_n", f"{force_n:g} N {problem}; use less force, or a thicker or harder skin.")
    )


def find_patch(
    compliance: Array,
    gap: Array,
    weight: Array,
    force_n: float,
    active: NDArray[np.bool_],
) -> tuple[Array, float, float, NDArray[np.bool_]]:
    """Find pressures, depth, its increase by force and the patch under a force, from a first guess
    of the patch.

    Gap and weight are integrals around the nodes, of the distance and of what a unit depth takes of
    it. A primal-dual active set (M. Hintermueller, K. Ito and K. Kunisch, SIAM J. Optim. 13 (2002)
    865).
    """
    for step in range(_MAX_STEPS):
        index = np.flatnonzero(active)
        n = len(index)
        system = np.zeros((n + 1, n + 1))
        right = np.zeros((n + 1, 2))
        system[:n, :n] = compliance[np.ix_(index, index)]
        system[:n, n] = -weight[index]
        system[n, :n] = weight[index]
        right[:n, 0] = -gap[index]
        right[n] = (force_n, 1.0)
        solution = np.linalg.solve(system, right)
        pressure = np.zeros(len(gap))
        pressure[index] = solution[:n, 0]
        depth = float(solution[n, 0])
        rest = (gap + compliance[:, index] @ solution[:n, 0]) / weight - depth
        # By how much pressures pull and the rest overlaps, relative to the largest pressure and to
        # the depth.
        wrong = np.where(active, -pressure / np.abs(pressure).max(), -rest / max(abs(depth), 1e-12))
        if wrong.max() <= 1e-9:
            break

        active = active ^ ((wrong > 1e-9) if 2 * step < _MAX_STEPS else (wrong == wrong.max()))
        active |= (rest == rest.min()) & ~active.any()

    return pressure, depth, float(solution[n, 1]), active
