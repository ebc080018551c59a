"""Constructors of the board's components by purpose: footprint and rating for purchase."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.board.components.bridge import DIVIDER_F, SENSOR_FILTER_F, VREF_BOTTOM_OHM, VREF_TOP_OHM
from fingertip.board.components.values import (
    CLAMP,
    LOW_LEAKAGE_CLAMP,
    MAX_LOW_LEAKAGE_A,
    SUPPLIES,
    ComponentValues,
    Supply,
)
from fingertip.board.parts import symbols
from fingertip.board.parts.circuit import (
    ADC_ENVELOPE,
    ADC_FILTERED,
    ADC_TACTILE,
    ALIAS_MID,
    ENVELOPE,
    FILTERED,
    GAIN_A,
    GAIN_B,
    GND,
    POWER_IN,
    REFERENCE,
    SENSOR,
    STAGE1_OUT,
    TACTILE,
    VCC,
    VEE,
    VMID,
    VMID_DIVIDER,
    VMID_OUT,
    VREF,
    VREF_DIVIDER,
    CapacitorRequirement,
    Circuit,
    Component,
    ResistorRequirement,
    Symbol,
    build_circuit,
    format_component_value,
)
from fingertip.board.parts.select_part import BULK_CAPACITOR, SUPPLY_CAPACITOR, find_package, require_capacitor
from fingertip.catalogues.amplifiers import CATALOGUE
from fingertip.design.formulas.filter import DIVIDERS_OHM

Wiring = Mapping[Component, Mapping[str, str]]
"""Component -> pin number -> net name."""

_PRECISION = ResistorRequirement(0.1, 0.1, 25.0)
_POWER_W = 0.1
_LOCKING_RATING = "keyed and locking, with its plug and crimped wires"
_HEADER_RATING = "pin header 2.54 mm, one row; or solder the wires"
_CLAMP_RATINGS = {
    CLAMP: symbols.BAT54S.description,
    LOW_LEAKAGE_CLAMP: f"Dual diode in series, SOT-23, leakage {1e9 * MAX_LOW_LEAKAGE_A:g} nA at most",
}


def component(reference: str, value: str, symbol: Symbol, footprint: str, role: str) -> Component:
    """A component that is purchased by its name."""
    rating = symbol.description
    if reference.startswith("J"):
        rating = _LOCKING_RATING if footprint in symbols.LOCKING_CONNECTORS else _HEADER_RATING
    return Component(reference, value, symbol, footprint, role, rating)


def clamp(reference: str, name: str, role: str) -> Component:
    """A clamp of an output: two diodes in series by their name in `anti_aliasing`. All of them have the same pins."""
    return Component(reference, name, symbols.BAT54S, symbols.SOT_23, role, _CLAMP_RATINGS[name])


def amplifier(reference: str, name: str, role: str) -> Component:
    """A dual amplifier by its name in `CATALOGUE`. All of them have the same pins."""
    data, symbol = CATALOGUE[name], symbols.DUAL_AMPLIFIERS[name]
    rating = f"{symbol.description}, offset {1e3 * data.max_offset_v:g} mV at most"
    return Component(reference, data.order_name, symbol, symbols.SOIC_8, role, rating)


def precision_resistor(reference: str, ohm: float, role: str) -> Component:
    """A precision resistor, whose value determines a voltage."""
    return _resistor(reference, ohm, role, _PRECISION)


@dataclass(frozen=True)
class SelectedComponents:
    """Constructor of the components whose values are selected for the design, by reference, with its tolerances."""

    values: ComponentValues

    def bridge_resistor(self, reference: str, role: str) -> Component:
        """A precision resistor of the bridge."""
        return precision_resistor(reference, self.values.by_reference[reference], role)

    def resistor(self, reference: str, role: str, ohm: float | None = None) -> Component:
        """A resistor of the signal path; a value is given where none is selected."""
        requirement = ResistorRequirement(self.values.tolerance.resistor_percent, _POWER_W)
        return _resistor(reference, self.values.by_reference[reference] if ohm is None else ohm, role, requirement)

    def capacitor(self, reference: str, role: str) -> Component:
        """A capacitor in size 1206; above what the size offers for 16 V, one that has no direct voltage across it."""
        return self._capacitor(reference, role, symbols.C_1206)

    def small_capacitor(self, reference: str, role: str) -> Component:
        """A capacitor in size 0603."""
        return self._capacitor(reference, role, symbols.C_0603)

    def _capacitor(self, reference: str, role: str, footprint: str) -> Component:
        farad, stated_percent = self.values.by_reference[reference], self.values.tolerance.capacitor_percent
        requirement = require_capacitor(farad, find_package(footprint), stated_percent)
        return _chip_capacitor(reference, farad, role, footprint, requirement)


def supply_capacitor(reference: str, farad: float, role: str, footprint: str = symbols.C_0603) -> Component:
    """A decoupling capacitor between the rails, or in a larger size one that stores charge."""
    requirement = SUPPLY_CAPACITOR if footprint == symbols.C_0603 else BULK_CAPACITOR
    return _chip_capacitor(reference, farad, role, footprint, requirement)


def _resistor(reference: str, ohm: float, role: str, requirement: ResistorRequirement) -> Component:
    value = format_component_value(ohm)
    return Component(reference, value, symbols.RESISTOR, symbols.R_0603, role, requirement.rating, requirement)


def _chip_capacitor(
    reference: str, farad: float, role: str, footprint: str, requirement: CapacitorRequirement
) -> Component:
    value = format_component_value(farad)
    return Component(reference, value, symbols.CAPACITOR, footprint, role, requirement.rating, requirement)


# Circuit blocks that all variants share: bridge, ADC interface, supply, test points and mounting holes.


NAME = "slip_filter"

# Values that do not depend on parameters of the design.
DECOUPLING_F = 100e-9
"""Decoupling capacitor at each supply pin [F]."""
BULK_F = 10e-6
"""Capacitor where the supply enters [F]."""
CABLE_OHM = 1e3
"""Resistor between an amplifier's output and a pin without a filter [ohm]."""


