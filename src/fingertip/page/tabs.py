"""Frame of a page: title, tabs with their panels, footer, and the first screen that a design and a set have alike.

Without a script the panels stand one below the other, and the tabs are links to them; `page.js` makes tabs of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from fingertip.foundation.version import __version__
from fingertip.page.html import Markup, element, embed, join, read_asset, render_document
from fingertip.page.markdown import render, split_sections

_BEFORE = "Before you begin"


Tab = tuple[str, str, tuple[Markup, ...]]
"""Name of a panel, by which links lead to it, its label and its content."""


def render_tabs(
    name: str, title: str, tabs: Sequence[Tab], scripts: Iterable[str] = (), banner: str = "", end: str = ""
) -> bytes:
    """Render a page of tabs; `banner` stands above all of them, `end` below."""
    links = (element("li", element("a", label, href=f"#{to}", id=f"tab-{to}")) for to, label, _ in tabs)
    panels = (
        element("section", *content, id=to, class_="panel", aria_labelledby=f"tab-{to}") for to, _, content in tabs
    )
    body = (
        element("a", "Skip to the content", href="#content", class_="skip"),
        element("header", element("h1", title), banner),
        element("nav", element("ul", *links, id="tabs"), aria_label="sections"),
        element("main", *panels, id="content"),
        element("footer", end, element("p", f"Made by fingertip {__version__}. This page needs no network.")),
    )
    every = (read_asset("page.js"), *scripts)
    return render_document(f"{name}: fingertip", body, read_asset("page.css"), every, data_design=name)


def render_first_screen(text: str, pictures: Markup, links: Mapping[str, str]) -> Markup:
    """Render the first screen from its Markdown: a section is a box, or a step if its heading begins with a number."""
    sections = split_sections(text)
    lead, before = sections.pop(""), sections.pop(_BEFORE)
    steps = [
        element("li", element("h3", heading), render(sections.pop(heading), links))
        for heading in [*sections]
        if heading[0].isdigit()
    ]
    about = element(
        "div", element("div", render(lead), class_="lead"), element("h2", _BEFORE), render(before, links),
        render_facts(sections, links), class_="about",
    )  # fmt: skip
    return join((
        element("div", pictures, about, class_="hero"), element("h2", "The next three steps"),
        element("ol", *steps, class_="next"),
    ))  # fmt: skip


def render_facts(sections: Mapping[str, str], links: Mapping[str, str] | None = None) -> Markup:
    facts = (
        element("div", element("dt", title), element("dd", render(said, links))) for title, said in sections.items()
    )
    return element("dl", *facts, class_="facts")


def render_finger(picture: bytes, caption: Markup | str) -> Markup:
    image = element("img", src=embed(picture, "image/png"), alt="The finished finger, from the back and from the palm")
    return element("figure", image, element("figcaption", caption), class_="finger")
