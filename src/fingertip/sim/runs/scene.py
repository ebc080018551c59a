"""Run a scene: its events drive one finger, chunk by chunk.

A scene without a slide has no friction. Parts that no recorded output depends on do not run
(`fingertip.sim.signal.simulated_finger`).
"""

from __future__ import annotations

import contextlib
import functools
import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation import jit
from fingertip.foundation.errors import Issue, TraceError, checked, raise_issues
from fingertip.foundation.numerics import Array
from fingertip.foundation.progress import ReportProgress
from fingertip.pad.response import Pad
from fingertip.pad.touch import Pose
from fingertip.sim.contact.friction import ELASTO_PLASTIC, Friction
from fingertip.sim.contact.surface_files import SurfaceTable
from fingertip.sim.contact.surfaces import SurfaceProfile
from fingertip.sim.runs.scene_and_manipulation_files import DIRECTIONS, SceneFile
from fingertip.sim.runs.timeline import (
    CoupledPad,
    Timeline,
    UncoupledPad,
    build_timeline,
    mount_pad,
)
from fingertip.sim.runs.tremor_and_servo import HandMotion, largest_factor
from fingertip.sim.signal.grid import (
    BASE_HZ,
    CostMeter,
    Grid,
    StageCost,
    count_samples,
    report_share,
)
from fingertip.sim.signal.parameters import FILTER_OUTPUTS
from fingertip.sim.signal.simulated_finger import (
    OF_BRIDGE,
    OF_CONTACT,
    Finger,
    FingerDrive,
    FingerSetup,
    FingerSignals,
)
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import Interval, Origin, SlipCollector

COMPILE_FROM_S = 3.0
"""Time in plain Python from which a scene runs compiled [s].
Loading numba and the loops takes 0.8 s.
"""
_PLAIN_US = {
    "friction": 5.0,
    "coupled contact": 20.0,
    "shaking": 2.0,
    "bridge": 0.8,
    "ADC": 0.3,
    "board": 7.0,
    "comparator": 3.5,
}
"""Time per point in plain Python of each group of stages [us], measured once."""
MAX_PHASE = 0.5
"""Largest angle by which a stuck pad oscillates on its bristles in one step of the grid [rad]. Its
vibration is sampled at the points.
"""
CHUNK = 32_768
"""Number of points that are computed at a time: 3 s. A finger needs some 10 MB for them."""


@dataclass(frozen=True)
class SceneRecord:
    """Facts about a simulated scene, without its signals."""

    scene: SceneFile
    seed: int
    force_n: float
    samples: int
    slips: tuple[Interval, ...]
    """True slips; empty if the scene does not record them."""
    stages: tuple[StageCost, ...]
    sample_rate_hz: float
    pose: Pose
    sensor_share: float
    """Part of this force that reaches the sensor in this pose."""
    motion_s: float | None = None
    """Moment at which the robot begins to slide [s]; None if it does not."""
    out_of_contact_share: float = 0.0
    """Share of the true slip in which the pad does not touch.
    0 if the scene does not record slip and force.
    """
    clip_share: float | None = None
    """Share of the true slip in which the board clips.
    None if the scene records no slip, or nothing of the board.
    """
    step_s: float = Grid().step_s
    """Step of the grid on which it was computed [s]."""

    @property
    def duration_s(self) -> float:
        """Time of the last sample [s]."""
        return (self.samples - 1) / self.sample_rate_hz


