"""Equations of a circuit: one linear equation for each net, from its components, pins and nets.

Modified nodal analysis (C.-W. Ho, A. Ruehli, P. Brennan, IEEE Trans. Circuits Syst. 22 (1975) 504).
The equation of a net is Kirchhoff's current law, or, where an amplifier drives the net, the
amplifier's own equation. No current is therefore an unknown, and the equations read

    (G + s C) v + (G_in + s C_in) v_in = 0

with the voltages v of the nets and the given voltages v_in of the inputs. Frequency response,
passband, noise, offsets, operating point, tolerances and the simulation in time all start from
these equations.

Amplifiers are ideal, or as built: finite gain and bandwidth, and capacitance of their inputs. Their
outputs have no resistance. Diodes conduct or block as stated.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.board.components import front_end
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.board.parts.nets import GND, RAILS, UNCONNECTED, VCC
from fingertip.catalogues.electronics import OPEN_LOOP_GAIN, Amplifier
from fingertip.foundation.numerics import Array

Spectrum = NDArray[np.complex128]
Value: TypeAlias = "float | Array"
"""One value, or one for each of many boards."""

UNITY = ""
"""Quantity whose value is 1."""
INVERSE_GAIN = "1/A0"
INVERSE_BANDWIDTH = "1/GBW"
"""Quantities of an amplifier, after its name: 1 / A0, and 1 / (2 pi GBW) [s]."""
CONDUCTING_S = 1.0
"""Conductance of a conducting diode [S]; it lies in an amplifier's loop, which hides its drop."""
MAX_SWITCH_OHM = 0.085
"""Largest resistance of the supply's MOSFET at 2.5 V from gate to source [ohm] (data sheet)."""
_TRIMMER_END_OHM = 1e-3
"""Resistance that remains between a trimmer's wiper and the end to which it is turned [ohm]."""


class AmplifierOutput(NamedTuple):
    """Net that an amplifier drives."""

    amplifier: str
    """Reference of its component, with the letter of its unit: "U1a", or "U2" for an AD623."""
    reference: str
    net: str
    inputs: tuple[str, str]
    """Nets of its inputs, the inverting one last."""
    data: Amplifier | None
    """Figures in the catalogue; None for an AD623."""


class Term(NamedTuple):
    """Summand of an equation: factor * quantity * s^order * voltage of a net."""

    equation: str
    """Net whose equation it belongs to."""
    net: str
    """Net or input whose voltage it contains."""
    quantity: str
    """Name of its value, such as "R1": a conductance [S], a capacitance [F], or `UNITY`."""
    factor: float
    order: int
    """0 for G, 1 for C."""


@dataclass(frozen=True, eq=False)
class StateSpace:
    """State equations x' = A x + B v_in, batched. Voltages are rows over (x, v_in)."""

    A: Array
    B: Array
    rows: Mapping[str, Array]
    charge: Array
    """States as rows over (voltages of the nets, v_in)."""


