"""Markdown sheets of a design as HTML: headings, paragraphs, lists, tables, bold, code and pictures."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import PurePath

from markdown_it import MarkdownIt
from markdown_it.tree import SyntaxTreeNode

from fingertip.page.html import Markup, element, join, table

_PARSER = MarkdownIt("zero").enable(
    ["heading", "list", "table", "newline", "backticks", "emphasis", "entity", "image", "link"]
)


def split_sections(text: str) -> dict[str, str]:
    """Split a page at its second-level headings: heading -> text below it. The part before the first has the key ""."""
    mark, found, heading = "## ", {"": ""}, ""
    for line in text.splitlines():
        if line.startswith(mark):
            heading = line.removeprefix(mark).strip()
            found[heading] = ""
        else:
            found[heading] += line + "\n"
    return found


def render(text: str, links: Mapping[str, str] | None = None, **attributes: str) -> Markup:
    """Render Markdown. Headings become the third level and below, because a page has its own two.

    `links` are addresses by path: a file whose name stands as code becomes a link, a picture is shown, and neither is
    if its path is not there. Links of the text itself lead within the page. Tables get the attributes.
    """
    return join(_render(node, links or {}, attributes) for node in SyntaxTreeNode(_PARSER.parse(text)).children)


def list_steps(text: str, links: Mapping[str, str]) -> Markup:
    """Render a numbered list as steps to unfold and tick off, each with its picture, whose name is its title."""
    # Sheets indent pictures by three columns; below a number of two digits Markdown asks for four.
    (steps,) = SyntaxTreeNode(_PARSER.parse(text.replace("\n   ![", "\n    !["))).children
    listed = []
    for number, step in enumerate(steps.children, 1):
        paths = [str(node.attrs["src"]) for node in step.walk() if node.type == "image"]
        title = PurePath(paths[0]).stem.partition("-")[2].replace("_", " ").capitalize() if paths else ""
        said = [rendered for part in step.children if (rendered := _render(part, links, {}))]
        begin = element("span", re.sub(r"<[^>]*>", "", said[0].partition(". ")[0]), class_="begin")
        head = element("summary", element("span", f"Step {number}", class_="number"), " ", title, begin)
        body = element("details", head, *(element("p", part) for part in said))
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
            return element("img", src=source, alt=node.content) if source.startswith("data:") else ""
        case "heading":
            return element(f"h{min(int(node.tag[1]) + 1, 6)}", *inner)
        case "table":
            head, *rows = (
                [_render(cell, links, attributes) for cell in row.children] for row in node.walk() if row.type == "tr"
            )
            return table(head, rows, **attributes)
        case "list_item":  # a picture stands below its text
            return element("li", *[piece for paragraph in inner for piece in (" ", paragraph)][1:])
        case "strong" | "bullet_list" | "ordered_list":
            return element(node.tag, *inner)
        case "paragraph" if node.level == 0:
            return element("p", *inner)
    return join(inner)
