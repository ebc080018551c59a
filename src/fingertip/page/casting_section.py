"""Sheets of a design as tabs of its page: printing, shopping, casting, drawings, and where all figures come from."""

from __future__ import annotations

from fingertip.catalogues import output_files as outputs
from fingertip.design import Design
from fingertip.design.files import list_parameters
from fingertip.documents.start import render_basis_table
from fingertip.page.html import Markup, element, fold, join, list_links, note, table
from fingertip.page.markdown import list_steps, render, split_sections
from fingertip.page.parameters_and_checks import link_parameters
from fingertip.page.sources import COMMANDS, Sources

_BUY, _PROCEDURE = "What to buy", "Procedure"
_TICKED = {"data_ticks": "shopping", "data_noun": "things at hand"}
"""Attributes by which `page.js` adds boxes to tick to the lines of a table."""


def render_printing(sources: Sources) -> Markup:
    """Render the files for the printer with what each holds."""
    rows = []
    for path, found in sources.report.get(outputs.PRINT_FOLDER, {}).items():
        if path in sources.links:
            parts = ", ".join(part.replace("_", " ") for part in sorted(found["parts"]))
            rows.append((element("a", path, href=sources.links[path]), parts))
    files = table(("file", "holds"), sorted(rows, key=lambda row: row[0].endswith("stl</a>")), "files to print")
    missing = note(element("code", COMMANDS[outputs.PRINT_FOLDER]), " makes plates and parts as they lie on the bed.")
    return files if rows else missing


def render_tests(sources: Sources) -> Markup:
    lead, *sections = split_sections(sources.text(outputs.ACCEPTANCE) or "").items()
    if not sections:
        return note("There is no acceptance sheet: ", element("code", COMMANDS[outputs.SIGNAL_FOLDER]), " makes it.")
    folded = (fold(title, render(text, sources.links), state="roomy") for title, text in sections)
    return join((render(lead[1].partition("\n")[2]), *folded))


def render_shopping(sources: Sources) -> Markup:
    """Render what to buy with boxes to tick: what the casting sheet lists, then the plugs of the board."""
    text = split_sections(sources.files[outputs.SHEET].decode()).get(_BUY, "")
    parts = [render(text, sources.links, **_TICKED)]
    plugs = split_sections(sources.text(f"{outputs.BOARD_FOLDER}/{outputs.README}") or "").get("What else to buy")
    if plugs:
        parts.append(fold("Plugs and wires of the board", render(plugs, sources.links, **_TICKED)))
    if sources.design.board.variant != "divider":
        said = ("The parts on the board stand ", element("a", "with its pictures", href="#board"), ".")
        parts.append(element("p", *said))
    return join(parts)


def render_casting(sources: Sources) -> Markup:
    """Render the steps of the casting sheet with their pictures."""
    sections = split_sections(sources.files[outputs.SHEET].decode())
    parts = [render(sections[""].partition("\n")[2]), element("h3", "Step by step")]
    if outputs.STEPS_FOLDER in sources.remarks:
        parts.append(note(sources.remarks[outputs.STEPS_FOLDER]))
    return join((*parts, list_steps(sections[_PROCEDURE], sources.links)))


def render_drawing(sources: Sources) -> Markup:
    """Render links to the dimensioned sheets, whose data would be a sixth of the page."""
    return list_links(sorted(name for name in sources.links if name.startswith("drawing")), sources.links)


def render_basis(design: Design) -> Markup:
    """Render where each kind of figure comes from, and which parameters nobody verified."""
    unverified = [parameter.path for parameter in list_parameters() if "(unverified)" in parameter.description]
    said = ("Parameters for which no document was found: ", link_parameters(unverified), ".")
    return join((render(render_basis_table(design)), element("p", *said) if unverified else ""))
