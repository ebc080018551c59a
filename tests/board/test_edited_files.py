"""A layout or schematic that somebody edited: values follow the
design, everything else stays as it was edited.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import takewhile
from pathlib import Path

import pytest

from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.netlist import (
    CircuitRecord,
    Part,
    describe_structure_changes,
    kicad_netlist_file,
    read_netlist,
)
from fingertip.board.kicad.sexpr import Node, find_word, quote, read_expression, replace_spans
from fingertip.board.parts.circuit import Component, Symbol, build_circuit
from fingertip.board.parts.symbols import CAPACITOR, R_0603, RESISTOR
from fingertip.catalogues.output_files import BOARD, LAYOUT, NETLIST, PROJECT, SCHEMATIC
from fingertip.foundation.errors import OutputError
from fingertip.foundation.output_set import Revision
from fingertip.tasks.board_files import write_board
from fingertip.tasks.edited_board import (
    enter_texts,
    find_edited,
    refuse_other_circuit,
    revise_edited,
)
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.board.test_layout import NO_VIOLATIONS, run_drc
from tests.conftest import run_fingertip
from tests.designs import ARTICLE, ARTICLE_OPTIONS, load_article
from tests.oracles.sexpressions import Expression, children, parse
from tests.tools import require_tool

OTHER_VALUES = ("board.cutoff_hz=80",)
"""Changes of a design that change values of R1, R2 and R3 alone."""
OTHER_PARTS = VARIANT_CHANGES["precision"]


def files_in(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def edit(path: Path, pattern: str, new: str) -> bytes:
    """Replace the first match in a file and return its new content."""
    text, count = re.subn(pattern, new, path.read_bytes().decode(), count=1, flags=re.DOTALL)
    assert count == 1
    path.write_bytes(text.encode())
    return path.read_bytes()


def move_r1(folder: Path) -> bytes:
    """Move R1 on the layout, as the text that KiCad would write."""
    return edit(folder / LAYOUT, r'(\(footprint "Resistor_SMD.*?\(at )[^)]*\)', r"\g<1>105 95 45)")


def move_label(path: Path) -> bytes:
    """Move the reference of R1."""
    return edit(path, r'("Reference" "R1"\s*\(at )\S+', r"\g<1>3")


def reindent(path: Path) -> None:
    """Indent a file in another way, with the line ends of Windows
    and a list that this program does not write.
    """
    text = path.read_bytes().decode().replace("\n  ", "\r\n\t").replace(")(", ") (")
    path.write_bytes(
        text.replace(
            "(embedded_fonts no))", '(embedded_fonts no)(mine "a \\"b\\" (c" 1e3))'
        ).encode()
    )


def fields(tree: Expression, kind: str) -> dict[str, dict[str, str]]:
    """Fields of the parts by reference; of a part with several units, those of the last."""
    found = {}
    for item in children(tree, kind):
        texts = {entry[1]: entry[2] for entry in children(item, "property")}
        found[texts["Reference"]] = texts
    return found


def without_fields(tree: Expression) -> Expression:
    """A file without the texts of its parts' fields and of what is
    printed on the board, such as the values.
    """
    return [
        (
            ["property", item[1], *item[3:]]
            if item and item[0] == "property"
            else ["gr_text", *item[2:]]
            if item and item[0] == "gr_text"
            else without_fields(item)
        )
        if isinstance(item, list)
        else item
        for item in tree
    ]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder with the board of the default design."""
    write_board(ARTICLE, tmp_path / "pcb")
    return tmp_path / "pcb"


@pytest.mark.parametrize(("name", "kind"), [(LAYOUT, "footprint"), (SCHEMATIC, "symbol")])
@pytest.mark.parametrize(
    "change",
    [lambda path: None, pytest.param(reindent, marks=pytest.mark.full)],
    ids=["as written", "indented"],
)
def test_values_are_entered_and_every_other_byte_stays(
    folder: Path, tmp_path: Path, name: str, kind: str, change: Callable[[Path], None]
) -> None:
    move_label(folder / name)
    change(folder / name)
    before = (folder / name).read_bytes().decode()
    notes: list[str] = []
    write_board(load_article(OTHER_VALUES), folder, progress=notes.append)
    after = (folder / name).read_bytes().decode()
    assert [note.partition("was edited; ")[2] for note in notes] == [
        "the values of R1, R2 and R3 are updated, and nothing else changes."
    ]
    write_board(load_article(OTHER_VALUES), tmp_path / "new")
    wanted = fields(parse((tmp_path / "new" / name).read_text("utf-8")), kind)
    assert fields(parse(after), kind) == wanted != fields(parse(before), kind)
    assert without_fields(parse(after)) == without_fields(parse(before))
    # Line by line, only lines with a field differ.
    lines = list(zip(before.split("\n"), after.split("\n"), strict=True))
    changed = [(old, new) for old, new in lines if old != new]
    assert 3 <= len(changed) <= 15
    text = re.compile(r'(\(property "[^"]*"|\(gr_text) "[^"]*"')
    for old, new in changed:
        assert text.sub(r"\1", old) == text.sub(r"\1", new)


