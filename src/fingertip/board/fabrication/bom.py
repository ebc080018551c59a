"""Bill of materials: what to buy, how many, which rating to look for, and the numbers of a part that has it."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import dataclass

from fingertip.board.circuit import Circuit, Component, reference_sort_key
from fingertip.board.parts.select_part import Selection, select_part
from fingertip.board.parts.table import Part, load_sources

COLUMNS = (
    "Quantity", "References", "Value", "Footprint", "Rating", "Manufacturer", "MPN", "Alternate", "LCSC", "Source",
    "Note",
)  # fmt: skip


@dataclass(frozen=True)
class BomLine:
    """Line of a bill of materials: equal components."""

    components: tuple[Component, ...]

    @property
    def references(self) -> list[str]:
        """References of the components."""
        return [component.reference for component in self.components]

    @property
    def value(self) -> str:
        """Value of each component."""
        return self.components[0].value

    @property
    def footprint(self) -> str:
        """Name of the footprint without its library."""
        return self.components[0].footprint.split(":")[1]

    @property
    def rating(self) -> str:
        """Requirements for purchase."""
        return self.components[0].rating

    @property
    def selection(self) -> Selection:
        """Part to buy."""
        return select_part(self.components[0])


def bill_of_materials(circuit: Circuit) -> bytes:
    """Content of the CSV file: one line for each value, footprint and rating, in the order of the first reference.

    A number that is missing leaves its field empty, and the note says why.
    """
    rows = []
    for line in list_bom(circuit):
        fields, selection = line.selection.fields, line.selection
        what = (str(len(line.components)), " ".join(line.references), line.value, line.footprint, line.rating)
        alternate, source = _format_part(selection.alternate), _format_source(selection)
        rows.append((*what, fields["Manufacturer"], fields["MPN"], alternate, fields["LCSC"], source, selection.reason))
    return format_csv(COLUMNS, rows)


def list_bom(circuit: Circuit) -> list[BomLine]:
    """List the lines of the bill of materials, in the order of the first reference of each."""
    groups: dict[tuple[str, str, str], list[Component]] = {}
    for component in purchased_components(circuit):
        groups.setdefault((component.value, component.footprint, component.rating), []).append(component)
    return [BomLine(tuple(components)) for components in groups.values()]


def purchased_components(circuit: Circuit) -> list[Component]:
    """Components to buy, sorted by reference: all but test points and mounting holes."""
    return sorted((component for component in circuit.components if component.rating), key=reference_sort_key)


def format_csv(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> bytes:
    """Content of a CSV file, UTF-8."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return text.getvalue().encode()


def _format_source(selection: Selection) -> str:
    """Titles of the documents from which the numbers of part and alternate were copied."""
    parts = (selection.part, selection.alternate)
    titles = [load_sources()[part.source].title for part in parts if part]
    return "; alternate: ".join(dict.fromkeys(titles))


def _format_part(part: Part | None) -> str:
    return f"{part.manufacturer} {part.number}".strip() if part else ""
