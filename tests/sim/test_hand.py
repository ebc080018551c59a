"""Hand and object: motors and forces against closed forms and scipy,
and what a controller sees and commands.
"""

from __future__ import annotations

import math
import re
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compiled
from fingertip.pad.response import Pad
from fingertip.sim.contact.dragged_pad import Mount
from fingertip.sim.contact.friction import LOAD_SCALE_N, Friction
from fingertip.sim.runs.grasp_loop import Grasp, HeldObject, Pin
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.manipulation_plan import Motors, delay_commands, plan_motion, thumb_force_n
from fingertip.sim.runs.scene_and_manipulation_files import Hand, ManipulationFile
from fingertip.sim.runs.stepper import HandSignals, ManipulationStepper
from fingertip.sim.signal.bridge import Bridge
from fingertip.sim.signal.grid import BASE_HZ, Grid
from fingertip.sim.simulation import article_manipulations
from tests.conftest import ROOT

PAD = Pad.from_design(Design())

FIVE = ("thumb", "index", "middle", "ring", "little")

H = 5e-4


def make_motors(fingers=FIVE, **hand) -> Motors:
    return Motors(Hand(**hand), PAD, fingers, np.full(len(fingers), 0.03), H)


def test_motors_follow_with_lag_and_limited_velocity():
    hand = make_motors(("thumb", "index"), lag_s=0.05, rate_m_s=1.0)
    closing = hand.follow(np.full((2, 400), 0.02)).closing_m
    assert closing[0] == pytest.approx(0.02 * (1 - np.exp(-np.arange(1, 401) * H / 0.05)), rel=1e-9)
    slow = make_motors(("thumb", "index"), lag_s=0.005, rate_m_s=0.05)
    motion = slow.follow(np.full((2, 1200), 0.02))
    closing = motion.closing_m
    shaking = motion.vibration_n
    assert np.diff(closing[0])[:300] == pytest.approx(0.05 * H)
    turns = np.flatnonzero((shaking[0][:-1] < 0) & (shaking[0][1:] >= 0))
    assert np.diff(turns[:8]).mean() * H == pytest.approx(1 / 45, rel=0.03)
    assert np.abs(shaking).max() == pytest.approx(0.01, rel=0.01)
    assert closing[0][-1] == pytest.approx(0.02, abs=2e-9)
    # A motor at rest does not vibrate.
    assert not slow.follow(np.full((2, 400), 0.02)).vibration_n[:, 300:].any()


def test_ring_and_little_finger_share_a_motor():
    command = np.full((5, 1200), 0.02)
    command[3] = 0.03
    closing = make_motors().follow(command).closing_m
    assert np.array_equal(closing[3], closing[4])
    assert closing[4][-1] > closing[1][-1]


def test_thumb_force_equals_the_sum_of_the_finger_forces():
    rng = np.random.default_rng(1)
    hand = make_motors(lag_s=0.001, rate_m_s=1.0)
    for _ in range(20):
        goal = 0.03 + rng.uniform(-0.01, 0.05, 5)
        motion = hand.follow(np.repeat(goal[:, None], 300, axis=1))
        closing = motion.closing_m
        force = motion.force_n
        F = force[:, -1]
        depth = closing[:, -1] - 0.03
        assert F[0] == pytest.approx(F[1:].sum(), abs=1e-9)
        if F[0] == 0.0:
            assert depth[0] + depth[1:].max() <= 1e-6
            continue
        yields = np.array([PAD.depth_m(f) for f in F])
        q = depth[0] - yields[0]  # displacement of the object towards the fingers
        pressing = F > 0.0
        assert yields[1:][pressing[1:]] == pytest.approx((depth[1:] + q)[pressing[1:]], abs=1e-10)
        assert (depth[1:][~pressing[1:]] + q <= 1e-9).all()


def test_planned_closing_gives_its_force_and_tendon_stalls_at_the_limit():
    hand = make_motors(("thumb", "index"), lag_s=0.001, rate_m_s=1.0)
    goal = 0.03 + PAD.depth_m(1.7)
    assert hand.follow(np.full((2, 300), goal)).force_n[:, -1] == pytest.approx(
        [1.7, 1.7], abs=1e-6
    )
    weak = make_motors(("thumb", "index"), lag_s=0.001, rate_m_s=1.0, max_force_n=2.0)
    assert weak.follow(np.full((2, 600), 1.0)).force_n[:, -1] == pytest.approx([2.0, 2.0], abs=1e-6)