@pytest.fixture
def small_board(tmp_path: Path) -> Path:
    """Folder with the files of a board of two resistors, as this program wrote them."""
    files = small_files("1k")
    BOARD.writer(ARTICLE, tmp_path).write(files)
    return tmp_path


def small_files(value: str, symbol: Symbol = RESISTOR) -> dict[str, bytes]:
    """Netlist, layout, schematic and project of two parts of a value."""
    parts = [Component(name, value, symbol, R_0603, "of a divider") for name in ("R1", "R2")]
    netlist = kicad_netlist_file(
        build_circuit("small", {part: {"1": "A", "2": "B"} for part in parts})
    )
    items = [
        (f'(path "{part.identifier}") (uuid "{part.identifier[1:]}")', name, part.fields["Value"])
        for name, part in read_netlist(netlist).parts.items()
    ]
    fields = [
        f'{ends} (property "Reference" "{name}") (property "Value" "{word}")'
        for ends, name, word in items
    ]
    layout, schematic = (
        f"(kicad {' '.join(f'({kind} {each})' for each in fields)})".encode()
        for kind in ("footprint", "symbol")
    )
    return {NETLIST: netlist, LAYOUT: layout, SCHEMATIC: schematic, PROJECT: b"{}"}


def revise_small(folder: Path, new: Mapping[str, bytes]) -> tuple[dict[str, Revision], list[str]]:
    return revise_edited(folder, new, lambda values: small_files(values["R1"])[LAYOUT])


def test_guard_revises_what_somebody_edited_and_nothing_else(small_board: Path) -> None:
    assert revise_small(small_board, small_files("2k")) == ({}, [])
    for name in (LAYOUT, PROJECT):
        (small_board / name).write_bytes((small_board / name).read_bytes() + b" by hand")
    revisions, notes = revise_small(small_board, small_files("2k"))
    assert revisions[LAYOUT].after == small_files("2k")[LAYOUT] + b" by hand"
    assert revisions.keys() == {LAYOUT, PROJECT}
    assert revisions[PROJECT].after == b"{} by hand"
    assert [note.partition(": ")[2].partition(", and")[0] for note in notes] == [
        "was changed in KiCad",
        "was edited; the values of R1 and R2 are updated",
    ]


def test_guard_refuses_what_an_edited_file_cannot_follow(small_board: Path) -> None:
    others = small_files("2k", CAPACITOR)
    with pytest.raises(
        OutputError, match=r"holds a board of 'fsr400' with another circuit.*with out beside"
    ):
        refuse_other_circuit(small_board, others[NETLIST], Path("beside"))
    refuse_other_circuit(small_board, small_files("2k")[NETLIST], Path("beside"))
    schematic = small_board / SCHEMATIC
    schematic.write_bytes(schematic.read_bytes().replace(b'"1k"', b'"3k"', 1))
    # What is edited is left to the other guard.
    refuse_other_circuit(small_board, others[NETLIST], Path("beside"))
    assert find_edited(small_board) == [SCHEMATIC]
    with pytest.raises(
        OutputError, match="R1 has Value '3k' by hand, and this design changes it from '1k' to '2k'"
    ):
        revise_small(small_board, small_files("2k"))
    with pytest.raises(OutputError, match="was edited, and this design changes more than values"):
        revise_small(small_board, others)
    (small_board / NETLIST).write_bytes(b"")
    with pytest.raises(OutputError, match="which states its circuit, is missing or was changed"):
        revise_small(small_board, small_files("2k"))


def test_change_of_parts_or_nets_writes_nothing(folder: Path) -> None:
    words = (
        "board",
        *ARTICLE_OPTIONS,
        "--out",
        folder,
        *(w for change in OTHER_PARTS for w in ("--set", change)),
    )
    move_label(folder / SCHEMATIC)
    move_r1(folder)
    before = files_in(folder)
    run = run_fingertip(*words)
    assert run.returncode == 2
    assert files_in(folder) == before
    lines = run.stderr.splitlines()
    assert len(lines) == 2
    for name, line in zip((LAYOUT, SCHEMATIC), lines, strict=True):
        assert f"{name}: was edited, and this design changes more than values (it " in line
        assert "add --force to overwrite your edits" in line
    assert run_fingertip(*words, "--force").returncode == 0
    assert b"(at 105 95 45)" not in (folder / LAYOUT).read_bytes()
    assert run_fingertip(*words, "--check").returncode == 0


