"""Wiring diagram (SVG): what stands at each edge of the board, seen from the side of its parts.

Pins and nets are those of the circuit's connectors. Each pin has one row, and each row one wire.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.sax.saxutils import escape

from fingertip.board.circuits.channels import split_net
from fingertip.board.parts.circuit import HOST_CONNECTOR, SUPPLY_CONNECTOR, Circuit, Component
from fingertip.board.parts.nets import ADC_ENVELOPE, ADC_FILTERED, ADC_TACTILE, GND, POWER_IN, SLIP, VCC, VEE, VMID_OUT
from fingertip.board.parts.symbols import AO3401A, JST_SH_4, JST_SH_15, LOCKING_CONNECTORS
from fingertip.board.parts.table import group_plug_wires
from fingertip.catalogues.controllers import NAMES
from fingertip.foundation.errors import join_words

NEEDED_PINS = "Firmware and detector `fast` need T and S (2 analog inputs)."
OTHER_PINS = "A threshold on the envelope needs E and M."
"""Outputs that a controller samples, by what it runs."""
SKETCH_PINS = {ADC_TACTILE: "A0", ADC_FILTERED: "A1"}
"""Inputs of a controller at which the sketches of `fingertip firmware` read the board."""

_RED, _BLACK, _BLUE, _GREEN, _GREY = "#b03a2e", "#1c1f22", "#1f4e79", "#2e7d5b", "#4a5157"
_WIDTH, _MARGIN = 960, 20
_ROW, _HEAD, _FOOT, _GAP = 24, 34, 4, 26
"""Height of a pin's row, of the heading above the rows, of the space below them, and gap between connectors."""
_BOARD_LEFT, _BOARD_RIGHT = 370, 590
_PLUG = 96
_DEVICE = 190
"""Width of what a connector leads to on the left."""
_HOST_LEFT = 700
_SIZE = 13
_LINE = 19
_STROKE = 'stroke-width="2" fill="none"'


@dataclass(frozen=True)
class Signal:
    """Net at a connector: what the board prints beside it, what it is for the other side, and colour of its wire."""

    print: str
    far_end: str
    colour: str


_SENSOR, _OPEN = Signal("FSR", "either wire", _GREEN), Signal("open", "", _GREY)


def name_signals(circuit: Circuit, supply_v: float) -> dict[str, Signal]:
    """Name the nets at the connectors of supply and controller, of a board with this supply [V]."""
    # A board that gives its filtered signal to a controller has grounds between its pins, which have no mark.
    is_for_controller = ADC_FILTERED in {split_net(net.name)[1] for net in circuit.nets}
    plus = Signal("+", f"+{supply_v:g} V", _RED)
    signals = {
        VCC: plus,
        POWER_IN: plus,
        GND: Signal("" if is_for_controller else "0", "ground", _BLACK),
        VEE: Signal("-", f"-{supply_v:g} V", _BLUE),
        ADC_TACTILE: Signal("T", "analog in: tactile voltage", _BLUE),
        ADC_FILTERED: Signal("S", "analog in: filtered signal", _BLUE),
        ADC_ENVELOPE: Signal("E", "analog in: envelope", _BLUE),
        VMID_OUT: Signal("M", "analog in: signal ground", _GREEN),
        SLIP: Signal("SLIP" if is_for_controller else "S", "digital in: slip, active low", _RED),
    }
    for net in circuit.nets:
        channel, own = split_net(net.name)
        if channel and own in signals:
            letter, what = signals[own].print, signals[own].far_end.partition(":")[0]
            signals[net.name] = Signal(
                f"{letter}{channel}", f"{what}: {letter} of {NAMES[channel - 1]}", signals[own].colour
            )
    return signals


