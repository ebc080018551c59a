"""The wiring diagram: every pin of the connectors has its wire, and all text is legible."""

from __future__ import annotations

from itertools import combinations
from xml.etree import ElementTree

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.bringup.wiring import wiring_diagram
from fingertip.board.kicad.netlist import kicad_netlist_file
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import Circuit
from tests.designs import load_article
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
