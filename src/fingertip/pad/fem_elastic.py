"""Linear elasticity of a body of wedges: stiffness, displacements, forces of its support, strains.

Displacements are quadratic in plan and in height. Each wedge has a linear pressure of its own,
which is eliminated. So Poisson's ratio may approach 0.5 without locking, and the matrix stays
symmetric and positive definite (D. Boffi, F. Brezzi and M. Fortin, Mixed Finite Element Methods and
Applications, 2013, chapter 8). No proof of stability is known to us for this wedge; tests look for
locking. A pressure constant in plan converges several times slower in force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.pad.fem_mesh import WedgeMesh

_CHUNK = 400
"""Number of elements whose matrices are in memory at a time."""
_A = 0.445948490915965
_B = 0.091576213509771
_POINTS = np.array(
    [[_A, _A], [1 - 2 * _A, _A], [_A, 1 - 2 * _A], [_B, _B], [1 - 2 * _B, _B], [_B, 1 - 2 * _B]]
)
_WEIGHTS = np.repeat([0.111690794839005, 0.054975871827661], 3)
"""Quadrature of the triangle, of degree 4 (D. A. Dunavant, Int. J. Numer. Meth. Eng. 21 (1985)
1129).
"""
_LINE, _LINE_WEIGHTS = np.polynomial.legendre.leggauss(3)
_NODES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
_QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""Parts of a triangle between its corners and the middles of its edges, by their nodes."""


def triangle_shapes(points: Array) -> tuple[Array, Array]:
    """Shape functions of the quadratic triangle at local points, and their derivatives by both
    local axes.
    """
    r, s = points.T
    t = 1 - r - s
    zero = np.zeros_like(r)
    shapes = np.stack(
        [t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * t * r, 4 * r * s, 4 * s * t], axis=1
    )
    by_r = np.stack([1 - 4 * t, 4 * r - 1, zero, 4 * (t - r), 4 * s, -4 * s], axis=1)
    by_s = np.stack([1 - 4 * t, zero, 4 * s - 1, -4 * r, 4 * r, 4 * (t - s)], axis=1)

    return shapes, np.stack([by_r, by_s], axis=2)


def _wedge_derivatives(points: Array, heights: Array) -> Array:
    """Local derivatives of a wedge's shape functions at all pairs of points and heights, of shape
    (pairs, 18, 3).
    """
    plan, by_plan = triangle_shapes(points)
    t = heights
    up = np.stack([0.5 * t * (t - 1), 1 - t * t, 0.5 * t * (t + 1)], axis=1)
    by_up = np.stack([t - 0.5, -2 * t, t + 0.5], axis=1)
    along = np.einsum("pak,ql->pqlak", by_plan, up)
    upwards = np.einsum("pa,ql->pqla", plan, by_up)[..., None]

    return np.concatenate([along, upwards], axis=4).reshape(len(points) * len(t), 18, 3)


_INSIDE = _wedge_derivatives(_POINTS, _LINE)
_MIDDLE = _wedge_derivatives(np.full((1, 2), 1 / 3), np.zeros(1))
_INSIDE_WEIGHTS = np.outer(_WEIGHTS, _LINE_WEIGHTS).ravel()
_PRESSURES = np.stack([np.ones(18), np.tile(_LINE, 6), *np.repeat(_POINTS - 1 / 3, 3, axis=0).T])
"""Pressures of an element at the points of its quadrature."""


def _gradients(nodes: Array, local: Array) -> tuple[Array, Array]:
    """Gradients of the shape functions at points of elements with these nodes, and the determinants
    of their maps.
    """
    jacobian = np.einsum("eai,qak->eqik", nodes, local, optimize=True)
    return local @ np.linalg.inv(jacobian), np.linalg.det(jacobian)


