"""Scene, pad, vibration, sensor: each stage by itself."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from fingertip.board.values.bridge import sensor_conductance_s
from fingertip.design import Design
from fingertip.sim.contact import vibration
from fingertip.sim.contact.pad import Pad
from fingertip.sim.electronics import converter, fsr
from fingertip.sim.scenes.scene import LIFT_M, Ramp
from fingertip.sim.scenes.timeline import plan
from fingertip.sim.trial import MAX_FORCE_N, Trial

PAD = Pad.of(Design())


@pytest.mark.parametrize("speed", [0.04, 0.06, 0.08, 0.5])
def test_ramp_arrives_and_its_velocity_is_the_slope(speed):
    ramp = Ramp.at(0.3, 0.04, speed)
    time = np.linspace(0.0, ramp.end_s + 0.5, 200_001)
    way = ramp.position_m(time)
    assert way[0] == 0.0
    assert way[-1] == pytest.approx(0.04, abs=1e-12)
    assert ramp.velocity_m_s(time).max() <= speed
    slope = np.gradient(way, time)
    assert np.abs(slope - ramp.velocity_m_s(time)).max() < 1e-4


def test_article_times():
    scene = plan(Trial().scene, PAD, 1.0)
    assert scene.slide.start_s - scene.approach.end_s == pytest.approx(1.0)
    assert scene.slide.end_s - scene.slide.start_s == pytest.approx(1.04)
    assert scene.lift.end_s - scene.lift.start_s == pytest.approx(2.0)
    assert scene.lift.position_m(np.array([99.0]))[0] == pytest.approx(0.05)


def test_pad_force_inverts_depth():
    forces = np.array([1e-6, 0.01, 0.2, 1.0, 4.0])
    depths = np.array([PAD.depth_m(f) for f in forces.tolist()])
    assert PAD.force_n(depths) == pytest.approx(forces, rel=1e-12)
    assert PAD.force_n(np.array([-1.0, 0.0])).tolist() == [0.0, 0.0]


def test_the_lift_ends_every_contact_that_is_allowed():
    assert PAD.depth_m(MAX_FORCE_N) < LIFT_M


def test_pad_by_hertz_and_mindlin():
    R, E = PAD.radius_m, 1e6 / 0.75
    assert pytest.approx(2 * 0.8**2 * 8.5**2 / 6.0 * 1e-3) == R
    patch = (3 * 1.0 * R / (4 * E)) ** (1 / 3)
    assert PAD.normal_stiffness_n_per_m(1.0) == pytest.approx(2 * E * patch)
    assert PAD.tangential_stiffness_n_per_m(1.0) == pytest.approx(2 * E * patch * 2 / 3)
    assert PAD.resonance_hz(1.0) == pytest.approx(90.0)


def test_profile_has_its_roughness_below_the_cutoff():
    heights = vibration.profile(random.Random(1), 0.8, 0.8e-3, 0.5)
    spectrum = np.abs(np.fft.rfft(heights * np.hanning(len(heights)))) ** 2
    waves_per_m = np.fft.rfftfreq(len(heights), 5e-6)
    window = np.mean(np.hanning(len(heights)) ** 2)
    rough = 2 * spectrum[waves_per_m > 1 / 0.8e-3 * 0.98].sum() / len(heights) ** 2 / window
    assert math.sqrt(rough) == pytest.approx(0.8e-6 * math.sqrt(math.pi / 2), rel=0.1)


@pytest.mark.parametrize("frequency", [20.0, 90.0, 180.0])
def test_resonance_against_its_closed_form(frequency):
    f0, zeta, h = 90.0, 0.15, 1.25e-4
    time = np.arange(24_000) * h
    out = vibration.resonate(5 + np.sin(2 * math.pi * frequency * time), time >= 0, h, f0, zeta)
    tail = out[-8000:] - 5.0  # a second: whole periods
    r = frequency / f0
    gain = 1 / math.hypot(1 - r * r, 2 * zeta * r)
    assert math.sqrt(2 * np.mean(tail**2)) == pytest.approx(gain, rel=5e-3)


def test_the_hand_follows_slow_waves_only():
    assert PAD.hand_hz == pytest.approx(math.sqrt(90 / PAD.mass_kg) / (2 * math.pi))
    time = np.arange(160_000) * 1.25e-4
    for frequency in (0.5, 10.0, 90.0):
        out = vibration.left_by_hand(np.sin(2 * math.pi * frequency * time), 1.25e-4, 10.0)[80_000:]
        r = frequency / 10.0
        assert math.sqrt(2 * np.mean(out**2)) == pytest.approx(r / math.hypot(1, r), rel=0.02)
    assert abs(vibration.left_by_hand(np.append(0.0, np.ones(8000)), 1.25e-4, 10.0)[-1]) < 1e-12


def test_no_contact_no_force():
    h = 1.25e-4
    touching = np.arange(4000) < 2000
    out = vibration.resonate(np.where(touching, 1.0, 0.0), touching, h, 90.0, 0.15)
    assert out[1999] == pytest.approx(1.0, rel=1e-3)
    assert not out[2000:].any()
    assert (vibration.resonate(np.full(4000, -1.0), touching, h, 90.0, 0.15) == 0.0).all()


def test_the_curve_passes_the_articles_points():
    curve = fsr.fit()
    assert [round(curve.voltage_v(f), 9) for f in (0.0, 0.1, 0.8, 1.3)] == [4.3, 4.3, 4.0, 3.85]
    assert 4.25 < curve.voltage_v(0.2) < 4.3  # in the middle of the turn-on


@pytest.mark.parametrize("exponent", [fsr.fit().exponent, fsr.fit_conductance().exponent, 1.0, 0.3])
def test_the_turn_on_has_neither_jump_nor_corner(exponent):
    """A corner would ring the high-pass at every contact, which the article did not see: whatever the exponent, the
    slope grows from 0 in proportion to the force, and ends as the power law's."""
    w, h = fsr.TURN_ON_WIDTH_N, 1e-6

    def slope(excess: float) -> float:
        return (fsr.turned_on(excess + h, exponent) - fsr.turned_on(excess - h, exponent)) / (2 * h)

    assert fsr.turned_on(-w, exponent) == 0.0
    assert fsr.turned_on(w * (1 - 1e-12), exponent) == pytest.approx(w**exponent)
    assert slope(w - 2 * h) == pytest.approx(exponent * w ** (exponent - 1), rel=1e-3)
    for share in (1e-3, 1e-2):
        assert slope(-w + 2 * w * share) / share == pytest.approx(w ** (exponent - 1) * (3 - 2 * exponent), rel=0.05)
    rising = [fsr.turned_on(-0.2 + i / 1000, exponent) for i in range(3000)]
    assert rising == sorted(rising)


