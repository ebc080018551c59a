"""The bridge against the figures of the article, and figures that a README and a bring-up sheet state, by hand."""

from __future__ import annotations

import re

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.bringup.plan import supply_current_a
from fingertip.board.bringup.prediction import Board
from fingertip.board.components.bridge import (
    ARTICLE_POINTS,
    INTERLINK_CURVE,
    MAX_FORCE_N,
    NEWTON_PER_GRAM,
    max_current_a,
    sensor_conductance_s,
    size_bridge,
)
from fingertip.board.components.selection import mantissas
from fingertip.design import Design
from fingertip.documents.template import format_ohm
from fingertip.foundation.files import format_figure
from fingertip.tasks.board import board_files
from tests.designs import ARTICLE

# Bridge


CASES = [
    *((5.0, "E24", diameter_mm, ratio) for diameter_mm in (5.08, 12.7, 4.0) for ratio in (0.0, 0.5)),
    (6.0, "E24", 5.08, 0.0),
    (6.0, "E96", 12.7, 0.5),
]


def test_sensor_curve_passes_through_its_points_and_is_monotonic() -> None:
    for gram, ohm in INTERLINK_CURVE:
        assert sensor_conductance_s(gram * NEWTON_PER_GRAM * (1 + 1e-12)) == pytest.approx(1 / ohm, rel=1e-9)
    forces = [0.2 * 1.05**i for i in range(130)]
    conductances = [sensor_conductance_s(f) for f in forces]
    assert conductances == sorted(conductances)
    assert sensor_conductance_s(0.19) == sensor_conductance_s(0.0) == 0.0


@pytest.mark.parametrize(("supply_v", "series", "diameter_mm", "signal_ground_ratio"), CASES)
def test_sized_bridge_reproduces_the_articles_voltages_within_the_sensors_limit(
    supply_v: float, series: str, diameter_mm: float, signal_ground_ratio: float
) -> None:
    bridge = size_bridge(supply_v, series, diameter_mm, signal_ground_ratio)
    for force, volt in ARTICLE_POINTS:
        assert bridge.tactile_v(sensor_conductance_s(force), supply_v) == pytest.approx(volt, abs=0.06)
    # The amplifier's output reaches 0.5 V below the rail (AD623, 10 kohm load).
    assert bridge.tactile_v(0.0, supply_v) < supply_v - 0.5
    assert bridge.tactile_v(sensor_conductance_s(MAX_FORCE_N), supply_v) > 0
    for ohm in (
        bridge.sensor_top_ohm, bridge.sensor_shunt_ohm, bridge.reference_top_ohm, bridge.reference_bottom_ohm,
        bridge.gain_ohm,
    ):  # fmt: skip
        assert float(f"{ohm:e}".split("e")[0]) * (100 if series == "E96" else 10) in mantissas(series)
    conductances = [sensor_conductance_s(f / 10) for f in range(201)]
    ground_v = signal_ground_ratio * supply_v
    currents = [g * (bridge.sensor_v(g, supply_v) - ground_v) for g in conductances]
    assert 0.7 * max_current_a(min(diameter_mm, 5.08)) < max(currents) <= max_current_a(diameter_mm)


# Figures of README and bring-up sheet


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (67.2503, 4, "67.25"), (44493.6, 4, "44490"), (0.98952, 4, "0.9895"), (9999.96, 4, "10000"), (0.0, 4, "0"),
        (-0.0, 4, "0"), (-3.14159, 3, "-3.14"), (0.000123456, 2, "0.00012"), (8854.0, 2, "8900"),
    ],
)  # fmt: skip
def test_figures_have_the_given_number_of_significant_digits(value: float, digits: int, text: str) -> None:
    assert format_figure(value, digits) == text


@pytest.mark.parametrize(
    ("design", "milliampere"),
    [
        # Six units of 0.55 mA and the AD623's 0.375; both arms of the bridge from 0.8 to 0.446 of 3.3 V; two dividers.
        (Design(), 6 * 0.55 + 0.375 + 1.1682 / 1.771 + 1.1682 / 1.607 + 3.3 / 150 + 3.3 / 99.1),
        # Two units of a TL082, the AD623, and both arms from 5 V to ground.
        (ARTICLE, 2 * 1.4 + 0.375 + 5 / 6.44 + 5 / 3.382),
    ],
)
def test_supply_current_is_that_of_the_data_sheets_and_of_ohms_law(design: Design, milliampere: float) -> None:
    board = Board.of_design(design, board_circuit(board_values(design)))
    assert 1e3 * supply_current_a(board) == pytest.approx(milliampere, rel=1e-4)


def readme(design: Design) -> str:
    """README of a board's folder, without line breaks."""
    return " ".join(board_files(design)["README.md"].decode().split())


def test_no_figure_has_an_exponent_where_gain_and_steps_are_large() -> None:
    design = Design.load(changes=["board.passband_gain=120", "detector.adc_bits=8", "detector.noise_v=0.01"])
    notes = readme(design)
    assert [format_ohm(value) for value in (4.7, 6800.0, 1.1e6)] == ["4.7 ohm", "6.8 kohm", "1.1 Mohm"]
    assert "a step of the ADC (13 mV) is 110 uV" in notes, "3.3 V / 256, over 115"
    assert not re.findall(r"\de[+-]\d", notes)
