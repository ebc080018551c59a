"""The sheet of variant `article`: signal from left to right, in three rows; supply below. Units of 1.27 mm."""

from __future__ import annotations

from fingertip.board.schematic.common_sheet import BRIDGE, MOUNTING, connector, joined, supply_row
from fingertip.board.schematic.sheet import Label, Mark, Placed, Sheet, supplied
from fingertip.board.supplies import Supply

_FILTERS = Sheet(
    placed=(
        Placed("C1", 28, 80, 90), Placed("R1", 36, 87), Placed("U1", 54, 82, unit=1), Placed("R5", 56, 92, 270),
        Placed("R4", 46, 99), Placed("TP2", 64, 82), Placed("C2", 82, 82, 90), Placed("C3", 104, 82, 90),
        Placed("R2", 116, 70, 90), Placed("R3", 110, 89), Placed("U1", 128, 84, unit=2), Placed("TP3", 147, 84),
        Placed("D1", 154, 84, 180), Placed("R6", 162, 91), Placed("C4", 172, 91), Placed("TP4", 177, 84),
        Placed("R7", 183, 84, 90), Placed("C8", 190, 91), Placed("D2", 204, 92, 180),
    ),
    wires=(
        ((14, 80), (25, 80)), ((31, 80), (48, 80)), ((36, 80), (36, 84)),
        ((48, 84), (46, 84), (46, 96)), ((46, 92), (53, 92)), ((59, 92), (64, 92), (64, 82)), ((60, 82), (79, 82)),
        ((85, 82), (101, 82)), ((98, 82), (98, 70), (113, 70)), ((119, 70), (136, 70), (136, 84), (136, 92), (120, 92),
        (120, 86), (122, 86)), ((107, 82), (122, 82)), ((110, 82), (110, 86)), ((134, 84), (151, 84)),
        ((157, 84), (180, 84)), ((162, 84), (162, 88)), ((172, 84), (172, 88)),
        ((186, 84), (211, 84), (211, 62), (218, 62)), ((190, 84), (190, 88)), ((204, 84), (204, 88)),
        ((198, 92), (198, 91)), ((210, 92), (210, 93)),
    ),
    marks=(
        Mark("ZERO", 36, 90), Mark("ZERO", 46, 102), Mark("ZERO", 110, 92), Mark("ZERO", 162, 94),
        Mark("ZERO", 172, 94), Mark("GND", 190, 94), Mark("VCC", 198, 91), Mark("GND", 210, 93),
    ),
    labels=(
        Label("TACTILE", 14, 80), Label("STAGE1_IN", 37, 80), Label("FEEDBACK", 46, 95, 180),
        Label("STAGE1_OUT", 67, 82), Label("STAGE2_MID", 87, 82), Label("STAGE2_IN", 111, 82),
        Label("FILTERED", 137, 84), Label("ENVELOPE", 163, 84), Label("ADC_ENVELOPE", 191, 84),
    ),
    words=(
        ("First-order high-pass with gain (eqs. 1, 2)", 12, 70),
        ("Sallen-Key high-pass (eqs. 3, 4)", 98, 65),
        ("Peak detector (eq. 11)", 148, 74),
        ("Envelope to the converter", 178, 74),
    ),
)  # fmt: skip


def article_sheet(supply: Supply) -> Sheet:
    """The whole sheet."""
    plus = ("C10", "C5", "C12", *(("C22",) if supply.zero_share else ()))
    row = supply_row(supply, plus, ("C11", "C6", "C13"), ("U1",))
    return supplied(joined(BRIDGE, connector(supply), _FILTERS, row, MOUNTING), supply)
