"""Analysis and the circuit's equations, compared with formulas,
closed forms and independent computations.
"""

from __future__ import annotations

import csv
import io
import json
import math
import random
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board.analysis.board_analysis import analyse, bode_table
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.loads import _find_margin_deg
from fingertip.board.analysis.response import FilterModel, decibel, model_filter, target_response
from fingertip.board.analysis.tolerance import (
    BAND_QUANTILES,
    COMPONENTS,
    QUANTITIES,
    TolerancedFilter,
    find_quantile_error,
    monte_carlo,
)
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import Network, Term, build_network, filter_quantities
from fingertip.board.circuits.transfer_function import Rational, find_stages, multiply
from fingertip.board.components.front_end import SUPPRESSOR_F
from fingertip.board.components.selection import FilterSelection, values_in_range
from fingertip.board.components.values import SUPPLIES, VARIANT_CHANGES
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE
from fingertip.cli.board_tables import analysis_text
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.design.formulas.filter import FilterComponents, ideal_components
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.numerics import Array
from tests.conftest import run_fingertip
from tests.designs import ARTICLE, ARTICLE_OPTIONS, load_article
from tests.oracles.filter_formulas import (
    comparator_threshold_v,
    envelope_offset_gains,
    envelope_pin_transfer,
    filter_transfer,
    first_stage_transfer,
    open_loop_transfer,
    overall_cutoff_hz,
    section_frequency_hz,
    section_quality,
    tactile_pin_transfer,
)
from tests.oracles.ideal_filter import ideal_filter_transfer

VALUES = board_values(ARTICLE)


def test_bode_table_agrees_with_the_formulas() -> None:
    rows = list(csv.DictReader(io.StringIO(bode_table(ARTICLE))))
    assert len(rows) == 201
    assert (float(rows[0]["frequency_hz"]), float(rows[-1]["frequency_hz"])) == (1.0, 1e5)
    for row in rows[::20]:
        f = float(row["frequency_hz"])
        assert float(row["whole_db"]) == pytest.approx(
            decibel(filter_transfer(f, VALUES.preferred, 4e6)), abs=2e-3
        )
        assert float(row["stage1_db"]) + float(row["stage2_db"]) == pytest.approx(
            float(row["whole_db"]), abs=2e-4
        )
        # Between the amplifier's corner frequency and its gain-bandwidth product, as in the
        # article's figure.
        if f > 100:
            assert float(row["gbw_over_f_db"]) == pytest.approx(
                decibel(open_loop_transfer(f, 4e6)), abs=0.1
            )
            assert float(row["whole_db"]) < float(row["gbw_over_f_db"])


def toleranced_filter(design: Design, bandwidth_hz: float | None = None) -> TolerancedFilter:
    circuit = board_circuit(board_values(design))
    board = design.board
    network = build_network(circuit, bandwidth_hz or find_gain_bandwidth_hz(board))
    return TolerancedFilter(model_filter(circuit), network.values)


FILTER = toleranced_filter(ARTICLE)
TOLERANCE = {name: 1.0 if name.startswith("R") else 5.0 for name in COMPONENTS[:8]}


@pytest.mark.full
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_quantities_of_random_boards_agree_with_the_circuits_equations(name: str) -> None:
    """Random values within 5 % are put into the circuit, whose equations give the gain."""
    design = load_article((*VARIANT_CHANGES[name], "board.band_limit_hz=270"))
    board = toleranced_filter(design)
    circuit = board_circuit(board_values(design))
    rng = np.random.default_rng(4)
    f = np.geomspace(20, 20e3, 6001)
    for deviations in 0.05 * rng.uniform(-1, 1, (5, len(board.names))):
        drawn = circuit
        for reference, deviation in zip(board.names, deviations.tolist(), strict=True):
            value = parse_component_value(circuit.component(reference).value) * (1 + deviation)
            drawn = drawn.replace(reference, f"{value:.12g}")
        path = (
            build_network(drawn, find_gain_bandwidth_hz(design.board))
            .drive("TACTILE")
            .restrict("FILTERED")
        )
        gain = np.abs(path.response(f, {"TACTILE": 1.0}, "FILTERED")[:, 0])
        passband = f[gain >= gain.max() / math.sqrt(2)]
        quantities = board.quantities(deviations)
        assert float(quantities["passband_gain"]) == pytest.approx(float(gain.max()), rel=1e-5)
        assert float(quantities["cutoff_hz"]) == pytest.approx(float(passband[0]), rel=1.5e-3)


