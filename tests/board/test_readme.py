"""Documents of a board, compared whole with approved ones: README, bring-up, wiring, analysis, report on readings.

The approved documents of the default board and of the article's are those in `pcb/`, which the manifest compares.
After a change that is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest tests/board/test_readme.py` writes the rest.
"""

from __future__ import annotations

import functools
import math
import re
import statistics
from collections.abc import Iterator, Mapping
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.report import Analysis, analyse
from fingertip.board.bringup.assessment import assess_readings
from fingertip.board.bringup.bench import TONE_V, list_faults
from fingertip.board.bringup.diagnosis import diagnose
from fingertip.board.bringup.plan import SUPPLY_MA, BringUp
from fingertip.board.bringup.prediction import is_tone, predict
from fingertip.board.bringup.readings import Readings
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.placement import list_pads, read_reference
from fingertip.board.kicad.sexpr import read_expression
from fingertip.cli.board_tables import analysis_text
from fingertip.design import Design
from fingertip.documents.wiring import wiring_diagram
from fingertip.tasks.board import board_files, bring_up_files, write_board
from tests.approved import check_text
from tests.board.test_bringup import draw_board, plan_of
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
    [*((name, file) for name in OTHERS for file in ("README.md", "bringup.md")), ("channels", "bringup_readings.toml"),
     ("comparator", "slip_filter.cir"), ("comparator", "bom.csv")],
)  # fmt: skip
def test_documents_differ_from_those_of_the_default_board_as_approved(name: str, file: str) -> None:
    check_text(APPROVED / f"{name}_{file}", files_of(name)[file], ROOT / "pcb" / file)


@functools.cache
def files_of(name: str) -> Mapping[str, bytes]:
    return board_files(OTHERS[name]()) | bring_up_files(OTHERS[name]())


@pytest.mark.parametrize("name", OTHERS)
def test_texts_of_the_wiring_diagram_are_the_approved_ones(name: str) -> None:
    """A line for each height, from left to right."""
    rows: dict[float, list[tuple[float, str]]] = {}
    for text in ElementTree.fromstring(files_of(name)["wiring.svg"]).iter(f"{SVG}text"):
        rows.setdefault(float(text.attrib["y"]), []).append((float(text.attrib["x"]), text.text or ""))
    lines = [" | ".join(text for _, text in sorted(row)) for _, row in sorted(rows.items())]
    check_text(APPROVED / f"{name}_wiring.txt", "\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("name", "folder", "has_bring_up"),
    [("fsr400", "pcb", False), pytest.param("fsr400", "pcb", True, marks=pytest.mark.full),
     ("article", "pcb/article", True)],
)  # fmt: skip
def test_bundled_board_is_up_to_date(name: str, folder: str, has_bring_up: bool, tmp_path: Path) -> None:
    """The folder pcb/ holds the default board with its bring-up sheet, pcb/article/ that of the article."""
    write_board(Design.load(name), tmp_path, bring_up=has_bring_up)
    for path in (path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()):
        if has_bring_up or path.name != "manifest.json":
            hint = f"run: fingertip board {name} --out {folder} --bringup ({path})"
            assert (tmp_path / path).read_bytes() == (ROOT / folder / path).read_bytes(), hint


@functools.cache
def analysis_of(variant: str) -> Analysis:
    return analyse(load_article(VARIANT_CHANGES[variant]), boards=20)


@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_analysis_is_the_approved_one(variant: str) -> None:
    beside = APPROVED / "analysis_precision.txt" if variant != "precision" else None
    text = analysis_text(load_article(VARIANT_CHANGES[variant]), analysis_of(variant))
    check_text(APPROVED / f"analysis_{variant}.txt", text, beside)


# Report on readings, compared whole with approved files


def assess(plan: BringUp, title: str, readings: Mapping[str, float]) -> Iterator[str]:
    """Yield what is said of readings. Faults that cannot be told apart are sorted: rounding decides their order."""
    data = assess_readings(plan, Readings(TONE_V, readings))
    yield f"{title}: {', '.join(row.name for row in data.readings if not row.passed)}"
    yield "  " + data.verdict.replace("; ".join(data.likely), "; ".join(sorted(data.likely)))
    yield from (f"  {hint}" for hint in data.hints)


@pytest.fixture(scope="module")
def precision_plan(predict_once: None) -> BringUp:
    """Plan of the default board, whose faults are predicted."""
    plan = plan_of(VARIANT_CHANGES["precision"])[1]
    diagnose(plan.board, plan.levels, dict.fromkeys(plan.levels, 0.0), TONE_V)
    return plan


