"""Cables of a board, in its README: plugs, contacts or finished leads to buy, and the wires they take."""

from __future__ import annotations

from fingertip.board.circuit import Circuit
from fingertip.board.parts.mating import (
    MatingPart,
    count_wires,
    group_plug_wires,
    list_connectors,
    list_mating_parts,
)
from fingertip.board.parts.select_part import NO_LCSC
from fingertip.board.parts.table import load_sources


def cable_table(circuit: Circuit) -> str:
    """Table of what to buy for each connector's cable, in Markdown."""
    rows = [("for", "count", "part", "number", "LCSC", "source, or why a number is missing"), ("---",) * 6]
    for connector in list_connectors(circuit):
        wires = count_wires(connector)
        for mating in list_mating_parts(connector):
            rows.append((connector.reference, str(mating.count(wires)), mating.item, *_describe_numbers(mating)))
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def cable_notes(circuit: Circuit) -> list[str]:
    """Notes on the wires and on the making of the cables."""
    found = group_plug_wires(circuit)
    if not found:
        return ["The socket's maker states which wires it takes. The sensor's must fit the finger too: its "
                "`acceptance.md` states which do."]  # fmt: skip
    sources = load_sources()
    return [
        *(
            f"Wires of {' and '.join(references)} ({wire.series}): {wire.description} ({sources[wire.source].title})."
            for wire, references in found.items()
        ),
        "The wires of the sensor must fit the finger too: its `acceptance.md` states which fit both.",
        "A lead with a contact at each end, cut in two, gives two wires. All leads are black: mark them at the far "
        "end. Contacts are crimped with a tool made for them, not soldered.",
        "Where a field is empty, no document that was read gives the number. Nobody checked what is in stock.",
    ]


def _describe_numbers(mating: MatingPart) -> tuple[str, str, str]:
    if mating.part is None:
        return "", "", mating.reason
    source = load_sources()[mating.part.source].title
    missing = "" if mating.part.lcsc else f"; {NO_LCSC}"
    return f"{mating.part.manufacturer} {mating.part.number}", mating.part.lcsc, f"{source}{missing}"
