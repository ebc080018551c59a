"""Board and slip pin in the time domain: against closed forms,
scipy, fine steps and ngspice; extreme inputs.
"""

from __future__ import annotations

import itertools
import math
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers.spice import Spice, sampled_source
from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.parts.nets import FILTERED
from fingertip.design.formulas.amplifiers import choose_amplifier, find_gain_bandwidth_hz
from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compile_for_process, compiled
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.analog_circuit import (
    Amplifiers,
    AnalogBoard,
    Diode,
    augment,
    compute_state_space,
    exponentials,
)
from fingertip.sim.signal.envelope_loop import RECOVERY_V, wright_omega
from fingertip.sim.signal.filter_board import (
    AnalogStream,
    Comparator,
    ComparatorStream,
    simulate_board,
)
from tests.designs import ARTICLE, article_design
from tests.oracles.filter_formulas import filter_transfer
from tests.oracles.ideal_filter import ideal_filter_transfer
from tests.tools import require_tool

BOARD = AnalogBoard.from_design(ARTICLE, "ideal")

REAL = AnalogBoard.from_design(ARTICLE)

STEP_S = 1 / 2000

PRECISION = AnalogBoard.from_design(article_design(board={"variant": "precision"}), "ideal")
"""Its envelope is computed by software."""
RECTIFIER = AnalogBoard.from_design(article_design(board={"variant": "comparator"}), "ideal")
"""Its amplifiers rectify."""

STIFF_BOARDS = {
    "as fitted": BOARD,
    "Is 1e-14": replace(BOARD, diode=Diode(1e-14, 1.0)),
    "Is 1e-6": replace(BOARD, diode=Diode(1e-6, 1.0)),
    "Rs 0": replace(BOARD, diode=Diode(series_ohm=0.0)),
    "Rs 1G": replace(BOARD, diode=Diode(series_ohm=1e9)),
    "R 1G": BOARD.with_components(R6=1e9),
    "C 1p": BOARD.with_components(C4=1e-12),
    "C 1p, Rs 0, Is 1e-14": replace(BOARD.with_components(C4=1e-12), diode=Diode(1e-14, 1.0, 0.0)),
    "all C 1p": BOARD.with_components(C1=1e-12, C2=1e-12, C3=1e-12, C4=1e-12),
    "R 1G, C 1p": BOARD.with_components(R1=1e9, R2=1e9, R3=1e9, R6=1e9, C4=1e-12),
    "real": REAL,
    "precision": PRECISION,
    "rectifier, C 1p, real": AnalogBoard.from_design(
        article_design(board={"variant": "comparator"})
    ).with_components(C4=1e-12),
}


def constant_gain(board: AnalogBoard) -> float:
    """Gain of the first stage without C14 and C20, 1 + R5 / R4."""
    return 1 + float(board.components["R5"] / board.components["R4"])


def first_stage_gain(board: AnalogBoard, frequency: float) -> complex:
    """Gain of the precision board's first stage, 1 + Z5 / Z4: R5
    parallel to C20 over R4 in series with C14.
    """
    c = board.components
    s = 2j * math.pi * frequency
    return 1 + c["R5"] / (1 + s * c["R5"] * c["C20"]) / (c["R4"] + 1 / (s * c["C14"]))


def burst(seconds: float = 0.5) -> np.ndarray:
    time = np.arange(round(seconds / STEP_S) + 1) * STEP_S
    return 4.0 + np.where((time > 0.1) & (time < 0.35), 0.02 * np.sin(2 * math.pi * 90 * time), 0.0)


def test_omega_agrees_with_scipy_over_its_range():
    from scipy.special import wrightomega

    assert wright_omega(-800.0) == 0.0
    y = np.concatenate((np.linspace(-45, 60, 20_001), [-60.0, 1e5]))
    error = np.abs(np.array([wright_omega(a) for a in y.tolist()]) / wrightomega(y) - 1)
    assert error.max() < 1e-14
    assert error[y > -4.0].max() < 2e-15  # of both


