"""The engraving font: every character a name may hold, no two alike."""

from __future__ import annotations

import random
import string
from collections.abc import Sequence

import pytest

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes import lettering, mold, strokes
from fingertip.cad.solids import intersection, union
from fingertip.design import Design
from fingertip.design.document import parameters
from fingertip.design.mold_layout import lay_out

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


LARGE = ["name=a", "mold.engraving_height_mm=20"]


@pytest.mark.parametrize("changes", [[], LARGE, ["skin.width_mm=30", *LARGE], ["name=thirteen_long"]], ids=str)
def test_letters_stay_on_the_block_and_off_the_nuts(changes: list[str]) -> None:
    design, evaluator = Design.load(changes=changes), Evaluator(0.02)
    m = lay_out(design, design.dimensions)
    letters = union(*mold.engraving(design, m, "palmar"), *mold.engraving(design, m, "dorsal"))
    low_x, _, low_z, high_x, _, high_z = evaluator.manifold(letters).bounding_box()
    assert -m.half_width < low_x < high_x < m.half_width
    assert m.proximal_z < low_z < high_z < m.distal_z
    fastened = union(*mold.nut_traps(design, m), *mold.bolts(design, m))
    assert evaluator.manifold(intersection(letters, fastened)).volume() == 0.0


def test_what_could_not_be_read_is_left_out_and_told() -> None:
    def engraved(*changes: str) -> tuple[list[str], list[str]]:
        design = Design.load(changes=changes)
        m = lay_out(design, design.dimensions)
        return [text for text, _, _ in lettering.lines(design, m, "palmar")], lettering.left_out(design, m)

    assert engraved() == (["fsr400", "palmar"], [])
    long = "abcdefghij" * 4
    assert engraved(f"name={long}") == (["palmar"], [long])
    assert engraved(f"name={long}", "mold.engraving_depth_mm=0") == ([], [])


def test_the_least_height_has_the_least_stroke() -> None:
    (bounds,) = (p.bounds for p in parameters() if p.path == "mold.engraving_height_mm")
    minimum = lettering.MIN_STROKE_MM / lettering.STROKE * strokes.HEIGHT
    assert bounds.startswith(f">= {minimum:g},")
