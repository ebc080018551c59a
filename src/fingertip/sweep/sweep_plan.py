"""Plan of a sweep: its axes, its base design and scene, and its points by number.

Points are computed from their numbers when they are needed, so a million of them take no memory. On
a grid the file's last axis varies fastest. The points of a sampler follow its sequence.
"""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.electronics import split_finger
from fingertip.design.fit import MOVABLE
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters.declaration import suggest_name
from fingertip.design.refusal import find_remedies
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, SweepError, gather
from fingertip.foundation.files import round_for_output
from fingertip.slip.detectors.registry import find_detector_type
from fingertip.sweep import sweep_file
from fingertip.sweep.axes import Axis, Value, find_repeats
from fingertip.sweep.axis_parser import flatten_axes, read_axis
from fingertip.sweep.outputs import TRACES, OutputGroup, check_outputs, find_groups
from fingertip.sweep.sweep_file import MAX_POINTS, MAX_SAMPLED_VALUES, SweepFile
from fingertip.sweep.swept_parameters import select_changes

if TYPE_CHECKING:
    from fingertip.sim.runs.scene_and_manipulation_files import SceneFile

FITTED = "fitted."
"""Beginning of the name of a column that holds what a fit has moved."""
PointNumbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """Validated sweep. Create it with `SweepPlan.load`, `from_toml` or `from_tables`."""

    file: SweepFile
    axes: tuple[Axis, ...]
    designs: Mapping[str, DesignTables]
    """Base design under "", or finger -> design of the base set. Their parameters are within their
    bounds; the rules between them are checked at each point.
    """
    scene: SceneFile | None

    @classmethod
    def load(cls, path: str | Path, changes: Iterable[str] = ()) -> SweepPlan:
        """Load a sweep file (see `read_sweep_file`). Raises SweepError or MissingLibraryError."""
        plan = cls.from_tables(sweep_file.read_sweep_file(path, changes))
        if plan.file.sampling != "grid":
            plan._require_samplers()  # a missing package is reported before the sweep

        return plan

    @classmethod
    def from_toml(cls, text: str) -> SweepPlan:
        """Parse the canonical text that `to_toml` wrote. Raises as `load` does."""
        return cls.from_tables(tomllib.loads(text))

    @classmethod
    def from_tables(cls, tables: Mapping[str, Any]) -> SweepPlan:
        """Build a plan from the tables of a sweep file that hold design and scene.

        Raises as `load` does.
        """
        # Each section is validated even if another one is wrong, so that all issues are reported at
        # once.
        file, issues = sweep_file.parse_sweep_file(tables)
        sections = [tables.get(name) for name in ("axes", "design", "scene")]
        if not all(isinstance(section, Mapping | None) for section in sections):
            raise SweepError(issues)  # which name what is no table

        entries, design_tables, scene_tables = sections
        sampled = tables.get("sampling") in ("latin_hypercube", "sobol")
        axes, axis_issues = _read_axes(entries or {}, sampled)
        issues += axis_issues if entries is not None else ()
        designs, design_issues = sweep_file.parse_base_designs(design_tables or {})
        issues += design_issues
        scene = None

        if scene_tables is not None:
            from fingertip.sim.runs.scene_and_manipulation_files import SceneFile  # noqa: PLC0415

            with gather(issues, "scene."):
                scene = SceneFile(**scene_tables)

        outputs = tables.get("outputs")
        unknown: list[Issue] = []
        if isinstance(outputs, list) and all(isinstance(name, str) for name in outputs):
            is_set = "fingers" in (design_tables or {})
            unknown = check_outputs(outputs, is_set)
            issues += unknown

        if file and not unknown:  # else an objective may be right, and an output misspelt
            issues += sweep_file.check_objectives(file)

        if file:
            issues += _check_point_count(file, axes)
            with gather(issues):
                find_detector_type(file.detector, "detector")

        if file and not issues:
            plan = cls(file, tuple(axes), designs, scene)
            issues += _check_consistency(plan)
            if not issues:
                return plan

        raise SweepError(issues)

    def to_toml(self) -> str:
        """Write the whole sweep, base design and scene included, as canonical text: equal sweeps
        give equal text.
        """
        tables: dict[str, Any] = self.file.model_dump(exclude={"axes", "design", "scene"})
        tables["axes"] = {axis.name: _to_entry(axis) for axis in self.axes}
        dumped = {finger: design.model_dump() for finger, design in self.designs.items()}
        tables["design"] = self.file.design | {"fingers": dumped} if self.is_set else dumped[""]
        if self.scene:
            tables["scene"] = self.scene.model_dump()

        return sweep_file.to_canonical_text(tables)

    @property
    def is_set(self) -> bool:
        return "" not in self.designs

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple(self.file.outputs)

    @cached_property
    def fitted(self) -> dict[str, float]:
        """Column of each number that a fit may move -> its value in the base, such as
        "fitted.skin.tip_length_mm".
        """
        values = dict[str, float]()
        axes = dict.fromkeys((axis.name for axis in self.axes), 0)

        for finger, design in self.designs.items() if self.file.fit else ():
            for name in sorted({*MOVABLE} - select_changes(axes, finger).keys()):
                owner = f"fingers.{finger}." if finger else ""
                values[f"{FITTED}{owner}{name}"] = round_for_output(design.value(name))

        return values

    @property
    def recorded(self) -> tuple[str, ...]:
        """Numbers that are stored for each point: outputs, and values that a fit may have moved."""
        return (*self.outputs, *self.fitted)

    @property
    def groups(self) -> tuple[OutputGroup, ...]:
        """Groups that have to be computed for the outputs, cheapest first."""
        return find_groups(self.outputs)

    @cached_property
    def size(self) -> int:
        return (
            int(np.prod(self._shape, dtype=object))
            if self.file.sampling == "grid"
            else self.file.points
        )

    @property
    def _shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in self.axes)

    def point(self, number: int) -> dict[str, Value]:
        """Return the parameters of a point, name -> value.

        Raises IndexError beyond the last point.
        """
        if not 0 <= number < self.size:
            raise IndexError(f"point {number} of {self.size}")

        return {
            name: column.tolist()[0] for name, column in self.columns(np.array([number])).items()
        }

    def columns(self, points: PointNumbers) -> dict[str, NDArray[Any]]:
        """Return the parameters of many points, name -> (n,) values."""
        if self.file.sampling == "grid":
            indices = np.unravel_index(points, self._shape)
            return {
                axis.name: axis.array[index] for axis, index in zip(self.axes, indices, strict=True)
            }

        return {
            axis.name: axis.sample(self._samples[points, i]) for i, axis in enumerate(self.axes)
        }

    def computing_order(self, start: int, stop: int) -> PointNumbers:
        """Return the numbers of the points that are computed from position `start` to before
        `stop`.

        On a grid, the axes of expensive output groups vary slowest, so that neighbouring points
        share results. The points of a sampler have nothing in common and are computed in their own
        order.
        """
        positions = np.arange(start, min(stop, self.size), dtype=np.int64)
        if self.file.sampling != "grid" or not self.axes:
            return positions

        order = sorted(range(len(self.axes)), key=lambda i: -self._cost_of_step(self.axes[i]))
        indices = np.unravel_index(positions, tuple(self._shape[i] for i in order))
        by_axis = dict(zip(order, indices, strict=True))
        in_order = tuple(by_axis[i] for i in range(len(order)))

        return np.asarray(np.ravel_multi_index(in_order, self._shape), dtype=np.int64)

    def _cost_of_step(self, axis: Axis) -> float:
        """Cost of what has to be computed again when an axis takes its next value."""
        has_trials = any(group.name == "detection" for group in self.groups)
        shared = (*self.groups, TRACES) if has_trials else self.groups
        costs = [group.cost for group in shared if group.depends_on(axis.name)]
        # Every part is made from the finger's shape. The mold, the printer and the name do not
        # change it.
        table = split_finger(axis.name)[1].partition(".")[0]

        return max(costs, default=-1) + {"mold": -0.25, "printer": -0.5, "name": -0.5}.get(
            table, 0.0
        )

    @cached_property
    def _samples(self) -> NDArray[np.float64]:
        """Samples in [0, 1), shape (points, axes): Latin hypercube or scrambled Sobol sequence."""
        self._require_samplers()
        from scipy.stats import qmc  # noqa: PLC0415

        # Both scramble by default.
        sampler = qmc.Sobol if self.file.sampling == "sobol" else qmc.LatinHypercube

        return np.asarray(sampler(len(self.axes), rng=self.file.seed).random(self.size))

    def _require_samplers(self) -> None:
        extras.require("sampling", "scipy", subject=self.file.sampling, alternative="sample a grid")


