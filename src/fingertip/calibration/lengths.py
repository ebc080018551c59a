"""Lengths of the coupon that are measured with calipers: name, nominal value, and where they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

from fingertip.cad.shapes.coupon_layout import AROUND_MM, RIB_MM, WALLS_MM, Spot, lay_out
from fingertip.design import Design

MIN_LENGTH_MM = 5.0
"""Least nominal length that is measured [mm]: calipers read shorter ones too coarsely for a scale."""


Piece = Literal["coupon", "coupon_slice"]
Kind = Literal["outer", "inner", "wall"]
Point = tuple[float, float]
_INTO_WALL_MM = AROUND_MM / 2
"""Distance from the side of a block at which its length is drawn: on the wall around its hollow [mm]."""
_FREE_END_MM = 2.0
"""Distance from the free end of a window at which the jaws go in [mm]."""


@dataclass(frozen=True)
class Length:
    """Length of the coupon as the printer is told to print it. All lie in the plane of the bed."""

    name: str
    """Key in the file of readings; it ends in the unit."""
    nominal_mm: float
    """Length in STL and 3MF: that of the design times printer.scale_percent."""
    kind: Kind
    """Outer lengths grow where the printer prints too much, inner ones shrink. Thin walls show whether they print."""
    where: str
    """Place on the coupon, in words."""
    ends: tuple[Point, Point]
    """Place in the plan of its piece, without the scale [mm]."""
    piece: Piece = "coupon"

    @property
    def axis(self) -> Literal["x", "y"]:
        """Axis of the bed along which the jaws of the calipers close."""
        (x0, _), (x1, _) = self.ends
        return "x" if x0 != x1 else "y"


def list_lengths(design: Design) -> tuple[Length, ...]:
    """List the lengths to measure on the coupon of a design: outer ones, inner ones, then the thin walls."""
    scale = design.printer.scale_percent / 100.0
    return tuple(
        replace(length, nominal_mm=round(length.nominal_mm * scale, 6))
        for length in _list_unscaled(design)
        if length.kind == "wall" or length.nominal_mm >= MIN_LENGTH_MM
    )


def _list_unscaled(design: Design) -> Iterator[Length]:
    """Yield the lengths of the design's own coupon."""
    layout, section = lay_out(design), design.dimensions.bone_outline.section
    (width, depth), (long, middle, upper), slot = layout.size, layout.windows, layout.slot
    yield _along_x("outer_x_mm", "outer", (0.0, width), depth - RIB_MM / 2, "Whole frame, along the row of thin walls.")
    where = "Whole frame, across the row of thin walls, beside the slot."
    yield _along_y("outer_y_mm", "outer", width - RIB_MM / 2, (0.0, depth), where)
    where = "Block around the recess of the loose piece, its long side."
    yield _block_x("recess_block_x_mm", layout.ring, where)
    (_, low), (right, high) = layout.ring.low, layout.ring.high
    where = "The same block, its short side, above the rib."
    yield _along_y("recess_block_y_mm", "outer", right - _INTO_WALL_MM, (low, high), where)
    yield _block_x("tongue_mm", layout.tongue, "Block with the hexagonal trap: its side along the rib.")
    if layout.luer:
        yield _block_x("tower_mm", layout.luer, "Tallest block, with the cone of the syringe: along the rib.")
    half, flat, top = section.half_width, -design.dimensions.base_flat_depth, section.dorsal
    where = "Loose piece, at its widest, along its flat."
    yield replace(_along_x("slice_width_mm", "outer", (-half, half), 0.0, where), piece="coupon_slice")
    where = "Loose piece, from its flat to the top of its arch."
    yield replace(_along_y("slice_height_mm", "outer", 0.0, (flat, top), where), piece="coupon_slice")
    where = "Long window beside the slot: its length."
    yield _along_x("window_x_mm", "inner", (long.low[0], long.high[0]), long.centre[1], where)
    for name, window, where in (
        ("window_y_mm", middle, "Middle window, at its free end: from rib to rib."),
        ("upper_window_y_mm", upper, "Window with the thin walls, at its free end."),
    ):
        yield _along_y(name, "inner", window.high[0] - _FREE_END_MM, (window.low[1], window.high[1]), where)
    where = "Slot that is open at the edge of the frame."
    yield _along_x("slot_mm", "inner", (slot.low[0], slot.high[0]), slot.centre[1], where)
    x, y = layout.tongue.centre
    trap = design.mold.nut_width_mm / 2
    where = "Hexagonal trap, from flat to flat, across the rib."
    yield _along_y("nut_trap_mm", "inner", x, (y - trap, y + trap), where)
    for spot, thickness in zip(layout.walls, WALLS_MM, strict=True):
        name = f"wall_{thickness:.1f}_mm".replace(".", "_")
        where = "Thin wall; leave it empty if the wall is missing, torn or falls over."
        yield _along_x(name, "wall", (spot.low[0], spot.high[0]), spot.centre[1], where, thickness)


def _block_x(name: str, spot: Spot, where: str) -> Length:
    """Length of a block along the rib, on the wall at its free side."""
    return _along_x(name, "outer", (spot.low[0], spot.high[0]), spot.high[1] - _INTO_WALL_MM, where, spot.size[0])


def _along_x(name: str, kind: Kind, xs: Point, y: float, where: str, nominal: float | None = None) -> Length:
    """Length along x at a height `y` of the plan; `nominal` saves the rounding of a difference."""
    return Length(name, xs[1] - xs[0] if nominal is None else nominal, kind, where, ((xs[0], y), (xs[1], y)))


def _along_y(name: str, kind: Kind, x: float, ys: Point, where: str) -> Length:
    return Length(name, ys[1] - ys[0], kind, where, ((x, ys[0]), (x, ys[1])))