@dataclass(frozen=True, eq=False)
class Network:
    terms: tuple[Term, ...]
    values: Mapping[str, Value]
    """Value of each quantity: conductance [S] of a resistor, capacitance [F]."""
    inputs: tuple[str, ...]
    """Nets of given voltage, which have no equation."""

    @functools.cached_property
    def nets(self) -> tuple[str, ...]:
        """Nets of unknown voltage, in the order of the matrices."""
        return tuple(sorted({term.equation for term in self.terms}))

    def drive(self, *nets: str) -> Network:
        """Return the network in which sources determine the voltages of more nets."""
        terms = tuple(term for term in self.terms if term.equation not in nets)
        return replace(self, terms=terms, inputs=(*self.inputs, *nets))

    def ground(self, *nets: str) -> Network:
        """Return the network in which the voltages of these nets are 0."""
        terms = tuple(
            term for term in self.terms if term.equation not in nets and term.net not in nets
        )
        return replace(
            self, terms=terms, inputs=tuple(name for name in self.inputs if name not in nets)
        )

    def restrict(self, *outputs: str) -> Network:
        """Return the part of the network that determines the voltages of some nets.

        An amplifier isolates its output: what only loads an output does not determine it.
        """
        nets = self.trace(outputs)
        return replace(self, terms=tuple(term for term in self.terms if term.equation in nets))

    def trace(self, names: Iterable[str]) -> set[str]:
        """Return these names and all nets and inputs that determine their voltages."""
        traced = set[str]()
        new = set(names)

        while new:
            traced |= new
            new = set().union(*(self.contents.get(name, ()) for name in new)) - traced

        return traced

    @functools.cached_property
    def contents(self) -> Mapping[str, set[str]]:
        """Nets and inputs in the equation of each net."""
        contents: dict[str, set[str]] = {name: set() for name in self.nets}
        for term in self.terms:
            contents[term.equation].add(term.net)

        return contents

    def with_values(self, values: Mapping[str, Value]) -> Network:
        return replace(self, values={**self.values, **values})

    @functools.cached_property
    def matrices(self) -> tuple[Array, Array]:
        """Matrices (G, G_in) and (C, C_in), (..., nets, nets + inputs), batched like the values."""
        row = {name: i for i, name in enumerate(self.nets)}
        column = {name: i for i, name in enumerate((*self.nets, *self.inputs))}
        batch = np.broadcast_shapes(
            *(np.shape(self.values[t.quantity]) for t in self.terms if t.quantity), ()
        )
        G, C = np.zeros((2, *batch, len(row), len(column)))

        for equation, net, quantity, factor, order in self.terms:
            value = self.values[quantity] if quantity else 1.0
            (C if order else G)[..., row[equation], column[net]] += factor * value

        G.flags.writeable = C.flags.writeable = False
        return G, C

    def response(self, f_hz: Array, inputs: Mapping[str, float], *nets: str) -> Spectrum:
        """Return voltages of nets at frequencies [Hz], (frequencies, nets); unnamed inputs are 0.

        Values may be arrays: of many boards at one frequency, or of quantities that vary with the
        frequency.
        """
        n = len(self.nets)
        s = 2j * math.pi * f_hz[:, None, None]
        G, C = self.matrices
        v_in = np.array([inputs.get(name, 0.0) for name in self.inputs])
        right = -(G[..., n:] @ v_in + s[:, :, 0] * (C[..., n:] @ v_in))
        solution = np.linalg.solve(G[..., :n] + s * C[..., :n], right[:, :, None])[:, :, 0]

        return np.asarray(solution[:, [self.nets.index(net) for net in nets]], dtype=np.complex128)

    def transfers(self, f_hz: Array, net: str) -> Spectrum:
        """Return a net's voltage for 1 on the right of each equation, (frequencies, equations).

        That is 1 A into a net, or 1 V at the input of an amplifier times its gain. One solution of
        the transposed equations serves all of them (adjoint method).
        """
        n = len(self.nets)
        G, C = self.matrices
        matrices = G[:, :n] + 2j * math.pi * f_hz[:, None, None] * C[:, :n]
        selector = np.zeros((len(f_hz), n, 1))
        selector[:, self.nets.index(net)] = 1.0

        return np.asarray(
            np.linalg.solve(matrices.transpose(0, 2, 1), selector)[:, :, 0], dtype=np.complex128
        )

    def operating_point(self, inputs: Mapping[str, float]) -> dict[str, float]:
        """Return the voltages [V] of all nets for constant voltages of the inputs [V]."""
        volts = self.response(np.zeros(1), inputs, *self.nets)[0].real.tolist()
        return dict(zip(self.nets, volts, strict=True)) | dict(inputs)

    def constant_transfers(self, net: str, ground: str = GND) -> dict[str, float]:
        """Return the voltage between two nets for a constant 1 on the right of each equation."""
        volts = self.transfers(np.zeros(1), net)[0].real
        if ground in self.nets:
            volts = volts - self.transfers(np.zeros(1), ground)[0].real

        return dict(zip(self.nets, volts.tolist(), strict=True))

    def steady_state(self) -> Array:
        """Return the states for constant voltages of the inputs, (..., states, inputs)."""
        n = len(self.nets)
        G, _ = self.matrices
        volts = np.linalg.solve(G[..., :n], -G[..., n:])
        charge = self.state_space.charge

        return np.asarray(charge[..., :n] @ volts + charge[..., n:])

    @functools.cached_property
    def state_space(self) -> StateSpace:
        """State equations of the network. Raises LinAlgError.

        The states are the charges of the nets with capacitances, each divided by its own net's
        capacitance, so that their unit is the volt; and the outputs of amplifiers of finite
        bandwidth.
        """
        n = len(self.nets)
        G, C = self.matrices
        has_state = [any(t.order and t.equation == name for t in self.terms) for name in self.nets]
        state = np.flatnonzero(has_state)
        algebraic = np.flatnonzero(~np.array(has_state))
        own = C[..., state, state][..., None]
        charge = C[..., state, :] / own
        # The voltages follow from the states, x = charge v + charge_in v_in, and the equations
        # without capacitance.
        left = np.concatenate((charge[..., :n], G[..., algebraic, :n]), axis=-2)
        right = -np.concatenate((charge[..., n:], G[..., algebraic, n:]), axis=-2)
        unit = np.broadcast_to(np.eye(n)[:, : len(state)], (*left.shape[:-1], len(state)))
        volts = np.linalg.solve(left, np.concatenate((unit, right), axis=-1))
        # Then the equations with capacitance give the rates of the states.
        rates = -(G[..., state, :n] @ volts) / own
        rates[..., len(state) :] -= G[..., state, n:] / own
        rows = {
            name: np.asarray(volts[..., i, :], dtype=np.float64) for i, name in enumerate(self.nets)
        }

        return StateSpace(rates[..., : len(state)], rates[..., len(state) :], rows, charge)