def test_every_change_of_structure_is_described() -> None:
    """Values alone are none."""
    parts = {
        name: Part(f"id {name}", ("Lib:Footprint", "Lib:R"), {"Value": "1k"})
        for name in ("R1", "R2", "R3")
    }
    nets = {"A": frozenset({("R1", "1"), ("R2", "1")}), "B": frozenset({("R1", "2"), ("R3", "1")})}
    old = CircuitRecord(parts, nets)

    def describe(
        parts: Mapping[str, Part] = parts, nets: Mapping[str, frozenset[tuple[str, str]]] = nets
    ) -> str:
        return "; ".join(describe_structure_changes(old, CircuitRecord(parts, nets)))

    assert (
        describe() == describe({**parts, "R1": replace(parts["R1"], fields={"Value": "2k"})}) == ""
    )
    assert describe({**parts, "R4": parts["R1"]}) == "it adds R4"
    assert describe({"R1": parts["R1"]}) == "it removes R2 and R3"
    for kind in (("Lib:Other", "Lib:R"), ("Lib:Footprint", "Lib:Other")):
        other = {**parts, "R2": replace(parts["R2"], kind=kind)}
        assert describe(other) == "it changes the symbol or the footprint of R2"
    swapped = {"A": nets["B"], "B": nets["A"], "C": frozenset({("R3", "2")})}
    assert describe(nets=swapped) == "it changes the nets A, B and C"


@pytest.mark.full
def test_value_changed_by_hand_stays_where_the_design_does_not_change_it(folder: Path) -> None:
    edit(folder / LAYOUT, r'"Value" "82"', '"Value" "81.6"')
    notes: list[str] = []
    write_board(load_article(OTHER_VALUES), folder, progress=notes.append)
    (note,) = notes
    assert note.endswith(
        "Your values of R13 are in it alone: bom.csv, slip_filter.net, slip_filter.cir, "
        "values.json and assembly.svg "
        "have those of the design."
    )
    found = fields(parse((folder / LAYOUT).read_text("utf-8")), "footprint")
    assert found["R13"]["Value"] == "81.6"
    assert found["R1"]["Value"] == "2k"


@pytest.mark.full
def test_renumbered_part_keeps_its_value(folder: Path) -> None:
    """R1 is called R6 and R6 R1: the identifiers tell which is which."""
    for name in (LAYOUT, SCHEMATIC):
        text = (folder / name).read_bytes().decode()
        swapped = re.sub(r'"R([16])"', lambda match: f'"R{7 - int(match[1])}"', text)
        (folder / name).write_bytes(swapped.encode())
    write_board(load_article(OTHER_VALUES), folder)
    for name, kind in ((LAYOUT, "footprint"), (SCHEMATIC, "symbol")):
        found = fields(parse((folder / name).read_text("utf-8")), kind)
        assert found["R6"]["Value"] == found["R1"]["Value"] == "2k"
        assert found["R6"]["Role"].startswith("first stage")


def remove_r1(folder: Path) -> None:
    edit(folder / LAYOUT, r'\n  \(footprint "Resistor_SMD.*?(?=\n  \(footprint)', "")
    assert "R1" not in fields(parse((folder / LAYOUT).read_text("utf-8")), "footprint")
    write_board(ARTICLE, folder)  # nothing changes, so nothing is missed


def cut_layout(folder: Path) -> None:
    (folder / LAYOUT).write_bytes((folder / LAYOUT).read_bytes()[:5000])


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (remove_r1, "lacks R1, whose LCSC, MPN and Value"),
        (cut_layout, r"kicad_pcb: was edited and cannot be read \(it has no complete list\)"),
    ],
)
def test_edit_that_values_cannot_be_entered_into_is_refused(
    folder: Path, damage: Callable[[Path], None], words: str
) -> None:
    damage(folder)
    before = files_in(folder)
    with pytest.raises(OutputError, match=words):
        write_board(load_article(OTHER_VALUES), folder)
    assert files_in(folder) == before


def test_fabrication_files_of_an_edited_board_are_refused(folder: Path) -> None:
    move_r1(folder)
    before = files_in(folder)
    run = run_fingertip(
        "board", *ARTICLE_OPTIONS, "--out", folder, "--fab", "--set", OTHER_VALUES[0]
    )
    assert run.returncode == 2
    assert (
        "kicad_pcb: was edited, and --fab would export the board without your edits" in run.stderr
    )
    assert files_in(folder) == before


