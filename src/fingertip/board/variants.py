"""The variants of the board that are made: circuit, sheet and placement of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.board.circuit import Circuit
from fingertip.board.comparator_circuit import comparator_circuit
from fingertip.board.comparator_sheet import COMPARATOR_SHEET
from fingertip.board.paper_circuit import paper_circuit
from fingertip.board.paper_sheet import PAPER_SHEET
from fingertip.board.placement import Placement
from fingertip.board.placements import COMPARATOR_PLACEMENT, PAPER_PLACEMENT, PRECISION_PLACEMENT
from fingertip.board.precision_circuit import precision_circuit
from fingertip.board.precision_sheet import PRECISION_SHEET
from fingertip.board.sheet import Sheet
from fingertip.board.values import BoardValues
from fingertip.errors import BoardError


@dataclass(frozen=True)
class Variant:
    """What a variant is made of."""

    name: str
    circuit: Callable[[BoardValues], Circuit]
    sheet: Sheet
    placement: Placement
    summary: str
    """For the README of its folder."""


def _comparator(values: BoardValues) -> Circuit:
    if values.decision is None:
        raise BoardError("the values are of a variant without comparator; compute them with board.variant=comparator.")
    return comparator_circuit(values.preferred, values.bridge, values.decision)


VARIANTS = {
    variant.name: variant
    for variant in (
        Variant(
            "paper", lambda v: paper_circuit(v.preferred, v.bridge), PAPER_SHEET, PAPER_PLACEMENT,
            "the article's two filters, rectifier and envelope (its figure 3)",
        ),
        Variant(
            "precision", lambda v: precision_circuit(v.preferred, v.bridge), PRECISION_SHEET, PRECISION_PLACEMENT,
            "the article's two filters, then a rectifier without dead zone and a true pole for the envelope",
        ),
        Variant(
            "comparator", _comparator, COMPARATOR_SHEET, COMPARATOR_PLACEMENT,
            "the article's two filters, a precise rectifier and envelope, threshold and hysteresis with an ON/OFF pin",
        ),
    )
}  # fmt: skip
"""By name; a test holds the names against those the design file takes."""
