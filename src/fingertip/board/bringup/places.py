"""Places for the probes where no test point is: an end of a part, named by its side as seen from the front.

Sides are those of the board with sensor and supply on the left.
"""

from __future__ import annotations

from fingertip.board.circuit import Circuit
from fingertip.board.layout.placement import PlacedPad, Placement, place_pads
from fingertip.errors import BoardError

FRONT = "Sides of parts are as seen from the front, with J1 and J2 on the left."


def find_end(circuit: Circuit, placement: Placement, reference: str, net: str) -> str:
    """Name the end of a two-terminal part that is at a net, such as "right end of C10".

    Raises
    ------
    BoardError
        If no end is at the net.
    """
    pads = [pad for pad in place_pads(circuit, placement) if pad.reference == reference]
    here = next((pad for pad in pads if pad.net == net), None)
    other = next((pad for pad in pads if pad.net != net), None)
    if here is None or other is None:
        raise BoardError(f"no end of {reference} alone is at {net}; this is a fault of the program.")
    return f"{_name_side(here, other)} end of {reference}"


def find_pin_1_end(circuit: Circuit, placement: Placement, reference: str) -> str:
    """Name the end of a connector at which pin 1 lies, such as "lower"."""
    pads = {pad.pad.number: pad for pad in place_pads(circuit, placement) if pad.reference == reference}
    last = max((name for name in pads if name.isdigit()), key=int)
    return _name_side(pads["1"], pads[last])


def find_widest(circuit: Circuit, placement: Placement, net: str) -> str:
    """Find the two-terminal part whose pad at a net is the largest, and name that end."""
    by_part: dict[str, list[PlacedPad]] = {}
    for pad in place_pads(circuit, placement):
        if pad.reference[0] in "RC" and pad.reference[1:].isdigit():
            by_part.setdefault(pad.reference, []).append(pad)
    at_net = {
        reference: pads[0].half_width * pads[0].half_height
        for reference, pads in by_part.items()
        if sum(pad.net == net for pad in pads) == 1
    }
    if not at_net:
        raise BoardError(f"no resistor or capacitor is at {net}; this is a fault of the program.")
    return find_end(circuit, placement, max(at_net, key=lambda reference: at_net[reference]), net)


def _name_side(pad: PlacedPad, other: PlacedPad) -> str:
    dx, dy = pad.x - other.x, pad.y - other.y
    if abs(dx) > abs(dy):
        return "right" if dx > 0 else "left"
    return "lower" if dy > 0 else "upper"
