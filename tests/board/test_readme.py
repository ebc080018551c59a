"""Documents of a board, compared whole with approved ones: README, bring-up, wiring, analysis.

The approved documents of the default board and of the article's are those in `pcb/`, which the
manifest compares. After a change that is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest
tests/board/test_readme.py` writes the rest.
"""

from __future__ import annotations

import functools
import re
import statistics
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fingertip.board.analysis.board_analysis import Analysis, analyse
from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.placement import list_pads, read_reference
from fingertip.board.kicad.sexpr import read_expression
from fingertip.cli.board_tables import analysis_text
from fingertip.design import Design
from fingertip.documents.wiring import wiring_diagram
from fingertip.tasks.board_files import board_files, bring_up_files, write_board
from tests.approved import check_text
from tests.conftest import ROOT
from tests.designs import load_article

APPROVED = Path(__file__).parent / "approved"


OTHERS = {
    "comparator": lambda: load_article(VARIANT_CHANGES["comparator"]),
    "channels": lambda: Design.load("fsr400", changes=["board.channels=2"]),
}
"""Boards that `pcb/` does not hold."""
SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("name", "file"),
    [
        *((name, file) for name in OTHERS for file in ("README.md", "bringup.md", "bringup.ino")),
        ("comparator", "slip_filter.cir"),
        ("comparator", "bom.csv"),
    ],
)
def test_documents_of_other_boards_are_the_approved_ones(name: str, file: str) -> None:
    check_text(APPROVED / f"{name}_{file}", files_of(name)[file])


@pytest.mark.parametrize("changes", [*VARIANT_CHANGES.values(), ("board.channels=5",)])
def test_readme_has_at_most_1800_words_and_the_bring_up_sheet_900(changes: tuple[str, ...]) -> None:
    design = Design.load("fsr400", changes=changes)
    files = board_files(design) | bring_up_files(design)
    for name, most in (("README.md", 1800), ("bringup.md", 900)):
        assert (
            len([word for word in files[name].decode().split() if re.search(r"\w", word)]) <= most
        )


@functools.cache
def files_of(name: str) -> Mapping[str, bytes]:
    return board_files(OTHERS[name]()) | bring_up_files(OTHERS[name]())


@pytest.mark.parametrize("name", OTHERS)
def test_texts_of_the_wiring_diagram_are_the_approved_ones(name: str) -> None:
    """A line for each height, from left to right."""
    rows: dict[float, list[tuple[float, str]]] = {}
    for text in ElementTree.fromstring(files_of(name)["wiring.svg"]).iter(f"{SVG}text"):
        rows.setdefault(float(text.attrib["y"]), []).append(
            (float(text.attrib["x"]), text.text or "")
        )
    lines = [" | ".join(text for _, text in sorted(row)) for _, row in sorted(rows.items())]
    check_text(APPROVED / f"{name}_wiring.txt", "\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("name", "folder", "has_bring_up"),
    [
        ("fsr400", "pcb", False),
        pytest.param("fsr400", "pcb", True, marks=pytest.mark.full),
        ("article", "pcb/article", True),
    ],
)
def test_bundled_board_is_up_to_date(
    name: str, folder: str, has_bring_up: bool, tmp_path: Path
) -> None:
    """The folder pcb/ holds the default board with its bring-up
    sheet, pcb/article/ that of the article.
    """
    write_board(Design.load(name), tmp_path, bring_up=has_bring_up)
    for path in (path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()):
        if has_bring_up or path.name != "manifest.json":
            hint = f"run: fingertip board {name} --out {folder} --bringup ({path})"
            assert (tmp_path / path).read_bytes() == (ROOT / folder / path).read_bytes(), hint


@functools.cache
def analysis_of(variant: str) -> Analysis:
    return analyse(load_article(VARIANT_CHANGES[variant]), boards=400)


@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_analysis_is_the_approved_one(variant: str) -> None:
    text = analysis_text(load_article(VARIANT_CHANGES[variant]), analysis_of(variant))
    check_text(APPROVED / f"analysis_{variant}.txt", text)


# Legibility of the diagrams


@pytest.mark.every_case
@pytest.mark.parametrize(
    "changes", [*VARIANT_CHANGES.values(), (*VARIANT_CHANGES["precision"], "board.channels=3")]
)
def test_texts_of_the_wiring_diagram_are_apart_and_inside_it(changes: tuple[str, ...]) -> None:
    """A character is taken to be 0.6 of the font size wide, which
    is more than Helvetica has on average.
    """
    design = load_article(changes)
    circuit = board_circuit(board_values(design), design.board.channels)
    drawing = wiring_diagram(circuit, design.board.supply_v, design.name)
    root = ElementTree.fromstring(drawing)
    size = 13.0
    boxes = []
    for text in root.iter(f"{SVG}text"):
        x = float(text.attrib["x"])
        y = float(text.attrib["y"])
        length = 0.6 * size * len(text.text or "")
        left = (
            x
            - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.attrib.get("text-anchor", "start")]
            * length
        )
        boxes.append((left, y - 0.8 * size, left + length, y + 0.2 * size, text.text))
    width = float(root.attrib["width"])
    height = float(root.attrib["height"])
    assert all(
        box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height for box in boxes
    )
    for a, b in combinations(boxes, 2):
        assert min(a[2], b[2]) <= max(a[0], b[0]) or min(a[3], b[3]) <= max(a[1], b[1]), (
            a[4],
            b[4],
        )


@pytest.mark.parametrize("changes", [(), ("board.channels=5",), ("board.variant=comparator",)])
def test_the_wiring_diagram_has_connectors_and_pins_where_the_board_has_them(
    changes: tuple[str, ...],
) -> None:
    design = Design.load("adult_finger", changes=changes)
    circuit = board_circuit(board_values(design), design.board.channels)
    layout = read_expression(board_files(design)["slip_filter.kicad_pcb"].decode())
    pads = [
        (*pad.centre, f"{reference}.{pad.name}")
        for footprint in layout.children("footprint")
        if re.fullmatch(r"J\d+", reference := read_reference(footprint))
        for pad in list_pads(footprint)
        if pad.name.isdigit()
    ]
    middle = statistics.mean(x for x, _, _ in pads)
    drawing = ElementTree.fromstring(wiring_diagram(circuit, design.board.supply_v, design.name))
    for plug_x, pin_x, is_left in (("418", "382", True), ("542", "578", False)):
        drawn = []
        connector = ""
        for text in drawing.iter(f"{SVG}text"):
            connector = text.text or "" if text.attrib["x"] == plug_x else connector
            drawn += (
                [(float(text.attrib["y"]), f"{connector}.{text.text}")]
                if text.attrib["x"] == pin_x
                else []
            )
        placed = [(y, pin) for x, y, pin in pads if (x < middle) is is_left]
        assert [pin for _, pin in sorted(drawn)] == [pin for _, pin in sorted(placed)]
