"""The placer and the labels it leaves to the end: what stays, what moves, and that the stored files are its own."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.placement import PLACEMENTS, Position, load_placement
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS, VIA_MM
from fingertip.board.kicad.silkscreen import label_box, needs_label, silkscreen_conflicts
from tests.designs import ARTICLE
from tools.placing.label import add_labels
from tools.placing.place import format_placement, list_problems, place

CIRCUIT = board_circuit(board_values(ARTICLE))
PLACEMENT = load_placement("article_split")


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_stored_placement_is_as_the_tools_write_it(name: str) -> None:
    stored = (PLACEMENTS / f"{name}.json").read_text("utf-8")
    assert format_placement(load_placement(name)) == stored


@pytest.mark.full
def test_placer_separates_components_and_moves_no_connector() -> None:
    """All components start on one spot. Twenty thousand moves separate most of them, the same ones each time."""
    spot = Position(20.0, 12.0)
    positions = {ref: p if ref[0] in "JH" else spot for ref, p in PLACEMENT.positions.items()}
    heap = replace(PLACEMENT, positions=positions)
    placed, wire, rest = place(CIRCUIT, heap, 20_000, 4.0, 0.02, 0.1, 1)
    assert len(list_problems(CIRCUIT, placed)) < len(list_problems(CIRCUIT, heap)) / 10
    assert {ref: p for ref, p in placed.positions.items() if ref[0] in "JH"} == {
        ref: p for ref, p in positions.items() if ref[0] in "JH"
    }
    assert (placed.fiducials, placed.texts) == (PLACEMENT.fiducials, PLACEMENT.texts)
    assert set(placed.reference_labels) == {c.reference for c in CIRCUIT.components if needs_label(c)}
    assert place(CIRCUIT, heap, 20_000, 4.0, 0.02, 0.1, 1) == (placed, wire, rest)


def test_labels_are_added_where_they_can_be_read() -> None:
    required = {c.reference for c in CIRCUIT.components if needs_label(c)}
    bare = replace(
        PLACEMENT, reference_labels={ref: p for ref, p in PLACEMENT.reference_labels.items() if ref in required}
    )
    labelled = add_labels(CIRCUIT, bare, [], VIA_MM)
    assert list(silkscreen_conflicts(CIRCUIT, labelled)) == []
    added = set(labelled.reference_labels) - required
    assert len(added) > 10
    # A via under a label moves it or takes it away.
    ref = min(added)
    left, top, right, bottom = label_box(ref, labelled.reference_labels[ref])
    via = ((left + right) / 2, (top + bottom) / 2)
    again = add_labels(CIRCUIT, bare, [via], VIA_MM)
    assert again.reference_labels.get(ref) != labelled.reference_labels[ref]
    assert list(silkscreen_conflicts(CIRCUIT, again, [via], VIA_MM)) == []
