"""Circuit of a board, from the table `components.csv` and the selected values; and of a divider.

A row of the table holds for the boards whose properties (`_PROPERTIES`) it names. Its pins lead to
nets, of which SGND and VNEG stand for the signal ground and the amplifiers' negative rail.

Variant `article` is the article's circuit (figure 3) with its references, except that R_LP and C_LP
are R6 and C4, because KiCad requires references that end in a digit: a first-order high-pass with
gain 1 + R5/R4 (eqs. 1, 2), a unity-gain Sallen-Key high-pass (eqs. 3, 4), a diode, and R_LP
parallel to C_LP (eq. 11).

`precision` has a transimpedance stage in place of the bridge
(`fingertip.board.components.front_end`). Its filter equals that of `article` except for two
capacitors. C14 couples R4 to signal ground for AC only, so that the first stage does not amplify
its own offset. C20 across R5 is a low-pass above the band of the vibrations. The circuit ends with
FILTERED: the controller's software computes the envelope.

`comparator` is `precision` with rectifier, envelope and the article's future work: threshold,
hysteresis and an ON/OFF pin. After FILTERED a precision half-wave rectifier (U3a, D1, D4), which
inverts, drives an inverting first-order low-pass (U3b). Both inputs are virtual grounds, so R_LP
and C_LP give the article's 36.17 Hz whether a diode conducts or not. After two inversions the
envelope is positive and follows the positive half waves. For a sine its mean is 1/pi of the peak.
The comparator has an open-collector output: SLIP is low (asserted) while slip is detected and high
(VCC) otherwise. R24 isolates the buffer of VMID from the cable, whose capacitance it could not
drive.

Both run on the 3.3 V of a controller. U2b buffers VMID. Q1 blocks a reversed supply, whose positive
end is its gate; otherwise its body diode lets the first current through, and its channel bridges
the diode. The supply comes with the signals through J3, whose pins are in the order of I2C
connectors (ground, 3.3 V, T, S). From its pins only R9 and R27 lead to the amplifiers, behind D3
and D5: whatever voltage another socket has there drives less than a milliampere.

A divider stands in place of a board: the sensor from the supply to a controller's pin, and one
resistor from there to ground. T = Vs R / (R + 1 / G) for a sensor of the conductance G. It scales
with the supply Vs, so that a converter that takes its reference from there measures the sensor
alone. Noise and steps of the converter are those of the signal.
"""

from __future__ import annotations

import functools
from pathlib import Path

from fingertip.board.circuits.channels import repeat_channel
from fingertip.board.components.values import SUPPLIES, ComponentValues
from fingertip.board.parts import symbols
from fingertip.board.parts.circuit import (
    Circuit,
    Component,
    Requirement,
    ResistorRequirement,
    build_circuit,
    format_component_value,
)
from fingertip.board.parts.nets import GND, TACTILE, VCC
from fingertip.board.parts.select_part import (
    BULK_CAPACITOR,
    SUPPLY_CAPACITOR,
    find_package,
    require_capacitor,
)
from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE
from fingertip.design import Design
from fingertip.design.formulas.filter import VMID_BOTTOM_OHM, VMID_TOP_OHM
from fingertip.foundation.tables import parse_value, read_rows

NAME = "slip_filter"

SUPPRESSOR = "PESD5V0S1BA"
"""Part between the sensor's cable and ground."""

_PRECISION = ResistorRequirement(0.1, 0.1, 25.0)
"""Requirement for resistors whose value determines a voltage."""
_POWER_W = 0.1
_RATINGS = {
    "header": "pin header 2.54 mm, one row; or solder the wires",
    "locking": "keyed; plug and wires are bought apart (README, What else to buy)",
    "trimmer": "trimmer 3 mm, one turn, top",
    SUPPRESSOR: "ESD suppressor, bidirectional, 5 V working voltage, SOD-323, 8 kV contact (IEC "
    "61000-4-2)",
}
_SIZES = {
    "filter": symbols.C_1206,
    "small": symbols.C_0603,
    "supply": symbols.C_0603,
    "bulk": symbols.C_0805,
}
"""Sizes of the capacitors by kind; filter capacitors beyond size 1206 carry no direct voltage."""


@functools.cache
def load_rows() -> tuple[dict[str, str], ...]:
    return tuple(read_rows(Path(__file__).parent / "components.csv"))


def board_circuit(values: ComponentValues, channels: int = 1) -> Circuit:
    """Build the circuit of a board; of several channels, each is that of one finger."""
    supply = SUPPLIES[values.variant]
    properties = _PROPERTIES[values.variant]
    nets = {"SGND": supply.signal_ground, "VNEG": supply.negative_rail}
    wiring = {}

    for row in load_rows():
        if properties.issuperset(row["boards"].split()):
            pins = (pin.split("=") for pin in row["pins"].split())
            wiring[_make_component(row, values)] = {
                number: nets.get(net, net) for number, net in pins
            }

    circuit = build_circuit(NAME, wiring)
    return circuit if channels == 1 else repeat_channel(circuit, channels)