def wiring_diagram(circuit: Circuit, supply_v: float, name: str) -> bytes:
    supply, host = (circuit.component(r) for r in (SUPPLY_CONNECTOR, HOST_CONNECTOR))
    sensors = [part for part in circuit.components if part.value == "FSR" and part.is_fitted]
    nets = {split_net(net.name)[1] for net in circuit.nets}
    signals = name_signals(circuit, supply_v)
    # Ground is marked as the negative pole of a single supply.
    supply_signals = signals if VEE in nets else signals | {GND: replace(signals[GND], print="-")}
    controller = "controller" if ADC_FILTERED in nets else "ADC or controller"
    top = 2 * _MARGIN + _SIZE
    devices = ["sensor"] if len(sensors) == 1 else [f"sensor: {finger}" for finger in NAMES[: len(sensors)]]
    of_sensor = {GND: Signal("ground", "either wire", _BLACK)}
    left = [(sensor, of_sensor, device) for sensor, device in zip(sensors, devices, strict=True)]
    right = [(host, signals, controller)]
    (left if len(sensors) == 1 else right).append((supply, supply_signals, "supply"))
    if len(sensors) > 1:
        left.reverse()
    heights = [sum(_height(part) + _GAP for part, _, _ in column) - _GAP for column in (left, right)]
    board_height, middle = max(heights) + 2 * _GAP + _HEAD, top + _HEAD + _GAP + max(heights) / 2
    connectors = list[str]()
    for column, column_height in zip((left, right), heights, strict=True):
        at = middle - column_height / 2
        for part, marks, device in column:
            connectors += _connector(circuit, part, marks, at, device, is_left=column is left)
            at += _height(part) + _GAP
    notes = list(list_notes(circuit, supply_v))
    height = top + board_height + _GAP + _LINE * len(notes) + _MARGIN
    body = [
        _text(_MARGIN, _MARGIN + _SIZE, f"Wiring of the board of {name}", weight="bold"),
        _box(_BOARD_LEFT, top, _BOARD_RIGHT - _BOARD_LEFT, board_height, "#eef4ee", _GREEN),
        _text((_BOARD_LEFT + _BOARD_RIGHT) / 2, top + 26, "slip-filter board", anchor="middle", weight="bold"),
        *connectors,
        *(
            _text(_MARGIN, top + board_height + _GAP + _LINE * i + _SIZE, note, colour=_GREY)
            for i, note in enumerate(notes)
        ),
    ]
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_number(height)}" '
        f'viewBox="0 0 {_WIDTH} {_number(height)}" font-family="Helvetica, Arial, sans-serif" font-size="{_SIZE}">',
        f"<title>{escape(f'Wiring of the board of {name}')}</title>",
        f'<rect width="{_WIDTH}" height="{_number(height)}" fill="white"/>',
        *body,
        "</svg>",
    ]
    return ("\n".join(lines) + "\n").encode()


def list_notes(circuit: Circuit, supply_v: float) -> Iterator[str]:
    """Yield what to observe when the cables are made."""
    locking = circuit.component(HOST_CONNECTOR).footprint in LOCKING_CONNECTORS
    outputs = {split_net(net)[1] for _, net in circuit.list_wires(circuit.component(HOST_CONNECTOR))}
    is_several = circuit.component(HOST_CONNECTOR).footprint == JST_SH_15
    if is_several:
        yield "Parts are named as on the board of one finger: J1 is J101 at finger 1 and J501 at finger 5."
        yield "No two plugs of sensors can be exchanged: none enters a smaller socket, and in another one of its size"
        yield "it leaves a wire at an open pin: T then stays where it is when the finger is pressed."
        yield "The wires stand in the plugs as drawn here, when they are in their sockets and the parts face you."
        yield "On the board J2 and J3 are at the right edge, and finger 1 is at the bottom."
    if locking:
        yield "Pin 1 of J1 and J3 has a dot beside it; + is printed beside pin 1 of J2."
    if locking and not is_several:
        yield "With J1 and J2 on the left, pin 1 of J3 is the lower end."
    if not locking:
        yield "Pin 1 is the square one."
    yield "The sensor's wires may be exchanged."
    if any(component.symbol.name == "D_TVS" for component in circuit.components):
        ground = "Of a sensor's two pins the one of the higher number" if is_several else "Pin 2 of J1"
        yield f"{ground} is ground. TP6, ground too, takes the shield of a long cable."
        yield "D6 and R28 take a static discharge into the sensor's cable (8 kV contact, IEC 61000-4-2; simulated)."
    if any(component.symbol == AO3401A for component in circuit.components):
        yield "With J3 unplugged a reversed supply does no harm: Q1 blocks it."
        yield "With J3 connected it shorts the controller's own 3.3 V through ground: check the polarity first."
        yield "Nothing protects against a voltage that is too high. Plugs of LiPo cells fit J2, and give up to 4.2 V."
    else:
        yield "A reversed supply destroys the board: check its polarity at the plug before you connect it."
    yield f"The outputs lie between 0 and {supply_v:g} V: the inputs of the controller must take that."
    if circuit.component(HOST_CONNECTOR).footprint == JST_SH_4:
        yield "J3: a cable of Qwiic or STEMMA QT fits: black and yellow ground, red T (no supply), blue S."
        yield "Its other end goes to analog pins, never into an I2C socket: there red is a supply of up to 5 V."
    if VMID_OUT in outputs:
        yield "E refers to M: sample M too if you use E. Record T and S as they are, against ground."
    if ADC_FILTERED in outputs:
        if is_several:
            yield "Firmware and detector fast need T and S of each finger (10 analog inputs for five)."
        else:
            yield f"{NEEDED_PINS}{f' {OTHER_PINS}' if VMID_OUT in outputs else ''}".replace("`", "")
        yield f"Take +{supply_v:g} V and the ground of J2 from the controller's own {supply_v:g} V pin and GND."
        yield "Disconnect a bench supply first: two supplies would feed each other."
        tactile, filtered = SKETCH_PINS[ADC_TACTILE], SKETCH_PINS[ADC_FILTERED]
        if is_several:
            yield "The README of fingertip firmware names the input of each T and S."
        else:
            yield f"The sketches of fingertip firmware for one finger read T at {tactile} and S at {filtered}."
    for wire, references in group_plug_wires(circuit).items():
        yield f"Wires of {join_words(references)} ({wire.series} plug): {wire.description}."
    if is_several:
        yield "Twist T, S and ground of each finger."
    elif locking:
        yield "Twist each signal's wire with the ground beside it."
    else:
        yield "Keep the wires of J1 and J3 short, and twist each signal with a ground wire."