# At 1 pF the rates span nine decades, and scipy's own result moves by 1.5e-11 with the BLAS of the
# processor.
@pytest.mark.parametrize(("capacitor_f", "bound"), [(1e-6, 1e-12), (1e-12, 1e-10)])
def test_exponentials_agree_with_scipy(capacitor_f, bound):
    from scipy.linalg import expm

    system = compute_state_space(
        BOARD.with_components(C1=capacitor_f, C2=capacitor_f, C3=capacitor_f)
    )
    M = augment(system.A, system.b, np.ones((1, 3, 1)))
    for level, ours in enumerate(exponentials(M, STEP_S, 6)[0]):
        theirs = expm(M[0] * STEP_S / 2**level)
        assert np.abs(ours - theirs).max() < bound * np.abs(theirs).max()


@pytest.mark.full
def test_agrees_with_ngspice():
    voltage = burst()
    ours = simulate_board(BOARD, STEP_S, voltage, 1e-8)
    program = require_tool(
        "ngspice", "run `sh .ci/install-ngspice` as root on Debian, or install ngspice"
    )
    time = np.arange(len(voltage)) * STEP_S
    simulator = Spice(program, BOARD, sampled_source(STEP_S, voltage), STEP_S, float(time[-1]))
    found, *columns = simulator.simulate(1e-6, 2e-5)
    filtered, envelope = (np.interp(time, found, column) for column in columns)
    assert np.abs(filtered - ours.filtered_v).max() < 1e-4
    assert np.abs(envelope - ours.envelope_v).max() < 2e-4
    assert ours.envelope_v.max() > 0.5


@pytest.mark.full
def test_error_falls_with_the_fourth_power_of_the_step():
    """The diode conducts nearly all the time, so that the stages of SDIRK4 determine the error."""
    t = np.arange(400) / 2000
    tone = 0.03 * np.sin(2 * np.pi * 120 * t)
    exact = simulate_board(BOARD, 1 / 2000, tone, 1e-11).envelope_v
    coarse, fine = (simulate_board(BOARD, 1 / 2000, tone, tolerance) for tolerance in (1e-4, 1e-7))
    assert min(run.implicit / run.steps for run in (coarse, fine)) > 0.8
    errors = [np.abs(run.envelope_v - exact).max() for run in (coarse, fine)]
    assert math.log(errors[0] / errors[1]) / math.log(fine.steps / coarse.steps) > 3.7


def test_steps_are_few_and_a_constant_input_needs_one_per_sample():
    constant = simulate_board(BOARD, STEP_S, np.full(1001, 4.3))
    assert (constant.steps, constant.rejected, constant.implicit) == (1000, 0, 0)
    assert np.abs(constant.envelope_v).max() < 1e-9
    found = simulate_board(BOARD, STEP_S, burst())
    assert found.steps < 1.8 * 1000
    assert found.rejected < 0.15 * found.steps
    assert found.implicit < 0.9 * 1000


@pytest.mark.parametrize(
    ("parts", "what", "tolerance"),
    [
        *((parts, "burst", 1e-5) for parts in STIFF_BOARDS),
        *((parts, "100 V jump", 1e-3) for parts in STIFF_BOARDS),
        *(
            (parts, "100 V ramp", 1e-5)
            for parts in ("as fitted", "C 1p, Rs 0, Is 1e-14", "rectifier, C 1p, real")
        ),
        *(
            (parts, what, 1e-3)
            for parts in ("as fitted", "precision")
            for what in ("zero", "denormal")
        ),
    ],
)
def test_extreme_components_and_inputs_give_bounded_envelopes(parts, what, tolerance):
    board = STIFF_BOARDS[parts]
    sample = np.arange(len(burst()))
    peak_v = {"100 V jump": 100.0, "100 V ramp": 100.0, "zero": 0.0, "denormal": 1e-310}
    voltage = burst() if what == "burst" else np.where(sample > 200, peak_v[what], 0.0)
    after = np.where(sample >= 200, 100.0, 0.0) if what == "100 V jump" else None
    with compiled():
        found = simulate_board(board, STEP_S, voltage, tolerance, after)
        finer = simulate_board(board, STEP_S, voltage, tolerance / 10, after)
    assert np.isfinite(found.envelope_v).all()
    assert np.isfinite(found.filtered_v).all()
    # The envelope stays between the reverse current's voltage and the filter's maximum, and does
    # not oscillate.
    maximum = constant_gain(board) * np.ptp(
        np.append(voltage, after if after is not None else voltage)
    )
    if board.amplifiers:
        maximum = min(maximum, board.amplifiers.peak_v)
    assert np.abs(found.envelope_v - finer.envelope_v).max() < 3 * tolerance + 1e-8 * maximum
    assert found.envelope_v.max() <= maximum + tolerance
    reverse_v = (
        0.0 if board.rectifier == "precision" else board.diode.saturation_a * board.components["R6"]
    )
    assert found.envelope_v.min() >= -reverse_v - tolerance
    assert found.steps < 100_000
    if what in ("zero", "denormal"):
        assert np.abs(found.envelope_v).max() < tolerance