MOVE_WITH_KICAD = """
import sys, pcbnew
board = pcbnew.LoadBoard(sys.argv[1])
part = board.FindFootprintByReference("C11")
part.Move(pcbnew.VECTOR2I(0, pcbnew.FromMM(0.05)))
text = pcbnew.PCB_TEXT(board)
text.SetText("mine")
text.SetLayer(pcbnew.Cmts_User)
text.SetPosition(part.GetPosition())
board.Add(text)
pcbnew.ZONE_FILLER(board).Fill(board.Zones())
board.Save(sys.argv[1])
"""


@pytest.mark.full
def test_layout_saved_by_kicad_keeps_its_positions_and_passes_the_checks(folder: Path) -> None:
    require_tool("kicad-cli", HOW_TO_INSTALL_KICAD)
    require_tool("/usr/lib/python3/dist-packages/pcbnew.py", HOW_TO_INSTALL_KICAD)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    home = folder.parent / "home"
    home.mkdir()
    subprocess.run(
        ["/usr/bin/python3", "-c", MOVE_WITH_KICAD, folder / LAYOUT],
        check=True,
        capture_output=True,
        env=environment | {"HOME": str(home), "KICAD_CONFIG_HOME": str(home)},
    )
    move_label(folder / SCHEMATIC)
    saved = parse((folder / LAYOUT).read_text("utf-8"))
    assert run_drc(folder) == NO_VIOLATIONS
    write_board(load_article(OTHER_VALUES), folder)
    now = parse((folder / LAYOUT).read_text("utf-8"))
    assert without_fields(now) == without_fields(saved)
    assert (
        fields(now, "footprint")["R1"]["Value"] == "2k" != fields(saved, "footprint")["R1"]["Value"]
    )
    assert run_drc(folder) == NO_VIOLATIONS
    erc = kicad_cli(
        folder, "sch", "erc", SCHEMATIC, "--severity-all", "--exit-code-violations", "-o", "erc.rpt"
    )
    assert erc.returncode == 0, (folder / "erc.rpt").read_text()


def layout_with_texts(**texts: str) -> bytes:
    """Layout with texts by UUID."""
    return "\n".join(
        ["(kicad_pcb", *(f'  (gr_text "{t}" (at 1 2) (uuid "{u}"))' for u, t in texts.items()), ")"]
    ).encode()


def test_printed_values_follow_and_other_texts_stay() -> None:
    old = layout_with_texts(a="R1 2.4k", b="R2 1k", c="board")
    new = layout_with_texts(a="R1 2k", b="R2 2k", c="board")
    edited = layout_with_texts(c="board of mine", b="R2 by hand", a="R1 2.4k", d="R1 2.4k").replace(
        b"at 1", b"at 7"
    )
    after, is_complete = enter_texts(edited, old, new)
    assert (
        after
        == edited.replace(b'"R1 2.4k" (at 7 2) (uuid "a")', b'"R1 2k" (at 7 2) (uuid "a")')
        != edited
    )
    assert is_complete
    assert enter_texts(edited, old, layout_with_texts(a="R1 2k")) == (after, False)


TEXTS = (
    "(a)",
    '(a "b" (c 1 "") d)',
    ' \r\n(kicad_pcb\t(x "say \\"(no)\\" \\\\")\n(y -1.5e3 ä "ü\\n") )\n',
)


def leading_words(node: Node) -> list[tuple[Node, int, str]]:
    """Words of a list and of those within it that stand before
    any list, each with its list and index.
    """
    words = [
        (node, i, word)
        for i, word in enumerate(takewhile(lambda item: isinstance(item, str), node.items))
    ]
    return words + [
        word for item in node.items if isinstance(item, Node) for word in leading_words(item)
    ]


@pytest.mark.parametrize("text", TEXTS)
def test_words_are_found_in_their_place(text: str) -> None:
    assert replace_spans(text, {}) == text
    for node, index, word in leading_words(read_expression(text)):
        start, end = find_word(text, node, index)
        found = (
            text[start:end]
            .strip('"')
            .replace("\\n", "\n")
            .replace('\\"', '"')
            .replace("\\\\", "\\")
        )
        assert found == word
        assert text[node.start] == "("
        assert text[node.end - 1] == ")"
        changed = replace_spans(text, {(start, end): quote('new "word"')})
        assert changed == text[:start] + '"new \\"word\\""' + text[end:]
        assert 'new "word"' in [w for *_, w in leading_words(read_expression(changed))]


@pytest.mark.parametrize("text", ["", "(a", "a b", "(a))(", '(a "b)', ")"])
def test_incomplete_lists_are_refused(text: str) -> None:
    if text == "(a))(":
        assert read_expression(text).head == "a"  # what follows the first list does not count
        return
    with pytest.raises(ValueError, match=r"list|bracket"):
        read_expression(text)
