"""The bench: what replaces the sensor while a board is brought up, and the tone that is fed in.

A resistor in place of the sensor stands for a force, the same on every day. The tone of a phone or a generator reaches
the bridge through a capacitor and a large resistor, so that some millivolts at TACTILE result, as from a slip.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from fingertip.board.circuits.network import Network, build_network, list_amplifiers
from fingertip.board.components.front_end import ARTICLE_POINTS, sensor_conductance_s
from fingertip.board.components.selection import nearest_value
from fingertip.board.parts import nets
from fingertip.board.parts.circuit import HOST_CONNECTOR, Circuit, Component, Net, parse_component_value
from fingertip.board.parts.symbols import C_0603, CAPACITOR, R_0603, RESISTOR

TONE = "TONE"
"""Net that the generator drives, above ground."""
COUPLING_OHM, COUPLING_F = "R99", "C99"
COUPLING_FARAD = 100e-9
TONE_V = 0.3
"""Tone of the generator, RMS [V]: what the headphone output of a phone gives without distortion."""
_SWING_SHARE = 0.45
"""Peak of the filtered tone as a share of the filter's swing: well above a meter's error, well below clipping."""
_TONE_RATIOS = (0.6, 1.0, 2.0)
"""Frequencies of the tone as multiples of the cutoff: well below, at, and well above it."""


@dataclass(frozen=True)
class Bench:
    dummy_ohm: tuple[float, float]
    """Resistors in place of the sensor: for the lighter and the firmer of two forces."""
    coupling_ohm: float
    """Resistor between generator and sensor connector, in series with `COUPLING_FARAD`."""
    tones_hz: tuple[float, float, float]
    """Frequencies of the tone, rising."""


def set_up_bench(circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float, swing_v: float) -> Bench:
    # Values of E24 are in any kit of resistors; the expected readings follow from the values that are used.
    light_ohm, firm_ohm = (
        nearest_value(1.0 / sensor_conductance_s(force_n), "E24") for force_n, _ in ARTICLE_POINTS[1:]
    )
    low, middle, high = (float(round(ratio * cutoff_hz)) or cutoff_hz for ratio in _TONE_RATIOS)
    # The current into the bridge is the tone over this resistor, which is far larger than the bridge.
    trial = Bench((light_ohm, firm_ohm), 1e6, (low, middle, high))
    path = feed_tone(circuit, trial, gain_bandwidth_hz).restrict(nets.FILTERED)
    gain = abs(path.response(np.array([high]), {TONE: 1.0}, nets.FILTERED)[0, 0])
    wanted = _SWING_SHARE * swing_v / (math.sqrt(2.0) * TONE_V)
    return replace(trial, coupling_ohm=nearest_value(trial.coupling_ohm * gain / wanted, "E24"))


def feed_tone(circuit: Circuit, bench: Bench, gain_bandwidth_hz: float) -> Network:
    """Feed a tone to the sensor's pin through the coupling parts, with the lighter resistor in place of the sensor."""
    resistor = Component(
        COUPLING_OHM, f"{bench.coupling_ohm:.10g}", RESISTOR, R_0603, "test: from the generator to the sensor"
    )
    capacitor = Component(COUPLING_F, f"{COUPLING_FARAD:.10g}", CAPACITOR, C_0603, "test: blocks direct current")
    middle = "TONE_MIDDLE"
    toned = circuit.connect(resistor, {"1": middle, "2": nets.SENSOR}).connect(capacitor, {"1": TONE, "2": middle})
    return build_network(toned, gain_bandwidth_hz, sensor_s=1.0 / bench.dummy_ohm[0]).drive(TONE)


# Faults of single parts: what goes wrong when a board is soldered, each as a changed circuit.

_OPEN_OHM, _SHORT_OHM = "1e10", "1e-2"
_OPEN_FARAD = "1e-16"
_LEAKING_FARAD, _LEAKAGE_OHM = 5e-6, "5e7"
"""Capacitor from which leakage counts, and its resistance: that of 10 uF X7R, which makers state as 500 ohm F."""
_WRONG_VALUES = ((0.1, "a tenth of its value"), (0.5, "half its value"), (2.0, "twice its value"), (10.0, "ten times"))


@dataclass(frozen=True)
class Fault:
    reference: str
    """Reference of the part; empty for a board without a fault."""
    description: str
    circuit: Circuit
    rarity: int = 0
    """Rank by how rare the fault is: 0 not soldered or reversed, 1 bridged, 2 a wrong value, 3 a whole amplifier. An
    assumption, which only orders what the readings do not tell apart."""
    stuck_v: dict[str, float] = field(default_factory=dict)
    """Nets that an amplifier's output holds at a voltage [V]."""

    @property
    def sentence(self) -> str:
        return f"{self.reference} {self.description}"


def _leak(circuit: Circuit) -> Circuit:
    """Give large capacitors to ground their leakage, which decides on a net that an open resistor leaves floating."""
    for part in circuit.components:
        ends = [circuit.net_by_pin.get((part.reference, pin), "") for pin in "12"]
        if part.symbol.name == "C" and nets.GND in ends and parse_component_value(part.value) >= _LEAKING_FARAD:
            leak = Component(f"R8{part.reference[1:]}", _LEAKAGE_OHM, RESISTOR, R_0603, "leakage of a capacitor")
            circuit = circuit.connect(leak, dict(zip("12", ends, strict=True)))
    return circuit


