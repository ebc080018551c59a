"""The bridge, compared with the article's voltages, the sensor's current limit and Kirchhoff's law on the netlist."""

from __future__ import annotations

import pytest

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
