"""Designs of a sweep's points, refused where they break a rule, and the mesh kernel whose results they share.

The bounds of the parameters are checked together with the axes, before any point. If only electronic tables vary, the
rules of the printed parts give the same result at every point as for the base design, and so do the dimensions. Such a
point takes microseconds instead of milliseconds.
"""

from __future__ import annotations

import hashlib
import os
from collections import OrderedDict
from collections.abc import Callable, Mapping
from functools import partial, partialmethod
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, load_manifold, to_canonical_mesh
from fingertip.design.geometry.solids import Solid
from fingertip.design.model import Design
from fingertip.design.parameters import ELECTRONIC_TABLES
from fingertip.design.refusal import describe_violations
from fingertip.design.search import ELECTRONIC_RULES
from fingertip.foundation.errors import DesignError
from fingertip.sweep.axes import Value, select_changes
from fingertip.sweep.plan import SweepPlan

if TYPE_CHECKING:
    from manifold3d import Manifold


class DesignBuilder:
    def __init__(self, plan: SweepPlan, finger: str = "") -> None:
        self._finger, base = finger, plan.designs[finger]
        varied = select_changes(dict.fromkeys((axis.name for axis in plan.axes), 0), finger)
        self._only_electronics_vary = all(name.partition(".")[0] in ELECTRONIC_TABLES for name in varied)
        self._tables = base.model_dump()
        self._base = Design.model_construct(**dict(base))

    def build(self, changes: Mapping[str, Value]) -> Design:
        """Build the design of a point. Raises DesignError."""
        own_changes = select_changes(changes, self._finger)
        if not self._only_electronics_vary:
            return Design.without_remedies(**apply_changes(self._tables, own_changes))
        design = self._base.with_values(own_changes)
        if issues := list(describe_violations(design, ELECTRONIC_RULES)):
            raise DesignError(issues)
        return design


def apply_changes(tables: dict[str, Any], changes: Mapping[str, Value]) -> dict[str, Any]:
    """Copy nested tables with dotted parameters changed; unchanged tables are shared with the original."""
    changed = dict(tables)
    for name, value in changes.items():
        table, _, key = name.rpartition(".")
        changed |= {table: {**changed[table], key: value}} if table else {key: value}
    return changed


K = TypeVar("K")
V = TypeVar("V")


class LruCache(Generic[K, V]):
    """Mapping of bounded weight: it evicts the least recently used entries, except for the newest one."""

    def __init__(self, max_weight: float) -> None:
        self.max_weight = max_weight
        self.weight = 0.0
        self._entries: OrderedDict[K, tuple[V, float]] = OrderedDict()

    def get(self, key: K, make: Callable[[], V], weigh: Callable[[V], float] = lambda _: 1.0) -> V:
        if key in self._entries:
            self._entries.move_to_end(key)
            return self._entries[key][0]
        value = make()
        self._entries[key] = value, weigh(value)
        self.weight += self._entries[key][1]
        while self.weight > self.max_weight and len(self._entries) > 1:
            self.weight -= self._entries.popitem(last=False)[1][1]
        return value

    def __len__(self) -> int:
        return len(self._entries)


MAX_TRIANGLES = 400_000
"""Limit of the triangles of all cached solids: about 100 MB per worker."""
MAX_MESHES = 12
MAX_KEYS = 2_000
"""Number of cached digests of expressions."""
MAX_MEASUREMENTS = 20_000
"""Number of cached measurements. They are small, and outlive the solids that they were taken from."""


def compute_digest(*parts: object) -> bytes:
    """Compute a digest of several parts; two digests are equal only if all parts are."""
    digest = hashlib.blake2b(digest_size=16)
    for part in parts:
        data = part if isinstance(part, bytes) else repr(part).encode()
        digest.update(len(data).to_bytes(4, "big"))
        digest.update(data)
    return digest.digest()


def restrict_kernel_to_one_thread() -> None:
    """Make the mesh kernel compute on one thread in this process; the sweep has a process on each processor already.

    On two threads a design takes 1.5 times the processor time. The kernel counts the processors at its first
    computation and offers no setting. This function has no effect after that computation, or on systems other than
    Linux.
    """
    if not hasattr(os, "sched_setaffinity"):
        return
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        load_manifold()
        from manifold3d import Manifold  # noqa: PLC0415

        cube = Manifold.cube((1.0, 1.0, 1.0))
        (cube - cube.translate((0.5, 0.5, 0.5))).status()
    finally:
        os.sched_setaffinity(0, allowed)


