"""Bill of materials: what to buy, how many, and which rating to look for, without manufacturers' names."""

from __future__ import annotations

import csv
import io

from fingertip.board.circuit import Circuit, Component, reference_sort_key

COLUMNS = ("Quantity", "References", "Value", "Footprint", "Rating")


def bill_of_materials(circuit: Circuit) -> bytes:
    """Content of the CSV file: one line for each value, footprint and rating, in the order of the first reference."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for (value, footprint, rating), references in group_purchased(circuit).items():
        writer.writerow((len(references), " ".join(references), value, footprint, rating))
    return text.getvalue().encode()


def group_purchased(circuit: Circuit) -> dict[tuple[str, str, str], list[str]]:
    """Group the references of purchased components by value, footprint and rating, in the order of the first."""
    groups: dict[tuple[str, str, str], list[str]] = {}
    for component in purchased_components(circuit):
        item = (component.value, component.footprint.split(":")[1], component.rating)
        groups.setdefault(item, []).append(component.reference)
    return groups


def purchased_components(circuit: Circuit) -> list[Component]:
    """Components to buy, sorted by reference: all but test points and mounting holes."""
    return sorted((component for component in circuit.components if component.rating), key=reference_sort_key)
