"""One finger: chunks, sampling rates, converters and interference, in scenes and in a hand."""

from __future__ import annotations

import io
import math
import random
import tracemalloc
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from fingertip.catalogues.file_kinds import SCENE, list_bundled_files
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import REFERENCE_POSE, Pad
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.contact.surfaces import average_over_patch, generate_profile
from fingertip.sim.runs.scene import SceneRun, run_scene, stream_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.signal.grid import BASE_HZ, Grid, open_stream
from fingertip.sim.signal.interference import (
    HandVibration,
    InterferenceSource,
    PinkNoise,
    compute_cable_v,
    compute_hum_v,
    design_pink,
)
from fingertip.sim.signal.parameters import Cable, Drift, Noise
from fingertip.sim.signal.simulated_finger import FingerSignals
from fingertip.sim.simulation import Trial
from fingertip.sim.trace_file import encode_trace, open_trace
from tests.sim.test_report import EVERYTHING

DESIGN = Design(board={"variant": "comparator", "supply_v": 3.3})

SCENE_OUTPUTS = SceneFile.known_outputs()


@pytest.mark.full
@pytest.mark.parametrize("rate", [1000.0, 3000.0, 20_000.0])
@pytest.mark.parametrize("refinement", [1, 3])
def test_chunks_change_no_bit_at_any_rate_with_all_interference(rate, refinement):
    design = Design(detector={"sample_rate_hz": rate}, board=DESIGN.board.model_dump())
    tables = {
        "hold": {"wait_s": 0.05},
        "slide": {"distance_m": 0.004},
        "outputs": [*SCENE_OUTPUTS],
    } | EVERYTHING
    for contact in ({}, {"feedback": True}, {"bristles": "elasto_plastic"}):
        scene = SceneFile(**tables, contact=contact)
        grid = Grid(refinement)
        with compiled():
            whole = run_scene(design, scene, 2, grid=grid).signals
            parts = FingerSignals.join([*SceneRun(design, scene, 2, grid).chunks(1303)])
        for name in ("time_s", *SCENE_OUTPUTS):
            assert np.array_equal(getattr(parts, name), getattr(whole, name)), (name, contact)


@pytest.mark.full
def test_stream_needs_no_more_memory_for_a_longer_scene():
    def peak_mb(seconds: float) -> float:
        scene = SceneFile(hold={"min_s": seconds}, outputs=["voltage_v", "force_n", "slip"])
        tracemalloc.start()
        record = stream_scene(Design(), scene, lambda chunk: None, 1)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert record.duration_s > seconds
        return peak / 1e6

    with compiled():
        peak_mb(5.0)
        short = peak_mb(5.0)
        long = peak_mb(30.0)
    assert long < 1.1 * short


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_trace_in_chunks_has_the_bytes_of_the_whole(suffix, monkeypatch):
    scene = SceneFile.load(list_bundled_files(SCENE)["contact"]).model_copy(
        update={"outputs": [*SCENE_OUTPUTS]}
    )
    result = run_scene(DESIGN, scene, 1)
    path = Path(f"trace.{suffix}")
    out = io.BytesIO()
    whole = encode_trace(result.time_s, result.columns, path)
    monkeypatch.setattr("fingertip.sim.trace_file._ROWS", 999)
    writer = open_trace(out, path, [*SCENE_OUTPUTS])
    for a, b in pairwise((0, 1, 700, 5000, len(result.time_s))):
        writer.write(
            result.time_s[a:b], {name: values[a:b] for name, values in result.columns.items()}
        )
    writer.close()
    assert out.getvalue() == whole