def test_amplifiers_limit_the_output_and_delay_small_signals():
    strong = 50 * (burst() - 4.0)
    clipped = simulate_board(REAL, STEP_S, strong)
    assert clipped.filtered_v.max() == 3.5
    assert clipped.steps < 9500, "moments of clipping are found to a nanosecond, and no closer"
    assert clipped.clips[300:600].mean() > 0.2 > clipped.clips[:200].max() == 0.0
    # The first stage lags by the inverse of its bandwidth, 4 MHz over its gain, at a slope of some
    # 800 V/s.
    ideal, real = (simulate_board(board, STEP_S, burst(), 1e-6) for board in (BOARD, REAL))
    lag_s = constant_gain(REAL) / (2 * math.pi * 4e6)
    steepest = np.abs(np.diff(ideal.filtered_v)).max() / STEP_S
    assert np.abs(real.filtered_v - ideal.filtered_v).max() == pytest.approx(
        lag_s * steepest, rel=0.3
    )
    assert not real.clips.any()


def test_an_input_below_its_range_makes_the_output_jump_up():
    time = np.arange(4000) / 1e5
    dip = np.where(
        time > 0.005, -0.05 * np.sin(2 * math.pi * 150 * np.maximum(time - 0.005, 0.0)), 0.0
    )
    found = simulate_board(REAL, 1e-5, dip, 1e-6)
    first = int(np.argmax(found.clips > 0.0))
    assert found.filtered_v[first - 1] == pytest.approx(-2.0, abs=0.05)
    assert found.filtered_v[first : first + 5].max() == 3.5
    limited = replace(REAL, amplifiers=replace(REAL.amplifiers, reversal_v=None))
    assert simulate_board(limited, 1e-5, dip, 1e-6).filtered_v[first : first + 5].max() < -1.9


@pytest.mark.parametrize(("peak_v", "clips", "bound_v"), [(0.02, False, 1e-5), (0.05, True, 8e-4)])
def test_a_board_whose_output_can_jump_follows_an_input_that_bends(peak_v, clips, bound_v):
    """Every step gives two points of a sine and its area; the
    reference takes 64 straight lines a step.
    """
    w = 2 * math.pi * 140
    found = []
    for parts in (1, 64):
        time = np.arange(200 * parts + 1) * (1e-4 / parts)
        voltage = peak_v * np.sin(w * time)
        area = -np.diff(peak_v * np.cos(w * time)) / (w * time[1])
        bend = np.append(0.0, 2 * area - voltage[1:] - voltage[:-1]) if parts == 1 else None
        stream = AnalogStream(REAL, 1e-4 / parts, 1e-6)
        found.append(stream.process(voltage, None, bend)[1][::parts])
        assert stream.clips.any() == clips
    assert np.abs(found[0] - found[1]).max() < bound_v


