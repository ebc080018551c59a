"""Engraving font and layout: every character a name may hold is
distinct, legible and within the mold.
"""

from __future__ import annotations

import random
import string
from collections.abc import Sequence

import pytest

from fingertip.design.design_file import list_parameters
from fingertip.design.geometry.letters import outline_letters, stroke_rectangles
from fingertip.models import engraving
from fingertip.models.engraving import HEIGHT, STROKE_WIDTH, letter_outlines

ALLOWED = string.ascii_letters + string.digits + "-_"
LETTERS = string.ascii_uppercase + string.digits + "-_"
"""Characters with a shape of their own."""


def area(ring: Sequence[engraving.Point]) -> float:
    return (
        sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)) / 2
    )


def is_inside(point: engraving.Point, ring: Sequence[engraving.Point]) -> bool:
    """Test whether a ray from the point to the right crosses the ring an odd number of times."""
    x, y = point
    edges = zip(ring, [*ring[1:], ring[0]], strict=True)
    return (
        sum(
            (a[1] > y) != (b[1] > y) and x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            for a, b in edges
        )
        % 2
        == 1
    )


def test_outlines_are_valid_and_cover_the_same_area_as_the_strokes() -> None:
    """Strokes and outlines run counter-clockwise, and counters clockwise.

    Random points lie inside a stroke exactly if they lie inside the outline and in no counter.
    """
    wrong = []
    for letter in ALLOWED:
        rectangles = stroke_rectangles(letter, STROKE_WIDTH)
        pieces = letter_outlines(outline_letters(), letter)
        wrong += [letter for ring in rectangles if area(ring) <= 0]
        wrong += [
            letter
            for ring in rectangles
            for x, y in ring
            if not (-0.57 <= x <= 4.57 and -0.57 <= y <= 6.57)
        ]
        wrong += [
            letter
            for outline, *counters in pieces
            if area(outline) <= 0 or any(area(c) >= 0 for c in counters)
        ]
        rng = random.Random(letter)
        for _ in range(500 if letter in LETTERS else 0):
            point = (rng.uniform(-0.7, 4.7), rng.uniform(-0.7, 6.7))
            by_stroke = any(is_inside(point, rectangle) for rectangle in rectangles)
            if by_stroke != (
                sum(is_inside(point, ring) for rings in pieces for ring in rings) % 2 == 1
            ):
                wrong.append(letter)
    assert wrong == []


def test_all_letters_differ_and_follow_each_other_at_a_constant_distance() -> None:
    shapes = {letter: tuple(letter_outlines(outline_letters(), letter)) for letter in LETTERS}
    assert len(set(shapes.values())) == len(shapes)
    first = letter_outlines(outline_letters(), "I")
    second = letter_outlines(outline_letters(), "II")
    moved = [
        tuple(tuple((x + engraving.ADVANCE, y) for x, y in ring) for ring in rings)
        for rings in first
    ]
    assert second == (*first, *moved)
    assert engraving.text_width("II") == pytest.approx(10.0)


def test_min_height_in_the_parameters_corresponds_to_the_min_stroke() -> None:
    (bounds,) = (p.bounds for p in list_parameters() if p.path == "mold.engraving_height_mm")
    minimum = engraving.MIN_STROKE_MM / STROKE_WIDTH * HEIGHT
    assert bounds.startswith(f">= {minimum:g},")
