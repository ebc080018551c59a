"""Layout of a sheet: paper and scale, places of the views, their lines, and all dimensions.

The largest scale of ISO 5455 on the smallest paper whose views and dimensions all find a place is
taken; A3 before a smaller scale. Where the section's letters are in the way of a size on every
paper, they give way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, product, zip_longest
from typing import TypeAlias

from fingertip.design.geometry.sizes import Circle, Length, PartDrawing, Side, ViewName
from fingertip.foundation.errors import GeometryError, Issue
from fingertip.models.solids import Point3
from fingertip.pictures.drawing import dimensioning
from fingertip.pictures.drawing.primitives import (
    PROJECTIONS,
    Arrow,
    Box,
    Hatch,
    Point,
    Polyline,
    Primitive,
    ProjectedView,
    Sheet,
    Styles,
    Text,
    line,
)
from fingertip.pictures.drawing.title_block import Heading, Paper, draw_frame

A4 = Paper(297.0, 210.0)
A3 = Paper(420.0, 297.0)
A2 = Paper(594.0, 420.0)
A1 = Paper(841.0, 594.0)
SCALES = (("5:1", 5.0), ("2:1", 2.0), ("1:1", 1.0), ("1:2", 0.5))
"""Scales of ISO 5455."""
CHOICES = (
    *((paper, scale) for scale in SCALES for paper in (A4, A3)),
    *((paper, scale) for scale in SCALES[1:] for paper in (A2, A1)),
)
_HATCH_MM = 2.5
_PAST_VIEW_MM = 3.0
"""Length of centre lines past what they pass through."""
_CUT_MM = (2.0, 7.0)
"""Distances from the view between which the ends of the section line lie."""
_LETTER_MM = 3.5
_BEHIND_ARROW_MM = 2.0 + _LETTER_MM / 2
_PAST_ARROW_MM = 8.5 + _LETTER_MM / 2
"""Distances of a letter's middle from the section line."""
_NAME_ABOVE_MM = 3.0
"""Distance of the section's name from the section."""
Views: TypeAlias = Mapping[ViewName, ProjectedView]
Arrangement: TypeAlias = tuple[tuple[ViewName, ViewName | None], ...]
"""Views on the left and on the right of each row, from the top."""
_SIDES: tuple[Side, ...] = ("above", "below", "left", "right")
_MIN_GAP_MM = 12.0


@dataclass(frozen=True)
class PlacedView:
    """View with its scale and its place on paper."""

    name: ViewName
    view: ProjectedView
    scale: float
    origin: Point

    def on_paper(self, point: Point) -> Point:
        return self.origin[0] + self.scale * point[0], self.origin[1] + self.scale * point[1]

    def place(self, point: Point3) -> Point:
        return self.on_paper(PROJECTIONS[self.name].flatten(point))

    def bounds(self) -> Box:
        left, bottom, right, top = self.view.bounds()
        return *self.on_paper((left, bottom)), *self.on_paper((right, top))

    def edge(self, side: Side) -> float:
        """Return the coordinate at which a side's lanes begin: past the section line's ends."""
        left, bottom, right, top = self.bounds()
        past = _beside_section_line(self.name)
        return {
            "above": top,
            "below": bottom,
            "left": left - past,
            "right": right + past,
        }[side]


def _beside_section_line(name: ViewName) -> float:
    """Return the width that the ends of the section line need on both sides of a view."""
    return _CUT_MM[1] - 2.0 if name in ("palmar", "dorsal") else 0.0


def lay_out(part: PartDrawing, views: Views, heading: Heading) -> Sheet:
    missing = ""
    attempts = product((False, True), CHOICES, _arrangements(part.plan))
    for letters_give_way, (paper, (name, scale)), arrangement in attempts:
        scaled = replace(heading, scale=name)
        try:
            primitives = _draw(
                part,
                views=views,
                heading=scaled,
                paper=paper,
                scale=scale,
                arrangement=arrangement,
                letters_give_way=letters_give_way,
            )
        except dimensioning.NoRoomError as error:
            missing = str(error)
            continue

        title = f"{heading.design}: {part.title}, sheet {heading.sheet} of {heading.sheets}"
        return Sheet(title, paper.width, paper.height, primitives)

    message = (
        f"no paper has room for the {missing} of {part.part}; measure it in the STEP file "
        "of `fingertip build`."
    )
    raise GeometryError(Issue("drawing", message))


