"""Against KiCad itself: its libraries have what the circuit names, and its PCB editor imports the netlist."""

from __future__ import annotations

import fnmatch
import functools
import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fingertip.board import board_circuit, board_values, write_board
from fingertip.board.circuit import kicad_name
from fingertip.board.kicad.identity import part_uuid
from fingertip.board.output import NETLIST
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from tests.board.expressions import Expression, children, everywhere, parse
from tests.board.kicad import HOW
from tests.tools import require_tool

CIRCUIT = board_circuit(board_values(Design()))
# Of all boards, by what they are: the same reference is another part on another supply.
PARTS = {
    (part.reference, part.symbol.name, part.footprint): part
    for variant in VARIANTS.values()
    for part in board_circuit(board_values(Design.load(changes=variant.changes))).parts
}.values()
SYMBOLS = sorted({part.symbol for part in PARTS}, key=lambda s: (s.library, s.name))
FOOTPRINTS = sorted({part.footprint for part in PARTS})


class Symbols(dict[str, Expression]):
    """A library's symbols by name, each read when it is asked for: the whole takes seconds."""

    def __init__(self, library: Path) -> None:
        pieces = library.read_text("utf-8").split('\n\t(symbol "')[1:]
        self.texts = {piece.split('"', 1)[0]: piece[: piece.index("\n\t)") + 3] for piece in pieces}

    def __missing__(self, name: str) -> Expression:
        self[name] = parse(f'(symbol "{self.texts[name]}')
        return self[name]


@functools.cache
def all_symbols(library: Path) -> Symbols:
    return Symbols(library)


def library_symbol(library: str, name: str) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """Properties and pins (number -> name, type) of a symbol; what it lacks it has from the symbol it extends."""
    symbols = all_symbols(require_tool("/usr/share/kicad/symbols", HOW) / f"{library}.kicad_sym")
    assert name in symbols.texts, f"{library} has no {name}"
    chain = [symbols[name]]
    while extended := next(children(chain[-1], "extends"), None):
        chain.append(symbols[extended[1]])
    properties = {p[1]: p[2] for symbol in reversed(chain) for p in children(symbol, "property")}
    pins = {}
    for pin in everywhere(chain[-1], "pin"):
        number, label = next(children(pin, "number"))[1], next(children(pin, "name"))[1]
        pins[number] = (label, pin[1])
    return properties, pins


@pytest.mark.parametrize("symbol", SYMBOLS, ids=lambda s: f"{s.library}:{s.name}")
def test_symbol_is_in_the_library_with_these_pins(symbol) -> None:  # type: ignore[no-untyped-def]
    _, pins = library_symbol(symbol.library, symbol.name)
    assert {pin.number: (pin.name, pin.kind) for pin in symbol.pins} == pins


@pytest.mark.parametrize("footprint", FOOTPRINTS)
def test_footprint_is_in_the_library_with_a_pad_for_each_pin(footprint: str) -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW)
    library, name = footprint.split(":")
    module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
    pads = {pad[1] for pad in children(module, "pad")} - {""}  # a hole is a pad without a number
    for part in PARTS:
        if part.footprint == footprint:
            assert {pin.number for pin in part.symbol.pins} == pads


@pytest.mark.parametrize("part", PARTS, ids=lambda p: p.reference)
def test_footprint_is_one_the_symbol_is_meant_for(part) -> None:  # type: ignore[no-untyped-def]
    properties, _ = library_symbol(part.symbol.library, part.symbol.name)
    filters = properties["ki_fp_filters"].split()
    candidates = (part.footprint, part.footprint.split(":")[1])
    assert any(fnmatch.fnmatchcase(name, pattern) for name in candidates for pattern in filters)


