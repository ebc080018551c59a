"""Place of a board on the sheet of its assembly drawing, five times its size.

Lengths are millimetres on paper; the y axis of the sheet points up, that of the board down.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.kicad.placement import Box
from fingertip.pictures.drawing.primitives import Point, Polyline, Style, rectangle

SCALE = 5.0
"""Length on paper over length of the board."""


@dataclass(frozen=True)
class SheetBox:
    """Rectangle on the sheet [mm]."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        """Length from left to right."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Length from below to above."""
        return self.top - self.bottom

    @property
    def middle(self) -> Point:
        """Point in the middle."""
        return (self.left + self.right) / 2.0, (self.bottom + self.top) / 2.0

    def outline(self, style: Style) -> Polyline:
        """Return the closed line around the rectangle."""
        return rectangle(
            self.left,
            bottom=self.bottom,
            right=self.right,
            top=self.top,
            style=style,
        )


@dataclass(frozen=True)
class BoardOnSheet:
    """Place of a board's upper left corner on the sheet [mm]."""

    left: float
    top: float

    def place(self, box: Box) -> SheetBox:
        """Return where a rectangle of the board lies on the sheet."""
        left, top, right, bottom = box
        return SheetBox(
            left=self.left + SCALE * left,
            bottom=self.top - SCALE * bottom,
            right=self.left + SCALE * right,
            top=self.top - SCALE * top,
        )
