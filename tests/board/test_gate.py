"""The board's gate: what cannot work is refused, and what the circuit
says agrees with closed forms and ngspice.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.board_gate import random_changes
from benchmarks.gate_in_ngspice import check_gate_in_ngspice
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.gate import (
    CLAMP,
    CURRENT,
    HIGHEST,
    LOWEST,
    MARGIN,
    OFFSET,
    PEAKING,
    TRIM,
    YIELD,
    check_gate,
    find_smallest_margin,
    gate_warnings,
)
from fingertip.board.analysis.loads import compute_phase_margins_deg, compute_two_pole_gain
from fingertip.board.analysis.thresholds import TOLERANCES
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE, list_dual_amplifiers
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import (
    choose_amplifier,
    compute_charging_current_a,
    compute_filter_current_a,
    compute_peaking_db,
    compute_phase_margin_deg,
    find_gain_bandwidth_hz,
    first_stage_feedback,
    input_swing_v,
)
from fingertip.design.formulas.filter import find_preferred_neighbours
from fingertip.foundation.errors import DesignError
from tests.board.ngspice import HOW_TO_INSTALL_NGSPICE, run_ngspice
from tests.designs import load_article
from tests.tools import require_tool


def load(name: str, *changes: str) -> Design:
    return load_article([*VARIANT_CHANGES[name], *changes])


# The catalogue


def test_catalogue_states_each_figure_and_an_order_of_preference() -> None:
    assert [a.preference for a in list_dual_amplifiers()] == [
        *range(1, len(AMPLIFIER_CATALOGUE) + 1)
    ]
    for amplifier in AMPLIFIER_CATALOGUE.values():
        assert amplifier.source
        assert all(hasattr(amplifier, name) for name in amplifier.unverified)
        assert 0 < amplifier.offset_v <= amplifier.max_offset_v
        assert amplifier.min_supply_v < amplifier.max_supply_v


def test_second_poles_give_the_stated_phase_margins() -> None:
    found = {
        name: compute_phase_margin_deg(amplifier, lambda _: 1.0)
        for name, amplifier in AMPLIFIER_CATALOGUE.items()
    }
    stated = {name: amplifier.phase_margin_deg for name, amplifier in AMPLIFIER_CATALOGUE.items()}
    assert found == pytest.approx(stated, abs=1e-3)


@pytest.mark.every_case
@pytest.mark.parametrize("supply_v", [3.1, 3.3, 3.6])
@pytest.mark.parametrize("variant", ["precision", "comparator"])
def test_board_for_a_controller_meets_every_condition_over_its_range(
    variant: str, supply_v: float
) -> None:
    converter = (
        "detector.adc_bits=12",
        f"detector.adc_range_v={supply_v}",
        "detector.adc_polarity=unipolar",
    )
    design = load(variant, f"board.supply_v={supply_v}", *converter)
    amplifier = choose_amplifier(design.board)
    assert amplifier.name == ("OPA2376" if variant == "comparator" else "MCP6022")
    assert amplifier.min_supply_v <= supply_v <= amplifier.max_supply_v
    assert list(gate_warnings(board_values(design).gate)) == []


# Conditions against closed forms


@pytest.mark.full
@settings(max_examples=60)
@given(
    st.sampled_from(sorted(VARIANT_CHANGES)),
    st.floats(2.0, 200.0),
    st.sampled_from([2e3, 2e4, 1e5, 1e6]),
)
def test_rule_and_circuit_agree_on_the_first_stage(name: str, gain: float, r5_ohm: float) -> None:
    """The rule has ideal values, the circuit preferred ones of series E24 and a C20 of
    series E6.
    """
    tables = load(name).with_values({"board.passband_gain": gain, "board.r5_ohm": r5_ohm})
    design = Design.model_construct(
        **{field: getattr(tables, field) for field in type(tables).model_fields}
    )
    amplifier = choose_amplifier(design.board)
    feedback = first_stage_feedback(design.board, amplifier, r5_ohm)
    circuit = board_circuit(board_values.__wrapped__(design))
    network = build_network(circuit, amplifier.bandwidth_hz)
    margin_deg = compute_phase_margins_deg(circuit, network)["U1a"]
    assert margin_deg == pytest.approx(compute_phase_margin_deg(amplifier, feedback), abs=4.0)
    f = np.array([1e5, 1e6, 1e7])
    found = np.abs(compute_two_pole_gain(circuit, network, f))
    open_loop = np.array([amplifier.open_loop_gain(hz) for hz in f.tolist()])
    expected = np.abs(
        open_loop / (1 + open_loop * np.array([feedback(hz) for hz in f.tolist()])) * open_loop
    )
    assert found == pytest.approx(expected / np.abs(1 + open_loop), rel=0.3)
    peaking_db = next(c.value for c in board_values.__wrapped__(design).gate if c.name == PEAKING)
    # C20 is a preferred value up to 21 % from the ideal one, and lowers the gain there.
    tolerance_db = 1.0 if name.startswith("article") else 4.0
    assert peaking_db == pytest.approx(
        compute_peaking_db(amplifier, feedback, gain), abs=tolerance_db
    )


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "cutoff", "capacitor"),
    [
        *((name, "67", "1") for name in VARIANT_CHANGES),
        *(
            (name, *pair)
            for name in ("article", "precision")
            for pair in (("30", "2.2"), ("150", "0.47"))
        ),
    ],
)
def test_rule_and_circuit_agree_on_the_filters_current(
    name: str, cutoff: str, capacitor: str
) -> None:
    design = load(
        name,
        f"board.cutoff_hz={cutoff}",
        f"board.capacitor_uf={capacitor}",
        "board.envelope_capacitor_uf=0.1",
    )
    values = board_values(design)
    found = {c.subject: c.value for c in values.gate if c.name == CURRENT}
    allowed = 0.3e-3 if name.startswith("article") else 0.6e-3  # the envelope, or R15
    largest_a = max(found["U1a"], found["U1b"])
    assert largest_a == pytest.approx(compute_filter_current_a(design.board), rel=0.2, abs=allowed)


@pytest.mark.parametrize(
    ("f_hz", "peak_v"), [(67.0, 2.0), (201.0, 2.0), (450.0, 3.5), (201.0, 0.5)]
)
def test_charging_current_agrees_with_a_simulated_peak_detector(f_hz: float, peak_v: float) -> None:
    """Oracle: steps of 1 us with an ideal diode behind a fixed drop."""
    ohm = 2e3
    farad = 2.2e-6
    volts = 0.0
    step_s = 1e-6
    largest_a = 0.0
    for i in range(round(6 / f_hz / step_s)):
        source_v = peak_v * math.sin(math.tau * f_hz * i * step_s) - 0.6
        decayed_v = volts * (1 - step_s / ohm / farad)
        volts, current_a = (
            max(source_v, decayed_v),
            (max(source_v, decayed_v) - volts) / step_s * farad + volts / ohm,
        )
        if i * step_s > 3 / f_hz and source_v > decayed_v:
            largest_a = max(largest_a, current_a)
    assert compute_charging_current_a(peak_v, f_hz, ohm, farad) == pytest.approx(
        largest_a, rel=0.05, abs=1e-6
    )


def test_a_converter_that_the_tactile_voltage_saturates_is_warned_of() -> None:
    conditions = board_values(load_article(["detector.adc_range_v=3.3"])).gate
    warning = next(gate_warnings(conditions))
    assert warning.startswith(
        "highest tactile voltage (TACTILE): 4.41 V, must be at most 3.30 V; the converter is"
    )
    assert find_smallest_margin(conditions) == find_smallest_margin(conditions, HIGHEST) < 1


def test_a_loop_that_never_reaches_a_gain_of_one_has_no_phase_margin() -> None:
    """Fuzzing found this one: its margin is infinite, which no JSON file can hold."""
    changes = ["board.passband_gain=4477", "board.r5_ohm=1.798e6", "board.amplifier=TLV2372"]
    conditions = board_values(Design.load("adult_finger", changes=changes)).gate
    assert all(math.isfinite(condition.value) for condition in conditions)
    assert "U1a" not in {c.subject for c in conditions if c.name == MARGIN}


@pytest.mark.full
def test_parts_of_wide_tolerances_are_warned_of_with_a_remedy_that_passes() -> None:
    """Oracle: another draw, of the filter's formulas with ideal amplifiers."""
    wide = ("board.capacitor_tolerance_percent=20", "board.resistor_tolerance_percent=5")
    shares = {
        c.subject: c.value for c in board_values(load("article", *wide)).gate if c.name == YIELD
    }
    rng = np.random.default_rng(5)
    f_hz = np.geomspace(50, 1500, 1200)
    c1, c2, c3 = 1e-6 * (1 + 0.2 * rng.uniform(-1, 1, (3, 4000)))
    r1, r2, r3, r4, r5 = (
        ohm * (1 + 0.05 * rng.uniform(-1, 1, 4000)) for ohm in (2400, 1200, 4700, 1500, 1e5)
    )
    s = 2j * np.pi * f_hz[:, None]
    section = s**2 * c2 * c3 * r2 * r3 / (1 + s * r2 * (c2 + c3) + s**2 * c2 * c3 * r2 * r3)
    magnitude = np.abs(s * r1 * c1 / (1 + s * r1 * c1) * section)
    cutoffs_hz = f_hz[np.argmax(magnitude >= 0.5**0.5 * magnitude.max(axis=0), axis=0)]
    assert shares["cutoff"] == pytest.approx(np.mean(np.abs(cutoffs_hz / 67 - 1) <= 0.1), abs=0.02)
    assert shares["gain"] == pytest.approx(
        np.mean(np.abs((1 + r5 / r4) / (203 / 3) - 1) <= 0.1), abs=0.02
    )
    (warning,) = gate_warnings(board_values(load("article", wide[0])).gate)
    assert warning.startswith("share of boards within 10 % (cutoff): 0.8")
    remedies = re.findall(r"board\.\w+=\w+", warning)
    assert list(gate_warnings(board_values(load("article", *wide, *remedies)).gate)) == []


