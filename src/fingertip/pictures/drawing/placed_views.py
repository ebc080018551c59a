"""Views of a part in their places on paper: in rows and columns, with room for dimensions.

Views in a row share the height of their origins, and views in a column share its distance from the
left, as first-angle projection wants it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from fingertip.design.geometry.sizes import Length, PartDrawing, Side, ViewName
from fingertip.models.solids import Point3
from fingertip.pictures.drawing.dimensioning import FIRST_LANE_MM, LANE_MM, NoRoomError
from fingertip.pictures.drawing.primitives import PROJECTIONS, Box, Point, ProjectedView

SECTION_LINE_BEGIN_MM = 2.0
"""Distance from the view at which the ends of the section line begin."""
SECTION_LINE_END_MM = 7.0
"""Distance from the view at which the section line ends."""
_SECTION_LINE_ROOM_MM = SECTION_LINE_END_MM - 2.0
"""Distance from a view with a section line at which its lanes begin. Their first dimension line
lies further out, past the end of the section line.
"""
LETTER_MM = 3.5
"""Height of the letters of the section."""
NAME_ABOVE_MM = 3.0
"""Distance of the section's name from the section."""
_PAST_LANES_MM = 4.0
"""Free room past the last dimension line beside a view."""
_NO_LANES_MM = 6.0
"""Free room on a side of a view without dimensions."""

Views: TypeAlias = Mapping[ViewName, ProjectedView]
"""Views of a part by their names."""


@dataclass(frozen=True)
class PlacedView:
    """View with its scale and its place on paper."""

    name: ViewName
    view: ProjectedView
    scale: float
    origin: Point
    """Place of the part's origin."""

    def on_paper(self, point: Point) -> Point:
        """Return where a point of the view [mm of the part] lies on paper [mm]."""
        return self.origin[0] + self.scale * point[0], self.origin[1] + self.scale * point[1]

    def place(self, point: Point3) -> Point:
        """Return where a point of the part [mm] appears on paper [mm]."""
        return self.on_paper(PROJECTIONS[self.name].flatten(point))

    def bounds(self) -> Box:
        """Return the box of the view on paper [mm]."""
        left, bottom, right, top = self.view.bounds()
        return *self.on_paper((left, bottom)), *self.on_paper((right, top))

    def edge(self, side: Side) -> float:
        """Return the coordinate at which a side's lanes begin: past the section line's ends."""
        left, bottom, right, top = self.bounds()
        match side:
            case "above":
                return top
            case "below":
                return bottom
            case "left":
                return left - _section_line_room(self.name)
            case "right":
                return right + _section_line_room(self.name)


@dataclass(frozen=True)
class Row:
    """Views that stand beside each other."""

    left: ViewName
    right: ViewName | None = None
    """View in the right column; None if its place stays empty."""


Arrangement: TypeAlias = tuple[Row, ...]
"""Rows from the top."""


def list_arrangements(plan: ViewName) -> tuple[Arrangement, ...]:
    """List the arrangements of a part's views, the preferred one first.

    The palmar view stands above the front view, the dorsal one below it, and the end at its right.
    """
    main = Row("front", "end")
    if plan == "palmar":
        return (
            (Row("palmar", "section"), main),
            (Row("palmar"), main, Row("section")),
        )

    return (
        (main, Row("dorsal", "section")),
        (main, Row("dorsal"), Row("section")),
    )


@dataclass(frozen=True)
class _Band:
    """Room that the views of one row or column take across it, about their common origin [mm]."""

    low: float
    """Left or lower bound of the views."""
    high: float
    """Right or upper bound of the views."""
    low_lanes: float
    """Width of the lanes at the left of the views or below them."""
    high_lanes: float
    """Width of the lanes at the right of the views or above them."""

    @property
    def width(self) -> float:
        """Width of the views with the lanes on both sides."""
        return self.high - self.low + self.low_lanes + self.high_lanes


