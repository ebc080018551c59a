"""Assembly drawing of a board: every part with its value, no text
over another, and bars at the cathodes.
"""

from __future__ import annotations

from itertools import combinations, groupby
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import SUPPRESSOR, board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.fabrication.bom import purchased_components
from fingertip.board.kicad.project import load_project
from fingertip.pictures.board_assembly import draw_assembly
from fingertip.pictures.board_sheet import SCALE
from fingertip.pictures.drawing.primitives import Polyline, Ring, Sheet, Text
from tests.approved import check_text
from tests.designs import load_article


def draw(variant: str) -> tuple[Sheet, dict[str, str]]:
    """Draw the board of a variant, and return the values of what is on it."""
    circuit = board_circuit(board_values(load_article(VARIANT_CHANGES[variant])))
    sheet = draw_assembly(circuit, load_project(variant).placement, "board")
    return sheet, {c.reference: c.value for c in purchased_components(circuit)}


@pytest.mark.every_case
@pytest.mark.parametrize("variant", VARIANT_CHANGES)
def test_every_part_is_drawn_once_with_its_value_and_no_text_covers_another(variant: str) -> None:
    sheet, values = draw(variant)
    placement = load_project(variant).placement
    frame = next(p for p in sheet.primitives if isinstance(p, Polyline) and p.style.name == "board")
    left, bottom = frame.points[0]
    right, top = frame.points[2]
    assert (right - left, top - bottom) == pytest.approx(
        (SCALE * placement.width, SCALE * placement.height)
    )
    texts = [p for p in sheet.primitives if isinstance(p, Text)]
    on_board = [t for t in texts if t.at[0] < right and t.at[1] < top]
    for reference, value in values.items():
        x0, y0, x1, y1 = placement.parts[reference].body or (0, 0, 0, 0)
        body = left + SCALE * x0, top - SCALE * y1, left + SCALE * x1, top - SCALE * y0
        inside = [
            t.text
            for t in on_board
            if body[0] < t.box()[0]
            and body[1] < t.box()[1]
            and t.box()[2] < body[2]
            and t.box()[3] < body[3]
        ]
        # Ohms have an R, and a suppressor's name is too long for its outline.
        alone = reference if value == SUPPRESSOR else ""
        assert " ".join(inside) in (f"{reference} {value}", f"{reference} {value}R", alone), (
            reference
        )
    for a, b in combinations((t.box() for t in texts), 2):
        assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
    for hole in (p for p in sheet.primitives if isinstance(p, Ring) and p.style.name == "pad"):
        x, y = hole.centre
        r = hole.radius
        covered = [
            t.text
            for t in on_board
            if t.box()[0] < x + r
            and t.box()[2] > x - r
            and t.box()[1] < y + r
            and t.box()[3] > y - r
        ]
        assert all(name.startswith("TP") for name in covered), (
            "only the circle of a test point holds a name"
        )
    beside = [text for text in texts if text.at[0] > right]
    assert set(values) <= {word for text in beside for word in text.text.split(" ")}
    if variant == "comparator":  # the folder `pcb` holds the drawings of the other two
        rows = groupby(
            sorted(beside, key=lambda text: (-text.at[1], text.at[0])), lambda text: text.at[1]
        )
        lines = (" | ".join(text.text for text in row) for _, row in rows)
        check_text(
            Path(__file__).parent / "approved/assembly_comparator.txt", "\n".join(lines) + "\n"
        )


@pytest.mark.parametrize("variant", VARIANT_CHANGES)
def test_bars_lie_at_the_cathodes(variant: str) -> None:
    sheet, values = draw(variant)
    parts = load_project(variant).placement.parts
    frame = next(p for p in sheet.primitives if isinstance(p, Polyline) and p.style.name == "board")
    left = frame.points[0][0]
    top = frame.points[2][1]
    bars = [p.points for p in sheet.primitives if isinstance(p, Polyline) and p.style.name == "bar"]
    diodes = [
        name
        for name in values
        if name.startswith("D") and len(parts[name].pads) == 2 and values[name] != SUPPRESSOR
    ]
    assert len(bars) == len(diodes) == {"article": 1, "precision": 0, "comparator": 2}[variant]
    for (x0, y0), (x1, y1) in bars:
        x = ((x0 + x1) / 2 - left) / SCALE
        y = (top - (y0 + y1) / 2) / SCALE
        # The nearest pad of any diode is a cathode: pad 1 of KiCad's footprints.
        pads = [pad for name in diodes for pad in parts[name].pads]
        assert (
            min(pads, key=lambda pad: (pad.centre[0] - x) ** 2 + (pad.centre[1] - y) ** 2).name
            == "1"
        )
