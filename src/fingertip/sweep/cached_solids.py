"""The mesh kernel with a memory: what was evaluated or measured before is not again, for as long as there is room.

A solid is known by a digest of its expression, and what is made of solids by a digest of how: an intersection, a gap,
a volume are looked up before anything is meshed. While only the mold varies, the bone is neither meshed nor measured
twice. Nothing here knows a part or a check; `cad` runs on these solids as it runs on manifold3d's.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from fingertip.cad.kernel.mesh import MeshEvaluator, Mesh
from fingertip.cad.solids import Solid
from fingertip.sweep.cache import Memory

if TYPE_CHECKING:
    from manifold3d import Manifold

MAX_TRIANGLES = 400_000
"""Of evaluated solids that are kept: some 100 MB in a worker."""
MAX_MESHES = 12
MAX_NAMES = 2_000
MAX_FACTS = 20_000
"""Numbers are kept far longer than the solids they were measured on."""


def digest(*parts: object) -> bytes:
    """A short name for something made of named things; equal only if all parts are."""
    hashed = hashlib.blake2b(digest_size=16)
    for part in parts:
        data = part if isinstance(part, bytes) else repr(part).encode()
        hashed.update(len(data).to_bytes(4, "big"))
        hashed.update(data)
    return hashed.digest()


def on_one_thread() -> None:
    """Let the mesh kernel compute on one thread in this process, for a sweep has a process on each processor already.

    On two threads a design takes half as much processor time again. The kernel counts processors when it first
    computes, and offers no other way to tell it. Without effect if it has computed before, or on systems other than
    Linux.
    """
    if not hasattr(os, "sched_setaffinity"):
        return
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        from manifold3d import Manifold

        cube = Manifold.cube((1.0, 1.0, 1.0))
        (cube - cube.translate((0.5, 0.5, 0.5))).status()
    finally:
        os.sched_setaffinity(0, allowed)


class CachedEvaluator(MeshEvaluator):
    """An evaluator whose solids, meshes and measures are remembered between designs."""

    def __init__(self, tolerance_mm: float) -> None:
        super().__init__(tolerance_mm)
        self.evaluated = 0
        """Solids that were evaluated, for tests."""
        self._solids: Memory[bytes, Manifold] = Memory(MAX_TRIANGLES)
        self._names: Memory[Solid, bytes] = Memory(MAX_NAMES)
        self._within = _Within(self)
        self._meshes: Memory[bytes, Mesh] = Memory(MAX_MESHES)
        self._facts: Memory[bytes, Any] = Memory(MAX_FACTS)

    def name(self, solid: Solid) -> bytes:
        """The digest of an expression; itself remembered, because parts are made of parts."""
        found = self._names.get(solid)
        if found is None:
            found = digest("solid", solid)
            self._names.put(solid, found)
        return found

    def manifold(self, solid: Solid) -> Any:
        """The solid, evaluated when something is asked of it that is not remembered."""
        key = self.name(solid)
        return CachedManifold(self, key, lambda: self._manifold(key, solid))

    def mesh(self, solid: Solid) -> Mesh:
        """The solid as a mesh on the grid, in canonical order."""
        key = self.name(solid)
        mesh = self._meshes.get(key)
        if mesh is None:
            from fingertip.cad.kernel.mesh import canonical

            mesh = canonical(self._manifold(key, solid))
            self._meshes.put(key, mesh)
        return mesh

    def fact(self, key: bytes, measure: Callable[[], Any]) -> Any:
        """What `measure` finds, or found before under this name."""
        found = self._facts.get(key)
        if found is None:
            found = (measure(),)
            self._facts.put(key, found)
        return found[0]

    def _manifold(self, key: bytes, solid: Solid) -> Manifold:
        found = self._solids.get(key)
        if found is None:
            self.evaluated += 1
            found = self._within.evaluate(solid)
            self._solids.put(key, found, found.num_tri())
        return found


class _Within(MeshEvaluator):
    """Evaluates one expression; the solids it is made of are manifold3d's own, from the memory."""

    def __init__(self, memory: CachedEvaluator) -> None:
        super().__init__(memory.tolerance_mm)
        self._memory = memory

    def manifold(self, solid: Solid) -> Manifold:
        """A solid within the expression."""
        return self._memory._manifold(self._memory.name(solid), solid)

    def evaluate(self, solid: Solid) -> Manifold:
        """The solid, from those it is made of."""
        return self._evaluate(solid)


