"""The bill of materials: what to buy, how many, and what to look for, without makers' names."""

from __future__ import annotations

import csv
import io

from fingertip.board.circuit import Circuit, Part, by_reference

COLUMNS = ("Quantity", "References", "Value", "Footprint", "Rating")


def bill_of_materials(circuit: Circuit) -> bytes:
    """CSV, one line for each value, footprint and rating, in the order of the first reference."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for (value, footprint, rating), references in grouped(circuit).items():
        writer.writerow((len(references), " ".join(references), value, footprint, rating))
    return text.getvalue().encode()


def grouped(circuit: Circuit) -> dict[tuple[str, str, str], list[str]]:
    """Value, footprint and rating -> references: what is bought as one, in the order of the first reference."""
    lines: dict[tuple[str, str, str], list[str]] = {}
    for part in bought(circuit):
        lines.setdefault((part.value, part.footprint.split(":")[1], part.rating), []).append(part.reference)
    return lines


def bought(circuit: Circuit) -> list[Part]:
    """The parts that are bought: all but test points and holes, sorted by reference."""
    return sorted((part for part in circuit.parts if part.rating), key=by_reference)