@pytest.mark.parametrize(
    ("name", "gains"), [("article", [203 / 3, 1.0]), ("precision", [1.0, 1.0])]
)
def test_each_stage_has_the_offset_of_its_own_amplifier_times_its_gain_at_rest(
    name: str, gains: list[float]
) -> None:
    design = load(name)
    amplifier = choose_amplifier(design.board)
    offsets = [
        c.value for c in board_values(design).gate if c.name == OFFSET and c.level == "required"
    ]
    per_offset = input_swing_v(design.board, amplifier) / amplifier.max_offset_v
    assert [offset * per_offset for offset in offsets] == pytest.approx(gains, rel=1e-3)


def test_a_converter_of_less_than_the_clamps_rail_is_warned_of() -> None:
    conditions = board_values(load_article(["detector.adc_range_v=4.6"])).gate
    assert {c.name: c.passed for c in conditions if c.name in (HIGHEST, CLAMP)} == {
        HIGHEST: True,
        CLAMP: False,
    }
    (warning,) = gate_warnings(conditions)
    assert (
        "voltage at the converter's pins (D2, D3): 5.00 V, should be at most 4.60 V; only the "
        "supply" in warning
    )


def test_a_unipolar_converter_is_warned_of_a_tactile_voltage_below_ground() -> None:
    for polarity, passes in (("unipolar", False), ("bipolar", True)):
        design = load("article", f"detector.adc_polarity={polarity}")
        values = board_values(design)
        assert values.voltage_limits.min_tactile_v > 0
        limits = replace(values.voltage_limits, min_tactile_v=-0.1)
        conditions = check_gate(
            board_circuit(values),
            design,
            limits,
            False,
            60.0,
            {"GND": 0, "VCC": 5, "VEE": -5},
            None,
            None,
        )
        (pressed,) = (c for c in conditions if c.name == LOWEST)
        assert (pressed.passed, pressed.margin >= 1) == (passes, passes)


