"""Designs of a sweep's points, refused where they break a rule, and the mesh kernel whose results
they share.

The bounds of the parameters are checked together with the axes, before any point. If only
electronic tables vary, the rules of the printed parts give the same result at every point as for
the base design, and so do the dimensions. Such a point takes microseconds instead of milliseconds.
If only tables of the parts vary, the rules of the electronics pass at every point.
"""

from __future__ import annotations

import os
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, load_manifold, to_canonical_mesh
from fingertip.design.design import Design
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters.declaration import parse_tables
from fingertip.design.refusal import describe_violations
from fingertip.design.search import ELECTRONIC_RULES, PART_RULES, RULES
from fingertip.fitting.fitting import fit_finger
from fingertip.foundation.errors import DesignError, raise_issues
from fingertip.models.solids import Solid
from fingertip.sweep.axes import Value
from fingertip.sweep.sweep_plan import SweepPlan
from fingertip.sweep.swept_parameters import is_of_parts, select_changes

if TYPE_CHECKING:
    from manifold3d import Manifold


class DesignBuilder:
    def __init__(self, plan: SweepPlan, finger: str = "") -> None:
        self._finger = finger
        base = plan.designs[finger]
        varied = select_changes(dict.fromkeys((axis.name for axis in plan.axes), 0), finger)
        self._only_electronics_vary = not any(map(is_of_parts, varied))
        self._rules = RULES
        if self._only_electronics_vary:
            self._rules = ELECTRONIC_RULES
        elif all(map(is_of_parts, varied)) and not plan.file.fit:
            self._rules = PART_RULES
        self._tables = base.model_dump()
        self._base = Design.model_construct(**dict(base))
        self._fits = plan.file.fit
        self._fitted: LruCache[Any, dict[str, Any]] = LruCache(MAX_FITS)

    def build(self, changes: Mapping[str, Value]) -> Design:
        """Build the design of a point. Raises DesignError."""
        own_changes: dict[str, Any] = {**select_changes(changes, self._finger)}
        if self._fits:
            part_values = {name: value for name, value in own_changes.items() if is_of_parts(name)}
            key = tuple(part_values.values())
            own_changes |= self._fitted.get(key, lambda: self._fit(part_values))

        if self._only_electronics_vary:
            design = self._base.with_values(own_changes)
        else:
            tables = parse_tables(DesignTables, apply_changes(self._tables, own_changes))
            design = Design.model_construct(None, **dict(tables))

        raise_issues(DesignError, describe_violations(design, self._rules))
        return design

    def _fit(self, part_values: Mapping[str, Value]) -> dict[str, Any]:
        """Find what moves with given values. Raises DesignError."""
        return {
            move.name: move.after
            for move in fit_finger(self._base.with_values(part_values), tuple(part_values)).moves
        }


def apply_changes(tables: dict[str, Any], changes: Mapping[str, Value]) -> dict[str, Any]:
    """Copy nested tables with dotted parameters changed.

    Unchanged tables are shared with the original.
    """
    changed = dict(tables)
    for name, value in changes.items():
        table, _, key = name.rpartition(".")
        changed |= {table: {**changed[table], key: value}} if table else {key: value}

    return changed


K = TypeVar("K")
V = TypeVar("V")


class LruCache(Generic[K, V]):
    """Mapping of bounded weight: it evicts the least recently used entries, except for the newest
    one.
    """

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
MAX_FITS = 4096


def restrict_kernel_to_one_thread() -> None:
    """Make the mesh kernel compute on one thread in this process.

    The sweep has a process on each processor already.

    On two threads a design takes 1.5 times the processor time. The kernel counts the processors at
    its first computation and offers no setting. This function has no effect after that computation,
    or on systems other than Linux.
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
    """Mesh evaluator that reuses solids and meshes between the designs of a sweep, within a limit
    of memory.

    While only the mold varies, the bone is not meshed twice.
    """

    def __init__(self, tolerance_mm: float) -> None:
        super().__init__(tolerance_mm)
        self._solids: LruCache[Solid, Manifold] = LruCache(MAX_TRIANGLES)
        self._meshes: LruCache[Solid, Mesh] = LruCache(MAX_MESHES)

    def manifold(self, solid: Solid) -> Manifold:
        return self._solids.get(
            solid, lambda: self._evaluate(solid), lambda manifold: manifold.num_tri()
        )

    def mesh(self, solid: Solid) -> Mesh:
        return self._meshes.get(solid, lambda: to_canonical_mesh(self.manifold(solid)))