class CachedManifold:
    """A solid by its name; stands for manifold3d's object, and makes it only where it must."""

    def __init__(self, memory: CachedEvaluator, key: bytes, make: Callable[[], Manifold]) -> None:
        self._memory, self._key, self._make = memory, key, make
        self._made: Manifold | None = None

    @property
    def made(self) -> Manifold:
        """manifold3d's own object, evaluated step by step: a tree of steps would be rounded by what it holds."""
        if self._made is None:
            self._made = self._make()
            self._made.status()
        return self._made

    def volume(self) -> float:
        """Volume [mm3]."""
        return float(self._fact("volume"))

    def genus(self) -> int:
        """Through holes."""
        return int(self._fact("genus"))

    def bounding_box(self) -> Any:
        """Least and greatest coordinates [mm]."""
        return self._fact("bounding_box")

    def min_gap(self, other: CachedManifold, max_mm: float) -> float:
        """Distance to another solid [mm], searched for up to `max_mm`."""
        return float(self._fact("min_gap", other, max_mm))

    def decompose(self) -> list[CachedManifold]:
        """Its bodies, whose volumes are known."""
        key = digest("volumes of bodies", self._key)
        volumes: list[float] = self._memory.fact(key, lambda: [body.volume() for body in self.made.decompose()])
        bodies = []
        for i, volume in enumerate(volumes):
            body = self._derived("body", i, make=partial(self._body, i))
            self._memory.fact(digest("volume", body._key), partial(float, volume))
            bodies.append(body)
        return bodies

    def _body(self, i: int) -> Manifold:
        return self.made.decompose()[i]

    def translate(self, by_mm: tuple[float, float, float]) -> CachedManifold:
        """Moved."""
        return self._derived("translate", by_mm, make=lambda: self.made.translate(by_mm))

    def rotate(self, degrees: tuple[float, float, float]) -> CachedManifold:
        """Turned about the axes, x first."""
        return self._derived("rotate", degrees, make=lambda: self.made.rotate(degrees))

    def scale(self, factors: tuple[float, float, float]) -> CachedManifold:
        """Scaled about the origin."""
        return self._derived("scale", factors, make=lambda: self.made.scale(factors))

    def trim_by_plane(self, normal: tuple[float, float, float], offset_mm: float) -> CachedManifold:
        """What lies beyond a plane."""
        return self._derived("trim", normal, offset_mm, make=lambda: self.made.trim_by_plane(normal, offset_mm))

    def __xor__(self, other: CachedManifold) -> CachedManifold:
        return self._derived("and", other._key, make=lambda: self.made ^ other.made)

    def __sub__(self, other: CachedManifold) -> CachedManifold:
        return self._derived("less", other._key, make=lambda: self.made - other.made)

    def __add__(self, other: CachedManifold) -> CachedManifold:
        return self._derived("or", other._key, make=lambda: self.made + other.made)

    def __getattr__(self, name: str) -> Any:
        """Anything else is asked of manifold3d's object, and not remembered."""
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments: self._ask(name, arguments)

    def _ask(self, name: str, arguments: tuple[Any, ...]) -> Any:
        return getattr(self.made, name)(*(a.made if isinstance(a, CachedManifold) else a for a in arguments))

    def _fact(self, name: str, *arguments: Any) -> Any:
        named = [a._key if isinstance(a, CachedManifold) else a for a in arguments]
        return self._memory.fact(digest(name, self._key, *named), lambda: self._ask(name, arguments))

    def _derived(self, how: str, *arguments: object, make: Callable[[], Manifold]) -> CachedManifold:
        return CachedManifold(self._memory, digest(how, self._key, *arguments), make)
