"""The engraving font: every character a name may hold, no two alike."""

from __future__ import annotations

import string

import pytest

from fingertip.cad import strokes

ALLOWED = string.ascii_letters + string.digits + "-_"


@pytest.mark.parametrize("letter", ALLOWED)
def test_every_letter_of_a_name_can_be_cut(letter: str) -> None:
    found = strokes.quads(letter, 0.8)
    assert found
    for quad in found:
        area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(quad, [*quad[1:], quad[0]], strict=True)) / 2
        assert area > 0, "counter-clockwise"
        assert all(-0.57 <= x <= 4.57 and -0.57 <= y <= 6.57 for x, y in quad)


def test_no_two_letters_look_alike() -> None:
    shapes = {letter: frozenset(strokes.quads(letter, 0.8)) for letter in string.ascii_uppercase + string.digits + "-_"}
    assert len(set(shapes.values())) == len(shapes)


def test_letters_advance() -> None:
    first, second = strokes.quads("I", 0.8), strokes.quads("II", 0.8)
    moved = [tuple((x + strokes.ADVANCE, y) for x, y in quad) for quad in first]
    assert second == [*first, *moved]
    assert strokes.text_width("II") == pytest.approx(10.0)