_PROPERTIES = {
    "article": {"article", "envelope"},
    "precision": {"controller"},
    "comparator": {"controller", "slip", "envelope"},
}
"""Properties of each variant by which rows of the table hold for it."""


def _make_component(row: dict[str, str], values: ComponentValues) -> Component:
    reference = row["reference"]
    kind = row["kind"]
    role = row["role"]

    match kind:
        case "resistor" | "precision":
            ohm = _find_value(row, values)
            requirement = ResistorRequirement(values.tolerance.resistor_percent, _POWER_W)
            required = _PRECISION if kind == "precision" else requirement
            return _make_passive(
                reference,
                value=ohm,
                role=role,
                footprint=symbols.R_0603,
                requirement=required,
            )
        case "filter" | "small" | "supply" | "bulk":
            farad = _find_value(row, values)
            footprint = _SIZES[kind]
            capacitor = SUPPLY_CAPACITOR if kind == "supply" else BULK_CAPACITOR

            if kind in ("filter", "small"):
                capacitor = require_capacitor(
                    farad, find_package(footprint), values.tolerance.capacitor_percent
                )

            return _make_passive(
                reference,
                value=farad,
                role=role,
                footprint=footprint,
                requirement=capacitor,
            )
        case "amplifier":
            data = AMPLIFIER_CATALOGUE[values.amplifier]
            symbol = symbols.DUAL_AMPLIFIERS[values.amplifier]
            rating = f"{symbol.description}, offset {1e3 * data.max_offset_v:g} mV at most"
            return Component(
                reference=reference,
                value=data.order_name,
                symbol=symbol,
                footprint=symbols.SOIC_8,
                role=role,
                rating=rating,
            )
        case "point":
            return Component(
                reference=reference,
                value=row["value"],
                symbol=symbols.SYMBOLS["TestPoint"],
                footprint=symbols.TEST_PAD,
                role=role,
            )
        case "hole":
            return Component(
                reference=reference,
                value=row["value"],
                symbol=symbols.SYMBOLS["MountingHole"],
                footprint=symbols.M2_HOLE,
                role=role,
            )

    symbol = symbols.SYMBOLS[row["symbol"]]
    footprint = getattr(symbols, row["footprint"])
    value = row["value"]
    rating = symbol.description

    if value == SUPPRESSOR:
        rating = _RATINGS[SUPPRESSOR]
    elif reference.startswith("J"):
        rating = _RATINGS["locking" if footprint in symbols.LOCKING_CONNECTORS else "header"]
    elif kind == "trimmer":
        rating = _RATINGS[kind]
        value = format_component_value(_find_value(row, values))

    return Component(
        reference=reference,
        value=value,
        symbol=symbol,
        footprint=footprint,
        role=role,
        rating=rating,
    )


def _find_value(row: dict[str, str], values: ComponentValues) -> float:
    """Return a component's value [ohm, F]: the fixed one of the table, or the selected one."""
    selected = {"R22": VMID_TOP_OHM, "R23": VMID_BOTTOM_OHM, **values.by_reference}
    return parse_value(row["value"]) if row["value"] else selected[row["reference"]]


def _make_passive(
    reference: str,
    value: float,
    role: str,
    footprint: str,
    requirement: Requirement,
) -> Component:
    symbol = symbols.RESISTOR if reference.startswith("R") else symbols.CAPACITOR
    return Component(
        reference=reference,
        value=format_component_value(value),
        symbol=symbol,
        footprint=footprint,
        role=role,
        rating=requirement.rating,
        requirement=requirement,
    )


_AXIAL = "Resistor_THT:R_Axial_DIN0207_L6.3mm_D2.5mm_P10.16mm_Horizontal"


def divider_circuit(design: Design) -> Circuit:
    """Build the circuit of sensor, resistor, and the three pins of the controller."""
    ohm = format_component_value(design.board.divider_ohm)
    converter = design.detector
    label = design.dimensions.sensor.label
    two_pins = symbols.SYMBOLS["Conn_01x02"]
    sensor = Component(
        reference="J1",
        value=label,
        symbol=two_pins,
        footprint=symbols.HEADER_2,
        role="sensor, either way round",
        rating="with solder tabs",
    )
    resistor = Component(
        reference="R1",
        value=ohm,
        symbol=symbols.RESISTOR,
        footprint=_AXIAL,
        role="input to ground",
        rating="metal film with leads, 1 %, 0.25 W",
    )
    rating = (
        f"analog input of {converter.adc_bits} bits, {converter.adc_range_text}; see "
        "fingertip firmware"
    )
    role = "converter's reference (Pico: ADC_VREF, pin 35), analog input, ground"
    pins = Component(
        reference="J3",
        value="controller",
        symbol=symbols.SYMBOLS["Conn_01x03"],
        footprint=symbols.HEADER_3,
        role=role,
        rating=rating,
    )
    wiring = {sensor: (VCC, TACTILE), resistor: (TACTILE, GND), pins: (VCC, TACTILE, GND)}

    return build_circuit(
        "divider", {part: dict(zip("123", nets, strict=False)) for part, nets in wiring.items()}
    )
