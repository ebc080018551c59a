"""The boards that are made, by variant and supply: circuit, sheet and placement of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.board.circuit import Circuit
from fingertip.board.circuits.article import article_circuit
from fingertip.board.circuits.comparator import comparator_circuit
from fingertip.board.circuits.precision import precision_circuit
from fingertip.board.layout.placement import Placement
from fingertip.board.layout.placements import load_placement
from fingertip.board.schematic.article_sheet import article_sheet
from fingertip.board.schematic.comparator_sheet import comparator_sheet
from fingertip.board.schematic.precision_sheet import precision_sheet
from fingertip.board.schematic.sheet import Sheet
from fingertip.board.supplies import SUPPLIES, Supply
from fingertip.board.values.board_values import BoardValues


@dataclass(frozen=True)
class Kind:
    """What a variant is made of."""

    name: str
    circuit: Callable[[BoardValues], Circuit]
    sheet: Callable[[Supply], Sheet]
    summary: str
    """For the README of its folder."""


@dataclass(frozen=True)
class Variant:
    """A variant with its supply."""

    kind: Kind
    supply: Supply

    @property
    def name(self) -> str:
        """Of its placement and template: "article_split"."""
        return f"{self.kind.name}_{self.supply.name}"

    @property
    def changes(self) -> tuple[str, str]:
        """Changes to a design that make it this one."""
        return f"board.variant={self.kind.name}", f"board.supply={self.supply.name}"

    @property
    def sheet(self) -> Sheet:
        """Its drawing."""
        return self.kind.sheet(self.supply)

    @property
    def placement(self) -> Placement:
        """Where its parts stand."""
        return load_placement(self.name)


KINDS = {
    kind.name: kind
    for kind in (
        Kind("article", article_circuit, article_sheet, "the article's two filters, rectifier and envelope (its figure 3)"),
        Kind(
            "precision", precision_circuit, precision_sheet,
            "the article's two filters, then a rectifier without dead zone and a true pole for the envelope",
        ),
        Kind(
            "comparator", comparator_circuit, comparator_sheet,
            "the article's two filters, a precise rectifier and envelope, threshold and hysteresis with an ON/OFF pin",
        ),
    )
}  # fmt: skip
"""By name; a test holds the names against those the design file takes."""

VARIANTS = {
    variant.name: variant
    for variant in (Variant(kind, supply) for kind in KINDS.values() for supply in SUPPLIES.values())
}


def variant_of(values: BoardValues) -> Variant:
    """The variant that values were computed for."""
    return VARIANTS[f"{values.variant}_{values.supply}"]
