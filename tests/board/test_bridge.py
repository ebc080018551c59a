"""The bridge: the article's voltages, the sensor's current, and Kirchhoff's law on the netlist."""

from __future__ import annotations

import itertools

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.values.bridge import (
    ARTICLE_POINTS,
    INTERLINK_CURVE,
    MAX_FORCE_N,
    NEWTON_PER_GRAM,
    article_error_v,
    fit_bridge,
    max_current_a,
    sensor_conductance_s,
)  # fmt: skip
from fingertip.board.values.preferred import decade
from fingertip.design import Design
from tests.board.nodal import number

CASES = list(itertools.product((5.0, 6.0), ("E24", "E96"), (5.08, 12.7, 4.0), (0.0, 0.5)))


def test_the_curve_goes_through_its_points() -> None:
    for gram, ohm in INTERLINK_CURVE:
        assert sensor_conductance_s(gram * NEWTON_PER_GRAM * (1 + 1e-12)) == pytest.approx(1 / ohm, rel=1e-9)
    forces = [0.2 * 1.05**i for i in range(130)]
    conductances = [sensor_conductance_s(f) for f in forces]
    assert conductances == sorted(conductances)
    assert sensor_conductance_s(0.19) == sensor_conductance_s(0.0) == 0.0


@pytest.mark.parametrize(("supply_v", "series", "diameter_mm", "zero"), CASES)
def test_the_articles_voltages(supply_v: float, series: str, diameter_mm: float, zero: float) -> None:
    bridge = fit_bridge(supply_v, series, diameter_mm, zero)
    for force, volt in ARTICLE_POINTS:
        assert bridge.tactile_v(sensor_conductance_s(force), supply_v) == pytest.approx(volt, abs=0.06)
    # The amplifier's output reaches 0.5 V below the rail (AD623, 10 kohm load).
    assert bridge.tactile_v(0.0, supply_v) < supply_v - 0.5
    assert bridge.tactile_v(sensor_conductance_s(MAX_FORCE_N), supply_v) > 0


@pytest.mark.parametrize(("supply_v", "series", "diameter_mm", "zero"), CASES)
def test_the_sensors_current_stays_within_its_limit(
    supply_v: float, series: str, diameter_mm: float, zero: float
) -> None:
    bridge = fit_bridge(supply_v, series, diameter_mm, zero)
    currents = [bridge.sensor_current_a(sensor_conductance_s(f / 10), supply_v) for f in range(201)]
    assert 0.7 * max_current_a(min(diameter_mm, 5.08)) < max(currents) <= max_current_a(diameter_mm)


def test_default_values_come_close() -> None:
    assert article_error_v(fit_bridge(5.0, "E24", 5.08), 5.0) < 0.01


def test_values_are_preferred() -> None:
    for series in ("E12", "E24", "E96"):
        bridge = fit_bridge(5.0, series, 5.08)
        for ohm in (bridge.top_ohm, bridge.shunt_ohm, bridge.high_ohm, bridge.low_ohm, bridge.gain_ohm):
            assert float(f"{ohm:e}".split("e")[0]) * (100 if series == "E96" else 10) in decade(series)


@pytest.mark.parametrize("supply", ["split", "single"])
def test_voltage_by_kirchhoff_from_the_circuit(supply: str) -> None:
    """Said again from the circuit's own values and nets, with the amplifier's rule alone taken from its data sheet."""
    values = board_values(Design.load(changes=[f"board.supply={supply}"]))
    circuit = board_circuit(values)
    ohm = {part.reference: number(part.value) for part in circuit.parts if part.symbol.name == "R"}
    net = {node: n.name for n in circuit.nets for node in n.nodes}
    volt = {"VCC": 5.0, "GND": 0.0}
    if supply == "single":
        assert {net[r, pin] for r in ("R22", "R23") for pin in "12"} == {"VCC", "HALF", "GND"}
        volt["VMID"] = 5.0 * ohm["R23"] / (ohm["R22"] + ohm["R23"])
    for g in (0.0, 1e-4, 1e-3):
        for name, pin in (("SENSOR", ("U2", "3")), ("REFERENCE", ("U2", "2"))):
            assert net[pin] == name
            total = g if name == net["J1", "1"] else 0.0
            current = total * volt[net["J1", "2"]]
            for r in ("R10", "R11", "R12", "R13"):
                ends = [net[r, "1"], net[r, "2"]]
                if name in ends:
                    other = ends[1 - ends.index(name)]
                    total, current = total + 1 / ohm[r], current + volt[other] / ohm[r]
            volt[name] = current / total
        assert {net["R14", "1"], net["R14", "2"]} == {net["U2", "1"], net["U2", "8"]}
        assert net["U2", "5"] == net["J1", "2"] == ("GND" if supply == "split" else "VMID")
        expected = volt[net["U2", "5"]] + (1 + 100e3 / ohm["R14"]) * (volt["SENSOR"] - volt["REFERENCE"])
        assert values.bridge.tactile_v(g, 5.0) == pytest.approx(expected, rel=1e-9)
        del volt["SENSOR"], volt["REFERENCE"]
