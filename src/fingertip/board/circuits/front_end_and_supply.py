"""Circuit blocks that all variants share: bridge, ADC interface, supply, test points and mounting holes."""

from __future__ import annotations

from collections.abc import Mapping

from fingertip.board.circuit import Circuit, Component, build_circuit
from fingertip.board.circuits.components import (
    SelectedComponents,
    Wiring,
    component,
    precision_resistor,
    supply_capacitor,
)
from fingertip.board.components.bridge import SENSOR_FILTER_F
from fingertip.board.components.component_values import ComponentValues
from fingertip.board.kicad import symbols
from fingertip.board.nets import (
    ADC_ENVELOPE,
    ADC_TACTILE,
    ALIAS_MID,
    ENVELOPE,
    FILTERED,
    GAIN_A,
    GAIN_B,
    GND,
    REFERENCE,
    SENSOR,
    STAGE1_OUT,
    TACTILE,
    VCC,
    VEE,
    VMID,
    VMID_DIVIDER,
    VMID_OUT,
)
from fingertip.board.supplies import SUPPLIES, Supply

NAME = "slip_filter"

# Values that do not depend on parameters of the design.
DECOUPLING_F = 100e-9
"""Decoupling capacitor at each supply pin [F]."""
BULK_F = 10e-6
"""Capacitor where the supply enters, and across the divider that halves it [F]."""
CABLE_OHM = 1e3
"""Resistor between an amplifier's output and a pin without a filter [ohm]."""
DIVIDER_OHM = 10e3
"""Both resistors of the divider [ohm]. With `BULK_F` they filter supply ripple above 3 Hz out of VMID."""


def complete_circuit(values: ComponentValues, signal_path: Wiring, fourth_pin: str = GND) -> Circuit:
    """Complete a variant's signal path, which starts at TACTILE, with the blocks that all variants share; checked."""
    supply = SUPPLIES[values.supply]
    wiring: dict[Component, Mapping[str, str]] = {}
    parts = SelectedComponents(values)
    supply_block = _split_supply() if supply.negative_rail == VEE else _single_supply(parts)
    for block in (
        _front_end(parts, supply), signal_path, _adc_interface(parts, supply, fourth_pin),
        supply_block, _test_points(supply), _mounting_holes(),
    ):  # fmt: skip
        wiring.update(block)
    return build_circuit(NAME, wiring)


def _front_end(parts: SelectedComponents, supply: Supply) -> Wiring:
    """Connector of the sensor, bridge and instrumentation amplifier."""
    ground = supply.signal_ground
    sensor = component("J1", "FSR", symbols.CONNECTOR_2, symbols.HEADER_2, "force-sensing resistor")
    amplifier = component("U2", "AD623ARMZ", symbols.AD623, symbols.MSOP_8, "instrumentation amplifier of the bridge")
    return {
        sensor: {"1": SENSOR, "2": ground},
        parts.bridge_resistor("R10", "bridge: supply to sensor"): {"1": VCC, "2": SENSOR},
        parts.bridge_resistor("R11", "bridge: parallel to the sensor"): {"1": SENSOR, "2": ground},
        parts.bridge_resistor("R12", "bridge: supply to reference"): {"1": VCC, "2": REFERENCE},
        parts.bridge_resistor("R13", "bridge: reference to signal ground"): {"1": REFERENCE, "2": ground},
        parts.bridge_resistor("R14", "bridge: gain of its amplifier"): {"1": GAIN_A, "2": GAIN_B},
        supply_capacitor("C7", SENSOR_FILTER_F, "sensor's cable: radio interference"): {"1": SENSOR, "2": ground},
        amplifier: {
            "1": GAIN_A, "8": GAIN_B, "2": REFERENCE, "3": SENSOR, "5": ground, "6": TACTILE, "7": VCC,
            "4": supply.negative_rail,
        },
    }  # fmt: skip


