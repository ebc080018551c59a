"""Feet: the fillets where a thin part of the bone stands on a wider one, drawn as chords of an arc.

       outward
          ^             | wide part
          |             |
          |            /|
          |          .' |
          |_____..--'   |
     thin part        root_z   --> z, if `way` is 1

A foot runs on into the solids on both sides, so that no faces coincide.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .solids import Axis, Solid, extrude

_CHORDS = 6
"""Chords of a quarter of a circle: the surface bends by 15 degrees at most."""
_INTO_MM = 0.1
"""Length by which a foot reaches into the thin part [mm]."""


@dataclass(frozen=True)
class Foot:
    """Section of a foot [mm]."""

    line: tuple[tuple[float, float], ...]
    """Points (z, outward) from within the thin part to the root, where the wide part begins."""
    length: float
    """Length of the thin part that the foot covers."""


def arc_foot(radius: float, root_z: float, way: float) -> Foot:
    """Make a foot of a quarter circle; the wide part lies towards `way`, 1 or -1 [mm]."""
    arc = _arc(radius, root_z, way, chords=_CHORDS)
    return Foot(_run_on(arc, way), radius)


def sloping_foot(radius: float, root_z: float, way: float, reach: float) -> Foot:
    """Make a foot of half a quarter circle, and of 45 degrees from there on out to `reach` at the
    root [mm].

    It prints without supports.
    """
    length = reach + radius * (math.sqrt(2.0) - 1.0)
    arc = _arc(radius, root_z, way, chords=_CHORDS // 2, before_root=length - radius)
    return Foot(_run_on([*arc, (root_z, reach)], way), length)


def _arc(
    radius: float, root_z: float, way: float, chords: int, before_root: float = 0.0
) -> list[tuple[float, float]]:
    """List points of a quarter circle that would end before the root, as far as some chords go."""
    angles = [math.pi / 2 * i / _CHORDS for i in range(chords + 1)]
    return [
        (
            root_z - way * (before_root + radius * (1.0 - math.sin(angle))),
            radius * (1.0 - math.cos(angle)),
        )
        for angle in angles
    ]


def _run_on(line: list[tuple[float, float]], way: float) -> tuple[tuple[float, float], ...]:
    """Begin a line within the thin part, by the slope of its first chord."""
    (first_z, first_out), (second_z, second_out) = line[:2]
    rise = second_out - first_out
    run = abs(second_z - first_z)

    return (first_z - way * _INTO_MM, first_out - _INTO_MM * rise / run), *line[1:]


def flat_foot(
    axis: Axis,
    low_side: float,
    high_side: float,
    foot: Foot,
    end: float,
    reach: float,
) -> Solid:
    """Build the foot of flats along an axis across the finger, between two sides [mm]; it ends at z
    = `end`.
    """
    outline = [*foot.line, (end, foot.line[-1][1])]
    low_line = [(z, low_side - out) for z, out in outline]
    high_line = [(z, high_side + out) for z, out in outline]

    return extrude(axis, [*low_line, *reversed(high_line)], -reach, reach)
