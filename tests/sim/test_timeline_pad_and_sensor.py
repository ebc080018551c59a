"""Parts of a scene by themselves: timeline, pad, vibration, sensor and ADC."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np
import pytest

from fingertip.board.components.front_end import sensor_conductance_s
from fingertip.design import Design
from fingertip.pad.layer import find_contacts, find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import REFERENCE_POSE, Backing, Pad
from fingertip.pad.touch import Pose
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.contact.surfaces import SurfaceProfile, generate_profile
from fingertip.sim.contact.vibration import ContactResonance, ProfileForce, high_pass
from fingertip.sim.runs.pose import MOUNTS, MountTable
from fingertip.sim.runs.timeline import LIFT_M, TrapezoidalMove, build_timeline
from fingertip.sim.signal.bridge import (
    STRAIGHT,
    TURN_ON_WIDTH_N,
    Bridge,
    ForceSensor,
    fit_conductance_curve,
    turn_on_power,
)
from fingertip.sim.signal.converter import AdcRange
from fingertip.sim.simulation import MAX_FORCE_N, Trial

DESIGN = Design()
PAD = Pad.from_design(DESIGN)


@pytest.mark.parametrize("speed", [0.04, 0.06, 0.08, 0.5])
def test_move_arrives_and_its_velocity_is_the_slope(speed):
    move = TrapezoidalMove.with_speed(0.3, 0.04, speed)
    time = np.linspace(0.0, move.end_s + 0.5, 200_001)
    position = move.position_m(time)
    assert position[0] == 0.0
    assert position[-1] == pytest.approx(0.04, abs=1e-12)
    assert move.velocity_m_s(time).max() <= speed
    slope = np.gradient(position, time)
    assert np.abs(slope - move.velocity_m_s(time)).max() < 1e-4


def test_times_of_the_article():
    timeline = build_timeline(DESIGN, Trial().scene, PAD, 1.0)
    assert timeline.slide.start_s - timeline.approach.end_s == pytest.approx(1.0)
    assert timeline.slide.end_s - timeline.slide.start_s == pytest.approx(1.04)
    assert timeline.lift.end_s - timeline.lift.start_s == pytest.approx(2.0)
    assert timeline.lift.position_m(np.array([99.0]))[0] == pytest.approx(0.05)


def test_pad_force_inverts_depth():
    forces = np.array([1e-6, 0.01, 0.2, 1.0, 4.0])
    depths = np.array([PAD.depth_m(f) for f in forces.tolist()])
    assert PAD.force_n(depths) == pytest.approx(forces, rel=1e-12)
    assert PAD.force_n(np.array([-1.0, 0.0])).tolist() == [0.0, 0.0]


def test_lift_ends_every_permitted_contact():
    assert PAD.depth_m(MAX_FORCE_N) < LIFT_M


def test_stiffness_is_the_layer_s_at_1_n_with_hertz_power_and_mindlin_s_ratio():
    low, high = find_contacts(PadForm.of_design(DESIGN), REFERENCE_POSE, (0.9, 1.1))
    k = 1e3 * 0.2 / (high.depth_mm - low.depth_mm)
    assert PAD.normal_stiffness_n_per_m(1.0) == pytest.approx(k, rel=1e-4)
    assert PAD.normal_stiffness_n_per_m(8.0) == pytest.approx(2 * k, rel=1e-4)
    assert PAD.tangential_stiffness_n_per_m(1.0) == pytest.approx(2 / 3 * k, rel=1e-4)
    assert PAD.resonance_hz(1.0) == pytest.approx(
        math.sqrt((k + 90) / PAD.backing.mass_kg) / 2 / math.pi, rel=1e-4
    )
    depth = PAD.depth_m(1.0) - 1.0 / Backing.stiffness_n_per_m
    yields_m_per_n = (
        PAD.depth_m(1.01) - PAD.depth_m(0.99)
    ) / 0.02 - 1.0 / Backing.stiffness_n_per_m
    assert yields_m_per_n == pytest.approx(1 / k, rel=1e-3)
    assert depth == pytest.approx(1.5 / k, rel=1e-4)


def test_profile_has_the_given_roughness_below_the_cutoff():
    surface = SURFACES["medium"]
    heights = generate_profile(random.Random(1), surface, 0.0, 0.5).heights_m
    spectrum = np.abs(np.fft.rfft(heights * np.hanning(len(heights)))) ** 2
    waves_per_m = np.fft.rfftfreq(len(heights), 5e-6)
    window = np.mean(np.hanning(len(heights)) ** 2)
    rough = 2 * spectrum[waves_per_m > 1 / 0.8e-3 * 0.98].sum() / len(heights) ** 2 / window
    felt_m = surface.felt_um * surface.roughness_um**surface.felt_exponent * 1e-6
    assert math.sqrt(rough) == pytest.approx(felt_m * math.sqrt(math.pi / 2), rel=0.1)


@pytest.mark.parametrize("frequency", [20.0, 90.0, 180.0])
def test_resonance_matches_closed_form(frequency):
    f0 = 90.0
    zeta = 0.15
    h = 1.25e-4
    time = np.arange(24_000) * h
    out = ContactResonance(h, f0, zeta).process(
        5 + np.sin(2 * math.pi * frequency * time), np.ones_like(time)
    )
    tail = out[-8000:] - 5.0  # a second: whole periods
    r = frequency / f0
    gain = 1 / math.hypot(1 - r * r, 2 * zeta * r)
    assert math.sqrt(2 * np.mean(tail**2)) == pytest.approx(gain, rel=1e-4)  # ramps alone: 2e-3


def test_hand_follows_slow_waves_only():
    assert PAD.backing.resonance_hz == pytest.approx(
        math.sqrt(90 / PAD.backing.mass_kg) / (2 * math.pi)
    )
    time = np.arange(160_000) * 1.25e-4
    for frequency in (0.5, 10.0, 90.0):
        out = high_pass(np.sin(2 * math.pi * frequency * time), 1.25e-4, 10.0, np.zeros(5))[80_000:]
        r = frequency / 10.0
        assert math.sqrt(2 * np.mean(out**2)) == pytest.approx(r / math.hypot(1, r), rel=0.02)
    assert abs(high_pass(np.append(0.0, np.ones(8000)), 1.25e-4, 10.0, np.zeros(5))[-1]) < 1e-12


@pytest.mark.parametrize("kind", MOUNTS)
def test_slow_waves_press_a_pad_as_two_springs_in_series(kind):
    pad = Pad.from_design(DESIGN, backing=MountTable(kind=kind).backing)
    height = np.append(0.0, np.full(20_000, 1e-6))
    path = np.arange(20_001.0)
    load = np.ones(20_001)
    profile = SurfaceProfile(0.0, height, np.zeros_like(height), 1.0)
    k = pad.stiffness_1n_n_per_m
    behind = pad.backing.stiffness_n_per_m
    force = ProfileForce(pad, profile, True, 1e-3).process(load, path)
    assert force[-1] == pytest.approx(1e-6 * k * behind / (k + behind), rel=1e-6)
    assert pad.resonance_hz(1.0) == pytest.approx(
        math.sqrt((k + behind) / pad.backing.mass_kg) / (2 * math.pi)
    )


def test_figures_of_a_mount_replace_those_of_its_kind():
    assert MountTable(kind="bench", mass_kg=0.2).backing == replace(MOUNTS["bench"], mass_kg=0.2)


def test_force_is_zero_without_contact():
    h = 1.25e-4
    load = np.where(np.arange(4000) < 2000, 1.0, 0.0)
    out = ContactResonance(h, 90.0, 0.15).process(load, load)
    assert out[1999] == pytest.approx(1.0, rel=1e-3)
    assert not out[2000:].any()
    assert (ContactResonance(h, 90.0, 0.15).process(np.full(4000, -1.0), load) == 0.0).all()


def test_voltage_curve_passes_the_points_of_the_article():
    bridge = Bridge.of_article()
    assert bridge.voltage_v(np.array([0.0, 0.1, 0.8, 1.3])).round(9).tolist() == [
        4.3,
        4.3,
        4.0,
        3.85,
    ]
    assert 4.25 < bridge.voltage_v(np.array([0.2]))[0] < 4.3  # in the middle of the turn-on


@pytest.mark.parametrize(
    "exponent", [Bridge.of_article().curve.exponent, fit_conductance_curve().exponent, 1.0, 0.3]
)
def test_turn_on_has_neither_jump_nor_kink(exponent):
    """The slope grows from 0 in proportion to the force and ends as that of the power law, for
    every exponent.

    A kink would make the high-pass filter ring at every contact, which the article did not observe.
    """
    w = TURN_ON_WIDTH_N
    h = 1e-6

    def slope(excess: float) -> float:
        return (turn_on_power(excess + h, exponent, w) - turn_on_power(excess - h, exponent, w)) / (
            2 * h
        )

    assert turn_on_power(-w, exponent, w) == 0.0
    assert turn_on_power(w * (1 - 1e-12), exponent, w) == pytest.approx(w**exponent)
    assert slope(w - 2 * h) == pytest.approx(exponent * w ** (exponent - 1), rel=1e-3)
    for share in (1e-3, 1e-2):
        assert slope(-w + 2 * w * share) / share == pytest.approx(
            w ** (exponent - 1) * (3 - 2 * exponent), rel=0.05
        )
    rising = [turn_on_power(-0.2 + i / 1000, exponent, w) for i in range(3000)]
    assert rising == sorted(rising)


def test_curves_fall_and_follow_the_data_sheet():
    bridge = Bridge.of_article()
    # The data sheet's slope, which took no part in the fit.
    assert bridge.curve.exponent == pytest.approx(0.694, abs=0.03)
    falling = bridge.voltage_v(0.2 + np.arange(300) / 100).tolist()
    assert falling == sorted(falling, reverse=True)
    conductance = fit_conductance_curve()
    for force in (0.8, 1.3):
        assert conductance.conductance_s(force) == pytest.approx(
            sensor_conductance_s(force), rel=1e-9
        )


def test_hysteresis_stays_below_ten_percent_and_passes_vibration():
    up = np.linspace(0.0, 2.0, 401)
    down = np.linspace(2.0, 0.0, 401)
    shown = ForceSensor(1e-3).process(np.concatenate((up, down)))[0]
    assert np.array_equal(shown[:401], up)
    above = shown[401:-1] / down[:-1]
    assert above[0] == 1.0
    assert (above >= 1.0).all()
    assert above.max() == pytest.approx(1.10)
    assert shown[-1] == 0.0
    shaken = ForceSensor(1e-3).process(1 + 0.001 * np.sin(np.arange(1000) / 10))[0]
    assert np.ptp(shaken[500:]) == pytest.approx(0.8 * 0.002, rel=0.01)


def test_force_in_the_middle_of_a_step_keeps_the_area_of_the_curve():
    """Of a sine with play, whose points are 2 ms apart: by hand
    with points that are 100 times as close.
    """
    # 20 Hz where a hundred points take 0.5 ms.
    force_n = 1.0 + 0.2 * np.sin(np.arange(100_000) / 3183.1)
    fine = ForceSensor(1e-5).process(force_n)[0]
    shown, middle = ForceSensor(1e-3).process(force_n[::100])
    exact = fine[:99_900].reshape(-1, 100).sum(axis=1) + 0.5 * (
        fine[100:100_000:100] - fine[:99_900:100]
    )
    bent = np.where(middle == STRAIGHT, 0.0, middle - 0.5 * (shown + np.roll(shown, 1)))[1:]
    straight = 50 * (shown[1:] + shown[:-1])
    assert np.abs(straight - exact)[10:].max() > 5e-4
    assert np.abs(straight + 50 * bent - exact)[10:].max() < 2e-4


def test_creep_grows_per_decade_of_time_under_load_and_begins_anew():
    """5 % per decade, as data sheets state it: 1.05 and 1.10 after 10 and 100 s, counted
    from 1 s.
    """
    loaded = np.ones(9900)
    shown = ForceSensor(0.01, 0.05).process(np.concatenate(([0.0], loaded, [0.0], loaded)))[0][1:]
    assert shown[[899, 9899]] == pytest.approx([1.05, 1.10], rel=1e-4)
    assert shown[9901:].tolist() == shown[:9900].tolist(), "unloading ends it"


def test_the_sensor_gets_its_share_of_the_force_and_what_shear_adds():
    forces = np.array([0.0, 0.1, 0.3, 1.0, 3.0, 8.0])
    contacts = find_contacts(PadForm.of_design(DESIGN), Pose(10.0), forces[1:].tolist())
    pad = Pad.from_design(DESIGN, Pose(10.0))
    # The bump inside the skin presses without a touch.
    rest_n = find_rest_n(PadForm.of_design(DESIGN))
    assert rest_n > 0.01
    wanted = [rest_n + contact.share * contact.force_n for contact in contacts]
    assert pad.sensed_n(forces) == pytest.approx([rest_n, *wanted], rel=0.04, abs=0.004)
    sheared = pad.sensed_n(forces[1:], 0.1 * forces[1:]) - pad.sensed_n(forces[1:])
    assert sheared == pytest.approx(
        [0.1 * c.shear_share * c.force_n for c in contacts], rel=0.1, abs=0.004
    )
    # A curve that was weighed on the finger reads the force on it, in the pose of the weighing.
    weighed = Pad.from_design(DESIGN)
    assert weighed.sensed_n(np.ones(1), None, True) == pytest.approx([1.0], rel=1e-9)


def test_adc_quantises_and_clips():
    step = 20 / 65536
    adc = AdcRange(16, -10.0, 10.0)
    codes = adc.quantise_v(np.linspace(-11, 11, 2001)) / step
    assert np.array_equal(codes, np.round(codes))
    assert (codes.min(), codes.max()) == (-32768, 32767)
    assert adc.quantise_v(np.float64(4.3)) == pytest.approx(4.3, abs=step / 2)
    assert adc.quantise_v(np.float64(0.6 * step)) == pytest.approx(step, abs=1e-15)
