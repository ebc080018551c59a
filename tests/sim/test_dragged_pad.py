"""Dragged pad: comparison with scipy, and stiff or
extreme cases.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compiled
from fingertip.sim.contact import dragged_pad, dragged_pad_loop
from fingertip.sim.contact.dragged_pad import (
    DraggedPad,
    Mount,
    NormalContact,
    PadMotion,
    integrate,
)
from fingertip.sim.contact.dragged_pad_loop import bristle_rate, normal_rate
from fingertip.sim.contact.friction import (
    ELASTO_PLASTIC,
    GROSS_SLIP_M_S,
    LOAD_SCALE_N,
    RELAX_PER_S,
    Friction,
)
from fingertip.sim.runs.timeline import TrapezoidalMove
from tests.first_set import FULL
from tests.oracles.steady_friction import steady_coefficient

FORCE_N = 0.8
STIFFNESS = 3391.0
MOUNT = Mount(0.01713, STIFFNESS, 2 * 0.15 * math.sqrt(STIFFNESS * 0.01713))
FRICTION = Friction(0.6, 0.48)
NORMAL = NormalContact(90.0, 0.15)
RATE_HZ = 2000.0


def grid(seconds: float, rate_hz: float = RATE_HZ) -> np.ndarray:
    return np.arange(round(seconds * rate_hz) + 1) / rate_hz


def slide(friction=FRICTION, mount=MOUNT, tolerance=1e-6) -> PadMotion:
    """Rest for 0.2 s, then slide by 4 cm, under an oscillating load that keeps contact."""
    time = grid(1.4)
    ramp = TrapezoidalMove.with_speed(0.2, 0.04, 0.04)
    drive = (
        ramp.position_m(time),
        ramp.velocity_m_s(time),
        FORCE_N * (1 + 0.1 * np.sin(2 * math.pi * 53 * time)),
    )
    return integrate(friction, mount, NORMAL, 1 / RATE_HZ, *drive, tolerance)


@pytest.mark.full
@pytest.mark.parametrize("normal", [NORMAL, None], ids=["resonance", "given"])
def test_motion_agrees_with_scipy_radau(normal):
    """scipy solves an independent copy of the equations and restarts at the kinks of the drive."""
    from scipy.integrate import solve_ivp

    f = FRICTION
    omega = 2 * math.pi * 90
    until = 0.4
    time = grid(until)
    ramp = TrapezoidalMove.with_speed(0.05, 0.04, 0.04)
    load = FORCE_N * (1 + 0.1 * time / until)
    ours = integrate(
        f, MOUNT, normal, 1 / RATE_HZ, ramp.position_m(time), ramp.velocity_m_s(time), load, 1e-9
    )

    def rates(t, s):
        x, v, bristles, y, w = s
        pressing = FORCE_N * (1 + 0.1 * t / until)
        if normal is None:
            y = pressing
        g = f.mu_c + (f.mu_s - f.mu_c) / (1 + (v / f.stribeck_m_s) ** 2)
        root = math.sqrt(y + LOAD_SCALE_N)
        z = bristles / root
        rate = y / root * (v - f.sigma0 * abs(v) * z / g)
        at = np.array([t])
        pull = STIFFNESS * (ramp.position_m(at)[0] - x) + MOUNT.damping_n_s_per_m * (
            ramp.velocity_m_s(at)[0] - v
        )
        dv = (pull - y * (f.sigma0 * z + f.sigma1 * rate / root + f.sigma2 * v)) / MOUNT.mass_kg
        return [v, dv, rate, w, omega**2 * (pressing - y) - 0.3 * omega * w]

    state = [0.0, 0.0, 0.0, FORCE_N, 0.0]
    worst = 0.0
    for start, end in pairwise((0.0, 0.05, 0.09, until)):
        at = (time > start + 1e-9) & (time < end + 1e-9)
        part = solve_ivp(
            rates, (start, end), state, "Radau", time[at], rtol=1e-9, atol=1e-13, max_step=2e-3
        )
        state = part.y[:, -1]
        worst = max(worst, float(np.abs(part.y[1] - ours.velocity_m_s[at]).max()))
        force = part.y[3] if normal else load[at]
        assert np.abs(force - ours.force_n[at]).max() < 1e-7
        assert np.abs(part.y[2] / np.sqrt(force + LOAD_SCALE_N) - ours.bristle_m[at]).max() < 1e-11
    assert worst < 2e-7


def test_elastic_bending_is_not_slip():
    """A pad that is tugged and released moves faster than gross
    slip and returns: only its bristles bent.
    """
    friction = Friction(0.6, 0.48, elastic=ELASTO_PLASTIC)
    time = grid(0.3)
    tug = np.where((time > 0.02) & (time < 0.04), np.sin(math.pi * (time - 0.02) / 0.02) ** 2, 0.0)
    load = np.full_like(time, FORCE_N)
    moved = integrate(
        friction, MOUNT, NORMAL, 1 / RATE_HZ, 5e-5 * tug, np.gradient(5e-5 * tug, 1 / RATE_HZ), load
    )
    assert np.abs(moved.velocity_m_s).max() > 1.2 * GROSS_SLIP_M_S
    assert np.abs(moved.position_m[-1]) < 1e-3 * np.abs(moved.position_m).max()
    assert not friction.sliding_speed_m_s(moved.velocity_m_s, moved.bristle_m).any()


@pytest.mark.full
def test_tolerance_is_an_error_in_newtons():
    reference = slide(tolerance=1e-11)
    pull = [
        STIFFNESS * np.abs(slide(tolerance=t).position_m - reference.position_m).max()
        for t in (1e-6, 1e-7, 1e-8)
    ]
    assert pull[0] < 5e-6
    assert pull[1] < 5e-7
    assert pull[2] < 5e-8


@pytest.mark.every_case
@pytest.mark.parametrize("elastic", [0.0, ELASTO_PLASTIC])
@pytest.mark.parametrize("mass_kg", [MOUNT.mass_kg, 1e-5])
@pytest.mark.parametrize(
    "stiff",
    [
        {"sigma0": 1e8},
        {"stribeck_m_s": 1e-5},
        {"sigma0": 1e8, "stribeck_m_s": 1e-5},
        {"sigma0": 1.0},
    ],
    ids=str,
)
def test_stiff_bristles_and_light_pads_slide_steadily(stiff, mass_kg, elastic):
    friction = Friction(0.6, 0.48, elastic=elastic, **stiff)
    mount = Mount(mass_kg, STIFFNESS, MOUNT.damping_n_s_per_m)
    with compiled():
        found = slide(friction, mount)
    middle = round(0.8 * RATE_HZ)
    assert found.evaluations < 300_000
    assert np.isfinite(found.position_m).all()
    assert np.abs(found.velocity_m_s).max() < 0.15
    # Such soft bristles deflect by 0.5 m, so they never break loose within 4 cm.
    if stiff != {"sigma0": 1.0}:
        assert found.velocity_m_s[middle - 400 : middle + 400].mean() == pytest.approx(
            0.04, rel=0.02
        )
        assert found.position_m[-1] == pytest.approx(0.04, abs=3e-4)
        # Friction, measured by the spring, against the closed form.
        time = grid(1.4)
        shear = TrapezoidalMove.with_speed(0.2, 0.04, 0.04).position_m(time) - found.position_m
        mu = STIFFNESS * shear[middle - 400 : middle + 400].mean() / FORCE_N
        assert mu == pytest.approx(steady_coefficient(friction, 0.04), rel=0.02)


def test_resting_carriage_leaves_the_pad_exactly_at_rest():
    still = np.zeros(401)
    found = integrate(FRICTION, MOUNT, NORMAL, 1 / RATE_HZ, still, still, still + FORCE_N)
    assert not found.velocity_m_s.any()
    assert not found.position_m.any()
    assert np.abs(found.force_n - FORCE_N).max() < 1e-12
    assert found.steps == 400
    nothing = integrate(FRICTION, MOUNT, NORMAL, 1 / RATE_HZ, still, still, still)
    assert not nothing.force_n.any()


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7])
def test_impulse_response_matches_the_linear_resonance(tolerance):
    """The linear contact responds to 100 N for 1 ms like to an impulse."""
    from scipy.signal import fftconvolve

    time = grid(0.3)
    # 3 samples: a trapezoid of 1.5 ms area.
    knock = FORCE_N + np.where(np.abs(time - 0.1) < 0.75e-3, 100.0, 0.0)
    still = np.zeros_like(time)
    with compiled():
        found = integrate(FRICTION, MOUNT, NORMAL, 1 / RATE_HZ, still, still, knock, tolerance)
    omega = 2 * math.pi * 90
    zeta = 0.15
    fine = np.arange(0, 0.05, 1e-6)
    wd = omega * math.sqrt(1 - zeta**2)
    impulse = omega**2 / wd * np.exp(-zeta * omega * fine) * np.sin(wd * fine)
    drive = np.interp(fine, time[190:230] - time[190], knock[190:230] - FORCE_N)
    peak = FORCE_N + fftconvolve(drive, impulse)[: len(fine)].max() * 1e-6
    assert found.force_n.max() == pytest.approx(peak, rel=2e-3)
    assert found.force_n[round(0.13 * RATE_HZ) :].max() < peak


@pytest.mark.parametrize("rate", [2000.0, 8000.0])
def test_creep_below_breakaway_comes_from_the_model(rate):
    """Plain bristles creep under vibration, by the same amount at four times the rate.

    Elasto-plastic ones do not.
    """
    time = grid(3.0, rate)
    hold = 0.5 * FRICTION.mu_c * FORCE_N / STIFFNESS
    shaking = np.where(time > 0.3, 0.3 * hold, 0.0)
    angle = 2 * math.pi * 40 * (time - 0.3)
    stage = hold * np.clip(time / 0.2, 0, 1) + shaking * np.sin(angle)
    speed = np.where(time < 0.2, hold / 0.2, 0.0) + shaking * 2 * math.pi * 40 * np.cos(angle)
    creep = {}
    for elastic in (0.0, ELASTO_PLASTIC):
        friction = Friction(0.6, 0.48, elastic=elastic)
        with compiled():
            run = integrate(
                friction, MOUNT, NORMAL, 1 / rate, stage, speed, np.full_like(time, FORCE_N), 1e-9
            )
        creep[elastic] = (run.position_m[-1] - run.position_m[-1 - round(rate)]) / 40
    assert creep[0.0] == pytest.approx(1.264e-8, rel=0.01)  # metres per cycle
    assert abs(creep[ELASTO_PLASTIC]) < creep[0.0] / 300


def loop_parameters(f: Friction) -> tuple[tuple[float, ...], tuple[float, ...]]:
    curve = f.mu_c, f.mu_s, 1 / f.stribeck_m_s, f.elastic
    return curve, (f.sigma0, f.sigma1, f.sigma2, RELAX_PER_S, LOAD_SCALE_N)


def compute_rates(
    curve, sigma, mount, normal, pull, d, x, v, s, y, w
) -> tuple[float, float, float]:
    """Right-hand sides dv/dt, ds/dt and dw/dt; `pull` is (k X + c_m
    V) / m, `mount` holds k / m, c_m / m, 1 / m.
    """
    s0, s1, s2, _, n0 = sigma
    k_m, c_m, per_m = mount
    load = y if y > 0.0 else 0.0
    scale = 1 / math.sqrt(load + n0)
    ds = bristle_rate(curve, sigma, load, scale, v, s)
    dv = pull - k_m * x - c_m * v - load * per_m * (s0 * scale * s + s1 * scale * ds + s2 * v)
    return dv, ds, normal_rate(normal, d, y, w)


def draw_friction(rng: np.random.Generator, elastic: float) -> Friction:
    """Draw a surface whose bristle damping is at 90 to 99 % of the bound of passivity."""
    mu_c = rng.uniform(0.1, 1.0)
    sigma2 = rng.uniform(0.1, 1.0)
    mu_s = mu_c * rng.uniform(1.05, 1.6)
    sigma1 = rng.uniform(0.9, 0.99) * sigma2 * mu_c / (mu_s - mu_c)
    return Friction(
        mu_s, mu_c, 10 ** rng.uniform(-3, -2), 10 ** rng.uniform(4, 4.7), sigma1, sigma2, elastic
    )


@pytest.mark.parametrize("elastic", [0.0, ELASTO_PLASTIC])
def test_jacobian_agrees_with_finite_differences(elastic):
    """Also in flight, next to the loss of contact, and with both signs of velocity and
    deflection.
    """
    rng = np.random.default_rng(5)
    mount = (900.0 / 0.002, 0.3 / 0.002, 1 / 0.002)
    normal = (570.0**2, 170.0, 0.02, 24.0)
    yielding = 0
    for case in range(2000 if FULL else 200):
        curve, sigma = loop_parameters(draw_friction(rng, elastic))
        y = (rng.uniform(0.01, 3.0), rng.uniform(2e-5, 9.9e-4), rng.uniform(-1.0, -0.01))[case % 3]
        v = rng.choice([-1, 1]) * 10 ** rng.uniform(-4, -1)
        s = rng.uniform(-1.2, 1.2) * curve[0] / sigma[0] * math.sqrt(max(y, 0.0) + LOAD_SCALE_N)
        state = np.array([1e-4, v, s, y, 3.0])
        given = curve, sigma, mount, normal, 90.0, 0.7
        found = dragged_pad_loop.linearise(*given, *state)
        assert found[:3] == pytest.approx(compute_rates(*given, *state), rel=1e-12, abs=1e-12)
        J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, J_wy, J_ww = found[3:]
        expected = np.array(
            [
                [-mount[0], J_vv, J_vs, J_vy, 0.0],
                [0.0, J_sv, J_ss, J_sy, 0.0],
                [0.0, 0.0, 0.0, J_wy, J_ww],
            ]
        )
        scale = np.array([1e-4, abs(v), 1e-5, max(abs(y), 1e-3), 1.0])
        differences = np.empty((3, 5))
        for i in range(5):
            h = 1e-5 * scale[i] * np.eye(5)[i]
            ahead, behind = (
                np.array(compute_rates(*given, *(state + sign * h))) for sign in (1, -1)
            )
            differences[:, i] = (ahead - behind) / (2 * h[i])
        size = np.abs(expected * scale).max(axis=1, keepdims=True) + 1e-12
        assert (np.abs(differences - expected) * scale / size).max() < 1e-4, (case, state)
        yielding += (
            elastic > 0.0 and 0.0 < expected[1, 1] * math.sqrt(max(y, 0.0) + LOAD_SCALE_N) < 0.9 * y
        )
    assert yielding > case / 100 or not elastic


@pytest.mark.parametrize("chunk", [1, 2, 7, 1000])
@pytest.mark.parametrize("elastic", [0.0, ELASTO_PLASTIC])
@pytest.mark.parametrize("normal", [NORMAL, None], ids=["resonance", "given"])
def test_any_chunks_give_the_same_bits(normal, elastic, chunk):
    """Also across flights, stick and slip, and when the first chunks are single samples."""
    friction = Friction(0.6, 0.48, elastic=elastic)
    time = grid(0.5)
    ramp = TrapezoidalMove.with_speed(0.1, 0.01, 0.04)
    load = np.maximum(
        FORCE_N + 1.5 * np.sin(2 * math.pi * 70 * time), 0.0 if normal is None else -9
    )
    drive = ramp.position_m(time), ramp.velocity_m_s(time), load
    whole = integrate(friction, MOUNT, normal, 1 / RATE_HZ, *drive)
    assert 0.1 < (whole.force_n == 0.0).mean() < 0.9
    contact = DraggedPad(friction, MOUNT, normal, 1 / RATE_HZ, float(load.max()))
    cuts = [0, 1, *range(2, len(time), chunk), len(time)]
    parts = [contact.process(*(column[a:b] for column in drive)) for a, b in pairwise(cuts)]
    for name in ("position_m", "velocity_m_s", "bristle_m", "force_n"):
        assert np.array_equal(
            np.concatenate([getattr(part, name) for part in parts]), getattr(whole, name)
        ), name
    assert sum(part.steps for part in parts) == whole.steps
    assert sum(part.rejected for part in parts) == whole.rejected


def test_chunk_that_fails_leaves_the_state_as_it_was(monkeypatch):
    time = grid(0.2)
    ramp = TrapezoidalMove.with_speed(0.05, 0.01, 0.04)
    drive = ramp.position_m(time), ramp.velocity_m_s(time), np.full_like(time, FORCE_N)
    first = [column[:150] for column in drive]
    second = [column[150:] for column in drive]
    contact = DraggedPad(FRICTION, MOUNT, NORMAL, 1 / RATE_HZ, FORCE_N)
    contact.process(*first)
    with monkeypatch.context() as patch:
        patch.setattr(dragged_pad, "MAX_STEPS", 0)
        with pytest.raises(
            TraceError, match=r"sample 150: needs more than 0 steps .* choose a larger tolerance_n"
        ):
            contact.process(*second)
    expected = integrate(FRICTION, MOUNT, NORMAL, 1 / RATE_HZ, *drive).position_m[150:]
    assert np.array_equal(contact.process(*second).position_m, expected)


def test_few_steps_are_rejected():
    """A wrong coefficient or solution shows first as repeatedly rejected steps."""
    found = slide()
    assert found.steps < 3.2 * 2800
    assert found.rejected < 0.2 * found.steps
    assert found.evaluations == 3 * (found.steps + found.rejected)
    tight = slide(tolerance=1e-8)
    assert tight.steps < 4 * found.steps  # order 3 of the estimate: 100^(1/4) = 3.2


@pytest.mark.parametrize("normal", [NormalContact(90.0, 0.3), None], ids=["resonance", "given"])
def test_equal_steps_have_order_4(normal):
    """A drive that is exact between samples, a pad that moves forward
    only, and a tolerance that allows any step.
    """
    mount = Mount(0.035, 1500.0, 10.0)

    def forces_at_end(samples: int, tolerance_n: float) -> np.ndarray:
        t = np.arange(samples + 1) * (0.01 / samples)
        found = integrate(
            FRICTION,
            mount,
            normal,
            t[1],
            0.04 * t,
            np.full_like(t, 0.04),
            0.8 + 20 * t,
            tolerance_n,
        )
        return np.array([1500 * found.position_m[-1], 2e4 * found.bristle_m[-1], found.force_n[-1]])

    exact = forces_at_end(640, 1e-12)
    coarse, fine = (np.abs(forces_at_end(samples, 1e9) - exact) for samples in (40, 80))
    order = np.log2(coarse / fine) if normal else np.log2(coarse[:2] / fine[:2])
    assert (order > 3.6).all()