NO_PIN = Pin(2000.0, 5.0, False)
GROWTH_PER_S = 2.0
"""Growth of the loads where a test lets them grow."""


def move_object(
    seconds: float,
    step_s: float,
    loads,
    mass=0.1,
    weight=0.98,
    pin=None,
    leaves=1.0,
    tolerance_n=1e-6,
    growth_per_s=0.0,
):
    count = len(loads)
    length = round(seconds / step_s)
    time = np.arange(length + 1) * step_s
    pin_m, pin_m_s = (np.full(length + 1, -1.0), np.zeros(length + 1)) if pin is None else pin(time)
    mounts = (Mount(PAD.backing.mass_kg, 6000.0, 2.0),) * count
    held = HeldObject(
        Friction(0.7, 0.56), mounts, mass, leaves, Pin(2000.0, 5.0, pin is pull_motion)
    )
    weights = weight * np.minimum(time / 0.05, 1.0) if weight else np.zeros(length + 1)
    load_n = np.array(loads)[:, None] * (1 + growth_per_s * time)
    found = Grasp(held, step_s, max(loads), tolerance_n).advance(load_n, weights, pin_m, pin_m_s)
    return time[1:], found.object_m, found.position_m, found.over_object_m_s, found.pin_n


def test_released_object_falls():
    time, moved, *_ = move_object(0.3, 1.25e-4, [0.0, 0.0])
    late = time > 0.05
    # The weight rises for 0.05 s. After that the position is g (t^2 - 0.05 t + 0.05^2 / 3) / 2.
    assert moved[late] == pytest.approx(
        4.9 * (time[late] ** 2 - 0.05 * time[late] + 0.05**2 / 3), abs=2e-8
    )


def pin_motion(time):
    """Position and velocity of a pin that stops at 0.2 s."""
    return 0.08 * (time - 0.1) * (time < 0.2) + 0.008 * (time >= 0.2), 0.08 * (time < 0.2)


def pull_motion(time):
    """Position and velocity of a pin that accelerates evenly."""
    return 0.5 * time**2, time


def rates(t, y, loads, mass, weight, pin=pin_motion):
    """The equations of `grasp_loop`, written as plainly as possible."""
    n = len(loads)
    loads = loads * (1 + GROWTH_PER_S * t)
    x = y[:n]
    v = y[n : 2 * n]
    s = y[2 * n : 3 * n]
    X = y[-2]
    V = y[-1]
    w = v - V
    c = 1 / np.sqrt(loads + LOAD_SCALE_N)
    g = 0.56 + 0.14 / (1 + (w / 0.005) ** 2)
    ds = loads * c * (w - 25e3 * np.abs(w) * c * s / g)
    mu = 25e3 * c * s + 2.0 * c * ds + 0.6 * w
    Xp, Vp = (float(q[0]) for q in pin(np.array([t])))
    d = Xp - X
    push = max(0.0, 2000.0 * d * (1 + 5.0 * (Vp - V))) if d > 0 else 0.0
    push = 2000.0 * (d + 5.0 * abs(d) * (Vp - V)) if pin is pull_motion else push
    dv = (-6000.0 * x - 2.0 * v - loads * mu) / PAD.backing.mass_kg
    dV = (weight * min(t / 0.05, 1.0) + push + float(loads @ mu)) / mass
    return np.concatenate((v, dv, ds, [V, dV]))


