"""Values of a board: ideal, preferred and achieved ones, rules
between parameters, selection, bridge, figures.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board.analysis.board_values import board_values, load_errata
from fingertip.board.analysis.interference import DEAD_ZONE_V, compute_supply_current_a
from fingertip.board.analysis.response import decibel
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.front_end import (
    ARTICLE_POINTS,
    INTERLINK_CURVE,
    MAX_FORCE_N,
    NEWTON_PER_GRAM,
    max_current_a,
    sensor_conductance_s,
    size_bridge,
)
from fingertip.board.components.selection import (
    DEVIATION_BAND,
    choose_jointly,
    filter_error,
    nearest_value,
    select_filter_capacitor,
    values_in_range,
)
from fingertip.design import Design
from fingertip.design.formulas.filter import MANTISSAS, FilterComponents, ideal_components
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.errors import DesignError
from fingertip.foundation.files import format_figure
from tests.designs import ARTICLE, load_article
from tests.oracles.filter_formulas import (
    ideal_cutoff_hz,
    passband_gain,
    pole_hz,
    section_frequency_hz,
    section_quality,
)


def test_default_values_are_the_articles() -> None:
    values = board_values(ARTICLE)
    assert values.preferred == FilterComponents(
        2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6
    )
    c = values.preferred
    assert values.achieved_response.section_quality == pytest.approx(section_quality(c), rel=1e-12)
    # Computed from the circuit: the amplifier's finite gain reduces the gain by half a thousandth.
    assert values.achieved_response.passband_gain == pytest.approx(passband_gain(c), rel=1e-3)
    assert values.achieved_response.cutoff_hz == pytest.approx(ideal_cutoff_hz(c), rel=2e-4)
    assert values.target_response.cutoff_hz == pytest.approx(67, rel=1e-12)
    assert round(ideal_cutoff_hz(c), 2) == 67.26


def test_errata_agree_with_the_computed_figures() -> None:
    values = board_values(ARTICLE)
    errata = values.errata
    limits = values.voltage_limits
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
        # the diode's dead zone, referred to the input
        f"{1e3 * DEAD_ZONE_V / passband_gain(c):.1f} mV",
        f"-{limits.filter_trough_v:.0f} V (guaranteed: -{limits.filter_guaranteed_trough_v:.0f} V)",
    ):
        assert figure in corrections


@pytest.mark.parametrize(
    "changes",
    [
        "board.passband_gain=300",
        "board.passband_gain=10",
        "board.passband_gain=2 board.variant=precision",
        "board.passband_gain=2 board.amplifier=OPA2197 board.r5_ohm=2000",
        "board.r5_ohm=2500",
        "board.capacitor_uf=0.12",
        "board.capacitor_uf=0.00056",
        "board.envelope_capacitor_uf=3.9",
        "board.capacitor_series=E6 board.capacitor_uf=0.1234567891",
        "board.amplifier=OPA2376 board.variant=precision",
        "board.supply_v=5.5",
        "board.variant=precision board.supply_v=3.6 board.envelope_capacitor_uf=1.8",
        "board.r5_ohm=1.584e4 board.variant=precision",
        "detector.adc_range_v=4.5 board.amplifier=TL082",
        "detector.threshold_v=1.6 board.variant=precision",
        "detector.threshold_v=2.5",
        "board.r5_ohm=10000",
        "board.variant=comparator detector.window_samples=136",
        "detector.window_samples=2000",
        "board.variant=comparator detector.window_samples=137 detector.threshold_v=0.018",
        "board.variant=comparator board.band_limit_hz=201",
        "board.band_limit_hz=200",
        "board.variant=precision board.band_limit_hz=1591 board.r5_ohm=10e6",
    ],
)
def test_remedies_pass_and_their_boards_meet_every_required_condition(changes: str) -> None:
    conditions = board_values(load_article(changes.split())).gate
    assert [c for c in conditions if c.level == "required" and not c.passed] == []


# Preferred values


# IEC 60063, transcribed from the standard's tables.
E6 = "10 15 22 33 47 68"
E12 = "10 12 15 18 22 27 33 39 47 56 68 82"
E24 = "10 11 12 13 15 16 18 20 22 24 27 30 33 36 39 43 47 51 56 62 68 75 82 91"
E96 = """100 102 105 107 110 113 115 118 121 124 127 130 133 137 140 143 147 150 154 158 162 165 169 174 178 182 187
191 196 200 205 210 215 221 226 232 237 243 249 255 261 267 274 280 287 294 301 309 316 324 332 340 348 357 365 374 383
392 402 412 422 432 442 453 464 475 487 499 511 523 536 549 562 576 590 604 619 634 649 665 681 698 715 732 750 768 787
806 825 845 866 887 909 931 953 976"""  # noqa: E501

series = st.sampled_from(["E12", "E24", "E96"])


@pytest.mark.parametrize(("name", "table"), [("E6", E6), ("E12", E12), ("E24", E24), ("E96", E96)])
def test_mantissas_are_those_of_the_standard(name: str, table: str) -> None:
    assert MANTISSAS[name] == tuple(map(int, table.split()))


def all_values(name: str) -> list[float]:
    """All preferred resistances of a series from 10 ohm to 10 Mohm."""
    scale = 10 if name == "E96" else 1
    values = {m * 10**e / scale for m in MANTISSAS[name] for e in range(7)}
    return sorted(v for v in values if 10 <= v <= 10e6)


@given(st.floats(10.0, 10e6), series)
def test_nearest_value_is_the_nearest_of_all(value: float, name: str) -> None:
    best = min(abs(math.log(v / value)) for v in all_values(name))
    assert abs(math.log(nearest_value(value, name) / value)) == pytest.approx(best, abs=1e-12)
    assert nearest_value(value, name) in all_values(name)


def test_nearest_value_stays_within_the_range() -> None:
    assert nearest_value(9.0, "E24") == 10.0
    assert nearest_value(2e7, "E96") == 10e6


def test_values_in_range_contains_at_least_one_value() -> None:
    assert values_in_range(1e-6, 1e-5, "E6") == (1e-6, 1.5e-6, 2.2e-6, 3.3e-6, 4.7e-6, 6.8e-6, 1e-5)
    assert values_in_range(1.1e-6, 1.2e-6, "E6") == (1e-6,)


# Capacitors that the board selects itself


capacitor_series = st.sampled_from(["E6", "E12"])


def preferred_values(series: str, low: float, high: float) -> list[float]:
    """All values of a series from `low` to `high`."""
    digits = len(str(MANTISSAS[series][0])) - 1
    values = (m * 10.0 ** (e - digits) for e in range(-13, 8) for m in MANTISSAS[series])
    return [v for v in values if low * (1 - 1e-9) <= v <= high * (1 + 1e-9)]


@settings(max_examples=25)
@given(st.floats(5.0, 500.0), capacitor_series, st.sampled_from(["E12", "E24"]))
def test_no_combination_of_components_is_better_than_the_selected_one(
    cutoff: float, capacitors: str, resistors: str
) -> None:
    """Every C up to 10 uF with R1 from 2k to 20k is combined with
    every R1, R2, R3 near its ideal value.
    """
    board = Board(
        cutoff_hz=cutoff, capacitor_series=capacitors, series=resistors, resistor_choice="apart"
    )
    omega = math.tau * cutoff
    best = math.inf
    for c in preferred_values(capacitors, 1 / (omega * 20e3), min(1 / (omega * 2e3), 10e-6)):
        ideal = (1 / (omega * c), 1 / (2 * omega * c), 2 / (omega * c))
        for r1, r2, r3 in itertools.product(
            *(preferred_values(resistors, 0.8 * r, 1.25 * r) for r in ideal)
        ):
            f1 = 1 / (math.tau * r1 * c)
            f0 = 1 / (math.tau * c * math.sqrt(r2 * r3))
            errors = (
                math.log(f0 / cutoff),
                math.log(math.sqrt(r3 / r2) / 2),
                math.log(f1 / cutoff),
            )
            best = min(best, math.sqrt(sum(e * e for e in errors)))
    assert filter_error(select_filter_capacitor(board), board) == pytest.approx(best, abs=1e-12)


def test_selecting_capacitors_reproduces_the_article() -> None:
    """Its own values are the best of E12 and E24 for 67 Hz and 36.17 Hz."""
    for series in ("E6", "E12"):
        assert board_values(load_article([f"board.capacitor_series={series}"])).preferred == (
            board_values(ARTICLE).preferred
        )
    selected = board_values(
        load_article(["board.cutoff_hz=80", "board.series=E96", "board.capacitor_series=E12"])
    )
    assert selected.preferred.c_f == 390e-9


def test_given_capacitors_are_ignored_where_the_board_selects_its_own() -> None:
    given = ["board.capacitor_uf=1000", "board.envelope_capacitor_uf=1e-6"]
    for series in ("E6", "E12", "preferred"):
        changes = [f"board.capacitor_series={series}"]
        assert board_values(load_article(changes + given)) == board_values(load_article(changes))
    with pytest.raises(DesignError, match=r"board\.capacitor_uf"):
        load_article(given)


def test_an_envelope_capacitor_needs_a_resistor_and_a_footprint_that_exist() -> None:
    """1 / (2 pi f C) is 9.5 Mohm at 30 Hz with 0.56 nF, and 11.3
    with 0.47 nF; the largest resistor has 10.
    """
    at_30_hz = "board.envelope_cutoff_hz=30"
    load_article([at_30_hz, "board.envelope_capacitor_uf=0.00056"])
    with pytest.raises(
        DesignError, match=r"requires R_LP of 1\.129e\+07 ohm.*at least 0\.00056 uF"
    ):
        load_article([at_30_hz, "board.envelope_capacitor_uf=0.00047"])
    with pytest.raises(DesignError, match=r"envelope_capacitor_uf.*C4"):
        load_article([at_30_hz, "board.envelope_capacitor_uf=100"])


# R1, R2 and R3 chosen together


def ideal_ohm(
    cutoff_hz: float, capacitor_uf: float = 1.0
) -> tuple[tuple[float, float, float], FilterComponents]:
    ideal = ideal_components(Board(cutoff_hz=cutoff_hz, capacitor_uf=capacitor_uf))
    return first_three(ideal), ideal


def first_three(values: FilterComponents) -> tuple[float, float, float]:
    return values.r1_ohm, values.r2_ohm, values.r3_ohm


def deviation_db(ohm: tuple[float, ...], ideal: tuple[float, float, float]) -> float:
    """Oracle: complex transfer functions of both stages over w = f / f_c, C omega_c = 1 / R1."""
    r1, r2, r3 = (value / ideal[0] for value in ohm)
    s = 1j * np.geomspace(*DEVIATION_BAND, 37)
    filter_ = s * r1 / (1 + s * r1) * s**2 * r2 * r3 / (1 + 2 * s * r2 + s**2 * r2 * r3)
    butterworth = s**3 / (1 + 2 * s + 2 * s**2 + s**3)
    return float(np.abs(20 * np.log10(np.abs(filter_ / butterworth))).max())


@pytest.mark.parametrize(("series", "ratio"), [("E12", 2.2), ("E24", 1.8), ("E96", 1.1)])
@pytest.mark.parametrize("cutoff", [30.0, 41.7, 67.0, 88.8, 123.0])
def test_no_combination_of_a_wide_search_is_better(
    series: str, ratio: float, cutoff: float
) -> None:
    ideal, _ = ideal_ohm(cutoff)
    candidates = (values_in_range(ohm / ratio, ohm * ratio, series) for ohm in ideal)
    best = min(deviation_db(ohm, ideal) for ohm in itertools.product(*candidates))
    chosen, found = choose_jointly(ideal, series)
    assert found == pytest.approx(best, abs=1e-6)
    assert deviation_db(chosen, ideal) == pytest.approx(found, abs=1e-6)


@pytest.mark.parametrize("cutoff", [33.0, 80.0, 140.0])
def test_no_capacitor_and_resistors_together_are_better(cutoff: float) -> None:
    board = Board(cutoff_hz=cutoff, capacitor_series="E6", series="E24")
    omega = math.tau * cutoff
    best = math.inf
    for c_f in values_in_range(1 / (omega * 20e3), 1 / (omega * 2e3), "E6"):
        ohm, _ = ideal_ohm(cutoff, 1e6 * c_f)
        best = min(best, choose_jointly(ohm, "E24")[1])
    ohm, _ = ideal_ohm(cutoff, 1e6 * select_filter_capacitor(board))
    assert choose_jointly(ohm, "E24")[1] == pytest.approx(best, abs=1e-6)


# Bridge


CASES = [
    *((5.0, "E24", diameter_mm) for diameter_mm in (5.08, 12.7, 4.0)),
    (6.0, "E24", 5.08),
    (6.0, "E96", 12.7),
]


def test_sensor_curve_passes_through_its_points_and_is_monotonic() -> None:
    for gram, ohm in INTERLINK_CURVE:
        assert sensor_conductance_s(gram * NEWTON_PER_GRAM * (1 + 1e-12)) == pytest.approx(
            1 / ohm, rel=1e-9
        )
    forces = [0.2 * 1.05**i for i in range(130)]
    conductances = [sensor_conductance_s(f) for f in forces]
    assert conductances == sorted(conductances)
    assert sensor_conductance_s(0.19) == sensor_conductance_s(0.0) == 0.0


@pytest.mark.parametrize(("supply_v", "series", "diameter_mm"), CASES)
def test_sized_bridge_reproduces_the_articles_voltages_within_the_sensors_limit(
    supply_v: float, series: str, diameter_mm: float
) -> None:
    bridge = size_bridge(supply_v, series, diameter_mm)
    for force, volt in ARTICLE_POINTS:
        assert bridge.tactile_v(sensor_conductance_s(force), supply_v) == pytest.approx(
            volt, abs=0.06
        )
    # The amplifier's output reaches 0.5 V below the rail (AD623, 10 kohm load).
    assert bridge.tactile_v(0.0, supply_v) < supply_v - 0.5
    assert bridge.tactile_v(sensor_conductance_s(MAX_FORCE_N), supply_v) > 0
    for ohm in (
        bridge.sensor_top_ohm,
        bridge.sensor_shunt_ohm,
        bridge.reference_top_ohm,
        bridge.reference_bottom_ohm,
        bridge.gain_ohm,
    ):
        assert (
            float(f"{ohm:e}".split("e")[0]) * (100 if series == "E96" else 10) in MANTISSAS[series]
        )
    conductances = [sensor_conductance_s(f / 10) for f in range(201)]
    currents = [g * bridge.sensor_v(g, supply_v) for g in conductances]
    assert 0.7 * max_current_a(min(diameter_mm, 5.08)) < max(currents) <= max_current_a(diameter_mm)


# Figures of README and bring-up sheet


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (67.2503, 4, "67.25"),
        (44493.6, 4, "44490"),
        (0.98952, 4, "0.9895"),
        (9999.96, 4, "10000"),
        (0.0, 4, "0"),
        (-0.0, 4, "0"),
        (-3.14159, 3, "-3.14"),
        (0.000123456, 2, "0.00012"),
        (8854.0, 2, "8900"),
    ],
)
def test_figures_have_the_given_number_of_significant_digits(
    value: float, digits: int, text: str
) -> None:
    assert format_figure(value, digits) == text


@pytest.mark.parametrize(
    ("design", "milliampere"),
    [
        # Four units of 1 mA, and two dividers.
        (Design(), 4 * 1.0 + 3.3 / 230 + 3.3 / 102),
        # Two units of a TL082, the AD623, and both arms from 5 V to ground.
        (ARTICLE, 2 * 1.4 + 0.375 + 5 / 6.44 + 5 / 3.382),
    ],
)
def test_supply_current_is_that_of_the_data_sheets_and_of_ohms_law(
    design: Design, milliampere: float
) -> None:
    circuit = board_circuit(board_values(design))
    assert 1e3 * compute_supply_current_a(circuit, design.board.supply_v) == pytest.approx(
        milliampere, rel=1e-4
    )
