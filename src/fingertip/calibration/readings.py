"""Lengths of the coupon that calipers measure, and the file of their readings: its template, and all its faults."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from fingertip.cad.shapes.coupon_layout import AROUND_MM, RIB_MM, WALLS_MM, Spot, lay_out
from fingertip.catalogues.output_files import PLAN
from fingertip.design import Design
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import DesignError, Issue, join_words
from fingertip.foundation.output_set import hash_parameters
from fingertip.foundation.toml_files import read_toml

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


IDENTITY = "coupon"
"""Key that says which coupon the readings belong to."""
MIN_READINGS = 3
"""Least number of readings of a length that has any, so that a slip of the calipers shows."""
MIN_LENGTHS = 3
"""Least number of outer lengths with readings, and of inner ones."""
MAX_SCALE_ERROR, MAX_OFFSET_MM = 0.02, 0.3
"""Largest deviation of a reading from the nominal length: a share of it, and a length [mm]. More is a mistake."""
MAX_WALL_DEVIATION_MM = 0.5
"""Largest deviation of a thin wall, which may be one bead wide [mm]."""
_FACTORS = {"inches": 25.4, "centimetres": 10.0}
"""Units that are mistaken for millimetres, with their size in millimetres."""


@dataclass(frozen=True)
class Measured:
    length: Length
    readings_mm: tuple[float, ...]

    @property
    def mean_mm(self) -> float:
        return math.fsum(self.readings_mm) / len(self.readings_mm)


def identify_coupon(design: Design) -> str:
    return hash_parameters({length.name: length.nominal_mm for length in list_lengths(design)})[:8]


def write_template(design: Design) -> str:
    """Write the file of readings, each length with an empty list."""
    lines = [
        f"# Caliper readings of the fit coupon of {design.name}, in millimetres. Save this file under another name.",
        f"# Write at least {MIN_READINGS} readings of each length, with a decimal point: [12.30, 12.32, 12.31].",
        "# Turn the piece and set the calipers anew for each one. Leave a length empty that you cannot measure.",
        f"# The numbers are those of {PLAN}. All lengths lie in the plane of the bed; none is a height.",
        "",
        f'{IDENTITY} = "{identify_coupon(design)}"  # do not change: it names the coupon that these lengths belong to',
    ]
    titles = {"outer": "Outer lengths", "inner": "Inner lengths", "wall": "Thin walls"}
    before = ""
    for number, length in enumerate(list_lengths(design), 1):
        if length.kind != before:
            lines += ["", f"# {titles[length.kind]}"]
            before = length.kind
        lines.append(f"{length.name} = []  # {number}: nominal {length.nominal_mm:.3f}. {length.where}")
    return "\n".join(lines) + "\n"


def read_readings(path: str | Path, design: Design) -> tuple[Measured, ...]:
    """Read a file of readings of the coupon of a design. Lengths without readings are left out, but for thin walls.

    Raises TomlFileError or DesignError.
    """
    return check_readings(read_toml(Path(path)), design, str(path))


def check_readings(tables: Mapping[str, Any], design: Design, source: str) -> tuple[Measured, ...]:
    """Check the contents of a file of readings, as `read_readings` does; `source` names it in messages."""
    lengths = {length.name: length for length in list_lengths(design)}
    if IDENTITY not in tables and not lengths.keys() & tables.keys():
        remedy = "`fingertip coupon` writes one to fill in"
        raise DesignError(Issue(source, f"is not a file of caliper readings; {remedy}."))
    if issues := list(_find_issues(tables, design, lengths)) or list(_find_missing(tables, lengths.values())):
        raise DesignError(issues)
    measured = (Measured(length, tuple(map(float, tables.get(name, ())))) for name, length in lengths.items())
    return tuple(each for each in measured if each.readings_mm or each.length.kind == "wall")


def _find_issues(tables: Mapping[str, Any], design: Design, lengths: Mapping[str, Length]) -> Iterator[Issue]:
    """Find what cannot be used, in the order of the file."""
    identity = identify_coupon(design)
    if IDENTITY not in tables:
        yield Issue(IDENTITY, "is missing; copy the line from the template that `fingertip coupon` wrote.")
    for name, value in tables.items():
        if name == IDENTITY:
            if value != identity:
                yield Issue(
                    IDENTITY,
                    f"{value!r} is another coupon than that of {design.name}, which is {identity!r}; give the design, "
                    "and the --set, from which the measured coupon was made.",
                )
        elif name not in lengths:
            yield Issue(name, f"is no length of the coupon; {suggest_name(name, list(lengths))}")
        elif not isinstance(value, list):
            yield Issue(name, f"{value!r} is no list of readings; write {MIN_READINGS} or more in square brackets.")
        else:
            for number, reading in enumerate(value, 1):
                if problem := _describe_problem(reading, lengths[name]):
                    yield Issue(name, f"reading {number}, {problem}")


def _describe_problem(reading: Any, length: Length) -> str | None:
    """Describe what is wrong with a reading; None if nothing is."""
    if isinstance(reading, str):
        return f"{reading!r}, is text; write the number in mm with a decimal point and without quotes."
    if isinstance(reading, int) and not isinstance(reading, bool):
        return (
            f"{reading}, is a whole number, as a decimal comma leaves two of them; write it with a decimal point, such "
            f"as {length.nominal_mm:.2f}."
        )
    if not isinstance(reading, float) or not math.isfinite(reading):
        return f"{reading!r}, is not a length; write a number in mm, such as {length.nominal_mm:.2f}."
    if reading <= 0.0:
        return f"{reading:g} mm, is not positive; set the calipers to zero and measure it again."
    nominal = length.nominal_mm
    limit = MAX_WALL_DEVIATION_MM if length.kind == "wall" else MAX_SCALE_ERROR * nominal + MAX_OFFSET_MM
    if abs(reading - nominal) <= limit:
        return None
    for unit, size in _FACTORS.items():
        if length.kind != "wall" and abs(reading * size - nominal) <= limit:
            return f"{reading:g}, looks like {unit}; write it in millimetres, about {nominal:.2f}."
    return (
        f"{reading:g} mm, is more than {limit:.2g} mm off the nominal {nominal:.2f} mm; measure where the template "
        "says, in millimetres, and see that it is not swapped with another length."
    )


def _find_missing(tables: Mapping[str, Any], lengths: Collection[Length]) -> Iterator[Issue]:
    """Find lengths with too few readings, and kinds with too few lengths."""
    for length in lengths:
        count = len(tables.get(length.name, ()))
        needed = 1 if length.kind == "wall" else MIN_READINGS
        if 0 < count < needed:
            yield Issue(length.name, f"{_count(count, 'reading')} cannot show a slip; at least {needed}, or none.")
    for kind in ("outer", "inner"):
        names = [length.name for length in lengths if length.kind == kind]
        missing = [name for name in names if not tables.get(name)]
        given = len(names) - len(missing)
        if given < MIN_LENGTHS:
            yield Issue(
                "readings",
                f"{_count(given, f'{kind} length')} with readings are too few to tell scale from offset; at "
                f"least {MIN_LENGTHS}, such as {join_words(missing[: MIN_LENGTHS - given])}.",
            )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
