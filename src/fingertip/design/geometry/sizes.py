"""Sizes on a part's drawing: what is dimensioned, in which view, with which tolerance, and what to
do if it is out.

Both ends of a length are points in the frame of the part, taken from the dimensions of the design.
The number on the sheet is what calipers read on the print: the distance between them, and what the
printer adds to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from fingertip.design.parameters import Tables
from fingertip.models.solids import Axis, Point3

GENERAL = "ISO 2768-m"
_GENERAL_MM = ((6.0, 0.1), (30.0, 0.2), (120.0, 0.3), (400.0, 0.5))
"""Largest nominal size and its permissible deviation, class m of ISO 2768-1.
Its first class begins at 0.5 mm.
"""
_SHARE = 0.5
"""Share of a clearance that a tolerance may take. An assumption."""
MIN_TOLERANCE_MM = 0.05
"""Least deviation that calipers tell apart on a print [mm].
An assumption: they are accurate to some 0.03 mm.
"""
FIT = "fit, try"
"""Text in place of a tolerance that calipers cannot check."""


@dataclass(frozen=True)
class Tolerance:
    """Permissible deviations from the nominal size [mm]."""

    low: float
    high: float

    def text(self) -> str:
        bounds = [2.0 * abs(bound) for bound in (self.low, self.high) if abs(bound) > 1e-9]
        if min([self.high - self.low, *bounds]) < 2.0 * MIN_TOLERANCE_MM - 1e-9:
            return FIT
        if round(self.high + self.low, 2) == 0.0:
            return f"±{_deviation_text(self.high)}"

        upper, lower = (_deviation_text(d, "+" if d > 0.0 else "-") for d in (self.high, self.low))
        return f"{upper}/{lower}"


def size_text(value: float) -> str:
    return f"{round(value, 2) + 0.0:g}"


def _deviation_text(deviation: float, sign: str = "") -> str:
    """Write a deviation; what a hundredth cannot express is left
    out, so that the tolerance is never wider.
    """
    hundredths = math.floor(abs(deviation) * 100.0 + 1e-6)
    return f"{sign if hundredths else ''}{hundredths / 100.0:g}"


def symmetric(deviation: float) -> Tolerance:
    return Tolerance(-deviation, deviation)


def general(size: float) -> Tolerance:
    return symmetric(
        next((deviation for limit, deviation in _GENERAL_MM if size <= limit), _GENERAL_MM[-1][1])
    )


def located(design: Tables, size: float) -> Tolerance:
    """Tolerance of a size between two surfaces that locate bone or
    core: the play in the mold counts on it.
    """
    error = 2.0 * design.printer.surface_error_mm
    return symmetric(max(error, MIN_TOLERANCE_MM)) if error else general(size)


def clearance(gap: float) -> Tolerance:
    """Tolerance of a size that leaves a `gap` [mm] in the print to
    its counterpart, of which half must be left.
    """
    return symmetric(_SHARE * max(gap, 0.0))


def shared_clearance(gap: float) -> Tolerance:
    """Tolerance of a size if its counterpart is printed too and
    takes as much of the `gap` [mm] in the print.
    """
    return clearance(gap / 2.0)


def bore(design: Tables) -> Tolerance:
    """Tolerance of a bore that is reamed to its pin: never wider
    than the print's error on both sides.
    """
    return (
        Tolerance(-2.0 * design.printer.surface_error_mm, 0.0)
        if design.printer.surface_error_mm
        else symmetric(0.1)
    )


ViewName = Literal["front", "dorsal", "palmar", "end", "section"]
Side = Literal["above", "below", "left", "right"]
ARROW_DEG = 5.0
"""Angle between the end of an arc and the arrow that points to it."""
AXES: dict[Axis, int] = {"x": 0, "y": 1, "z": 2}
OUTER = 1.0
INNER = -1.0
STEP = 0.0
"""Growth of a length between two faces that look outwards, inwards,
or the same way; of one between two axes, 0.
"""
BEHIND_FACE = 0.5
BEFORE_FACE = -0.5
"""Growth of a length between a face and an axis that lies in the
material behind it, or in the air before it.
"""
FINISHED = 0.0
"""Growth of a hole that is drilled or reamed to its size."""
SCALE_REMEDY = "correct printer.scale_percent"
"""Remedy for a length that is out by more than its tolerance, on drawings of every part."""


@dataclass(frozen=True)
class Length:
    """Distance along an axis between two points."""

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
    is_reference: bool = False
    """True if no surface lies at one of its ends, so that calipers
    cannot measure it: it stands in parentheses.
    """
    added_mm: float = 0.0

    @property
    def value(self) -> float:
        return abs(self.end[AXES[self.axis]] - self.start[AXES[self.axis]])

    @property
    def printed(self) -> float:
        """Size that calipers read on the print [mm]."""
        return self.value + self.added_mm

    def text(self) -> str:
        text = _with_tolerance(size_text(self.printed), self.tolerance)
        return f"({text})" if self.is_reference else text


@dataclass(frozen=True)
class Circle:
    """Diameter of circles, or radius of an arc, seen along their axis; one of them is
    dimensioned.
    """

    name: str
    growth: float
    """Share of printer.offset_mm that the print's diameter, or radius, is larger than
    the model's.
    """
    view: ViewName
    axis: Axis
    centre: Point3
    radius: float
    tolerance: Tolerance | None = None
    action: str = ""
    count: int = 1
    is_radius: bool = False
    hidden_deg: tuple[tuple[float, float], ...] = ()
    """Ranges of directions in the view in which the part has no
    such edge, of an arc that is no circle.
    """
    added_mm: float = 0.0

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
        count = f"{self.count}× " if self.count > 1 else ""
        return _with_tolerance(
            count + ("R" if self.is_radius else "Ø") + size_text(self.printed), self.tolerance
        )


Size: TypeAlias = Length | Circle


@dataclass(frozen=True)
class PartDrawing:
    """Content of the sheet of a part, besides its edges."""

    part: str
    title: str
    plan: ViewName
    """View from the dorsal or the palmar side."""
    material: str
    sizes: tuple[Size, ...]
    notes: tuple[str, ...] = ()

    @property
    def views(self) -> tuple[ViewName, ...]:
        return ("front", self.plan, "end", "section")

    @property
    def checked(self) -> tuple[Size, ...]:
        """Sizes to check with calipers, in the order of their balloons."""
        return tuple(size for size in self.sizes if size.action)


def _with_tolerance(text: str, tolerance: Tolerance | None) -> str:
    return f"{text} {tolerance.text()}" if tolerance else text