@pytest.fixture(scope="module")
def import_netlist(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """KiCad's PCB editor importing a netlist file: a function from the file to the record of the import."""
    editor, server, cli = (require_tool(name, HOW) for name in ("pcbnew", "Xvfb", "kicad-cli"))
    home = tmp_path_factory.mktemp("kicad")
    version = ".".join(subprocess.check_output([cli, "version"], text=True).split(".")[:2])
    plugins, settings = home / "documents" / "kicad" / version / "scripting" / "plugins", home / "settings" / version
    plugins.mkdir(parents=True)
    settings.mkdir(parents=True)
    shutil.copy(Path(__file__).with_name("pcbnew_import.py"), plugins)
    templates = require_tool("/usr/share/kicad/template", HOW)
    for table in ("fp-lib-table", "sym-lib-table"):
        shutil.copy(templates / table, settings)
    # Dialogs of a first start would be in the way.
    settings_file = {"do_not_show_again": {"data_collection_prompt": True, "update_check_prompt": True}}
    (settings / "kicad_common.json").write_text(json.dumps(settings_file))
    board = '(kicad_pcb (version 20221018) (generator pcbnew) (layers (0 "F.Cu" signal) (31 "B.Cu" signal)))'

    readable, writable = os.pipe()
    xvfb = subprocess.Popen(
        [server, "-displayfd", str(writable), "-screen", "0", "1280x900x24"],
        pass_fds=[writable], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(writable)
    with os.fdopen(readable) as pipe:
        display = pipe.readline().strip()  # the whole line: the server dies if nobody takes its last byte

    def run(netlist: Path) -> dict[str, Any]:
        folder = tmp_path_factory.mktemp("import")
        (folder / "empty.kicad_pcb").write_text(board)
        environment = os.environ | {
            "HOME": str(home), "KICAD_CONFIG_HOME": str(home / "settings"), "DISPLAY": f":{display}",
            "KICAD_DOCUMENTS_HOME": str(home / "documents"), "XDG_CACHE_HOME": str(home / "cache"),
            "FINGERTIP_NETLIST": str(netlist), "FINGERTIP_RECORD": str(folder / "record.json"),
        }  # fmt: skip
        record = folder / "record.json"
        command = [editor, folder / "empty.kicad_pcb"]
        done = subprocess.run(command, env=environment, timeout=60, capture_output=True, text=True, check=False)
        assert record.exists(), f"the PCB editor ended with {done.returncode}: {done.stderr}"
        return json.loads(record.read_text("utf-8"))  # type: ignore[no-any-return]

    yield run
    xvfb.terminate()
    xvfb.wait()


def test_pcb_editor_imports_the_netlist(import_netlist: Any, tmp_path: Path) -> None:
    write_board(Design(), tmp_path)
    record = import_netlist(tmp_path / NETLIST)
    assert "failed" not in record, record
    assert "Total warnings: 0, errors: 0." in record["tested"]
    assert "Total warnings: 0, errors: 0." in record["updated"]
    nets = {node: kicad_name(net.name) for net in CIRCUIT.nets for node in net.nodes}
    for part in record["board"].values():
        part["nets"].pop("", None)  # a hole is a pad without a number
    assert record["board"] == {
        part.reference: {
            "value": part.value,
            "footprint": part.footprint,
            "path": f"/{part_uuid(CIRCUIT, part.reference)}",
            "nets": {pin.number: nets[part.reference, pin.number] for pin in part.symbol.pins},
        }
        for part in CIRCUIT.parts
    }


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("(export (version", "(export\n  (version"),  # not recognized as a netlist at all
        ('(code "3")', '(code "0")'),  # the ground net is dropped without a word
        ("Package_SO:SOIC-8_3.9x4.9mm_P1.27mm", "Package_SO:SOIC-8_no_such"),
    ],
    ids=["line break", "net code 0", "footprint"],
)
def test_pcb_editor_notices_a_spoiled_netlist(import_netlist: Any, tmp_path: Path, right: str, wrong: str) -> None:
    """The check above can fail: each of these gives warnings, errors or another board."""
    write_board(Design(), tmp_path)
    text = (tmp_path / NETLIST).read_text("utf-8")
    assert right in text
    (tmp_path / "spoiled.net").write_text(text.replace(right, wrong), encoding="utf-8")
    record = import_netlist(tmp_path / "spoiled.net")
    assert "failed" not in record, record
    if "refused" in record:
        return
    clean = "Total warnings: 0, errors: 0." in record["tested"]
    connected = sum(bool(net) for part in record["board"].values() for net in part["nets"].values())
    assert not clean or connected < sum(len(net.nodes) for net in CIRCUIT.nets)