def stiffness(
    mesh: WedgeMesh, young_mpa: float | Array, poisson: float | Array, moved: Array | None = None
) -> tuple[Any, Array]:
    """Assemble the stiffness [N/mm], a sparse matrix with three rows for each node, and the forces
    that hold it [N].

    Modulus and Poisson's ratio are those of all wedges, or of each. The material is neo-Hookean,
    with the energy mu/2 (J^(-2/3) tr b - 3) and that of the pressures, which follow the mean of J -
    1; the stiffness is its tangent after the displacements `moved` (J. Bonet and R. D. Wood,
    Nonlinear Continuum Mechanics, 2008, chapters 6 to 9).
    """
    from scipy.sparse import coo_array, csr_array  # noqa: PLC0415

    young, ratio = (
        np.broadcast_to(value, len(mesh.wedges))[:, None, None] for value in (young_mpa, poisson)
    )
    shears = 0.5 * young / (1 + ratio)
    bulks = young / (3 * (1 - 2 * ratio))
    size = mesh.nodes.size
    unit = np.eye(3)
    total = csr_array((size, size))
    forces = np.zeros(size)
    moved = np.zeros_like(mesh.nodes) if moved is None else moved

    for start in range(0, len(mesh.wedges), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        part = mesh.wedges[chunk]
        shear = shears[chunk]
        bulk = bulks[chunk]
        gradient, determinant = _gradients(mesh.nodes[part], _INSIDE)
        volume = determinant * _INSIDE_WEIGHTS
        mass = np.einsum("mq,eq,nq->emn", _PRESSURES, volume, _PRESSURES)
        stretch = unit + np.einsum("eai,eqaj->eqij", moved[part], gradient, optimize=True)
        j = np.linalg.det(stretch)
        gradient = gradient @ np.linalg.inv(stretch)
        # Kirchhoff stress mu J^(-2/3) b; its deviator is the stress of the shape change, and draws
        # at the nodes.
        stress = (
            shear[..., None]
            * j[..., None, None] ** (-2 / 3)
            * (stretch @ stretch.transpose(0, 1, 3, 2))
        )
        mean = np.einsum("eqii->eq", stress) / 3
        drawn = gradient @ (stress - mean[..., None, None] * unit)
        flat = gradient.reshape(len(part), 18, 54)
        swell = np.einsum("mq,eq->em", _PRESSURES, volume * (j - 1))[..., None]
        divergence = np.einsum("mq,eq,eqd->emd", _PRESSURES, volume * j, flat, optimize=True)
        modes = bulk * np.linalg.solve(mass, np.concatenate([divergence, swell], axis=2))
        pressed = volume * j * (modes[:, :, -1] @ _PRESSURES)
        drawn = drawn.reshape(len(part), 18, 54)
        held = flat.transpose(0, 2, 1)
        means, presses, draws = (
            (held @ (weight[..., None] * other)).reshape(-1, 18, 3, 18, 3)
            for weight, other in ((volume * mean, flat), (pressed, flat), (volume, drawn))
        )
        alike = np.einsum("eakbk->eab", means + draws)[:, :, None, :, None] * unit[:, None, :]
        draws = draws + draws.transpose(0, 3, 4, 1, 2)
        matrix = (
            alike + presses - 2 / 3 * (means + draws) + (means - presses).transpose(0, 1, 4, 3, 2)
        )
        matrix = matrix.reshape(-1, 54, 54) + divergence.transpose(0, 2, 1) @ modes[:, :, :-1]
        rows = (3 * part[:, :, None] + np.arange(3)).reshape(-1, 54)
        where = (np.repeat(rows, 54, axis=1).ravel(), np.tile(rows, (1, 54)).ravel())
        total = total + coo_array((matrix.ravel(), where), shape=(size, size)).tocsr()
        np.add.at(forces, rows, (volume[..., None] * drawn + pressed[..., None] * flat).sum(axis=1))

    return total, forces.reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class Surface:
    """Nodes of an upper or lower surface, which may be curved, with integrals over its triangles
    [mm^2].

    The mass is that of products of the quadratic shape functions. The trace is that of these with
    pressures, which are linear between the nodes of each quarter of a triangle.
    """

    points: Array
    mass: Any
    trace: Any

    @classmethod
    def of_nodes(cls, points: Array, triangles: NDArray[np.int64]) -> Surface:
        from scipy.sparse import coo_array, csc_array  # noqa: PLC0415

        size = (len(points), len(points))
        mass = csc_array(size)
        trace = csc_array(size)
        linear = np.column_stack([1 - _POINTS.sum(axis=1), _POINTS])

        for quarter in _QUARTERS:
            shapes, local = triangle_shapes(linear @ _NODES[quarter])
            along = np.einsum("eai,qak->eqki", points[triangles], local, optimize=True)
            area = (
                0.25 * _WEIGHTS * np.linalg.norm(np.cross(along[:, :, 0], along[:, :, 1]), axis=2)
            )

            for other, columns in ((shapes, triangles), (linear, triangles[:, quarter])):
                values = np.einsum("qa,eq,qb->eab", shapes, area, other, optimize=True)
                i, j = np.broadcast_arrays(triangles[:, :, None], columns[:, None, :])
                added = coo_array((values.ravel(), (i.ravel(), j.ravel())), shape=size).tocsc()
                mass, trace = (mass + added, trace) if other is shapes else (mass, trace + added)

        return cls(points, mass, trace)

    def project(self, integrals: Array) -> Array:
        """Return the values at the nodes of a quadratic function, from its integrals with the shape
        functions.
        """
        from scipy.sparse.linalg import spsolve  # noqa: PLC0415

        return np.asarray(spsolve(self.mass, integrals))


def factorise(matrix: Any) -> Any:
    """Factorise a sparse matrix whose pattern is symmetric."""
    from scipy.sparse.linalg import splu  # noqa: PLC0415

    return splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


class Body:
    """Elastic body, some of whose displacements are fixed, with its factorised stiffness."""

    def __init__(
        self,
        mesh: WedgeMesh,
        young_mpa: float | Array,
        poisson: float | Array,
        is_fixed: NDArray[np.bool_],
    ) -> None:
        """Factorise the stiffness. `is_fixed` has a flag for each axis of each node."""
        self._mesh = mesh
        self._fixed = np.flatnonzero(is_fixed)
        self._free = np.flatnonzero(~is_fixed)
        self.young_mpa = young_mpa
        self.poisson = poisson
        self.is_fixed = is_fixed
        matrix, _ = self.tangent()
        self._coupling = matrix[self._fixed][:, self._free]
        self._factors = factorise(matrix[self._free][:, self._free])

    def tangent(self, moved: Array | None = None) -> tuple[Any, Array]:
        """Return stiffness and forces after displacements, at any strain."""
        return stiffness(self._mesh, self.young_mpa, self.poisson, moved)

    def move(self, loads: Array, given: Array | None = None) -> Array:
        """Displacements under loads of shape (nodes, 3, cases).

        Those that are fixed are `given`, or 0.
        """
        flat = loads.reshape(self._mesh.nodes.size, -1)
        out = np.zeros_like(flat)
        right = flat[self._free]

        if given is not None:
            out[self._fixed] = given.reshape(flat.shape)[self._fixed]
            right = right - self._coupling.T @ out[self._fixed]

        out[self._free] = self._factors.solve(np.ascontiguousarray(right))
        return out.reshape(loads.shape)

    def support(self, displacements: Array) -> Array:
        """Return the forces of the support on the nodes [N]; displacements are 0 at fixed ones."""
        out = np.zeros(displacements.size)
        out[self._fixed] = self._coupling @ displacements.ravel()[self._free]
        return out.reshape(-1, 3)

    def strains(self, displacements: Array) -> Array:
        """Principal strains in the middle of each element, in rising order."""
        wedges = self._mesh.wedges
        gradient = _gradients(self._mesh.nodes[wedges], _MIDDLE)[0][:, 0]
        slope = displacements[wedges].transpose(0, 2, 1) @ gradient

        return np.asarray(np.linalg.eigvalsh(0.5 * (slope + slope.transpose(0, 2, 1))))
