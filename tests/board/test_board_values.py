"""Ideal, preferred and achieved values of a design, and the rules between the board's parameters."""

from __future__ import annotations

from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.board_values import load_errata
from fingertip.board.analysis.interference import DEAD_ZONE_V
from fingertip.board.analysis.response import decibel
from fingertip.board.components.selection import compute_deviation_db
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import parse_component_value
from fingertip.catalogues.amplifiers import AmplifierName
from fingertip.design import Design
from fingertip.design.formulas.filter import MAX_OHM, MIN_OHM, FilterComponents, find_preferred_neighbours
from fingertip.design.rules.amplifiers import SUPPLY_RANGES_V
from fingertip.foundation.errors import DesignError
from tests.designs import ARTICLE, article_design, load_article
from tests.oracles.filter_formulas import (
    ideal_cutoff_hz,
    passband_gain,
    pole_hz,
    section_frequency_hz,
    section_quality,
)


def resistances(c: FilterComponents) -> tuple[float, ...]:
    """All resistances of the filter [ohm]."""
    return (c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.r_lp_ohm)


def test_default_values_are_the_articles() -> None:
    values = board_values(ARTICLE)
    assert values.preferred == FilterComponents(2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6)
    c = values.preferred
    assert values.achieved_response.section_quality == pytest.approx(section_quality(c), rel=1e-12)
    # Computed from the circuit: the amplifier's finite gain reduces the gain by half a thousandth.
    assert values.achieved_response.passband_gain == pytest.approx(passband_gain(c), rel=1e-3)
    assert values.achieved_response.cutoff_hz == pytest.approx(ideal_cutoff_hz(c), rel=2e-4)
    assert values.target_response.cutoff_hz == pytest.approx(67, rel=1e-12)
    assert round(ideal_cutoff_hz(c), 2) == 67.26


def test_errata_agree_with_the_computed_figures() -> None:
    values = board_values(ARTICLE)
    errata, limits = values.errata, values.voltage_limits
    assert errata == load_errata()  # all of them apply to the article's board
    assert len(errata) == len({erratum.subject for erratum in errata}) >= 7
    assert all(e.statement and e.correction and e.statement != e.correction for e in errata)
    corrections = " ".join(erratum.correction for erratum in errata)
    c = values.preferred
    for figure in (
        f"{passband_gain(c):.2f}",
        f"{decibel(passband_gain(c)):.2f} dB",
        f"{section_frequency_hz(c):.2f} Hz",
        f"{section_quality(c):.4f}",
        f"{pole_hz(c.r1_ohm, c.c_f):.2f} Hz",
        f"{ideal_cutoff_hz(c):.2f} Hz",
        f"{1e3 * values.achieved_response.envelope_decay_s:.2f} ms",
        f"{3 * passband_gain(c):.0f} mV",  # 3 mV of offset
        f"{1e3 * DEAD_ZONE_V / passband_gain(c):.1f} mV",  # the diode's dead zone, referred to the input
        f"-{limits.filter_trough_v:.0f} V (guaranteed: -{limits.filter_guaranteed_trough_v:.0f} V)",
    ):
        assert figure in corrections