def solve_apart(values, diode, amplifier, u, v_step_s, h, out):
    """Envelope of the article's board by Euler's explicit rule,
    from Kirchhoff's laws written down here.
    """
    c1, c2, c3, c4, r1, r2, r3, r4, r5, r6, cin = values
    saturation, nvt, series = diode
    gbw, slew, top, bottom, reversal, recovery = amplifier
    plus = minus = first = middle = second = output = envelope = current = 0.0
    is_up = False
    for i in range(len(u) - 1):
        slope = (u[i + 1] - u[i]) / v_step_s
        for _ in range(round(v_step_s / h)):
            d_plus = (c1 * slope - plus / r1) / (c1 + cin)
            d_minus = ((first - minus) / r5 - minus / r4) / cin
            d_first = min(max(gbw * (plus - minus - first / 2e5), -slew), slew)
            if (first >= top and d_first > 0.0) or (first <= bottom and d_first < 0.0):
                d_first = 0.0
            # C2 (first' - middle') + C3 (second' - middle') + (output - middle) / R2 = 0, and at
            # the second input C3 (middle' - second') = second / R3 + Cin second'.
            total = c3 + cin
            drawn = second / r3
            d_middle = (c2 * d_first + (output - middle) / r2 - c3 * drawn / total) / (
                c2 + c3 - c3 * c3 / total
            )
            d_second = (c3 * d_middle - drawn) / total
            is_up = second < reversal + (recovery if is_up else 0.0)
            d_output = (
                slew if is_up else min(max(gbw * (second - output - output / 2e5), -slew), slew)
            )
            # One step of Newton's method for the diode, from the current before.
            excess = (
                nvt * math.log(1.0 + current / saturation) + series * current - (output - envelope)
            )
            current = max(
                current - excess / (nvt / (saturation + current) + series), -0.999 * saturation
            )
            envelope += h * (current - envelope / r6) / c4
            plus = plus + h * d_plus
            minus = minus + h * d_minus
            middle = middle + h * d_middle
            second = second + h * d_second
            first = first + h * d_first
            output = min(max(output + h * d_output, bottom), top)
        out[i + 1] = envelope


@pytest.mark.full
@pytest.mark.parametrize(("peak_v", "clips"), [(0.025, False), (0.06, True)])
def test_real_amplifiers_agree_with_an_independent_solver(peak_v, clips):
    c = REAL.components
    a = REAL.amplifiers
    d = REAL.diode
    time = np.arange(110) * 1e-4
    voltage = peak_v * np.sin(2 * math.pi * 120 * time) * np.minimum(time / 0.005, 1.0)
    ours = simulate_board(REAL, 1e-4, voltage, 1e-4)
    theirs = np.zeros(len(voltage))
    values = (
        *(c[name] for name in ("C1", "C2", "C3", "C4", "R1", "R2", "R3", "R4", "R5", "R6")),
        8e-12,
    )
    limits = (
        2 * math.pi * a.bandwidth_hz,
        a.slew_v_per_s,
        a.peak_v,
        -a.trough_v,
        -a.reversal_v,
        RECOVERY_V,
    )
    diode = d.saturation_a, d.emission * d.thermal_v, d.series_ohm
    compile_for_process(solve_apart)(values, diode, limits, voltage, 1e-4, 1e-9, theirs)
    assert ours.clips.any() == clips
    assert theirs.max() > 0.5
    assert np.abs(ours.envelope_v - theirs).max() < 1e-3


@pytest.mark.parametrize("board", [PRECISION, RECTIFIER], ids=["software", "amplifiers"])
def test_rectifier_has_no_dead_zone(board):
    """The mean of a half-wave rectified sine is its peak / pi, however small the sine."""
    assert board.rectifier == "precision"
    time = np.arange(64_000) / 32_000
    for volt in (1e-6, 1e-2):
        out = simulate_board(
            board, 1 / 32_000, volt * np.sin(2 * math.pi * 200 * time), volt * 1e-4
        )
        peak = out.filtered_v[32_000:].max()
        assert out.envelope_v[32_000:].mean() == pytest.approx(peak / math.pi, rel=1e-3)
        article = simulate_board(
            BOARD, 1 / 32_000, volt * np.sin(2 * math.pi * 200 * time), volt * 1e-4
        )
        assert (article.envelope_v[32_000:].mean() < 1e-3 * peak) == (volt == 1e-6)


