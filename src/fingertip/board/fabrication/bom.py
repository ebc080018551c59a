"""Bill of materials: what to buy, how many, which rating to look
for, and the numbers of a part that has it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from fingertip.board.components.front_end import AMPLIFIERS
from fingertip.board.kicad.placement import Placement
from fingertip.board.parts.circuit import Circuit, Component, reference_sort_key
from fingertip.board.parts.nets import VEE
from fingertip.board.parts.select_part import Selection, select_part
from fingertip.board.parts.table import BASIC_SOURCE, PRICES, load_table
from fingertip.catalogues.electronics import list_dual_amplifiers
from fingertip.foundation.files import format_csv

PRICE = "Price of one [USD, estimate of 2026-11]"
COLUMNS = (
    "Quantity",
    "References",
    "Value",
    "Footprint",
    "Rating",
    "Manufacturer",
    "MPN",
    "Alternate",
    "LCSC",
    PRICE,
    "Source",
    "Note",
)

_MANY = 5


@dataclass(frozen=True)
class BomLine:
    """Line of a bill of materials: equal components."""

    components: list[Component]
    references: list[str]
    value: str
    footprint: str
    """Name of the footprint without its library."""
    rating: str
    selection: Selection

    @property
    def name(self) -> str:
        """References, of which only the ends are named where there are many."""
        first, *_, last = (*self.references, self.references[-1])
        return " ".join(self.references) if len(self.references) < _MANY else f"{first} to {last}"


def bill_of_materials(circuit: Circuit) -> bytes:
    """Content of the CSV file: a line for each value, footprint and
    rating, whose note says why a number is missing.
    """
    rows = []
    for line in list_bom(circuit):
        fields = line.selection.fields
        part = line.selection.part
        alternate = line.selection.alternate
        alternates = [f"{alternate.manufacturer} {alternate.number}".strip()] if alternate else []
        alternates += [
            f"{other} with --set board.amplifier={other}"
            for other in _list_other_amplifiers(line, circuit)
        ]
        sources = dict.fromkeys(each.source_text for each in (part, alternate) if each)
        low, high = PRICES[part.price] if part else (0.0, 0.0)
        by_hand = part and not is_assembled(line.components[0])
        price = f"{low:g} to {high:g}" if low else f"below {high:g}"
        rows.append(
            (
                str(len(line.components)),
                " ".join(line.references),
                line.value,
                line.footprint,
                line.rating,
                fields["Manufacturer"],
                fields["MPN"],
                "; or ".join(alternates),
                fields["LCSC"],
                price if part else "",
                "; alternate: ".join(sources),
                f"solder by hand: {line.selection.reason}" if by_hand else line.selection.note,
            )
        )

    return format_csv(COLUMNS, rows)


def _list_other_amplifiers(line: BomLine, circuit: Circuit) -> list[str]:
    """Name the amplifier that fits the pads in the place of a dual
    amplifier, with values that the command computes.
    """
    symbol = line.components[0].symbol.name
    supply_v = 10.0 if VEE in circuit.net_by_pin.values() else 3.3
    fitting = (
        a
        for a in list_dual_amplifiers()
        if a.symbol != symbol and a.min_supply_v <= supply_v <= a.max_supply_v
    )

    return [other.name for other in fitting][:1] if symbol in AMPLIFIERS else []


def list_bom(circuit: Circuit) -> list[BomLine]:
    """List the lines of the bill of materials, in the order of the first reference of each."""
    groups: dict[tuple[str, str, str], list[Component]] = {}
    for component in purchased_components(circuit):
        groups.setdefault((component.value, component.footprint, component.rating), []).append(
            component
        )

    return [
        BomLine(
            components=found,
            references=[c.reference for c in found],
            value=value,
            footprint=footprint.split(":")[1],
            rating=rating,
            selection=select_part(found[0]),
        )
        for (value, footprint, rating), found in groups.items()
    ]


def purchased_components(circuit: Circuit) -> list[Component]:
    """Components to buy, sorted by reference: all but test points,
    mounting holes and places that stay empty.
    """
    return sorted(
        (part for part in circuit.components if part.rating and part.is_fitted),
        key=reference_sort_key,
    )


# Files in the columns of the assembly house JLCPCB: bill of materials, and placement with its
# rotations.
#
# The house turns some packages differently from KiCad. `rotations.csv` in the parts table holds the
# offsets, with their source; a package that is not in it keeps KiCad's rotation. The house places a
# part by the centre of its pads.

ASSEMBLY_BOM = "bom_assembly.csv"
ASSEMBLY_PLACEMENT = "placement_assembly.csv"
BOM_COLUMNS = ("Comment", "Designator", "Footprint", "JLCPCB Part #", "MPN", "Manufacturer", "Note")
"""The four columns that the house reads, and for people the
number to search for and what to confirm.
"""
PLACEMENT_COLUMNS = ("Designator", "Mid X", "Mid Y", "Layer", "Rotation")


@dataclass(frozen=True)
class RotationOffset:
    """Rotation of the house's parts relative to KiCad's footprints."""

    pattern: str
    """Regular expression that the name of the footprint begins with."""
    rotation_deg: int
    """Anticlockwise rotation to add to KiCad's [degree]."""
    source: str