@pytest.mark.every_case
@pytest.mark.parametrize("pin", [pin_motion, pull_motion])
def test_every_step_is_shampines_with_the_full_jacobian(pin):
    """The reference is the method for dense matrices, with derivatives from finite differences.

    Error control hides a wrong Jacobian, so only this test detects it.
    """
    loads = np.array([0.8, 0.5, 0.3])
    h = 1e-3
    steps = 150  # beyond the impact of the pin, into the slide
    y = np.zeros(11)
    a = ((), (2.0,), (48 / 25, 6 / 25), (48 / 25, 6 / 25))
    c = ((), (-8.0,), (372 / 25, 12 / 5), (-112 / 125, -54 / 125, -2 / 5))
    d = (1 / 2, -3 / 2, 121 / 50, 29 / 250)
    b = (19 / 9, 1 / 2, 25 / 108, 125 / 108)

    def find_rates(at, state):
        return rates(at, state, loads, 0.1, 0.98, pin)

    for i in range(steps):
        t = i * h
        size = np.maximum(np.abs(y), 1e-6) * 1e-6
        J = np.stack(
            [
                (find_rates(t, y + nudge) - find_rates(t, y - nudge)) / (2 * size[j])
                for j, nudge in enumerate(np.diag(size))
            ],
            axis=1,
        )
        soon, later = (find_rates(t + 1e-4 * h * n, y) for n in (1, 2))
        by_time = (4 * soon - later - 3 * find_rates(t, y)) / (2e-4 * h)
        inverse = np.linalg.inv(np.eye(11) * 2 / h - J)
        u: list[np.ndarray] = []
        for stage, alpha in enumerate((0.0, 1.0, 0.6, 0.6)):
            at = y + sum(k * one for k, one in zip(a[stage], u, strict=False))
            sides = sum(k * one for k, one in zip(c[stage], u, strict=False)) / h
            u.append(inverse @ (find_rates(t + alpha * h, at) + sides + d[stage] * h * by_time))
        y = y + sum(k * one for k, one in zip(b, u, strict=True))
    _, moved, shear, *_ = move_object(
        steps * h, h, loads, pin=pin, tolerance_n=1e9, growth_per_s=GROWTH_PER_S
    )
    assert y[-2] > 1e-4
    assert moved[-1] == pytest.approx(y[-2], rel=3e-8)
    assert shear[:, -1] == pytest.approx(y[:3], rel=3e-8)


@pytest.mark.full
@pytest.mark.parametrize("pin", [pin_motion, pull_motion])
def test_motion_agrees_with_scipy_radau(pin):
    loads = np.array([0.8, 0.5, 0.3])
    time, moved, shear, over, _ = move_object(0.15, 1e-3, loads, pin=pin, growth_per_s=GROWTH_PER_S)
    state = np.zeros(11)
    for start, end in pairwise((0.0, 0.05, 0.1, 0.15)):
        at = (time > start + 1e-9) & (time < end + 1e-9)
        part = solve_ivp(
            lambda t, y: rates(t, y, loads, 0.1, 0.98, pin),
            (start, end),
            state,
            "Radau",
            time[at],
            rtol=1e-9,
            atol=1e-13,
            max_step=1e-3,
        )
        state = part.y[:, -1]
        assert np.abs(part.y[-2] - moved[at]).max() < 1e-9
        assert 6000.0 * np.abs(part.y[:3] - shear[:, at]).max() < 5e-6
        assert np.abs(part.y[3:6] - part.y[-1] - over[:, at]).max() < 1e-6


def test_hand_that_holds_an_object_at_rest_takes_no_steps():
    """Loads on straight bristles may change; once the object hangs on them, they may not."""
    held = HeldObject(Friction(0.7, 0.56), (Mount(0.035, 6000.0, 60.0),) * 2, 0.1, 1.0, NO_PIN)
    hold = np.full((2, 5001), 3.0)
    away = np.full(5001, -1.0), np.zeros(5001)
    weight = np.minimum(np.arange(5001) / 500, 1.0)

    def advance(load_n, weight_n, max_steps):
        grasp._constants = (*constants[:2], max_steps, *constants[3:])
        return grasp.advance(load_n, weight_n, *away)

    grasp = Grasp(held, 1e-4, 3.0)
    constants = grasp._constants
    closed = advance(hold * np.linspace(0.0, 1.0, 5001), np.zeros(5001), 0)
    assert not closed.object_m.any()
    with pytest.raises(TraceError, match="point 5001: needs more than"):
        advance(hold, weight, 0)
    advance(hold, weight, 1000)
    hanging = advance(hold, np.ones(5001), 0)
    assert hanging.object_m[0] > 1e-5
    assert np.ptp(hanging.object_m) == 0.0
    with pytest.raises(TraceError, match="point 15001: needs more than"):
        advance(hold * np.linspace(1.0, 1.1, 5001), np.ones(5001), 0)