def build_network(
    circuit: Circuit,
    gain_bandwidth_hz: float | None = None,
    *,
    sensor_s: float = 0.0,
    conducting: Iterable[str] = (),
    trimmer_ratio: float = 0.5,
    is_supply_resistive: bool = False,
) -> Network:
    """Build the equations of a circuit, with the rails as inputs.

    With a resistive supply the positive rail is no input: Kirchhoff's law holds for it and for the
    outputs of the amplifiers together, as these draw their current from it.
    """
    nets = circuit.net_by_pin
    equations = _Equations(circuit, gain_bandwidth_hz, is_supply_resistive)

    for component in circuit.components:
        symbol = component.symbol.name
        name = component.reference
        pins = {pin.number: nets[name, pin.number] for pin in component.symbol.pins}

        if symbol == "R" and pins["1"] in equations.gain_nets:
            # The resistor is part of its amplifier's gain.
            equations.values[name] = 1.0 / parse_component_value(component.value)
        elif symbol == "R":
            equations.add(name, 1.0 / parse_component_value(component.value), pins["1"], pins["2"])
        elif symbol == "C":
            equations.add(
                name, parse_component_value(component.value), pins["1"], pins["2"], order=1
            )
        elif symbol == "R_Potentiometer":
            ohm = parse_component_value(component.value)
            for end, pin, ratio in (("a", "1", 1.0 - trimmer_ratio), ("b", "3", trimmer_ratio)):
                equations.add(
                    f"{name}{end}", 1.0 / max(ohm * ratio, _TRIMMER_END_OHM), pins[pin], pins["2"]
                )
        elif component.value == "FSR":
            (_, sensor), (_, ground) = circuit.list_wires(component)
            equations.add(name, sensor_s, sensor, ground)
        elif symbol == "AO3401A" and is_supply_resistive:
            equations.add(name, 1.0 / MAX_SWITCH_OHM, pins["3"], pins["2"])
        elif symbol == "D_TVS":
            equations.add(name, front_end.SUPPRESSOR_F, pins["1"], pins["2"], order=1)
        elif symbol == "1N4148W":
            equations.values[name] = CONDUCTING_S
            if name in conducting:
                equations.add(name, CONDUCTING_S, pins["1"], pins["2"])
        elif symbol == "AD623ARMZ":
            equations.add_instrumentation_amplifier(pins)
        elif symbol in front_end.AMPLIFIERS:
            equations.add_amplifiers(name, front_end.AMPLIFIERS[symbol], pins)

    return Network(tuple(equations.terms), equations.values, equations.rails)


