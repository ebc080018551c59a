"""The engraving font: every character a name may hold, no two alike."""

from __future__ import annotations

import random
import string
from collections.abc import Sequence

import pytest

from fingertip.cad.shapes import strokes

ALLOWED = string.ascii_letters + string.digits + "-_"


STROKE = 0.8


def area(ring: Sequence[strokes.Point]) -> float:
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)) / 2


def within(point: strokes.Point, ring: Sequence[strokes.Point]) -> bool:
    """Whether a ray to the right crosses the ring an odd number of times."""
    x, y = point
    edges = zip(ring, [*ring[1:], ring[0]], strict=True)
    return sum(
        (a[1] > y) != (b[1] > y) and x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in edges
    ) % 2 == 1  # fmt: skip


@pytest.mark.parametrize("letter", ALLOWED)
def test_every_letter_of_a_name_can_be_cut(letter: str) -> None:
    for quad in strokes.quads(letter, STROKE):
        assert area(quad) > 0, "counter-clockwise"
        assert all(-0.57 <= x <= 4.57 and -0.57 <= y <= 6.57 for x, y in quad)
    for outline, *counters in strokes.letters(letter, STROKE):
        assert area(outline) > 0
        assert all(area(ring) < 0 for ring in counters)


@pytest.mark.parametrize("letter", string.ascii_uppercase + string.digits + "-_")
def test_a_letter_covers_what_its_strokes_cover(letter: str) -> None:
    """At 2 000 places of its own: inside one stroke at least, or inside the outline and no counter."""
    quads, pieces = strokes.quads(letter, STROKE), strokes.letters(letter, STROKE)
    rng = random.Random(letter)
    for _ in range(2000):
        point = (rng.uniform(-0.7, 4.7), rng.uniform(-0.7, 6.7))
        by_stroke = any(within(point, quad) for quad in quads)
        assert by_stroke == (sum(within(point, ring) for rings in pieces for ring in rings) % 2 == 1)


def test_an_o_has_a_counter_and_a_b_two() -> None:
    assert {letter: [len(rings) for rings in strokes.letters(letter, STROKE)] for letter in "COB8"} == {
        "C": [1], "O": [2], "B": [3], "8": [3],
    }  # fmt: skip


def test_no_two_letters_look_alike() -> None:
    shapes = {
        letter: tuple(strokes.letters(letter, STROKE)) for letter in string.ascii_uppercase + string.digits + "-_"
    }
    assert len(set(shapes.values())) == len(shapes)


def test_letters_advance() -> None:
    first, second = strokes.letters("I", STROKE), strokes.letters("II", STROKE)
    moved = [tuple(tuple((x + strokes.ADVANCE, y) for x, y in ring) for ring in rings) for rings in first]
    assert second == [*first, *moved]
    assert strokes.text_width("II") == pytest.approx(10.0)
