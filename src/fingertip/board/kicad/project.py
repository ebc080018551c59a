"""Boards that can be generated, by variant and supply, and KiCad's project file: design rules, checks, 3D models."""

from __future__ import annotations

import json
from dataclasses import dataclass

from fingertip.board.components.values import SUPPLIES, ComponentValues, Supply
from fingertip.board.kicad.footprints import SILK_CLEARANCE_MM, SILK_LINE_MM, TEXT_HEIGHT_MM
from fingertip.board.kicad.models import MODEL_FOLDER_OF_PROJECT, MODEL_VARIABLE
from fingertip.board.kicad.placement import Placement, load_placement
from fingertip.board.kicad.schematic_sheet import Sheet, make_sheet
from fingertip.board.parts.circuit import Circuit

REVISION = "2"
"""Revision of the boards: higher where parts, nets or copper have changed."""
BOARD_THICKNESS_MM = 1.6
COPPER_OZ = 1.0
CLEARANCE_MM = 0.15
POUR_CLEARANCE_MM = 0.2
"""Clearance of the ground pour from other copper."""
TRACK_MM = 0.2
VIA_MM = 0.6
VIA_DRILL_MM = 0.3

IGNORED_IN_SCHEMATIC = {
    "lib_symbol_mismatch": "symbols have the pins of KiCad's libraries, but lines of their own",
    "lib_symbol_issues": "the libraries of the symbols need not be installed: the schematic holds its symbols",
    "footprint_link_issues": "nor need those of the footprints: the layout holds its footprints",
}
"""Electrical rules that are switched off, by KiCad's name, with the reason."""
IGNORED_ON_BOARD = {
    "lib_footprint_mismatch": "footprints have the pads of KiCad's libraries, but outlines and silkscreen of their own",
    "lib_footprint_issues": "the libraries of the footprints need not be installed",
}
"""Design rules that are switched off, by KiCad's name, with the reason."""


def kicad_project_file(circuit: Circuit) -> bytes:
    """Content of the project file, JSON in UTF-8."""
    netclass = {
        "name": "Default", "priority": 2147483647, "clearance": CLEARANCE_MM, "track_width": TRACK_MM,
        "via_diameter": VIA_MM, "via_drill": VIA_DRILL_MM, "microvia_diameter": 0.3, "microvia_drill": 0.1,
        "diff_pair_gap": 0.25, "diff_pair_via_gap": 0.25, "diff_pair_width": 0.2, "bus_width": 12, "line_style": 0,
        "wire_width": 6, "pcb_color": "rgba(0, 0, 0, 0.000)", "schematic_color": "rgba(0, 0, 0, 0.000)",
    }  # fmt: skip
    rules = {
        "min_clearance": CLEARANCE_MM, "min_track_width": 0.15, "min_via_diameter": 0.5, "min_via_annular_width": 0.1,
        "min_through_hole_diameter": 0.3, "min_hole_clearance": 0.2, "min_hole_to_hole": 0.25,
        "min_copper_edge_clearance": 0.3, "min_silk_clearance": SILK_CLEARANCE_MM,
        "min_text_height": TEXT_HEIGHT_MM, "min_text_thickness": SILK_LINE_MM, "solder_mask_to_copper_clearance": 0.0,
    }  # fmt: skip
    data = {
        "board": {
            "design_settings": {
                "rules": rules,
                "rule_severities": dict.fromkeys(IGNORED_ON_BOARD, "ignore"),
            }
        },
        "erc": {"meta": {"version": 0}, "rule_severities": dict.fromkeys(IGNORED_IN_SCHEMATIC, "ignore")},
        "meta": {"filename": f"{circuit.name}.kicad_pro", "version": 3},
        "net_settings": {"classes": [netclass], "meta": {"version": 4}},
        "text_variables": {MODEL_VARIABLE: MODEL_FOLDER_OF_PROJECT},
    }
    return (json.dumps(data, indent=2) + "\n").encode()


# Boards that can be generated: schematic sheet and placement of each.


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
