"""A stroke font for engraving: straight strokes on a 4 x 6 grid, so that both kernels cut the same letters and no
system font is needed. Small letters are cut as capitals."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

Point = tuple[float, float]
Rings = tuple[tuple[Point, ...], ...]

ADVANCE = 6.0
HEIGHT = 6.0

# Each letter is some polylines, each polyline digits "xy" on the grid: x 0 to 4, y 0 (foot) to 6 (head).
# Few strokes, because each costs the B-rep kernel a cut.
_GLYPHS = {
    "0": "00 40 46 06 00", "1": "05 26 20", "2": "06 46 43 03 00 40", "3": "06 46 40 00|13 43", "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 00", "6": "46 06 00 40 43 03", "7": "06 46 10", "8": "00 40 46 06 00|03 43",
    "9": "43 03 06 46 40 00", "A": "00 26 40|12 32", "B": "00 06 36 33 03|33 43 40 00", "C": "46 06 00 40",
    "D": "00 06 26 44 42 20 00", "E": "46 06 00 40|03 33", "F": "46 06 00|03 33", "G": "46 06 00 40 43 23",
    "H": "00 06|40 46|03 43", "I": "20 26", "J": "46 40 00 02", "K": "00 06|46 03 40", "L": "06 00 40",
    "M": "00 06 23 46 40", "N": "00 06 40 46", "O": "10 30 41 45 36 16 05 01 10", "P": "00 06 46 43 03",
    "Q": "00 40 46 06 00|22 40", "R": "00 06 46 43 03|23 40", "S": "46 06 03 43 40 00", "T": "06 46|26 20",
    "U": "06 00 40 46", "V": "06 20 46", "W": "06 10 23 30 46", "X": "00 46|06 40", "Y": "06 23 46|23 20",
    "Z": "06 46 00 40", "-": "13 33", "_": "00 40",
}  # fmt: skip


def text_width(text: str) -> float:
    """Width of a line of text in grid units, from the first stroke to the last."""
    return ADVANCE * len(text) - (ADVANCE - 4.0)


def letters(text: str, stroke: float) -> list[Rings]:
    """The letters of a line of text in grid units, x to the right and y up, their strokes united.

    Returns
    -------
    letters
        Rings of each: its outline counter-clockwise, then its counters (what an O surrounds) clockwise.
    """
    from manifold3d import CrossSection, FillRule

    found = []
    for place, letter in enumerate(text.upper()):
        united = CrossSection(quads(letter, stroke), FillRule.NonZero)
        for piece in united.decompose():
            rings = [
                [(round(x, 9) + ADVANCE * place, round(y, 9)) for x, y in np.asarray(ring).tolist()]
                for ring in piece.to_polygons()
            ]
            found.append(tuple(_above_minimum(ring) for ring in sorted(rings, key=_area, reverse=True)))
    return found


def quads(letter: str, stroke: float) -> list[tuple[Point, ...]]:
    """The strokes of one letter as rectangles in grid units, counter-clockwise.

    Each stroke is `stroke` wide and longer by half of that at both ends, so that the strokes of a corner overlap.
    """
    found = []
    for polyline in _GLYPHS[letter.upper()].split("|"):
        points = [(float(xy[0]), float(xy[1])) for xy in polyline.split()]
        found += [_quad(a, b, stroke / 2) for a, b in pairwise(points)]
    return found


def _above_minimum(ring: list[Point]) -> tuple[Point, ...]:
    """The ring begun at its least corner, wherever a library began it."""
    first = ring.index(min(ring))
    return (*ring[first:], *ring[:first])


def _area(ring: list[Point]) -> float:
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise([*ring, ring[0]])) / 2


def _quad(a: Point, b: Point, half: float) -> tuple[Point, ...]:
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    ux, uy = half * (b[0] - a[0]) / length, half * (b[1] - a[1]) / length
    return (
        (a[0] - ux + uy, a[1] - uy - ux),
        (b[0] + ux + uy, b[1] + uy - ux),
        (b[0] + ux - uy, b[1] + uy + ux),
        (a[0] - ux - uy, a[1] - uy + ux),
    )
