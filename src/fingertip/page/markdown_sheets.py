"""Markdown sheets of a design as HTML, and the tabs of its page that
they make: printing, shopping, casting, tests.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import PurePath

from markdown_it import MarkdownIt
from markdown_it.tree import SyntaxTreeNode

from fingertip.catalogues import output_files as outputs
from fingertip.catalogues.stated_errors import StatedError
from fingertip.design import Design
from fingertip.design.design_file import list_parameters
from fingertip.documents.finger_sheets import render_basis_table
from fingertip.page.html import Markup, element, fold, join, list_links, note, table
from fingertip.page.parameters_and_checks import link_parameters
from fingertip.page.sources import COMMANDS, Sources

_PARSER = MarkdownIt("zero").enable(
    ["heading", "list", "table", "newline", "backticks", "emphasis", "entity", "image", "link"]
)


def split_sections(text: str) -> dict[str, str]:
    """Split a page at its second-level headings: heading -> text below it.

    The part before the first has the key "".
    """
    mark = "## "
    found = {"": ""}
    heading = ""

    for line in text.splitlines():
        if line.startswith(mark):
            heading = line.removeprefix(mark).strip()
            found[heading] = ""
        else:
            found[heading] += line + "\n"

    return found


def render_markdown(text: str, links: Mapping[str, str] | None = None, **attributes: str) -> Markup:
    """Render Markdown. Headings become the third level and below, because a page has its own two.

    `links` are addresses by path: a file whose name stands as code becomes a link, a picture is
    shown, and neither is if its path is not there. Links of the text itself lead within the page.
    Tables get the attributes.
    """
    return join(
        _render(node, links or {}, attributes)
        for node in SyntaxTreeNode(_PARSER.parse(text)).children
    )


def render_steps(text: str, links: Mapping[str, str]) -> Markup:
    """Render a numbered list as steps to unfold and tick off, each
    with its picture, whose name is its title.
    """
    # Sheets indent pictures by three columns; below a number of two digits Markdown asks for four.
    (steps,) = SyntaxTreeNode(_PARSER.parse(text.replace("\n   ![", "\n    !["))).children
    listed = []

    for number, step in enumerate(steps.children, 1):
        paths = [str(node.attrs["src"]) for node in step.walk() if node.type == "image"]
        title = (
            PurePath(paths[0]).stem.partition("-")[2].replace("_", " ").capitalize()
            if paths
            else ""
        )
        paragraphs = [rendered for part in step.children if (rendered := _render(part, links, {}))]
        begin = element(
            "span", re.sub(r"<[^>]*>", "", paragraphs[0].partition(". ")[0]), class_="begin"
        )
        head = element(
            "summary", element("span", f"Step {number}", class_="number"), " ", title, begin
        )
        body = element(
            "details", head, *(element("p", part) for part in paragraphs), open=number == 1
        )
        listed.append(element("li", body, data_tick=f"step {number}", id=f"step-{number}"))

    return element("ol", *listed, class_="steps", data_ticks="steps", data_noun="steps")


def _render(node: SyntaxTreeNode, links: Mapping[str, str], attributes: Mapping[str, str]) -> str:
    inner = [_render(child, links, attributes) for child in node.children]
    match node.type:
        case "text":
            return node.content.replace("\N{NO-BREAK SPACE}", "")
        case "softbreak":
            return " "
        case "code_inline":
            named = element("code", node.content)
            return element("a", named, href=links[node.content]) if node.content in links else named
        case "link" if str(node.attrs["href"]).startswith("#"):
            return element("a", *inner, href=str(node.attrs["href"]))
        case "image":
            source = links.get(str(node.attrs["src"]), "")
            return (
                element("img", src=source, alt=node.content) if source.startswith("data:") else ""
            )
        case "heading":
            return element(f"h{min(int(node.tag[1]) + 1, 6)}", *inner)
        case "table":
            head, *rows = (
                [_render(cell, links, attributes) for cell in row.children]
                for row in node.walk()
                if row.type == "tr"
            )
            return table(head, rows, **attributes)
        case "list_item":  # a picture stands below its text
            return element("li", *[piece for paragraph in inner for piece in (" ", paragraph)][1:])
        case "strong" | "bullet_list" | "ordered_list":
            return element(node.tag, *inner)
        case "paragraph" if node.level == 0:
            return element("p", *inner)

    return join(inner)


_BUY = "What to buy"
_PROCEDURE = "Procedure"
TICKED_THINGS = {"data_ticks": "shopping", "data_noun": "things at hand"}
"""Attributes by which `page.js` adds boxes to tick to the lines of a table."""


def render_facts(sections: Mapping[str, str], links: Mapping[str, str] | None = None) -> Markup:
    """Render sections as boxes, each a title with what stands below it."""
    facts = (
        element("div", element("dt", title), element("dd", render_markdown(text, links)))
        for title, text in sections.items()
    )
    return element("dl", *facts, class_="facts")


def render_printing(sources: Sources) -> Markup:
    """Render the files for the printer with what each holds."""
    rows = []
    for path, parts in sources.report.prints.items():
        if path in sources.links:
            names = ", ".join(part.replace("_", " ") for part in sorted(parts))
            rows.append((element("a", path, href=sources.links[path]), names))

    files = table(
        ("file", "holds"),
        sorted(rows, key=lambda row: row[0].endswith("stl</a>")),
        "files to print",
    )
    missing = note(
        element("code", COMMANDS[outputs.PRINT_FOLDER]),
        " makes plates and parts as they lie on the bed.",
    )
    settings = element("p", "Step 1 of ", element("a", "Cast", href="#cast"), " has the settings.")
    return join((files, settings)) if rows else missing


def render_tests(sources: Sources) -> Markup:
    lead, *sections = split_sections(sources.text(outputs.ACCEPTANCE) or "").items()
    if not sections:
        return note(
            "There is no acceptance sheet: ",
            element("code", COMMANDS[outputs.SIGNAL_FOLDER]),
            " makes it.",
        )

    folded = (
        fold(title, render_markdown(text, sources.links), state="roomy") for title, text in sections
    )
    return join((render_markdown(lead[1].partition("\n")[2]), *folded))


def render_shopping(sources: Sources) -> Markup:
    """Render what to buy with boxes to tick: what the casting
    sheet lists, then the plugs of the board.
    """
    text = split_sections(sources.files[outputs.SHEET].decode()).get(_BUY, "")
    parts = [render_markdown(text, sources.links, **TICKED_THINGS)]
    plugs = split_sections(sources.text(f"{outputs.BOARD_FOLDER}/{outputs.README}") or "").get(
        "What else to buy"
    )

    if plugs:
        parts.append(
            fold(
                "Plugs and wires of the board",
                render_markdown(plugs, sources.links, **TICKED_THINGS),
            )
        )

    if sources.design.board.variant != "divider":
        link = element("a", "with its pictures", href="#board")
        parts.append(element("p", "The parts on the board are ", link, "."))

    return join(parts)


def render_casting(sources: Sources) -> Markup:
    """Render the steps of the casting sheet with their pictures."""
    sections = split_sections(sources.files[outputs.SHEET].decode())
    parts = [render_markdown(sections[""].partition("\n")[2]), element("h3", "Step by step")]
    if outputs.STEPS_FOLDER in sources.remarks:
        parts.append(note(sources.remarks[outputs.STEPS_FOLDER]))

    return join((*parts, render_steps(sections[_PROCEDURE], sources.links)))


def render_drawing(sources: Sources) -> Markup:
    """Render links to the dimensioned sheets, whose data would be a sixth of the page."""
    return list_links(
        sorted(name for name in sources.links if name.startswith("drawing")), sources.links
    )


def render_basis(design: Design, errors: Sequence[StatedError]) -> Markup:
    """Render where each kind of figure comes from, its error, and which parameters nobody
    verified.
    """
    unverified = [
        parameter.path for parameter in list_parameters() if "(unverified)" in parameter.description
    ]
    sources = element(
        "p", "Parameters for which no document was found: ", link_parameters(unverified), "."
    )
    rows = ((error.figure, error.bounds, error.against, f"{error.cpu_s:.2g} s") for error in errors)
    known = table(("figure", "error", "beside", "CPU time"), rows, "errors of computed figures")
    basis = render_markdown(render_basis_table(design))
    return join((basis, known, sources if unverified else ""))
