"""Wiring diagram (SVG): what stands at each edge of the board, seen from the side of its parts.

Pins and nets are those of the circuit's connectors. Each pin has one row, and each row one wire.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.sax.saxutils import escape

from fingertip.board.circuits.channels import split_net
from fingertip.board.parts.circuit import HOST_CONNECTOR, SLIP_CONNECTOR, SUPPLY_CONNECTOR, Circuit
from fingertip.board.parts.nets import (
    ADC_ENVELOPE,
    ADC_FILTERED,
    ADC_TACTILE,
    GND,
    POWER_IN,
    SLIP_OUT,
    VCC,
    VEE,
    VMID_OUT,
)
from fingertip.board.parts.symbols import JST_SH_15, LOCKING_CONNECTORS
from fingertip.board.parts.table import group_plug_wires
from fingertip.catalogues.electronics import NAMES
from fingertip.documents.template import render
from fingertip.foundation.errors import join_words

NEEDED_PINS = "Firmware and detector `fast` need T and S (2 analog inputs)."
OTHER_PINS = "A threshold on the envelope needs E and M."
"""Outputs that a controller samples, by what it runs."""
SKETCH_PINS = {ADC_TACTILE: "A0", ADC_FILTERED: "A1"}
"""Inputs of a controller at which the sketches of `fingertip firmware` read the board."""

_RED = "#b03a2e"
_BLACK = "#1c1f22"
_BLUE = "#1f4e79"
_GREEN = "#2e7d5b"
_YELLOW = "#b7950b"
_TOP = 53.0
_GAP = 26.0
"""Upper edge of the board, and gap between connectors."""


@dataclass(frozen=True)
class Signal:
    """Net at a connector, and the wire that leads to it."""

    print: str
    """Text that the board prints beside it."""
    meaning: str
    colour: str
    pin: str = ""
    """Kind of the controller's pin that it leads to; empty for supply, ground and sensor."""

    @property
    def far_end(self) -> str:
        """Pin and meaning at the far end of the wire."""
        return f"{self.pin}: {self.meaning}" if self.pin else self.meaning


_SENSOR = Signal("FSR", "either wire", _GREEN)
_ANALOG_IN = "analog in"
_DIGITAL_IN = "digital in"


def name_signals(circuit: Circuit, supply_v: float) -> dict[str, Signal]:
    """Name the nets at the connectors of supply and controller, of a board with this supply [V]."""
    is_for_controller = ADC_FILTERED in {split_net(net.name)[1] for net in circuit.nets}
    # The grounds of a board for several fingers have no mark.
    ground = "" if ADC_FILTERED not in {net.name for net in circuit.nets} else "GND"
    signals = {
        VCC: Signal("+", f"+{supply_v:g} V", _RED),
        POWER_IN: Signal("3V3", f"supply, +{supply_v:g} V", _RED),
        GND: Signal(ground if is_for_controller else "0", "ground", _BLACK),
        VEE: Signal("-", f"-{supply_v:g} V", _BLUE),
        ADC_TACTILE: Signal("T", "tactile voltage", _BLUE, _ANALOG_IN),
        ADC_FILTERED: Signal("S", "filtered signal", _YELLOW, _ANALOG_IN),
        ADC_ENVELOPE: Signal("E", "envelope", _BLUE, _ANALOG_IN),
        VMID_OUT: Signal("M", "signal ground", _GREEN, _ANALOG_IN),
        SLIP_OUT: Signal("SLIP", "slip, active low", _GREEN, _DIGITAL_IN),
    }

    for net in circuit.nets:
        channel, own = split_net(net.name)
        if channel and own in signals:
            signal = signals[own]
            signals[net.name] = Signal(
                print=f"{signal.print}{channel}",
                meaning=f"{signal.print} of {NAMES[channel - 1]}",
                colour=signal.colour,
                pin=signal.pin,
            )

    return signals


@dataclass(frozen=True)
class _Connector:
    """Connector at an edge of the board, and what it leads to."""

    reference: str
    device: str
    is_left: bool
    pins: tuple[tuple[str, Signal | None], ...]
    """Number and signal of each pin from the top; None for one that is open."""
    top: float = 0.0

    @property
    def height(self) -> float:
        return 38.0 + 24.0 * len(self.pins)


def wiring_diagram(circuit: Circuit, supply_v: float, name: str) -> bytes:
    columns = _list_columns(circuit, supply_v)
    heights = [sum(one.height + _GAP for one in column) - _GAP for column in columns]
    connectors = []

    for column, height in zip(columns, heights, strict=True):
        top = _TOP + 34.0 + _GAP + (max(heights) - height) / 2
        for one in column:
            connectors.append(replace(one, top=top))
            top += one.height + _GAP

    height = max(heights) + 2 * _GAP + 34.0
    notes = list(list_notes(circuit, supply_v))
    return render(
        "wiring.svg",
        name=name,
        top=_TOP,
        board_height=height,
        connectors=connectors,
        notes=notes,
        height=_TOP + height + _GAP + 19.0 * len(notes) + 20.0,
        escape=escape,
    ).encode()


