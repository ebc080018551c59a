"""Front end and outputs in ngspice: noise, stability with a cable,
recovery, discharges, and wrong plugs.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.interference import compute_cable_crosstalk
from fingertip.board.analysis.loads import compute_phase_margins_deg
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.components.front_end import sensor_conductance_s
from fingertip.board.parts import symbols
from fingertip.board.parts.circuit import Component
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE
from fingertip.design import Design
from tests.board.ngspice import read_noise_total, run_ngspice
from tests.board.test_spice import limit_to_the_rails, replace_elements

AMPLIFIERS = ["MCP6022", "OPA2376"]


def write_deck(amplifier: str, force_n: float, rng: np.random.Generator | None = None) -> str:
    """Deck of the default board with the sensor under a force,
    and parts drawn within their tolerances.
    """
    circuit = board_circuit(
        board_values(Design.load("fsr400", changes=[f"board.amplifier={amplifier}"]))
    )
    for part in circuit.components if rng else ():
        if rng and part.requirement:
            ratio = part.requirement.tolerance_percent / 100 * rng.uniform(-1, 1)
            value = build_network(circuit).values[part.reference]
            farad_or_ohm = value if part.reference[0] == "C" else 1 / value
            circuit = circuit.replace(part.reference, f"{farad_or_ohm * (1 + ratio):.6g}")
    deck = spice_deck(circuit, AMPLIFIER_CATALOGUE[amplifier].bandwidth_hz, 3.3).decode()
    return replace_elements(deck, RJ1=f"RJ1 sensor 0 {1 / sensor_conductance_s(force_n):.6g}")


@pytest.mark.full
@pytest.mark.parametrize("amplifier", AMPLIFIERS)
def test_noise_at_the_pin_of_the_filtered_signal(tmp_path: Path, amplifier: str) -> None:
    rng = np.random.default_rng(1)
    for force_n, limit_v in ((3.0, 0.20e-3), (8.0, 0.35e-3)):
        decks = [
            write_deck(amplifier, force_n),
            *(write_deck(amplifier, force_n, rng) for _ in range(10)),
        ]
        found = [read_noise_total(tmp_path, deck, "adc_filtered") for deck in decks]
        assert max(found) < limit_v


@pytest.mark.full
@pytest.mark.parametrize("amplifier", AMPLIFIERS)
def test_stage_is_stable_with_any_cable_and_sensor(amplifier: str) -> None:
    """By the equations: amplifiers of two poles, without resistance at their outputs."""
    circuit = board_circuit(
        board_values(Design.load("fsr400", changes=[f"board.amplifier={amplifier}"]))
    )
    margins = []
    for farad, ohm in itertools.product(
        (1e-12, 1e-10, 1e-9, 4.7e-9, 2.2e-8), (1e-2, 250.0, 1e3, 5e3, 3e4, 1e6, 1e9)
    ):
        cable = Component("C90", f"{farad:g}", symbols.CAPACITOR, symbols.C_0603, "")
        loaded = circuit.connect(cable, {"1": "SENSOR", "2": "GND"})
        network = build_network(
            loaded, AMPLIFIER_CATALOGUE[amplifier].bandwidth_hz, sensor_s=1 / ohm
        )
        margins.append(compute_phase_margins_deg(loaded, network)["U2a"])
    assert min(margins) >= 60


EVENTS = {
    "press": "0 1e-9 50m 1e-9 51m {firm}",
    "release": "0 {firm} 50m {firm} 51m 1e-9",
    "open": "0 {firm} 50m {firm} 50.001m 1e-12",
    "short": "0 {firm} 50m {firm} 50.001m 100",
}


@pytest.mark.full
@pytest.mark.parametrize("event", EVENTS)
def test_filtered_signal_is_back_soon(tmp_path: Path, event: str) -> None:
    """Amplifiers that end at the rails; back is within a tenth of the swing."""
    deck = limit_to_the_rails(write_deck("MCP6022", 3.0))
    deck = replace_elements(deck, IJ1="* no source", RJ1="BJ1 sensor 0 I=v(sensor)*v(siemens)")
    points = EVENTS[event].format(firm=f"{sensor_conductance_s(3.0):.4g}")
    deck = deck.replace("\n.ac ", f"\nVG siemens 0 pwl({points})\n.ac ")
    rows = run_ngspice(tmp_path, deck, "tran 20u 0.3 0 20u\nwrdata out v(adc_filtered) v(vmid)")
    late_s = [
        t - 0.05
        for t, filtered, middle in ((r[0], r[1], r[-1]) for r in rows)
        if abs(filtered - middle) > 0.16
    ]
    assert max(late_s) < 0.035


REST = "\nRO3 vmid 0 1\nRO4 stage1_out 0 1"
"""Outputs of the other amplifiers, for a deck without any."""
CLAMPS = "DC{0}1 {0} vcc dclamp\nDC{0}2 0 {0} dclamp"
"""Clamps of an amplifier at one of its pins."""


def clamp(deck: str, *nets: str) -> str:
    clamps = "\n".join(CLAMPS.format(net) for net in nets)
    return deck.replace("\n.ac ", f"\n{clamps}\n.model dclamp D(Is=1e-14 Rs=1)\n.ac ")


@pytest.mark.full
@pytest.mark.parametrize(
    ("net", "behind", "ohm", "least_a", "most_a"),
    [
        ("sensor", "v(protected)-v(sum)", 220, 0.005, 0.1),
        ("adc_tactile", "v(adc_tactile)-v(alias_mid)", 10e3, 1e-5, 2e-3),
        ("adc_filtered", "v(adc_filtered)-v(filtered)", 10e3, 1e-5, 2e-3),
    ],
)
def test_discharge_into_a_cable_leaves_little_for_the_amplifier(
    tmp_path: Path, net: str, behind: str, ohm: float, least_a: float, most_a: float
) -> None:
    """8 kV in contact: current of IEC 61000-4-2, annex B, twice that of
    4 kV; clamps of the amplifier at its input.
    """
    k1, k2 = (np.exp(-(a / b) * (1.8 * b / a) ** (1 / 1.8)) for a, b in ((1.1, 2.0), (12.0, 37.0)))
    pulse = "+".join(
        f"{amps / k:.6g}*pow(time/{rise}n,1.8)/(1+pow(time/{rise}n,1.8))*exp(-time/{fall}n)"
        for amps, k, rise, fall in ((33.2, k1, 1.1, 2), (18.6, k2, 12, 37))
    )
    for sign in ("", "-"):
        deck = clamp(
            replace_elements(write_deck("MCP6022", 3.0), IJ1=f"BJ1 0 {net} I={sign}({pulse})"),
            "sum",
        )
        command = f"tran 0.1n 300n 0 0.1n\nlet amps = abs({behind})/{ohm}\nwrdata out amps v({net})"
        rows = run_ngspice(tmp_path, deck, command)
        largest_a, largest_v = (max(abs(row[i]) for row in rows) for i in (1, 2))
        assert largest_v > 7
        assert least_a < largest_a < most_a


@pytest.mark.parametrize("supply_v", [0.0, 3.3])
@pytest.mark.parametrize("net", ["adc_tactile", "adc_filtered"])
def test_five_volts_of_a_wrong_plug_drive_less_than_a_milliampere(
    tmp_path: Path, net: str, supply_v: float
) -> None:
    """Supply of another socket at T or S; amplifiers at ground,
    whose outputs sink all, with their clamps.
    """
    lines = [
        line
        for line in write_deck("MCP6022", 3.0).splitlines()
        if not line.startswith(("XU", "VJ3", "IJ1"))
    ]
    deck = clamp("\n".join(lines) + "\n", "tactile", "filtered").replace(
        "\n.ac ",
        f"\nVJ3 power_in 0 {supply_v}\nVW {net} 0 5\nRO1 tactile 0 1\nRO2 filtered 0 1{REST}\n.ac ",
    )
    ((_, amps),) = run_ngspice(tmp_path, deck, "op\nwrdata out i(vw)")
    assert 0.1e-3 < abs(amps) < 0.6e-3


def test_crosstalk_of_the_cable_is_that_of_ngspice(tmp_path: Path) -> None:
    design = Design.load("fsr400")
    stated = compute_cable_crosstalk(board_circuit(board_values(design)), design.board)
    lines = [
        line
        for line in write_deck("MCP6022", 3.0).splitlines()
        if not line.startswith(("XU", "IJ1"))
    ]
    for source, other, pin, found in zip(
        ("tactile", "filtered"),
        ("filtered", "tactile"),
        ("adc_filtered", "adc_tactile"),
        stated,
        strict=True,
    ):
        cable = (
            f"CW adc_tactile adc_filtered {60e-12 * design.board.cable_m}\nVT {source} 0 ac "
            f"1\nVO {other} 0 0{REST}"
        )
        deck = ("\n".join(lines) + "\n").replace("\n.ac ", f"\n{cable}\n.ac ")
        rows = run_ngspice(tmp_path, deck, f"ac dec 20 1 1k\nwrdata out vm({pin})")
        assert max(row[1] for row in rows) == pytest.approx(found, rel=0.01)
        assert found < 0.5e-3