@dataclass(frozen=True, eq=False)
class SceneResult(SceneRecord):
    """Recorded signals of a scene, and the facts about it."""

    signals: FingerSignals = field(kw_only=True)
    """Signals that the scene records; the others are None."""

    @property
    def time_s(self) -> Array:
        return self.signals.time_s

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Outputs that the scene names, in its order. The column slip holds booleans."""
        return select_columns(self.signals, self.scene)

    @property
    def trace(self) -> Trace:
        """Trace for a detector: voltage, and the force and slip that it is evaluated against.

        Raises TraceError.
        """
        signals = self.signals
        if signals.voltage_v is None:
            raise TraceError(Issue("outputs", "does not name voltage_v; a trace needs it."))

        return Trace(
            time_s=signals.time_s,
            voltage_v=signals.voltage_v,
            force_n=signals.force_n,
            slip=signals.slip,
            envelope_v=signals.sampled_envelope_v,
            filtered_v=signals.sampled_filtered_v,
            origin=Origin(True, self.motion_s, self.clip_share),
        )


def select_columns(signals: FingerSignals, scene: SceneFile) -> dict[str, NDArray[Any]]:
    return {name: getattr(signals, name) for name in scene.outputs}


@checked
@dataclass
class SceneRun:
    """Scene in progress: iterate over `chunks` once. Raises TraceError."""

    design: Design
    scene: SceneFile
    seed: int = 0
    grid: Grid | None = None
    meter: CostMeter = field(default_factory=CostMeter)

    def __post_init__(self) -> None:
        raise_issues(TraceError, self.scene.find_design_issues(self.design, self.seed))
        self.grid = self.grid or self._choose_grid()

    def _choose_grid(self) -> Grid:
        """Choose the base grid, refined where a light or stiff pad that sticks turns by more than
        `MAX_PHASE` in a step.
        """
        if not self.scene.slide.distance_m:
            return Grid()

        mount = mount_pad(self.pad, self.force_n)
        stiffness = mount.stiffness_n_per_m + self.max_load_n * self.friction.sigma0
        phase = math.sqrt(stiffness / mount.mass_kg) / BASE_HZ
        return Grid(max(1, math.ceil(phase / MAX_PHASE)))

    @functools.cached_property
    def force_n(self) -> float:
        """Holding force on this finger, drawn by the seed [N]."""
        hold = self.scene.hold
        force = (
            hold.min_force_n
            + (hold.max_force_n - hold.min_force_n) * self._open_random("force").random()
        )
        return force * hold.share if hold.mode == "grasp" else force

    @functools.cached_property
    def pad(self) -> Pad:
        return self.scene.draw_pad(self.design, self.seed)

    @functools.cached_property
    def surface(self) -> SurfaceTable:
        return self.scene.surface.complete(self.scene.contact.surface)

    @functools.cached_property
    def friction(self) -> Friction:
        contact = self.scene.contact
        friction = self.surface.friction
        if contact.stick_slip:
            friction = friction.with_stick_slip()

        return (
            replace(friction, elastic=ELASTO_PLASTIC)
            if contact.bristles == "elasto_plastic"
            else friction
        )

    @functools.cached_property
    def timeline(self) -> Timeline:
        return build_timeline(self.design, self.scene, self.pad, self.force_n)

    @functools.cached_property
    def hand_motion(self) -> HandMotion | None:
        scene = self.scene
        rng = self._open_random("hand")
        line = self.timeline
        return HandMotion.draw(
            scene.tremor,
            servo=scene.servo,
            rng=rng,
            force_n=self.force_n,
            held_s=line.held_s,
            duration_s=line.duration_s,
        )

    def make_profile(self) -> SurfaceProfile:
        return self._set_up().make_profile()

    @property
    def max_load_n(self) -> float:
        """Largest load on the pad, without vibration [N]."""
        scene, highest_n = self.scene, self.force_n + max(0.0, self.scene.load_change.by_n)
        return highest_n * largest_factor(scene.tremor, scene.servo, self.force_n)

    def predict_plain_s(self) -> float:
        assert self.grid
        contact = self.scene.contact
        outputs = frozenset(self.scene.outputs)
        slides = self.timeline.slide is not None
        runs = {
            "friction": slides,
            "coupled contact": slides and contact.feedback,
            "shaking": bool(outputs & OF_CONTACT),
            "bridge": bool(outputs & OF_BRIDGE),
            "ADC": "voltage_v" in outputs,
            "board": bool(outputs & FILTER_OUTPUTS),
            "comparator": "slip_pin_v" in outputs,
        }
        points = self.grid.count_points(
            self.timeline.duration_s, self.design.detector.sample_rate_hz
        )

        return 1e-6 * points * sum(_PLAIN_US[name] for name, does in runs.items() if does)

    def chunks(self, size: int = CHUNK) -> Iterator[FingerSignals]:
        """Yield the signals of one chunk after the other; the size of a chunk changes no bit."""
        assert self.grid
        count = self.grid.count_points(
            self.timeline.duration_s, self.design.detector.sample_rate_hz
        )
        outputs = frozenset(self.scene.outputs)
        slides = self.timeline.slide is not None
        setup = self._set_up()
        feedback = slides and self.scene.contact.feedback
        pad: CoupledPad | UncoupledPad | None = None

        if feedback:
            shaking_n = self.scene.tap.force_n + 2 * self.scene.motor.force_n
            pad = CoupledPad(setup, self.grid, self.max_load_n + shaking_n, self.meter)
        elif slides:
            pad = UncoupledPad(setup, self.grid, self.max_load_n, self.meter)

        finger = Finger(
            setup=setup,
            grid=self.grid,
            outputs=outputs,
            meter=self.meter,
            contact_is_given=feedback,
        )
        rng = self._open_random("motor")
        phases = 2 * math.pi * rng.random(), 2 * math.pi * rng.random()

        for first in range(0, count, size):
            time_s = self.grid.time_s(first, min(size, count - first))
            with self.meter.stage("load"):
                load_n = self.timeline.load_n(self.pad, time_s)
                if self.hand_motion:
                    load_n = load_n * self.hand_motion.factor(time_s)

            push_n = None
            if (feedback or outputs & OF_CONTACT) and (
                self.scene.tap.force_n or self.scene.motor.force_n
            ):
                with self.meter.stage("disturbances"):
                    push_n = self.timeline.push_n(time_s, phases)

            if pad is None:
                yield finger.process(FingerDrive(load_n, push_n))
                continue

            assert self.timeline.slide
            with self.meter.stage("carriage"):
                at_m = self.timeline.slide.position_m(time_s)
                speed_m_s = self.timeline.slide.velocity_m_s(time_s)

            yield finger.process(pad.process(at_m, speed_m_s, load_n, push_n))

    def _set_up(self) -> FingerSetup:
        scene, slides = self.scene, bool(self.scene.slide.distance_m)
        return FingerSetup(
            design=self.design,
            pad=self.pad,
            held_n=self.force_n,
            friction=self.friction,
            open_random=self._open_random,
            seed=(self.seed, "finger"),
            surface=self.surface if slides else None,
            profile_length_m=scene.slide.distance_m,
            towards_tip=DIRECTIONS[scene.slide.towards],
            patch_average=scene.contact.patch_average,
            path=scene,
            event_origin_s=self.timeline.held_s,
        )

    def _open_random(self, purpose: str) -> random.Random:
        """Random numbers for one purpose, so that setting the force changes neither the surface nor
        the motors.
        """
        return random.Random(f"{self.seed}:{purpose}")


def run_scene(
    design: Design,
    scene: SceneFile,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    grid: Grid | None = None,
) -> SceneResult:
    """Simulate a scene, running only the parts that its outputs depend on.

    The design gives the shape of the pad, the board, the ADC and its noise; the seed is that of
    force, surface, motors and noise. The same design, scene and seed give the same columns.
    `progress` receives messages of scenes longer than `progress.LONG_S`. Without a grid, the
    computation takes the base grid, refined where the pad needs it.

    Raises TraceError if the scene cannot be simulated with this design.
    """
    chunks: list[FingerSignals] = []
    record = stream_scene(design, scene, chunks.append, seed, progress, grid)
    return SceneResult(**vars(record), signals=FingerSignals.join(chunks))


def stream_scene(
    design: Design,
    scene: SceneFile,
    take: Callable[[FingerSignals], None],
    seed: int = 0,
    progress: ReportProgress | None = None,
    grid: Grid | None = None,
) -> SceneRecord:
    """Simulate a scene and hand its signals on, chunk by chunk, so that memory does not grow with
    its length.

    Loops run compiled where the scene would take longer than `COMPILE_FROM_S` in plain Python. The
    bits are the same. Raises TraceError.
    """
    run = SceneRun(design, scene, seed, grid)
    slips = SlipCollector()
    slipping = airborne = clipping = 0
    is_clipping_known = False
    done = report_share(scene.name, run.timeline.duration_s, progress)
    chunks = run.chunks()

    with jit.compiled() if run.predict_plain_s() > COMPILE_FROM_S else contextlib.nullcontext():
        for chunk in chunks:
            if chunk.slip is not None:
                slips.add(chunk.time_s, chunk.slip)
                slipping += int(np.count_nonzero(chunk.slip))
                if chunk.clips is not None:
                    is_clipping_known = True
                    clipping += int(np.count_nonzero(chunk.clips & chunk.slip))

                if chunk.force_n is not None:
                    airborne += int(np.count_nonzero(chunk.force_n[chunk.slip] <= 0.0))

            take(chunk)
            done(float(chunk.time_s[-1]) if len(chunk.time_s) else 0.0)

    rate = design.detector.sample_rate_hz
    slide = run.timeline.slide
    motion_s = slide.start_s if slide else None
    share = (float(run.pad.sensed_n(np.array([run.force_n]))[0]) - run.pad.rest_n) / run.force_n
    pose = scene.draw_pose(run.design, seed)
    costs = run.meter.costs
    count = count_samples(run.timeline.duration_s, rate)
    assert run.grid
    lost = airborne / max(1, slipping)
    clips = clipping / slipping if is_clipping_known and slipping else None

    return SceneRecord(
        scene=scene,
        seed=seed,
        force_n=run.force_n,
        samples=count,
        slips=slips.close(),
        stages=costs,
        sample_rate_hz=rate,
        pose=pose,
        sensor_share=share,
        motion_s=motion_s,
        out_of_contact_share=lost,
        clip_share=clips,
        step_s=run.grid.step_s,
    )