def _height(connector: Component) -> int:
    return _HEAD + _ROW * sum(pin.number.isdigit() for pin in connector.symbol.pins) + _FOOT


def _connector(
    circuit: Circuit, connector: Component, signals: dict[str, Signal], top: float, device: str, *, is_left: bool
) -> Iterator[str]:
    """Yield a connector at an edge of the board, what it leads to, and the wires between them."""
    nets, height = dict(circuit.list_wires(connector)), _height(connector)
    pins = [pin.number for pin in connector.symbol.pins if pin.number.isdigit()]
    if connector.footprint in LOCKING_CONNECTORS and not is_left:
        pins.reverse()  # a plug is turned by half a turn at the other edge
    plug_left = _BOARD_LEFT if is_left else _BOARD_RIGHT - _PLUG
    device_left, device_width = (_MARGIN, _DEVICE) if is_left else (_HOST_LEFT, _WIDTH - _MARGIN - _HOST_LEFT)
    ends = (device_left + device_width, plug_left) if is_left else (plug_left + _PLUG, device_left)
    yield _box(device_left, top, device_width, height, "#f4f5f6", _GREY)
    yield _text(device_left + device_width / 2, top + 21, device, anchor="middle", weight="bold")
    yield _box(plug_left, top, _PLUG, height, "white", _GREEN)
    yield _text(plug_left + _PLUG / 2, top + 21, connector.reference, anchor="middle", weight="bold")
    for i, number in enumerate(pins):
        signal, y = signals.get(nets[number], _SENSOR) if number in nets else _OPEN, top + _HEAD + _ROW * (i + 0.5)
        if number in nets:
            yield f'<path d="M{_number(ends[0])} {_number(y)}H{_number(ends[1])}" stroke="{signal.colour}" {_STROKE}/>'
            for x in ends:
                yield f'<circle cx="{_number(x)}" cy="{_number(y)}" r="3" fill="{signal.colour}"/>'
        base = y + 0.35 * _SIZE
        near, far = (plug_left + 12, plug_left + _PLUG - 12) if is_left else (plug_left + _PLUG - 12, plug_left + 12)
        sides = ("start", "end") if is_left else ("end", "start")
        yield _text(near, base, number, anchor=sides[0])
        if signal.print:
            yield _text(far, base, signal.print, anchor=sides[1], colour=_GREY)
        if is_left:
            yield _text(device_left + device_width - 12, base, signal.far_end, anchor="end")
        else:
            yield _text(device_left + 12, base, signal.far_end)


def _box(x: float, y: float, width: float, height: float, fill: str, colour: str) -> str:
    place = f'x="{_number(x)}" y="{_number(y)}" width="{_number(width)}" height="{_number(height)}"'
    return f'<rect {place} rx="6" fill="{fill}" stroke="{colour}" stroke-width="1.5"/>'


def _text(x: float, y: float, text: str, *, anchor: str = "start", colour: str = _BLACK, weight: str = "normal") -> str:
    style = "" if weight == "normal" else f' font-weight="{weight}"'
    side = "" if anchor == "start" else f' text-anchor="{anchor}"'
    return f'<text x="{_number(x)}" y="{_number(y)}" fill="{colour}"{side}{style}>{escape(text)}</text>'


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
