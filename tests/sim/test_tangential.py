"""Tangential contact: statics, steady sliding, energy, order of the
method, comparison with an independent solver.
"""

from __future__ import annotations

import math
import random
import re
from itertools import pairwise

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compiled
from fingertip.pad.response import Backing, Pad
from fingertip.sim.contact.friction import (
    LOAD_SCALE_N,
    RELAX_PER_S,
    Friction,
    stribeck,
    stribeck_fraction,
)
from fingertip.sim.contact.tangential import DraggedPad, Mount, PadMotion, admissible_step_s
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
    return DraggedPad(friction, mount, h).process(
        speed_m_s * time, np.full_like(time, speed_m_s), np.full_like(time, FORCE_N)
    )


@pytest.mark.parametrize("v", [-0.2, 0.0, 0.003, 0.08])
def test_both_forms_of_the_stribeck_curve_are_the_same_law(v):
    friction = Friction(0.62, 0.5, 0.004)
    step = 1e-7
    g, slope = stribeck(friction.curve, v)
    top, bottom = stribeck_fraction(friction.mu_c, friction.mu_s, v / friction.stribeck_m_s)
    assert g == pytest.approx(stribeck_coefficient(friction, v), rel=1e-14)
    assert top / bottom == pytest.approx(g, rel=1e-14)
    above, below = (stribeck_coefficient(friction, at) for at in (v + step, v - step))
    assert slope == pytest.approx((above - below) / (2 * step), rel=1e-5, abs=1e-8)


def test_breakaway_force_is_mu_s_times_load():
    # The pull is so slow that inertia and viscosity are negligible.
    motion = pull(2e-4, 4.0)
    stage = 2e-4 * np.arange(len(motion.position_m)) * 1e-4
    spring = STIFFNESS * (stage - motion.position_m)
    assert spring.max() == pytest.approx(FRICTION.mu_s * FORCE_N, rel=0.03)


@pytest.mark.parametrize("whole", [True, False])
def test_pad_that_nothing_has_moved_rests_without_steps_of_its_own(whole):
    """With the load changing meanwhile; the next steps have the bits of a pad that begins then."""
    rest = 500
    time = np.arange(3000) * 1e-4
    load = FORCE_N * (1 + 0.5 * np.sin(20 * time))
    carriage_m = 0.01 + np.concatenate((np.zeros(rest), 0.04 * time[: len(time) - rest]))
    speed_m_s = np.where(np.arange(len(time)) > rest, 0.04, 0.0)
    pad = DraggedPad(FRICTION, MOUNT, 1e-4)
    cuts = [0, 3000] if whole else [0, 100, 500, 501, 3000]
    parts = [pad.process(carriage_m[a:b], speed_m_s[a:b], load[a:b]) for a, b in pairwise(cuts)]
    late = DraggedPad(FRICTION, MOUNT, 1e-4).process(
        carriage_m[rest:], speed_m_s[rest:], load[rest:]
    )
    for name in ("position_m", "velocity_m_s", "bristle_m"):
        found = np.concatenate([getattr(part, name) for part in parts])
        assert found[rest:].tobytes() == getattr(late, name).tobytes()
        assert (
            found[:rest].tobytes() == np.full(rest, 0.01 if name == "position_m" else 0.0).tobytes()
        )


@pytest.mark.parametrize("speed", [0.02, 0.04, 0.08])
def test_steady_sliding_matches_closed_form(speed):
    motion = pull(speed, 1.0)
    shear = speed * (len(motion.position_m) - 1) * 1e-4 - motion.position_m[-1]
    g = 0.48 + 0.12 / (1 + (speed / 0.005) ** 2)
    assert motion.velocity_m_s[-1] == pytest.approx(speed, rel=1e-6)
    assert STIFFNESS * shear == pytest.approx(FORCE_N * (g + 0.6 * speed), rel=1e-6)
    assert steady_coefficient(FRICTION, speed) == pytest.approx(g + 0.6 * speed)
    assert steady_coefficient(FRICTION, -speed) == -steady_coefficient(FRICTION, speed)


def slide_trial(substeps: int, seconds: float = 2.1) -> PadMotion:
    timeline = build_timeline(Design(), Trial().scene, PAD, FORCE_N)
    h = 1 / (2000 * substeps)
    time = np.arange(round(seconds * 2000) * substeps + 1) * h
    motion = DraggedPad(FRICTION, MOUNT, h).process(
        timeline.slide.position_m(time),
        timeline.slide.velocity_m_s(time),
        timeline.load_n(PAD, time),
    )
    every = slice(None, None, substeps)
    return PadMotion(motion.position_m[every], motion.velocity_m_s[every], motion.bristle_m[every])


