"""The boards that can be generated, by variant and supply: schematic sheet and placement of each."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.components.supplies import SUPPLIES, Supply
from fingertip.board.components.values import ComponentValues
from fingertip.board.kicad.placement import Placement, load_placement
from fingertip.board.kicad.project import REVISION
from fingertip.board.kicad.schematic_sheet import Sheet, make_sheet


@dataclass(frozen=True)
class BoardConfiguration:
    """A board variant on one of the supplies."""

    variant: str
    supply: Supply

    @property
    def name(self) -> str:
        """Name of the placement and the routing template, such as "article_split"."""
        return f"{self.variant}_{self.supply.name}"

    @property
    def changes(self) -> tuple[str, str, str]:
        """Changes to a design that select this configuration."""
        return (
            f"board.variant={self.variant}",
            f"board.supply={self.supply.name}",
            f"board.supply_v={self.supply.nominal_v:g}",
        )

    @property
    def sheet(self) -> Sheet:
        """Schematic sheet."""
        return make_sheet(self.variant, self.supply)

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


BOARD_VARIANTS = ("article", "precision", "comparator")
"""Names of the variants. A test compares them with those that the design file accepts."""

BOARD_CONFIGURATIONS = {
    configuration.name: configuration
    for configuration in (
        BoardConfiguration(variant, supply) for variant in BOARD_VARIANTS for supply in SUPPLIES.values()
    )
}
"""Every variant on every supply, by name."""


def find_configuration(values: ComponentValues) -> BoardConfiguration:
    """Find the configuration that values were computed for."""
    return BOARD_CONFIGURATIONS[f"{values.variant}_{values.supply}"]
