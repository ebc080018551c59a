"""Layout of a sheet: its paper and scale, the arrangement of its views, and all dimensions.

The largest scale of ISO 5455 on the smallest paper whose views and dimensions all find a place is
taken; A3 before a smaller scale. Where the section's letters are in the way of a size on every
paper, they give way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from fingertip.design.geometry.sizes import Circle, Length, PartDrawing, Side, ViewName
from fingertip.foundation.errors import GeometryError, Issue
from fingertip.pictures.drawing.dimensioning import (
    NoRoomError,
    Occupancy,
    PlacedLength,
    place_circle,
    place_lengths,
)
from fingertip.pictures.drawing.placed_views import (
    Arrangement,
    PlacedView,
    ScaledViews,
    Views,
    lengths_beside,
    list_arrangements,
    place_views,
)
from fingertip.pictures.drawing.primitives import Primitive, Sheet
from fingertip.pictures.drawing.title_block import Heading, Paper, draw_frame
from fingertip.pictures.drawing.view_lines import draw_view_lines

_A4 = Paper(297.0, 210.0)
_A3 = Paper(420.0, 297.0)
_A2 = Paper(594.0, 420.0)
_A1 = Paper(841.0, 594.0)


@dataclass(frozen=True)
class _Scale:
    """Scale of a drawing."""

    name: str
    """Text of the title block, such as 2:1."""
    factor: float
    """Length on paper over length of the part."""


_ENLARGED_5 = _Scale("5:1", 5.0)
_ENLARGED_2 = _Scale("2:1", 2.0)
_FULL_SIZE = _Scale("1:1", 1.0)
_HALF_SIZE = _Scale("1:2", 0.5)
_SCALES = (_ENLARGED_5, _ENLARGED_2, _FULL_SIZE, _HALF_SIZE)
"""Scales of ISO 5455, the largest first."""
_LARGE_PAPER_SCALES = (_ENLARGED_2, _FULL_SIZE, _HALF_SIZE)
"""Scales that are tried on large paper too, the largest first."""
_PAPERS_AND_SCALES = (
    *((paper, scale) for scale in _SCALES for paper in (_A4, _A3)),
    *((paper, scale) for scale in _LARGE_PAPER_SCALES for paper in (_A2, _A1)),
)
"""Papers with their scales, the preferred first."""
_SIDES: tuple[Side, ...] = ("above", "below", "left", "right")
"""Sides of a view, in the order in which their dimensions are placed."""


@dataclass(frozen=True)
class _Choice:
    """One way to lay out a sheet."""

    paper: Paper
    scale: _Scale
    arrangement: Arrangement
    letters_give_way: bool
    """True if the section's letters stand where they block no dimension."""


def lay_out(part: PartDrawing, views: Views, heading: Heading) -> Sheet:
    """Return the sheet of a part, laid out in the first way in which all finds its place.

    The scale of the heading is replaced. Raises GeometryError if no paper has room.
    """
    title = f"{heading.design}: {part.title}, sheet {heading.sheet} of {heading.sheets}"
    missing = ""

    for choice in _list_choices(part.plan):
        try:
            primitives = _draw_sheet(part, views, heading, choice)
        except NoRoomError as error:
            missing = str(error)
            continue

        return Sheet(title, choice.paper.width, choice.paper.height, primitives)

    message = (
        f"no paper has room for the {missing} of {part.part}; measure it in the STEP file "
        "of `fingertip build`."
    )
    raise GeometryError(Issue("drawing", message))


def _list_choices(plan: ViewName) -> Iterator[_Choice]:
    """List the ways to lay out a sheet, the preferred first."""
    for letters_give_way in (False, True):
        for paper, scale in _PAPERS_AND_SCALES:
            for arrangement in list_arrangements(plan):
                yield _Choice(paper, scale, arrangement, letters_give_way)


def _draw_sheet(
    part: PartDrawing, views: Views, heading: Heading, choice: _Choice
) -> tuple[Primitive, ...]:
    """Draw a sheet in one way. Raises NoRoomError."""
    paper = choice.paper
    scaled_heading = replace(heading, scale=choice.scale.name)
    frame, free_bottom = draw_frame(paper, part, scaled_heading)

    scaled_views = ScaledViews(part, views, choice.scale.factor)
    free = (paper.left, free_bottom, paper.right, paper.top)
    placed = place_views(scaled_views, free, choice.arrangement)
    view_lines = [*draw_view_lines(placed, part, letters_give_way=choice.letters_give_way)]

    occupancy = _block_border(paper, free_bottom)
    # Centre lines and the ends of the section line count as edges: no dimension line runs along
    # them.
    occupancy.add(view_lines, is_view=True)
    lengths = [*_dimension_lengths(placed, part, occupancy)]
    circles = [*_dimension_circles(placed, part, occupancy)]

    return (*view_lines, *lengths, *circles, *frame)


def _block_border(paper: Paper, free_bottom: float) -> Occupancy:
    """Return the raster of a sheet on which only the box above `free_bottom` [mm] is free."""
    occupancy = Occupancy(paper.width, paper.height)
    occupancy.block((0.0, 0.0, paper.left, paper.height))
    occupancy.block((paper.right, 0.0, paper.width, paper.height))
    occupancy.block((0.0, 0.0, paper.width, free_bottom))
    occupancy.block((0.0, paper.top, paper.width, paper.height))

    return occupancy


def _dimension_lengths(
    views: Mapping[ViewName, PlacedView], part: PartDrawing, occupancy: Occupancy
) -> Iterator[Primitive]:
    """Place the lengths beside all views. Raises NoRoomError."""
    balloons = _number_balloons(part)
    for view, side in product(views.values(), _SIDES):
        lengths = lengths_beside(part, view.name, side)
        placed = _place_ends(lengths, view, side, balloons)
        yield from place_lengths(placed, occupancy)


def _place_ends(
    lengths: Sequence[Length], view: PlacedView, side: Side, balloons: Mapping[str, int]
) -> list[PlacedLength]:
    """Return the lengths on one side of a view with their ends on paper."""
    return [
        PlacedLength(
            size=length,
            start=view.place(length.start),
            end=view.place(length.end),
            edge=view.edge(side),
            balloon=balloons.get(length.name, 0),
        )
        for length in lengths
    ]


def _dimension_circles(
    views: Mapping[ViewName, PlacedView], part: PartDrawing, occupancy: Occupancy
) -> Iterator[Primitive]:
    """Place diameters and radii in all views. Raises NoRoomError."""
    balloons = _number_balloons(part)
    circles = [size for size in part.sizes if isinstance(size, Circle)]

    for view, circle in product(views.values(), circles):
        if circle.view == view.name:
            yield from place_circle(
                circle,
                centre=view.place(circle.centre),
                radius=circle.radius * view.scale,
                balloon=balloons.get(circle.name, 0),
                occupancy=occupancy,
            )


def _number_balloons(part: PartDrawing) -> dict[str, int]:
    """Return the numbers of the sizes to check by their names; other sizes have none."""
    return {size.name: number for number, size in enumerate(part.checked, 1)}
