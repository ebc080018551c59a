"""Rows that the sheets of all variants have: bridge, way to the converter, supply. Units of 1.27 mm.

ZERO stands for whatever signals rest at, MINUS for what the amplifiers' negative pins hang on: `sheet.supplied` puts
the supply's own in their place.
"""

from __future__ import annotations

from collections.abc import Sequence

from fingertip.board.schematic.sheet import GlobalLabel, Label, Mark, Placed, Sheet
from fingertip.board.supplies import Supply

# A row's parts, wires, power symbols and labels stand together, as they are looked at together.
BRIDGE = Sheet(
    placed=(
        Placed("J1", 16, 46, mirrored=True), Placed("C7", 28, 53), Placed("R11", 36, 53), Placed("R10", 36, 39),
        Placed("R12", 50, 23), Placed("R13", 50, 33), Placed("R14", 58, 40), Placed("U2", 78, 40),
        Placed("TP1", 100, 40), Placed("R8", 112, 40, 90), Placed("C9", 122, 47), Placed("R9", 132, 40, 90),
        Placed("C19", 142, 47), Placed("D3", 160, 48, 180),
    ),
    wires=(
        ((20, 46), (68, 46), (68, 44), (72, 44)), ((20, 48), (20, 56)), ((28, 46), (28, 50)),
        ((36, 42), (36, 46), (36, 50)),
        ((50, 26), (50, 30)), ((50, 28), (66, 28), (66, 36), (72, 36)),
        ((58, 37), (70, 37), (70, 38), (72, 38)), ((58, 43), (70, 43), (70, 42), (72, 42)),
        ((82, 46), (82, 48)),
        ((88, 40), (109, 40)), ((115, 40), (129, 40)), ((122, 40), (122, 44)),
        ((135, 40), (211, 40), (211, 60), (218, 60)), ((142, 40), (142, 44)),
        ((160, 40), (160, 44)), ((154, 48), (154, 47)), ((166, 48), (166, 49)),
    ),
    marks=(
        Mark("ZERO", 20, 56), Mark("ZERO", 28, 56), Mark("ZERO", 36, 56), Mark("VCC", 36, 36), Mark("VCC", 50, 20),
        Mark("ZERO", 50, 36), Mark("VCC", 78, 34), Mark("MINUS", 78, 46), Mark("ZERO", 82, 48),
        Mark("GND", 122, 50), Mark("GND", 142, 50), Mark("VCC", 154, 47), Mark("GND", 166, 49),
    ),
    labels=(
        Label("SENSOR", 40, 46), Label("REFERENCE", 52, 28), Label("GAIN_A", 60, 37), Label("GAIN_B", 60, 43),
        Label("TACTILE", 89, 40), Label("ALIAS_MID", 117, 40), Label("ADC_TACTILE", 172, 40),
    ),
    words=(
        ("Bridge and amplifier: voltage falls with force", 12, 12),
        ("Tactile voltage to the converter: two poles, clamp", 106, 30),
    ),
)  # fmt: skip

MOUNTING = Sheet(
    placed=tuple(Placed(f"H{i}", 197 + 6 * i, 123) for i in range(1, 5)), wires=(), marks=(), labels=(),
    words=(("Mounting", 201, 116),),
)  # fmt: skip


def connector(supply: Supply, slip: bool = False) -> Sheet:
    """J3; its fourth pin is SLIP or ground, its fifth what signals rest at where that is not ground."""
    pin_4: Sheet
    if slip:
        pin_4 = Sheet((), (((218, 66), (216, 66), (216, 76)), ((218, 64), (214, 64))), (Mark("GND", 214, 64),),
                      (Label("SLIP", 216, 76, 180),), ())  # fmt: skip
    else:
        pin_4 = Sheet((), (((218, 64), (216, 64), (216, 68)), ((218, 66), (216, 66))), (Mark("GND", 216, 68),), (), ())
    if not supply.zero_share:
        return joined(Sheet((Placed("J3", 222, 62),), (), (), (), ()), pin_4)
    middle = Sheet((Placed("J3", 222, 64), Placed("R24", 218, 89)), (((218, 68), (218, 86)),), (),
                   (Label("M_OUT", 218, 82),), (), (GlobalLabel(supply.zero, 218, 92, 270),))  # fmt: skip
    return joined(middle, pin_4)


