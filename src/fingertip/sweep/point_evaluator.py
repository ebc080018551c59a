"""Evaluation of single points, as a worker does it.

The result of a point depends on that point alone. Caches only save time: an output group whose
inputs have not changed is not computed again, and a solid that was meshed before is not meshed
again.
"""

from __future__ import annotations

import faulthandler
import math
import os
import threading
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import IO, TYPE_CHECKING, Any, TypeAlias

from fingertip.catalogues.electronics import split_finger
from fingertip.design.design import Design
from fingertip.design.finger_set import FingerSet, build_set
from fingertip.foundation.errors import FingertipError, Issue, gather, raise_issues
from fingertip.foundation.files import round_for_output
from fingertip.foundation.workers import report_step
from fingertip.sweep import designs
from fingertip.sweep.axes import Value
from fingertip.sweep.compute import GROUP_FUNCTIONS, ISSUE, OutputValues, PointContext
from fingertip.sweep.outputs import TRACES, OutputGroup
from fingertip.sweep.sweep_plan import FITTED, SweepPlan
from fingertip.sweep.swept_parameters import is_of_parts

if TYPE_CHECKING:
    from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
    from fingertip.slip.traces.trace import Trace


MAX_GROUP_RESULTS = 4096
"""Number of cached results of output groups; each holds a few numbers."""
MAX_TRACE_BYTES = 100e6
"""Limit of the memory for cached simulated trials [bytes]."""
QUICK_COST = 1
"""Maximum cost of the output groups of a sweep whose points share time limits."""
QUICK_POINTS_PER_LIMIT = 64
"""Number of points that share a time limit in such a sweep."""
_NO_ISSUE = Issue("", "")
PointResult: TypeAlias = tuple[int, str, str, str, tuple[float, ...]]
"""Point number, status, field, reason, and the outputs in the plan's order."""


@dataclass(frozen=True)
class Chunk:
    """Points of a sweep that one worker evaluates in one task."""

    text: str
    """Canonical TOML text of the sweep."""
    points: tuple[int, ...]
    columns: dict[str, list[Any]]
    """Swept parameter -> one value for each point."""

    def select(self, indices: Sequence[int]) -> Chunk:
        """Build a chunk of some of these points, given their indices in `points`."""
        columns = {name: [column[i] for i in indices] for name, column in self.columns.items()}
        return Chunk(self.text, tuple(self.points[i] for i in indices), columns)


@dataclass(frozen=True)
class ChunkResult:
    results: list[PointResult]
    elapsed_s: float


ChunkFunction: TypeAlias = Callable[[Chunk], ChunkResult]


class PointEvaluator:
    """Evaluates the points of one plan, and caches what they have in common."""

    def __init__(self, plan: SweepPlan) -> None:
        self.plan = plan
        quick = all(group.cost <= QUICK_COST for group in plan.groups)
        self.points_per_limit = QUICK_POINTS_PER_LIMIT if quick else 1
        self._builders = {finger: designs.DesignBuilder(plan, finger) for finger in plan.designs}
        self._scene = plan.scene.model_dump() if plan.scene else None
        self._groups = [(group, _find_cache_axes(group, plan)) for group in plan.groups]
        self._trace_axes = _find_cache_axes(TRACES, plan)
        self._group_results: designs.LruCache[Any, OutputValues] = designs.LruCache(
            MAX_GROUP_RESULTS
        )
        self._trials: designs.LruCache[Any, Trace] = designs.LruCache(MAX_TRACE_BYTES)
        self._no_outputs = (math.nan,) * len(plan.recorded)

    def evaluate(self, point: int, changes: Mapping[str, Value]) -> PointResult:
        """Evaluate a point.

        Every point gets a result: an exception becomes its status and reason.
        """
        try:
            built, fingers, scene = self._build_inputs(changes)
        except FingertipError as error:
            first, *further = error.issues
            fields = ", ".join(dict.fromkeys(issue.field for issue in further))
            more = f" (and {len(further)} more: {fields})" if further else ""
            return point, "refused", first.field, first.message + more, self._no_outputs

        load_trial = partial(self._load_trial, changes)
        design = next(iter(built.values()))
        context = PointContext(
            design=design,
            scene=scene,
            file=self.plan.file,
            evaluator=lambda: self.mesh_evaluator,
            load_trial=load_trial,
            fingers=fingers,
        )

        try:
            values: OutputValues = {}
            for column in self.plan.fitted:
                finger, path = split_finger(column.removeprefix(FITTED))
                values[column] = built[finger].value(path)

            for group, cache_axes in self._groups:
                compute = partial(GROUP_FUNCTIONS[group.name], context)
                key = group.name, *(changes[name] for name in cache_axes or ())
                values |= compute() if cache_axes is None else self._group_results.get(key, compute)
        except FingertipError as error:
            return point, "failed", "", str(error), self._no_outputs
        except Exception as error:  # a worker's traceback is never printed
            last = traceback.extract_tb(error.__traceback__)[-1]
            fault = f"{type(error).__name__}: {error} (in {last.name}, line {last.lineno})"
            return point, "failed", "", f"{fault}; this is a bug in fingertip.", self._no_outputs

        issue = values.get(ISSUE, _NO_ISSUE)
        outputs = tuple(round_for_output(values[name]) for name in self.plan.recorded)
        return point, "ok", issue.field, issue.message, outputs

    @cached_property
    def mesh_evaluator(self) -> designs.CachedEvaluator:
        designs.restrict_kernel_to_one_thread()
        return designs.CachedEvaluator(self.plan.file.tolerance_mm)

    def _build_inputs(
        self, changes: Mapping[str, Value]
    ) -> tuple[dict[str, Design], FingerSet | None, SceneFile | None]:
        """Build design, set and scene of a point; the designs by finger, or "" for a single one."""
        issues: list[Issue] = []
        built = dict[str, Design]()
        fingers = None
        scene = None

        for finger, builder in self._builders.items():
            with gather(issues, f"fingers.{finger}: " if finger else ""):
                built[finger] = builder.build(changes)

        if self.plan.is_set and not issues:
            with gather(issues):
                fingers = build_set(
                    self.plan.file.design["name"], self.plan.file.design["side"], built
                )

        if self._scene is not None:
            from fingertip.sim.runs.scene_and_manipulation_files import SceneFile  # noqa: PLC0415

            scene_changes = {
                n.removeprefix("scene."): v for n, v in changes.items() if n.startswith("scene.")
            }
            with gather(issues, "scene."):
                scene = SceneFile(**designs.apply_changes(self._scene, scene_changes))

        raise_issues(FingertipError, issues)
        return built, fingers, scene

    def _load_trial(
        self, changes: Mapping[str, Value], seed: int, record: Callable[[], Trace]
    ) -> Trace:
        if self._trace_axes is None:
            return record()

        key = (seed, *(changes[name] for name in self._trace_axes))
        # Five columns of 8 bytes.
        return self._trials.get(key, record, lambda trace: 40.0 * len(trace.time_s))


