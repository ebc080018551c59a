"""Symbols and footprints used, by their long-standing names in KiCad's own libraries.

`symbols.json` is a copy of the pins, so that writing a netlist does not need KiCad. A test compares
it with KiCad 9.
"""

from __future__ import annotations

import json
from pathlib import Path

from fingertip.board.parts.circuit import Pin, Symbol

SYMBOLS = {
    row["name"]: Symbol(
        row["library"], row["name"], row["description"], tuple(Pin(*pin) for pin in row["pins"])
    )
    for row in json.loads((Path(__file__).parent / "symbols.json").read_text("utf-8"))
}
RESISTOR = SYMBOLS["R"]
CAPACITOR = SYMBOLS["C"]
DUAL_AMPLIFIERS = {
    "TL082": SYMBOLS["TL082"],
    "TLV2372": SYMBOLS["TLV2372"],
    "MCP6022": SYMBOLS["MCP6022"],
    "OPA2376": SYMBOLS["OPA2376xxD"],
    "OPA2197": SYMBOLS["LM2904"],
}
"""Dual amplifiers for the filter and the rectifier, by name."""

SOT_23_5 = "Package_TO_SOT_SMD:SOT-23-5"
TC33X = "Potentiometer_SMD:Potentiometer_Bourns_TC33X_Vertical"
R_0603 = "Resistor_SMD:R_0603_1608Metric"
C_0603 = "Capacitor_SMD:C_0603_1608Metric"
C_1206 = "Capacitor_SMD:C_1206_3216Metric"
C_0805 = "Capacitor_SMD:C_0805_2012Metric"
SOD_123 = "Diode_SMD:D_SOD-123"
SOD_323 = "Diode_SMD:D_SOD-323"
SOT_23 = "Package_TO_SOT_SMD:SOT-23"
MSOP_8 = "Package_SO:MSOP-8_3x3mm_P0.65mm"
SOIC_8 = "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm"
HEADER_2 = "Connector_PinHeader_2.54mm:PinHeader_1x02_P2.54mm_Vertical"
HEADER_4 = "Connector_PinHeader_2.54mm:PinHeader_1x04_P2.54mm_Vertical"
HEADER_3 = "Connector_PinHeader_2.54mm:PinHeader_1x03_P2.54mm_Vertical"
JST_SH_2 = "Connector_JST:JST_SH_SM02B-SRSS-TB_1x02-1MP_P1.00mm_Horizontal"
JST_SH_3 = "Connector_JST:JST_SH_SM03B-SRSS-TB_1x03-1MP_P1.00mm_Horizontal"
JST_SH_4 = "Connector_JST:JST_SH_SM04B-SRSS-TB_1x04-1MP_P1.00mm_Horizontal"
JST_SH_15 = "Connector_JST:JST_SH_SM15B-SRSS-TB_1x15-1MP_P1.00mm_Horizontal"
LOCKING_CONNECTORS = (JST_SH_2, JST_SH_3, JST_SH_4, JST_SH_15)
"""Footprints of keyed connectors that lock."""
TEST_PAD = "TestPoint:TestPoint_Pad_D1.0mm"
M2_HOLE = "MountingHole:MountingHole_2.2mm_M2"
