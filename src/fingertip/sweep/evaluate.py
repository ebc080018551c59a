"""Rows of many points: what a worker does with its part of a sweep.

A row depends on its point alone. What a worker remembers of the points before only saves time: stages whose tables
have not changed, and solids that were meshed before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from fingertip.design.model import Design
from fingertip.errors import Fault, FingertipError
from fingertip.sweep.axes import Value
from fingertip.sweep.memory import Memory
from fingertip.sweep.outputs import Stage
from fingertip.sweep.part import Outcome, Part, each_limited
from fingertip.sweep.plan import Plan
from fingertip.sweep.stages import COMPUTE, Asked

if TYPE_CHECKING:
    from fingertip.cad.mesh import Evaluator

REMEMBERED = 256
"""Results of stages that are kept: a few numbers each."""


class Bench:
    """One worker's place: the plan, and what is remembered between its points."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._figures: Memory[Any, dict[str, float]] = Memory(REMEMBERED)
        self._evaluator: Evaluator | None = None
        self._design = plan.design.model_dump()
        self._scene = plan.scene.model_dump() if plan.scene else None

    def outcomes(self, part: Part) -> Iterator[Outcome]:
        """The rows of a part of the sweep."""
        yield from each_limited(part, self.plan.file.time_limit_s, len(self.plan.outputs), self.outcome)

    def outcome(self, point: int, changes: Mapping[str, Value]) -> Outcome:
        """The row of a point, whatever becomes of it: an exception is a row too."""
        nothing = (math.nan,) * len(self.plan.outputs)
        try:
            design, scene = self._point(changes)
        except FingertipError as error:
            first, *others = error.faults
            more = f" (and {len(others)} more: {', '.join(dict.fromkeys(f.field for f in others))})" if others else ""
            return point, "refused", first.field, first.sentence + more, nothing
        asked = Asked(design, scene, self.plan.file, self.evaluator)
        try:
            figures: dict[str, float] = {}
            for stage in self.plan.stages:
                figures |= self._stage(stage, asked)
        except FingertipError as error:
            return point, "failed", "", str(error), nothing
        except Exception as error:
            return point, "failed", "", f"{type(error).__name__}: {error}", nothing
        return point, "ok", "", "", tuple(settled(figures[name]) for name in self.plan.outputs)

    def evaluator(self) -> Evaluator:
        """The mesh kernel, shared by all points."""
        if self._evaluator is None:
            from fingertip.cad.mesh import Evaluator

            self._evaluator = Evaluator(self.plan.file.tolerance_mm)
        return self._evaluator

    def _point(self, changes: Mapping[str, Value]) -> tuple[Design, Any]:
        design = _changed(self._design, {n: v for n, v in changes.items() if not n.startswith("scene.")})
        scene = None
        faults: list[Fault] = []
        made = None
        try:
            made = Design(**design)
        except FingertipError as error:
            faults += error.faults
        if self._scene is not None:
            from fingertip.sim.scene_file import SceneFile

            of_scene = {n.removeprefix("scene."): v for n, v in changes.items() if n.startswith("scene.")}
            try:
                scene = SceneFile(**_changed(self._scene, of_scene))
            except FingertipError as error:
                faults += (Fault(f"scene.{fault.field}", fault.sentence) for fault in error.faults)
        if faults or made is None:
            raise FingertipError(faults)
        return made, scene

    def _stage(self, stage: Stage, asked: Asked) -> dict[str, float]:
        key = (stage.name, *(_read(asked, table) for table in sorted(stage.reads)))
        found = self._figures.get(key)
        if found is None:
            found = COMPUTE[stage.name](asked)
            self._figures.put(key, found)
        return found


@lru_cache(maxsize=1)
def bench_of(text: str) -> Bench:
    """This process's bench for the sweep with this canonical text."""
    return Bench(Plan.from_toml(text))


def _read(asked: Asked, table: str) -> Any:
    """What a stage sees of a table, as something that compares and hashes by value."""
    if table == "scene":
        return asked.scene.model_dump_json() if asked.scene else None
    return getattr(asked.design, table)


def _changed(tables: dict[str, Any], changes: Mapping[str, Value]) -> dict[str, Any]:
    """A copy of nested tables with dotted changes; what is not changed is shared."""
    new = dict(tables)
    for name, value in changes.items():
        table, _, key = name.rpartition(".")
        if table:
            new[table] = {**new[table], key: value}
        else:
            new[key] = value
    return new


def settled(value: float) -> float:
    """A figure as it is written down, as `cad.verify.settled` does: the last bits differ between processors."""
    return round(float(value), 6) + 0.0 if math.isfinite(value) else float(value)
