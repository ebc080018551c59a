"""Channels of a board for several fingers: their own parts and nets, shared ones, and names.

A channel is the circuit of one finger (`fingertip.board.circuits.board_circuit`) without supply,
references and host connector, repeated for each place of the board. Part R28 of channel 3 is R328,
and its net SUM is F3/SUM, as KiCad names the nets of a sheet F3. All analysis is that of one
channel; only what the channels share is computed for all.
"""

from __future__ import annotations

from dataclasses import replace

from fingertip.board.parts import symbols
from fingertip.board.parts.circuit import (
    HOST_CONNECTOR,
    SENSOR_CONNECTOR,
    Circuit,
    Component,
    build_circuit,
)
from fingertip.board.parts.nets import (
    ADC_FILTERED,
    ADC_TACTILE,
    BIAS,
    GND,
    POWER_IN,
    RAILS,
    UNCONNECTED,
)
from fingertip.catalogues.electronics import NAMES

PLACES = len(NAMES)
"""Channels that the board for several fingers has places for."""
SOCKETS = ((3, "2", "3"), (3, "1", "3"), (4, "2", "3"), (2, "1", "2"), (3, "1", "2"))
"""Number of pins of each finger's socket, then its sensor and ground pins; the others are open.

No plug enters a smaller socket, and in another one of its own size it leaves a wire at an open pin.
"""
_FOOTPRINTS = {2: symbols.JST_SH_2, 3: symbols.JST_SH_3, 4: symbols.JST_SH_4}
SHARED_PARTS = frozenset(
    (
        "TP7",
        "Q1",
        "C10",
        "R22",
        "R23",
        "C21",
        "R31",
        "R32",
        "C28",
        "R33",
        "C29",
        "H1",
        "H2",
        "H3",
        "H4",
    )
)
"""Parts that all channels share: supply, references of mid-supply and of the bias, holes."""
SHARED_NETS = frozenset((*RAILS, POWER_IN, "DIVIDED", BIAS, "HALF"))
_FIRST_PARTS = 100
"""Number at which the references of the first channel begin; those of one finger stay below it."""


def name_part(reference: str, channel: int) -> str:
    """Name a part of a channel: R28 of the third is R328."""
    letters = reference.rstrip("0123456789")
    return f"{letters}{_FIRST_PARTS * channel + int(reference[len(letters) :])}"


def split_name(reference: str) -> tuple[int, str]:
    """Return the channel of a part, 0 for a shared one, and its reference on a one-finger board."""
    letters = reference.rstrip("0123456789")
    channel, number = divmod(int(reference[len(letters) :]), _FIRST_PARTS)
    return channel, f"{letters}{number}"


def find_symbol(reference: str) -> tuple[int, str]:
    """Return the channel whose sheet shows a part, 0 for the root, and its reference there."""
    channel, own = split_name(reference)
    return (0, reference) if own == SENSOR_CONNECTOR else (channel, own)


def name_net(net: str, channel: int) -> str:
    """Name a net of a channel; shared nets keep their names."""
    return net if net in SHARED_NETS else f"{name_sheet(channel)}/{net}"


def split_net(net: str) -> tuple[int, str]:
    """Return the channel of a net, 0 for a shared one, and its name on a one-finger board."""
    sheet, _, own = net.rpartition("/")
    return (int(sheet[1:]), own) if sheet else (0, own)


def name_sheet(channel: int) -> str:
    return f"F{channel}"


def host_pins() -> dict[str, str]:
    """Return the host connector's nets by pin: T, S and ground of each channel; supply last."""
    nets = [
        name_net(net, channel)
        for channel in range(1, PLACES + 1)
        for net in (ADC_TACTILE, ADC_FILTERED, GND)
    ]
    return {str(number): net for number, net in enumerate((*nets[:-1], POWER_IN), start=1)} | {
        "MP": GND
    }


def describe_sockets() -> tuple[str, ...]:
    """Describe the sensor and ground pins of each finger's socket."""
    return tuple(
        f"{socket}, pins {' and '.join(pins)}"
        for socket, (_, *pins) in zip(list_sockets(), SOCKETS, strict=True)
    )


def list_sockets() -> tuple[str, ...]:
    """List the sensor's connector of each channel."""
    return tuple(name_part(SENSOR_CONNECTOR, channel) for channel in range(1, PLACES + 1))


def list_pins(net: str) -> tuple[str, ...]:
    """List the pins of the host connector at a net, of one channel's or a shared one."""
    return tuple(number for number, own in host_pins().items() if split_net(own)[1] == net)


def repeat_channel(single: Circuit, fitted: int) -> Circuit:
    """Build the board of several fingers from that of one: five places, the first ones fitted."""
    wiring: dict[Component, dict[str, str]] = {}
    pins = {
        component: {
            pin.number: single.net_by_pin[component.reference, pin.number]
            for pin in component.symbol.pins
        }
        for component in single.components
    }

    for component, nets in pins.items():
        if component.reference in SHARED_PARTS:
            wiring[component] = nets

    symbol = symbols.SYMBOLS["Conn_01x15_MountingPin"]
    role = (
        "to the controller: tactile voltage and filtered signal of each finger, ground between "
        "them, supply"
    )
    host = replace(
        single.component(HOST_CONNECTOR), symbol=symbol, footprint=symbols.JST_SH_15, role=role
    )
    wiring[host] = host_pins()

    for channel in range(1, PLACES + 1):
        for component, nets in pins.items():
            if component.reference not in (*SHARED_PARTS, HOST_CONNECTOR):
                own = replace(
                    component,
                    reference=name_part(component.reference, channel),
                    is_fitted=channel <= fitted,
                )
                own_nets = {number: name_net(net, channel) for number, net in nets.items()}
                if component.reference == SENSOR_CONNECTOR:
                    own, own_nets = _place_socket(own, own_nets, channel)

                wiring[own] = own_nets

    return build_circuit(single.name, wiring)


def _place_socket(
    part: Component, nets: dict[str, str], channel: int
) -> tuple[Component, dict[str, str]]:
    """Return the sensor's connector of a channel, and its pins, with the size of that channel."""
    size, sensor, ground = SOCKETS[channel - 1]
    symbol = symbols.SYMBOLS[f"Conn_01x{size:02}_MountingPin"]
    wired = {sensor: nets["1"], ground: nets["2"], "MP": nets["MP"]}
    placed = replace(part, symbol=symbol, footprint=_FOOTPRINTS[size])
    pins = (
        (pin.number, f"{UNCONNECTED}{part.reference}-{pin.name}-Pad{pin.number})")
        for pin in symbol.pins
    )

    return placed, {number: wired.get(number, unused) for number, unused in pins}


def leave_out_empty(circuit: Circuit) -> Circuit:
    return circuit.without(*(part.reference for part in circuit.components if not part.is_fitted))
