"""The boards that can be generated, by variant and supply: schematic sheet and placement of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fingertip.board.components.supplies import SUPPLIES, Supply
from fingertip.board.components.values import ComponentValues
from fingertip.board.kicad.placement import Placement, load_placement
from fingertip.board.kicad.project import REVISION
from fingertip.board.kicad.schematic_blocks import article_sheet, comparator_sheet, precision_sheet
from fingertip.board.kicad.schematic_sheet import Sheet


@dataclass(frozen=True)
class BoardVariant:
    """Function that makes the schematic sheet of a variant, and its description."""

    name: str
    sheet: Callable[[Supply], Sheet]
    summary: str
    """Description of the signal path for the README of the board's folder."""


@dataclass(frozen=True)
class BoardConfiguration:
    """A board variant on one of the supplies."""

    variant: BoardVariant
    supply: Supply

    @property
    def name(self) -> str:
        """Name of the placement and the routing template, such as "article_split"."""
        return f"{self.variant.name}_{self.supply.name}"

    @property
    def changes(self) -> tuple[str, str, str]:
        """Changes to a design that select this configuration."""
        return (
            f"board.variant={self.variant.name}",
            f"board.supply={self.supply.name}",
            f"board.supply_v={self.supply.nominal_v:g}",
        )

    @property
    def sheet(self) -> Sheet:
        """Schematic sheet."""
        return self.variant.sheet(self.supply)

    @property
    def heading(self) -> tuple[str, ...]:
        """Lines that name the board on its back, with the only supply voltage that it bears."""
        name = f"fingertip {self.name.replace('_', ' ')}"
        warning = (f"{self.supply.nominal_v:g} V only",) if self.supply.is_for_controller else ()
        return (name, f"rev {REVISION}", *warning)

    @property
    def placement(self) -> Placement:
        """Positions of the components on the board."""
        return load_placement(self.name)


BOARD_VARIANTS = {
    variant.name: variant
    for variant in (
        BoardVariant(
            "article", article_sheet,
            "the article's two filters, rectifier and envelope (its figure 3)"
        ),
        BoardVariant(
            "precision", precision_sheet,
            "the article's two filters, a precision half-wave rectifier and a first-order low-pass for the envelope",
        ),
        BoardVariant(
            "comparator", comparator_sheet,
            "the article's two filters, a precision half-wave rectifier, a first-order low-pass for the envelope, and "
            "a comparator with hysteresis and an ON/OFF pin",
        ),
    )
}  # fmt: skip
"""Variants by name. A test compares the names with those that the design file accepts."""

BOARD_CONFIGURATIONS = {
    configuration.name: configuration
    for configuration in (
        BoardConfiguration(variant, supply) for variant in BOARD_VARIANTS.values() for supply in SUPPLIES.values()
    )
}
"""Every variant on every supply, by name."""


def find_configuration(values: ComponentValues) -> BoardConfiguration:
    """Find the configuration that values were computed for."""
    return BOARD_CONFIGURATIONS[f"{values.variant}_{values.supply}"]
