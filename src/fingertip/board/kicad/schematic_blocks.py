"""Blocks that the sheets of all variants share: bridge, connector to the ADC and supply. Units of 1.27 mm."""

from __future__ import annotations

from collections.abc import Sequence

from fingertip.board.components.supplies import Supply
from fingertip.board.kicad.schematic_sheet import (
    SGND,
    VBRIDGE,
    VNEG,
    GlobalLabel,
    Label,
    PlacedSymbol,
    PowerSymbol,
    Sheet,
    apply_supply,
    join_blocks,
)

BRIDGE = Sheet(
    symbols=(
        PlacedSymbol("J1", 16, 46, mirrored=True), PlacedSymbol("C7", 28, 53), PlacedSymbol("R11", 36, 53),
        PlacedSymbol("R10", 36, 39), PlacedSymbol("R12", 50, 23), PlacedSymbol("R13", 50, 33),
        PlacedSymbol("R14", 58, 40), PlacedSymbol("U2", 78, 40), PlacedSymbol("TP1", 100, 40),
        PlacedSymbol("R8", 112, 40, 90), PlacedSymbol("C9", 122, 47), PlacedSymbol("R9", 132, 40, 90),
        PlacedSymbol("C19", 142, 47), PlacedSymbol("D3", 160, 48, 180),
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
    power_symbols=(
        PowerSymbol(SGND, 20, 56), PowerSymbol(SGND, 28, 56), PowerSymbol(SGND, 36, 56), PowerSymbol(VBRIDGE, 36, 36),
        PowerSymbol(VBRIDGE, 50, 20), PowerSymbol(SGND, 50, 36), PowerSymbol("VCC", 78, 34), PowerSymbol(VNEG, 78, 46),
        PowerSymbol(SGND, 82, 48), PowerSymbol("GND", 122, 50), PowerSymbol("GND", 142, 50),
        PowerSymbol("VCC", 154, 47), PowerSymbol("GND", 166, 49),
    ),
    labels=(
        Label("SENSOR", 40, 46), Label("REFERENCE", 52, 28), Label("GAIN_A", 60, 37), Label("GAIN_B", 60, 43),
        Label("TACTILE", 89, 40), Label("ALIAS_MID", 117, 40), Label("ADC_TACTILE", 172, 40),
    ),
    texts=(
        ("Bridge and amplifier: voltage falls with force", 12, 12),
        ("Tactile voltage to the converter: two poles, clamp", 106, 30),
    ),
)  # fmt: skip

MOUNTING_HOLES = Sheet(
    symbols=tuple(PlacedSymbol(f"H{i}", 197 + 6 * i, 123) for i in range(1, 3)), texts=(("Mounting", 201, 116),)
)


_FILTERED_OUTPUT = Sheet(
    symbols=(
        PlacedSymbol("R27", 153, 60, 90), PlacedSymbol("C25", 160, 67), PlacedSymbol("D5", 182, 68, 180),
    ),
    wires=(
        ((146, 60), (150, 60)), ((156, 60), (208, 60), (208, 64), (218, 64)), ((160, 60), (160, 64)),
        ((182, 60), (182, 64)), ((176, 68), (176, 67)), ((188, 68), (188, 69)),
    ),
    power_symbols=(PowerSymbol("GND", 160, 70), PowerSymbol("VCC", 176, 67), PowerSymbol("GND", 188, 69)),
    labels=(Label("FILTERED", 146, 60, 180), Label("ADC_FILTERED", 190, 60)),
    texts=(("Filtered signal to the converter", 150, 56),),
)  # fmt: skip


def _controller_connector(supply: Supply, has_slip_output: bool) -> Sheet:
    """Connector J3 to the controller: every second pin is ground, and the ninth is the slip output or ground."""
    grounds = (62, 66, 70, 74, 78) if has_slip_output else (62, 66, 70, 74, 76, 78)
    slip = Sheet(wires=(((218, 76), (214, 76)),), labels=(Label("SLIP", 214, 76, 180),)) if has_slip_output else Sheet()
    connector = Sheet(
        symbols=(PlacedSymbol("J3", 222, 68), PlacedSymbol("R24", 218, 95)),
        wires=(
            ((211, 84), (211, 68), (218, 68)), *(((218, y), (216, y)) for y in grounds), ((216, 62), (216, 82)),
            ((218, 72), (214, 72)), ((218, 89), (218, 92)),
        ),
        power_symbols=(PowerSymbol("GND", 216, 82), PowerSymbol("GND", 222, 82), PowerSymbol("GND", 16, 52)),
        labels=(Label("M_OUT", 214, 72, 180), Label("M_OUT", 218, 89)),
        global_labels=(GlobalLabel(supply.signal_ground, 218, 98, 270),),
    )  # fmt: skip
    return join_blocks(connector, slip, _FILTERED_OUTPUT)


def adc_connector(supply: Supply, has_slip_output: bool = False) -> Sheet:
    """Connector J3 to the ADC or the controller, and the end of the envelope's wire.

    The fourth pin of a pin header is the slip output or ground. On a single supply its fifth pin is the signal ground.
    """
    if supply.is_for_controller:
        return _controller_connector(supply, has_slip_output)
    return join_blocks(_pin_header(supply, has_slip_output), Sheet(wires=(((211, 84), (211, 62), (218, 62)),)))


def _pin_header(supply: Supply, has_slip_output: bool) -> Sheet:
    if has_slip_output:
        pin_4 = Sheet(
            wires=(((218, 66), (216, 66), (216, 76)), ((218, 64), (214, 64))),
            power_symbols=(PowerSymbol("GND", 214, 64),),
            labels=(Label("SLIP", 216, 76, 180),),
        )
    else:
        pin_4 = Sheet(
            wires=(((218, 64), (216, 64), (216, 68)), ((218, 66), (216, 66))),
            power_symbols=(PowerSymbol("GND", 216, 68),),
        )
    if not supply.signal_ground_ratio:
        return join_blocks(Sheet(symbols=(PlacedSymbol("J3", 222, 62),)), pin_4)
    with_signal_ground = Sheet(
        symbols=(PlacedSymbol("J3", 222, 64), PlacedSymbol("R24", 218, 89)),
        wires=(((218, 68), (218, 86)),),
        labels=(Label("M_OUT", 218, 82),),
        global_labels=(GlobalLabel(supply.signal_ground, 218, 92, 270),),
    )
    return join_blocks(with_signal_ground, pin_4)


_PLAIN_ENTRY = ((20, 122), (24, 122), (24, 114))
"""Wire from the supply's connector to the rail."""


def supply_block(supply: Supply, positive: Sequence[str], negative: Sequence[str], amplifiers: Sequence[str]) -> Sheet:
    """Supply connector J2, decoupling capacitors and supply pins of the amplifiers."""
    # On a board for a controller the protection stands between the connector and the capacitors.
    first, pitch, entry, flag = (40, 7, ((32, 114),), 37) if supply.is_for_controller else (30, 9, _PLAIN_ENTRY, 79)
    columns = [first + pitch * i for i in range(len(positive))]
    pins = [86 + 9 * i for i in range(len(amplifiers))]
    rail_ends = (79, 114), *((x, 114) for x in pins)
    positive_row = Sheet(
        symbols=(
            *(PlacedSymbol(reference, x, 120) for reference, x in zip(positive, columns, strict=True)),
            *(PlacedSymbol(reference, 88 + 9 * i, 124, unit=3) for i, reference in enumerate(amplifiers)),
        ),
        wires=(
            (*entry, *rail_ends), *(((x, 114), (x, 118)) for x in pins),
            *(((x, 114), (x, 117)) for x in columns), *(((x, 123), (x, 124)) for x in columns),
        ),
        power_symbols=(
            PowerSymbol("VCC", 34 if supply.is_for_controller else 26, 114), PowerSymbol("PWR_FLAG", flag, 114),
            PowerSymbol("GND", 26, 124),
        ),
        texts=(("Supply and decoupling", 12, 108),),
    )  # fmt: skip
    if supply.signal_ground_ratio:
        ground = Sheet(
            symbols=(PlacedSymbol("J2", 16, 122, mirrored=True),),
            wires=(((20, 124), (83, 124)),),
            power_symbols=(*(PowerSymbol("GND", x, 130) for x in pins), PowerSymbol("PWR_FLAG", 83, 124)),
        )
        for_controller = (_PROTECTION, _BRIDGE_SUPPLY) if supply.is_for_controller else ()
        return join_blocks(positive_row, ground, _SUPPLY_MIDPOINT, *for_controller)
    negative_columns = columns[: len(negative)]
    negative_row = Sheet(
        symbols=(
            PlacedSymbol("J2", 16, 124, mirrored=True), PlacedSymbol("TP5", 79, 124),
            *(PlacedSymbol(reference, x, 128) for reference, x in zip(negative, negative_columns, strict=True)),
        ),
        wires=(
            ((20, 124), (79, 124)), ((20, 126), (24, 126), (24, 134), (74, 134), *((x, 134) for x in pins)),
            *(((x, 134), (x, 130)) for x in pins),
            *(((x, 124), (x, 125)) for x in negative_columns), *(((x, 131), (x, 134)) for x in negative_columns),
        ),
        power_symbols=(
            PowerSymbol("VEE", 26, 134, 180), PowerSymbol("PWR_FLAG", 74, 134, 180), PowerSymbol("PWR_FLAG", 74, 124),
        ),
    )  # fmt: skip
    return join_blocks(positive_row, negative_row)


_SUPPLY_MIDPOINT = Sheet(
    symbols=(
        PlacedSymbol("R22", 18, 136), PlacedSymbol("R23", 18, 144), PlacedSymbol("C21", 27, 145),
        PlacedSymbol("U5", 44, 142), PlacedSymbol("TP5", 54, 142),
    ),
    wires=(
        ((18, 139), (18, 141)), ((18, 140), (27, 140), (27, 142)), ((27, 140), (38, 140)),
        ((38, 144), (36, 144), (36, 154), (52, 154), (52, 142)), ((50, 142), (54, 142), (56, 142)),
    ),
    power_symbols=(
        PowerSymbol("VCC", 18, 133), PowerSymbol("GND", 18, 147), PowerSymbol("GND", 27, 148),
        PowerSymbol("VCC", 42, 136), PowerSymbol("GND", 42, 148),
    ),
    labels=(Label("HALF", 30, 140),),
    texts=(("Buffered mid-supply", 22, 129),),
    global_labels=(GlobalLabel("VMID", 56, 142),),
)  # fmt: skip

_PROTECTION = Sheet(
    symbols=(PlacedSymbol("Q1", 28, 116, 90),),
    wires=(((20, 122), (22, 122), (22, 114), (24, 114)), ((28, 120), (28, 124))),
    labels=(Label("POWER_IN", 22, 114, 180),),
)

_BRIDGE_SUPPLY = Sheet(
    symbols=(
        PlacedSymbol("R25", 172, 18), PlacedSymbol("R26", 172, 26), PlacedSymbol("C23", 181, 27),
        PlacedSymbol("U6", 198, 24), PlacedSymbol("C24", 218, 24),
    ),
    wires=(
        ((172, 21), (172, 23)), ((172, 22), (181, 22), (181, 24)), ((181, 22), (192, 22)),
        ((192, 26), (190, 26), (190, 34), (206, 34), (206, 24)), ((204, 24), (206, 24), (208, 24)),
    ),
    power_symbols=(
        PowerSymbol("VCC", 172, 15), PowerSymbol("GND", 172, 29), PowerSymbol("GND", 181, 30),
        PowerSymbol("VCC", 196, 18), PowerSymbol("GND", 196, 30), PowerSymbol("VCC", 218, 21),
        PowerSymbol("GND", 218, 27),
    ),
    labels=(Label("VREF_IN", 183, 22),),
    texts=(("Supply of the bridge", 178, 12),),
    global_labels=(GlobalLabel("VREF", 208, 24),),
)  # fmt: skip


# Sheets of the board variants: signal from left to right, in rows; supply below. Units of 1.27 mm.


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
