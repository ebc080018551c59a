"""The sheet of variant `paper`: signal from left to right, in three rows; supply below. Units of 1.27 mm."""

from __future__ import annotations

from fingertip.board.sheet import Label, Mark, Placed, Sheet

# A row's parts, wires, power symbols and labels stand together, as they are looked at together.
BRIDGE = Sheet(
    placed=(
        Placed("J1", 16, 46, mirrored=True), Placed("C7", 28, 53), Placed("R11", 36, 53), Placed("R10", 36, 39),
        Placed("R12", 50, 23), Placed("R13", 50, 33), Placed("R14", 58, 40), Placed("U2", 78, 40),
        Placed("TP1", 100, 40), Placed("R8", 112, 40, 90), Placed("C9", 122, 47), Placed("D3", 138, 48, 180),
        Placed("J3", 222, 62),
    ),
    wires=(
        ((20, 46), (68, 46), (68, 44), (72, 44)), ((20, 48), (20, 56)), ((28, 46), (28, 50)),
        ((36, 42), (36, 46), (36, 50)),
        ((50, 26), (50, 30)), ((50, 28), (66, 28), (66, 36), (72, 36)),
        ((58, 37), (70, 37), (70, 38), (72, 38)), ((58, 43), (70, 43), (70, 42), (72, 42)),
        ((82, 46), (82, 48)),
        ((88, 40), (109, 40)), ((115, 40), (211, 40), (211, 60), (218, 60)), ((122, 40), (122, 44)),
        ((138, 40), (138, 44)), ((132, 48), (132, 47)), ((144, 48), (144, 49)),
        ((218, 64), (216, 64), (216, 68)), ((218, 66), (216, 66)),
    ),
    marks=(
        Mark("GND", 20, 56), Mark("GND", 28, 56), Mark("GND", 36, 56), Mark("VCC", 36, 36), Mark("VCC", 50, 20),
        Mark("GND", 50, 36), Mark("VCC", 78, 34), Mark("VEE", 78, 46, 180), Mark("GND", 82, 48),
        Mark("GND", 122, 50), Mark("VCC", 132, 47), Mark("GND", 144, 49), Mark("GND", 216, 68),
    ),
    labels=(
        Label("SENSOR", 40, 46), Label("REFERENCE", 52, 28), Label("GAIN_A", 60, 37), Label("GAIN_B", 64, 43),
        Label("TACTILE", 89, 40), Label("ADC_TACTILE", 150, 40),
    ),
    words=(
        ("Bridge and amplifier: voltage falls with force", 12, 12),
        ("Tactile voltage to the converter", 106, 30),
    ),
)  # fmt: skip

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
        Mark("GND", 36, 90), Mark("GND", 46, 102), Mark("GND", 110, 92), Mark("GND", 162, 94), Mark("GND", 172, 94),
        Mark("GND", 190, 94), Mark("VCC", 198, 91), Mark("GND", 210, 93),
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

_SUPPLY = Sheet(
    placed=(
        Placed("J2", 16, 124, mirrored=True), Placed("C10", 36, 120), Placed("C11", 36, 128), Placed("C5", 48, 120),
        Placed("C6", 48, 128), Placed("C12", 60, 120), Placed("C13", 60, 128), Placed("U1", 86, 124, unit=3),
        Placed("TP5", 74, 124),
    ),
    wires=(
        ((20, 122), (24, 122), (24, 114), (84, 114), (84, 118)), ((20, 124), (74, 124)),
        ((20, 126), (24, 126), (24, 134), (84, 134), (84, 130)),
        ((36, 114), (36, 117)), ((48, 114), (48, 117)), ((60, 114), (60, 117)),
        ((36, 123), (36, 124), (36, 125)), ((48, 123), (48, 124), (48, 125)), ((60, 123), (60, 124), (60, 125)),
        ((36, 131), (36, 134)), ((48, 131), (48, 134)), ((60, 131), (60, 134)),
    ),
    marks=(
        Mark("VCC", 28, 114), Mark("PWR_FLAG", 70, 114), Mark("GND", 28, 124), Mark("PWR_FLAG", 68, 124),
        Mark("VEE", 28, 134, 180), Mark("PWR_FLAG", 70, 134, 180),
    ),
    labels=(),
    words=(("Supply and decoupling: one pair at the entry, at U1 and at U2", 12, 107),),
)  # fmt: skip

MOUNTING = Sheet(
    placed=tuple(Placed(f"H{i}", 92 + 10 * i, 146) for i in range(1, 5)),
    wires=(),
    marks=(),
    labels=(),
    words=(("Mounting", 100, 138),),
)


def joined(*rows: Sheet) -> Sheet:
    """Several rows as one sheet."""
    return Sheet(
        placed=tuple(item for row in rows for item in row.placed),
        wires=tuple(item for row in rows for item in row.wires),
        marks=tuple(item for row in rows for item in row.marks),
        labels=tuple(item for row in rows for item in row.labels),
        words=tuple(item for row in rows for item in row.words),
    )


PAPER_SHEET = joined(BRIDGE, _FILTERS, _SUPPLY, MOUNTING)
"""The whole sheet."""