@pytest.mark.parametrize(
    "tables",
    [
        {"object": {"mass_kg": 0.005}, "grasp": {"force_n": 15.0}},
        {"object": {"mass_kg": 5.0}, "grasp": {"force_n": 0.01}},
        {
            "knock": {
                "stiffness_n_per_m": 1e5,
                "speed_m_s": 0.2,
                "stroke_m": 0.1,
                "damping_s_per_m": 20.0,
            }
        },
        {"hand": {"lag_s": 0.001, "rate_m_s": 1.0, "delay_s": 0.0, "period_s": 0.0005}},
        {"object": {"mass_kg": 0.005}, "knock": {"stiffness_n_per_m": 1e5, "damping_s_per_m": 0.0}},
    ],
    ids=str,
)
def test_extreme_parameters_give_bounded_motion(tables):
    """Nothing moves faster than the pin or a free fall over the length of the object."""
    quick = {"close_s": 0.05, "settle_s": 0.0, "let_go_s": 0.05, "after_s": 0.2}
    tables = tables | {
        "grasp": quick | tables.get("grasp", {}),
        "knock": {"at_s": 0.1} | tables.get("knock", {}),
    }
    scene = ManipulationFile(**tables, outputs=["force_n", "velocity_m_s", "object_m", "pin_n"])
    result = run_manipulation(Design(), scene, None, 1)
    assert all(np.isfinite(signal).all() for signal in result.columns.values())
    assert np.abs(result.output("velocity_m_s")).max() < 2 * scene.knock.speed_m_s + math.sqrt(
        2 * 9.81 * 0.05
    )


DESIGN = Design()


QUICK = {"close_s": 0.3, "settle_s": 0.2, "after_s": 1.0}


@pytest.fixture(autouse=True)
def _fast():
    """Run compiled loops where numba is installed;
    test_report.py checks that they give the same bits.
    """
    with compiled():
        yield


def make_scene(**tables) -> ManipulationFile:
    """A short manipulation without spread of the friction, with these tables."""
    tables = {
        name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()
    }
    tables["grasp"] = QUICK | tables.get("grasp", {})
    tables["object"] = {"friction_spread": 0.0} | tables.get("object", {})
    return ManipulationFile(**tables)


@pytest.mark.parametrize(("delay_s", "rate_hz"), [(0.0, 2000), (0.015, 10_000), (0.0333, 2000)])
def test_a_controller_sees_every_sample_once_and_its_commands_give_what_they_give_in_advance(
    delay_s, rate_hz
):
    """Whatever part of the future is computed before a command is
    known, and whatever it does to what it sees.
    """
    seen = []
    commands = []

    class ReactingController:
        def step(self, observation):
            arrays = {
                name: array
                for name, array in vars(observation).items()
                if isinstance(array, np.ndarray)
            }
            seen.append(
                {name: array.copy() for name, array in arrays.items()}
                | {"time_s": observation.time_s}
            )
            commands.append(
                observation.planned_m + 0.1 * abs(observation.voltage_v[:, -1] - 2.5) * 1e-3
            )
            for array in arrays.values():
                array[...] = 99.0
            return commands[-1]

    outputs = ["voltage_v", "force_n", "envelope_v", "sampled_envelope_v"]
    scene = make_scene(grasp={"kind": "pinch"}, hand={"delay_s": delay_s}, outputs=outputs)
    design = Design(detector={"sample_rate_hz": rate_hz})
    result = run_manipulation(design, scene, ReactingController(), 1)
    signals = result.signals
    plan = result.plan
    period, delay = scene.hand.count_points(BASE_HZ)
    count = Grid().count_points(plan.duration_s, design.detector.sample_rate_hz) - 1
    stepper = ManipulationStepper(design, scene, plan, PAD, 1, frozenset(outputs), Grid())
    stepper.advance(delay_commands(np.array(commands).T, 0, count, period, delay))
    whole = HandSignals.join(stepper.chunks)
    assert len(commands) == math.ceil(count / period)
    # What moves the motors up to a sample was commanded one delay before, or nothing yet.
    at = np.ceil((signals.time_s - delay_s) / 0.01 - 1e-6).astype(int) - 1
    assert np.array_equal(
        signals.command_m, np.where(at < 0, 0.0, np.array(commands).T[:, np.maximum(at, 0)])
    )
    for name in (*outputs, "object_m", "closing_m"):
        assert np.array_equal(signals.find(name), whole.find(name)), name
    rows = {name: [each[name] for each in seen] for name in seen[0]}
    each_time = rate_hz // 100
    assert set(rows) == {"time_s", "voltage_v", "closing_m", "planned_m", "envelope_v"}
    assert rows["time_s"] == pytest.approx(0.01 * np.arange(len(seen)))
    assert np.array_equal(
        np.stack(rows["planned_m"], axis=1), plan.planned_m(np.array(rows["time_s"]))
    )
    assert np.array_equal(
        np.stack(rows["closing_m"], axis=1), signals.closing_m[:, ::each_time][:, : len(seen)]
    )
    for name, field in (("voltage_v", "voltage_v"), ("envelope_v", "sampled_envelope_v")):
        found = np.concatenate(rows[name], axis=1)
        assert np.array_equal(found, signals.find(field)[:, : each_time * (len(seen) - 1) + 1]), (
            name
        )
    assert np.abs(found - signals.find("envelope_v")[:, : found.shape[1]]).max() > 1e-3


