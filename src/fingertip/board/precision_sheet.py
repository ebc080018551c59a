"""The sheet of variant `precision`: as `paper`'s, with rectifier and envelope on a row of their own."""

from __future__ import annotations

from fingertip.board.paper_sheet import BRIDGE, MOUNTING, joined
from fingertip.board.sheet import Label, Mark, Placed, Sheet

FILTERS = Sheet(
    placed=(
        Placed("C1", 28, 80, 90), Placed("R1", 36, 87), Placed("U1", 54, 82, unit=1), Placed("R5", 56, 92, 270),
        Placed("R4", 46, 99), Placed("C14", 35, 102, 90), Placed("TP2", 64, 82), Placed("C2", 82, 82, 90),
        Placed("C3", 104, 82, 90), Placed("R2", 116, 70, 90), Placed("R3", 110, 89), Placed("U1", 128, 84, unit=2),
        Placed("TP3", 147, 84), Placed("TP4", 174, 84), Placed("R7", 183, 84, 90), Placed("C8", 190, 91),
        Placed("D2", 204, 92, 180),
    ),
    wires=(
        ((14, 80), (25, 80)), ((31, 80), (48, 80)), ((36, 80), (36, 84)),
        ((48, 84), (46, 84), (46, 96)), ((46, 92), (53, 92)), ((59, 92), (64, 92), (64, 82)), ((60, 82), (79, 82)),
        ((46, 102), (38, 102)), ((32, 102), (30, 102)),
        ((85, 82), (101, 82)), ((98, 82), (98, 70), (113, 70)),
        ((119, 70), (136, 70), (136, 84), (136, 92), (120, 92), (120, 86), (122, 86)),
        ((107, 82), (122, 82)), ((110, 82), (110, 86)), ((134, 84), (147, 84)),
        ((162, 84), (180, 84)), ((186, 84), (211, 84), (211, 62), (218, 62)), ((190, 84), (190, 88)),
        ((204, 84), (204, 88)), ((198, 92), (198, 91)), ((210, 92), (210, 93)),
    ),
    marks=(
        Mark("GND", 36, 90), Mark("GND", 30, 102), Mark("GND", 110, 92), Mark("GND", 190, 94), Mark("VCC", 198, 91),
        Mark("GND", 210, 93),
    ),
    labels=(
        Label("TACTILE", 14, 80), Label("STAGE1_IN", 37, 80), Label("FEEDBACK", 46, 95, 180),
        Label("SERIES", 39, 102), Label("STAGE1_OUT", 67, 82), Label("STAGE2_MID", 87, 82), Label("STAGE2_IN", 111, 82),
        Label("FILTERED", 137, 84), Label("ENVELOPE", 162, 84), Label("ADC_ENVELOPE", 191, 84),
    ),
    words=(
        ("First-order high-pass with gain (eqs. 1, 2); C14 blocks its offset", 12, 70),
        ("Sallen-Key high-pass (eqs. 3, 4)", 98, 65),
        ("Envelope to the converter", 166, 74),
    ),
)  # fmt: skip

RECTIFIER = Sheet(
    placed=(
        Placed("R15", 112, 116, 90), Placed("U3", 130, 114, unit=1), Placed("D4", 130, 123), Placed("D1", 153, 114),
        Placed("R16", 134, 128, 90), Placed("R17", 165, 114, 90), Placed("U3", 185, 112, unit=2),
        Placed("R6", 185, 120, 90), Placed("C4", 185, 126, 90),
    ),
    wires=(
        ((100, 116), (109, 116)), ((115, 116), (124, 116)), ((118, 116), (118, 123), (118, 128), (131, 128)),
        ((118, 123), (127, 123)), ((133, 123), (139, 123), (139, 114)), ((136, 114), (150, 114)),
        ((137, 128), (159, 128), (159, 114)), ((156, 114), (162, 114)), ((168, 114), (179, 114)),
        ((173, 114), (173, 120), (173, 126), (182, 126)), ((173, 120), (182, 120)),
        ((188, 120), (195, 120)), ((188, 126), (195, 126), (195, 120), (195, 112)), ((191, 112), (197, 112)),
        ((124, 112), (122, 112), (122, 110)), ((179, 110), (177, 110), (177, 108)),
    ),
    marks=(Mark("GND", 122, 110, 180), Mark("GND", 177, 108, 180)),
    labels=(
        Label("FILTERED", 100, 116), Label("RECT_IN", 120, 128), Label("RECT_OUT", 140, 114),
        Label("RECTIFIED", 141, 128), Label("LP_IN", 174, 120), Label("ENVELOPE", 197, 112),
    ),
    words=(("Half-wave rectifier without dead zone", 126, 104), ("Envelope: one pole (eq. 11)", 181, 104)),
)  # fmt: skip

SUPPLY = Sheet(
    placed=(
        Placed("J2", 16, 124, mirrored=True), Placed("C10", 34, 120), Placed("C11", 34, 128), Placed("C5", 45, 120),
        Placed("C6", 45, 128), Placed("C12", 56, 120), Placed("C13", 56, 128), Placed("C15", 67, 120),
        Placed("C16", 67, 128), Placed("U1", 84, 124, unit=3), Placed("U3", 94, 124, unit=3), Placed("TP5", 77, 124),
    ),
    wires=(
        ((20, 122), (24, 122), (24, 114), (82, 114), (92, 114), (92, 118)), ((82, 114), (82, 118)),
        ((20, 124), (77, 124)),
        ((20, 126), (24, 126), (24, 134), (82, 134), (92, 134), (92, 130)), ((82, 134), (82, 130)),
        *(((x, 114), (x, 117)) for x in (34, 45, 56, 67)),
        *(((x, 123), (x, 124), (x, 125)) for x in (34, 45, 56, 67)),
        *(((x, 131), (x, 134)) for x in (34, 45, 56, 67)),
    ),
    marks=(
        Mark("VCC", 28, 114), Mark("PWR_FLAG", 76, 114), Mark("GND", 28, 124), Mark("PWR_FLAG", 52, 124),
        Mark("VEE", 28, 134, 180), Mark("PWR_FLAG", 76, 134, 180),
    ),
    labels=(),
    words=(("Supply and decoupling", 12, 108),),
)  # fmt: skip

PRECISION_SHEET = joined(BRIDGE, FILTERS, RECTIFIER, SUPPLY, MOUNTING)
"""The whole sheet."""
