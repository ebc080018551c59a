"""Readings at the pins of J3: what the controller will see, behind the resistors and capacitors ahead of it.

They are taken against supply ground, as the controller reads them. The meter's own resistance is part of the circuit,
so that a pin whose resistor is open reads nothing instead of floating.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fingertip.board.circuit import Circuit, Component, Net
from fingertip.board.kicad.symbols import R_0603, RESISTOR
from fingertip.board.nets import (
    ADC_ENVELOPE,
    ADC_FILTERED,
    ADC_TACTILE,
    ENVELOPE,
    FILTERED,
    GND,
    TACTILE,
    VMID,
    VMID_OUT,
)
from fingertip.board.network import build_network

HOST = "J3"
METER_OHM = 10e6
"""Input resistance of a multimeter."""
TOP_HZ = 400.0
"""Tone at which S is measured: the upper end of a simple meter's range, where C25 attenuates most."""


@dataclass(frozen=True)
class OutputPin:
    """Pin of J3 that carries a signal."""

    letter: str
    """Letter that the board prints beside it."""
    net: str
    source: str
    """Net with a test point that feeds it."""
    meter: str
    """Reference of the meter's resistance."""

    @property
    def constant_name(self) -> str:
        """Name of the reading of its constant voltage with the sensor open."""
        return f"j3_{self.letter.lower()}_open_v"

    @property
    def tone_name(self) -> str:
        """Name of the reading of its tone."""
        return f"j3_{self.letter.lower()}_{TOP_HZ:.0f}hz_v"


_PINS = (
    OutputPin("T", ADC_TACTILE, TACTILE, "R91"),
    OutputPin("S", ADC_FILTERED, FILTERED, "R92"),
    OutputPin("E", ADC_ENVELOPE, ENVELOPE, "R93"),
    OutputPin("M", VMID_OUT, VMID, "R94"),
)


def list_output_pins(circuit: Circuit) -> tuple[OutputPin, ...]:
    """List the pins of J3 that are measured."""
    nets = {net.name for net in circuit.nets if any(reference == HOST for reference, _ in net.nodes)}
    return tuple(pin for pin in _PINS if pin.net in nets)


def has_tone(pin: OutputPin) -> bool:
    """Return whether a pin's tone is large enough for a meter: that of the filtered signal."""
    return pin.source == FILTERED


def connect_meter(circuit: Circuit) -> Circuit:
    """Connect a meter between each measured pin and supply ground."""
    pins = {pin.net: pin for pin in list_output_pins(circuit)}
    meters = tuple(
        Component(pin.meter, f"{METER_OHM:.10g}", RESISTOR, R_0603, "test: input of the meter") for pin in pins.values()
    )
    nets = []
    for net in circuit.nets:
        if net.name in pins:
            nets.append(Net(net.name, (*net.nodes, (pins[net.name].meter, "1"))))
        elif net.name == GND:
            nets.append(Net(net.name, (*net.nodes, *((meter.reference, "2") for meter in meters))))
        else:
            nets.append(net)
    return Circuit(circuit.name, (*circuit.components, *meters), tuple(nets))


def predict_constants(circuit: Circuit, sources_v: Mapping[str, float]) -> dict[str, float]:
    """Constant voltages of the pins above supply ground [V], from those of the nets that feed them."""
    pins = list_output_pins(circuit)
    network = build_network(connect_meter(circuit)).drive(*(pin.source for pin in pins))
    path = network.restrict(*(pin.net for pin in pins))
    given = {name: sources_v.get(name, 0.0) for name in path.inputs}
    volts = path.operating_point(given)
    return {pin.constant_name: volts[pin.net] for pin in pins}


def attenuate_tones(circuit: Circuit) -> dict[str, float]:
    """Ratio of the tone at each pin that is measured with it to that at the net which feeds it."""
    found = {}
    for pin in filter(has_tone, list_output_pins(circuit)):
        path = build_network(connect_meter(circuit)).drive(pin.source).restrict(pin.net)
        found[pin.tone_name] = float(abs(path.response(np.array([TOP_HZ]), {pin.source: 1.0}, pin.net)[0, 0]))
    return found


def largest_drop_v(circuit: Circuit, expected_v: Mapping[str, float]) -> float:
    """Largest voltage that the meter's own current takes from a pin [V]."""
    return max(
        (abs(expected_v[pin.constant_name]) * (1.0 / ratio - 1.0) for pin, ratio in _ratios(circuit).items()),
        default=0.0,
    )


def _ratios(circuit: Circuit) -> dict[OutputPin, float]:
    """Share of each source's constant voltage that its pin has with the meter connected."""
    pins = list_output_pins(circuit)
    volts = predict_constants(circuit, {pin.source: 1.0 for pin in pins})
    return {pin: volts[pin.constant_name] for pin in pins}
