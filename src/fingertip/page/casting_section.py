"""Casting guide of a page: the casting sheet with the pictures of its steps, and the tests of the finished finger."""

from __future__ import annotations

import base64

from fingertip.build_result import SHEET, STEPS_FOLDER
from fingertip.page.html import Markup, element, figure, join
from fingertip.page.markdown import list_steps, render, split_sections
from fingertip.page.sources import COMMANDS, Sources

_ACCEPTANCE = "acceptance.md"
_PROCEDURE = "Procedure"
_OPEN = ("What to buy", "Quantities", "Warnings")
"""Sections that nobody should miss; others are folded up."""


def render_casting(sources: Sources) -> Markup:
    """Render the casting sheet, its procedure as steps with pictures."""
    sections = split_sections(sources.files[SHEET].decode())
    pictures = embed_pictures(sources)
    parts = [render(sections.pop("").partition("\n")[2])]
    for heading, text in sections.items():
        if heading == _PROCEDURE:
            parts.append(element("h3", "Step by step"))
            if STEPS_FOLDER in sources.remarks:
                parts.append(element("p", sources.remarks[STEPS_FOLDER], class_="note"))
            parts.append(list_steps(text, pictures))
        elif heading in _OPEN:
            parts += [element("h3", heading), render(text)]
        else:
            parts.append(element("details", element("summary", heading), render(text)))
    if page := sources.text(_ACCEPTANCE):
        title = "Tests of sensor and finished finger, with what each failure means"
        parts.append(element("details", element("summary", title), render(page.partition("\n")[2])))
    return join(parts)


def embed_pictures(sources: Sources) -> dict[str, str]:
    """Turn the pictures of the steps into addresses that hold their data, by their path in the sheet."""
    return {
        name: f"data:image/png;base64,{base64.b64encode(data).decode('ascii')}"
        for name, data in sources.files.items()
        if name.startswith(f"{STEPS_FOLDER}/") and name.endswith(".png")
    }


def render_drawing(sources: Sources) -> Markup:
    """Render the dimensioned sheets, or say how to make them."""
    sheets = {
        name: data for name, data in sources.files.items() if name.startswith("drawing_") and name.endswith(".svg")
    }
    if not sheets:
        return element(
            "p", "There is no drawing of these parts yet: in the folder of this page, ",
            element("code", COMMANDS["drawing"]),
            " makes a sheet with all dimensions and tolerances for each printed part, and ",
            element("code", COMMANDS["page"]), " then shows them here.", class_="note",
        )  # fmt: skip
    return join(_render_sheet(name, data) for name, data in sheets.items())


def _render_sheet(name: str, data: bytes) -> Markup:
    part = name.removeprefix("drawing_").removesuffix(".svg").replace("_", " ")
    source = f"data:image/svg+xml;base64,{base64.b64encode(data).decode('ascii')}"
    picture = element("img", src=source, alt=f"Dimensioned drawing of the {part}", decoding="async")
    return figure(picture, f"{part}, from {name}", f"drawing of the {part}", "wide paper")
