"""Pad dragged under a given load: statics, steady sliding, rest, energy, error of a trial."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.pad.response import Backing, Pad
from fingertip.sim.contact import dragged_pad
from fingertip.sim.contact.dragged_pad import DraggedPad, Mount, PadMotion, integrate
from fingertip.sim.contact.friction import LOAD_SCALE_N, RELAX_PER_S, Friction, stribeck_fraction
from fingertip.sim.runs.timeline import TrapezoidalMove, build_timeline
from fingertip.sim.simulation import Trial
from tests.oracles.steady_friction import steady_coefficient, stribeck_coefficient

FRICTION = Friction(0.6, 0.48)
FORCE_N = 0.8
PAD = Pad.from_design(Design())
STIFFNESS = PAD.tangential_stiffness_n_per_m(FORCE_N)
MOUNT = Mount(
    PAD.backing.mass_kg,
    STIFFNESS,
    2 * Backing.damping_ratio * math.sqrt(STIFFNESS * PAD.backing.mass_kg),
)


def pull(
    speed_m_s: float,
    seconds: float,
    mount: Mount = MOUNT,
    friction: Friction = FRICTION,
    step_s: float = 1e-4,
) -> PadMotion:
    h = step_s
    time = np.arange(round(seconds / h)) * h
    return integrate(
        friction,
        mount,
        None,
        h,
        speed_m_s * time,
        np.full_like(time, speed_m_s),
        np.full_like(time, FORCE_N),
    )


@pytest.mark.parametrize("v", [-0.2, 0.0, 0.003, 0.08])
def test_fraction_is_the_stribeck_curve(v):
    friction = Friction(0.62, 0.5, 0.004)
    top, bottom = stribeck_fraction(friction.mu_c, friction.mu_s, v / friction.stribeck_m_s)
    assert top / bottom == pytest.approx(stribeck_coefficient(friction, v), rel=1e-14)


def test_breakaway_force_is_mu_s_times_load():
    # The pull is so slow that inertia and viscosity are negligible.
    motion = pull(2e-4, 4.0)
    stage = 2e-4 * np.arange(len(motion.position_m)) * 1e-4
    spring = STIFFNESS * (stage - motion.position_m)
    assert spring.max() == pytest.approx(FRICTION.mu_s * FORCE_N, rel=0.03)


@pytest.mark.parametrize("load_n", [FORCE_N, 0.0])
def test_pad_that_has_come_to_rest_takes_no_steps_until_its_drive_changes(monkeypatch, load_n):
    """Before the carriage moves, and after it, with the pad on bent bristles or in the air."""
    time = np.arange(20_000) * 1e-4
    move = TrapezoidalMove.with_speed(0.2, 0.01, 0.04)
    at_m = move.position_m(time)
    speed_m_s = move.velocity_m_s(time)
    load = np.where(time < 0.6, FORCE_N * np.minimum(time / 0.1, 1.0), load_n)
    pad = DraggedPad(FRICTION, MOUNT, None, 1e-4, FORCE_N)

    def drag(part: slice, max_steps: int) -> PadMotion:
        monkeypatch.setattr(dragged_pad, "MAX_STEPS", max_steps)
        return pad.process(at_m[part], speed_m_s[part], load[part])

    assert not drag(slice(0, 2000), 0).position_m.any()
    drag(slice(2000, 14_000), 1000)
    after = drag(slice(14_000, None), 0)
    assert np.ptp(after.position_m) == 0.0
    shear_n = STIFFNESS * (at_m[-1] - after.position_m[0])
    assert shear_n > 0.05 if load_n else abs(shear_n) < 1e-8
    at_m = at_m + 1e-5
    with pytest.raises(TraceError, match="more than 0 steps"):
        drag(slice(14_000, None), 0)


@pytest.mark.parametrize("speed", [0.02, 0.04, 0.08])
def test_steady_sliding_matches_closed_form(speed):
    motion = pull(speed, 1.0)
    shear = speed * (len(motion.position_m) - 1) * 1e-4 - motion.position_m[-1]
    g = 0.48 + 0.12 / (1 + (speed / 0.005) ** 2)
    assert motion.velocity_m_s[-1] == pytest.approx(speed, rel=1e-6)
    assert STIFFNESS * shear == pytest.approx(FORCE_N * (g + 0.6 * speed), rel=1e-6)
    assert steady_coefficient(FRICTION, speed) == pytest.approx(g + 0.6 * speed)
    assert steady_coefficient(FRICTION, -speed) == -steady_coefficient(FRICTION, speed)


def slide_trial(substeps: int, tolerance_n: float = 1e-6) -> np.ndarray:
    timeline = build_timeline(Design(), Trial().scene, PAD, FORCE_N)
    h = 1 / (2000 * substeps)
    time = np.arange(round(2.1 * 2000) * substeps + 1) * h
    motion = integrate(
        FRICTION,
        MOUNT,
        None,
        h,
        timeline.slide.position_m(time),
        timeline.slide.velocity_m_s(time),
        timeline.load_n(PAD, time),
        tolerance_n,
    )
    return motion.position_m[::substeps]


def test_force_of_a_trial_is_within_its_tolerance():
    error_n = STIFFNESS * np.abs(slide_trial(5) - slide_trial(40, 1e-9))
    assert error_n.max() < 2e-6


def test_bristles_relax_and_friction_vanishes_without_contact():
    h = 1e-4
    time = np.arange(6000) * h
    load = np.where(time < 0.3, FORCE_N, 0.0)
    stage = np.minimum(1e-3 * time, 1e-4)
    motion = integrate(FRICTION, MOUNT, None, h, stage, np.where(time < 0.1, 1e-3, 0.0), load)
    assert motion.bristle_m[2990] > 1e-6
    assert abs(motion.bristle_m[-1]) < 1e-9
    assert motion.position_m[-1] == pytest.approx(1e-4, rel=1e-4)
    decay = motion.bristle_m[3100:3200] / motion.bristle_m[3099:3199]
    assert decay == pytest.approx(math.exp(-RELAX_PER_S * h), rel=1e-4)


@pytest.mark.parametrize("ratio", [1, 2, 3])
def test_friction_is_passive_while_load_and_velocity_both_move(ratio):
    """With the mean deflection as state, as usual, friction would drive
    the pad at twice the frequency in the load.
    """
    # so stiff that the pad follows
    h = 1e-4
    stiff = 1e5
    mount = Mount(0.01, stiff, 2 * Backing.damping_ratio * math.sqrt(stiff * 0.01))
    angle = 2 * math.pi * 10 * np.arange(10_000) * h
    for phase in (0.0, 1.0, 2.0, 3.0):
        load = FORCE_N * (1 + 0.8 * np.sin(ratio * angle + phase))
        x = 1e-5 * (np.cos(angle) - 1)
        v = -1e-5 * 2 * math.pi * 10 * np.sin(angle)
        motion = integrate(FRICTION, mount, None, h, x, v, load)
        pull_n = mount.stiffness_n_per_m * (x - motion.position_m) + mount.damping_n_s_per_m * (
            v - motion.velocity_m_s
        )
        work = (
            np.cumsum(h * pull_n * motion.velocity_m_s) - mount.mass_kg * motion.velocity_m_s**2 / 2
        )
        stored = FRICTION.sigma0 * motion.bristle_m**2 * (load + LOAD_SCALE_N) / 2
        assert (work - stored).min() > -1e-8