def validate(board: dict[str, object]) -> tuple[Design | None, set[str]]:
    """Return a design with this board, or the fields for which it is refused."""
    try:
        return article_design(board=board), set()
    except DesignError as error:
        return None, {issue.field for issue in error.issues}


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers from 10^low to 10^high, uniform in their logarithm."""
    return st.floats(low, high).map(lambda exponent: float(10.0**exponent))


PREFERRED_UF = decades(-6.0, 3.0).map(lambda value: find_preferred_neighbours(value)[0])
AMPLIFIERS = st.sampled_from(get_args(AmplifierName))


@pytest.mark.full
@given(
    decades(-2.0, 4.0), PREFERRED_UF, decades(-2.0, 3.0).map(lambda g: 1.0 + g), decades(3.0, 7.0),
    decades(-2.0, 4.0), PREFERRED_UF, AMPLIFIERS, st.sampled_from(["E12", "E24", "E96"]),
    st.sampled_from(["given", "E6", "E12"]), st.sampled_from(sorted(BOARD_CONFIGURATIONS)), decades(1.0, 5.0),
    st.floats(0.0, 1.0),
)  # fmt: skip
def test_every_valid_design_has_a_board(
    f: float, c: float, gain: float, r5: float, f_lp: float, c_lp: float, amplifier: str, series: str, capacitors: str,
    name: str, limit: float, share: float,
) -> None:  # fmt: skip
    variant, supply = name.split("_", 1)
    low_v, high_v = SUPPLY_RANGES_V[supply]
    board = {
        "cutoff_hz": f, "capacitor_uf": c, "passband_gain": gain, "r5_ohm": r5, "envelope_cutoff_hz": f_lp,
        "envelope_capacitor_uf": c_lp, "amplifier": amplifier, "series": series, "capacitor_series": capacitors,
        "variant": variant, "supply": supply, "band_limit_hz": limit,
        "supply_v": low_v + share * (high_v - low_v),
    }  # fmt: skip
    design, refused = validate(board)
    assert {field.split(".")[0] for field in refused} <= {"board", "detector"}
    if design is None:
        return
    values = board_values(design)
    assert all(MIN_OHM <= r <= MAX_OHM for r in resistances(values.ideal) + resistances(values.preferred))
    # Chosen together, E12 deviates by 0.8 dB at most, where no resistor leaves its range.
    ohm, ideal = ((c.r1_ohm, c.r2_ohm, c.r3_ohm) for c in (values.preferred, values.ideal))
    assert compute_deviation_db(ohm, ideal) < 0.8
    circuit = board_circuit(values)
    fitted = {c.reference: parse_component_value(c.value) for c in circuit.components if c.symbol.name in ("R", "C")}
    assert all(1e-12 <= v <= 1e-3 for reference, v in fitted.items() if reference[0] == "C")
    assert all(10 <= v <= 10e6 for reference, v in fitted.items() if reference[0] == "R")
    assert values.voltage_limits.bridge_amplifier_margin_v > 0
    assert BOARD_CONFIGURATIONS[name].project.enter(circuit)


REFUSED = {
    # changes: fields of the issues that they cause, and a phrase of their messages
    "board.capacitor_uf=1000": ("board.capacitor_uf", "at most 1 uF at this cutoff"),
    "board.capacitor_uf=12": ("board.capacitor_uf", "1206, X7R for 16 V); at most 1 uF"),
    "board.capacitor_uf=0.1234567891": (
        "board.capacitor_uf", "no value of series E12, in which capacitors are made; 0.12",
    ),
    "board.capacitor_uf=10 board.cutoff_hz=500": (
        "board.capacitor_uf", "asks 52.9 mA of a TL082, more than 0.8 of its 10",
    ),
    "board.envelope_capacitor_uf=2.3": ("board.envelope_capacitor_uf", "for C4 is no value of series E12"),
    "board.envelope_capacitor_uf=10": ("board.envelope_capacitor_uf", "asks peaks of "),
    "board.envelope_capacitor_uf=100": ("board.envelope_capacitor_uf", "footprint of C4 holds"),
    "board.capacitor_uf=1e-6": ("board.capacitor_uf", "at least 0.00056 uF"),
    "board.cutoff_hz=1e-310": ("board.capacitor_uf", "above 10 Mohm; set board.cutoff_hz=0.03"),
    "board.envelope_capacitor_uf=1e-6": ("board.envelope_capacitor_uf", "above 10 Mohm"),
    "board.envelope_cutoff_hz=10000": (
        "board.envelope_cutoff_hz board.envelope_capacitor_uf detector.sample_rate_hz", "at most 382 Hz",
    ),
    "board.capacitor_series=E6 board.cutoff_hz=0.003": ("board.cutoff_hz", "at least 0.003184 Hz"),
    "board.capacitor_series=E6 board.envelope_cutoff_hz=0.001": ("board.envelope_cutoff_hz", "at least 0.001592 Hz"),
    "board.passband_gain=1.001": ("board.passband_gain board.r5_ohm", "board.passband_gain="),
    "board.passband_gain=2": ("board.r5_ohm", "leaves 9 degrees of phase margin"),
    "board.passband_gain=2 board.r5_ohm=1e7": ("board.r5_ohm", "leaves 1 degrees of phase margin"),
    "board.passband_gain=500 board.cutoff_hz=30": (
        "board.passband_gain", "500 times the 3 mV of offset that a TL082BC may",
    ),
    "board.passband_gain=10000": ("board.passband_gain", "at most 300"),
    "board.passband_gain=1e4 board.r5_ohm=1000": (
        "board.passband_gain", "R4 of 0.1 ohm, below 10 ohm; at most 101 with",
    ),
    "board.capacitor_uf=0.9e-6": ("board.capacitor_uf", "1e-06"),
    "board.series=E48": ("board.series", "E96"),
    "board.gain_bandwidth_hz=10000": ("board.gain_bandwidth_hz", "name the amplifier with board.amplifier=auto"),
    "board.amplifier=OPA2376": ("board.amplifier", "and this supply puts 10 V"),
    "board.variant=precision board.r5_ohm=10000": (
        "board.r5_ohm", "above 100 uF; at least 1.584e+04 ohm, or board.variant=",
    ),
    "detector.threshold_v=6": ("detector.threshold_v", "never reached by a board supplied with 5 V; at most 4.95 V"),
    "detector.threshold_v=2.5 board.supply=single": ("detector.threshold_v", "level of 2.5 V; at most 2.475 V"),
    "detector.threshold_v=0.7 board.supply=single board.variant=comparator": (
        "detector.threshold_v", "between 0.011 and 0.625 V with this supply",
    ),
    "detector.window_samples=137 board.variant=comparator": ("detector.window_samples", "at most 136 samples"),
    "board.variant=comparator board.band_limit_hz=200": ("board.band_limit_hz", "3 cutoffs of 67 Hz; at least 201 Hz"),
    "board.variant=precision board.band_limit_hz=9000 board.r5_ohm=10e6": (
        "board.band_limit_hz", "requires 1.768 pF across it, below 10 pF; at most 1591 Hz with this r5_ohm",
    ),
    "board.variant=precision board.band_limit_hz=31 board.cutoff_hz=10 board.r5_ohm=2000 board.passband_gain=2": (
        "board.band_limit_hz", "requires 2.567e+06 pF across it, above 1e+06 pF; at least 79.58 Hz with this r5_ohm",
    ),
    "board.supply=single_3v3 board.supply_v=5": ("board.supply_v", "3.6"),
    "board.supply=single_3v3 board.supply_v=3": ("board.supply_v", ""),
    "board.supply=single board.supply_v=3.3": ("board.supply_v", "5"),
    "board.supply=split board.supply_v=3.3": ("board.supply_v", "5"),
    "board.supply_v=6 board.variant=precision": (
        "board.supply_v", "put 12 V across the bridge's AD623, too close to the end of its supply range; at most 5.5 V",
    ),
    "board.supply_v=6 board.supply=single board.variant=comparator": (
        "board.supply_v", "6 V is too much for variant comparator's LMV331; at most 5.5 V.",
    ),
}  # fmt: skip


@pytest.mark.every_case
@pytest.mark.parametrize("changes", REFUSED)
def test_boards_that_cannot_work_are_refused_with_a_bound_and_a_remedy(changes: str) -> None:
    fields, phrase = REFUSED[changes]
    with pytest.raises(DesignError) as caught:
        load_article(changes.split())
    messages = {issue.field: issue.message for issue in caught.value.issues}
    assert list(messages) == fields.split()
    assert phrase in " ".join(messages.values())


@pytest.mark.every_case
@pytest.mark.parametrize(
    "changes",
    [
        "board.passband_gain=300", "board.passband_gain=10", "board.passband_gain=2 board.variant=precision",
        "board.passband_gain=2 board.amplifier=OPA2197 board.r5_ohm=2000", "board.r5_ohm=2500",
        "board.capacitor_uf=0.12", "board.capacitor_uf=0.00056", "board.envelope_capacitor_uf=3.9",
        "board.capacitor_series=E6 board.capacitor_uf=0.1234567891", "board.amplifier=OPA2376 board.supply=single",
        "board.supply_v=5.5", "board.supply_v=6 board.supply=single board.envelope_capacitor_uf=1.8",
        "board.r5_ohm=1.584e4 board.variant=precision", "detector.adc_range_v=4.5 board.amplifier=TL082",
        "detector.threshold_v=2.475 board.supply=single", "detector.threshold_v=2.5", "board.r5_ohm=10000",
        "board.variant=comparator detector.window_samples=136", "detector.window_samples=2000",
        "board.variant=comparator detector.window_samples=137 detector.threshold_v=0.018",
        "board.variant=comparator board.band_limit_hz=201", "board.band_limit_hz=200",
        "board.variant=precision board.band_limit_hz=1591 board.r5_ohm=10e6",
    ],
)  # fmt: skip
def test_remedies_pass_and_their_boards_meet_every_required_condition(changes: str) -> None:
    conditions = board_values(load_article(changes.split())).gate
    assert [c for c in conditions if c.level == "required" and not c.passed] == []
