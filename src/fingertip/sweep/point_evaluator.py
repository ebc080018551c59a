"""Rows of many points: what a worker does with its part of a sweep.

A row depends on its point alone. What a worker remembers of the points before only saves time: stages of which nothing
has changed that they read, and solids that were meshed before.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

from fingertip.design.model import Design
from fingertip.errors import FingertipError, Issue
from fingertip.files import round_for_output
from fingertip.sweep.axes import Value
from fingertip.sweep.design_builder import Designs
from fingertip.sweep.cache import Memory
from fingertip.sweep.outputs import TRACES, Stage
from fingertip.sweep.chunk import Outcome, Part
from fingertip.sweep.plan import Plan
from fingertip.sweep.compute import COMPUTE, ISSUE, Asked, Figures, Recorded
from fingertip.sweep.worker_loop import each_limited

if TYPE_CHECKING:
    from fingertip.sim.scenes.scene_file import SceneFile
    from fingertip.sweep.cached_solids import CachedEvaluator

REMEMBERED = 4096
"""Results of stages that are kept: a few numbers each."""
TRACES_BYTES = 100e6
"""Of simulated trials that are kept."""
_NO_ISSUE = Issue("", "")
QUICK_COST, TOGETHER = 1, 64
"""So many points share a time limit where no stage costs more."""


class Bench:
    """One worker's place: the plan, and what is remembered between its points."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._designs = Designs(plan)
        self._figures: Memory[Any, Figures] = Memory(REMEMBERED)
        self._evaluator: CachedEvaluator | None = None
        self._scene = plan.scene.model_dump() if plan.scene else None
        self._nothing = (math.nan,) * len(plan.outputs)
        self._stages = [(stage, _shared_by(stage, plan)) for stage in plan.stages]
        self._traces: Memory[Any, Recorded] = Memory(TRACES_BYTES)
        self._of_traces = _shared_by(TRACES, plan)
        self._together = TOGETHER if all(stage.cost <= QUICK_COST for stage in plan.stages) else 1

    def outcomes(self, part: Part) -> list[Outcome]:
        """The rows of a part of the sweep."""
        limit_s = self.plan.file.time_limit_s
        return each_limited(part, limit_s, self._together, self.outcome)

    def outcome(self, point: int, changes: Mapping[str, Value]) -> Outcome:
        """The row of a point, whatever becomes of it: an exception is a row too."""
        try:
            design, scene = self._point(changes)
        except FingertipError as error:
            first, *others = error.issues
            more = f" (and {len(others)} more: {', '.join(dict.fromkeys(f.field for f in others))})" if others else ""
            return point, "refused", first.field, first.message + more, self._nothing
        asked = Asked(design, scene, self.plan.file, self.evaluator, partial(self._trace, changes))
        try:
            figures: Figures = {}
            for stage, shared in self._stages:
                figures |= self._computed(stage, shared, asked, changes)
        except FingertipError as error:
            return point, "failed", "", str(error), self._nothing
        except Exception as error:
            return point, "failed", "", _fault_of_ours(error), self._nothing
        issue = figures.get(ISSUE, _NO_ISSUE)
        return point, "ok", issue.field, issue.message, tuple(round_for_output(figures[name]) for name in self.plan.outputs)

    def evaluator(self) -> CachedEvaluator:
        """The mesh kernel, shared by all points."""
        if self._evaluator is None:
            from fingertip.sweep.cached_solids import CachedEvaluator, on_one_thread

            on_one_thread()
            self._evaluator = CachedEvaluator(self.plan.file.tolerance_mm)
        return self._evaluator

    def _point(self, changes: Mapping[str, Value]) -> tuple[Design, SceneFile | None]:
        issues: list[Issue] = []
        design, scene = None, None
        try:
            design = self._designs.design(changes)
        except FingertipError as error:
            issues += error.issues
        if self._scene is not None:
            try:
                scene = self._changed_scene(self._scene, changes)
            except FingertipError as error:
                issues += (Issue(f"scene.{issue.field}", issue.message) for issue in error.issues)
        if issues or design is None:
            raise FingertipError(issues)
        return design, scene

    def _changed_scene(self, tables: dict[str, Any], changes: Mapping[str, Value]) -> SceneFile:
        from fingertip.sim.scenes.scene_file import SceneFile
        from fingertip.sweep.design_builder import changed

        of_scene = {n.removeprefix("scene."): v for n, v in changes.items() if n.startswith("scene.")}
        return SceneFile(**changed(tables, of_scene))

    def _computed(
        self, stage: Stage, shared: tuple[str, ...] | None, asked: Asked, changes: Mapping[str, Value]
    ) -> Figures:
        """A stage's figures; remembered by the values of the axes it reads, if other axes vary beside them."""
        if shared is None:
            return COMPUTE[stage.name](asked)
        key = (stage.name, *(changes[name] for name in shared))
        found = self._figures.get(key)
        if found is None:
            found = COMPUTE[stage.name](asked)
            self._figures.put(key, found)
        return found

    def _trace(self, changes: Mapping[str, Value], seed: int, record: Callable[[], Recorded]) -> Recorded:
        """The trial of a seed, remembered as `_computed` does."""
        if self._of_traces is None:
            return record()
        key = (seed, *(changes[name] for name in self._of_traces))
        found = self._traces.get(key)
        if found is None:
            found = record()
            self._traces.put(key, found, 40.0 * len(found[0].time_s))  # five columns
        return found


@lru_cache(maxsize=1)
def bench_of(text: str) -> Bench:
    """This process's bench for the sweep with this canonical text."""
    return Bench(Plan.from_toml(text))



def _fault_of_ours(error: Exception) -> str:
    """What went wrong, and where: nobody sees a traceback of a worker."""
    import traceback

    frames = traceback.extract_tb(error.__traceback__)
    at = f"{frames[-1].name}, line {frames[-1].lineno}" if frames else "?"
    return f"{type(error).__name__}: {error} (in {at}); this is a bug in fingertip."


def _shared_by(stage: Stage, plan: Plan) -> tuple[str, ...] | None:
    """The axes a stage reads; None if it reads all of them, so that no two points share its figures."""
    read = tuple(axis.name for axis in plan.axes if stage.depends_on(axis.name))
    return read if len(read) < len(plan.axes) else None
