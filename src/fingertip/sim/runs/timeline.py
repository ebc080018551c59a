"""Timeline of a scene: the moments of its events, the motions that follow from them, and what
shakes the contact.

The motions are the force of the hand and the position of the carriage. Moves have trapezoidal
velocity profiles with the article's values (section III.C, figures 8 and 9). The formulas use only
sums, products, square and cube roots, so that every processor gives the same bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.contact.dragged_pad import (
    STATES,
    TOLERANCE_N,
    DraggedPad,
    Mount,
    NormalContact,
    PadMotion,
)
from fingertip.sim.contact.vibration import smoothstep, transmit
from fingertip.sim.runs.scene_and_manipulation_files import Motor, SceneFile, Slide, Tap
from fingertip.sim.signal.bridge import Bridge, reads_whole_finger
from fingertip.sim.signal.grid import CostMeter, Grid
from fingertip.sim.signal.parameters import ACCELERATION_M_S2, Sensing
from fingertip.sim.signal.simulated_finger import FingerDrive, FingerSetup

SLIDE_M = 0.04
LIFT_M = 0.05
"""Height by which the finger lifts at the end [m]."""
LIFT_S = 2.0
APPROACH_M = 0.01
"""Travel in air before the touch [m].
Assumption: half of the article's 2 cm. The other half presses the finger on.
"""
_TRIGGER_POINTS = 4001
"""Number of moments of the closing between which the trigger is sought: some 0.2 ms apart, on
straight lines.
"""
OPEN_S = 0.3
"""Time for which an open grasp is recorded before it closes [s]. Assumption."""


@dataclass(frozen=True)
class TrapezoidalMove:
    """Move between two standstills with a trapezoidal velocity profile.

    The velocity rises at constant acceleration, stays at its peak and falls. If the distance is too
    short to reach the requested speed, the profile is a triangle.
    """

    start_s: float
    distance_m: float
    acceleration_m_s2: float
    peak_m_s: float

    @classmethod
    def with_speed(
        cls,
        start_s: float,
        distance_m: float,
        speed_m_s: float,
        acceleration_m_s2: float = ACCELERATION_M_S2,
    ) -> TrapezoidalMove:
        """Build the move that reaches `speed_m_s`, where the distance allows it."""
        peak_m_s = min(speed_m_s, math.sqrt(acceleration_m_s2 * distance_m))
        return cls(start_s, distance_m, acceleration_m_s2, peak_m_s)

    @classmethod
    def with_duration(cls, start_s: float, distance_m: float, duration_s: float) -> TrapezoidalMove:
        """Build the move that takes `duration_s` [s].

        One that is shorter than a triangle accelerates more.
        """
        T = duration_s
        a = max(ACCELERATION_M_S2, 4 * distance_m / (T * T))
        return cls(
            start_s,
            distance_m,
            a,
            (a * T - math.sqrt(max(0.0, a * a * T * T - 4 * a * distance_m))) / 2,
        )

    @property
    def _ramp_s(self) -> float:
        return self.peak_m_s / self.acceleration_m_s2

    @property
    def _cruise_s(self) -> float:
        return max(0.0, self.distance_m / self.peak_m_s - self._ramp_s)

    @property
    def end_s(self) -> float:
        return self.start_s + 2 * self._ramp_s + self._cruise_s

    def velocity_m_s(self, time_s: Array) -> Array:
        a = self.acceleration_m_s2
        rising = a * (time_s - self.start_s)
        falling = a * (self.end_s - time_s)
        return np.clip(np.minimum(rising, falling), 0.0, self.peak_m_s)

    def position_m(self, time_s: Array) -> Array:
        """Distance travelled since the start [m]."""
        a = self.acceleration_m_s2
        v = self.peak_m_s
        ramp = self._ramp_s
        cruise = self._cruise_s
        t = time_s - self.start_s
        up = np.clip(t, 0.0, ramp)
        even = np.clip(t - ramp, 0.0, cruise)
        down = np.clip(t - ramp - cruise, 0.0, ramp)

        return a * up * up / 2 + v * even + (v * down - a * down * down / 2)


@dataclass(frozen=True)
class RepeatedMove:
    """Equal moves, with a pause after each but the last."""

    moves: tuple[TrapezoidalMove, ...]

    @property
    def start_s(self) -> float:
        return self.moves[0].start_s

    @property
    def end_s(self) -> float:
        return self.moves[-1].end_s

    def velocity_m_s(self, time_s: Array) -> Array:
        return sum((move.velocity_m_s(time_s) for move in self.moves), np.zeros_like(time_s))

    def position_m(self, time_s: Array) -> Array:
        return sum((move.position_m(time_s) for move in self.moves), np.zeros_like(time_s))


@dataclass(frozen=True)
class Timeline:
    """Moments [s] and moves of a scene."""

    scene: SceneFile
    force_n: float
    held_s: float
    """Moment at which the holding force is reached."""
    release_s: float
    duration_s: float
    slide: RepeatedMove | None
    approach: TrapezoidalMove | None
    """Approach of a finger that presses; None for a grasp."""
    lift: TrapezoidalMove | None
    """Lift at the end, if a pressing finger is released."""

    @property
    def moves(self) -> tuple[TrapezoidalMove, ...]:
        return self.slide.moves if self.slide else ()

    def push_n(self, time_s: Array, phases: tuple[float, float]) -> Array:
        """Forces of knocks, and of motors from the phases of their tones [rad], on the pad [N]."""
        tap = self.scene.tap
        motor = self.scene.motor
        push = np.zeros_like(time_s)
        if tap.force_n:
            push += _knock_force_n(tap, self.held_s, time_s)
        if motor.force_n:
            push += _motor_force_n(motor, phases, self.held_s, time_s)

        return push

    def load_n(self, pad: Pad, time_s: Array) -> Array:
        """Quasi-static normal force [N]."""
        hold = self.scene.hold
        change = self.scene.load_change

        if self.approach:
            depth = self.approach.position_m(time_s) - APPROACH_M
            load = pad.force_n(depth - self.lift.position_m(time_s) if self.lift else depth)
        else:
            load = self.force_n * smoothstep((time_s - OPEN_S) / hold.close_s)
            if hold.release:
                load = load - self.force_n * smoothstep((time_s - self.release_s) / hold.close_s)

        if change.by_n:
            # The change is a fraction of the force, so that it ends with the contact.
            fraction = (
                change.by_n
                / self.force_n
                * smoothstep((time_s - self.held_s - change.at_s) / change.rise_s)
            )
            load = load * (1 + fraction)

        return np.maximum(load, 0.0)


def find_trigger_s(
    design: Design,
    pad: Pad,
    sensing: Sensing,
    change_v: float,
    time_s: Array,
    force_n: Array,
) -> float:
    """Moment at which a growing force has moved the tactile voltage by so much [s].

    It is the last one if the force never does.
    """
    sensed_n = pad.sensed_n(force_n, None, reads_whole_finger(design, sensing.bridge))
    volts = Bridge.select(design, sensing.bridge).voltage_v(sensed_n)
    changes = np.maximum.accumulate(np.abs(volts - volts[0]))

    # The power of the bridge differs in its last digit.
    return round(float(np.interp(change_v, changes, time_s)), 6)


def build_timeline(design: Design, scene: SceneFile, pad: Pad, force_n: float) -> Timeline:
    """Set the moments of a scene whose holding force on this finger is `force_n` [N]."""
    hold = scene.hold
    slide = scene.slide
    approach = None
    closed_s = OPEN_S + hold.close_s

    if hold.mode == "press":
        # Approach and lift have the same speed (assumption: the article gives the duration of the
        # lift only).
        speed = TrapezoidalMove.with_duration(0.0, LIFT_M, LIFT_S).peak_m_s
        approach = TrapezoidalMove.with_speed(0.0, APPROACH_M + pad.depth_m(force_n), speed)
        closed_s = approach.end_s

    starts = closed_s
    if hold.trigger_v:
        time_s = np.linspace(0.0, closed_s, _TRIGGER_POINTS)
        load_n = Timeline(
            scene=scene,
            force_n=force_n,
            held_s=closed_s,
            release_s=closed_s,
            duration_s=closed_s,
            slide=None,
            approach=approach,
            lift=None,
        ).load_n(pad, time_s)
        starts = find_trigger_s(design, pad, scene.sensing, hold.trigger_v, time_s, load_n)

    sliding = _plan_slide(slide, starts + hold.wait_s) if slide.distance_m else None
    busy = max(
        closed_s + hold.min_s,
        sliding.end_s if sliding else closed_s,
        closed_s + _events_end_s(scene),
    )
    release = busy + hold.wait_s
    lift = None
    if hold.release and approach:
        lift = TrapezoidalMove.with_duration(release, LIFT_M, LIFT_S)

    end = release
    if lift:
        end = lift.end_s
    elif hold.release:
        end = release + hold.close_s

    return Timeline(
        scene=scene,
        force_n=force_n,
        held_s=closed_s,
        release_s=release,
        duration_s=end + hold.after_s,
        slide=sliding,
        approach=approach,
        lift=lift,
    )


def _plan_slide(slide: Slide, start_s: float) -> RepeatedMove:
    distance_m = slide.distance_m / slide.moves
    first = TrapezoidalMove.with_speed(
        start_s, distance_m, slide.speed_m_s, slide.acceleration_m_s2
    )
    period_s = first.end_s - start_s + slide.pause_s
    return RepeatedMove(
        tuple(replace(first, start_s=start_s + i * period_s) for i in range(slide.moves))
    )


def _events_end_s(scene: SceneFile) -> float:
    """Time from the moment the force is reached to the end of the last event [s]."""
    change = scene.load_change
    tap = scene.tap
    motor = scene.motor
    cable = scene.cable
    ends = [0.0]
    if change.by_n:
        ends.append(change.at_s + change.rise_s)
    if tap.force_n:
        ends.append(tap.at_s + (tap.count - 1) * tap.interval_s + 2 * tap.rise_s)
    if motor.force_n:
        ends.append(motor.at_s + motor.duration_s)
    if cable.step_v or cable.hum_v:
        ends.append(cable.at_s + cable.duration_s)

    return max(ends)


# Motion of a pad that a carriage drags over a surface, chunk by chunk.


def mount_pad(pad: Pad, force_n: float) -> Mount:
    k = pad.tangential_stiffness_n_per_m(force_n)
    behind = pad.backing
    return Mount(behind.mass_kg, k, 2 * behind.damping_ratio * math.sqrt(k * behind.mass_kg))


_ROUNDING_N = 1e-9
"""Error of a step below which rounding is larger [N]."""


def limit_error_n(grid: Grid) -> float:
    """Return the permitted error of a step [N].

    All errors fall with the step of the grid, as far as rounding permits.
    """
    return max(TOLERANCE_N / grid.refinement**2, _ROUNDING_N)


class UncoupledPad:
    """Pad on which vibration does not act back: the contact force follows elsewhere."""

    def __init__(
        self,
        setup: FingerSetup,
        grid: Grid,
        max_load_n: float,
        meter: CostMeter,
    ) -> None:
        self._meter = meter
        self._pad = DraggedPad(
            friction=setup.friction,
            mount=mount_pad(setup.pad, setup.held_n),
            normal=None,
            step_s=grid.step_s,
            max_pressing_n=max_load_n,
            tolerance_n=limit_error_n(grid),
        )

    def process(
        self,
        carriage_m: Array,
        carriage_m_s: Array,
        load_n: Array,
        push_n: Array | None,
    ) -> FingerDrive:
        """Follow the pad over the next points: position [m] and velocity [m/s] of the carriage, and
        forces [N].
        """
        with self._meter.stage("friction", 3):
            motion = self._pad.process(carriage_m, carriage_m_s, load_n)

        self._meter.add("friction", 3, motion.evaluations)
        return _describe(motion, carriage_m, load_n, push_n)


class CoupledPad:
    """Pad whose vibration acts back on friction.

    The profile is read along the path that results without that.
    """

    def __init__(
        self,
        setup: FingerSetup,
        grid: Grid,
        max_load_n: float,
        meter: CostMeter,
    ) -> None:
        pad = setup.pad
        held_n = setup.held_n
        mount = mount_pad(pad, held_n)
        self._first = DraggedPad(
            friction=replace(setup.friction, elastic=0.0),
            mount=mount,
            normal=None,
            step_s=grid.step_s,
            max_pressing_n=max_load_n,
            tolerance_n=limit_error_n(grid),
        )
        self._profile = setup.make_profile_force(grid.step_s)
        self._meter = meter
        hand_ratio = pad.backing.stiffness_n_per_m / pad.normal_stiffness_n_per_m(held_n)
        normal = NormalContact(pad.resonance_hz(held_n), pad.backing.damping_ratio, hand_ratio)
        self._contact = DraggedPad(
            friction=setup.friction,
            mount=mount,
            normal=normal,
            step_s=grid.step_s,
            max_pressing_n=max_load_n,
            tolerance_n=limit_error_n(grid),
        )

    def process(
        self,
        carriage_m: Array,
        carriage_m_s: Array,
        load_n: Array,
        push_n: Array | None,
    ) -> FingerDrive:
        """Follow the pad over the next points. The contact force is part of the result."""
        with self._meter.stage("coupled contact", STATES):
            first = self._first.process(carriage_m, carriage_m_s, load_n)
            pressing = load_n + self._profile.process(load_n, first.position_m)
            if push_n is not None:
                pressing = pressing + transmit(load_n) * push_n

            motion = self._contact.process(carriage_m, carriage_m_s, pressing)

        self._meter.add("coupled contact", STATES, first.evaluations + motion.evaluations)
        contact_n = np.where(load_n > 0.0, motion.force_n, 0.0)
        return _describe(motion, carriage_m, load_n, push_n, contact_n)


def _describe(
    motion: PadMotion,
    carriage_m: Array,
    load_n: Array,
    push_n: Array | None,
    contact_n: Array | None = None,
) -> FingerDrive:
    path_m = motion.position_m
    shear_m = carriage_m - motion.position_m
    return FingerDrive(
        load_n=load_n,
        push_n=push_n,
        push_jump_n=None,
        path_m=path_m,
        velocity_m_s=motion.velocity_m_s,
        bristle_m=motion.bristle_m,
        shear_m=shear_m,
        contact_n=contact_n,
    )


# Disturbances that are not slip: knocks and motors shake the contact.

MOTOR_RAMP_S = 0.02
"""Time in which the vibration of a motor starts and stops [s]. Assumption."""


def _knock_force_n(tap: Tap, held_s: float, time_s: Array) -> Array:
    """Force of the knocks [N]. Each one rises and falls as a smooth step."""
    total = np.zeros_like(time_s)
    for i in range(tap.count):
        t = (time_s - held_s - tap.at_s - i * tap.interval_s) / tap.rise_s
        total += smoothstep(t) - smoothstep(t - 1)

    return tap.force_n * total


def _motor_force_n(
    motor: Motor, phases: tuple[float, float], held_s: float, time_s: Array
) -> Array:
    """Force of the motors' vibration [N].

    Units: `phases` of fundamental and second harmonic [rad].
    """
    w = 2 * math.pi * motor.frequency_hz
    t = time_s - held_s - motor.at_s
    envelope = smoothstep(t / MOTOR_RAMP_S) - smoothstep((t - motor.duration_s) / MOTOR_RAMP_S + 1)
    force = np.zeros_like(t)
    _shake(w, phases, motor.harmonic, t, envelope, force)

    return motor.force_n * envelope * force


def _shake_loop(
    w: float,
    phases: tuple[float, float],
    harmonic: float,
    time: Floats,
    envelope: Floats,
    out: MutableFloats,
) -> None:
    """Sum both tones point by point: processors differ in the last bit of a vectorised sine."""
    first, second = phases
    for i in range(len(time)):
        if envelope[i] != 0.0:
            x = w * time[i]
            out[i] = math.sin(x + first) + harmonic * math.sin(2 * x + second)


_shake = CompiledLoop(_shake_loop, samples="time", plain_us=0.3)
