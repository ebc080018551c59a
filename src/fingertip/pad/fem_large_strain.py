"""Contact of the pad at large strain and with friction, by finite elements: how far small strains
can be trusted.

The silicone is neo-Hookean, and the contact follows the deformed surface. Pressures are those of
stiff springs between the surface and the object; they leave an overlap of some thousandths of the
depth. Friction is Coulomb's: a node sticks with the same springs to the place of the object where
it touched, or slides (T. A. Laursen, Computational Contact and Impact Mechanics, 2002, chapter 5).
Each force is found by Newton's method from the one before. The inside of a skin that lies on the
bone meets it in the same way, each node the plane of the bone below it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.pad.fem_contact import PadModel
from fingertip.pad.fem_elastic import factorise
from fingertip.pad.touch import Pose, Touch

_SPRINGS = 1000.0
"""Stiffness of the springs of the contact over that of a layer of silicone in tension."""
_DRAG = 0.03
"""Stiffness of the springs along the surface over that of those across it.
A stiffer one makes Newton's method jump.
"""
_MAX_STEPS = 60
_CLOSE = 1e-7
"""Largest number of Newton's steps for a force, and the error of the forces, relative to it, at
which they end.
"""
_FULL_STEPS = 4
"""Steps for a force that are not shortened."""
_PACES = (1.0, 0.5, 0.25, 0.125, 0.0625)
"""Parts of a later step that are tried until it lessens the error: nodes that stick and slide in
turn overshoot.
"""
_BULGES = (0.1, 0.25, 0.5, 1.0)
"""Parts of a bump and its gap that are computed one after the other."""
_AWAY_MM = 10.0
"""Distance of the object while nothing touches."""
_FIRST_N = 0.05
_FIRST_NODES = 6
"""Force that is computed first, and the nodes that the object overlaps at the start of the search.
"""
_GROWTH = 1.5
"""Growth of the force, from one that is computed to the next."""

Gaps = Callable[[Array], tuple[Array, Array, Any]]
"""Gaps at places, unit vectors into what is met, and what travel closes of them."""


@dataclass(frozen=True)
class LargeStrainContact:
    """Contact of the pad under a force: share on the active area, and travel of the object."""

    force_n: float
    share: float
    depth_mm: float


def press_large_strain(
    model: PadModel, pose: Pose, forces_n: Sequence[float], friction: float = 0.0
) -> Iterator[LargeStrainContact]:
    """Press with rising forces, with friction on the object and inside.

    Raises TraceError where nothing balances.

    The share leaves out what a bump inside presses on the sensor at rest.
    """
    touch, _ = Touch.of_pose(model.form, pose, model.fine_surface())
    contact = LargeStrainSolver(model, touch, friction)
    rest_n, first_mm, moved = contact.first_touch()
    force = _FIRST_N

    for target in forces_n:
        while True:
            force = min(force, target)
            moved, forces = contact.balance(force, moved)
            if force == target:
                break

            force *= _GROWTH

        share = (model.copies * float((model.step * forces).sum()) - rest_n) / target
        yield LargeStrainContact(target, share, float(moved[-1]) - first_mm)
        force *= _GROWTH


class LargeStrainSolver:
    """Pad and object.

    What is unknown are the displacements of all nodes, and behind them the travel of the object.
    """

    def __init__(self, model: PadModel, touch: Touch, friction: float) -> None:
        self._model = model
        self._friction = friction
        size = model.mesh.nodes.size
        self._bulge = 1.0
        stiff = _SPRINGS * model.form.young_mpa / model.form.over_sensor_mm
        nodes = np.flatnonzero(model.area > 0.0)
        outer = model.top.trace.T.tocsr()[nodes], model.top.points
        self.face = Face(
            *outer, model.area[nodes], size, touch.approach, touch.gaps, friction, stiff
        )
        self._faces = [self.face]
        self._free = np.append(np.flatnonzero(~model.body.is_fixed), size)

        if not model.form.bonded:
            trace, into, gap = model.find_bone_planes()
            area = np.asarray(trace.sum(axis=0)).ravel()

            def stand_off(places: Array) -> tuple[Array, Array, None]:
                return self._bulge * gap - ((places - inner.still) * into).sum(axis=1), into, None

            inner = Face(
                trace=trace.T.tocsr(),
                points=model.bond.points,
                area=area,
                size=size,
                approach=None,
                gaps=stand_off,
                friction=friction,
                springs=stiff,
            )
            self._faces.append(inner)

    def first_touch(self) -> tuple[float, float, Array]:
        """Return the force on the sensor at rest, how much nearer a bump brings the touch, and the
        unknowns there.
        """
        rest_n = 0.0
        face = self.face
        unknown = np.zeros(self._model.mesh.nodes.size + 1)

        if self._model.form.bump_height_mm:
            rest_n, unknown = self._model.at_rest or self._rest(unknown)
            unknown = np.append(unknown[:-1], 0.0)
            for contact_face in self._faces:
                contact_face.anchors = contact_face.place(unknown)

        gap, _, closing = face.gaps(face.place(unknown))
        travel = np.partition(gap / closing, _FIRST_NODES)
        unknown[-1] = float(travel[_FIRST_NODES])
        return rest_n, float(travel[0]) if rest_n else 0.0, unknown

    def _rest(self, unknown: Array) -> tuple[float, Array]:
        """Find the same while nothing touches, once for all poses."""
        unknown[-1] = -_AWAY_MM
        for face in self._faces:
            face.friction = 0.0  # the skin slides to where it is at rest

        for self._bulge in _BULGES:
            unknown, forces = self.balance(0.0, unknown)

        for face in self._faces:
            face.friction = self._friction

        self._model.at_rest = self._model.copies * float((self._model.step * forces).sum()), unknown
        return self._model.at_rest

    def balance(self, force_n: float, unknown: Array) -> tuple[Array, Array]:
        """Return the unknowns under a force, from those under another, and the forces of the skin
        on its nodes.
        """
        load = force_n / self._model.copies
        free = self._free if force_n else self._free[:-1]
        residual, matrix, forces = self._assemble(unknown, load)

        for step in range(_MAX_STEPS):
            if float(np.abs(residual[free]).max()) < _CLOSE * (load or _FIRST_N):
                for face in self._faces:
                    face.settle()

                return unknown, forces

            before = float(np.linalg.norm(residual[free]))
            start = unknown
            way = factorise(matrix[free][:, free]).solve(residual[free])

            for pace in _PACES:
                unknown = start.copy()
                unknown[free] -= pace * way
                residual, matrix, forces = self._assemble(unknown, load)
                # NaN: an element is turned inside out.
                error = float(np.linalg.norm(residual[free]))
                if error < (math.inf if step < _FULL_STEPS else (1.0 - 0.1 * pace) * before):
                    break

            if not error < math.inf:
                break

        raise TraceError(
            Issue("force_n", f"{force_n:g} N: no equilibrium is found; use less force.")
        )

    def _assemble(self, unknown: Array, load: float) -> tuple[Array, Any, Array]:
        """Return the unbalanced forces, their slopes, and the forces of the skin on its nodes."""
        from scipy.sparse import block_array  # noqa: PLC0415

        with np.errstate(invalid="ignore"):
            matrix, skin_forces = self._model.body.tangent(unknown[:-1].reshape(-1, 3))

        residual = np.append(skin_forces.ravel(), -load)
        whole = block_array([[matrix, None], [None, np.zeros((1, 1))]]).tocsr()
        for face in self._faces:
            forces, stiffness = face.meet(unknown)
            residual += forces
            whole += stiffness

        return residual, whole, skin_forces


class Face:
    """Nodes of a surface of the skin that may meet something rigid: the object, or the bone."""

    def __init__(
        self,
        trace: Any,
        points: Array,
        area: Array,
        size: int,
        approach: Array | None,
        gaps: Gaps,
        friction: float,
        springs: float,
    ) -> None:
        """Join the nodes to the unknowns.

        `approach` is the way of the object, and None for the bone.
        """
        from scipy.sparse import csr_array, eye_array, hstack, kron  # noqa: PLC0415

        spread = kron(trace, eye_array(3))
        rest = csr_array((spread.shape[0], size - spread.shape[1]))
        travel = np.outer(area, np.zeros(3) if approach is None else approach).reshape(-1, 1)
        self._join = hstack(
            [*((spread, rest) if approach is None else (rest, spread)), travel]
        ).tocsr()
        self.still = (spread @ points.ravel()).reshape(-1, 3) / area[:, None]
        self._area = area
        self.gaps = gaps
        self.friction = friction
        self._springs = springs
        self.anchors = self._next = self.still

    def place(self, unknown: Array) -> Array:
        return np.asarray(self.still + (self._join @ unknown).reshape(-1, 3) / self._area[:, None])

    def meet(self, unknown: Array) -> tuple[Array, Any]:
        """Return the forces on the unknowns and their slopes."""
        from scipy.sparse import block_diag  # noqa: PLC0415

        places = self.place(unknown)
        tractions, slopes, slid = self.press(places)
        self._next = places - slid

        return self._join.T @ tractions.ravel(), self._join.T @ block_diag(
            slopes / self._area[:, None, None], format="csr"
        ) @ self._join

    def settle(self) -> None:
        """Let the springs along the surface begin where the nodes are now."""
        self.anchors = self._next

    def press(self, places: Array) -> tuple[Array, Array, Array]:
        """Return tractions at places of the surface, their slopes by the place, and the slip that
        springs hold.
        """
        gap, into, _ = self.gaps(places)
        pressure = self._springs * np.maximum(-gap, 0.0)
        drag = _DRAG * self._springs * (self.friction > 0.0)
        touches = (gap <= 0.0)[:, None, None]
        slip = places - self.anchors
        slip = (slip - (slip * into).sum(axis=1, keepdims=True) * into) * touches[:, 0]
        length = np.linalg.norm(slip, axis=1)
        limit = self.friction * pressure / max(drag, 1e-300)
        slides = (length > limit)[:, None, None]
        way = slip / np.maximum(length, 1e-300)[:, None]
        part = (np.minimum(limit, length) / np.maximum(length, 1e-300))[:, None]
        normal = into[:, :, None] * into[:, None, :]
        ways = way[:, :, None] * way[:, None, :]
        tangent = (
            drag * np.where(slides, part[..., None], 1.0) * (np.eye(3) - normal - slides * ways)
        )
        tangent += slides * self.friction * self._springs * way[:, :, None] * into[:, None, :]
        slip = part * slip

        return (
            pressure[:, None] * into + drag * slip,
            touches * (self._springs * normal + tangent),
            slip,
        )