@given(st.floats(1e-7, 1e4))
def test_neighbours_of_a_capacitance_are_preferred_and_next_to_it(value: float) -> None:
    below, above = find_preferred_neighbours(value)
    assert below <= value * (1 + 1e-9) <= above * (1 + 2e-9)
    assert above / below < 1.26
    for end in (below, above):
        assert find_preferred_neighbours(end) == (end, end)


# The comparator's threshold


def test_threshold_spread_is_the_sum_of_its_causes() -> None:
    design = load("comparator", "board.amplifier=TLV2372")
    values = board_values(design)
    spread = values.threshold_spread
    levels = values.comparator_levels
    offset = values.output_offset
    assert spread is not None
    assert levels is not None
    assert offset is not None
    worst = {shift.cause: shift.worst_v for shift in spread.shifts}
    assert spread.max_v - spread.min_v == pytest.approx(2 * math.fsum(worst.values()))
    # Five offsets add up in the envelope; 2 uV/K over 25 K are 1 % more.
    assert worst["offsets of the amplifiers"] == pytest.approx(
        offset.max_v * (4.55 / 4.5), rel=3e-3
    )
    assert worst["offset of the comparator"] == pytest.approx(7.125e-3)
    assert worst["input currents of the comparator"] == pytest.approx(375e-9 * 15e3, rel=1e-3)
    # The envelope's amplifier isolates the comparator from the suppressors.
    assert worst["leakage of the suppressors"] == pytest.approx(0.0, abs=1e-9)
    # The threshold is proportional to RV1 / R19, so that 20 % and twice 1 % of it, and R20's 1 % of
    # a quarter, remain.
    assert worst[TOLERANCES] == pytest.approx(levels.on_v * (0.2 + 0.01), rel=0.05)
    assert spread.to_trim_v == pytest.approx(math.fsum(worst.values()) - worst[TOLERANCES])


