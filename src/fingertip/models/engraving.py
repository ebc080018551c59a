r"""Lines of text engraved into a face. Lower-case letters are engraved as capitals.

 _____         ^
|     \        |
|_____/     6 HEIGHT, between the middles of its strokes, which are 0.8 STROKE_WIDTH wide
|              |
|              v
|<----- 6 ADVANCE ----->|  to the next letter        [grid units]
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from .allowances import PAST_MM
from .solids import Axis, Prism, signed_area

if TYPE_CHECKING:
    from .program_types import Finger

Point = tuple[float, float]
Rings = tuple[tuple[Point, ...], ...]
"""Outline of a letter or of a piece of it, and its holes [grid units]."""
Letter = tuple[Rings, ...]
"""Pieces of a letter."""
HEIGHT = 6.0
"""Height of a letter, measured between the centre lines of its strokes [grid units]."""
ADVANCE = 6.0
"""Distance from one letter to the next [grid units]."""
STROKE_WIDTH = 0.8
MIN_STROKE_MM = 0.4
"""Minimum stroke width [mm]. Narrower strokes close up in printing. The minimum letter height
follows from it. An assumption.
"""
_TEXT_SHARE = 0.85
"""Length of a line of text over that of its face."""


def text_width(text: str) -> float:
    """Compute the width of a line of text, from the first stroke to the last [grid units]."""
    return ADVANCE * len(text) - (ADVANCE - 4.0)


def letter_outlines(letters: Mapping[str, Letter], text: str) -> tuple[Rings, ...]:
    """Place the letters of a line of text, in grid units with x to the right and y up."""
    outlines = []
    for position, letter in enumerate(text.upper()):
        for piece in letters[letter]:
            rings = [[(x + ADVANCE * position, y) for x, y in ring] for ring in piece]
            rings.sort(key=signed_area, reverse=True)
            outlines.append(tuple(map(_rotate_to_minimum, rings)))

    return tuple(outlines)


def engrave(
    finger: Finger,
    axis: Axis,
    text: str,
    height: float,
    length: float,
    centre: float,
    face: float,
) -> tuple[Prism, ...]:
    """Build letters in the face at a negative y or z, around x = 0; none where they are too small
    to read.
    """
    unit = min(
        finger.mold.engraving_height_mm / HEIGHT,
        _TEXT_SHARE * height / (HEIGHT + STROKE_WIDTH),
        _TEXT_SHARE * length / text_width(text),
    )
    depth = finger.mold.engraving_depth_mm
    if not depth or STROKE_WIDTH * unit < MIN_STROKE_MM:
        return ()

    middle = text_width(text) / 2
    up = (1.0 if axis == "z" else -1.0) * unit  # on the plate y is up, on the standing cup -z
    return tuple(
        _engrave_piece(
            axis,
            rings=[
                [(unit * (middle - u), centre + up * (v - HEIGHT / 2)) for u, v in ring]
                for ring in piece
            ],
            low=face - PAST_MM,
            high=face + depth,
        )
        for piece in letter_outlines(finger.letters, text)
    )


def _engrave_piece(axis: Axis, rings: Sequence[list[Point]], low: float, high: float) -> Prism:
    if axis == "y":
        rings = [[(z, x) for x, z in ring] for ring in rings]

    if signed_area(rings[0]) <= 0.0:
        rings = [ring[::-1] for ring in rings]

    outline, *holes = map(tuple, rings)
    return Prism(axis=axis, corners=outline, low=low, high=high, holes=tuple(holes))


def _rotate_to_minimum(ring: list[Point]) -> tuple[Point, ...]:
    """Start a ring at its smallest corner; which corner manifold3d starts at is not specified."""
    first = ring.index(min(ring))
    return (*ring[first:], *ring[:first])
