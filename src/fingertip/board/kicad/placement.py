"""Placement of a board's parts, as its layout states it [mm]; the y axis points down.

The boards are 40 x 25 mm, `comparator` 42 x 26 mm, with all components on the front. Sensor and
supply enter on the left, signals leave on the right.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from fingertip.board.circuits.channels import split_name, split_net
from fingertip.board.kicad.sexpr import Node, Point, find_place, first, numbers, turn

Box = tuple[float, float, float, float]
"""Left, top, right and bottom edge [mm]."""


@dataclass(frozen=True)
class Pad:
    """Pad of a component in its place on the board [mm]."""

    name: str
    kind: str
    shape: str
    centre: Point
    width: float
    height: float
    """Width and height before it is turned."""
    turned_deg: float
    rounding: float
    """Radius of its corners over the shorter side."""
    drill: float
    """Diameter of its hole; 0 without one."""
    net: str
    """Name of its net in the circuit; empty for a hole, or for a pin of no net."""

    @property
    def box(self) -> Box:
        """Edges as it is turned."""
        x, y = self.centre
        width = self.width
        height = self.height
        if self.turned_deg % 180.0 == 90.0:
            width, height = height, width

        return x - width / 2, y - height / 2, x + width / 2, y + height / 2

    @property
    def is_plated(self) -> bool:
        """True if it has copper; a hole for a screw has none."""
        return self.kind != "np_thru_hole"


@dataclass(frozen=True)
class PlacedPart:
    """Component on the board: footprint, its origin and its anticlockwise rotation [degree]."""

    footprint: str
    x: float
    y: float
    angle: int
    is_labelled: bool
    """True if its reference is printed on the board."""
    pads: tuple[Pad, ...]
    body: Box | None
    """Edges of its body; None for a hole."""
    courtyard_radius: float
    """Radius of the area to keep free of other components, where that is round; else 0."""

    @property
    def pad_centre(self) -> Point:
        """Centre of the box around its pads."""
        left, top, right, bottom = zip(*(pad.box for pad in self.pads), strict=True)
        return (min(left) + max(right)) / 2, (min(top) + max(bottom)) / 2


@dataclass(frozen=True)
class PrintedText:
    """Text printed on the back: the middle of its left end as seen from the back."""

    text: str
    x: float
    y: float


@dataclass(frozen=True)
class Placement:
    """Outline of a board, and the positions of its parts relative to the upper left corner."""

    width: float
    height: float
    corner: Point
    """Upper left corner on KiCad's page."""
    parts: dict[str, PlacedPart]
    """Components of the circuit by reference."""
    fiducials: int
    """Number of fiducial marks, by which a pick-and-place machine finds the board's position."""
    back: tuple[PrintedText, ...]
    thickness_mm: float
    narrowest_mm: float
    """Width of the narrowest track."""
    via_mm: float
    via_drill_mm: float
    """Diameter of the smallest via, and of its hole."""


def view_channel(placement: Placement, channel: int) -> Placement:
    """Select the parts of a channel and the shared ones, named as on the board of one finger."""
    parts = {}
    for reference, part in placement.parts.items():
        number, own = split_name(reference)
        if number in (0, channel):
            pads = []
            for pad in part.pads:
                net_channel, own_net = split_net(pad.net)
                if net_channel in (0, channel):
                    pads.append(replace(pad, net=own_net))

            parts[own] = replace(part, pads=tuple(pads))

    return replace(placement, parts=parts)


def read_placement(board: Node) -> Placement:
    edges = [
        item for item in board.children("gr_line", "gr_arc") if item.word("layer") == "Edge.Cuts"
    ]
    ends = [numbers(first(item, end)) for item, end in itertools.product(edges, ("start", "end"))]
    left, top = (min(end[axis] for end in ends) for axis in (0, 1))
    right, bottom = (max(end[axis] for end in ends) for axis in (0, 1))
    parts = {}
    fiducials = 0

    for footprint in board.children("footprint"):
        if "board_only" in first(footprint, "attr").words:
            fiducials += 1
        else:
            parts[read_reference(footprint)] = _read_part(footprint, (left, top))

    back = []
    for item in board.children("gr_text"):
        if item.word("layer") == "B.SilkS":
            x, y, _ = find_place(item)
            back.append(PrintedText(item.words[1], round(x - left, 6), round(y - top, 6)))

    narrowest_mm = min(float(segment.word("width")) for segment in board.children("segment"))
    via_mm, via_drill_mm = min(
        (float(via.word("size")), float(via.word("drill"))) for via in board.children("via")
    )
    return Placement(
        width=right - left,
        height=bottom - top,
        corner=(left, top),
        parts=parts,
        fiducials=fiducials,
        back=tuple(back),
        thickness_mm=float(first(board, "general").word("thickness")),
        narrowest_mm=narrowest_mm,
        via_mm=via_mm,
        via_drill_mm=via_drill_mm,
    )


def _read_part(footprint: Node, corner: Point) -> PlacedPart:
    x, y, angle = find_place(footprint)
    reference = find_reference(footprint)
    circles = [item for item in footprint.children("fp_circle") if item.word("layer") == "F.CrtYd"]
    radius = (
        math.dist(*(numbers(first(circles[0], end)) for end in ("center", "end")))
        if circles
        else 0.0
    )

    return PlacedPart(
        footprint=footprint.words[1],
        x=round(x - corner[0], 6),
        y=round(y - corner[1], 6),
        angle=round(angle) % 360,
        is_labelled=reference is not None and reference.word("layer") == "F.SilkS",
        pads=tuple(list_pads(footprint, corner)),
        body=_read_body(footprint, corner),
        courtyard_radius=radius,
    )


def _read_body(footprint: Node, corner: Point) -> Box | None:
    outline = next(
        (item for item in footprint.children("fp_rect") if item.word("layer") == "F.Fab"), None
    )
    if outline is None:
        return None

    x, y, angle = find_place(footprint)
    ends = (numbers(first(outline, end)) for end in ("start", "end"))
    turned = (turn(px, py, angle) for px, py in ends)
    (x0, y0), (x1, y1) = ((x + dx - corner[0], y + dy - corner[1]) for dx, dy in turned)

    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


def list_pads(footprint: Node, corner: Point = (0.0, 0.0)) -> Iterator[Pad]:
    """Yield the pads of a component, relative to a corner."""
    x, y, angle = find_place(footprint)
    for pad in footprint.children("pad"):
        px, py, own = find_place(pad)
        dx, dy = turn(px, py, angle)
        name, kind, shape = pad.words[1:4]
        width, height = numbers(first(pad, "size"))
        rounding = float(pad.word("roundrect_rratio") or 0)
        drill = float(pad.word("drill") or 0)
        centre = (x + dx - corner[0], y + dy - corner[1])
        net = pad.word("net", 2).removeprefix("/")
        yield Pad(
            name=name,
            kind=kind,
            shape=shape,
            centre=centre,
            width=width,
            height=height,
            turned_deg=own,
            rounding=rounding,
            drill=drill,
            net=net,
        )


def read_reference(part: Node) -> str:
    """Read the reference of a footprint or a symbol; empty if it has none."""
    text = find_reference(part)
    return text.words[2] if text else ""


def find_reference(part: Node) -> Node | None:
    """Find the property of a footprint or a symbol that states its reference."""
    return next((text for text in part.children("property") if text.words[1] == "Reference"), None)
