"""Plan of a simulation: the stages that its outputs need, and what they will cost, from a trial of
its first part.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fingertip.foundation import jit
from fingertip.sim.runs.manipulation import advance_as_planned, start_manipulation
from fingertip.sim.runs.scene import COMPILE_FROM_S, SceneRun
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile
from fingertip.sim.signal.grid import STAGES, CostMeter, StageCost
from fingertip.sim.simulation import Simulation

_COUPLED = {"friction", "profile", "contact"}
"""Stages that the coupled contact holds."""
TRIED_POINTS = 4096
"""Points of the grid in each of the two chunks that are tried: some 0.4 s."""


@dataclass(frozen=True)
class SimulationPlan:
    simulation: Simulation
    duration_s: float
    stages: tuple[StageCost, ...]
    """Stages that run, with the evaluations and the CPU time that the whole simulation will take.
    """

    @property
    def left_out(self) -> tuple[str, ...]:
        """Stages that neither the scene nor its outputs need."""
        run = {stage.name for stage in self.stages}
        if "coupled contact" in run:
            run |= _COUPLED

        return tuple(name for name in STAGES if name not in run)

    def as_data(self) -> dict[str, Any]:
        return {
            "scene": self.simulation.name,
            "design": self.simulation.design.name,
            "outputs": list(self.simulation.scene.outputs),
            "duration_s": round(self.duration_s, 7),
            "stages": [
                {
                    "name": s.name,
                    "states": s.states,
                    "evaluations": s.evaluations,
                    "cpu_ms": round(1e3 * s.cpu_s, 1),
                }
                for s in self.stages
            ],
            "left_out": list(self.left_out),
        }

    def as_text(self) -> list[str]:
        name = self.simulation.name
        total_s = sum(stage.cpu_s for stage in self.stages)
        lines = [
            f"{name} with {self.simulation.design.name}: outputs "
            f"{', '.join(self.simulation.scene.outputs)}"
        ]
        lines += [f"{'stage':27} {'states':>6} {'evaluations':>12} {'CPU ms':>9}"]
        lines += [
            f"{s.name:27} {s.states:6} {s.evaluations:12} {1e3 * s.cpu_s:9.1f}" for s in self.stages
        ]
        cost = f"about {total_s:.2g} s of CPU time, without start-up and writing"
        lines.append(
            f"{self.duration_s:.2f} s of {name}: {cost}, if all of it is like its first 0.8 s"
        )
        lines.append(f"left out, as neither scene nor outputs need it: {', '.join(self.left_out)}")
        scene = self.simulation.scene
        if (scene.knock if isinstance(scene, ManipulationFile) else scene.hold).trigger_v:
            lines.append("before all stages, load and sensor until trigger_v is reached")

        return lines


def plan_simulation(simulation: Simulation) -> SimulationPlan:
    """Find what a simulation will run and cost, by two chunks of it: the first one warms up.

    Raises TraceError.
    """
    design = simulation.design
    scene = simulation.scene
    seed = simulation.seed
    meter = CostMeter(time.process_time)
    chunks: Iterator[object]

    if isinstance(scene, ManipulationFile):
        stepper = start_manipulation(
            design,
            scene=scene,
            seed=seed,
            outputs=frozenset(scene.outputs),
            grid=None,
            meter=meter,
        )
        points = stepper.point_count
        duration_s = stepper.plan.duration_s
        chunks = advance_as_planned(stepper, TRIED_POINTS)
        is_compiled = False
    else:
        run = SceneRun(design, scene, seed, meter=meter)
        assert run.grid
        duration_s = run.timeline.duration_s
        points = run.grid.count_points(duration_s, design.detector.sample_rate_hz)
        chunks = run.chunks(TRIED_POINTS)
        is_compiled = run.predict_plain_s() > COMPILE_FROM_S and jit.available()

    with jit.compiled() if is_compiled else contextlib.nullcontext():
        next(chunks)
        before = {stage.name: stage for stage in meter.costs}
        next(chunks, None)

    stages = []
    tried = min(points, 2 * TRIED_POINTS)
    for stage in meter.costs:
        cpu_s = stage.cpu_s
        timed = tried
        if points > TRIED_POINTS:  # time the second chunk alone; a shorter scene has none
            cpu_s = cpu_s - before[stage.name].cpu_s
            timed = tried - TRIED_POINTS

        evaluations = round(stage.evaluations * points / tried)
        stages.append(StageCost(stage.name, stage.states, evaluations, cpu_s * points / timed))

    return SimulationPlan(simulation, duration_s, tuple(stages))