def supply_row(supply: Supply, plus: Sequence[str], minus: Sequence[str], amplifiers: Sequence[str]) -> Sheet:
    """J2, capacitors between the rails (those of `minus` below), the amplifiers' supply pins; the supply's middle."""
    columns = [30 + 9 * i for i in range(len(plus))]
    placed = [Placed(reference, x, 120) for reference, x in zip(plus, columns, strict=True)]
    placed += [Placed(reference, 88 + 9 * i, 124, unit=3) for i, reference in enumerate(amplifiers)]
    pins = [86 + 9 * i for i in range(len(amplifiers))]
    ends = (79, 114), *((x, 114) for x in pins)
    wires = [((20, 122), (24, 122), (24, 114), *ends), *(((x, 114), (x, 118)) for x in pins)]
    wires += [((x, 114), (x, 117)) for x in columns] + [((x, 123), (x, 124)) for x in columns]
    marks = [Mark("VCC", 26, 114), Mark("PWR_FLAG", 79, 114), Mark("GND", 26, 124)]
    row = Sheet(tuple(placed), tuple(wires), tuple(marks), (), (("Supply and decoupling", 12, 108),))
    if supply.zero_share:
        ground = Sheet(
            (Placed("J2", 16, 122, mirrored=True),), (((20, 124), (83, 124)),),
            (*(Mark("GND", x, 130) for x in pins), Mark("PWR_FLAG", 83, 124)), (), (),
        )  # fmt: skip
        return joined(row, ground, _MIDDLE)
    lower = columns[: len(minus)]
    below = Sheet(
        (
            Placed("J2", 16, 124, mirrored=True), Placed("TP5", 79, 124),
            *(Placed(reference, x, 128) for reference, x in zip(minus, lower, strict=True)),
        ),
        (
            ((20, 124), (79, 124)), ((20, 126), (24, 126), (24, 134), (74, 134), *((x, 134) for x in pins)),
            *(((x, 134), (x, 130)) for x in pins),
            *(((x, 124), (x, 125)) for x in lower), *(((x, 131), (x, 134)) for x in lower),
        ),
        (Mark("VEE", 26, 134, 180), Mark("PWR_FLAG", 74, 134, 180), Mark("PWR_FLAG", 74, 124)), (), (),
    )  # fmt: skip
    return joined(row, below)


_MIDDLE = Sheet(
    placed=(
        Placed("R22", 18, 136), Placed("R23", 18, 144), Placed("C21", 27, 145), Placed("U5", 44, 142),
        Placed("TP5", 54, 142),
    ),
    wires=(
        ((18, 139), (18, 141)), ((18, 140), (27, 140), (27, 142)), ((27, 140), (38, 140)),
        ((38, 144), (36, 144), (36, 154), (52, 154), (52, 142)), ((50, 142), (54, 142), (56, 142)),
    ),
    marks=(
        Mark("VCC", 18, 133), Mark("GND", 18, 147), Mark("GND", 27, 148), Mark("VCC", 42, 136), Mark("GND", 42, 148),
    ),
    labels=(Label("HALF", 30, 140),),
    words=(("The supply's middle, buffered", 22, 129),),
    globals=(GlobalLabel("VMID", 56, 142),),
)  # fmt: skip


def joined(*rows: Sheet) -> Sheet:
    """Several rows as one sheet."""
    return Sheet(
        placed=tuple(item for row in rows for item in row.placed),
        wires=tuple(item for row in rows for item in row.wires),
        marks=tuple(item for row in rows for item in row.marks),
        labels=tuple(item for row in rows for item in row.labels),
        words=tuple(item for row in rows for item in row.words),
        globals=tuple(item for row in rows for item in row.globals),
    )