def test_monte_carlo_agrees_with_scalar_formulas_board_by_board() -> None:
    """Both are estimates of the same spread, within their statistical errors."""
    rng = random.Random(5)
    base = [VALUES.by_reference[name] for name in FILTER.names]
    cutoffs = []
    for _ in range(4000):
        r1, r2, r3, _, _, c1, c2, c3 = (
            v * (1 + (0.01 if i < 5 else 0.05) * rng.uniform(-1, 1)) for i, v in enumerate(base)
        )
        f0 = 1 / (2 * math.pi * math.sqrt(r2 * r3 * c2 * c3))
        q = math.sqrt(r3 / r2) * math.sqrt(c2 * c3) / (c2 + c3)
        cutoffs.append(overall_cutoff_hz(1 / (2 * math.pi * r1 * c1), f0, q))
    mean = math.fsum(cutoffs) / len(cutoffs)
    deviation = math.sqrt(math.fsum((f - mean) ** 2 for f in cutoffs) / (len(cutoffs) - 1))
    spread = monte_carlo(FILTER, TOLERANCE)["cutoff_hz"]
    assert spread.mean == pytest.approx(mean, abs=5 * deviation / math.sqrt(4000))
    assert spread.deviation == pytest.approx(deviation, rel=0.06)
    assert (
        spread.worst_low
        < min(cutoffs)
        < spread.low_95
        < spread.high_95
        < max(cutoffs)
        < spread.worst_high
    )


@pytest.mark.parametrize("quantile", BAND_QUANTILES)
def test_error_of_a_quantile_is_that_of_its_scatter(quantile: float) -> None:
    """The mean over uniform draws agrees with the closed form, and 95 % of the intervals hold."""
    count = 2000
    draws = np.random.default_rng(3).random((400, count))
    errors = np.array([find_quantile_error(draw, quantile) for draw in draws])
    exact = 1.96 * math.sqrt(quantile * (1.0 - quantile) / count)
    scatter = errors.std(ddof=1) / math.sqrt(len(errors))
    # Ends on whole values are up to one value further out each.
    assert exact - 4.0 * scatter < errors.mean() < exact + 1.0 / count + 4.0 * scatter
    held = np.abs(np.quantile(draws, quantile, axis=1) - quantile) <= errors
    assert 0.92 < held.mean() < 0.99


def test_analysis_command_prints_tables_and_writes_the_bode_table(tmp_path: Path) -> None:
    table = tmp_path / "bode.csv"
    run = run_fingertip(
        "board",
        *ARTICLE_OPTIONS,
        "--analysis",
        "--bode",
        table,
        "--json",
        "--quiet",
        "--out",
        tmp_path / "pcb",
    )
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert set(data["analysis"]["spread"]) == set(QUANTITIES)
    assert table.read_text().startswith("frequency_hz,")
    assert str(table) in data["files"]
    text = run_fingertip(
        "board", *ARTICLE_OPTIONS, "--analysis", "--quiet", "--out", tmp_path / "pcb"
    ).stdout
    assert analysis_text(ARTICLE, analyse(ARTICLE)).strip() in text


def test_tolerances_are_those_of_the_parts() -> None:
    """With C1 to C3 of twice the article's tolerance the cutoff spreads almost twice as much."""
    analysis = analyse(ARTICLE, boards=2000)
    assert analysis.component_percent == {
        name: 1.0 if name[0] == "R" else 10.0 for name in COMPONENTS[:8]
    }
    stated = analyse(load_article(["board.capacitor_tolerance_percent=5"]), boards=2000)
    own, article = (each.spread["cutoff_hz"] for each in (analysis, stated))
    assert 1.7 < own.deviation / article.deviation < 2.0
    assert own.worst_low < article.worst_low < article.worst_high < own.worst_high