def complete_circuit(values: ComponentValues, signal_path: Wiring, fourth_pin: str = GND) -> Circuit:
    """Complete a variant's signal path, which starts at TACTILE, with the blocks that all variants share; checked."""
    supply = SUPPLIES[values.supply]
    wiring: dict[Component, Mapping[str, str]] = {}
    parts = SelectedComponents(values)
    supply_block = _split_supply() if supply.negative_rail == VEE else _single_supply(parts, supply)
    if supply.is_for_controller:
        interface = _controller_interface(parts, fourth_pin)
        supply_block = {**supply_block, **_bridge_supply()}
    else:
        interface = _adc_connector(supply, fourth_pin)
    for block in (
        _front_end(parts, supply), signal_path, _adc_interface(parts, supply), interface,
        supply_block, _test_points(supply), _mounting_holes(),
    ):  # fmt: skip
        wiring.update(block)
    return build_circuit(NAME, wiring)


def _front_end(parts: SelectedComponents, supply: Supply) -> Wiring:
    """Connector of the sensor, bridge and instrumentation amplifier."""
    ground = supply.signal_ground
    if supply.is_for_controller:
        sensor = component("J1", "FSR", symbols.LOCKING_CONNECTOR_2, symbols.JST_SH_2, "force-sensing resistor")
    else:
        sensor = component("J1", "FSR", symbols.CONNECTOR_2, symbols.HEADER_2, "force-sensing resistor")
    mounting_tabs = {"MP": GND} if supply.is_for_controller else {}
    amplifier = component("U2", "AD623ARMZ", symbols.AD623, symbols.MSOP_8, "instrumentation amplifier of the bridge")
    return {
        sensor: {"1": SENSOR, "2": ground, **mounting_tabs},
        parts.bridge_resistor("R10", "bridge: supply to sensor"): {"1": supply.bridge_supply, "2": SENSOR},
        parts.bridge_resistor("R11", "bridge: parallel to the sensor"): {"1": SENSOR, "2": ground},
        parts.bridge_resistor("R12", "bridge: supply to reference"): {"1": supply.bridge_supply, "2": REFERENCE},
        parts.bridge_resistor("R13", "bridge: reference to signal ground"): {"1": REFERENCE, "2": ground},
        parts.bridge_resistor("R14", "bridge: gain of its amplifier"): {"1": GAIN_A, "2": GAIN_B},
        supply_capacitor("C7", SENSOR_FILTER_F, "sensor's cable: radio interference"): {"1": SENSOR, "2": ground},
        amplifier: {
            "1": GAIN_A, "8": GAIN_B, "2": REFERENCE, "3": SENSOR, "5": ground, "6": TACTILE, "7": VCC,
            "4": supply.negative_rail,
        },
    }  # fmt: skip