@dataclass(frozen=True)
class ScaledViews:
    """Views of a part with their scale, which have no place yet."""

    part: PartDrawing
    views: Views
    scale: float

    def column(self, names: Sequence[ViewName]) -> _Band:
        """Return the room that views need from left to right if they stand in one column."""
        boxes = [self._bounds(name) for name in names]
        return _Band(
            low=min(left for left, _, _, _ in boxes),
            high=max(right for _, _, right, _ in boxes),
            low_lanes=max(self._lanes_width(name, "left") for name in names),
            high_lanes=max(self._lanes_width(name, "right") for name in names),
        )

    def row(self, names: Sequence[ViewName]) -> _Band:
        """Return the room that views need from below to above if they stand in one row."""
        boxes = [self._bounds(name) for name in names]
        return _Band(
            low=min(bottom for _, bottom, _, _ in boxes),
            high=max(top for _, _, _, top in boxes),
            low_lanes=max(self._lanes_width(name, "below") for name in names),
            high_lanes=max(self._lanes_width(name, "above") for name in names),
        )

    def place(self, name: ViewName, origin: Point) -> PlacedView:
        """Return a view with its origin at a point of the paper [mm]."""
        return PlacedView(name, self.views[name], self.scale, origin)

    def _bounds(self, name: ViewName) -> Box:
        """Return the box of a view about its origin [mm on paper]."""
        left, bottom, right, top = self.views[name].bounds()
        return self.scale * left, self.scale * bottom, self.scale * right, self.scale * top

    def _lanes_width(self, name: ViewName, side: Side) -> float:
        """Return the width that a side of a view needs for marks and dimensions [mm]."""
        marks = 0.0
        if side in ("left", "right"):
            marks = _section_line_room(name)
        elif name == "section" and side == "above":
            marks = NAME_ABOVE_MM + LETTER_MM

        count = len(lengths_beside(self.part, name, side))
        if not count:
            return marks + _NO_LANES_MM

        return marks + (FIRST_LANE_MM + LANE_MM * (count - 1) + _PAST_LANES_MM)


def lengths_beside(part: PartDrawing, name: ViewName, side: Side) -> list[Length]:
    """List the lengths whose dimension lines lie on a side of a view."""
    lengths = [size for size in part.sizes if isinstance(size, Length)]
    return [length for length in lengths if length.view == name and length.side == side]


def place_views(
    scaled: ScaledViews, free: Box, arrangement: Arrangement
) -> dict[ViewName, PlacedView]:
    """Place views in the free box of a sheet, with equal gaps between rows and between columns.

    Raises NoRoomError.
    """
    columns = [
        scaled.column([row.left for row in arrangement]),
        scaled.column([row.right for row in arrangement if row.right]),
    ]
    rows = [scaled.row([name for name in (row.left, row.right) if name]) for row in arrangement]

    left, bottom, right, top = free
    spare_width = right - left - sum(column.width for column in columns)
    spare_height = top - bottom - sum(row.width for row in rows)
    if spare_width < 0.0 or spare_height < 0.0:
        raise NoRoomError("views")

    left_x, right_x = _column_origins(columns, left, spare_width / (len(columns) + 1))
    heights = _row_origins(rows, top, spare_height / (len(rows) + 1))

    placed: dict[ViewName, PlacedView] = {}
    for row, y in zip(arrangement, heights, strict=True):
        placed[row.left] = scaled.place(row.left, (left_x, y))
        if row.right:
            placed[row.right] = scaled.place(row.right, (right_x, y))

    return placed


def _column_origins(columns: Sequence[_Band], left: float, gap: float) -> list[float]:
    """Return the x coordinates of the columns' origins, from the left edge on [mm]."""
    origins = []
    x = left

    for column in columns:
        x += gap + column.low_lanes
        origins.append(x - column.low)
        x += column.high - column.low + column.high_lanes

    return origins


def _row_origins(rows: Sequence[_Band], top: float, gap: float) -> list[float]:
    """Return the y coordinates of the rows' origins, from the top edge downwards [mm]."""
    origins = []
    y = top

    for row in rows:
        y -= gap + row.high_lanes
        origins.append(y - row.high)
        y -= row.high - row.low + row.low_lanes

    return origins


def _section_line_room(name: ViewName) -> float:
    """Return the width that the section line needs at the left and right of a view [mm]."""
    return _SECTION_LINE_ROOM_MM if name in ("palmar", "dorsal") else 0.0