def test_alias_attenuation_of_the_default_board() -> None:
    a = board_values(ARTICLE).aliasing
    assert (a.band_hz, a.nyquist_hz, a.alias_hz) == (201.0, 1000.0, 1799.0)
    assert -1.7 < a.tactile_band_db < -1.5  # slip ends below 100 Hz in the embedded finger: 0.4 dB
    comparator = board_values(load_article(["board.variant=comparator"])).aliasing
    envelope_pole_db = -10 * math.log10(1 + (1000 / 36.17) ** 2)
    assert comparator.output_nyquist_db - a.output_nyquist_db == pytest.approx(
        envelope_pole_db, abs=0.01
    )


FREQUENCIES = np.logspace(-1, 6, 141)

cutoffs = st.floats(1e-2, 1e4)
capacitors = st.floats(1e-6, 1e3)
gains = st.floats(1.01, 1e4)


SLOW = replace(AMPLIFIER_CATALOGUE["TL082"], bandwidth_hz=1.0)


def load(name: str, *changes: str) -> tuple[Design, Circuit]:
    """Return the design of a configuration with changes, and its circuit."""
    design = load_article((*VARIANT_CHANGES[name], *changes))
    return design, board_circuit(board_values(design))


def filter_path(circuit: Circuit, gain_bandwidth_hz: float | None) -> Network:
    """Network of a circuit from the tactile voltage to the filtered one."""
    return build_network(circuit, gain_bandwidth_hz).drive("TACTILE").restrict("FILTERED")


@pytest.fixture(scope="module")
def article_model() -> FilterModel:
    return model_filter(load("article")[1])


def quantities(components: FilterComponents) -> Mapping[str, float | Array]:
    """Values of the article's network for other components, with ideal amplifiers."""
    return filter_quantities(
        FilterSelection(components, components, None, None).by_reference(), SLOW
    )


# The article's figures and formulas


@given(cutoffs, capacitors, gains, cutoffs, capacitors)
def test_network_of_ideal_parts_agrees_with_the_closed_forms(
    article_model: FilterModel, f_c: float, c_uf: float, gain: float, f_lp: float, c_lp_uf: float
) -> None:
    """Ideal values give the Butterworth response that the design asks
    for: |H|^2 = G^2 x^6 / (1 + x^6), x = f / f_c.
    """
    board = Board(
        cutoff_hz=f_c,
        capacitor_uf=c_uf,
        passband_gain=gain,
        envelope_cutoff_hz=f_lp,
        envelope_capacitor_uf=c_lp_uf,
    )
    ideal = ideal_components(board)
    target = target_response(board)
    values = quantities(ideal)
    response = multiply(stage.evaluate(values) for stage in article_model.ideal)
    for x in (0.01, 0.5, 1.0, 2.0, 100.0):
        top, bottom = (
            np.polyval(each[::-1], 2j * math.pi * x * f_c)
            for each in (response.numerator, response.denominator)
        )
        assert top / bottom == pytest.approx(ideal_filter_transfer(x * f_c, ideal), rel=1e-9)
        assert abs(top / bottom) == pytest.approx(gain * math.sqrt(x**6 / (1 + x**6)), rel=1e-9)
        power = response.power_gain()(math.tau * x * f_c)
        assert float(power) == pytest.approx(abs(top / bottom) ** 2, rel=1e-9)
    assert float(article_model.first_pole_hz(values)) == pytest.approx(
        target.first_pole_hz, rel=1e-9
    )
    section = tuple(float(v) for v in article_model.section(values))
    assert section == pytest.approx((target.section_hz, target.section_quality), rel=1e-9)
    assert section == pytest.approx((section_frequency_hz(ideal), section_quality(ideal)), rel=1e-9)
    assert float(article_model.envelope.decay_s(values)) == pytest.approx(
        target.envelope_decay_s, rel=1e-9
    )
    assert float(article_model.envelope.gain(values)) == pytest.approx(ideal.r_lp_ohm, rel=1e-9)