def _adc_interface(parts: SelectedComponents, supply: Supply, fourth_pin: str) -> Wiring:
    """Anti-aliasing poles, and clamps to ground and VCC, for the envelope and the tactile voltage."""
    pins = {"1": ADC_TACTILE, "2": ADC_ENVELOPE, "3": GND, "4": fourth_pin}
    symbol, header = symbols.CONNECTOR_4, symbols.HEADER_4
    signals = ["tactile voltage", "envelope", "ground"]
    if fourth_pin != GND:
        signals.append("slip output")
    if supply.signal_ground == VMID:  # signal ground, for the host to subtract
        pins |= {"5": VMID_OUT}
        symbol, header = symbols.CONNECTOR_5, symbols.HEADER_5
        signals.append("signal ground")
    output = component("J3", "ADC", symbol, header, f"to the ADC: {', '.join(signals)}")
    return {
        parts.resistor("R7", "anti-aliasing filter, envelope"): {"1": ENVELOPE, "2": ADC_ENVELOPE},
        parts.small_capacitor("C8", "anti-aliasing filter, envelope"): {"1": ADC_ENVELOPE, "2": GND},
        _clamp("D2", "clamp of the envelope"): {"1": GND, "2": VCC, "3": ADC_ENVELOPE},
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
        _clamp("D3", "clamp of the tactile voltage"): {"1": GND, "2": VCC, "3": ADC_TACTILE},
        output: pins,
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


def _single_supply(parts: SelectedComponents) -> Wiring:
    """Connector and decoupling of a single supply, and VMID (buffered mid-supply): a divider and a voltage follower.

    The follower's output has no capacitor, because it could not drive one, and R24 isolates it from the cable's
    capacitance. It carries the bridge's 2 mA.
    """
    plus = {"1": VCC, "2": GND}
    power = component("J2", "POWER", symbols.CONNECTOR_2, symbols.HEADER_2, "supply: plus, ground")
    buffer = component("U5", "TLV2371DBV", symbols.TLV2371, symbols.SOT_23_5, "mid-supply: buffer")
    return {
        power: plus,
        supply_capacitor("C10", BULK_F, "supply, at its entry", symbols.C_0805): plus,
        supply_capacitor("C5", DECOUPLING_F, "supply, at U1"): plus,
        supply_capacitor("C12", DECOUPLING_F, "supply, at U2"): plus,
        precision_resistor("R22", DIVIDER_OHM, "mid-supply: upper half"): {"1": VCC, "2": VMID_DIVIDER},
        precision_resistor("R23", DIVIDER_OHM, "mid-supply: lower half"): {"1": VMID_DIVIDER, "2": GND},
        supply_capacitor("C21", BULK_F, "mid-supply: filters ripple", symbols.C_0805): {
            "1": VMID_DIVIDER,
            "2": GND,
        },
        buffer: {"3": VMID_DIVIDER, "4": VMID, "1": VMID, "5": VCC, "2": GND},
        supply_capacitor("C22", DECOUPLING_F, "supply, at U5"): plus,
        parts.resistor("R24", "mid-supply: isolates its buffer from the cable", CABLE_OHM): {"1": VMID_OUT, "2": VMID},
    }


def _test_points(supply: Supply) -> Wiring:
    nets = {"TP1": TACTILE, "TP2": STAGE1_OUT, "TP3": FILTERED, "TP4": ENVELOPE, "TP5": supply.signal_ground}
    return {
        Component(reference, net, symbols.TEST_POINT, symbols.TEST_PAD, f"test point: {net.lower()}"): {"1": net}
        for reference, net in nets.items()
    }


def _mounting_holes() -> Wiring:
    return {Component(f"H{i}", "M2", symbols.MOUNTING_HOLE, symbols.M2_HOLE, "mounting hole"): {} for i in range(1, 5)}


def _clamp(reference: str, role: str) -> Component:
    return component(reference, "BAT54S", symbols.BAT54S, symbols.SOT_23, role)
