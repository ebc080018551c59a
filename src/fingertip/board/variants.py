"""The variants of the board that are made: circuit, sheet and placement of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.board.bridge import Bridge
from fingertip.board.circuit import Circuit
from fingertip.board.paper_circuit import paper_circuit
from fingertip.board.paper_sheet import PAPER_SHEET
from fingertip.board.placement import Placement
from fingertip.board.placements import PAPER_PLACEMENT, PRECISION_PLACEMENT
from fingertip.board.precision_circuit import precision_circuit
from fingertip.board.precision_sheet import PRECISION_SHEET
from fingertip.board.sheet import Sheet
from fingertip.design.filter_components import Components


@dataclass(frozen=True)
class Variant:
    """What a variant is made of."""

    name: str
    circuit: Callable[[Components, Bridge], Circuit]
    sheet: Sheet
    placement: Placement
    summary: str
    """For the README of its folder."""


VARIANTS = {
    variant.name: variant
    for variant in (
        Variant(
            "paper", paper_circuit, PAPER_SHEET, PAPER_PLACEMENT,
            "the article's two filters, rectifier and envelope (its figure 3)",
        ),
        Variant(
            "precision", precision_circuit, PRECISION_SHEET, PRECISION_PLACEMENT,
            "the article's two filters, then a rectifier without dead zone and a true pole for the envelope",
        ),
    )
}  # fmt: skip
"""By name; a test holds the names against those the design file takes."""