def _list_columns(circuit: Circuit, supply_v: float) -> tuple[list[_Connector], list[_Connector]]:
    """List the connectors at the left and at the right edge, from the top."""
    sensors = [part for part in circuit.components if part.value == "FSR" and part.is_fitted]
    nets = {split_net(net.name)[1] for net in circuit.nets}
    signals = name_signals(circuit, supply_v)
    devices = (
        ["sensor"]
        if len(sensors) == 1
        else [f"sensor: {finger}" for finger in NAMES[: len(sensors)]]
    )
    of_sensor = {GND: Signal("ground", "either wire", _BLACK)}
    left = [
        _connect(circuit, part.reference, of_sensor, each)
        for part, each in zip(sensors, devices, strict=True)
    ]
    host = "controller" if ADC_FILTERED in nets else "ADC or controller"
    present = {component.reference for component in circuit.components}
    right = [
        _connect(circuit, each, signals, host, is_left=False)
        for each in (SLIP_CONNECTOR, HOST_CONNECTOR)
        if each in present
    ]
    if SUPPLY_CONNECTOR in present:
        left.append(_connect(circuit, SUPPLY_CONNECTOR, signals, "supply"))

    return (left if len(sensors) == 1 else left[::-1]), right


def _connect(
    circuit: Circuit,
    reference: str,
    signals: dict[str, Signal],
    device: str,
    is_left: bool = True,
) -> _Connector:
    connector = circuit.component(reference)
    nets = dict(circuit.list_wires(connector))
    pins = [pin.number for pin in connector.symbol.pins if pin.number.isdigit()]
    if connector.footprint in LOCKING_CONNECTORS and not is_left:
        pins.reverse()  # a plug is turned by half a turn at the other edge

    wired = (
        (number, signals.get(nets[number], _SENSOR) if number in nets else None) for number in pins
    )
    return _Connector(reference, device, is_left, tuple(wired))


def list_notes(circuit: Circuit, supply_v: float) -> Iterator[str]:
    """Yield what to observe when the cables are made."""
    nets = {split_net(net.name)[1] for net in circuit.nets}
    is_several = circuit.component(HOST_CONNECTOR).footprint == JST_SH_15
    outputs = (
        f"The outputs lie between 0 and {supply_v:g} V: the inputs of the controller must "
        "take that."
    )

    if ADC_FILTERED not in nets:
        yield "Pin 1 is the square one. The sensor's wires may be exchanged."
        yield (
            "A reversed supply destroys the board: check its polarity at the plug before you "
            "connect it."
        )
        yield outputs
        yield "Keep the wires of J1 and J3 short, and twist each signal with a ground wire."
        return

    if is_several:
        yield (
            "Parts are named as on the board of one finger: J1 is J101 at finger 1 and J501 at "
            "finger 5."
        )
        yield (
            "No two plugs of sensors can be exchanged: none enters a smaller socket, and in "
            "another one of its size"
        )
        yield (
            "it leaves a wire at an open pin: T then stays where it is when the finger is pressed."
        )
        yield (
            "The wires stand in the plugs as drawn here, when they are in their sockets and the "
            "parts face you."
        )
        yield (
            "J3 is at the right edge, and finger 1 at the bottom. Twist T, S and ground of each "
            "finger."
        )
        yield (
            "Of a sensor's pins the one of the higher number is ground, as is TP6, for the "
            "shield of a long cable."
        )
        yield (
            "Firmware and detector fast need T and S of each finger; the README of the firmware "
            "names the inputs."
        )
    else:
        yield "Pins 1 have a dot beside them: with J1 on the left, that of J3 is the lower end."
        yield "Pin 2 of J1 is ground, as is TP6, for the shield of a long cable."
        yield "J3 has the order of Qwiic and STEMMA QT: ground black, 3.3 V red, T blue, S yellow."
        yield "Take a cable with open ends: T and S go to two analog pins."
        yield (
            "An I2C socket feeds the board and harms nothing, but cannot read T and S, and its "
            "bus stops (C19, C25)."
        )
        yield (
            "A board that prints T and S alone beside J3 (revision 4) has another order: never "
            "join it to this cable."
        )
        yield f"{NEEDED_PINS}{f' {OTHER_PINS}' if VMID_OUT in nets else ''}".replace("`", "")
        yield (
            f"Sketches of fingertip firmware read T at {SKETCH_PINS[ADC_TACTILE]}, S at "
            f"{SKETCH_PINS[ADC_FILTERED]}."
        )

    if VMID_OUT in nets:
        yield (
            "E refers to M: sample M too if you use E. Record T and S as they are, against ground."
        )

    yield (
        "D3, D5 and D6 take a static discharge into the cables (8 kV contact, IEC 61000-4-2; "
        "simulated)."
    )
    yield (
        f"Take +{supply_v:g} V from the controller's own {supply_v:g} V pin; Q1 blocks a "
        "reversed supply."
    )
    yield outputs
    for wire, references in group_plug_wires(circuit).items():
        yield f"Wires of {join_words(references)} ({wire.series} plug): {wire.description}."
