"""Slip pin of variant comparator: against closed forms, fine steps, and the netlist's own deck in ngspice."""

from __future__ import annotations

import math
import subprocess

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.circuits.spice import spice_deck
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.sim import ManipulationFile, SceneFile, run_manipulation, run_scene
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import Comparator, ComparatorSignals, ComparatorStream, simulate_board
from tests.designs import article_design
from tests.tools import require_tool

DESIGN = article_design(board={"variant": "comparator"})
BOARD = AnalogBoard.from_design(DESIGN)
STEP_S = 1 / 2000
PLAIN = Comparator(0.015, 0.02, 0.015)


def simulate_comparator(comparator, board, step_s, filtered_v, envelope_v) -> ComparatorSignals:
    return ComparatorStream(comparator, board, step_s).process(filtered_v, envelope_v)


def slip_voltage(seconds: float = 0.6) -> np.ndarray:
    """Tactile voltage with a slow increase of force and then a burst of vibration [V]."""
    time = np.arange(round(seconds / STEP_S) + 1) * STEP_S
    press = 0.3 * np.clip((time - 0.02) / 0.05, 0.0, 1.0)
    shake = 0.004 * np.sin(2 * math.pi * 95 * time) + 0.002 * np.sin(2 * math.pi * 143 * time)
    return 4.3 - press + np.where((time > 0.2) & (time < 0.4), shake, 0.0)


def test_step_switches_when_the_exponential_mean_crosses_the_threshold():
    """The envelope steps to a constant v, so m = v (1 - exp(-t / tau))."""
    n = 400
    level = np.full(n, 0.05)
    level[0] = 0.0
    filtered = np.full(n, 0.05)  # max(u, 0) = v: slope 0
    filtered[0] = 0.0
    found = simulate_comparator(PLAIN, BOARD, STEP_S, filtered, level)
    # Over the first sample the cubic climbs from 0 to 0.05 with slopes 0: half of it, on average.
    exact = STEP_S / 2 - 0.015 * math.log(1 - 0.02 / 0.05)
    assert found.edges_s == pytest.approx([exact], abs=2e-6)
    assert found.mean_v[-1] == pytest.approx(0.05, rel=1e-5)
    assert not found.on[: int(exact / STEP_S)].any()
    assert found.on[int(exact / STEP_S) + 1 :].all()


def test_edges_between_samples_equal_those_of_a_finer_grid():
    """The finer grid samples the same piecewise linear input forty times as often."""
    voltage, many = slip_voltage(), 40
    fine = np.interp(np.arange((len(voltage) - 1) * many + 1) / many, np.arange(len(voltage)), voltage)
    comparator = Comparator.from_design(DESIGN)
    edges = []
    for step, samples in ((STEP_S, voltage), (STEP_S / many, fine)):
        out = simulate_board(BOARD, step, samples, 1e-7)
        edges.append(simulate_comparator(comparator, BOARD, step, out.filtered_v, out.envelope_v).edges_s)
    assert len(edges[0]) == len(edges[1]) >= 2
    assert np.abs(edges[0] - edges[1]).max() < 2e-6
    assert np.abs((edges[0] / STEP_S + 0.5) % 1 - 0.5).max() > 0.05  # at least one edge lies between samples


def test_hysteresis_keeps_the_output_on():
    time = np.arange(4000) * STEP_S
    level = 0.0175 + 0.002 * np.sin(2 * math.pi * 2 * time)  # between both thresholds
    dipped = np.where((time > 0.5) & (time < 0.6), 0.06, level)
    still = simulate_comparator(PLAIN, BOARD, STEP_S, level, level)
    assert len(still.edges_s) == 0
    assert not still.on.any()
    once = simulate_comparator(PLAIN, BOARD, STEP_S, dipped, dipped)
    assert len(once.edges_s) == 1
    assert once.on[-1]


@pytest.mark.full
@pytest.mark.parametrize("supply", ["split", "single"])
def test_netlist_in_ngspice_switches_at_the_same_moments(supply, tmp_path):
    """The deck has real diodes, amplifiers of 3 MHz and a switch; a source replaces its bridge."""
    voltage = np.concatenate((np.full(700, 4.3), slip_voltage()))  # ngspice takes 0.35 s to settle
    program = require_tool("ngspice", "run `sh .ci/install-ngspice` as root on Debian, or install ngspice")
    design = article_design(board={"variant": "comparator", "supply": supply})
    values = board_values(design)
    ground = "v(vmid)" if supply == "single" else "0"
    deck = spice_deck(board_circuit(values), find_gain_bandwidth_hz(design.board), 5.0).decode()
    ends = (" instrumentation", ".end")  # the bridge's amplifier, for the source in its place
    lines = [line for line in deck.splitlines() if not (line.startswith((".ac", ".print")) or line.endswith(ends))]
    points = "\n".join(f"+ {i * STEP_S:.9g} {v:.15g}" for i, v in enumerate(voltage.tolist()))
    lines += [f"Vdrive tactile 0 PWL(\n{points}\n+ )", ".options reltol=1e-5", ".control", "set wr_singlescale"]
    lines += [f"tran 2e-5 {(len(voltage) - 1) * STEP_S:.9g} 0 2e-5"]
    lines += [f"let above = v(envelope) - {ground}", "wrdata out above v(slip)", "quit"]
    (tmp_path / "slip.cir").write_text("\n".join([*lines, ".endc", ".end", ""]))
    subprocess.run([program, "-b", "slip.cir"], cwd=tmp_path, check=True, capture_output=True)
    theirs = np.loadtxt(next(tmp_path.glob("out*")))
    time, envelope, pin = theirs[:, 0], theirs[:, 1], theirs[:, 2]
    switched = np.flatnonzero(((pin[:-1] < 2.5) != (pin[1:] < 2.5)) & (time[1:] > 0.35))

    board = AnalogBoard.from_design(design, find_gain_bandwidth_hz(design.board))
    out = simulate_board(board, STEP_S, voltage, 1e-6)
    ours = simulate_comparator(Comparator.from_design(design), board, STEP_S, out.filtered_v, out.envelope_v)
    assert len(ours.edges_s) >= 4
    assert ours.edges_s == pytest.approx(time[switched + 1], abs=1e-4)
    at_samples = np.interp(np.arange(len(voltage)) * STEP_S, time, envelope)[700:]
    assert np.abs(out.envelope_v[700:] - at_samples).max() < 2e-3 * out.envelope_v.max()


def test_scene_outputs_the_slip_pin_only_for_boards_that_have_one():
    tables = SceneFile(
        contact={"surface": "gross"},
        hold={"min_force_n": 1.0, "max_force_n": 1.0},
        slide={"distance_m": 0.02},
        outputs=["slip", "slip_pin_v"],
    )
    found = run_scene(DESIGN, tables, 1)
    assert [stage.name for stage in found.stages if "board" in stage.name or "comp" in stage.name][-2:] == [
        "filter board",
        "comparator",
    ]
    low = found.columns["slip_pin_v"] < 2.5
    assert set(found.columns["slip_pin_v"].tolist()) == {0.0, 5.0}
    assert low[found.columns["slip"]].mean() > 0.8
    hand = ManipulationFile(grasp={"kind": "pinch"}, outputs=["slip_pin_v", "envelope_v"])
    assert run_manipulation(DESIGN, hand, None, 1).columns["index_slip_pin_v"].min() == 0.0