# Frequency response as built, by equations and by polynomials

FAST = ("board.r5_ohm=5100", "board.envelope_capacitor_uf=0.022")
CASES = [(name, ()) for name in VARIANT_CHANGES] + [
    ("article", ("board.cutoff_hz=5", "board.capacitor_uf=10")),
    (
        "article",
        ("board.capacitor_uf=0.001", "board.cutoff_hz=5000", "board.passband_gain=3", *FAST),
    ),
    ("precision", ("board.r5_ohm=1e7", "board.passband_gain=300", "board.amplifier=MCP6022")),
]


def case_design(case: tuple[str, tuple[str, ...]]) -> tuple[Design, Circuit]:
    name, changes = case
    if any(change.startswith("board.cutoff_hz=5000") for change in changes):
        changes = (*changes, "detector.sample_rate_hz=20000")
    return load(name, *changes)


@pytest.mark.every_case
@pytest.mark.parametrize("case", CASES, ids=str)
def test_equations_and_polynomials_agree_with_the_closed_form(
    case: tuple[str, tuple[str, ...]],
) -> None:
    """Finite gain and bandwidth, input capacitance, C14 and C20,
    on both supplies; VMID carries no signal.
    """
    design, circuit = case_design(case)
    values = board_values(design)
    gbw = find_gain_bandwidth_hz(design.board)
    path = filter_path(circuit, gbw)
    found = path.response(FREQUENCIES, {"TACTILE": 1.0}, "STAGE1_OUT", "FILTERED")
    arguments = (
        values.preferred,
        gbw,
        values.first_stage_capacitors,
        AMPLIFIER_CATALOGUE[values.amplifier].input_f,
    )
    for column, formula in enumerate((first_stage_transfer, filter_transfer)):
        expected = np.array([formula(f, *arguments) for f in FREQUENCIES.tolist()])
        assert np.abs(found[:, column] / expected - 1).max() < 1e-9
    rational = multiply(
        stage.evaluate(path.values) for stage in find_stages(path, "TACTILE", "FILTERED")
    )
    power = np.array([rational.power_gain()(math.tau * f) for f in FREQUENCIES.tolist()])
    assert np.abs(power / np.abs(expected) ** 2 - 1).max() < 1e-9
    if design.board.is_for_controller:
        assert np.abs(path.response(FREQUENCIES, {"TACTILE": 1.0}, "VMID")).max() < 1e-12


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_passband_is_found_on_the_closed_form(name: str) -> None:
    """At both cutoffs the closed form has half the power of its maximum, which is nowhere
    exceeded.
    """
    design, circuit = load(name)
    values = board_values(design)
    gbw = find_gain_bandwidth_hz(design.board)
    model = model_filter(circuit)
    network = build_network(circuit, gbw)
    passband = model.passband(network.values)

    def gain(f_hz: float) -> float:
        input_f = AMPLIFIER_CATALOGUE[values.amplifier].input_f
        return abs(
            filter_transfer(f_hz, values.preferred, gbw, values.first_stage_capacitors, input_f)
        )

    assert max(gain(f) for f in np.geomspace(10, 2000, 2000).tolist()) <= passband.gain * (1 + 1e-9)
    for cutoff_hz in (passband.low_hz, passband.high_hz):
        assert gain(cutoff_hz) == pytest.approx(passband.gain / math.sqrt(2), rel=1e-9)
    achieved = values.achieved_response
    assert (achieved.cutoff_hz, achieved.upper_cutoff_hz) == (passband.low_hz, passband.high_hz)
    assert achieved.passband_gain_db == pytest.approx(decibel(passband.gain), rel=1e-12)


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_anti_aliasing_poles_agree_with_the_closed_forms(name: str) -> None:
    design, circuit = load(name)
    interface = board_values(design).adc_interface
    network = build_network(circuit)
    if name != "article":  # suppressors lie in parallel
        interface = replace(
            interface,
            second_f=interface.second_f + SUPPRESSOR_F,
            output_f=interface.output_f + SUPPRESSOR_F,
        )
    output = "ENVELOPE" if design.board.has_envelope else "FILTERED"
    for source, pin, formula in (
        ("TACTILE", "ADC_TACTILE", tactile_pin_transfer),
        (output, f"ADC_{output}", envelope_pin_transfer),
    ):
        found = network.drive(source).restrict(pin).response(FREQUENCIES, {source: 1.0}, pin)[:, 0]
        expected = np.array([formula(f, interface) for f in FREQUENCIES.tolist()])
        assert np.abs(found / expected - 1).max() < 1e-9
    # behind a blocked diode
    limits = board_values(design).voltage_limits
    r6_ohm = 2e3 if name == "article" else 0.0
    assert limits.tactile_pin_ohm == pytest.approx(
        interface.first_ohm + interface.second_ohm, rel=1e-9
    )
    assert limits.output_pin_ohm == pytest.approx(interface.output_ohm + r6_ohm, rel=1e-4)


