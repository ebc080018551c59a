"""Contact of the pad at large strain and with friction, by finite elements: how far small strains can be trusted.

The silicone is neo-Hookean, and the contact follows the deformed surface. Pressures are those of stiff springs between
the surface and the object; they leave an overlap of some thousandths of the depth. Friction is Coulomb's: a node sticks
with the same springs to the place of the object where it touched, or slides (T. A. Laursen, Computational Contact and
Impact Mechanics, 2002, chapter 5). Each force is found by Newton's method from the one before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.pad.fem_contact import PadModel
from fingertip.pad.fem_elastic import factorise
from fingertip.pad.pose import Pose
from fingertip.pad.touch import Touch

_SPRINGS = 1000.0
"""Stiffness of the springs of the contact over that of a layer of silicone in tension."""
_DRAG = 0.03
"""Stiffness of the springs along the surface over that of those across it; a stiffer one makes Newton's method jump."""
_MAX_STEPS, _CLOSE = 60, 1e-7
"""Largest number of Newton's steps for a force, and the error of the forces, relative to it, at which they end."""
_FULL_STEPS = 4
"""Steps for a force that are not shortened."""
_FIRST_N, _FIRST_NODES = 0.05, 6
"""Force that is computed first, and the nodes that the object overlaps at the start of the search."""
_GROWTH = 1.5
"""Growth of the force, from one that is computed to the next."""


@dataclass(frozen=True)
class LargeContact:
    """Contact of the pad under a force: share on the active area, and travel of the object."""

    force_n: float
    share: float
    depth_mm: float


def press_far(model: PadModel, pose: Pose, forces_n: Sequence[float], friction: float = 0.0) -> Iterator[LargeContact]:
    """Press with rising forces. Raises TraceError where no equilibrium is found."""
    touch, _ = Touch.of_pose(model.form, pose, model.fine_surface())
    contact = FarContact(model, touch, friction)
    force, moved = _FIRST_N, contact.first_touch()
    for target in forces_n:
        while True:
            force = min(force, target)
            moved, held = contact.balance(force, moved)
            if force == target:
                break
            force *= _GROWTH
        share = model.copies * float((model.step * held).sum()) / target
        yield LargeContact(target, share, float(moved[-1]))
        force *= _GROWTH


class FarContact:
    """Pad and object. What is unknown are the displacements of all nodes, and behind them the travel of the object."""

    def __init__(self, model: PadModel, touch: Touch, friction: float) -> None:
        from scipy.sparse import csr_array, eye_array, hstack, kron  # noqa: PLC0415

        self._model, self._touch, self._friction = model, touch, friction
        nodes = np.flatnonzero(model.area > 0.0)
        self._area, self._into = model.area[nodes], touch.approach
        spread = kron(model.top.trace.T.tocsr()[nodes], eye_array(3))
        below = csr_array((spread.shape[0], model.mesh.nodes.size - spread.shape[1]))
        travel = np.outer(self._area, self._into).reshape(-1, 1)
        self._join = hstack([below, spread, travel]).tocsr()
        self.still = (spread @ model.top.points.ravel()).reshape(-1, 3) / self._area[:, None]
        self._springs = _SPRINGS * model.form.young_mpa / model.form.over_sensor_mm
        self._anchors, self._free = self.still, np.append(np.flatnonzero(~model.body.is_fixed), model.mesh.nodes.size)

    def first_touch(self) -> Array:
        gap, _, closing = self._touch.gaps(self.still)
        unknown = np.zeros(self._join.shape[1])
        unknown[-1] = float(np.partition(gap / closing, _FIRST_NODES)[_FIRST_NODES])
        return unknown

    def balance(self, force_n: float, unknown: Array) -> tuple[Array, Array]:
        """Return the unknowns under a force, from those under another, and the forces of the skin on its nodes."""
        from scipy.sparse import block_array, block_diag  # noqa: PLC0415

        unknown, load, error = unknown.copy(), force_n / self._model.copies, math.inf
        for step in range(_MAX_STEPS):
            places = self.still + (self._join @ unknown).reshape(-1, 3) / self._area[:, None]
            tractions, slopes, slid = self.press(places)
            with np.errstate(invalid="ignore"):
                matrix, held = self._model.body.tangent(unknown[:-1].reshape(-1, 3))
            residual = self._join.T @ tractions.ravel()
            residual[:-1] += held.ravel()
            residual[-1] -= load
            before, error = error, float(np.abs(residual[self._free]).max()) / load
            if error < _CLOSE:
                self._anchors = places - slid
                return unknown, held
            if not error < math.inf:
                break  # an element is turned inside out
            whole = block_array([[matrix, None], [None, np.zeros((1, 1))]]).tocsr()
            whole += self._join.T @ block_diag(slopes / self._area[:, None, None], format="csr") @ self._join
            whole = whole[self._free][:, self._free]
            # A node that sticks and slides in turn would go on for ever: half a step breaks the cycle.
            pace = 0.5 if step > _FULL_STEPS and error > 0.5 * before else 1.0
            unknown[self._free] -= pace * factorise(whole).solve(residual[self._free])
        raise TraceError(Issue("force_n", f"{force_n:g} N: no equilibrium is found; use less force."))

    def press(self, places: Array) -> tuple[Array, Array, Array]:
        """Return tractions at places of the surface, their slopes by the place, and the slip that springs hold."""
        gap, into, _ = self._touch.gaps(places)
        pressure = self._springs * np.maximum(-gap, 0.0)
        drag, touches = _DRAG * self._springs * (self._friction > 0.0), (pressure > 0.0)[:, None, None]
        slip = places - self._anchors
        slip = (slip - (slip * into).sum(axis=1, keepdims=True) * into) * touches[:, 0]
        length, limit = np.linalg.norm(slip, axis=1), self._friction * pressure / max(drag, 1e-300)
        slides = (length > limit)[:, None, None]
        way = slip / np.maximum(length, 1e-300)[:, None]
        part = (np.minimum(limit, length) / np.maximum(length, 1e-300))[:, None]
        normal, ways = into[:, :, None] * into[:, None, :], way[:, :, None] * way[:, None, :]
        held = drag * np.where(slides, part[..., None], 1.0) * (np.eye(3) - normal - slides * ways)
        held += slides * self._friction * self._springs * way[:, :, None] * into[:, None, :]
        slip = part * slip
        return pressure[:, None] * into + drag * slip, touches * (self._springs * normal + held), slip
