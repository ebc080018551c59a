"""Circuits are consistent, and their netlist is read back and has the transfer function of the filter."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board import board_circuit, board_values
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.netlist import component_uuid
from fingertip.board.parts.circuit import format_component_value, parse_component_value
from fingertip.board.parts.nets import kicad_net_name
from fingertip.catalogues.output_files import NETLIST
from fingertip.design import Design
from fingertip.tasks.board import write_board
from tests.board.kicad import read_netlist
from tests.designs import ARTICLE, load_article
from tests.oracles.filter_formulas import filter_transfer, tactile_pin_transfer
from tests.oracles.ideal_filter import ideal_filter_transfer
from tests.oracles.netlist_nodal import NetlistCircuit, number
from tests.oracles.sexpressions import children, descendants, parse, word

# Circuits


CIRCUIT = board_circuit(board_values(ARTICLE))


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_every_pin_is_in_one_net_and_every_net_has_two_pins(name: str) -> None:
    circuit = board_circuit(board_values(load_article(VARIANT_CHANGES[name])))
    nodes = [node for net in circuit.nets for node in net.nodes]
    assert len(nodes) == len(set(nodes))
    assert set(nodes) == {(c.reference, pin.number) for c in circuit.components for pin in c.symbol.pins}
    assert all(len(net.nodes) >= 2 for net in circuit.nets)
    assert len({c.reference for c in circuit.components}) == len(circuit.components)
    assert all(c.reference[-1].isdigit() for c in circuit.components)


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("value", "text"),
    [(4700, "4.7k"), (1180, "1.18k"), (10e6, "10M"), (47, "47"), (1e-6, "1u"), (2.2e-6, "2.2u"), (1e-7, "100n"),
     (1e-12, "1p"), (1e-3, "1m"), (0.99999999999999e-6, "1u")],
)  # fmt: skip
def test_format_component_value_uses_si_prefixes(value: float, text: str) -> None:
    assert format_component_value(value) == text


@given(st.floats(1e-12, 1e8))
def test_formatted_component_values_can_be_parsed(value: float) -> None:
    assert number(format_component_value(value)) == pytest.approx(value, rel=1e-9)
    assert parse_component_value(format_component_value(value)) == pytest.approx(value, rel=1e-9)


# The netlist file


FILES = [
    "3d",
    "README.md",
    "assembly.svg",
    "bom.csv",
    "manifest.json",
    "slip_filter.cir",
    "slip_filter.kicad_pcb",
    "slip_filter.kicad_pro",
    "slip_filter.kicad_sch",
    "slip_filter.net",
    "values.json",
]
FREQUENCIES = [10 ** (i / 20) for i in range(101)]  # 1 Hz to 100 kHz
DESIGNS = {
    "article": [],
    "another": ["board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.passband_gain=21", "board.series=E12"],
}


def write_netlist(folder: Path, changes: list[str]) -> tuple[Design, Path]:
    design = load_article(changes)
    write_board(design, folder)
    return design, folder / NETLIST


@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_wiring_has_the_transfer_function_of_the_filter_and_negative_feedback(
    tmp_path: Path, changes: list[str]
) -> None:
    design, path = write_netlist(tmp_path, changes)
    circuit, values = NetlistCircuit(path), board_values(design).preferred
    for f in FREQUENCIES:
        assert abs(circuit.gain(f, "/TACTILE", "/FILTERED") / ideal_filter_transfer(f, values) - 1) < 1e-9
    poles = circuit.poles("/TACTILE")
    assert len(poles) == 10  # one for each of C1 to C4, C7 to C9 and C19, one for each amplifier
    assert max(poles.real) < 0
    # Identifiers do not depend on values, so that KiCad keeps what somebody placed.
    assert component_uuid(board_circuit(board_values(design)), "R1") == "0954e7c3-2994-54f4-a8ff-12cb4395b0e6"


@pytest.mark.parametrize("name", ["article", "comparator"])
def test_independent_reader_reads_the_circuit(tmp_path: Path, name: str) -> None:
    design, path = write_netlist(tmp_path, list(VARIANT_CHANGES[name]))
    circuit, tree = board_circuit(board_values(design)), parse(path.read_text("utf-8"))
    parts = {
        (word(part, "ref"), word(part, "value"), word(source, "lib"), word(source, "part"), word(part, "footprint"))
        for part in descendants(tree, "comp")
        for source in children(part, "libsource")
    }
    assert parts == {(p.reference, p.value, p.symbol.library, p.symbol.name, p.footprint) for p in circuit.components}
    nets, _ = read_netlist(path)
    assert nets == {kicad_net_name(n.name): set(n.nodes) for n in circuit.nets}
    symbols = {
        (word(symbol, "lib"), word(symbol, "part")): {
            (word(pin, "num"), word(pin, "name"), word(pin, "type")) for pin in descendants(symbol, "pin")
        }
        for symbol in descendants(tree, "libpart")
    }
    assert symbols == {
        (p.symbol.library, p.symbol.name): {(pin.number, pin.name, pin.electrical_type) for pin in p.symbol.pins}
        for p in circuit.components
    }


@pytest.mark.parametrize("name", ["precision", "comparator"])
def test_wiring_around_vmid_has_the_transfer_function_of_the_filter(tmp_path: Path, name: str) -> None:
    """All signals refer to VMID, the buffered mid-supply. Nothing of the filter returns to ground."""
    design, path = write_netlist(tmp_path, list(VARIANT_CHANGES[name]))
    circuit, values = NetlistCircuit(path), board_values(design)
    for f in FREQUENCIES[::5]:
        found = {net: circuit.gain(f, "/TACTILE", net, 1e14) for net in ("/FILTERED", "/ADC_TACTILE", "VMID")}
        # The remaining difference is the open-loop gain of 2e5: the netlist's amplifiers are ideal.
        assert found["/FILTERED"] == pytest.approx(
            filter_transfer(f, values.preferred, 1e14, values.first_stage_capacitors, input_f=0.0), rel=1e-3, abs=1e-9
        )
        assert found["/ADC_TACTILE"] == pytest.approx(tactile_pin_transfer(f, values.adc_interface), rel=1e-9)
        assert abs(found["VMID"]) < 1e-6
    # After blocking diodes the rectifier's amplifier is an integrator, with a pole at zero. All others are negative.
    poles = sorted(circuit.poles("/TACTILE").real)[::-1]
    has_rectifier = name == "comparator"
    assert (poles[0] == 0) == has_rectifier
    assert poles[has_rectifier] < 0
    assert circuit.nodes("U2", "6", "7") + circuit.nodes("R3", "2") == ("VMID",) * 3
    if has_rectifier:
        assert circuit.nodes("R24", "2") == ("VMID",)
    assert circuit.nodes("J1", "2") == ("GND",)