def _draw(
    part: PartDrawing,
    views: Views,
    heading: Heading,
    paper: Paper,
    scale: float,
    arrangement: Arrangement,
    *,
    letters_give_way: bool,
) -> tuple[Primitive, ...]:
    frame, free_above = draw_frame(paper, part, heading)
    placed = _place_views(
        part,
        views=views,
        scale=scale,
        free=(paper.left, free_above, paper.right, paper.top),
        arrangement=arrangement,
    )
    occupancy = dimensioning.Occupancy(paper.width, paper.height)

    borders = (
        (0.0, 0.0, paper.left, paper.height),
        (paper.right, 0.0, paper.width, paper.height),
        (0.0, 0.0, paper.width, free_above),
        (0.0, paper.top, paper.width, paper.height),
    )
    for box in borders:
        occupancy.block(box)

    edges = [*chain.from_iterable(map(_view_edges, placed.values()))]
    centres = [*_centre_lines(placed, part)]
    marks = [
        *_section_marks(placed[part.plan], placed["section"], letters_give_way=letters_give_way)
    ]
    # Centre lines and the ends of the section line count as edges: no dimension line runs along
    # them.
    occupancy.add((*edges, *centres, *marks), is_view=True)
    dimensions: list[Primitive] = []
    balloons = {size.name: number for number, size in enumerate(part.checked, 1)}

    for view, side in product(placed.values(), _SIDES):
        lengths = [
            dimensioning.PlacedLength(
                size=size,
                start=view.place(size.start),
                end=view.place(size.end),
                edge=view.edge(side),
                balloon=balloons.get(size.name, 0),
            )
            for size in part.sizes
            if isinstance(size, Length) and size.view == view.name and size.side == side
        ]
        dimensions += dimensioning.place_lengths(lengths, occupancy)

    for view, size in product(placed.values(), part.sizes):
        if isinstance(size, Circle) and size.view == view.name:
            dimensions += dimensioning.place_circle(
                size,
                centre=view.place(size.centre),
                radius=size.radius * scale,
                balloon=balloons.get(size.name, 0),
                occupancy=occupancy,
            )

    return (*edges, *centres, *marks, *dimensions, *frame)


def _place_views(
    part: PartDrawing,
    views: Views,
    scale: float,
    free: Box,
    arrangement: Arrangement,
) -> dict[ViewName, PlacedView]:
    """Place the views in rows and columns, each with a common origin."""
    bounds = {name: tuple(scale * bound for bound in views[name].bounds()) for name in part.views}
    rows = [[name for name in row if name] for row in arrangement]
    columns = [[name for name in column if name] for column in zip_longest(*arrangement)]

    def lanes(name: ViewName, side: Side) -> float:
        lengths = [
            size
            for size in part.sizes
            if isinstance(size, Length) and size.view == name and size.side == side
        ]
        beside = _beside_section_line(name) if side in ("left", "right") else 0.0
        title = _NAME_ABOVE_MM + _LETTER_MM if (name, side) == ("section", "above") else 0.0
        room = dimensioning.FIRST_LANE_MM + dimensioning.LANE_MM * (len(lengths) - 1) + 4.0

        return max(title, beside) + (room if lengths else _MIN_GAP_MM / 2)

    def extent(
        names: Sequence[ViewName], k: int, low: Side, high: Side
    ) -> tuple[float, float, float, float]:
        """Return the bounds of views along an axis, and the widths of their lanes."""
        return (
            min(bounds[name][k] for name in names),
            max(bounds[name][k + 2] for name in names),
            max(lanes(name, low) for name in names),
            max(lanes(name, high) for name in names),
        )

    across = [extent(names, 0, "left", "right") for names in columns if names]
    upwards = [extent(names, 1, "below", "above") for names in rows]
    total_x = sum(high - low + before + after for low, high, before, after in across)
    total_y = sum(high - low + before + after for low, high, before, after in upwards)
    spare_x = free[2] - free[0] - total_x
    spare_y = free[3] - free[1] - total_y
    if spare_x < 0.0 or spare_y < 0.0:
        raise dimensioning.NoRoomError("views")

    xs = []
    ys = []
    x = free[0]
    y = free[3]

    for low, high, before, after in across:
        x += spare_x / (len(across) + 1) + before
        xs.append(x - low)
        x += high - low + after

    for low, high, before, after in upwards:
        y -= spare_y / (len(upwards) + 1) + after
        ys.append(y - high)
        y -= high - low + before

    placed = {}
    for row, origin_y in zip(arrangement, ys, strict=True):
        for name, origin_x in zip(row, xs, strict=False):
            if name:
                placed[name] = PlacedView(name, views[name], scale, (origin_x, origin_y))

    return placed