# Noise, ripple, offsets, thresholds and operating point


def test_envelope_offset_agrees_with_the_closed_form() -> None:
    """What remains is the finite gain of the amplifiers, 1e-5."""
    values = board_values(load("comparator")[0])
    offset = values.output_offset
    amplifier = AMPLIFIER_CATALOGUE[values.amplifier]
    assert values.rectifier_ohm is not None
    conducting, blocked = envelope_offset_gains(2e3, values.rectifier_ohm)
    assert offset is not None
    assert offset.max_v == pytest.approx(
        amplifier.max_offset_v * math.fsum(map(abs, conducting)), rel=1e-4
    )
    assert offset.min_v == pytest.approx(
        -amplifier.max_offset_v * math.fsum(map(abs, blocked)), rel=1e-4
    )
    assert offset.typical_v == pytest.approx(amplifier.offset_v * math.hypot(*conducting), rel=1e-4)
    assert offset.max_low_offset_v < 0.05 * 0.017


@pytest.mark.parametrize("threshold", [0.017, 0.03, 0.1])
def test_comparator_levels_agree_with_the_closed_form(threshold: float) -> None:
    design, _ = load("comparator", f"detector.threshold_v={threshold}")
    values = board_values(design)
    stage = values.comparator_stage
    levels = values.comparator_levels
    assert stage is not None
    assert levels is not None
    supply_v = design.board.supply_v
    upper_v = supply_v - SUPPLIES["comparator"].signal_ground_v(supply_v)
    arguments = stage.trimmer_top_ohm, stage.hysteresis_ohm, upper_v
    resistors = values_in_range(
        stage.trimmer_top_ohm / 1.2, 1.2 * stage.trimmer_top_ohm, design.board.series
    )
    reached_v = [
        comparator_threshold_v(ohm, arguments[1], upper_v, upper_v, 4.7e3) for ohm in resistors
    ]
    assert abs(levels.on_v - threshold) == pytest.approx(
        min(abs(volts - threshold) for volts in reached_v)
    )
    # While slip is OFF, the pull-up of 4.7 kohm holds the output at the supply.
    assert levels.on_v == pytest.approx(
        comparator_threshold_v(*arguments, upper_v, 4.7e3), rel=1e-9
    )
    assert levels.off_v == pytest.approx(
        comparator_threshold_v(*arguments, upper_v - supply_v, 0.0), rel=1e-9
    )
    assert levels.max_on_v == pytest.approx(
        comparator_threshold_v(*arguments, upper_v, 4.7e3, 1 - 1e-9), rel=1e-6
    )
    assert levels.averaging_tau_s == pytest.approx(
        stage.averaging_ohm * stage.averaging_f, rel=1e-9
    )
    assert (levels.bias_v, levels.max_bias_v) == pytest.approx(
        (25e-9 * stage.averaging_ohm, 250e-9 * stage.averaging_ohm), rel=1e-9
    )
    # The lower half of the trimmer, its upper half with R19, and R20 with R21, in parallel.
    conductance_s = 1 / 5e3 + 1 / (5e3 + stage.trimmer_top_ohm) + 1 / (stage.hysteresis_ohm + 4.7e3)
    assert levels.threshold_bias_v == pytest.approx(25e-9 / conductance_s, rel=1e-9)
    assert 0 < levels.threshold_bias_v < levels.bias_v


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_tactile_voltage_agrees_with_the_closed_form(name: str) -> None:
    design, circuit = load(name)
    values = board_values(design)
    for conductance_s in (0.0, 1e-5, 1e-4, 1e-3, 1e-2):
        found = values.tactile_response.tactile_v(conductance_s)
        if values.bridge:
            expected = values.bridge.tactile_v(conductance_s, design.board.supply_v)
        else:  # 3.3 V over 220k and 10k; 15k over the sensor with 100 and 220 ohm
            expected = 3.3 / 23 * (1 + 15e3 * conductance_s / (1 + 320 * conductance_s))
        assert found == pytest.approx(expected, rel=1e-9)
        assert values.tactile_response.rises == design.board.tactile_rises
    assert ("ENVELOPE" in circuit.net_by_pin.values()) == design.board.has_envelope


