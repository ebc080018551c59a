"""Inside of a skin that lies on the bone, by finite elements: its compliance, and its contact without friction.

A pressure acts on the skin along the normal of the bone, and never pulls. Gaps may hold an overlap: that of a bump.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.pad.fem_elastic import Body, Surface
from fingertip.pad.fem_mesh import WedgeMesh
from fingertip.pad.form import PadForm
from fingertip.pad.touch import PALM

_BATCH = 64
"""Pressures whose displacements are solved for at a time."""


@dataclass(frozen=True, eq=False)
class InsideContact:
    """Places where the skin may touch the bone. Gap and compliance are integrals around the nodes, as outside."""

    trace: Any
    into: Array
    """Unit vectors into the bone."""
    area: Array
    gap: Array
    on_sensor: Array
    """Force on the active area under unit pressures, normal to the sensor's plane."""
    compliance: Array
    outside: Array
    """Displacements of the outer surface under unit pressures, of shape (axis, outer node, inner node)."""

    @classmethod
    def of_mesh(
        cls, form: PadForm, body: Body, mesh: WedgeMesh, sides: tuple[Surface, Surface], disc: NDArray[np.int64]
    ) -> InsideContact:
        """Solve for a unit pressure at each node on the bone. `disc` are the triangles of the active area."""
        bond, top = sides
        nodes = find_loose(form, bond.points)
        trace, into, gap = find_bone_planes(form, bond, mesh.triangles)
        compliance, outside = np.zeros((len(nodes), len(nodes))), np.zeros((3, len(top.points), len(nodes)))
        for start in range(0, len(nodes), _BATCH):
            part = slice(start, start + _BATCH)
            load = np.zeros((*mesh.nodes.shape, len(into[part])))
            load[: mesh.count] = trace[:, part].toarray()[:, None] * into[part].T
            moved = body.move(load)
            for axis in range(3):
                compliance[:, part] += (trace.T @ moved[: mesh.count, axis]) * into[:, [axis]]
                outside[axis, :, part] = top.trace.T @ moved[-mesh.count :, axis]
        active = np.asarray(Surface.of_nodes(bond.points, disc).trace.sum(axis=0)).ravel()[nodes]
        area = np.asarray(trace.sum(axis=0)).ravel()
        return cls(trace, into, area, gap, active * -into[:, PALM], compliance, outside)

    def push(self, pressure: Array) -> Array:
        """Return the integrals of the outer surface's displacements under pressures."""
        return -np.tensordot(self.outside, pressure, 1).T


def find_bone_planes(form: PadForm, bond: Surface, triangles: NDArray[np.int64]) -> tuple[Any, Array, Array]:
    """Find trace, unit vectors into the bone, and integrals of the gap of the nodes that lie on it without a bond."""
    (x, z, _), nodes = bond.points.T, find_loose(form, bond.points)
    a, b, c = bond.points[triangles[:, :3]].transpose(1, 0, 2)
    normals = np.zeros_like(bond.points)
    np.add.at(normals, triangles, np.cross(c - a, b - a)[:, None])
    normals = (normals / np.linalg.norm(normals, axis=1)[:, None])[nodes]
    trace = bond.trace[:, nodes]
    return trace, -normals * np.sign(normals[:, [PALM]]), trace.T @ form.inner_gap_mm(x, z)


def find_loose(form: PadForm, points: Array) -> NDArray[np.int64]:
    """Find the nodes of the lower surface that lie on the bone without a bond."""
    return np.flatnonzero(np.isfinite(form.bone_mm(points[:, 0], points[:, 1])) & (not form.bonded))
