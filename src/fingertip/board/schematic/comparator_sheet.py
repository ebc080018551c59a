"""The sheet of variant `comparator`: as `precision`'s, with the comparator on a row below."""

from __future__ import annotations

from fingertip.board.schematic.common_sheet import BRIDGE, MOUNTING, connector, joined, supply_row
from fingertip.board.schematic.precision_sheet import FILTERS, RECTIFIER
from fingertip.board.schematic.sheet import Label, Mark, Placed, Sheet, supplied
from fingertip.board.supplies import Supply

_DECISION = Sheet(
    placed=(
        Placed("R18", 78, 143, 90), Placed("C17", 86, 146), Placed("R19", 100, 135), Placed("RV1", 100, 142),
        Placed("R20", 116, 131, 90), Placed("U4", 120, 144), Placed("R21", 130, 140),
    ),
    wires=(
        ((66, 143), (75, 143)), ((81, 143), (86, 143), (94, 143), (94, 150), (110, 150), (110, 146), (114, 146)),
        ((100, 138), (100, 139)), ((103, 142), (109, 142), (114, 142)), ((109, 142), (109, 131), (113, 131)),
        ((119, 131), (126, 131), (126, 144)), ((126, 144), (134, 144)), ((130, 143), (130, 144)),
    ),
    marks=(
        Mark("ZERO", 86, 149, 90), Mark("VCC", 100, 132), Mark("ZERO", 100, 145, 90), Mark("VCC", 118, 138),
        Mark("GND", 118, 150), Mark("VCC", 130, 137),
    ),
    labels=(
        Label("ENVELOPE", 66, 143), Label("MEAN", 95, 150), Label("THRESHOLD", 103, 142),
        Label("TRIM_TOP", 100, 138, 180), Label("SLIP", 134, 144),
    ),
    words=(("SLIP: low while it slips", 62, 138),),
)  # fmt: skip


def comparator_sheet(supply: Supply) -> Sheet:
    """The whole sheet."""
    plus = ("C10", "C5", "C12", "C15", "C18", *(("C22",) if supply.zero_share else ()))
    row = supply_row(supply, plus, ("C11", "C6", "C13", "C16"), ("U1", "U3"))
    return supplied(joined(BRIDGE, connector(supply, slip=True), FILTERS, RECTIFIER, row, _DECISION, MOUNTING), supply)
