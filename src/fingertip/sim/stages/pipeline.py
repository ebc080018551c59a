"""Run a scene for a design: its stages from hand to comparator, and the recorded columns.

A scene without a slide has no friction state. A scene without vibration sources has no disturbance stage. Stages that
no recorded output depends on do not run (`fingertip.sim.stages.stage`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.sim.contact import coupled
from fingertip.sim.signal.comparator import describe_missing_comparator
from fingertip.sim.scene.scene_file import SceneFile
from fingertip.sim.stages import contact_stages, signal_stages
from fingertip.sim.stages.context import SceneContext
from fingertip.sim.stages.stage import Stage, StageStats, run_stages
from fingertip.slip.traces.trace import Trace

LONG_S = 15.0
"""Duration above which a scene reports its progress [s]."""


@dataclass(frozen=True, eq=False)
class SceneResult:
    """Recorded columns of a scene."""

    scene: SceneFile
    seed: int
    force_n: float
    """Holding force on this finger [N]."""
    time_s: Array
    """Times of the samples [s]."""
    columns: dict[str, Array]
    """Outputs that the scene names, in its order. The column slip holds booleans."""
    stages: tuple[StageStats, ...]
    """Stages that ran, with their cost."""

    @property
    def trace(self) -> Trace:
        """Trace for a detector: voltage, and the true force and slip that it is evaluated against.

        Raises
        ------
        TraceError
            If the voltage is not among the outputs of the scene.
        """
        if "voltage_v" not in self.columns:
            raise TraceError(Issue("outputs", "does not name voltage_v; a trace needs it."))
        slip = self.columns["slip"].astype(np.bool_) if "slip" in self.columns else None
        return Trace(self.time_s, self.columns["voltage_v"], self.columns.get("force_n"), slip)


def run_scene(
    design: Design, scene: SceneFile, seed: int = 0, progress: Callable[[str], None] | None = None
) -> SceneResult:
    """Simulate a scene, running only the stages that its outputs depend on.

    Parameters
    ----------
    design
        Gives the shape of the pad, the board, the ADC and its noise.
    scene
        Events, and outputs to record.
    seed
        Seed of force, surface, motors and noise. The same design, scene and seed give the same columns.
    progress
        Receives progress messages, for scenes longer than `LONG_S`.

    Raises
    ------
    TraceError
        If the seed is negative, or the board of this design has no such output.
    """
    if seed < 0:
        raise TraceError(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))
    if "slip_pin_v" in scene.outputs and design.board.variant != "comparator":
        raise TraceError(Issue("outputs", describe_missing_comparator(design)))
    context = SceneContext(design, scene, seed)
    is_long = context.timeline.duration_s > LONG_S
    if progress and is_long:
        progress(f"{scene.name}, {context.timeline.duration_s:.1f} s:")
    values, stats = run_stages(build_stages(scene), context, scene.outputs, progress if is_long else None)
    columns = {name: values[name] for name in scene.outputs}
    return SceneResult(scene, seed, context.force_n, context.time_s[context.samples], columns, tuple(stats))


def build_stages(scene: SceneFile) -> list[Stage[SceneContext]]:
    """Return all stages that this scene can have."""
    slides = scene.slide.distance_m > 0.0
    is_disturbed = scene.tap.force_n > 0.0 or scene.motor.force_n > 0.0
    disturbance = ("disturbance_n",) if is_disturbed else ()
    stages = [Stage[SceneContext]("load", (), ("load_n",), contact_stages.compute_load)]
    stages += _sliding_stages(scene, disturbance) if slides else [
        Stage("no motion", ("load_n",), ("slip", "velocity_m_s", "shear_m"), contact_stages.zero_motion)
    ]  # fmt: skip
    if is_disturbed:
        stages.append(Stage("disturbances", ("load_n",), ("disturbance_n",), contact_stages.compute_disturbances))
    if not (slides and scene.contact.feedback):
        needs = ("load_n", *(("profile_n",) if slides else ()), *disturbance)
        stages.append(Stage("contact", needs, ("contact_n",), contact_stages.compute_contact_force, 2))
    return stages + _signal_stages(scene, slides)


def _sliding_stages(scene: SceneFile, disturbance: tuple[str, ...]) -> list[Stage[SceneContext]]:
    """Stages of a scene with a slide: carriage, friction, surface profile and true slip."""
    needs: tuple[str, ...] = ("load_n", "carriage_m", "carriage_m_s")
    motion: tuple[str, ...] = ("position_m", "grid_velocity_m_s", "grid_bristle_m", "grid_shear_m")
    if scene.contact.feedback:
        friction: Stage[SceneContext] = Stage(
            "coupled contact", (*needs, *disturbance), (*motion, "contact_n"),
            contact_stages.integrate_with_feedback, coupled.STATES,
        )  # fmt: skip
    elif scene.contact.bristles == "elasto_plastic":
        integrate = contact_stages.integrate_friction_with_error_control
        friction = Stage("friction", needs, motion, integrate, coupled.STATES)
    else:
        friction = Stage("friction", needs, motion, contact_stages.integrate_friction, 3)
    truth = ("load_n", "grid_velocity_m_s", "grid_bristle_m")
    return [
        Stage("carriage", (), ("carriage_m", "carriage_m_s"), contact_stages.move_carriage),
        friction,
        Stage("profile", ("load_n", "position_m"), ("profile_n",), contact_stages.compute_profile_force, 1),
        Stage("slip", truth, ("slip", "velocity_m_s"), contact_stages.compute_true_slip),
        Stage("shear", ("grid_shear_m",), ("shear_m",), contact_stages.sample_shear),
    ]


def _signal_stages(scene: SceneFile, slides: bool) -> list[Stage[SceneContext]]:
    """Stages from the contact force to the voltages."""
    is_touched = scene.cable.step_v != 0.0 or scene.cable.hum_v != 0.0
    shear = ("grid_shear_m",) if slides else ()
    cable, jump = (("cable_v",), ("cable_jump_v",)) if is_touched else ((), ())
    board = ("filtered_v", "envelope_v")
    return [
        Stage("force", ("contact_n",), ("force_n",), contact_stages.sample_force),
        Stage("sensor", ("contact_n", *shear), ("sensor_n",), signal_stages.compute_sensor_force, 1),
        Stage("cable", (), ("cable_v", "cable_jump_v"), signal_stages.compute_cable_voltage),
        Stage("bridge", ("sensor_n", *cable), ("bridge_v",), signal_stages.compute_bridge_voltage),
        Stage("ADC", ("bridge_v",), ("voltage_v",), signal_stages.sample_voltage),
        Stage("board noise", ("bridge_v",), ("tactile_v",), signal_stages.add_board_noise),
        Stage("filter board", ("tactile_v", *jump), board, signal_stages.filter_on_board, 4),
        Stage("comparator", board, ("slip_pin_v",), signal_stages.compute_slip_pin, 1),
    ]