def list_wrong_readings(plan: BringUp) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield readings of a good board that are taken in a wrong way, or with another supply or tone."""
    board = plan.board
    fault = next(f for f in list_faults(board.circuit, board.ends_v) if f.sentence.startswith("C2 has half"))
    good, half_c2 = (dict(v) for v in predict(board, [draw_board(plan, np.random.default_rng(11)), fault]))
    ground_v = good["tp5_open_v"]
    tones = {name for name in good if is_tone(name)}

    def scale(dc: float, tone: float) -> dict[str, float]:
        return {n: v * (tone if n in tones else dc) for n, v in good.items()}

    def at_supply_ground(readings: dict[str, float]) -> dict[str, float]:
        """Alternating voltages are the same there, and those at J3 are taken against it by design."""
        own = ("tp5_open_v", *(n for n in readings if n.startswith("j3")))
        ends = ("open_v", "ohm_v")
        return {n: v + readings["tp5_open_v"] * (n.endswith(ends) and n not in own) for n, v in readings.items()}

    at_signal_ground = {n: v - ground_v * (n[:2] == "j3" and n.endswith("open_v")) for n, v in good.items()}
    yield "good board", good
    for ratio in (0.91, 0.955, 1.09, 0.0):
        yield f"supply x {ratio}", scale(ratio, 1.0)
    few = ("tp1_open_v", "j1_open_v", "tp3_open_v", "tp2_open_v")
    yield "supply x 0.91, four readings", {n: 0.91 * good[n] for n in few}
    yield "two readings", {n: 0.91 * good[n] for n in few[:2]}
    yield "supply x 0.9 and a weak tone", scale(0.9, 1.0) | {"tp3_134hz_v": 0.02}
    for ratio in (0.5, 0.0):
        yield f"tone x {ratio}", scale(1.0, ratio)
    yield "black probe at GND", at_supply_ground(good)
    yield "black probe at GND, no tone", {n: v for n, v in at_supply_ground(good).items() if not n.endswith("hz_v")}
    yield "black probe at GND, C2 with half its value", at_supply_ground(half_c2)
    yield "probes exchanged at TP5", good | {"tp5_open_v": -ground_v}
    yield "both probes at TP5", good | {"tp5_open_v": 0.0}
    yield "black probe at TP5 for J3", at_signal_ground
    for name, volts in (("tp1_open_v", 1.14), ("tp5_open_v", 1.40)):
        yield f"{name} of {volts} V alone is odd", good | {name: volts}
    yield "no current", {SUPPLY_MA: 0.0}
    yield "little current", {SUPPLY_MA: 1.5, "tp1_open_v": good["tp1_open_v"]}


@pytest.mark.full
def test_what_is_said_of_wrong_readings_is_the_approved_text(precision_plan: BringUp) -> None:
    plan = precision_plan
    lines = [line for title, readings in list_wrong_readings(plan) for line in assess(plan, title, readings)]
    few = {"supply_ohm": math.inf, SUPPLY_MA: 1.5, "tp1_open_v": 1.9, "tp5_open_v": 2.0, "tp3_134hz_v": 0.7}
    table = assess_readings(plan, Readings(TONE_V, few)).as_text()
    lines += [line.rstrip() for line in table.splitlines()]
    check_text(APPROVED / "precision_wrong_readings.txt", "\n".join(lines) + "\n")


# Legibility of the diagrams


@pytest.mark.every_case
@pytest.mark.parametrize("changes", [*VARIANT_CHANGES.values(), (*VARIANT_CHANGES["precision"], "board.channels=3")])
def test_texts_of_the_wiring_diagram_are_apart_and_inside_it(changes: tuple[str, ...]) -> None:
    """A character is taken to be 0.6 of the font size wide, which is more than Helvetica has on average."""
    design = load_article(changes)
    circuit = board_circuit(board_values(design), design.board.channels)
    drawing = wiring_diagram(circuit, design.board.supply_v, design.name)
    root, size, boxes = ElementTree.fromstring(drawing), 13.0, []
    for text in root.iter(f"{SVG}text"):
        x, y, length = float(text.attrib["x"]), float(text.attrib["y"]), 0.6 * size * len(text.text or "")
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.attrib.get("text-anchor", "start")] * length
        boxes.append((left, y - 0.8 * size, left + length, y + 0.2 * size, text.text))
    width, height = float(root.attrib["width"]), float(root.attrib["height"])
    assert all(box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height for box in boxes)
    for a, b in combinations(boxes, 2):
        assert min(a[2], b[2]) <= max(a[0], b[0]) or min(a[3], b[3]) <= max(a[1], b[1]), (a[4], b[4])


@pytest.mark.parametrize("changes", [(), ("board.channels=5",), ("board.variant=comparator",)])
def test_the_wiring_diagram_has_connectors_and_pins_where_the_board_has_them(changes: tuple[str, ...]) -> None:
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
        drawn, connector = [], ""
        for text in drawing.iter(f"{SVG}text"):
            connector = text.text or "" if text.attrib["x"] == plug_x else connector
            drawn += [(float(text.attrib["y"]), f"{connector}.{text.text}")] if text.attrib["x"] == pin_x else []
        placed = [(y, pin) for x, y, pin in pads if (x < middle) is is_left]
        assert [pin for _, pin in sorted(drawn)] == [pin for _, pin in sorted(placed)]
