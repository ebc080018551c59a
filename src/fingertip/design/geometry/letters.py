"""Stroke font of the text engraved into the mold.

The font is made of straight strokes on a 4 x 6 grid. Both kernels therefore cut the same letters,
and no system font is needed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType

from fingertip.models.engraving import STROKE_WIDTH, Letter, Point

# A letter is a set of polylines, and a polyline a list of points "xy": x 0 to 4, y 0 (baseline) to
# 6 (cap height). The letters have few strokes, because each one costs the B-rep kernel a boolean.
_GLYPHS = {
    "0": "00 40 46 06 00",
    "1": "05 26 20",
    "2": "06 46 43 03 00 40",
    "3": "06 46 40 00|13 43",
    "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 00",
    "6": "46 06 00 40 43 03",
    "7": "06 46 10",
    "8": "00 40 46 06 00|03 43",
    "9": "43 03 06 46 40 00",
    "A": "00 26 40|12 32",
    "B": "00 06 36 33 03|33 43 40 00",
    "C": "46 06 00 40",
    "D": "00 06 26 44 42 20 00",
    "E": "46 06 00 40|03 33",
    "F": "46 06 00|03 33",
    "G": "46 06 00 40 43 23",
    "H": "00 06|40 46|03 43",
    "I": "20 26",
    "J": "46 40 00 02",
    "K": "00 06|46 03 40",
    "L": "06 00 40",
    "M": "00 06 23 46 40",
    "N": "00 06 40 46",
    "O": "10 30 41 45 36 16 05 01 10",
    "P": "00 06 46 43 03",
    "Q": "00 40 46 06 00|22 40",
    "R": "00 06 46 43 03|23 40",
    "S": "46 06 03 43 40 00",
    "T": "06 46|26 20",
    "U": "06 00 40 46",
    "V": "06 20 46",
    "W": "06 10 23 30 46",
    "X": "00 46|06 40",
    "Y": "06 23 46|23 20",
    "Z": "06 46 00 40",
    "-": "13 33",
    "_": "00 40",
}


@lru_cache(maxsize=1)
def outline_letters() -> Mapping[str, Letter]:
    """Outline all letters of the font."""
    return MappingProxyType({name: outline_letter(name, STROKE_WIDTH) for name in _GLYPHS})


def outline_letter(name: str, stroke_width: float) -> Letter:
    """Unite the strokes of a letter."""
    from manifold3d import CrossSection, FillRule  # noqa: PLC0415

    united = CrossSection(stroke_rectangles(name, stroke_width), FillRule.NonZero)
    return tuple(
        tuple(
            tuple((round(float(x), 9), round(float(y), 9)) for x, y in ring)
            for ring in piece.to_polygons()
        )
        for piece in united.decompose()
    )


def stroke_rectangles(letter: str, stroke_width: float) -> list[tuple[Point, ...]]:
    """Return the strokes of a letter as rectangles [grid units],
    counter-clockwise, which overlap at a corner.
    """
    polylines = (polyline.split() for polyline in _GLYPHS[letter.upper()].split("|"))
    lines = ([(float(xy[0]), float(xy[1])) for xy in points] for points in polylines)
    return [_rectangle(a, b, stroke_width / 2) for line in lines for a, b in pairwise(line)]


def _rectangle(a: Point, b: Point, half: float) -> tuple[Point, ...]:
    """Return the rectangle around the stroke from `a` to `b`, extended on all sides by `half`."""
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    ux = half * (b[0] - a[0]) / length
    uy = half * (b[1] - a[1]) / length

    return (
        (a[0] - ux + uy, a[1] - uy - ux),
        (b[0] + ux + uy, b[1] + uy - ux),
        (b[0] + ux - uy, b[1] + uy + ux),
        (a[0] - ux - uy, a[1] - uy + ux),
    )
