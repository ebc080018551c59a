"""Run a scene for a design, and the columns it gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.sim.electronics.comparator import missing
from fingertip.sim.scenes.scene_file import SceneFile
from fingertip.sim.stages.context import Context
from fingertip.sim.stages.pipeline import stages_of
from fingertip.sim.stages.stage import Ran, run
from fingertip.slip.traces.trace import Trace

LONG_S = 15.0
"""Scenes longer than this report their progress."""


@dataclass(frozen=True, eq=False)
class Simulated:
    """What a scene gave."""

    scene: SceneFile
    seed: int
    force_n: float
    """Holding force on this finger [N]."""
    time_s: Array
    columns: dict[str, Array]
    """The outputs the scene names, in its order; slip holds booleans."""
    ran: tuple[Ran, ...]
    """The stages that ran, and what each took."""

    @property
    def trace(self) -> Trace:
        """The columns a detector is given and judged by.

        Raises
        ------
        TraceError
            If the scene does not name the voltage among its outputs.
        """
        if "voltage_v" not in self.columns:
            raise TraceError(Issue("outputs", "does not name voltage_v; a trace needs it."))
        slip = self.columns["slip"].astype(np.bool_) if "slip" in self.columns else None
        return Trace(self.time_s, self.columns["voltage_v"], self.columns.get("force_n"), slip)


def run_scene(
    design: Design, scene: SceneFile, seed: int = 0, progress: Callable[[str], None] | None = None
) -> Simulated:
    """Simulate a scene: only the stages its outputs need are run.

    Parameters
    ----------
    design
        Gives the pad's form, the board, the converter and its noise.
    scene
        What happens, and which outputs are wanted.
    seed
        Of force, surface, motors and noise. The same design, scene and seed give the same columns.
    progress
        Told of progress, where a scene is long enough to need it.

    Raises
    ------
    TraceError
        If the seed is negative, or an output is none of this design's board.
    """
    if seed < 0:
        raise TraceError(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))
    if "slip_pin_v" in scene.outputs and design.board.variant != "comparator":
        raise TraceError(Issue("outputs", missing(design)))
    context = Context(design, scene, seed)
    long = progress and context.timeline.duration_s > LONG_S
    if progress and long:
        progress(f"{scene.scene}, {context.timeline.duration_s:.1f} s:")
    values, ran = run(stages_of(scene), context, scene.outputs, progress if long else None)
    columns = {name: values[name] for name in scene.outputs}
    return Simulated(scene, seed, context.force_n, context.time_s[context.every], columns, tuple(ran))
