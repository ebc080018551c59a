"""Readout step by step: the bits of the simulation of a finger for the same force."""

from __future__ import annotations

import itertools
import random

import numpy as np
import pytest

from fingertip import Design, FingertipError, Readout
from fingertip.foundation import jit
from fingertip.pad.response import Pad
from fingertip.pad.touch import Pose
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.signal import bridge
from fingertip.sim.signal import readout as module
from fingertip.sim.signal.grid import CostMeter, Grid
from fingertip.sim.signal.parameters import PathTables, Sensing
from fingertip.sim.signal.simulated_finger import Finger, FingerDrive, FingerSetup, FingerSignals

CASES = {
    "fsr400": (),
    "article": (),
    "comparator": ("board.variant=comparator", "force_curve.curve=calibrated"),
    "3 kHz": ("detector.sample_rate_hz=3000",),
    "20 kHz": ("detector.sample_rate_hz=20000",),
}


def load(case: str) -> Design:
    return Design.load("article" if case == "article" else "fsr400", changes=list(CASES[case]))


def simulate_whole(
    design: Design, pad: Pad, force_n: np.ndarray, has_noise: bool, name: str, grid: Grid
) -> FingerSignals:
    """Simulate the finger over all points of the grid at once."""
    friction = SURFACES["medium"].friction
    path = PathTables(sensing=Sensing(noise=has_noise))
    setup = FingerSetup(design, pad, 1.0, friction, random.Random, (7, name), path=path)
    output = "sampled_filtered_v" if design.board.is_for_controller else "sampled_envelope_v"
    outputs = frozenset({"tactile_v", "filtered_v", "envelope_v", "voltage_v", output})
    points = round(grid.rate_hz / design.detector.sample_rate_hz)
    part = (np.arange(points) + 1) / points
    line = [a + (b - a) * part for a, b in itertools.pairwise(force_n)]
    on_grid = np.concatenate([force_n[:1], *line])
    return Finger(setup, grid, outputs, CostMeter(), contact_is_given=True).process(
        FingerDrive(on_grid, contact_n=on_grid)
    )


def compare(case: str, steps: int, has_noise: bool) -> None:
    design = load(case)
    grid = Grid({"3 kHz": 3, "20 kHz": 2}.get(case, 1))
    pads = [Pad.from_design(design, Pose(tilt)) for tilt in (2.0, 8.0)]
    time_s = np.arange(steps) / design.detector.sample_rate_hz
    force_n = np.stack(
        [
            np.maximum(0.0, np.sin(20 * time_s) + 0.1 * np.sin(900 * time_s + i)) + 0.2 * i
            for i in (0, 1)
        ]
    )
    readout = Readout(design, pads, 7 if has_noise else None, ("thumb", "index"))
    samples = [readout.step(force_n[:, i]) for i in range(steps)]
    for i, name in enumerate(("thumb", "index")):
        whole = simulate_whole(design, pads[i], force_n[i], has_noise, name, grid)
        output = whole.sampled_filtered_v if readout.has_filtered else whole.sampled_envelope_v
        expected = (whole.tactile_v, whole.filtered_v, whole.envelope_v, whole.voltage_v, output)
        for field, values in zip(module.ReadoutSample._fields, expected, strict=False):
            assert np.array_equal([getattr(sample, field)[i] for sample in samples], values), (
                name,
                field,
            )
        detector = design.detector
        codes = np.array([sample.tactile_code[i] for sample in samples])
        step_v = (detector.adc_range_v - detector.adc_low_v) / 2**detector.adc_bits
        assert np.array_equal(codes, np.round((whole.voltage_v - detector.adc_low_v) / step_v))
        assert np.ptp(whole.filtered_v) > 0.1


@pytest.mark.every_case
@pytest.mark.parametrize("has_noise", [False, True])
def test_steps_give_the_bits_of_the_whole_in_plain_python(
    has_noise: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_compile", lambda: module._readout_loop)
    monkeypatch.setattr(module, "_BLOCK", 37)  # noise is drawn anew several times
    compare("fsr400", 120, has_noise)


@pytest.mark.full
@pytest.mark.parametrize("has_noise", [False, True])
@pytest.mark.parametrize("case", CASES)
def test_steps_give_the_bits_of_the_whole_compiled(case: str, has_noise: bool) -> None:
    with jit.compiled():
        compare(case, 3000, has_noise)


def test_a_finger_without_a_pad_takes_the_force_on_its_sensor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "_compile", lambda: module._readout_loop)
    for case in ("fsr400", "comparator"):
        design = load(case)
        pad = Pad.from_design(design)
        share = float(pad.sensed_n(np.ones(1))[0])
        if bridge.reads_whole_finger(design, "board"):
            share -= pad.rest_n  # which such a curve holds
        readout = Readout(design, [pad, None])
        for _ in range(3):
            sample = readout.step(np.array([1.0, share]))
        assert sample.tactile_v[1] == pytest.approx(sample.tactile_v[0], abs=1e-12)
        assert (
            abs(Readout(design, [None]).step(np.zeros(1)).tactile_v[0] - sample.tactile_v[0]) > 0.05
        )
        towards = Readout(design, [pad]).step(np.ones(1), np.ones(1)).tactile_v
        assert float(pad.sensed_n(np.ones(1), np.ones(1))[0]) > share
        assert towards[0] != sample.tactile_v[0]


def test_what_cannot_be_read_out_is_refused() -> None:
    design = Design.load("fsr400", changes=["detector.sample_rate_hz=2345"])
    with pytest.raises(
        FingertipError, match="2345 Hz does not divide the grid of the simulation; choose 2000"
    ):
        Readout(design, [None])
    with pytest.raises(FingertipError, match="names 0 fingers"):
        Readout(Design(), [])
