"""Bill of materials: quantity, rating, and the numbers of a part that meets it."""

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
        """References; of many, only the first and the last."""
        first, *_, last = (*self.references, self.references[-1])
        return " ".join(self.references) if len(self.references) < _MANY else f"{first} to {last}"


def bill_of_materials(circuit: Circuit) -> bytes:
    """Return the CSV file: a line for each value, footprint and rating, with a note."""
    rows = []
    for line in list_bom(circuit):
        fields = line.selection.fields
        part = line.selection.part
        alternate = line.selection.alternate
        alternates = [f"{alternate.manufacturer} {alternate.number}".strip()] if alternate else []
        alternates += [
            f"{name} with --set board.amplifier={name}"
            for name in _list_other_amplifiers(line, circuit)
        ]
        sources = dict.fromkeys(choice.source_text for choice in (part, alternate) if choice)
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
    """Name a pin-compatible dual amplifier, whose values the command computes; or none."""
    symbol = line.components[0].symbol.name
    supply_v = 10.0 if VEE in circuit.net_by_pin.values() else 3.3
    names = [
        amplifier.name
        for amplifier in list_dual_amplifiers()
        if amplifier.symbol != symbol
        and amplifier.min_supply_v <= supply_v <= amplifier.max_supply_v
    ]

    return names[:1] if symbol in AMPLIFIERS else []


def list_bom(circuit: Circuit) -> list[BomLine]:
    """List the lines of the bill of materials, in the order of the first reference of each."""
    groups: dict[tuple[str, str, str], list[Component]] = {}
    for component in purchased_components(circuit):
        groups.setdefault((component.value, component.footprint, component.rating), []).append(
            component
        )

    return [
        BomLine(
            components=components,
            references=[component.reference for component in components],
            value=value,
            footprint=footprint.split(":")[1],
            rating=rating,
            selection=select_part(components[0]),
        )
        for (value, footprint, rating), components in groups.items()
    ]


def purchased_components(circuit: Circuit) -> list[Component]:
    """Return the components to buy, by reference: no test points, holes or empty places."""
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
"""The four columns that the house reads; then what a person searches for and confirms."""
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
    """Return whether the house fits a component, not a person: a connector needs an LCSC number."""
    return component.reference[0] != "J" or bool(select_part(component).fields["LCSC"])


def assembly_bom_file(circuit: Circuit) -> bytes:
    """Return the bill of materials in the house's columns, with its part numbers if known.

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
    """Return a note on the lines whose number is missing or unsure; empty if there are none."""
    names = [line.name for line in list_unconfirmed(circuit)]
    if not names:
        return ""

    return (
        f"Confirm the numbers of {', '.join(names)} ({len(names)} of "
        f"{len(_list_assembled(circuit))} lines of "
        f"`{ASSEMBLY_BOM}`): the note of each says what to look up at the house."
    )


def estimate_cost(circuit: Circuit) -> tuple[float, float]:
    """Estimate the cost of one board's parts [US dollar], without those of unknown price."""
    low_usd = 0.0
    high_usd = 0.0
    for line in list_bom(circuit):
        if line.selection.part:
            low, high = PRICES[line.selection.part.price]
            low_usd += len(line.components) * low
            high_usd += len(line.components) * high

    return low_usd, high_usd


def list_extended(circuit: Circuit) -> list[str]:
    """List the lines to assemble that are no basic or preferred parts of the house."""
    return [
        line.name
        for line in _list_assembled(circuit)
        if line.selection.part and BASIC_SOURCE not in line.selection.part.sources
    ]


def list_unconfirmed(circuit: Circuit) -> list[BomLine]:
    """List the lines to assemble whose part number is missing, or in one document only."""
    return [line for line in _list_assembled(circuit) if line.selection.reason]


def _list_assembled(circuit: Circuit) -> list[BomLine]:
    return [line for line in list_bom(circuit) if is_assembled(line.components[0])]


def placement_file(circuit: Circuit, placement: Placement, *, for_house: bool) -> bytes:
    """Return places [mm] and rotations [degree] of the parts that the house fits, as CSV.

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