def power_density(
    values: np.ndarray, rate_hz: float, length: int = 8192
) -> tuple[np.ndarray, np.ndarray]:
    """Frequency [Hz] and one-sided power spectral density, by Welch's method."""
    window = np.hanning(length)
    parts = np.lib.stride_tricks.sliding_window_view(values, length)[:: length // 2]
    power = (
        (np.abs(np.fft.rfft(parts * window, axis=1)) ** 2).mean(axis=0)
        * 2
        / (rate_hz * np.sum(window**2))
    )
    return np.fft.rfftfreq(length, 1 / rate_hz), power


def test_processes_of_pink_noise_have_the_spectrum_and_the_steady_state_of_independent_ones():
    """Those of all octaves have the power 1 / f of independent
    ones, whose integral over an octave is 1 / 2.
    """
    decays, gains, steady = design_pink()
    per_step = np.logspace(-7, math.log10(0.5), 200)
    z = np.exp(-2j * math.pi * per_step)[:, None]
    independent = ((1 - np.square(decays)) / np.abs(1 - decays * z) ** 2).sum(axis=1)
    heard = (per_step > 2 / BASE_HZ) & (per_step < 300 / BASE_HZ)
    assert (per_step * independent)[heard] * 2 * math.log(2.0) == pytest.approx(1.0, rel=0.05)
    assert np.abs((gains / (1 - decays * z)).sum(axis=1)) ** 2 == pytest.approx(
        independent, rel=1e-10
    )
    matrix = np.array([row + [0.0] * (len(steady) - len(row)) for row in steady])
    # Covariance, one step later.
    after = np.outer(decays, decays) * (matrix @ matrix.T) + np.outer(gains, gains)
    assert matrix @ matrix.T == pytest.approx(after, rel=1e-10)
    first = [
        PinkNoise(Grid(), 1.0, open_stream(seed, "test")).process(1)[0] for seed in range(1000)
    ]
    assert np.std(first) == pytest.approx(math.sqrt(len(decays) * math.log10(2.0)), rel=0.1)
    steps = np.diff(PinkNoise(Grid(), 1.0, open_stream(1, "test")).process(20_000))
    assert np.mean(steps**2) == pytest.approx(
        2 * math.log10(2.0) * (1 - np.array(decays)).sum(), rel=0.05
    )


def test_vibration_of_a_hand_lies_in_its_band():
    with compiled():
        values = HandVibration(Grid(), 3e-4, open_stream(3, "test")).process(1_000_000)
    assert values.std() == pytest.approx(3e-4, rel=0.02)
    frequency, power = power_density(values, BASE_HZ)
    inside = (frequency > 25) & (frequency < 105)
    assert power[inside].sum() > 0.9 * power.sum()
    assert power[frequency > 300].sum() < 0.01 * power.sum()


def test_hum_has_its_harmonics():
    time_s = Grid().time_s(0, 10_000)
    values = compute_hum_v(Noise(hum_v=1e-3, hum_third=0.2, hum_fifth=0.1), time_s)
    lines = 2 * np.abs(np.fft.rfft(values)) / len(values)
    assert lines[[50, 150, 250]] == pytest.approx([1e-3, 2e-4, 1e-4], rel=1e-9)


def test_touched_cable_hums_as_long_as_it_is_touched():
    """50 Hz from 0.7 to 1.0 s: thirty half waves, whose RMS is the amplitude over the
    root of two.
    """
    cable = Cable(hum_v=1e-3, at_s=0.2, duration_s=0.3)
    time_s = (np.arange(20_000) + 0.5) * 1e-4
    volts, jumps = compute_cable_v(cable, 0.5, time_s, 1e-4)
    touched = slice(7000, 10_000)
    assert (np.flatnonzero(volts)[[0, -1]] == [7000, 9999]).all()
    assert np.count_nonzero(np.diff(np.sign(volts[touched]))) == 29
    assert np.sqrt(np.mean(volts[touched] ** 2)) == pytest.approx(1e-3 / math.sqrt(2))
    assert not jumps.any()


def test_touched_cable_jumps_at_both_ends_and_each_jump_decays():
    """Up at 0.7 s and down at 1.0 s by 10 mV, of which 1/e is left after 50 ms."""
    cable = Cable(step_v=0.01, decay_s=0.05, at_s=0.2, duration_s=0.3)
    time_s = (np.arange(2000) + 0.5) * 1e-3
    volts, jumps = compute_cable_v(cable, 0.5, time_s, 1e-3)
    assert np.flatnonzero(jumps).tolist() == [700, 1000]
    assert jumps[[700, 1000]] == pytest.approx([0.01, -0.01], rel=0.02)
    assert volts[[750, 1050]] / volts[[700, 1000]] == pytest.approx(1 / math.e, rel=0.01)
    assert not volts[:700].any()


def test_amplifier_drifts_by_its_rate():
    """2 mV/s: 5 mV after 2.5 s, also across two chunks, and nothing else."""
    source = InterferenceSource(
        Grid(), Drift(volt_per_s=2e-3), Cable(), Noise(), 0.0, partial(open_stream, 1)
    )
    volts = np.concatenate([source.process(np.ones(12_500))[0] for _ in range(2)])
    assert volts[[0, 12_500]] == pytest.approx([0.0, 2.5e-3])
    assert np.ptp(np.diff(volts)) < 1e-15


def test_hand_vibration_needs_contact():
    scene = SceneFile(
        hold={"wait_s": 0.2},
        noise={"hand_v": 5e-3},
        sensing={"noise": False},
        outputs=["tactile_v", "force_n"],
    )
    found = run_scene(Design(), scene, 0).columns
    air = found["force_n"] == 0.0
    assert np.ptp(found["tactile_v"][air]) < 1e-12
    assert found["tactile_v"][~air].std() > 4e-3


def test_average_over_the_patch_is_the_pressure_weighted_mean():
    """Against a sum over the disc; tests/sim/test_materials.py compares scenes with and
    without it.
    """
    pad = Pad.from_design(Design())
    radius = pad.patch_radius_m(1.0)
    (contact,) = find_contacts(PadForm.of_design(Design()), REFERENCE_POSE, [1.0])
    # Whole cells.
    assert radius == pytest.approx(1e-3 * math.sqrt(contact.area_mm2 / math.pi), rel=0.02)
    x, y = np.meshgrid(np.linspace(-1, 1, 801), np.linspace(-1, 1, 801))
    weight = np.sqrt(np.clip(1 - x * x - y * y, 0.0, None))
    for wavelength in (0.2e-3, 0.8e-3, 3e-3, 50e-3):
        u = 2 * math.pi * radius / wavelength
        assert average_over_patch(u) == pytest.approx(
            (weight * np.cos(u * x)).sum() / weight.sum(), abs=2e-3
        )


def test_stick_slip_lets_the_pad_stop_during_a_slide():
    scene = Trial("medium", 0.04, 2.0, 1).scene.model_copy(
        update={"outputs": ["velocity_m_s", "slip"]}
    )
    still = []
    for stick_slip in (False, True):
        contact = scene.contact.model_copy(update={"stick_slip": stick_slip})
        found = run_scene(Design(), scene.model_copy(update={"contact": contact}), 1)
        since_s = found.time_s - found.slips[0].onset_s
        during = (since_s > 0.1) & (since_s < 0.5)
        still.append((found.columns["velocity_m_s"][during] < 1e-3).mean())
    assert still[0] == 0.0
    assert still[1] > 0.03


def test_profile_slopes_are_the_derivative_of_its_heights():
    profile = generate_profile(random.Random(4), SURFACES["paper"], -1e-3, 0.01)
    inner = np.gradient(profile.heights_m, 5e-6)[1:-1]
    assert np.abs(inner - profile.slopes[1:-1]).max() < 0.1 * np.abs(inner).max()
    # The cubic passes through the points.
    at = -1e-3 + np.arange(100) * 5e-6
    assert profile.height_m(at) == pytest.approx(profile.heights_m[:100], abs=1e-15)