def _arrangements(plan: ViewName) -> tuple[Arrangement, ...]:
    """List the places of the views: palmar above the front, dorsal below, end at the right."""
    if plan == "palmar":
        return (
            (("palmar", "section"), ("front", "end")),
            (("palmar", None), ("front", "end"), ("section", None)),
        )

    return (
        (("front", "end"), ("dorsal", "section")),
        (("front", "end"), ("dorsal", None), ("section", None)),
    )


def _view_edges(placed: PlacedView) -> Iterator[Primitive]:
    """Draw the edges of a view, and visible ones over hidden ones and hatching."""
    view = placed.view
    if view.cut:
        yield Hatch(tuple(tuple(map(placed.on_paper, ring)) for ring in view.cut), _HATCH_MM)

    for edges, style in ((view.hidden, Styles.HIDDEN), (view.visible, Styles.EDGE)):
        for edge in edges:
            yield Polyline(tuple(map(placed.on_paper, edge)), style)


def _centre_lines(views: Mapping[ViewName, PlacedView], part: PartDrawing) -> Iterator[Primitive]:
    """Draw planes of symmetry, axes of holes, and a cross in circles with a dimension."""
    for name in (part.plan, "end"):
        left, bottom, right, top = views[name].bounds()
        x, y = views[name].origin
        if name == "end":
            yield line((x, bottom - _PAST_VIEW_MM), (x, top + _PAST_VIEW_MM), Styles.CENTRE)
        else:
            yield line((left - _PAST_VIEW_MM, y), (right + _PAST_VIEW_MM, y), Styles.CENTRE)

    for size in part.sizes:
        if isinstance(size, Circle):
            view = views[size.view]
            x, y = view.place(size.centre)
            reach = size.radius * view.scale + _PAST_VIEW_MM / 2
            yield line((x - reach, y), (x + reach, y), Styles.CENTRE)
            yield line((x, y - reach), (x, y + reach), Styles.CENTRE)


def _section_marks(
    plan: PlacedView, section: PlacedView, *, letters_give_way: bool
) -> Iterator[Primitive]:
    """Draw the section line A-A in the plan with its arrows, and the name over the section.

    The letters stand behind the arrows and over the section's corner. There they block the
    extension lines of sizes that lie near the plane of the section or near that corner; these are
    free where letters give way: past the tips of the arrows, and over the middle of the section.
    """
    left, _, right, _ = plan.bounds()
    y = plan.origin[1]
    towards = 1.0 if PROJECTIONS[plan.name].up[0] > 0.0 else -1.0  # the section looks along +x

    for edge, out in ((left, -1.0), (right, 1.0)):
        near, far = (edge + out * distance for distance in _CUT_MM)
        yield line((near, y), (far, y), Styles.EDGE)
        yield line((far, y), (far, y + towards * 6.0), Styles.EDGE)
        yield Arrow((far, y + towards * 7.5), 90.0 * towards, 3.5)
        middle = y + towards * (_PAST_ARROW_MM if letters_give_way else -_BEHIND_ARROW_MM)
        yield Text("A", (far, middle - _LETTER_MM / 2), _LETTER_MM, "middle")

    left, _, right, top = section.bounds()
    if letters_give_way:
        yield Text("A-A", ((left + right) / 2, top + _NAME_ABOVE_MM), _LETTER_MM, "middle")
    else:
        yield Text("A-A", (left, top + _NAME_ABOVE_MM), _LETTER_MM)