def test_only_an_amplifier_of_low_offset_keeps_the_threshold_within_the_trimmers_reach() -> None:
    for amplifier, passes in (("auto", True), ("TLV2372", False)):
        conditions = board_values(load("comparator", f"board.amplifier={amplifier}")).gate
        assert [c.passed for c in conditions if c.name == TRIM] == [passes]
        assert (
            any("set board.amplifier=OPA2376" in text for text in gate_warnings(conditions))
            != passes
        )


# Second tool

RANDOM = random_changes(seed=2, count=24)


@pytest.mark.full
@pytest.mark.parametrize("changes", RANDOM, ids=" ".join)
def test_accepted_random_boards_hold_the_conditions_in_ngspice(
    tmp_path: Path, changes: list[str]
) -> None:
    program = str(require_tool("ngspice", HOW_TO_INSTALL_NGSPICE))
    try:
        design = load_article(changes)
    except DesignError:
        return
    assert [c for c in board_values(design).gate if c.level == "required" and not c.passed] == []
    assert check_gate_in_ngspice(program, tmp_path, design).failures == []


@pytest.mark.parametrize("name", ["article", "comparator"])
def test_two_pole_response_agrees_with_ngspice(tmp_path: Path, name: str) -> None:
    design = load(name)
    circuit = board_circuit(board_values(design))
    bandwidth_hz = find_gain_bandwidth_hz(design.board)
    deck = spice_deck(circuit, bandwidth_hz, design.board.supply_v, worst_case=True).decode()
    rows = np.array(
        run_ngspice(
            tmp_path, deck, "ac dec 10 1e4 1e8\nlet h = vm(filtered)/vm(tactile)\nwrdata out h"
        )
    )
    network = build_network(circuit, bandwidth_hz)
    ours = np.abs(compute_two_pole_gain(circuit, network, rows[:, 0]))
    assert ours == pytest.approx(rows[:, 1], rel=2e-3)
    assert min(c.value for c in board_values(design).gate if c.name == MARGIN) > 44
    assert find_smallest_margin(board_values(design).gate) > 1