def test_precision_rectifier_follows_a_step_with_one_pole():
    """The filter passes a step but for C20: the gain begins at 1
    and rises with the time constant R5 C20.
    """
    board = RECTIFIER.with_components(C1=1.0, C2=1.0, C3=1.0, C14=1.0)
    voltage = np.where(np.arange(40) >= 1, 0.01, 0.0)
    after = np.where(np.arange(40) >= 0, 0.01, 0.0)
    out = simulate_board(board, STEP_S, voltage, 1e-8, after).envelope_v
    c = board.components
    time = np.arange(40) * STEP_S
    top = 0.01 * constant_gain(board)
    tau = c["R6"] * c["C4"]
    rise = c["R5"] * c["C20"]
    assert tau == pytest.approx(2000 * 2.2e-6)
    missing = (top - 0.01) / (1 - tau / rise)
    expected = top * (1 - np.exp(-time / tau)) + missing * (
        np.exp(-time / tau) - np.exp(-time / rise)
    )
    assert out == pytest.approx(expected, abs=1e-4 * top)


@pytest.mark.parametrize("reference", ["R16", "R17", "R15"])
def test_rectifier_resistors_set_the_gain_of_the_envelope(reference):
    """The rectifier amplifies by R16 / R15, and the low-pass by R6 / R17."""
    voltage = burst(0.2)
    components = RECTIFIER.components
    ratio = {"R16": 1.25, "R15": 0.8, "R17": 0.8}[reference]
    changed = RECTIFIER.with_components(**{reference: components[reference] * ratio})
    before = simulate_board(RECTIFIER, STEP_S, voltage, 1e-7)
    after = simulate_board(changed, STEP_S, voltage, 1e-7)
    assert np.array_equal(before.filtered_v, after.filtered_v)
    assert after.envelope_v == pytest.approx(1.25 * before.envelope_v, rel=1e-12)
    assert before.envelope_v.max() > 0.1


def test_software_follows_the_filtered_voltage_as_amplifiers_with_the_same_pole_do():
    """R6 and C4 of E24 and E6 miss the design's 36.17 Hz by 4e-5."""
    voltage = burst(0.2)
    software, amplifiers = (
        simulate_board(board, STEP_S, voltage, 1e-7) for board in (PRECISION, RECTIFIER)
    )
    top_v = amplifiers.envelope_v.max()
    # The comparator's board loads the filter with R15, which moves the filtered voltage by some
    # 1e-5.
    assert np.abs(software.envelope_v - amplifiers.envelope_v).max() < 1e-3 * top_v
    slow = AnalogBoard.from_design(
        article_design(board={"variant": "precision", "envelope_cutoff_hz": 18.0}), "ideal"
    )
    assert simulate_board(slow, STEP_S, voltage, 1e-7).envelope_v.max() < 0.8 * top_v


@pytest.mark.parametrize("gain_bandwidth_hz", [None, 3e4, 3e6])
@pytest.mark.parametrize("variant", ["article", "precision"])
def test_state_equations_have_the_transfer_function_of_the_formulas(variant, gain_bandwidth_hz):
    """At 1 MHz the inputs' capacitance and the amplifiers'
    bandwidth determine the transfer function.
    """
    design = article_design(board={"variant": variant})
    real = Amplifiers.from_design(design)
    values = board_values(design)
    chosen = replace(real, bandwidth_hz=gain_bandwidth_hz) if gain_bandwidth_hz else "ideal"
    board = AnalogBoard.from_design(design, chosen)
    system = compute_state_space(board)
    A = system.A[0]
    b = system.b[0]
    row = system.rows[FILTERED][0]
    n = len(A)
    for frequency in (1.0, 20.0, 67.0, 400.0, 1e4, 1e6):
        if gain_bandwidth_hz:
            stages = values.first_stage_capacitors
            input_f = choose_amplifier(design.board).input_f
            expected = filter_transfer(
                frequency, values.preferred, gain_bandwidth_hz, stages, input_f
            )
        else:
            ratio = (
                first_stage_gain(board, frequency) / constant_gain(board)
                if variant == "precision"
                else 1.0
            )
            expected = ideal_filter_transfer(frequency, values.preferred) * ratio
        found = row[:n] @ np.linalg.solve(2j * math.pi * frequency * np.eye(n) - A, b) + row[n]
        assert found == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("parts", ["as fitted", "real", "precision", "C 1p"])
