"""Sheets of the board variants: signal from left to right, in rows; supply below. Units of 1.27 mm."""

from __future__ import annotations

from fingertip.board.schematic.common_blocks import BRIDGE, MOUNTING_HOLES, adc_connector, supply_block
from fingertip.board.schematic.sheet import (
    SGND,
    Label,
    PlacedSymbol,
    PowerSymbol,
    Sheet,
    apply_supply,
    join_blocks,
)
from fingertip.board.supplies import Supply

_ARTICLE_FILTERS = Sheet(
    symbols=(
        PlacedSymbol("C1", 28, 80, 90), PlacedSymbol("R1", 36, 87), PlacedSymbol("U1", 54, 82, unit=1),
        PlacedSymbol("R5", 56, 92, 270), PlacedSymbol("R4", 46, 99), PlacedSymbol("TP2", 64, 82),
        PlacedSymbol("C2", 82, 82, 90), PlacedSymbol("C3", 104, 82, 90), PlacedSymbol("R2", 116, 70, 90),
        PlacedSymbol("R3", 110, 89), PlacedSymbol("U1", 128, 84, unit=2), PlacedSymbol("TP3", 147, 84),
        PlacedSymbol("D1", 154, 84, 180), PlacedSymbol("R6", 162, 91), PlacedSymbol("C4", 172, 91),
        PlacedSymbol("TP4", 177, 84), PlacedSymbol("R7", 183, 84, 90), PlacedSymbol("C8", 190, 91),
        PlacedSymbol("D2", 204, 92, 180),
    ),
    wires=(
        ((14, 80), (25, 80)), ((31, 80), (48, 80)), ((36, 80), (36, 84)),
        ((48, 84), (46, 84), (46, 96)), ((46, 92), (53, 92)), ((59, 92), (64, 92), (64, 82)), ((60, 82), (79, 82)),
        ((85, 82), (101, 82)), ((98, 82), (98, 70), (113, 70)), ((119, 70), (136, 70), (136, 84), (136, 92), (120, 92),
        (120, 86), (122, 86)), ((107, 82), (122, 82)), ((110, 82), (110, 86)), ((134, 84), (151, 84)),
        ((157, 84), (180, 84)), ((162, 84), (162, 88)), ((172, 84), (172, 88)),
        ((186, 84), (211, 84)), ((190, 84), (190, 88)), ((204, 84), (204, 88)),
        ((198, 92), (198, 91)), ((210, 92), (210, 93)),
    ),
    power_symbols=(
        PowerSymbol(SGND, 36, 90), PowerSymbol(SGND, 46, 102), PowerSymbol(SGND, 110, 92), PowerSymbol(SGND, 162, 94),
        PowerSymbol(SGND, 172, 94), PowerSymbol("GND", 190, 94), PowerSymbol("VCC", 198, 91),
        PowerSymbol("GND", 210, 93),
    ),
    labels=(
        Label("TACTILE", 14, 80), Label("STAGE1_IN", 37, 80), Label("FEEDBACK", 46, 95, 180),
        Label("STAGE1_OUT", 67, 82), Label("STAGE2_MID", 87, 82), Label("STAGE2_IN", 111, 82),
        Label("FILTERED", 137, 84), Label("ENVELOPE", 163, 84), Label("ADC_ENVELOPE", 191, 84),
    ),
    texts=(
        ("First-order high-pass with gain (eqs. 1, 2)", 12, 70),
        ("Sallen-Key high-pass (eqs. 3, 4)", 98, 65),
        ("Peak detector (eq. 11)", 148, 74),
        ("Envelope to the converter", 178, 74),
    ),
)  # fmt: skip