def test_weight_shears_the_pad_and_reduces_the_sensor_reading():
    scene = make_scene(
        grasp={"force_n": 10.0, "kind": "pinch"},
        object={"mass_kg": 0.5},
        knock={"speed_m_s": 0.0, "at_s": 0.5},
    )
    result = run_manipulation(DESIGN, scene, None, 1)
    before = result.time_s < result.plan.released_s - scene.grasp.let_go_s
    held = [
        result.output("voltage_v")[0][flags][-200:].mean() for flags in (before, result.time_s > 0)
    ]
    weight = np.array([0.5 * 9.80665 / 2])

    def voltage(shear_n):
        return Bridge.of_board(DESIGN).voltage_v(PAD.sensed_n(np.array([10.0]), shear_n))[0]

    # The hysteresis of the sensor hides a part of a falling force.
    change = voltage(-weight) - voltage(None)
    assert 0.5 < (held[1] - held[0]) / change < 1.1


def test_knock_frees_a_marginal_grip_and_not_a_firm_one():
    loose, firm = (
        run_manipulation(
            DESIGN,
            make_scene(grasp={"min_margin": m, "max_margin": m}, outputs=["slip", "object_m"]),
            None,
            1,
        )
        for m in (1.15, 1.6)
    )
    assert loose.lost_s > loose.plan.knock_s
    assert firm.lost_s is None
    assert firm.signals.object_m[-1] < 0.02
    for run in (loose, firm):
        onset = run.time_s[run.output("slip")[0]][0]
        assert run.plan.knock_s < onset < run.plan.knock_s + 0.03


def test_manipulations_of_the_article():
    found = list(article_manipulations())
    assert [(s.object.mass_kg, s.grasp.kind) for s, _ in found[::3]] == [
        (0.5, "power"),
        (0.255, "power"),
        (0.06, "pinch"),
        (0.02, "pinch"),
    ]
    assert [seed for _, seed in found] == list(range(12))
    assert {s.knock.speed_m_s for s, _ in found} == {0.08}
    assert {len(s.fingers) for s, _ in found} == {5, 2}


def test_robot_pulls_the_object_one_second_after_the_voltage_of_the_thumb_has_changed():
    design = Design(detector={"noise_v": 0.0, "adc_bits": 24})
    file = ROOT / "params/scenes/tri_digital.toml"
    outputs = '["voltage_v", "force_n", "slip", "object_m", "pin_n"]'
    run = run_manipulation(
        design, ManipulationFile.load(file, changes=["sensing.noise=false", f"outputs={outputs}"])
    )
    assert run.fingers == ("thumb", "index", "middle")
    volts = run.output("voltage_v")[0]
    moves_s = run.plan.knock_s
    changes_s = run.time_s[np.flatnonzero(np.abs(volts - volts[0]) >= 0.01)[0]]
    # The poles ahead of the ADC, and the contact, lag.
    assert moves_s - 1.0 == pytest.approx(changes_s, abs=3e-3)
    assert 0.5 <= run.force_n <= 3.5
    before = run.time_s < moves_s
    slides = (run.time_s > moves_s + 0.1) & (run.time_s < moves_s + 1.0)
    assert not run.output("slip")[:, before].any()
    assert run.output("slip")[:, slides].all()
    assert run.output("object_m")[-1] == pytest.approx(0.04, abs=3e-4)  # the arm yields
    friction_n = 2 * run.plan.friction.mu_c * run.force_n
    assert run.output("pin_n")[slides].mean() == pytest.approx(friction_n, rel=0.1)
    assert run.lost_s is None  # although nothing but the pin bears it