def test_the_curves_fall_and_follow_the_data_sheet():
    curve = fsr.fit()
    assert curve.exponent == pytest.approx(0.694, abs=0.03)  # the data sheet's slope, which took no part in the fit
    falling = [curve.voltage_v(0.2 + i / 100) for i in range(300)]
    assert falling == sorted(falling, reverse=True)
    conductance = fsr.fit_conductance()
    for force in (0.8, 1.3):
        assert conductance.siemens(force) == pytest.approx(sensor_conductance_s(force), rel=1e-9)


def test_hysteresis_stays_within_a_tenth_and_lets_vibration_through():
    up, down = np.linspace(0.0, 2.0, 401), np.linspace(2.0, 0.0, 401)
    shown = fsr.with_hysteresis(np.concatenate((up, down)))
    assert np.array_equal(shown[:401], up)
    above = shown[401:-1] / down[:-1]
    assert above[0] == 1.0
    assert (above >= 1.0).all()
    assert above.max() == pytest.approx(1.10)
    assert shown[-1] == 0.0
    shaken = fsr.with_hysteresis(1 + 0.001 * np.sin(np.arange(1000) / 10))
    assert np.ptp(shaken[500:]) == pytest.approx(0.8 * 0.002, rel=0.01)


def test_converter_steps():
    step = 20 / 65536
    codes = converter.quantise(np.linspace(-11, 11, 2001), 16, 10.0) / step
    assert np.array_equal(codes, np.round(codes))
    assert (codes.min(), codes.max()) == (-32768, 32767)
    assert converter.quantise(np.float64(4.3), 16, 10.0) == pytest.approx(4.3, abs=step / 2)
    assert converter.quantise(np.float64(0.6 * step), 16, 10.0) == step