class CachedEvaluator(MeshEvaluator):
    """Mesh evaluator that reuses solids, meshes and measurements between the designs of a sweep.

    A solid is identified by a digest of its expression. What is derived from solids (an intersection, a gap, a volume)
    is identified by a digest of the operation and its operands, and looked up before anything is meshed: while only the
    mold varies, the bone is neither meshed nor measured twice. `cad` uses these solids exactly as those of manifold3d.
    """

    def __init__(self, tolerance_mm: float) -> None:
        super().__init__(tolerance_mm)
        self.evaluated = 0
        """Number of solids that were evaluated so far, for tests."""
        self._solids: LruCache[bytes, Manifold] = LruCache(MAX_TRIANGLES)
        self._keys: LruCache[Solid, bytes] = LruCache(MAX_KEYS)
        self._expressions = _ExpressionEvaluator(self)
        self._meshes: LruCache[bytes, Mesh] = LruCache(MAX_MESHES)
        self.measurements: LruCache[bytes, Any] = LruCache(MAX_MEASUREMENTS)

    def compute_key(self, solid: Solid) -> bytes:
        """Compute the digest of an expression. It is cached too, because parts are made of parts."""
        return self._keys.get(solid, lambda: compute_digest("solid", solid))

    def manifold(self, solid: Solid) -> Any:
        """Return the solid; it is evaluated only when a measurement that is not cached needs it."""
        key = self.compute_key(solid)
        return CachedManifold(self, key, lambda: self.evaluate_manifold(key, solid))

    def mesh(self, solid: Solid) -> Mesh:
        key = self.compute_key(solid)
        return self._meshes.get(key, lambda: to_canonical_mesh(self.evaluate_manifold(key, solid)))

    def evaluate_manifold(self, key: bytes, solid: Solid) -> Manifold:
        """Return manifold3d's own object for a solid, from the cache if possible."""

        def evaluate() -> Manifold:
            self.evaluated += 1
            return self._expressions.evaluate(solid)

        return self._solids.get(key, evaluate, lambda manifold: manifold.num_tri())


class _ExpressionEvaluator(MeshEvaluator):
    """Evaluator of one expression, whose operands come from the cache as manifold3d's own objects."""

    def __init__(self, cached: CachedEvaluator) -> None:
        super().__init__(cached.tolerance_mm)
        self._cached = cached

    def manifold(self, solid: Solid) -> Manifold:
        return self._cached.evaluate_manifold(self._cached.compute_key(solid), solid)

    def evaluate(self, solid: Solid) -> Manifold:
        return self._evaluate(solid)


_MEASURED = frozenset({"volume", "genus", "bounding_box", "min_gap"})
"""Methods of manifold3d's object that give numbers."""
_DERIVED = frozenset({"translate", "rotate", "scale", "trim_by_plane"})
"""Methods that give another solid, as the operators do."""


class CachedManifold:
    """Solid known by its key; it stands for manifold3d's object, which is evaluated only where it must be."""

    def __init__(self, evaluator: CachedEvaluator, key: bytes, evaluate: Callable[[], Manifold]) -> None:
        self._evaluator, self._key, self._evaluate = evaluator, key, evaluate
        self._manifold: Manifold | None = None

    @property
    def manifold(self) -> Manifold:
        """manifold3d's own object. Each step is evaluated at once: rounding would depend on the tree of steps."""
        if self._manifold is None:
            self._manifold = self._evaluate()
            self._manifold.status()
        return self._manifold

    def decompose(self) -> list[CachedManifold]:
        """Split the solid into its connected bodies. Their volumes are cached."""
        key = self._compute_key("volumes of bodies")
        volumes: list[float] = self._evaluator.measurements.get(
            key, lambda: [b.volume() for b in self.manifold.decompose()]
        )
        bodies = []
        for i, volume in enumerate(volumes):
            body = CachedManifold(self._evaluator, self._compute_key("body", i), partial(self._evaluate_body, i))
            self._evaluator.measurements.get(body._compute_key("volume"), partial(float, volume))
            bodies.append(body)
        return bodies

    def _evaluate_body(self, i: int) -> Manifold:
        return self.manifold.decompose()[i]

    def __getattr__(self, name: str) -> Any:
        """Forward any other method to manifold3d's object; its result is cached if `_DERIVED` or `_MEASURED`."""
        if name.startswith("__"):
            raise AttributeError(name)
        return partial(self._derive if name in _DERIVED else self._measure if name in _MEASURED else self._call, name)

    def _call(self, name: str, *arguments: Any) -> Any:
        own = (a.manifold if isinstance(a, CachedManifold) else a for a in arguments)
        return getattr(self.manifold, name)(*own)

    def _compute_key(self, name: str, *arguments: Any) -> bytes:
        return compute_digest(name, self._key, *(a._key if isinstance(a, CachedManifold) else a for a in arguments))

    def _measure(self, name: str, *arguments: Any) -> Any:
        key = self._compute_key(name, *arguments)
        return self._evaluator.measurements.get(key, lambda: self._call(name, *arguments))

    def _derive(self, name: str, *arguments: Any) -> CachedManifold:
        key = self._compute_key(name, *arguments)
        return CachedManifold(self._evaluator, key, lambda: self._call(name, *arguments))

    __xor__ = partialmethod(_derive, "__xor__")
    __sub__ = partialmethod(_derive, "__sub__")
    __add__ = partialmethod(_derive, "__add__")