def test_any_chunks_give_the_same_bits(parts):
    board = STIFF_BOARDS[parts]
    cuts = [0, 1, 2, 21, 300, 301, 555, 601]
    for row in (burst(0.3), 3 * burst(0.3), np.zeros(601)):
        stream = AnalogStream(board, STEP_S)
        whole = simulate_board(board, STEP_S, row)
        chunks = [stream.process(row[a:b]) for a, b in itertools.pairwise(cuts)]
        assert np.array_equal(
            np.concatenate([filtered for filtered, _ in chunks]), whole.filtered_v
        )
        assert np.array_equal(
            np.concatenate([envelope_v for _, envelope_v in chunks]), whole.envelope_v
        )
    with pytest.raises(TraceError, match=r"voltage_v: nan at sample 1 \(and 1 more after it\)"):
        stream.process(np.array([1.0, math.nan, math.inf]))


PIN_DESIGN = article_design(board={"variant": "comparator"})

PIN_BOARD = AnalogBoard.from_design(PIN_DESIGN)

PLAIN = Comparator(0.015, 0.02, 0.015)


def simulate_comparator(
    comparator, board, step_s, filtered_v, envelope_v
) -> tuple[np.ndarray, np.ndarray]:
    return ComparatorStream(comparator, board, step_s).process(filtered_v, envelope_v)


def slip_voltage(seconds: float = 0.6) -> np.ndarray:
    """Tactile voltage with a slow increase of force and then a burst of vibration [V]."""
    time = np.arange(round(seconds / STEP_S) + 1) * STEP_S
    press = 0.3 * np.clip((time - 0.02) / 0.05, 0.0, 1.0)
    shake = 0.004 * np.sin(2 * math.pi * 95 * time) + 0.002 * np.sin(2 * math.pi * 143 * time)
    return 4.3 - press + np.where((time > 0.2) & (time < 0.4), shake, 0.0)


@pytest.mark.every_case
@pytest.mark.parametrize(("start_v", "filtered_v"), [(0.0, 0.05), (0.06, -0.3), (0.06, 0.01)])
def test_comparator_switches_when_the_mean_of_an_exponential_envelope_crosses_its_threshold(
    start_v, filtered_v
):
    """E = end + (start - end) exp(-t / T), end = max(u, 0): the mean
    has the same term, and one with its own tau.
    """
    decay_s = float(PIN_BOARD.envelope_decay_s)
    end_v = max(filtered_v, 0.0)
    tau_s = 0.015
    time_s = np.arange(400) * STEP_S
    falling = np.exp(-time_s / decay_s)
    share = decay_s / (decay_s - tau_s)
    exact_v = end_v + (start_v - end_v) * (share * falling + (1 - share) * np.exp(-time_s / tau_s))
    level_v = end_v + (start_v - end_v) * falling
    mean_v, on = simulate_comparator(PLAIN, PIN_BOARD, STEP_S, np.full(400, filtered_v), level_v)
    assert mean_v == pytest.approx(exact_v, abs=1e-8)
    assert np.array_equal(on, exact_v > 0.02 if start_v < end_v else exact_v >= 0.015)
    assert np.diff(on).sum() == 1


def test_mean_and_output_equal_those_of_a_finer_grid():
    """The finer grid samples the same piecewise linear input forty times as often."""
    voltage = slip_voltage()
    many = 40
    fine = np.interp(
        np.arange((len(voltage) - 1) * many + 1) / many, np.arange(len(voltage)), voltage
    )
    comparator = Comparator.from_design(PIN_DESIGN)
    found = []
    for step, samples in ((STEP_S, voltage), (STEP_S / many, fine)):
        out = simulate_board(PIN_BOARD, step, samples, 1e-7)
        found.append(
            simulate_comparator(comparator, PIN_BOARD, step, out.filtered_v, out.envelope_v)
        )
    (mean_v, on), (fine_v, fine_on) = found
    assert np.diff(on).sum() == np.diff(fine_on).sum() >= 2
    assert np.array_equal(on, fine_on[::many])
    assert np.abs(mean_v - fine_v[::many]).max() < 2e-5


