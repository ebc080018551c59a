"""Order form of a board, in its README: what the forms of board house and assembly house ask for."""

from __future__ import annotations

from fingertip.board.circuit import Circuit
from fingertip.board.fabrication.assembly import is_assembled
from fingertip.board.fabrication.bom import purchased_components
from fingertip.board.kicad.footprints import FOOTPRINTS
from fingertip.board.kicad.project import BOARD_THICKNESS_MM, CLEARANCE_MM, COPPER_OZ, VIA_DRILL_MM, VIA_MM
from fingertip.board.layout.placement import Placement
from fingertip.board.layout.template import Template


def order_form(circuit: Circuit, placement: Placement, template: Template) -> str:
    """Table of the figures that an order asks for, in Markdown."""
    components = purchased_components(circuit)
    narrowest_mm = min(width for tracks in template.tracks.values() for *_, width in tracks.segments)
    unplated_mm = sorted(
        {p.drill for c in circuit.components for p in FOOTPRINTS[c.footprint].pads if p.drill and not p.is_plated}
    )
    through_hole = [c.reference for c in components if _is_through_hole(c.footprint)]
    by_house = [r for r in through_hole if is_assembled(circuit.component(r))]
    by_hand = [r for r in through_hole if r not in by_house]
    assembled = sum(map(is_assembled, components))
    rows = [
        ("files", f"`fab/{circuit.name}_gerbers.zip`"),
        ("layers", "2"),
        ("size", f"{placement.width:g} x {placement.height:g} mm, one board, no panel"),
        ("thickness", f"{BOARD_THICKNESS_MM:g} mm"),
        ("copper", f"{COPPER_OZ:g} oz (35 um) outside"),
        ("narrowest track, least clearance", f"{narrowest_mm:g} mm, {CLEARANCE_MM:g} mm"),
        ("vias", f"{VIA_MM:g} mm, drill {VIA_DRILL_MM:g} mm"),
        ("unplated holes", ", ".join(f"{mm:g} mm" for mm in unplated_mm)),
        ("finish", "lead-free HASL or ENIG"),
        ("colours of mask and print", "any"),
        ("assembly", f"front only, {assembled} components, with a stencil for the front"),
        ("parts and placement", "`fab/bom_assembly.csv`, `fab/placement_assembly.csv`"),
    ]
    if by_house:
        rows.append(
            ("through hole", f"{', '.join(by_house)}: a service that costs extra at most houses; or solder it yourself")
        )
    if by_hand:
        rows.append(("through hole", f"{', '.join(by_hand)}: not in the files for assembly; solder them yourself"))
    table = [("what the form asks", "this board"), ("---", "---"), *rows]
    return "\n".join("| " + " | ".join(row) + " |" for row in table)


def _is_through_hole(footprint: str) -> bool:
    return any(pad.drill and pad.is_plated for pad in FOOTPRINTS[footprint].pads)