class _Equations:
    """Terms of the equations of a circuit's nets, to which each component adds its own."""

    def __init__(
        self, circuit: Circuit, gain_bandwidth_hz: float | None, is_supply_resistive: bool
    ) -> None:
        nets = circuit.net_by_pin
        driven = {output.net for output in list_amplifiers(circuit)}
        amplifiers = [c.reference for c in circuit.components if c.symbol.name == "AD623ARMZ"]
        self.gain_nets = {nets[name, pin] for name in amplifiers for pin in "18"}
        self.rails = tuple(rail for rail in RAILS if rail != VCC or not is_supply_resistive)
        without_law = {*self.rails, *driven, *self.gain_nets}
        self._law = {
            n: n for n in nets.values() if n not in without_law and not n.startswith(UNCONNECTED)
        }
        """Net -> net whose equation takes its current; a driven net has its amplifier's equation.
        """
        self._law |= dict.fromkeys(driven if is_supply_resistive else (), VCC)
        self._bandwidth_hz = gain_bandwidth_hz
        self.terms: list[Term] = []
        self.values: dict[str, Value] = {}

    def add(
        self,
        quantity: str,
        value: float,
        first: str,
        second: str | None,
        order: int = 0,
    ) -> None:
        """Add an admittance between two nets, or to ground, to the current laws of both."""
        self.values[quantity] = value
        for net, far_end in ((first, second), (second, first)):
            if net in self._law:
                self.terms.append(
                    Term(
                        equation=self._law[net],
                        net=net,
                        quantity=quantity,
                        factor=1.0,
                        order=order,
                    )
                )
                if far_end is not None:
                    self.terms.append(
                        Term(
                            equation=self._law[net],
                            net=far_end,
                            quantity=quantity,
                            factor=-1.0,
                            order=order,
                        )
                    )

    def add_instrumentation_amplifier(self, pins: Mapping[str, str]) -> None:
        """Add v_out (1 + s A / (2 pi GBW)) = A (v_plus - v_minus) + v_ref for an AD623.

        A = 1 + 100 kohm / R_gain.
        """
        out = pins["6"]
        for quantity, factor in (
            (UNITY, 1.0),
            (front_end.GAIN_RESISTOR, front_end.GAIN_CONSTANT_OHM),
        ):
            self.terms += [
                Term(
                    equation=out,
                    net=pins["3"],
                    quantity=quantity,
                    factor=factor,
                    order=0,
                ),
                Term(
                    equation=out,
                    net=pins["2"],
                    quantity=quantity,
                    factor=-factor,
                    order=0,
                ),
            ]
            if self._bandwidth_hz is not None:
                self.terms.append(
                    Term(
                        equation=out,
                        net=out,
                        quantity=quantity,
                        factor=-factor / (math.tau * front_end.AD623_BANDWIDTH_HZ),
                        order=1,
                    )
                )

        self.terms += [
            Term(
                equation=out,
                net=pins["5"],
                quantity=UNITY,
                factor=1.0,
                order=0,
            ),
            Term(
                equation=out,
                net=out,
                quantity=UNITY,
                factor=-1.0,
                order=0,
            ),
        ]

    def add_amplifiers(self, reference: str, data: Amplifier, pins: Mapping[str, str]) -> None:
        """Add v_out / A = v_plus - v_minus of each unit; 1 / A is 0, or 1 / A0 + s / (2 pi GBW)."""
        for unit, (plus, minus, out) in data.units.items():
            net = pins[out]
            name = f"{reference}{unit}"
            gain = f"{name} {INVERSE_GAIN}"
            bandwidth = f"{name} {INVERSE_BANDWIDTH}"
            self.terms += [
                Term(
                    equation=net,
                    net=pins[plus],
                    quantity=UNITY,
                    factor=1.0,
                    order=0,
                ),
                Term(
                    equation=net,
                    net=pins[minus],
                    quantity=UNITY,
                    factor=-1.0,
                    order=0,
                ),
            ]

            if self._bandwidth_hz is not None:
                self.values[gain] = 1.0 / OPEN_LOOP_GAIN
                self.values[bandwidth] = 1.0 / (math.tau * self._bandwidth_hz)
                self.terms += [
                    Term(
                        equation=net,
                        net=net,
                        quantity=gain,
                        factor=-1.0,
                        order=0,
                    ),
                    Term(
                        equation=net,
                        net=net,
                        quantity=bandwidth,
                        factor=-1.0,
                        order=1,
                    ),
                ]
                for pin in dict.fromkeys((plus, minus)):
                    self.add(f"{name} C{pin}", data.input_f, pins[pin], None, order=1)