def _adc_connector(supply: Supply, fourth_pin: str) -> Wiring:
    """Connector to the ADC: a pin header."""
    pins = {"1": ADC_TACTILE, "2": ADC_ENVELOPE, "3": GND, "4": fourth_pin}
    symbol, header = symbols.CONNECTOR_4, symbols.HEADER_4
    signals = ["tactile voltage", "envelope", "ground"]
    if fourth_pin != GND:
        signals.append("slip output")
    if supply.signal_ground == VMID:  # signal ground, for the host to subtract
        pins |= {"5": VMID_OUT}
        symbol, header = symbols.CONNECTOR_5, symbols.HEADER_5
        signals.append("signal ground")
    return {component("J3", "ADC", symbol, header, f"to the ADC: {', '.join(signals)}"): pins}


def _controller_interface(parts: SelectedComponents, slip_pin: str) -> Wiring:
    """Connector to the controller, with ground between the signals, and the filtered signal's pole and clamp.

    The filtered signal is centred at VMID. VMID is the reference of all signals.
    """
    signals = [ADC_TACTILE, ADC_FILTERED, ADC_ENVELOPE, VMID_OUT, slip_pin]
    pins = {str(2 * i + 1): net for i, net in enumerate(signals)}
    pins |= {str(2 * i + 2): GND for i in range(len(signals))}
    names = ["tactile voltage", "filtered signal", "envelope", "signal ground"]
    if slip_pin != GND:
        names.append("slip output")
    role = f"to the controller: {', '.join(names)}; ground between"
    output = component("J3", "HOST", symbols.LOCKING_CONNECTOR_10, symbols.JST_SH_10, role)
    return {
        parts.resistor("R27", "anti-aliasing filter, filtered signal"): {"1": FILTERED, "2": ADC_FILTERED},
        parts.small_capacitor("C25", "anti-aliasing filter, filtered signal"): {"1": ADC_FILTERED, "2": GND},
        clamp("D5", LOW_LEAKAGE_CLAMP, "clamp of the filtered signal"): {"1": GND, "2": VCC, "3": ADC_FILTERED},
        output: {**pins, "MP": GND},
    }


def _adc_interface(parts: SelectedComponents, supply: Supply) -> Wiring:
    """Anti-aliasing poles, and clamps to ground and VCC, for the envelope and the tactile voltage."""
    diodes = LOW_LEAKAGE_CLAMP if supply.is_for_controller else CLAMP
    return {
        parts.resistor("R7", "anti-aliasing filter, envelope"): {"1": ENVELOPE, "2": ADC_ENVELOPE},
        parts.small_capacitor("C8", "anti-aliasing filter, envelope"): {"1": ADC_ENVELOPE, "2": GND},
        clamp("D2", diodes, "clamp of the envelope"): {"1": GND, "2": VCC, "3": ADC_ENVELOPE},
        parts.resistor("R8", "anti-aliasing filter, tactile voltage: first pole"): {
            "1": TACTILE, "2": ALIAS_MID,
        },
        parts.small_capacitor("C9", "anti-aliasing filter, tactile voltage: first pole"): {
            "1": ALIAS_MID, "2": GND,
        },
        parts.resistor("R9", "anti-aliasing filter, tactile voltage: second pole"): {
            "1": ALIAS_MID, "2": ADC_TACTILE,
        },
        parts.small_capacitor("C19", "anti-aliasing filter, tactile voltage: second pole"): {
            "1": ADC_TACTILE, "2": GND,
        },
        clamp("D3", diodes, "clamp of the tactile voltage"): {"1": GND, "2": VCC, "3": ADC_TACTILE},
    }  # fmt: skip


def _split_supply() -> Wiring:
    """Connector and decoupling of a split supply."""
    plus, minus = {"1": VCC, "2": GND}, {"1": GND, "2": VEE}
    power = component("J2", "POWER", symbols.CONNECTOR_3, symbols.HEADER_3, "supply: plus, ground, minus")
    return {
        power: {"1": VCC, "2": GND, "3": VEE},
        supply_capacitor("C10", BULK_F, "plus supply, at its entry", symbols.C_0805): plus,
        supply_capacitor("C11", BULK_F, "minus supply, at its entry", symbols.C_0805): minus,
        supply_capacitor("C5", DECOUPLING_F, "plus supply, at U1"): plus,
        supply_capacitor("C6", DECOUPLING_F, "minus supply, at U1"): minus,
        supply_capacitor("C12", DECOUPLING_F, "plus supply, at U2"): plus,
        supply_capacitor("C13", DECOUPLING_F, "minus supply, at U2"): minus,
    }