@pytest.mark.full
def test_netlist_in_ngspice_switches_at_the_same_moments(tmp_path):
    """The deck has real diodes, amplifiers of 3 MHz and a
    switch; a source replaces its first stage.
    """
    # Ngspice takes 0.35 s to settle.
    voltage = np.concatenate((np.full(700, 4.3), slip_voltage())) - 2.0
    program = require_tool(
        "ngspice", "run `sh .ci/install-ngspice` as root on Debian, or install ngspice"
    )
    design = article_design(board={"variant": "comparator", "supply_v": 3.3})
    values = board_values(design)
    deck = spice_deck(board_circuit(values), find_gain_bandwidth_hz(design.board), 3.3).decode()
    # The transimpedance stage leaves for the source in its place.
    starts = (
        ".ac",
        ".print",
        "XU2a ",
    )
    lines = [line for line in deck.splitlines() if not (line.startswith(starts) or line == ".end")]
    points = "\n".join(f"+ {i * STEP_S:.9g} {v:.15g}" for i, v in enumerate(voltage.tolist()))
    lines += [
        f"Vdrive tactile 0 PWL(\n{points}\n+ )",
        ".options reltol=1e-5",
        ".control",
        "set wr_singlescale",
    ]
    lines += [f"tran 2e-5 {(len(voltage) - 1) * STEP_S:.9g} 0 2e-5"]
    lines += ["let above = v(envelope) - v(vmid)", "wrdata out above v(slip)", "quit"]
    (tmp_path / "slip.cir").write_text("\n".join([*lines, ".endc", ".end", ""]))
    subprocess.run([program, "-b", "slip.cir"], cwd=tmp_path, check=True, capture_output=True)
    theirs = np.loadtxt(next(tmp_path.glob("out*")))
    time = theirs[:, 0]
    envelope = theirs[:, 1]
    pin = theirs[:, 2]
    switched = np.flatnonzero(((pin[:-1] < 1.6) != (pin[1:] < 1.6)) & (time[1:] > 0.35))

    board = AnalogBoard.from_design(design)
    out = simulate_board(board, STEP_S, voltage, 1e-6)
    _, on = simulate_comparator(
        Comparator.from_design(design), board, STEP_S, out.filtered_v, out.envelope_v
    )
    changed_s = (np.flatnonzero(np.diff(on)) + 0.5) * STEP_S
    assert len(changed_s) >= 4
    assert changed_s == pytest.approx(time[switched + 1], abs=STEP_S / 2 + 1e-4)
    at_samples = np.interp(np.arange(len(voltage)) * STEP_S, time, envelope)[700:]
    assert np.abs(out.envelope_v[700:] - at_samples).max() < 2e-3 * out.envelope_v.max()


@pytest.mark.full
def test_scene_outputs_the_slip_pin_only_for_boards_that_have_one():
    hold = {"min_force_n": 1.0, "max_force_n": 1.0}
    slide = {"distance_m": 0.02}
    tables = SceneFile(
        contact={"surface": "gross"}, hold=hold, slide=slide, outputs=["slip", "slip_pin_v"]
    )
    found = run_scene(PIN_DESIGN, tables, 1)
    stages = [stage.name for stage in found.stages]
    assert stages[stages.index("filter board") :][:2] == ["filter board", "comparator"]
    low = found.columns["slip_pin_v"] < 1.65
    assert set(found.columns["slip_pin_v"].tolist()) == {0.0, 3.3}
    assert low[found.columns["slip"]].mean() > 0.8
    hand = ManipulationFile(grasp={"kind": "pinch"}, outputs=["slip_pin_v", "envelope_v"])
    assert run_manipulation(PIN_DESIGN, hand, None, 1).columns["index_slip_pin_v"].min() == 0.0
