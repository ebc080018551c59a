"""Evaluation of single points, as a worker does it.

The result of a point depends on that point alone. Caches only save time: an output group whose inputs have not changed
is not computed again, and a solid that was meshed before is not meshed again.
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
from fingertip.sweep.cache import LruCache
from fingertip.sweep.chunk import PointResult
from fingertip.sweep.compute import GROUP_FUNCTIONS, ISSUE, OutputValues, PointContext, RecordedTrial
from fingertip.sweep.design_builder import DesignBuilder, apply_changes
from fingertip.sweep.outputs import TRACES, OutputGroup
from fingertip.sweep.plan import SweepPlan

if TYPE_CHECKING:
    from fingertip.sim.scene.scene_file import SceneFile
    from fingertip.sweep.cached_solids import CachedEvaluator

MAX_GROUP_RESULTS = 4096
"""Number of cached results of output groups; each holds a few numbers."""
MAX_TRACE_BYTES = 100e6
"""Limit of the memory for cached simulated trials [bytes]."""
QUICK_COST = 1
"""Maximum cost of the output groups of a sweep whose points share time limits."""
QUICK_POINTS_PER_LIMIT = 64
"""Number of points that share a time limit in such a sweep."""
_NO_ISSUE = Issue("", "")


class PointEvaluator:
    """Evaluates the points of one plan, and caches what they have in common."""

    def __init__(self, plan: SweepPlan) -> None:
        self.plan = plan
        quick = all(group.cost <= QUICK_COST for group in plan.groups)
        self.points_per_limit = QUICK_POINTS_PER_LIMIT if quick else 1
        """Number of points that share a time limit."""
        self._designs = DesignBuilder(plan)
        self._scene = plan.scene.model_dump() if plan.scene else None
        self._groups = [(group, _find_cache_axes(group, plan)) for group in plan.groups]
        self._trace_axes = _find_cache_axes(TRACES, plan)
        self._group_results: LruCache[Any, OutputValues] = LruCache(MAX_GROUP_RESULTS)
        self._trials: LruCache[Any, RecordedTrial] = LruCache(MAX_TRACE_BYTES)
        self._mesh_evaluator: CachedEvaluator | None = None
        self._no_outputs = (math.nan,) * len(plan.outputs)

    def evaluate(self, point: int, changes: Mapping[str, Value]) -> PointResult:
        """Evaluate a point. Every point gets a result: an exception becomes its status and reason."""
        try:
            design, scene = self._build_inputs(changes)
        except FingertipError as error:
            first, *others = error.issues
            fields = ", ".join(dict.fromkeys(issue.field for issue in others))
            more = f" (and {len(others)} more: {fields})" if others else ""
            return point, "refused", first.field, first.message + more, self._no_outputs
        load_trial = partial(self._load_trial, changes)
        context = PointContext(design, scene, self.plan.file, self.load_mesh_evaluator, load_trial)
        try:
            values: OutputValues = {}
            for group, cache_axes in self._groups:
                values |= self._compute_group(group, cache_axes, context, changes)
        except FingertipError as error:
            return point, "failed", "", str(error), self._no_outputs
        except Exception as error:
            return point, "failed", "", _describe_bug(error), self._no_outputs
        issue = values.get(ISSUE, _NO_ISSUE)
        outputs = tuple(round_for_output(values[name]) for name in self.plan.outputs)
        return point, "ok", issue.field, issue.message, outputs

    def load_mesh_evaluator(self) -> CachedEvaluator:
        """Load the mesh kernel, which all points share."""
        if self._mesh_evaluator is None:
            from fingertip.sweep.cached_solids import CachedEvaluator, restrict_kernel_to_one_thread

            restrict_kernel_to_one_thread()
            self._mesh_evaluator = CachedEvaluator(self.plan.file.tolerance_mm)
        return self._mesh_evaluator

    def _build_inputs(self, changes: Mapping[str, Value]) -> tuple[Design, SceneFile | None]:
        """Build design and scene of a point; raise the issues of both."""
        issues: list[Issue] = []
        design, scene = None, None
        try:
            design = self._designs.build(changes)
        except FingertipError as error:
            issues += error.issues
        if self._scene is not None:
            try:
                scene = self._build_scene(self._scene, changes)
            except FingertipError as error:
                issues += (Issue(f"scene.{issue.field}", issue.message) for issue in error.issues)
        if issues or design is None:
            raise FingertipError(issues)
        return design, scene

    def _build_scene(self, tables: dict[str, Any], changes: Mapping[str, Value]) -> SceneFile:
        from fingertip.sim.scene.scene_file import SceneFile

        scene_changes = {n.removeprefix("scene."): v for n, v in changes.items() if n.startswith("scene.")}
        return SceneFile(**apply_changes(tables, scene_changes))

    def _compute_group(
        self,
        group: OutputGroup,
        cache_axes: tuple[str, ...] | None,
        context: PointContext,
        changes: Mapping[str, Value],
    ) -> OutputValues:
        """Compute the outputs of a group, or take them from the cache."""
        if cache_axes is None:
            return GROUP_FUNCTIONS[group.name](context)
        key = (group.name, *(changes[name] for name in cache_axes))
        values = self._group_results.get(key)
        if values is None:
            values = GROUP_FUNCTIONS[group.name](context)
            self._group_results.put(key, values)
        return values

    def _load_trial(
        self, changes: Mapping[str, Value], seed: int, record: Callable[[], RecordedTrial]
    ) -> RecordedTrial:
        """Record the trial of a seed, or take it from the cache."""
        if self._trace_axes is None:
            return record()
        key = (seed, *(changes[name] for name in self._trace_axes))
        trial = self._trials.get(key)
        if trial is None:
            trial = record()
            self._trials.put(key, trial, 40.0 * len(trial[0].time_s))  # five columns of 8 bytes
        return trial


@lru_cache(maxsize=1)
def load_evaluator(text: str) -> PointEvaluator:
    """Load this process's evaluator for the sweep with this canonical text."""
    return PointEvaluator(SweepPlan.from_toml(text))


def _describe_bug(error: Exception) -> str:
    """Describe an unexpected exception and its location; a worker's traceback is never printed."""
    import traceback

    frames = traceback.extract_tb(error.__traceback__)
    location = f"{frames[-1].name}, line {frames[-1].lineno}" if frames else "?"
    return f"{type(error).__name__}: {error} (in {location}); this is a bug in fingertip."


def _find_cache_axes(group: OutputGroup, plan: SweepPlan) -> tuple[str, ...] | None:
    """Find the axes that a group reads, which are its cache key; None if it reads all axes, so no points share it."""
    axes = tuple(axis.name for axis in plan.axes if group.depends_on(axis.name))
    return axes if len(axes) < len(plan.axes) else None