def filter_quantities(components: Mapping[str, float], amplifier: Amplifier) -> dict[str, Value]:
    """Return a network's quantities for component values [ohm, F] and another amplifier U1."""
    values: dict[str, Value] = {
        name: 1.0 / v if name.startswith("R") else v for name, v in components.items()
    }
    for unit, (plus, minus, _) in amplifier.units.items():
        values[f"U1{unit} {INVERSE_BANDWIDTH}"] = 1.0 / (math.tau * amplifier.bandwidth_hz)
        values |= {f"U1{unit} C{pin}": amplifier.input_f for pin in (plus, minus)}

    return values


def add_second_poles(network: Network, circuit: Circuit, f_hz: Array) -> Network:
    """Add the second pole of each amplifier at these frequencies [Hz].

    The equations hold 1 / A = 1 / A0 + s / (2 pi GBW). The second pole multiplies it by 1 + s / (2
    pi f2), and the product's term in s^2 is a real one that falls with the frequency.
    """
    values: dict[str, Value] = {}
    for output in list_amplifiers(circuit):
        if output.data:
            gain = f"{output.amplifier} {INVERSE_GAIN}"
            bandwidth = f"{output.amplifier} {INVERSE_BANDWIDTH}"
            inverse_gain = network.values[gain]
            inverse_bandwidth = network.values[bandwidth]
            second_s = 1.0 / (math.tau * output.data.second_pole_hz)
            values[gain] = inverse_gain - inverse_bandwidth * second_s * (math.tau * f_hz) ** 2
            values[bandwidth] = inverse_bandwidth + inverse_gain * second_s

    return network.with_values(values)


def list_amplifiers(circuit: Circuit) -> Iterator[AmplifierOutput]:
    """Yield each amplifier of a circuit with its output, in the order of the components."""
    for component in circuit.components:
        reference = component.reference
        data = front_end.AMPLIFIERS.get(component.symbol.name)
        if data:
            units = data.units
        elif component.symbol.name == "AD623ARMZ":
            units = {"": ("3", "2", "6")}
        else:
            units = {}

        for unit, pins in units.items():
            plus, minus, out = (circuit.net_by_pin[reference, pin] for pin in pins)
            yield AmplifierOutput(
                amplifier=f"{reference}{unit}",
                reference=reference,
                net=out,
                inputs=(plus, minus),
                data=data,
            )