def list_faults(circuit: Circuit, ends_v: Mapping[str, tuple[float, float]]) -> Iterator[Fault]:
    leaky = _leak(circuit)
    for part in circuit.components:
        name, kind = part.reference, part.symbol.name
        bridged = Fault(name, "is bridged", circuit.replace(name, _SHORT_OHM, RESISTOR), 1)
        if kind in ("R", "C"):
            opened = leaky.replace(name, _OPEN_OHM) if kind == "R" else circuit.replace(name, _OPEN_FARAD)
            yield Fault(name, "is open: not soldered, or cracked", opened)
            yield bridged
            for factor, description in _WRONG_VALUES:
                value = f"{factor * parse_component_value(part.value):.10g}"
                yield Fault(name, f"has {description}", circuit.replace(name, value), 2)
        elif kind == "1N4148W":
            swapped = {(name, "1"): (name, "2"), (name, "2"): (name, "1")}
            turned = tuple(Net(net.name, tuple(swapped.get(n, n) for n in net.nodes)) for net in circuit.nets)
            yield Fault(name, "is reversed", replace(circuit, nets=turned))
            yield Fault(name, "is open: not soldered", circuit.without(name))
            yield bridged
    for output in list_amplifiers(circuit):
        if output.net in ends_v:
            for volts, end in zip(ends_v[output.net], ("lowest", "highest"), strict=True):
                what = f"holds {output.net} at its {end} voltage: rotated, not soldered, or with bridged pins"
                yield Fault(output.reference, what, circuit, 3, {output.net: volts})


def list_exchanges(circuit: Circuit) -> Iterator[Fault]:
    """Yield the exchanges of two parts of other values in equal packages."""
    parts = [part for part in circuit.components if part.symbol.name in ("R", "C")]
    for one, other in itertools.combinations(parts, 2):
        if (one.symbol, one.footprint) == (other.symbol, other.footprint) and one.value != other.value:
            changed = circuit.replace(one.reference, other.value).replace(other.reference, one.value)
            yield Fault(f"{one.reference} and {other.reference}", "are exchanged", changed, 1)


# Readings at the pins of J3: what the controller will see, behind the resistors and capacitors ahead of it.
#
# They are taken against supply ground, as the controller reads them. The meter's own resistance is part of the
# circuit, so that a pin whose resistor is open reads nothing instead of floating.

HOST = HOST_CONNECTOR
METER_OHM = 10e6
TOP_HZ = 400.0
"""Tone at which S is measured: the upper end of a simple meter's range, where C25 attenuates most."""


@dataclass(frozen=True)
class OutputPin:
    letter: str
    """Letter that the board prints beside it."""
    net: str
    source: str
    """Net with a test point that feeds it."""
    meter: str
    """Reference of the meter's resistance."""

    @property
    def constant_name(self) -> str:
        return f"j3_{self.letter.lower()}_open_v"

    @property
    def tone_name(self) -> str:
        return f"j3_{self.letter.lower()}_{TOP_HZ:.0f}hz_v"


_PINS = (
    OutputPin("T", nets.ADC_TACTILE, nets.TACTILE, "R91"),
    OutputPin("S", nets.ADC_FILTERED, nets.FILTERED, "R92"),
    OutputPin("E", nets.ADC_ENVELOPE, nets.ENVELOPE, "R93"),
    OutputPin("M", nets.VMID_OUT, nets.VMID, "R94"),
)


def list_output_pins(circuit: Circuit) -> tuple[OutputPin, ...]:
    at_host = {net.name for net in circuit.nets if any(reference == HOST for reference, _ in net.nodes)}
    return tuple(pin for pin in _PINS if pin.net in at_host)


def has_tone(pin: OutputPin) -> bool:
    """Return whether a pin's tone is large enough for a meter: that of the filtered signal."""
    return pin.source == nets.FILTERED


def connect_meter(circuit: Circuit) -> Circuit:
    """Connect a meter between each measured pin and supply ground."""
    for pin in list_output_pins(circuit):
        meter = Component(pin.meter, f"{METER_OHM:.10g}", RESISTOR, R_0603, "test: input of the meter")
        circuit = circuit.connect(meter, {"1": pin.net, "2": nets.GND})
    return circuit


def predict_constants(circuit: Circuit, sources_v: Mapping[str, float]) -> dict[str, float]:
    """Constant voltages of the pins above supply ground [V], from those of the nets that feed them."""
    pins = list_output_pins(circuit)
    network = build_network(connect_meter(circuit)).drive(*(pin.source for pin in pins))
    volts = network.restrict(*(pin.net for pin in pins)).operating_point(sources_v)
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
    # The share of each source's constant voltage that its pin has with the meter connected.
    ratios = predict_constants(circuit, {pin.source: 1.0 for pin in list_output_pins(circuit)})
    return max((abs(expected_v[name]) * (1.0 / ratio - 1.0) for name, ratio in ratios.items()), default=0.0)
