"""The sheet of variant `comparator`: as `precision`'s, with the comparator on a row below."""

from __future__ import annotations

from dataclasses import replace

from fingertip.board.paper_sheet import BRIDGE, MOUNTING, joined
from fingertip.board.precision_sheet import FILTERS, RECTIFIER, SUPPLY
from fingertip.board.sheet import Label, Mark, Placed, Sheet

# J3's fourth pin leaves as SLIP instead of ground.
_GROUND = (((218, 64), (216, 64), (216, 68)), ((218, 66), (216, 66)))
_BRIDGE = replace(
    BRIDGE,
    wires=(
        *(wire for wire in BRIDGE.wires if wire not in _GROUND),
        ((218, 64), (214, 64)), ((218, 66), (217, 66), (217, 74)),
    ),
    marks=(*(mark for mark in BRIDGE.marks if mark != Mark("GND", 216, 68)), Mark("GND", 214, 64)),
    labels=(*BRIDGE.labels, Label("SLIP", 217, 74, 180)),
)  # fmt: skip

_MOUNTING = replace(
    MOUNTING,
    placed=tuple(Placed(f"H{i}", 4 + 10 * i, 149) for i in range(1, 5)),
    words=(("Mounting", 12, 142),),
)

_DECISION = Sheet(
    placed=(
        Placed("C18", 52, 149), Placed("R18", 74, 147, 90), Placed("C17", 84, 150), Placed("R19", 96, 133),
        Placed("RV1", 96, 140), Placed("R20", 114, 131, 90), Placed("U4", 116, 144), Placed("R21", 126, 140),
    ),
    wires=(
        ((62, 147), (71, 147)), ((77, 147), (84, 147), (106, 147), (106, 146), (110, 146)), ((96, 136), (96, 137)),
        ((99, 140), (109, 140), (109, 142), (110, 142)), ((109, 140), (109, 131), (111, 131)),
        ((117, 131), (122, 131), (122, 144)), ((122, 144), (130, 144)), ((126, 143), (126, 144)),
    ),
    marks=(
        Mark("VCC", 52, 146), Mark("GND", 52, 152), Mark("GND", 84, 153), Mark("VCC", 96, 130), Mark("GND", 96, 143),
        Mark("VCC", 114, 138), Mark("GND", 114, 150), Mark("VCC", 126, 137),
    ),
    labels=(
        Label("ENVELOPE", 62, 147), Label("MEAN", 100, 147), Label("THRESHOLD", 99, 140), Label("TRIM_TOP", 96, 137),
        Label("SLIP", 130, 144),
    ),
    words=(("ON/OFF: SLIP is low", 62, 139),),
)  # fmt: skip

COMPARATOR_SHEET = joined(_BRIDGE, FILTERS, RECTIFIER, SUPPLY, _MOUNTING, _DECISION)
"""The whole sheet."""