def _single_supply(parts: SelectedComponents, supply: Supply) -> Wiring:
    """Connector and decoupling of a single supply, and VMID (buffered mid-supply): a divider and a voltage follower.

    The follower's output has no capacitor, because it could not drive one, and R24 isolates it from the cable's
    capacitance. It carries the bridge's 2 mA.
    """
    plus, divider = {"1": VCC, "2": GND}, DIVIDERS_OHM[supply.name]
    assert divider
    if supply.is_for_controller:
        entry = _protected_entry()
    else:
        entry = {component("J2", "POWER", symbols.CONNECTOR_2, symbols.HEADER_2, "supply: plus, ground"): plus}
    buffer = component("U5", "TLV2371DBV", symbols.TLV2371, symbols.SOT_23_5, "mid-supply: buffer")
    return {
        **entry,
        supply_capacitor("C10", BULK_F, "supply, at its entry", symbols.C_0805): plus,
        supply_capacitor("C5", DECOUPLING_F, "supply, at U1"): plus,
        supply_capacitor("C12", DECOUPLING_F, "supply, at U2"): plus,
        precision_resistor("R22", divider[0], "mid-supply: upper part"): {"1": VCC, "2": VMID_DIVIDER},
        precision_resistor("R23", divider[1], "mid-supply: lower part"): {"1": VMID_DIVIDER, "2": GND},
        supply_capacitor("C21", DIVIDER_F, "mid-supply: filters ripple", symbols.C_0805): {
            "1": VMID_DIVIDER,
            "2": GND,
        },
        buffer: {"3": VMID_DIVIDER, "4": VMID, "1": VMID, "5": VCC, "2": GND},
        supply_capacitor("C22", DECOUPLING_F, "supply, at U5"): plus,
        parts.resistor("R24", "mid-supply: isolates its buffer from the cable", CABLE_OHM): {"1": VMID_OUT, "2": VMID},
    }


def _protected_entry() -> Wiring:
    """Connector of the supply and the MOSFET that blocks a reversed one.

    Its body diode lets the first current through; its channel then bridges the diode, because its gate is at ground.
    With a reversed supply the gate is at the positive end, and both block.
    """
    power = component("J2", "POWER", symbols.CONNECTOR_2, symbols.JST_PH_2, "supply: plus, ground")
    switch = component("Q1", "AO3401A", symbols.AO3401A, symbols.SOT_23, "protection against a reversed supply")
    return {power: {"1": POWER_IN, "2": GND}, switch: {"3": POWER_IN, "2": VCC, "1": GND}}


def _bridge_supply() -> Wiring:
    """VREF, which feeds the bridge: a divider, a capacitor that filters ripple, and a voltage follower."""
    buffer = component("U6", "TLV2371DBV", symbols.TLV2371, symbols.SOT_23_5, "bridge's supply: buffer")
    return {
        precision_resistor("R25", VREF_TOP_OHM, "bridge's supply: upper part"): {"1": VCC, "2": VREF_DIVIDER},
        precision_resistor("R26", VREF_BOTTOM_OHM, "bridge's supply: lower part"): {"1": VREF_DIVIDER, "2": GND},
        supply_capacitor("C23", DIVIDER_F, "bridge's supply: filters ripple", symbols.C_0805): {
            "1": VREF_DIVIDER,
            "2": GND,
        },
        buffer: {"3": VREF_DIVIDER, "4": VREF, "1": VREF, "5": VCC, "2": GND},
        supply_capacitor("C24", DECOUPLING_F, "supply, at U6"): {"1": VCC, "2": GND},
    }


def _test_points(supply: Supply) -> Wiring:
    nets = {"TP1": TACTILE, "TP2": STAGE1_OUT, "TP3": FILTERED, "TP4": ENVELOPE, "TP5": supply.signal_ground}
    return {
        Component(reference, net, symbols.TEST_POINT, symbols.TEST_PAD, f"test point: {net.lower()}"): {"1": net}
        for reference, net in nets.items()
    }


def _mounting_holes() -> Wiring:
    return {Component(f"H{i}", "M2", symbols.MOUNTING_HOLE, symbols.M2_HOLE, "mounting hole"): {} for i in range(1, 3)}
