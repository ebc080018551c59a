"""Sizes on a drawing: what is dimensioned, in which view, with which tolerance, and what to do if it is out.

Both ends of a length are points in the frame of the part, taken from the dimensions of the design. The number on the
sheet is what calipers read on the print: the distance between them, and what the printer adds to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from fingertip.cad.solids import Axis, Point3
from fingertip.drawing.tolerances import Tolerance, size_text
from fingertip.drawing.views import ViewName

Side = Literal["above", "below", "left", "right"]
AXES: dict[Axis, int] = {"x": 0, "y": 1, "z": 2}
OUTER, INNER, STEP = 1.0, -1.0, 0.0
"""Growth of a length between two faces that look outwards, inwards, or the same way; of one between two axes, 0."""
BEHIND_FACE, BEFORE_FACE = 0.5, -0.5
"""Growth of a length between a face and an axis that lies in the material behind it, or in the air before it."""
FINISHED = 0.0
"""Growth of a hole that is drilled or reamed to its size."""
SCALE_REMEDY = "correct printer.scale_percent"
"""Remedy for a length that is out by more than its tolerance, on drawings of every part."""


@dataclass(frozen=True)
class Length:
    """Distance along an axis between two points; the diameter of a hole if it is seen from its side."""

    name: str
    growth: float
    """Share of printer.offset_mm that the print is longer than the model."""
    view: ViewName
    side: Side
    """Side of the view on which the dimension line lies."""
    axis: Axis
    start: Point3
    end: Point3
    tolerance: Tolerance | None = None
    """Tolerance; the general one if None."""
    action: str = ""
    """Remedy if the size is out of tolerance. Sizes with one are those to check."""
    is_diameter: bool = False
    is_reference: bool = False
    """True if no surface lies at one of its ends, so that calipers cannot measure it: it stands in parentheses."""
    added_mm: float = 0.0
    """Length that the printer adds [mm]."""

    @property
    def value(self) -> float:
        """Size in the model [mm]."""
        return abs(self.end[AXES[self.axis]] - self.start[AXES[self.axis]])

    @property
    def printed(self) -> float:
        """Size that calipers read on the print [mm]."""
        return self.value + self.added_mm

    def text(self) -> str:
        """Write the size as on the drawing."""
        text = _with_tolerance(("Ø" if self.is_diameter else "") + size_text(self.printed), self.tolerance)
        return f"({text})" if self.is_reference else text


@dataclass(frozen=True)
class Circle:
    """Diameter of circles, or radius of an arc, seen along their axis; one of them is dimensioned."""

    name: str
    growth: float
    """Share of printer.offset_mm that the print's diameter, or radius, is larger than the model's."""
    view: ViewName
    axis: Axis
    centre: Point3
    radius: float
    tolerance: Tolerance | None = None
    action: str = ""
    count: int = 1
    is_radius: bool = False
    hidden_deg: tuple[tuple[float, float], ...] = ()
    """Ranges of directions in the view in which the part has no such edge, of an arc that is no circle."""
    added_mm: float = 0.0
    """Length that the printer adds [mm]."""

    @property
    def value(self) -> float:
        """Diameter, or radius, in the model [mm]."""
        return self.radius if self.is_radius else 2.0 * self.radius

    @property
    def printed(self) -> float:
        """Size that calipers read on the print [mm]."""
        return self.value + self.added_mm

    def has_edge_at(self, direction_deg: float) -> bool:
        """Tell whether an arrow from a direction in the view meets the arc."""
        return not any((direction_deg - low) % 360.0 < high - low for low, high in self.hidden_deg)

    def text(self) -> str:
        """Write the size as on the drawing."""
        count = f"{self.count}× " if self.count > 1 else ""
        return _with_tolerance(count + ("R" if self.is_radius else "Ø") + size_text(self.printed), self.tolerance)


Size: TypeAlias = Length | Circle


@dataclass(frozen=True)
class AxisLine:
    """Axis of a hole that a view shows from its side."""

    view: ViewName
    start: Point3
    end: Point3


@dataclass(frozen=True)
class PartDrawing:
    """Content of the sheet of a part, besides its edges."""

    part: str
    title: str
    plan: ViewName
    """View from the dorsal or the palmar side."""
    material: str
    sizes: tuple[Size, ...]
    axes: tuple[AxisLine, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def views(self) -> tuple[ViewName, ...]:
        """Views on the sheet."""
        return ("front", self.plan, "end", "section")

    @property
    def checked(self) -> tuple[Size, ...]:
        """Sizes to check with calipers, in the order of their balloons."""
        return tuple(size for size in self.sizes if size.action)


def _with_tolerance(text: str, tolerance: Tolerance | None) -> str:
    return f"{text} {tolerance.text()}" if tolerance else text
