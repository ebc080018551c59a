"""Board for a controller of 3.3 V: its outputs stay within the supply, ripple does not count, no plug does harm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.circuits.spice import MAX_SWITCH_OHM
from fingertip.board.components.bridge import sensor_conductance_s
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import Circuit
from fingertip.design import Design
from tests.board.ngspice import run_ngspice
from tests.board.test_spice import write_deck
from tests.designs import load_article

NAMES = [name for name, configuration in BOARD_CONFIGURATIONS.items() if configuration.supply.is_for_controller]
PINS = {"1": "ADC_TACTILE", "3": "ADC_FILTERED", "5": "ADC_ENVELOPE", "7": "M_OUT"}


def load(name: str, *changes: str) -> Design:
    return load_article((*BOARD_CONFIGURATIONS[name].changes, *changes))


def circuit_of(name: str) -> Circuit:
    return board_circuit(board_values(load(name)))


@pytest.mark.parametrize("name", NAMES)
def test_output_connector_has_ground_between_the_signals(name: str) -> None:
    circuit = circuit_of(name)
    nets = {pin: net for (reference, pin), net in circuit.net_by_pin.items() if reference == "J3"}
    slip = "SLIP" if name.startswith("comparator") else "GND"
    assert nets == PINS | {"9": slip, "MP": "GND"} | dict.fromkeys(("2", "4", "6", "8", "10"), "GND")


RANGE_SWEEP = {
    "article": ["board.series=E12"],
    "precision": ["board.cutoff_hz=40", "board.capacitor_series=E12"],
    "comparator": [],
}


def limit_to_the_rails(deck: str) -> str:
    """Deck whose amplifiers' outputs end at the rails; their poles saturate there too."""
    limited = deck.replace("E1 out 0 pole 0 1\n", "B1 out 0 V=min(max(v(pole),0),v(vcc))\n")
    limited = limited.replace("E4 out 0 pole 0 1\n", "B4 out 0 V=min(max(v(pole),0),v(vcc))\n")
    limited = limited.replace("G1 0 pole p minus ", "B0 0 pole I=max(min(v(p,minus),1e-3),-1e-3)*")
    assert limited.count("B1 out") >= 2
    return limited.replace("\n.subckt", "\n.global vcc\n.subckt", 1)


CONDITIONS = {
    "open": "RJ1 sensor vmid 1e9",
    "shorted": "RJ1 sensor vmid 1e-2",
    "press": "SJ1 sensor vmid hit 0 closes\nRJ1 sensor vmid 1e9\nVhit hit 0 pulse(0 1 1.2 1m)\n"
    ".model closes SW(Vt=0.5 Vh=0.1 Ron=250 Roff=1G)",
}


@pytest.mark.full
@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_outputs_stay_within_the_supply_in_ngspice(tmp_path: Path, variant: str, condition: str) -> None:
    """The supply rises within 1 ms, and in the last condition the sensor is pressed as hard as it can be."""
    _, deck = write_deck(tmp_path, [*BOARD_CONFIGURATIONS[f"{variant}_single_3v3"].changes, *RANGE_SWEEP[variant]])
    lines = limit_to_the_rails(deck).splitlines()
    lines = [line for line in lines if not line.startswith("IJ1")]
    i = next(i for i, line in enumerate(lines) if line.startswith("RJ1 "))
    lines[i] = CONDITIONS[condition]
    i = next(i for i, line in enumerate(lines) if line.startswith("VJ2 "))
    lines[i] = "VJ2 power_in 0 pwl(0 0 1m 3.3)"
    pins = [net.lower() for net in PINS.values()] + (["slip"] if variant == "comparator" else [])
    vectors = " ".join(f"v({pin})" for pin in pins)
    rows = run_ngspice(tmp_path, "\n".join(lines) + "\n", f"tran 0.2m 1.5 0 0.2m uic\nwrdata out {vectors}")
    volts = np.array([row[1:] for row in rows if row[0] > 1.1e-3])
    assert rows[-1][0] == pytest.approx(1.5, rel=1e-3)
    assert volts.min() > -1e-3
    assert volts.max() < 3.3 + 1e-3
    settled = dict(zip(pins, volts[-1], strict=True))
    assert settled["m_out"] == pytest.approx(3.3 * 44.2 / 99.1, abs=0.02)
    if condition == "open":
        assert settled["adc_tactile"] == pytest.approx(2.7, abs=0.1)
    if condition == "shorted":
        assert settled["adc_tactile"] < 0.1
    if condition == "press":
        assert np.ptp(volts[:, pins.index("adc_filtered")]) > 1.5  # the press shows


def test_tactile_voltage_falls_with_force_within_the_range() -> None:
    response = board_values(load("precision_single_3v3")).tactile_response
    volts = [response.tactile_v(sensor_conductance_s(f)) for f in (0.0, 0.2, 0.8, 1.3, 20.0)]
    assert volts == sorted(volts, reverse=True)
    assert 0.3 < volts[-1] < volts[0] < 3.3 - 0.5
    # Four fifths of the article's 0.3 V and 0.45 V.
    assert volts[1] - volts[2] == pytest.approx(0.8 * 0.3, abs=0.01)
    assert volts[1] - volts[3] == pytest.approx(0.8 * 0.45, abs=0.015)


def test_protection_costs_less_than_a_millivolt() -> None:
    """TLV2372 and TLV2371 draw 0.8 mA for each amplifier at most, the AD623 0.6 mA, the bridge 2 mA."""
    assert (6 * 0.8e-3 + 0.6e-3 + 2e-3 + 1e-3) * MAX_SWITCH_OHM < 1e-3
    switch = {pin: net for (ref, pin), net in circuit_of("precision_single_3v3").net_by_pin.items() if ref == "Q1"}
    assert switch == {"1": "GND", "2": "VCC", "3": "POWER_IN"}  # gate, source, drain
