"""A sweep as it was asked for: axes, base design and scene, and every point by its number.

Points are computed from their numbers when they are asked for, so that a million of them cost nothing. On a grid the
file's last axis varies fastest; a sampler's points follow its sequence.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design.parameters import DesignTables
from fingertip.design.rules import find_broken_rules
from fingertip.errors import FingertipError, Issue, SweepError
from fingertip.sweep import sweep_file
from fingertip.sweep.axes import Axis, Value, flatten, read_axis
from fingertip.sweep.outputs import Stage, shared_of, stages_of, unknown
from fingertip.sweep.sweep_file import MAX_POINTS, SweepFile

if TYPE_CHECKING:
    from fingertip.sim.scenes.scene_file import SceneFile

Points = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Plan:
    """A sweep, validated. Made by `Plan.load` or `Plan.from_toml`."""

    file: SweepFile
    axes: tuple[Axis, ...]
    design: DesignTables
    """Base design; within bounds, but its rules are asked of the points."""
    scene: SceneFile | None

    @classmethod
    def load(cls, path: str | Path, changes: Iterable[str] = ()) -> Plan:
        """Read a sweep file; see `sweep_file.read` for changes.

        Raises
        ------
        SweepError
            With everything that is wrong: unknown names, values out of bounds, files that cannot be read.
        """
        return cls.of(sweep_file.read(path, changes))

    @classmethod
    def from_toml(cls, text: str) -> Plan:
        """The plan of a canonical text, as `to_toml` gives it. Raises as `load` does."""
        return cls.of(sweep_file.parsed(text))

    @classmethod
    def of(cls, tables: Mapping[str, Any]) -> Plan:
        """A plan from tables: those of a sweep file, design and scene read in. Raises as `load` does."""
        file, issues = sweep_file.validated(tables)
        given = tables.get("axes")
        if given is not None and not isinstance(given, Mapping):
            raise SweepError(issues)
        sampled = tables.get("sampling") in ("latin_hypercube", "sobol")
        axes, more = _axes(given or {}, sampled)
        issues += more if given is not None else ()
        design, more = sweep_file.base_design(tables.get("design", {}))
        issues += more
        scene, more = _scene(tables.get("scene"))
        issues += more
        outputs = tables.get("outputs")
        if isinstance(outputs, list) and all(isinstance(name, str) for name in outputs):
            issues += unknown(outputs)
        if file:
            issues += sweep_file.objectives(file)
            issues += _amount(file, axes)
            issues += _catalogues(file)
        if file and design and not issues:
            plan = cls(file, tuple(axes), design, scene)
            issues += _together(plan)
            if not issues:
                return plan
        raise SweepError(issues)

    def to_toml(self) -> str:
        """The whole sweep as canonical text, base design and scene included: equal sweeps give equal text."""
        tables: dict[str, Any] = self.file.model_dump(exclude={"axes", "design", "scene"})
        tables["axes"] = {axis.name: _as_given(axis) for axis in self.axes}
        tables["design"] = self.design.model_dump()
        if self.scene:
            tables["scene"] = self.scene.model_dump()
        return sweep_file.to_text(tables)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the wanted outputs, in the file's order."""
        return tuple(self.file.outputs)

    @property
    def stages(self) -> tuple[Stage, ...]:
        """What has to be computed for them, cheapest first."""
        return stages_of(self.outputs)

    @cached_property
    def size(self) -> int:
        """How many points there are."""
        return int(np.prod(self._shape, dtype=object)) if self.file.sampling == "grid" else self.file.points

    @property
    def _shape(self) -> tuple[int, ...]:
        return tuple(len(axis.values) for axis in self.axes)

    def point(self, number: int) -> dict[str, Value]:
        """Parameters of a point: name -> value, plain Python. Raises IndexError beyond the last."""
        if not 0 <= number < self.size:
            raise IndexError(f"point {number} of {self.size}")
        return {name: column.tolist()[0] for name, column in self.columns(np.array([number])).items()}

    def columns(self, points: Points) -> dict[str, NDArray[Any]]:
        """Parameters of many points: name -> (n,) values."""
        if self.file.sampling == "grid":
            places = np.unravel_index(points, self._shape)
            return {axis.name: axis.column(np.asarray(place)) for axis, place in zip(self.axes, places, strict=True)}
        return {axis.name: axis.drawn(self._shares[points, i]) for i, axis in enumerate(self.axes)}

    def in_order(self, start: int, stop: int) -> Points:
        """Numbers of the points that are computed at these places of the sweep.

        On a grid, axes of dear stages vary slowest: neighbours share what they have in common. A sampler's points have
        nothing in common.
        """
        places = np.arange(start, min(stop, self.size), dtype=np.int64)
        if self.file.sampling != "grid" or not self.axes:
            return places
        order = sorted(range(len(self.axes)), key=lambda i: -self._dearest(self.axes[i]))
        at = np.unravel_index(places, tuple(self._shape[i] for i in order))
        back: list[Any] = [None] * len(order)
        for place, i in zip(at, order, strict=True):
            back[i] = place
        return np.asarray(np.ravel_multi_index(tuple(back), self._shape), dtype=np.int64)

    def _dearest(self, axis: Axis) -> float:
        """Cost of what has to be computed anew when an axis steps on."""
        costs = [stage.cost for stage in shared_of(self.outputs) if stage.depends_on(axis.name)]
        # The finger's form is in everything that is cut from it; the mold and the printer are not in the finger.
        table = axis.name.partition(".")[0]
        return max(costs, default=-1) + {"mold": -0.25, "printer": -0.5, "name": -0.5}.get(table, 0.0)

    @cached_property
    def _shares(self) -> NDArray[np.float64]:
        """(points, axes) in [0, 1)."""
        from scipy.stats import qmc

        if self.file.sampling == "sobol":
            return np.asarray(qmc.Sobol(len(self.axes), scramble=True, rng=self.file.seed).random(self.size))
        return np.asarray(qmc.LatinHypercube(len(self.axes), rng=self.file.seed).random(self.size))