def is_assembled(component: Component) -> bool:
    """Return whether the house fits a component; a connector
    without an LCSC number is soldered by hand.
    """
    return component.reference[0] != "J" or bool(select_part(component).fields["LCSC"])


def assembly_bom_file(circuit: Circuit) -> bytes:
    """Bill of materials in the house's columns, with its part numbers where the parts table has
    them.

    The comment of a resistor, a capacitor, a trimmer or a connector includes the rating, because
    its value alone does not determine what to buy. The lines are those of `bom.csv`, without those.
    """
    rows = []
    for line in _list_assembled(circuit):
        fields = line.selection.fields
        has_type_name = line.references[0].rstrip("0123456789") not in ("R", "C", "RV", "J")
        comment = line.value if has_type_name else f"{line.value}, {line.rating}"
        numbers = (fields["LCSC"], fields["MPN"], fields["Manufacturer"])
        rows.append(
            (comment, ",".join(line.references), line.footprint, *numbers, line.selection.note)
        )

    return format_csv(BOM_COLUMNS, rows)


def missing_numbers_note(circuit: Circuit) -> str:
    """Name the lines to assemble whose number is missing or unsure; empty if none is."""
    found = [line.name for line in list_unconfirmed(circuit)]
    if not found:
        return ""

    return (
        f"Confirm the numbers of {', '.join(found)} ({len(found)} of "
        f"{len(_list_assembled(circuit))} lines of "
        f"`{ASSEMBLY_BOM}`): the note of each says what to look up at the house."
    )


def estimate_cost(circuit: Circuit) -> tuple[float, float]:
    """Estimate the cost of one board's parts from the classes of their
    prices [US dollar], without those unknown.
    """
    priced = [
        (len(line.components), *PRICES[part.price])
        for line in list_bom(circuit)
        if (part := line.selection.part)
    ]
    return sum(count * low for count, low, _ in priced), sum(
        count * high for count, _, high in priced
    )


def list_extended(circuit: Circuit) -> list[str]:
    """List the lines to assemble, by reference, which are not
    among the house's basic and preferred parts.
    """
    known = ((line, line.selection.part) for line in _list_assembled(circuit))
    return [line.name for line, part in known if part and BASIC_SOURCE not in part.sources]


def list_unconfirmed(circuit: Circuit) -> list[BomLine]:
    """List the lines to assemble whose part number at the
    assembler is missing or in one document only.
    """
    return [line for line in _list_assembled(circuit) if line.selection.reason]


def _list_assembled(circuit: Circuit) -> list[BomLine]:
    return [line for line in list_bom(circuit) if is_assembled(line.components[0])]


def placement_file(circuit: Circuit, placement: Placement, *, for_house: bool) -> bytes:
    """Places [mm] and rotations [degree] of the components that are not soldered by hand.

    They are those that KiCad states, or for the house the centres of the pads, and its rotations.
    The origin is the lower left corner of the board, as in the gerbers.
    """
    rows = []
    for component in filter(is_assembled, purchased_components(circuit)):
        part = placement.parts[component.reference]
        x = part.x
        y = part.y
        rotation = part.angle

        if for_house:
            x, y = part.pad_centre
            offset = find_rotation(component.footprint)
            rotation = (rotation + (offset.rotation_deg if offset else 0)) % 360

        rows.append(
            (
                component.reference,
                f"{x:.4f}mm",
                f"{placement.height - y:.4f}mm",
                "Top",
                str(rotation),
            )
        )

    return format_csv(PLACEMENT_COLUMNS, rows)


def load_rotations() -> tuple[RotationOffset, ...]:
    """Load the rotation offsets. The first whose pattern matches holds."""
    return load_table(RotationOffset, "rotations.csv")


def find_rotation(footprint: str) -> RotationOffset | None:
    """Find the rotation offset of a footprint, "library:name"; None if the table has none."""
    name = footprint.split(":")[1]
    return next((offset for offset in load_rotations() if re.match(offset.pattern, name)), None)
