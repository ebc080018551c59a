"""The symbols and footprints used, out of KiCad's own libraries: names that have long been there.

Pins are copied here so that a netlist needs no KiCad; a test holds them against those of KiCad 9.
"""

from __future__ import annotations

from fingertip.board.circuit import Pin, Symbol


def _passive(*names: str) -> tuple[Pin, ...]:
    return tuple(Pin(str(number), name, "passive") for number, name in enumerate(names, start=1))


RESISTOR = Symbol("Device", "R", "Resistor", _passive("~", "~"))
CAPACITOR = Symbol("Device", "C", "Unpolarized capacitor", _passive("~", "~"))
DIODE_1N4148 = Symbol("Diode", "1N4148", "Standard switching diode, DO-35", _passive("K", "A"))
CONNECTOR_2 = Symbol("Connector_Generic", "Conn_01x02", "Generic connector, 1x2", _passive("Pin_1", "Pin_2"))
CONNECTOR_3 = Symbol("Connector_Generic", "Conn_01x03", "Generic connector, 1x3", _passive("Pin_1", "Pin_2", "Pin_3"))
TL082 = Symbol(
    "Amplifier_Operational",
    "TL082",
    "Dual JFET-input operational amplifier, SOIC-8",
    (
        Pin("1", "~", "output"),
        Pin("2", "-", "input"),
        Pin("3", "+", "input"),
        Pin("4", "V-", "power_in"),
        Pin("5", "+", "input"),
        Pin("6", "-", "input"),
        Pin("7", "~", "output"),
        Pin("8", "V+", "power_in"),
    ),
)

R_0603 = "Resistor_SMD:R_0603_1608Metric"
C_0603 = "Capacitor_SMD:C_0603_1608Metric"
C_1206 = "Capacitor_SMD:C_1206_3216Metric"
DO_35 = "Diode_THT:D_DO-35_SOD27_P7.62mm_Horizontal"
SOIC_8 = "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm"
HEADER_2 = "Connector_PinHeader_2.54mm:PinHeader_1x02_P2.54mm_Vertical"
HEADER_3 = "Connector_PinHeader_2.54mm:PinHeader_1x03_P2.54mm_Vertical"