_PRECISION_FILTERS = Sheet(
    symbols=(
        PlacedSymbol("C1", 28, 80, 90), PlacedSymbol("R1", 36, 87), PlacedSymbol("U1", 54, 82, unit=1),
        PlacedSymbol("R5", 56, 92, 270), PlacedSymbol("C20", 56, 100, 270), PlacedSymbol("R4", 46, 99),
        PlacedSymbol("C14", 37, 102, 90), PlacedSymbol("TP2", 64, 82), PlacedSymbol("C2", 82, 82, 90),
        PlacedSymbol("C3", 104, 82, 90), PlacedSymbol("R2", 116, 70, 90), PlacedSymbol("R3", 110, 89),
        PlacedSymbol("U1", 128, 84, unit=2), PlacedSymbol("TP3", 147, 84), PlacedSymbol("TP4", 174, 84),
        PlacedSymbol("R7", 183, 84, 90), PlacedSymbol("C8", 190, 91), PlacedSymbol("D2", 204, 92, 180),
    ),
    wires=(
        ((14, 80), (25, 80)), ((31, 80), (48, 80)), ((36, 80), (36, 84)),
        ((48, 84), (46, 84), (46, 96)), ((46, 92), (53, 92)), ((59, 92), (64, 92), (64, 82)), ((60, 82), (79, 82)),
        ((46, 102), (40, 102)), ((34, 102), (30, 102)),
        ((52, 92), (52, 100), (53, 100)), ((59, 100), (60, 100), (60, 92)),
        ((85, 82), (101, 82)), ((98, 82), (98, 70), (113, 70)),
        ((119, 70), (136, 70), (136, 84), (136, 92), (120, 92), (120, 86), (122, 86)),
        ((107, 82), (122, 82)), ((110, 82), (110, 86)), ((134, 84), (147, 84)),
        ((162, 84), (180, 84)), ((186, 84), (211, 84)), ((190, 84), (190, 88)),
        ((204, 84), (204, 88)), ((198, 92), (198, 91)), ((210, 92), (210, 93)),
    ),
    power_symbols=(
        PowerSymbol(SGND, 36, 90), PowerSymbol(SGND, 30, 102), PowerSymbol(SGND, 110, 92), PowerSymbol("GND", 190, 94),
        PowerSymbol("VCC", 198, 91), PowerSymbol("GND", 210, 93),
    ),
    labels=(
        Label("TACTILE", 14, 80), Label("STAGE1_IN", 37, 80), Label("FEEDBACK", 46, 95, 180), Label("SERIES", 40, 102),
        Label("STAGE1_OUT", 67, 82), Label("STAGE2_MID", 87, 82), Label("STAGE2_IN", 111, 82),
        Label("FILTERED", 137, 84), Label("ENVELOPE", 162, 84), Label("ADC_ENVELOPE", 191, 84),
    ),
    texts=(
        ("First-order high-pass with gain (eqs. 1, 2); C14: no offset, C20: less noise", 12, 70),
        ("Sallen-Key high-pass (eqs. 3, 4)", 98, 65),
        ("Envelope to the converter", 166, 74),
    ),
)  # fmt: skip

_RECTIFIER = Sheet(
    symbols=(
        PlacedSymbol("R15", 112, 116, 90), PlacedSymbol("U3", 130, 114, unit=1), PlacedSymbol("D4", 130, 123),
        PlacedSymbol("D1", 153, 114), PlacedSymbol("R16", 134, 128, 90), PlacedSymbol("R17", 165, 114, 90),
        PlacedSymbol("U3", 185, 112, unit=2), PlacedSymbol("R6", 185, 120, 90), PlacedSymbol("C4", 185, 127, 90),
    ),
    wires=(
        ((100, 116), (109, 116)), ((115, 116), (124, 116)), ((118, 116), (118, 123), (118, 128), (131, 128)),
        ((118, 123), (127, 123)), ((133, 123), (139, 123), (139, 114)), ((136, 114), (150, 114)),
        ((137, 128), (159, 128), (159, 114)), ((156, 114), (162, 114)), ((168, 114), (179, 114)),
        ((173, 114), (173, 120), (173, 127), (182, 127)), ((173, 120), (182, 120)),
        ((188, 120), (195, 120)), ((188, 127), (195, 127), (195, 120), (195, 112)), ((191, 112), (197, 112)),
        ((124, 112), (122, 112), (122, 110)), ((179, 110), (177, 110), (177, 108)),
    ),
    power_symbols=(PowerSymbol(SGND, 122, 110, 180), PowerSymbol(SGND, 177, 108, 180)),
    labels=(
        Label("FILTERED", 100, 116), Label("RECT_IN", 120, 128), Label("RECT_OUT", 140, 114),
        Label("RECTIFIED", 141, 128), Label("LP_IN", 174, 120), Label("ENVELOPE", 197, 112),
    ),
    texts=(("Half-wave rectifier without dead zone", 126, 104), ("Envelope: one pole (eq. 11)", 181, 104)),
)  # fmt: skip