def test_halving_the_step_quarters_the_error():
    reference = slide_trial(64)
    errors = [
        float(np.abs(slide_trial(n).velocity_m_s - reference.velocity_m_s).max())
        for n in (2, 4, 8, 16)
    ]
    assert errors[1] < 5e-6  # step of a trial
    for coarse, fine in pairwise(errors):
        assert 3.3 < coarse / fine < 5.0


def test_bristles_relax_and_friction_vanishes_without_contact():
    h = 1e-4
    time = np.arange(6000) * h
    load = np.where(time < 0.3, FORCE_N, 0.0)
    stage = np.minimum(1e-3 * time, 1e-4)
    motion = DraggedPad(FRICTION, MOUNT, h).process(stage, np.where(time < 0.1, 1e-3, 0.0), load)
    assert motion.bristle_m[2990] > 1e-6
    assert abs(motion.bristle_m[-1]) < 1e-9
    assert motion.position_m[-1] == pytest.approx(1e-4, rel=1e-4)
    decay = motion.bristle_m[3100:3200] / motion.bristle_m[3099:3199]
    assert decay == pytest.approx(math.exp(-RELAX_PER_S * h), rel=1e-4)


@pytest.mark.every_case
@pytest.mark.parametrize("sigma0", [1e6, 1e7, 1e8, 1e9])
@pytest.mark.parametrize("mass_kg", [1e-2, 1e-4, 1e-5])
def test_step_too_long_for_the_bristles_is_refused_with_a_step_that_passes(sigma0, mass_kg):
    friction = Friction(0.6, 0.48, sigma0=sigma0)
    mount = Mount(mass_kg, STIFFNESS, 0.5)
    with pytest.raises(TraceError, match="is too long for bristles of") as caught:
        pull(0.04, 0.1, mount, friction)
    longest = float(re.search(r"choose at most (\S+) s", str(caught.value)).group(1))
    assert 0.98 < longest / admissible_step_s(friction, mount, FORCE_N) <= 1.0
    assert np.isfinite(pull(0.04, 2000 * longest, mount, friction, longest).velocity_m_s).all()
    with pytest.raises(TraceError):
        pull(0.04, 2000 * longest, mount, friction, longest * 1.02)


def random_contact(rng: random.Random) -> tuple[Friction, Mount, float, float]:
    k = 10 ** rng.uniform(2.5, 4)
    mass_kg = 10 ** rng.uniform(-4, -2)
    friction = Friction(0.6, 0.48, 10 ** rng.uniform(-3, -1.3), 10 ** rng.uniform(4, 8))
    mount = Mount(mass_kg, k, 2 * Backing.damping_ratio * math.sqrt(k * mass_kg))
    return friction, mount, 10 ** rng.uniform(-0.7, 0.6), rng.choice([0.01, 0.04, 0.08])


@pytest.mark.full
def test_error_up_to_the_longest_admissible_step():
    """Starts from rest, under a load that swings by 30 %, against steps 32 times shorter."""
    rng = random.Random(5)
    errors = []
    with compiled():
        for _ in range(60):
            friction, mount, load, speed = random_contact(rng)
            step = admissible_step_s(friction, mount, 1.3 * load)
            found = {}
            for parts in (1, 32, 64):
                time = np.arange(parts * round(min(0.15, 4000 * step) / step) + 1) * (step / parts)
                carriage = TrapezoidalMove.with_speed(0.01, 0.04, speed)
                normal = load * (1 + 0.3 * np.sin(2 * math.pi * 5 * time))
                at = carriage.position_m(time)
                motion = DraggedPad(friction, mount, step / parts).process(
                    at, carriage.velocity_m_s(time), normal
                )
                found[parts] = (mount.stiffness_n_per_m * (at - motion.position_m) / load)[::parts]
            assert np.abs(found[32] - found[64]).max() < 1e-4
            errors.append(np.abs(found[1] - found[64]).max())
    assert np.quantile(errors, 0.9) < 5e-4
    assert max(errors) < 5e-3


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
        motion = DraggedPad(FRICTION, mount, h).process(x, v, load)
        pull_n = mount.stiffness_n_per_m * (x - motion.position_m) + mount.damping_n_s_per_m * (
            v - motion.velocity_m_s
        )
        work = (
            np.cumsum(h * pull_n * motion.velocity_m_s) - mount.mass_kg * motion.velocity_m_s**2 / 2
        )
        stored = FRICTION.sigma0 * motion.bristle_m**2 * (load + LOAD_SCALE_N) / 2
        assert (work - stored).min() > -1e-8