@pytest.mark.parametrize("trigger_v", [0.0, 1.0])
def test_without_a_drop_the_robot_waits_for_the_hand(trigger_v):
    plan = plan_motion(DESIGN, make_scene(knock={"trigger_v": trigger_v, "at_s": 0.4}), PAD, 1)
    assert plan.knock_s == pytest.approx(plan.released_s + 0.4, abs=1e-4)
    still = make_scene(knock={"attached": True, "speed_m_s": 0.0})
    assert not plan_motion(DESIGN, still, PAD, 1).pin_m(np.linspace(0, 1, 9))[0].any()


def test_object_that_yields_takes_more_closing_for_the_same_force():
    scenes = [
        make_scene(grasp={"kind": "tri"}, object={"stiffness_n_per_m": k})
        for k in (0.0, 3000.0, 1e6)
    ]
    rigid, soft, hard = (plan_motion(DESIGN, scene, PAD, 1) for scene in scenes)
    assert np.array_equal(soft.force_n, rigid.force_n)
    assert soft.goal_m - rigid.goal_m == pytest.approx(rigid.force_n / 3000)
    assert hard.goal_m == pytest.approx(rigid.goal_m, abs=2e-5)
    outputs = frozenset({"force_n"})
    steppers = [
        ManipulationStepper(DESIGN, scenes[1], soft, PAD, 1, outputs, Grid()) for _ in range(2)
    ]
    for stepper, goal in zip(steppers, (soft.goal_m, rigid.goal_m), strict=True):
        stepper.advance(np.repeat(goal[:, None], 8000, axis=1))
    full, short = (stepper.chunks[-1].find("force_n")[0, -1] for stepper in steppers)
    assert full == pytest.approx(rigid.force_n[0], abs=1e-4)
    assert short < 0.99 * full  # a closing that was planned for a rigid object presses less


def test_seed_determines_the_result():
    scene = make_scene(
        grasp={"kind": "pinch", "after_s": 0.0}, object={"mass_kg": 0.2, "friction_spread": 0.05}
    )
    one, again, other = (run_manipulation(DESIGN, scene, None, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.output("voltage_v"), again.output("voltage_v"))
    assert one.force_n != other.force_n
    assert one.plan.friction.mu_s != other.plan.friction.mu_s


def test_an_object_that_no_hand_holds_is_refused_with_remedies_that_pass():
    """They were rounded down, or above what a hand may have."""
    tables = {"object": {"mass_kg": 5.0}, "grasp": {"max_margin": 20.0}, "hand": {}}
    for table, name, remedy in (
        ("object", "mass_kg", "at most 0.713 kg"),
        ("hand", "max_force_n", "at least 99.9 N"),
        ("", "--seed", "0"),
    ):
        with pytest.raises(TraceError, match=remedy) as caught:
            run_manipulation(DESIGN, make_scene(**tables), None, -1)
        assert caught.value.issues[-1].field == f"{table}.{name}".removeprefix(".")
        assert "--seed" in [issue.field for issue in caught.value.issues]
        tables |= {table: {name: float(remedy.split()[2])}} if table else {}


def test_a_friction_that_holds_no_object_is_refused_with_the_least_that_does():
    """Nothing but rounding up to three digits is between the remedy and the strongest thumb."""
    friction = {"static_friction": 0.0006, "kinetic_friction": 0.0005}
    with pytest.raises(TraceError, match=r"not even one of 0\.005 kg") as caught:
        run_manipulation(DESIGN, make_scene(surface=friction, grasp={"max_margin": 20.0}), None, 1)
    given = dict(re.findall(r"(\w+)=([\d.e-]+)", caught.value.issues[0].message))
    held_by = {name: float(given[name]) for name in friction}
    held = make_scene(
        surface=held_by, grasp={"max_margin": 20.0}, object={"mass_kg": float(given["mass_kg"])}
    )
    assert (
        0.99
        < thumb_force_n(held, 1.0)
        / Hand.model_json_schema()["properties"]["max_force_n"]["maximum"]
        <= 1.0
    )