@lru_cache(maxsize=1)
def load_evaluator(text: str) -> PointEvaluator:
    """Load this process's evaluator for the sweep with this canonical text."""
    return PointEvaluator(SweepPlan.from_toml(text))


def _find_cache_axes(group: OutputGroup, plan: SweepPlan) -> tuple[str, ...] | None:
    """Find the axes that a group reads, which are its cache key.

    None if it reads all axes, so no points share it.
    """
    # What a fit moves depends on every axis of the parts.
    axes = tuple(
        axis.name
        for axis in plan.axes
        if group.depends_on(axis.name) or (plan.file.fit and is_of_parts(axis.name))
    )
    return axes if len(axes) < len(plan.axes) else None


_null_file: IO[str] | None = None
_one_chunk_at_a_time = threading.Lock()
"""A Dask worker may have several threads.
Time limits and caches are made for one point at a time.
"""


def evaluate_chunk(chunk: Chunk) -> ChunkResult:
    """Evaluate every point of a chunk; this is the task that engines send to workers."""
    with _one_chunk_at_a_time:
        start = time.perf_counter()
        evaluator = load_evaluator(chunk.text)
        limit_s = evaluator.plan.file.time_limit_s
        results = evaluate_points(chunk, limit_s, evaluator.points_per_limit, evaluator.evaluate)
        return ChunkResult(results, time.perf_counter() - start)


def evaluate_points(
    chunk: Chunk,
    limit_s: float,
    points_per_limit: int,
    evaluate: Callable[[int, dict[str, Any]], PointResult],
) -> list[PointResult]:
    """Evaluate the points of a chunk one after the other.

    This process exits if one exceeds its time limit.

    An exception raised in the running code would leave half-imported modules and half-filled caches
    behind, and later points would suffer from them. faulthandler ends the process from its own
    thread. That thread needs no Python lock, so it also ends a compiled kernel stuck in an endless
    loop. The engine notices the exit, starts another worker, and knows from the last report which
    points were being computed.
    """
    global _null_file
    if _null_file is None:
        # faulthandler writes its traceback there. The file stays open until the process ends.
        _null_file = open(os.devnull, "w")  # noqa: SIM115

    names = list(chunk.columns)
    values = list(zip(*chunk.columns.values(), strict=True))
    results: list[PointResult] = []

    try:
        for i, point in enumerate(chunk.points):
            if i % points_per_limit == 0:
                report_step(chunk.points[i : i + points_per_limit])
                faulthandler.dump_traceback_later(limit_s, exit=True, file=_null_file)

            results.append(evaluate(point, dict(zip(names, values[i], strict=True))))
    finally:
        faulthandler.cancel_dump_traceback_later()

    return results