def _read_axes(entries: Mapping[str, Any], sampled: bool) -> tuple[list[Axis], list[Issue]]:
    axes: list[Axis] = []
    issues: list[Issue] = []
    for name, entry in flatten_axes(entries):
        with gather(issues):
            axis, beyond_bounds = read_axis(name, entry, sampled)
            axes.append(axis)
            issues += beyond_bounds

    if not axes and not issues:
        issues.append(
            Issue(
                "axes", "is empty; name at least one parameter, such as skin.width_mm = [16, 17]."
            )
        )

    return axes, issues


def _check_point_count(file: SweepFile, axes: list[Axis]) -> list[Issue]:
    if file.sampling == "grid":
        size = math.prod(axis.count for axis in axes) if axes else 0
        if file.points:
            problem = f"{file.points} is for samplers, but the axes make a grid of {size} points"
            return [Issue("points", f"{problem}; leave it out.")]

        if size > MAX_POINTS:
            message = (
                f"make a grid of {size} points; give at most {MAX_POINTS}, or sample them "
                "with sobol."
            )
            return [Issue("axes", message)]

        return list(itertools.chain.from_iterable(map(find_repeats, axes)))

    if not file.points:
        return [
            Issue(
                "points",
                f"is missing; give the number that {file.sampling} draws, such as points = 1024.",
            )
        ]

    if file.points * len(axes) > MAX_SAMPLED_VALUES:
        most = MAX_SAMPLED_VALUES // len(axes)
        most = 1 << (most.bit_length() - 1) if file.sampling == "sobol" else most
        return [
            Issue(
                "points",
                f"{file.points} points of {len(axes)} axes do not fit in memory; at most {most}.",
            )
        ]

    if file.sampling == "sobol" and file.points & (file.points - 1):
        below = 1 << (file.points.bit_length() - 1)
        problem = f"{file.points} is not a power of two, which a balanced Sobol sequence needs"
        return [Issue("points", f"{problem}; choose {below} or {2 * below}, or latin_hypercube.")]

    return []


