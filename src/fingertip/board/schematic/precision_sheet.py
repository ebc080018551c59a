"""The sheet of variant `precision`: as `article`'s, with rectifier and envelope on a row of their own."""

from __future__ import annotations

from fingertip.board.schematic.common_sheet import BRIDGE, MOUNTING, connector, joined, supply_row
from fingertip.board.schematic.sheet import Label, Mark, Placed, Sheet, supplied
from fingertip.board.supplies import Supply

FILTERS = Sheet(
    placed=(
        Placed("C1", 28, 80, 90), Placed("R1", 36, 87), Placed("U1", 54, 82, unit=1), Placed("R5", 56, 92, 270),
        Placed("C20", 56, 100, 270), Placed("R4", 46, 99), Placed("C14", 37, 102, 90), Placed("TP2", 64, 82),
        Placed("C2", 82, 82, 90), Placed("C3", 104, 82, 90), Placed("R2", 116, 70, 90), Placed("R3", 110, 89),
        Placed("U1", 128, 84, unit=2), Placed("TP3", 147, 84), Placed("TP4", 174, 84), Placed("R7", 183, 84, 90),
        Placed("C8", 190, 91), Placed("D2", 204, 92, 180),
    ),
    wires=(
        ((14, 80), (25, 80)), ((31, 80), (48, 80)), ((36, 80), (36, 84)),
        ((48, 84), (46, 84), (46, 96)), ((46, 92), (53, 92)), ((59, 92), (64, 92), (64, 82)), ((60, 82), (79, 82)),
        ((46, 102), (40, 102)), ((34, 102), (30, 102)),
        ((52, 92), (52, 100), (53, 100)), ((59, 100), (60, 100), (60, 92)),
        ((85, 82), (101, 82)), ((98, 82), (98, 70), (113, 70)),
        ((119, 70), (136, 70), (136, 84), (136, 92), (120, 92), (120, 86), (122, 86)),
        ((107, 82), (122, 82)), ((110, 82), (110, 86)), ((134, 84), (147, 84)),
        ((162, 84), (180, 84)), ((186, 84), (211, 84), (211, 62), (218, 62)), ((190, 84), (190, 88)),
        ((204, 84), (204, 88)), ((198, 92), (198, 91)), ((210, 92), (210, 93)),
    ),
    marks=(
        Mark("ZERO", 36, 90), Mark("ZERO", 30, 102), Mark("ZERO", 110, 92), Mark("GND", 190, 94), Mark("VCC", 198, 91),
        Mark("GND", 210, 93),
    ),
    labels=(
        Label("TACTILE", 14, 80), Label("STAGE1_IN", 37, 80), Label("FEEDBACK", 46, 95, 180),
        Label("SERIES", 40, 102), Label("STAGE1_OUT", 67, 82), Label("STAGE2_MID", 87, 82), Label("STAGE2_IN", 111, 82),
        Label("FILTERED", 137, 84), Label("ENVELOPE", 162, 84), Label("ADC_ENVELOPE", 191, 84),
    ),
    words=(
        ("First-order high-pass with gain (eqs. 1, 2); C14: no offset, C20: less noise", 12, 70),
        ("Sallen-Key high-pass (eqs. 3, 4)", 98, 65),
        ("Envelope to the converter", 166, 74),
    ),
)  # fmt: skip

RECTIFIER = Sheet(
    placed=(
        Placed("R15", 112, 116, 90), Placed("U3", 130, 114, unit=1), Placed("D4", 130, 123), Placed("D1", 153, 114),
        Placed("R16", 134, 128, 90), Placed("R17", 165, 114, 90), Placed("U3", 185, 112, unit=2),
        Placed("R6", 185, 120, 90), Placed("C4", 185, 127, 90),
    ),
    wires=(
        ((100, 116), (109, 116)), ((115, 116), (124, 116)), ((118, 116), (118, 123), (118, 128), (131, 128)),
        ((118, 123), (127, 123)), ((133, 123), (139, 123), (139, 114)), ((136, 114), (150, 114)),
        ((137, 128), (159, 128), (159, 114)), ((156, 114), (162, 114)), ((168, 114), (179, 114)),
        ((173, 114), (173, 120), (173, 127), (182, 127)), ((173, 120), (182, 120)),
        ((188, 120), (195, 120)), ((188, 127), (195, 127), (195, 120), (195, 112)), ((191, 112), (197, 112)),
        ((124, 112), (122, 112), (122, 110)), ((179, 110), (177, 110), (177, 108)),
    ),
    marks=(Mark("ZERO", 122, 110, 180), Mark("ZERO", 177, 108, 180)),
    labels=(
        Label("FILTERED", 100, 116), Label("RECT_IN", 120, 128), Label("RECT_OUT", 140, 114),
        Label("RECTIFIED", 141, 128), Label("LP_IN", 174, 120), Label("ENVELOPE", 197, 112),
    ),
    words=(("Half-wave rectifier without dead zone", 126, 104), ("Envelope: one pole (eq. 11)", 181, 104)),
)  # fmt: skip


def precision_sheet(supply: Supply) -> Sheet:
    """The whole sheet."""
    plus = ("C10", "C5", "C12", "C15", *(("C22",) if supply.zero_share else ()))
    row = supply_row(supply, plus, ("C11", "C6", "C13", "C16"), ("U1", "U3"))
    return supplied(joined(BRIDGE, connector(supply), FILTERS, RECTIFIER, row, MOUNTING), supply)
