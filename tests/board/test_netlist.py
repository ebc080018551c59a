"""The netlist file: its content by an independent reader, the transfer function of its wiring, and reproducibility."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.netlist import component_uuid
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import kicad_net_name
from fingertip.catalogues.output_files import NETLIST
from fingertip.design import Design
from fingertip.tasks.board import write_board
from tests.board.kicad import read_netlist
from tests.conftest import ROOT, run_fingertip
from tests.designs import load_article
from tests.oracles.filter_formulas import filter_transfer, tactile_pin_transfer
from tests.oracles.ideal_filter import ideal_filter_transfer
from tests.oracles.netlist_nodal import NetlistCircuit
from tests.oracles.sexpressions import children, descendants, parse, word

FILES = [
    "3d",
    "README.md",
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


def max_deviation(circuit: NetlistCircuit, design: Design) -> float:
    """Maximum relative deviation of the wired circuit from eq. (9), from 1 Hz to 100 kHz."""
    values = board_values(design).preferred
    expected = [(f, ideal_filter_transfer(f, values)) for f in FREQUENCIES]
    return max(abs(circuit.gain(f, "/TACTILE", "/FILTERED") / H - 1) for f, H in expected)


@pytest.mark.full
@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_wiring_has_the_transfer_function_of_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, path = write_netlist(tmp_path, changes)
    assert max_deviation(NetlistCircuit(path), design) < 1e-9


def test_feedback_is_negative(tmp_path: Path) -> None:
    _, path = write_netlist(tmp_path, [])
    poles = NetlistCircuit(path).poles("/TACTILE")
    assert len(poles) == 10  # one for each of C1 to C4, C7 to C9 and C19, one for each amplifier
    assert max(poles.real) < 0


@pytest.mark.parametrize("name", ["article_split", "comparator_single"])
def test_independent_reader_reads_the_circuit(tmp_path: Path, name: str) -> None:
    design, path = write_netlist(tmp_path, list(BOARD_CONFIGURATIONS[name].changes))
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


@pytest.mark.full
@pytest.mark.parametrize("name", ["article_single", "precision_single", "comparator_single"])
def test_wiring_on_a_single_supply_has_the_transfer_function_of_the_filter(tmp_path: Path, name: str) -> None:
    """All signals refer to VMID, the buffered mid-supply. Nothing of the filter returns to ground."""
    design, path = write_netlist(tmp_path, list(BOARD_CONFIGURATIONS[name].changes))
    circuit, values = NetlistCircuit(path), board_values(design)
    for f in FREQUENCIES[::5]:
        found = {net: circuit.gain(f, "/TACTILE", net, 1e14) for net in ("/FILTERED", "/ADC_TACTILE", "VMID")}
        # The remaining difference is the open-loop gain of 2e5: the netlist's amplifiers are ideal.
        assert found["/FILTERED"] == pytest.approx(
            filter_transfer(f, values.preferred, 1e14, values.first_stage_capacitors, input_f=0.0), rel=1e-3, abs=1e-9
        )
        assert found["/ADC_TACTILE"] == pytest.approx(tactile_pin_transfer(f, values.adc_interface), rel=1e-9)
        assert abs(found["VMID"]) < 1e-6
    # After blocking diodes U3a is an integrator, with a pole at zero. All other poles are negative.
    poles = sorted(circuit.poles("/TACTILE").real)[::-1]
    assert poles[0] < 0 if name == "article_single" else poles[0] == 0 > poles[1]
    assert circuit.nodes("U5", "1", "4") == circuit.nodes("J1", "2") + circuit.nodes("R24", "2") == ("VMID",) * 2


def test_uuids_do_not_depend_on_values() -> None:
    first, second = (board_circuit(board_values(load_article(c))) for c in ([], ["board.series=E96"]))
    assert first != second
    assert component_uuid(first, "R1") == component_uuid(second, "R1") == "0954e7c3-2994-54f4-a8ff-12cb4395b0e6"


@pytest.mark.full
def test_two_processes_write_the_same_bytes(tmp_path: Path) -> None:
    digests = []
    for seed in ("1", "2"):
        out = tmp_path / seed / "pcb"
        run = run_fingertip("board", "--out", out, "--quiet", PYTHONHASHSEED=seed)
        assert run.returncode == 0, run.stderr
        files = sorted(path for path in out.rglob("*") if path.is_file())
        digests.append({p.relative_to(out): hashlib.sha256(p.read_bytes()).hexdigest() for p in files})
    assert digests[0] == digests[1]
    assert sorted({path.parts[0] for path in digests[0]}) == FILES


@pytest.mark.full
@pytest.mark.parametrize(("design", "folder"), [("fsr400", "pcb"), ("article", "pcb/article")])
def test_bundled_board_files_are_up_to_date(tmp_path: Path, design: str, folder: str) -> None:
    """The folder pcb/ holds the default board with its bring-up sheet, pcb/article/ that of the article."""
    write_board(Design.load(design), tmp_path, bring_up=True)
    for name in (file.relative_to(tmp_path) for file in tmp_path.rglob("*") if file.is_file()):
        assert (ROOT / folder / name).read_bytes() == (tmp_path / name).read_bytes(), (
            f"run: fingertip board {design} --out {folder} --bringup ({name})"
        )