# The equations themselves


def test_steady_state_is_that_of_the_operating_point() -> None:
    """A divider of 1k and 3k with a capacitor across the lower
    resistor settles to three quarters of its input.
    """
    terms = (
        Term("out", "out", "g", 4.0, 0),
        Term("out", "vcc", "g", -3.0, 0),
        Term("out", "out", "c", 1.0, 1),
    )
    network = Network(terms, {"g": 1 / 3e3, "c": 1e-6}, ("vcc",))
    assert network.operating_point({"vcc": 4.0})["out"] == pytest.approx(3.0, rel=1e-12)
    system = network.state_space
    assert network.steady_state()[0, 0] == pytest.approx(0.75, rel=1e-12)
    assert system.A[0, 0] == pytest.approx(-1 / (750 * 1e-6), rel=1e-12)
    assert -system.B[0, 0] / system.A[0, 0] == pytest.approx(0.75, rel=1e-12)


def test_determinants_multiply_the_factors_of_their_terms() -> None:
    """a: 4 g a + 3 c s b = 5 g x; b: 2 g b + 7 c s a = 0, so that b
    / x = -35 g c s / (8 g^2 - 21 c^2 s^2).
    """
    terms = (
        Term("a", "a", "g", 4.0, 0),
        Term("a", "b", "c", 3.0, 1),
        Term("a", "x", "g", -5.0, 0),
        Term("b", "b", "g", 2.0, 0),
        Term("b", "a", "c", 7.0, 1),
    )
    (stage,) = find_stages(Network(terms, {"g": 10.0, "c": 1.0}, ("x",)), "x", "b")
    found = stage.evaluate({"g": 10.0, "c": 1.0})
    assert found == Rational([0.0, -350.0], [800.0, 0.0, -21.0])


def test_phase_margins_of_loops_with_one_and_two_poles_are_those_of_the_textbook() -> None:
    f = np.geomspace(1.0, 1e4, 401)
    one_pole = 1e3 / (1j * np.geomspace(1.0, 1e4, 401))
    assert _find_margin_deg(one_pole) == pytest.approx(90.0)
    crossing = math.sqrt((math.sqrt(5.0) - 1.0) / 2.0)  # of 1 / (x sqrt(1 + x^2)) = 1
    margin_deg = 90.0 - math.degrees(math.atan(crossing))
    assert _find_margin_deg(one_pole / (1 + 1j * f / 1e3)) == pytest.approx(margin_deg, abs=0.01)
    assert _find_margin_deg(9.99 * one_pole) == pytest.approx(90.0), (
        "it falls through 1 between the last two points"
    )
    assert (_find_margin_deg(10.1 * one_pole), _find_margin_deg(1e-4 * one_pole)) == (
        -math.inf,
        math.inf,
    )
