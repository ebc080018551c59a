"""Lines of placed views: their edges and hatching, centre lines, and the marks of the section."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fingertip.design.geometry.sizes import Circle, PartDrawing, ViewName
from fingertip.pictures.drawing.placed_views import (
    LETTER_MM,
    NAME_ABOVE_MM,
    SECTION_LINE_BEGIN_MM,
    SECTION_LINE_END_MM,
    PlacedView,
)
from fingertip.pictures.drawing.primitives import (
    PROJECTIONS,
    Arrow,
    Hatch,
    Line2,
    Point,
    Polyline,
    Primitive,
    Styles,
    Text,
    line,
)

_HATCH_MM = 2.5
"""Distance of the lines of hatching."""
_PAST_VIEW_MM = 3.0
"""Length of a centre line past the view."""
_PAST_CIRCLE_MM = 1.5
"""Length of a centre line past a circle."""
_SHAFT_MM = 6.0
"""Length of the shaft of an arrow on the section line."""
_TIP_MM = 7.5
"""Distance of the tip of an arrow from the section line."""
_HEAD_MM = 3.5
"""Length of the head of an arrow on the section line."""
_BEHIND_ARROW_MM = 2.0 + LETTER_MM / 2
"""Distance of a letter's middle from the section line, on the side away from the arrow."""
_PAST_ARROW_MM = 8.5 + LETTER_MM / 2
"""Distance of a letter's middle from the section line, past the tip of the arrow."""


def draw_view_lines(
    views: Mapping[ViewName, PlacedView], part: PartDrawing, *, letters_give_way: bool
) -> Iterator[Primitive]:
    """Draw all lines of a part's views and the marks of its section, without dimensions.

    The section's letters stand behind its arrows and over its corner. There they block the
    extension lines of sizes that lie near the plane of the section or near that corner; these are
    free where letters give way: past the tips of the arrows, and over the middle of the section.
    """
    for view in views.values():
        yield from _edges(view)

    yield from _symmetry_lines(views, part)
    yield from _circle_crosses(views, part)
    yield from _section_line(views[part.plan], letters_give_way=letters_give_way)
    yield _section_name(views["section"], letters_give_way=letters_give_way)


def _edges(placed: PlacedView) -> Iterator[Primitive]:
    """Draw the edges of a view, and visible ones over hidden ones and hatching."""

    def on_paper(points: Line2) -> tuple[Point, ...]:
        return tuple(placed.on_paper(point) for point in points)

    view = placed.view
    if view.cut:
        yield Hatch(tuple(on_paper(ring) for ring in view.cut), _HATCH_MM)

    for edge in view.hidden:
        yield Polyline(on_paper(edge), Styles.HIDDEN)

    for edge in view.visible:
        yield Polyline(on_paper(edge), Styles.EDGE)


def _symmetry_lines(views: Mapping[ViewName, PlacedView], part: PartDrawing) -> Iterator[Primitive]:
    """Draw the plane of symmetry in the plan and in the view of the end."""
    plan = views[part.plan]
    left, _, right, _ = plan.bounds()
    y = plan.origin[1]
    yield line((left - _PAST_VIEW_MM, y), (right + _PAST_VIEW_MM, y), Styles.CENTRE)

    end = views["end"]
    _, bottom, _, top = end.bounds()
    x = end.origin[0]
    yield line((x, bottom - _PAST_VIEW_MM), (x, top + _PAST_VIEW_MM), Styles.CENTRE)


def _circle_crosses(views: Mapping[ViewName, PlacedView], part: PartDrawing) -> Iterator[Primitive]:
    """Draw a cross of centre lines in each circle with a dimension."""
    for size in part.sizes:
        if isinstance(size, Circle):
            view = views[size.view]
            x, y = view.place(size.centre)
            reach = size.radius * view.scale + _PAST_CIRCLE_MM
            yield line((x - reach, y), (x + reach, y), Styles.CENTRE)
            yield line((x, y - reach), (x, y + reach), Styles.CENTRE)


def _section_line(plan: PlacedView, *, letters_give_way: bool) -> Iterator[Primitive]:
    """Draw both ends of the section line A-A in the plan, each with its arrow and its letter."""
    left, _, right, _ = plan.bounds()
    y = plan.origin[1]
    # The section looks along +x.
    towards = 1.0 if PROJECTIONS[plan.name].up[0] > 0.0 else -1.0
    letter_offset = _PAST_ARROW_MM if letters_give_way else -_BEHIND_ARROW_MM
    baseline = y + towards * letter_offset - LETTER_MM / 2

    for edge, out in ((left, -1.0), (right, 1.0)):
        begin = edge + out * SECTION_LINE_BEGIN_MM
        end = edge + out * SECTION_LINE_END_MM
        yield line((begin, y), (end, y), Styles.EDGE)
        yield line((end, y), (end, y + towards * _SHAFT_MM), Styles.EDGE)
        yield Arrow((end, y + towards * _TIP_MM), 90.0 * towards, _HEAD_MM)
        yield Text("A", (end, baseline), LETTER_MM, "middle")


def _section_name(section: PlacedView, *, letters_give_way: bool) -> Text:
    """Write the name of the section over it."""
    left, _, right, top = section.bounds()
    baseline = top + NAME_ABOVE_MM
    if letters_give_way:
        return Text("A-A", ((left + right) / 2, baseline), LETTER_MM, "middle")

    return Text("A-A", (left, baseline), LETTER_MM)