_COMPARATOR = Sheet(
    symbols=(
        PlacedSymbol("R18", 78, 143, 90), PlacedSymbol("C17", 86, 146), PlacedSymbol("R19", 100, 135),
        PlacedSymbol("RV1", 100, 142), PlacedSymbol("R20", 116, 131, 90), PlacedSymbol("U4", 120, 144),
        PlacedSymbol("R21", 130, 140),
    ),
    wires=(
        ((66, 143), (75, 143)), ((81, 143), (86, 143), (94, 143), (94, 150), (110, 150), (110, 146), (114, 146)),
        ((100, 138), (100, 139)), ((103, 142), (109, 142), (114, 142)), ((109, 142), (109, 131), (113, 131)),
        ((119, 131), (126, 131), (126, 144)), ((126, 144), (134, 144)), ((130, 143), (130, 144)),
    ),
    power_symbols=(
        PowerSymbol(SGND, 86, 149, 90), PowerSymbol("VCC", 100, 132), PowerSymbol(SGND, 100, 145, 90),
        PowerSymbol("VCC", 118, 138), PowerSymbol("GND", 118, 150), PowerSymbol("VCC", 130, 137),
    ),
    labels=(
        Label("ENVELOPE", 66, 143), Label("MEAN", 95, 150), Label("THRESHOLD", 103, 142),
        Label("TRIM_TOP", 100, 138, 180), Label("SLIP", 134, 144),
    ),
    texts=(("SLIP: low while it slips", 62, 138),),
)  # fmt: skip


def article_sheet(supply: Supply) -> Sheet:
    """Sheet of variant `article`: the article's filters and peak detector."""
    positive = ("C10", "C5", "C12", *(("C22",) if supply.signal_ground_ratio else ()))
    supply_rails = supply_block(supply, positive, ("C11", "C6", "C13"), ("U1",))
    sheet = join_blocks(BRIDGE, adc_connector(supply), _ARTICLE_FILTERS, supply_rails, MOUNTING_HOLES)
    return apply_supply(sheet, supply)


def precision_sheet(supply: Supply) -> Sheet:
    """Sheet of variant `precision`: rectifier and envelope are in a row of their own."""
    positive = ("C10", "C5", "C12", "C15", *(("C22",) if supply.signal_ground_ratio else ()))
    supply_rails = supply_block(supply, positive, ("C11", "C6", "C13", "C16"), ("U1", "U3"))
    sheet = join_blocks(BRIDGE, adc_connector(supply), _PRECISION_FILTERS, _RECTIFIER, supply_rails, MOUNTING_HOLES)
    return apply_supply(sheet, supply)


def comparator_sheet(supply: Supply) -> Sheet:
    """Sheet of variant `comparator`: that of `precision`, with the comparator in a row below."""
    positive = ("C10", "C5", "C12", "C15", "C18", *(("C22",) if supply.signal_ground_ratio else ()))
    supply_rails = supply_block(supply, positive, ("C11", "C6", "C13", "C16"), ("U1", "U3"))
    sheet = join_blocks(
        BRIDGE, adc_connector(supply, has_slip_output=True), _PRECISION_FILTERS, _RECTIFIER, supply_rails, _COMPARATOR,
        MOUNTING_HOLES,
    )  # fmt: skip
    return apply_supply(sheet, supply)
