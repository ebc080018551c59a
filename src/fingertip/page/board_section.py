"""Board of a page: layout, schematic, what to buy, connections, gate, response and bring-up."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from typing import Any

from fingertip.catalogues.output_files import BOARD_FOLDER, BOM, BRING_UP, LAYOUT, README, SCHEMATIC, VALUES
from fingertip.page.html import Markup, element, figure, join, table
from fingertip.page.layout_svg import render_back, render_copper, render_placement
from fingertip.page.markdown import render, split_sections
from fingertip.page.plots import draw_response
from fingertip.page.schematic_svg import render_schematic
from fingertip.page.sources import COMMANDS, Sources

# Bill of materials of a board as a table whose lines name their parts.
#
# `board.js` adds a check box for what is placed and a button that highlights the parts of a line on the pictures of
# the board. Without scripts it is a plain table.


_COLUMNS = ("Quantity", "References", "Value", "Footprint", "Rating", "Manufacturer", "MPN", "LCSC", "Note")
_REFERENCES = "References"
_CAPTION = "bill of materials; board/bom.csv names the source of each number"


def render_bom(text: str) -> Markup:
    """Render `bom.csv`, without the columns that are empty."""
    lines = list(csv.DictReader(io.StringIO(text)))
    columns = [name for name in _COLUMNS if any(line.get(name) for line in lines)]
    head = (element("th", name if name in ("MPN", "LCSC") else name.lower(), scope="col") for name in columns)
    rows = (
        element(
            "tr",
            *(element("td", line[name], class_="references" if name == _REFERENCES else None) for name in columns),
            data_parts=line[_REFERENCES],
        )
        for line in lines
    )
    whole = element(
        "table",
        element("caption", _CAPTION),
        element("thead", element("tr", *head)),
        element("tbody", *rows),
        class_="broad",
        id="bom",
    )
    scroll = element("div", whole, class_="scroll", role="group", tabindex="0", aria_label=_CAPTION)
    # The script shows the line of controls; without it there is nothing to control.
    return Markup(f"{element('div', class_='row', id='bom-controls', hidden=True)}{scroll}")


_NOTES = ("Connectors", "Test points", "Before you apply power")
"""Sections of the board's README that a page shows."""
_PLACEMENT = "Placement, seen from the front. Pin 1 of a connector is its square pad."
_COPPER = (
    "Copper, seen through the board from the front: front layer in orange, back layer in blue, pale where it is poured."
)
_BACK = (
    "Back, seen from the back: the printed list of values. Frames show where the parts stand, all of them on the front."
)
_PARTS = "What to buy for the board"
_BOUNDS = {"at most": "≤", "at least": "≥"}


def render_board(sources: Sources) -> Markup:
    """Render the board, or say how to make it. The response follows from the design alone."""
    response = join((element("h3", "Response", id="response"), draw_response(sources.design)))
    if BOARD_FOLDER in sources.remarks:
        return join((element("p", sources.remarks[BOARD_FOLDER], class_="note"), response))
    files = {
        name: sources.text(f"{BOARD_FOLDER}/{name}") for name in (LAYOUT, SCHEMATIC, BOM, VALUES, README, BRING_UP)
    }
    parts = []
    if layout := files[LAYOUT]:
        placement = render_placement(layout, "Placement of the components")
        copper = render_copper(layout, "Copper of the board")
        back = render_back(layout, "Back of the board")
        # It scrolls by itself on a low screen, so the keyboard must reach it.
        pictures = element(
            "div", figure(placement, _PLACEMENT, "placement"), figure(back, _BACK, "back"),
            role="group", tabindex="0", aria_label="front and back of the board",
        )  # fmt: skip
        parts += [element("h3", "Layout"), _set_beside(pictures, files[BOM]), figure(copper, _COPPER, "copper")]
    elif bom := files[BOM]:
        parts.append(_render_parts(bom))
    if schematic := files[SCHEMATIC]:
        parts += [
            element("h3", "Schematic"),
            figure(render_schematic(schematic, "Schematic of the board"), "", "schematic", "wide"),
        ]
    if values := files[VALUES]:
        parts.append(_render_gate(json.loads(values).get("gate", [])))
    parts.append(response)
    for heading, text in split_sections(files[README] or "").items():
        if heading in _NOTES:
            parts += [element("h3", heading), render(text)]
    if sheet := files[BRING_UP]:
        body = render(sheet.partition("\n")[2])
        parts += [element("h3", "Bring-up"), element("details", element("summary", "Bring-up with a multimeter"), body)]
    else:
        said = (
            "There is no bring-up sheet: in the folder of this page, ",
            element("code", COMMANDS[BOARD_FOLDER]),
            " makes it.",
        )
        parts.append(element("p", *said, class_="note"))
    return join(parts)


def _set_beside(pictures: Markup, bom: str | None) -> Markup:
    """Set the pictures beside the list of the parts on them, so that both are seen at once."""
    if not bom:
        return pictures
    return element("div", pictures, element("div", _render_parts(bom)), class_="parts")


def _render_parts(bom: str) -> Markup:
    return join((element("h3", _PARTS), render_bom(bom)))


def _render_gate(gate: list[Mapping[str, Any]]) -> Markup:
    """Render what makes the board work, each with value and limit."""
    if not gate:
        return Markup("")
    passed = sum(entry["passed"] for entry in gate)
    rows = [
        (
            entry["name"],
            entry["subject"],
            element("span", _with_unit(entry["value"], entry), class_="num"),
            element("span", f"{_BOUNDS[entry['bound']]} {_with_unit(entry['limit'], entry)}", class_="num"),
            element("span", "✓" if entry["passed"] else f"✗ {entry['remedy']}", class_=_tell(entry["passed"])),
        )
        for entry in gate
    ]
    body = table(("requirement", "of", "value", "must be", "met"), rows, "what makes the board work")
    summary = element("summary", f"Requirements of the board: {passed} of {len(gate)} met")
    return element("details", summary, body, open=passed < len(gate))


def _with_unit(value: float, entry: Mapping[str, Any]) -> str:
    return f"{value:.4g} {entry['unit']}".rstrip()


def _tell(passed: bool) -> str:
    return "passed" if passed else "failed"
