"""Symbols and footprints used, by their long-standing names in KiCad's own libraries.

Pins are copied here so that writing a netlist does not need KiCad. A test compares them with those of KiCad 9.
"""

from __future__ import annotations

from fingertip.board.parts.circuit import Pin, Symbol


def _passive(*names: str) -> tuple[Pin, ...]:
    return tuple(Pin(str(number), name, "passive") for number, name in enumerate(names, start=1))


RESISTOR = Symbol("Device", "R", "Resistor", _passive("~", "~"))
CAPACITOR = Symbol("Device", "C", "Unpolarized capacitor", _passive("~", "~"))
DIODE_1N4148W = Symbol("Diode", "1N4148W", "Fast switching diode, SOD-123", _passive("K", "A"))
BAT54S = Symbol("Diode", "BAT54S", "Dual Schottky diode in series, SOT-23", _passive("A", "K", "COM"))
AO3401A = Symbol(
    "Transistor_FET",
    "AO3401A",
    "P-channel MOSFET, SOT-23",
    (Pin("1", "G", "input"), Pin("2", "S", "passive"), Pin("3", "D", "passive")),
)
TEST_POINT = Symbol("Connector", "TestPoint", "test point", _passive("1"))
MOUNTING_HOLE = Symbol("Mechanical", "MountingHole", "Mounting Hole without connection", ())
CONNECTOR_2 = Symbol("Connector_Generic", "Conn_01x02", "Generic connector, 1x2", _passive("Pin_1", "Pin_2"))
CONNECTOR_3 = Symbol("Connector_Generic", "Conn_01x03", "Generic connector, 1x3", _passive("Pin_1", "Pin_2", "Pin_3"))
CONNECTOR_4 = Symbol(
    "Connector_Generic", "Conn_01x04", "Generic connector, 1x4", _passive("Pin_1", "Pin_2", "Pin_3", "Pin_4")
)
CONNECTOR_5 = Symbol(
    "Connector_Generic", "Conn_01x05", "Generic connector, 1x5", _passive("Pin_1", "Pin_2", "Pin_3", "Pin_4", "Pin_5")
)


def _locking_connector(pins: int) -> Symbol:
    """Connector with a mounting pin, as the footprints of surface-mount connectors require."""
    contacts = _passive(*(f"Pin_{i}" for i in range(1, pins + 1)))
    return Symbol(
        "Connector_Generic_MountingPin",
        f"Conn_01x{pins:02}_MountingPin",
        f"Generic connector with mounting pin, 1x{pins}",
        (*contacts, Pin("MP", "MountPin", "passive")),
    )


LOCKING_CONNECTOR_2, LOCKING_CONNECTOR_10 = _locking_connector(2), _locking_connector(10)
_DUAL_PINS = (
    Pin("1", "~", "output"),
    Pin("2", "-", "input"),
    Pin("3", "+", "input"),
    Pin("4", "V-", "power_in"),
    Pin("5", "+", "input"),
    Pin("6", "-", "input"),
    Pin("7", "~", "output"),
    Pin("8", "V+", "power_in"),
)
TL082 = Symbol("Amplifier_Operational", "TL082", "Dual JFET-input operational amplifier, SOIC-8", _DUAL_PINS)


def _rail_to_rail(name: str) -> Symbol:
    description = "Dual operational amplifier, inputs and outputs to both rails, SOIC-8"
    return Symbol("Amplifier_Operational", name, description, _DUAL_PINS)


TLV2372 = _rail_to_rail("TLV2372")
DUAL_AMPLIFIERS = {
    "TL082": TL082,
    "TLV2372": TLV2372,
    "MCP6022": _rail_to_rail("MCP6022"),
    "OPA2376": _rail_to_rail("OPA2376xxD"),
    "OPA2197": _rail_to_rail("LM2904"),
}
"""Dual amplifiers for the filter and the rectifier, by name."""
TLV2371 = Symbol(
    "Amplifier_Operational",
    "TLV2371DBV",
    "Operational amplifier, inputs and output to both rails, SOT-23-5",
    (
        Pin("1", "~", "output"),
        Pin("2", "V-", "power_in"),
        Pin("3", "+", "input"),
        Pin("4", "-", "input"),
        Pin("5", "V+", "power_in"),
    ),
)
AD623 = Symbol(
    "Amplifier_Instrumentation",
    "AD623ARMZ",
    "Rail to rail instrumentation amplifier, MSOP-8",
    (
        Pin("1", "Rg", "passive"),
        Pin("2", "-", "input"),
        Pin("3", "+", "input"),
        Pin("4", "Vs-", "power_in"),
        Pin("5", "Ref", "passive"),
        Pin("6", "~", "output"),
        Pin("7", "Vs+", "power_in"),
        Pin("8", "Rg", "passive"),
    ),
)
TRIMMER = Symbol("Device", "R_Potentiometer", "Potentiometer", (
    Pin("1", "1", "passive"), Pin("2", "2", "passive"), Pin("3", "3", "passive"),
))  # fmt: skip
LMV331 = Symbol(
    "Comparator",
    "LMV331",
    "Comparator with open collector, SOT-23-5",
    (
        Pin("1", "+", "input"),
        Pin("2", "V-", "power_in"),
        Pin("3", "-", "input"),
        Pin("4", "~", "open_collector"),
        Pin("5", "V+", "power_in"),
    ),
)

SOT_23_5 = "Package_TO_SOT_SMD:SOT-23-5"
TC33X = "Potentiometer_SMD:Potentiometer_Bourns_TC33X_Vertical"
R_0603 = "Resistor_SMD:R_0603_1608Metric"
C_0603 = "Capacitor_SMD:C_0603_1608Metric"
C_1206 = "Capacitor_SMD:C_1206_3216Metric"
C_0805 = "Capacitor_SMD:C_0805_2012Metric"
SOD_123 = "Diode_SMD:D_SOD-123"
SOT_23 = "Package_TO_SOT_SMD:SOT-23"
MSOP_8 = "Package_SO:MSOP-8_3x3mm_P0.65mm"
SOIC_8 = "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm"
HEADER_2 = "Connector_PinHeader_2.54mm:PinHeader_1x02_P2.54mm_Vertical"
HEADER_4 = "Connector_PinHeader_2.54mm:PinHeader_1x04_P2.54mm_Vertical"
HEADER_5 = "Connector_PinHeader_2.54mm:PinHeader_1x05_P2.54mm_Vertical"
HEADER_3 = "Connector_PinHeader_2.54mm:PinHeader_1x03_P2.54mm_Vertical"
JST_SH_2 = "Connector_JST:JST_SH_SM02B-SRSS-TB_1x02-1MP_P1.00mm_Horizontal"
JST_SH_10 = "Connector_JST:JST_SH_SM10B-SRSS-TB_1x10-1MP_P1.00mm_Horizontal"
JST_PH_2 = "Connector_JST:JST_PH_S2B-PH-K_1x02_P2.00mm_Horizontal"
LOCKING_CONNECTORS = (JST_SH_2, JST_SH_10, JST_PH_2)
"""Footprints of keyed connectors that lock."""
TEST_PAD = "TestPoint:TestPoint_Pad_D1.0mm"
M2_HOLE = "MountingHole:MountingHole_2.2mm_M2"
