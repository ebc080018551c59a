"""Lengths of the coupon that are measured with calipers: name, nominal value, and where they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from fingertip.cad.shapes.coupon_layout import WALLS_MM, lay_out, slice_height
from fingertip.design import Design

MIN_LENGTH_MM = 5.0
"""Least nominal length that is measured [mm]: calipers read shorter ones too coarsely for a scale."""


@dataclass(frozen=True)
class Length:
    """Length of the coupon as the printer is told to print it."""

    name: str
    """Key in the file of readings; it ends in the unit."""
    nominal_mm: float
    """Length in STL and 3MF: that of the design times printer.scale_percent."""
    kind: Literal["outer", "inner", "wall"]
    """Outer lengths grow where the printer prints too much, inner ones shrink. Thin walls show whether they print."""
    where: str
    """Place on the coupon, in words."""


def list_lengths(design: Design) -> tuple[Length, ...]:
    """List the lengths to measure on the coupon of a design: outer ones, inner ones, then the thin walls."""
    scale = design.printer.scale_percent / 100.0
    return tuple(
        Length(name, round(nominal * scale, 6), kind, where)
        for name, nominal, kind, where in _list_unscaled(design)
        if kind == "wall" or nominal >= MIN_LENGTH_MM
    )


def _list_unscaled(design: Design) -> Iterator[tuple[str, float, Literal["outer", "inner", "wall"], str]]:
    """Yield name, length in the design [mm], kind and place of each length."""
    layout, section = lay_out(design), design.dimensions.bone_outline.section
    yield "outer_x_mm", layout.size[0], "outer", "Whole frame, along the row of thin walls."
    yield "outer_y_mm", layout.size[1], "outer", "Whole frame, across the row of thin walls, beside the slot."
    yield (
        "recess_block_x_mm",
        layout.ring.size[0],
        "outer",
        "Block around the recess of the loose piece, its long side.",
    )
    yield "recess_block_y_mm", layout.ring.size[1], "outer", "The same block, its short side, above the rib."
    yield "tongue_mm", layout.tongue.size[0], "outer", "Block with the hexagonal trap: its side along the rib."
    if layout.luer:
        yield "tower_mm", layout.luer.size[0], "outer", "Tallest block, with the cone of the syringe: along the rib."
    yield "slice_width_mm", 2 * section.half_width, "outer", "Loose piece, at its widest, along its flat."
    yield "slice_height_mm", slice_height(design), "outer", "Loose piece, from its flat to the top of its arch."
    yield "window_x_mm", layout.windows[0].size[0], "inner", "Long window beside the slot: its length."
    yield "window_y_mm", layout.windows[1].size[1], "inner", "Middle window, at its free end: from rib to rib."
    yield "upper_window_y_mm", layout.windows[2].size[1], "inner", "Window with the thin walls, at its free end."
    yield "slot_mm", layout.slot.size[0], "inner", "Slot that is open at the edge of the frame."
    yield "nut_trap_mm", design.mold.nut_width_mm, "inner", "Hexagonal trap, from flat to flat, across the rib."
    for wall in WALLS_MM:
        place = "Thin wall; leave it empty if the wall is missing, torn or falls over."
        yield f"wall_{wall:.1f}_mm".replace(".", "_"), wall, "wall", place
