"""Wiring of a divider (SVG): controller, breadboard, resistor, and the two wires of the sensor."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.board.circuits.divider import DIVIDER_RESISTOR, divider_circuit
from fingertip.board.parts.circuit import HOST_CONNECTOR, SENSOR_CONNECTOR
from fingertip.board.parts.nets import GND, TACTILE, VCC
from fingertip.design import Design

PINS = {TACTILE: "A0", GND: "GND"}
"""Usual names of a controller's pins; that of the supply follows from its voltage."""
_WIRES = {VCC: "#b03a2e", TACTILE: "#1f4e79", GND: "#1c1f22"}
_ROWS = {VCC: 110, TACTILE: 170, GND: 250}
"""Net -> height of its row of holes."""
_CONTROLLER, _BOARD, _SENSOR = (20, 150), (280, 300), (720, 220)
"""Left end and width of each."""
_HOLES = range(_BOARD[0] + 50, _BOARD[0] + _BOARD[1], 50)
_RESISTOR_X = _HOLES[3]


def divider_wiring(design: Design, pins: dict[str, str] | None = None) -> bytes:
    """Draw the wiring; `pins` gives other names of the controller's pins by net."""
    circuit, supply = divider_circuit(design), f"{design.board.supply_v:g} V"
    names = {VCC: supply.replace(".", "V").replace(" V", "") if "." in supply else supply.replace(" ", "")} | PINS
    names |= pins or {}
    title = f"Wiring of {design.name}"
    value = circuit.component(DIVIDER_RESISTOR).value
    body = [
        _text(20, 32, title, weight="bold"),
        *_box(*_CONTROLLER, "controller", 70, 220),
        *_box(*_BOARD, "breadboard: the five holes of a row are connected", 70, 220),
        *_box(*_SENSOR, "sensor in the finger", 70, 140),
    ]
    for net in dict(circuit.list_wires(circuit.component(HOST_CONNECTOR))).values():
        y = _ROWS[net]
        body += [f'<circle cx="{x}" cy="{y}" r="4" fill="#c9ccd0"/>' for x in _HOLES]
        body += [_wire(net, _CONTROLLER[0] + _CONTROLLER[1], _HOLES[0]), _text(60, y + 5, names[net])]
    for wire, net in enumerate(dict(circuit.list_wires(circuit.component(SENSOR_CONNECTOR))).values(), 1):
        body += [_wire(net, _HOLES[-1], _SENSOR[0]), _text(_SENSOR[0] + 16, _ROWS[net] + 5, f"wire {wire}")]
    top, bottom = (_ROWS[net] for _, net in circuit.list_wires(circuit.component(DIVIDER_RESISTOR)))
    body += [
        f'<path d="M{_RESISTOR_X} {top}V{bottom}" stroke="#4a5157" stroke-width="2"/>',
        f'<rect x="{_RESISTOR_X - 9}" y="{top + 20}" width="18" height="{bottom - top - 40}" rx="5" fill="#e9d8b4" '
        'stroke="#4a5157"/>',
        _text(_RESISTOR_X + 18, (top + bottom) / 2 + 5, f"{value} ohm"),
        _text(20, 325, "The two wires of the sensor may be exchanged, and so may the ends of the resistor."),
        _text(20, 347, "A0 is GP26 on a Pico and GPIO1 on an ESP32-S3."),
        _text(20, 369, f"{names[VCC]} is the controller's own {supply} output, never a higher voltage."),
    ]
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" width="960" height="387" viewBox="0 0 960 387" '
        'font-family="Helvetica, Arial, sans-serif" font-size="14">',
        f"<title>{title}</title>",
        '<rect width="960" height="387" fill="white"/>',
        *body,
        "</svg>",
    ]
    return ("\n".join(lines) + "\n").encode()


def _wire(net: str, left: int, right: int) -> str:
    return f'<path d="M{left} {_ROWS[net]}H{right}" stroke="{_WIRES[net]}" stroke-width="3"/>'


def _box(left: int, width: int, name: str, top: int, height: int) -> Iterator[str]:
    yield f'<rect x="{left}" y="{top}" width="{width}" height="{height}" rx="6" fill="#f4f5f6" stroke="#4a5157"/>'
    yield _text(left, top - 8, name)


def _text(x: float, y: float, text: str, weight: str = "normal") -> str:
    return f'<text x="{x:g}" y="{y:g}" fill="#1c1f22" font-weight="{weight}">{text}</text>'