def _axes(given: Mapping[str, Any], sampled: bool) -> tuple[list[Axis], list[Issue]]:
    axes: list[Axis] = []
    issues: list[Issue] = []
    for name, inner in flatten(given):
        axis, found = read_axis(name, inner, sampled)
        issues += found
        if axis:
            axes.append(axis)
    if not axes and not issues:
        issues.append(Issue("axes", "is empty; name at least one parameter, such as skin.width_mm = [16, 17]."))
    return axes, issues


def _scene(given: Mapping[str, Any] | None) -> tuple[SceneFile | None, list[Issue]]:
    if given is None:
        return None, []
    from fingertip.sim.scenes.scene_file import SceneFile

    try:
        return SceneFile(**given), []
    except FingertipError as error:
        return None, [Issue(f"scene.{issue.field}", issue.message) for issue in error.issues]


def _amount(file: SweepFile, axes: list[Axis]) -> list[Issue]:
    if file.sampling == "grid":
        size = int(np.prod([len(axis.values) for axis in axes], dtype=object)) if axes else 0
        if file.points:
            return [
                Issue("points", f"{file.points} is for samplers; a grid has {size} points by its axes, leave it out.")
            ]
        if size > MAX_POINTS:
            return [Issue("axes", f"make a grid of {size} points; at most {MAX_POINTS}, or draw some with sobol.")]
        return []
    if not file.points:
        return [Issue("points", f"is missing; say how many {file.sampling} draws, such as points = 1024.")]
    if file.sampling == "sobol" and file.points & (file.points - 1):
        below = 1 << (file.points.bit_length() - 1)
        sentence = f"{file.points} is no power of two, without which a Sobol sequence is not balanced"
        return [Issue("points", f"{sentence}; choose {below} or {2 * below}, or latin_hypercube.")]
    return []


def _catalogues(file: SweepFile) -> list[Issue]:
    """Names of things that other packages list."""
    from fingertip.casting.materials import silicone
    from fingertip.slip.detectors.registry import find_detector_type

    issues: list[Issue] = []
    for name, look_up, word in (("silicone", silicone, file.silicone), ("detector", find_detector_type, file.detector)):
        try:
            look_up(word)
        except FingertipError as error:
            issues += (Issue(name, issue.message) for issue in error.issues)
    return issues


def _together(plan: Plan) -> list[Issue]:
    """What is wrong only between the parts of a plan."""
    read = frozenset().union(*(stage.reads for stage in plan.stages))
    of_scene = [axis.name for axis in plan.axes if axis.name.startswith("scene.")]
    issues = []
    if "scene" in read and plan.scene is None:
        wanted = ", ".join(n for n in plan.outputs if stages_of([n])[0].name == "trials")
        issues.append(Issue("scene", f'is missing, and {wanted} are of one; write scene = "sliding_finger.toml".'))
    if "scene" not in read:
        issues += [Issue(f"axes.{n}", "changes no output that is wanted; add one, such as delay_ms.") for n in of_scene]
    swept = {axis.name for axis in plan.axes}
    for issue, reads in find_broken_rules(plan.design):
        if not reads & swept:
            issues.append(Issue(f"design.{issue.field}", f"{issue.message} No axis changes that."))
    return issues


def _as_given(axis: Axis) -> Any:
    if axis.given:
        return list(axis.given)
    table: dict[str, Any] = {"low": axis.low, "high": axis.high}
    if axis.steps:
        table["steps"] = axis.steps
    return table | {"spacing": axis.spacing}
