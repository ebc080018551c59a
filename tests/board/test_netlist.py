"""The netlist file: what another parser reads back, what the wiring does, and the same bytes each time."""

from __future__ import annotations

import hashlib
import re
import uuid
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values, write_board
from fingertip.board.circuit import kicad_name
from fingertip.board.kicad.identity import part_uuid
from fingertip.board.output import NETLIST
from fingertip.board.values.built import network
from fingertip.board.values.filters import filter_network
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from tests.board.nodal import NetlistCircuit, parse
from tests.conftest import ROOT, run_fingertip

FILES = [
    "README.md",
    "bom.csv",
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


def written(folder: Path, changes: list[str]) -> tuple[Design, Path]:
    design = Design.load(changes=changes)
    write_board(design, folder)
    return design, folder / NETLIST


def worst(circuit: NetlistCircuit, design: Design) -> float:
    """Largest relative deviation of the wired circuit from eq. (9), 1 Hz to 100 kHz."""
    values = board_values(design).preferred
    wanted = [(f, filter_network(f, values)) for f in FREQUENCIES]
    return max(abs(circuit.gain(f, "/TACTILE", "/FILTERED") / H - 1) for f, H in wanted)


@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_the_wiring_is_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, path = written(tmp_path, changes)
    assert worst(NetlistCircuit(path), design) < 1e-9


SWAPS = [
    (("R1", "1"), ("R3", "1")), (("R2", "1"), ("C3", "2")), (("C2", "2"), ("C3", "2")), (("R4", "1"), ("R5", "1")),
    (("R2", "2"), ("R3", "2")), (("U1", "3"), ("U1", "5")), (("U1", "2"), ("U1", "6")),
    (("U1", "1"), ("U1", "7")), (("U1", "2"), ("U1", "3")), (("U1", "5"), ("U1", "6")),
]  # fmt: skip


def test_the_feedback_is_negative(tmp_path: Path) -> None:
    _, path = written(tmp_path, [])
    poles = NetlistCircuit(path).poles("/TACTILE")
    assert len(poles) == 10  # one for each of C1 to C4, C7 to C9 and C19, one for each amplifier
    assert max(poles.real) < 0


@pytest.mark.parametrize("swap", SWAPS)
def test_a_miswired_netlist_is_caught(tmp_path: Path, swap: tuple[tuple[str, str], tuple[str, str]]) -> None:
    design, path = written(tmp_path, [])
    circuit = NetlistCircuit(path).swapped(*swap)
    assert not worst(circuit, design) < 1e-2 or max(circuit.poles("/TACTILE").real) > 0


@pytest.mark.parametrize("reference", ["C1", "R2"])
def test_a_part_turned_around_is_the_same_circuit(tmp_path: Path, reference: str) -> None:
    """The oracle does not cry wolf."""
    design, path = written(tmp_path, [])
    assert worst(NetlistCircuit(path).swapped((reference, "1"), (reference, "2")), design) < 1e-9


def test_diode_and_envelope(tmp_path: Path) -> None:
    """The diode lets positive voltages through to R_LP parallel to C_LP, which are all that is on the output."""
    _, path = written(tmp_path, [])
    circuit = NetlistCircuit(path)
    assert circuit.nodes("D1", "2", "1") == ("/FILTERED", "/ENVELOPE")  # anode, cathode
    assert {node for node, net in circuit.net.items() if net == "/ENVELOPE"} == {
        ("D1", "1"), ("R6", "1"), ("C4", "1"), ("R7", "1"), ("TP4", "1"),
    }  # fmt: skip
    assert circuit.nodes("R6", "2") == circuit.nodes("C4", "2") == circuit.nodes("J3", "3") == ("GND",)
    assert circuit.nodes("U1", "8", "4") == circuit.nodes("J2", "1", "3") == ("VCC", "VEE")


@pytest.mark.parametrize("name", ["article_split", "comparator_single"])
def test_another_parser_reads_what_the_circuit_says(tmp_path: Path, name: str) -> None:
    design, path = written(tmp_path, list(VARIANTS[name].changes))
    assert read_differently(design, path) == []


@pytest.mark.parametrize(
    ("right", "wrong", "seen"),
    [
        ('(ref "R2") (pin "1")', '(ref "R2") (pin "7")', "nets"),
        ("Capacitor_SMD:C_1206_3216Metric", "Capacitor_SMD:C_0402_1005Metric", "parts"),
        ('(ref "R4")', '(ref "R44")', "parts"),
    ],
    ids=["pin", "footprint", "reference"],
)
def test_a_spoiled_netlist_is_noticed(tmp_path: Path, right: str, wrong: str, seen: str) -> None:
    design, path = written(tmp_path, [])
    text = path.read_text("utf-8")
    assert right in text
    path.write_text(text.replace(right, wrong, 1), "utf-8")
    assert seen in read_differently(design, path)


def read_differently(design: Design, path: Path) -> list[str]:
    """What of a netlist file another parser reads otherwise than the circuit says."""
    circuit, parsed = board_circuit(board_values(design)), parse(path)
    parts = {(p.ref, p.value, p.lib, p.name, p.footprint) for p in parsed.parts}
    nets = {n.name: {(pin.ref, pin.num) for pin in n.pins} for n in parsed.nets}
    symbols = {(p.lib, p.name): {(pin.num, pin.name, pin.type) for pin in p.pins} for p in parsed.libparts}
    same = {
        "parts": parts == {(p.reference, p.value, p.symbol.library, p.symbol.name, p.footprint) for p in circuit.parts},
        "nets": nets == {kicad_name(n.name): set(n.nodes) for n in circuit.nets},
        "symbols": symbols
        == {
            (p.symbol.library, p.symbol.name): {(pin.number, pin.name, pin.kind) for pin in p.symbol.pins}
            for p in circuit.parts
        },
    }
    return [what for what, equal in same.items() if not equal]


@pytest.mark.parametrize("name", ["article_single", "precision_single", "comparator_single"])
def test_on_a_single_supply_the_wiring_is_the_filter_too(tmp_path: Path, name: str) -> None:
    """All signals against the middle, which a follower holds; nothing of the filter returns to ground."""
    design, path = written(tmp_path, list(VARIANTS[name].changes))
    circuit, values = NetlistCircuit(path), board_values(design)
    for f in FREQUENCIES[::5]:
        found = {net: circuit.gain(f, "/TACTILE", net, 1e14) for net in ("/FILTERED", "/ADC_TACTILE", "VMID")}
        # What is left is the open-loop gain of 2e5, which the netlist's amplifiers do not have.
        assert found["/FILTERED"] == pytest.approx(
            network(f, values.preferred, 1e14, values.first_stage), rel=1e-3, abs=1e-9
        )
        assert found["/ADC_TACTILE"] == pytest.approx(values.converter.raw(f), rel=1e-9)
        assert abs(found["VMID"]) < 1e-6
    # Behind open diodes U3a is an integrator; nothing else stays where it is.
    slow = sorted(circuit.poles("/TACTILE").real)[::-1]
    assert slow[0] < 0 if name == "article_single" else slow[0] == 0 > slow[1]
    assert circuit.nodes("U5", "1", "4") == circuit.nodes("J1", "2") + circuit.nodes("R24", "2") == ("VMID",) * 2
    assert circuit.nodes("R24", "1") == circuit.nodes("J3", "5")
    assert {circuit.net[pin] for pin in (("U1", "4"), ("U2", "4"), ("U5", "2"), ("J2", "2"), ("J3", "3"))} == {"GND"}
    at_rest = {("R1", "2"), ("R3", "2"), ("R11", "2"), ("R13", "2"), ("U2", "5"), ("C7", "2")}
    at_rest |= (
        {("R4", "2"), ("R6", "2"), ("C4", "2")}
        if name == "article_single"
        else {("C14", "1"), ("U3", "3"), ("U3", "5")}
    )
    at_rest |= {("RV1", "3"), ("C17", "2")} if name == "comparator_single" else set()
    assert {circuit.net[pin] for pin in at_rest} == {"VMID"}


def test_what_kicads_reader_insists_on(tmp_path: Path) -> None:
    design, path = written(tmp_path, [])
    text = path.read_text(encoding="utf-8")
    assert text.startswith('(export (version "E")\n')  # recognized by "(export " on the first line
    sections = [text.index(f"\n  ({name}") for name in ("design", "components", "libparts", "nets")]
    assert sections == sorted(sections)
    assert [int(code) for code in re.findall(r'\(code "(\d+)"\)', text)] == list(range(1, 19))
    assert text.count('(sheetpath (names "/") (tstamps "/"))') == len(board_circuit(board_values(design)).parts)
    stamps = re.findall(r'\(tstamps "([^/"]+)"\)', text)
    assert len(stamps) == len(set(stamps)) == text.count("(comp\n")
    assert all(str(uuid.UUID(stamp)) == stamp and uuid.UUID(stamp).version == 5 for stamp in stamps)
    assert text.count("(") == text.count(")")


def test_identifiers_survive_new_values() -> None:
    first, second = (board_circuit(board_values(Design.load(changes=c))) for c in ([], ["board.series=E96"]))
    assert first != second
    assert part_uuid(first, "R1") == part_uuid(second, "R1") == "0954e7c3-2994-54f4-a8ff-12cb4395b0e6"


def test_same_bytes_in_two_processes(tmp_path: Path) -> None:
    digests = []
    for seed in ("1", "2"):
        out = tmp_path / seed / "pcb"
        run = run_fingertip("board", "--out", out, "--quiet", PYTHONHASHSEED=seed)
        assert run.returncode == 0, run.stderr
        digests.append({p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(out.iterdir())})
    assert digests[0] == digests[1]
    assert list(digests[0]) == FILES


def test_bundled_files_are_current(tmp_path: Path) -> None:
    """pcb/ holds what the default design gives today."""
    _, path = written(tmp_path, [])
    for file in path.parent.iterdir():
        assert (ROOT / "pcb" / file.name).read_bytes() == file.read_bytes(), f"run: fingertip board ({file.name})"


def test_no_date_and_no_path_in_the_files(tmp_path: Path) -> None:
    written(tmp_path, [])
    for file in tmp_path.iterdir():
        text = file.read_text(encoding="utf-8")
        assert str(tmp_path) not in text
        without_identifiers = re.sub(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", "", text)
        assert not re.search(r"\b20\d\d-\d\d", without_identifiers)
        assert not re.search(r'"/[a-z]', without_identifiers)
