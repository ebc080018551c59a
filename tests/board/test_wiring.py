"""The wiring diagram: every pin of the connectors has its wire, and all text is legible."""

from __future__ import annotations

import json
from itertools import combinations
from operator import itemgetter
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.bringup.wiring import wiring_diagram
from fingertip.board.kicad.netlist import kicad_netlist_file
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import Circuit
from fingertip.catalogues.output_files import BRING_UP, WIRING
from fingertip.tasks.board import write_board
from tests.designs import ARTICLE, load_article
from tests.oracles.sexpressions import children, parse

SVG = "{http://www.w3.org/2000/svg}"
SIZE = 13.0
FAR_ENDS = {
    "ADC_TACTILE": "analog in: tactile voltage",
    "ADC_FILTERED": "analog in: filtered signal",
    "ADC_ENVELOPE": "analog in: envelope",
    "M_OUT": "analog in: signal ground",
    "SLIP": "digital in: slip, active low",
    "GND": "ground",
}
"""Labels at the controller, by the net of KiCad's netlist."""


def draw(name: str) -> tuple[Circuit, ElementTree.Element, float]:
    """Circuit and diagram of a board, and its supply [V]."""
    design = load_article(BOARD_CONFIGURATIONS[name].changes)
    circuit = board_circuit(board_values(design))
    data = wiring_diagram(circuit, design.board.supply_v, design.name)
    return circuit, ElementTree.fromstring(data), design.board.supply_v


def rows(root: ElementTree.Element, left: float, right: float) -> dict[float, list[str]]:
    """Texts beside each wire that begins between two abscissae, from left to right, by its height."""
    wires = {}
    for path in root.iter(f"{SVG}path"):
        start, _, end = path.attrib["d"].removeprefix("M").partition("H")
        x, y = map(float, start.split())
        if left <= x < right:
            near = [
                (float(text.attrib["x"]), text.text or "")
                for text in root.iter(f"{SVG}text")
                if abs(float(text.attrib["y"]) - y) < SIZE / 2 and (float(text.attrib["x"]) < 500) == (float(end) < 500)
            ]
            wires[y] = [text for _, text in sorted(near)]
    return wires


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_pin_of_the_netlist_has_its_wire(name: str) -> None:
    circuit, root, supply_v = draw(name)
    tree = parse(kicad_netlist_file(circuit).decode())
    pins: dict[str, dict[int, str]] = {"J1": {}, "J2": {}, "J3": {}}
    for net in children(next(children(tree, "nets")), "net"):
        for node in children(net, "node"):
            reference, pin = (next(children(node, key))[1] for key in ("ref", "pin"))
            if reference in pins and pin != "MP":
                pins[reference][int(pin)] = next(children(net, "name"))[1].removeprefix("/")
    host = [pins["J3"][pin] for pin in sorted(pins["J3"])]
    found = rows(root, 500.0, 900.0)
    assert [(texts[-2], texts[-1]) for _, texts in sorted(found.items())] == [
        (str(i), FAR_ENDS[net]) for i, net in enumerate(host, start=1)
    ]
    volts = {"VCC": f"+{supply_v:g} V", "POWER_IN": f"+{supply_v:g} V", "GND": "ground", "VEE": f"-{supply_v:g} V"}
    supply = [volts[pins["J2"][pin]] for pin in sorted(pins["J2"])]
    left = [(texts[0], texts[1]) for _, texts in sorted(rows(root, 0.0, 500.0).items())]
    assert left == [("either wire", "1"), ("either wire", "2"), *((v, str(i)) for i, v in enumerate(supply, start=1))]


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_marks_are_those_that_the_board_prints_beside_the_pins(name: str) -> None:
    _, root, _ = draw(name)
    layout = parse(BOARD_CONFIGURATIONS[name].project.layout)
    front = [item for item in children(layout, "gr_text") if next(children(item, "layer"))[1] == "F.SilkS"]
    places = [(item[1], *map(float, next(children(item, "at"))[1:3])) for item in front]
    printed = [place for place in places if len(place[0]) == 1 or place[0] == "SLIP"]
    middle = 120.0
    supply = [text for text, x, _ in sorted(printed, key=itemgetter(2)) if x < middle]
    assert [texts[2] for _, texts in sorted(rows(root, 0.0, 500.0).items())][2:] == supply
    marks = [texts[0] for _, texts in sorted(rows(root, 500.0, 900.0).items()) if len(texts) > 2]
    assert sorted(marks) == sorted(text for text, x, _ in printed if x > middle)


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_texts_are_apart_and_inside_the_picture(name: str) -> None:
    """A character is taken to be 0.6 of the font size wide, which is more than Helvetica has on average."""
    _, root, _ = draw(name)
    width, height = float(root.attrib["width"]), float(root.attrib["height"])
    boxes = []
    for text in root.iter(f"{SVG}text"):
        x, y, length = float(text.attrib["x"]), float(text.attrib["y"]), 0.6 * SIZE * len(text.text or "")
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.attrib.get("text-anchor", "start")] * length
        boxes.append((left, y - 0.8 * SIZE, left + length, y + 0.2 * SIZE, text.text))
    assert all(box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height for box in boxes)
    for a, b in combinations(boxes, 2):
        assert min(a[2], b[2]) <= max(a[0], b[0]) or min(a[3], b[3]) <= max(a[1], b[1]), (a[4], b[4])


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_notes_fit_the_board(name: str) -> None:
    circuit, root, supply_v = draw(name)
    text = " ".join(element.text or "" for element in root.iter(f"{SVG}text"))
    references = {component.reference for component in circuit.components}
    assert ("Q1 blocks it" in text) == ("Q1" in references)
    assert ("A reversed supply destroys the board" in text) == ("Q1" not in references)
    assert ("sample M too" in text) == ("single" in name)
    assert ("Pin 2 of J1 is at signal ground" in text) == ("single" in name)
    assert ("Pin 1 of J1 and J3 has a dot" in text) == ("3v3" in name)
    assert ("Firmware and detector fast need T and S" in text) == ("3v3" in name)
    assert ("Take +3.3 V and the ground of J2 from the controller's own 3.3 V pin" in text) == ("3v3" in name)
    assert ("sketches of fingertip firmware read T at A0 and S at A1" in text) == ("3v3" in name)
    if "3v3" in name:
        pads = {pad.name: pad for pad in BOARD_CONFIGURATIONS[name].placement.parts["J3"].pads}
        assert pads["1"].centre[1] > pads["10"].centre[1], "pin 1 is the lower end"
    assert f"The outputs lie between 0 and {supply_v:g} V" in text


@pytest.mark.full
def test_sheet_shows_the_diagram_that_is_written_with_it(tmp_path: Path) -> None:
    write_board(ARTICLE, tmp_path, bring_up=True)
    assert f"]({WIRING})" in (tmp_path / BRING_UP).read_text("utf-8")
    design = ARTICLE
    expected = wiring_diagram(board_circuit(board_values(design)), design.board.supply_v, design.name)
    assert (tmp_path / WIRING).read_bytes() == expected
    assert WIRING in json.loads((tmp_path / "manifest.json").read_bytes())["files"]
    write_board(load_article(["board.cutoff_hz=80"]), tmp_path)
    assert not (tmp_path / WIRING).exists()