def _check_consistency(plan: SweepPlan) -> list[Issue]:
    """Check what only several sections of a plan together can get wrong."""
    tables_read = frozenset().union(*(group.reads for group in plan.groups))
    scene_axes = [axis.name for axis in plan.axes if axis.name.startswith("scene.")]
    issues = []

    if "scene" in tables_read and plan.scene is None and not plan.is_set:
        outputs = ", ".join(n for n in plan.outputs if "scene" in find_groups([n])[0].reads)
        remedy = 'write scene = "sliding_finger".'
        issues.append(Issue("scene", f"is missing, but outputs need one ({outputs}); {remedy}"))

    if "scene" not in tables_read:
        issues += [
            Issue(
                f"axes.{name}",
                "changes none of the outputs; add one that it changes, such as delay_ms.",
            )
            for name in scene_axes
        ]

    # A broken rule of a base design is an issue only if no axis can repair it.
    for axis in plan.axes:
        finger = split_finger(axis.name)[0]
        if finger and finger not in plan.designs:
            remedy = (
                suggest_name(finger, list(plan.designs))
                if plan.is_set
                else "name a set with design = NAME."
            )
            issues.append(
                Issue(f"axes.{axis.name}", f"names a finger that design does not have; {remedy}")
            )

    for finger, design in plan.designs.items() if not plan.file.fit else ():  # a fit may repair it
        swept = select_changes(dict.fromkeys((axis.name for axis in plan.axes), 0), finger).keys()
        broken = list(find_violations(RULES, design))
        lasting = [broken_rule for broken_rule in broken if not broken_rule.reads & swept]
        if not lasting:
            continue

        repairable = {broken_rule.rule for broken_rule in broken} - {
            broken_rule.rule for broken_rule in lasting
        }
        rules = [rule for rule in RULES if rule not in repairable]
        issues += [
            Issue(
                f"design.{f'fingers.{finger}.' * plan.is_set}{issue.field}",
                f"no axis changes this: {issue.message}",
            )
            for issue in find_remedies(design, lasting, rules=rules)
        ]

    return issues


def _to_entry(axis: Axis) -> Any:
    if axis.listed:
        return list(axis.listed)

    table: dict[str, Any] = {"low": axis.low, "high": axis.high}
    if axis.steps:
        table["steps"] = axis.steps

    return table | {"spacing": axis.spacing}
