"""Markdown sheets of a design as HTML: headings, paragraphs, lists, tables, bold, code and pictures."""

from __future__ import annotations

from collections.abc import Mapping

from markdown_it import MarkdownIt
from markdown_it.tree import SyntaxTreeNode

from fingertip.page.html import Markup, element, join, table

_PARSER = MarkdownIt("zero").enable(["heading", "list", "table", "newline", "backticks", "emphasis", "entity", "image"])


def split_sections(text: str, level: int = 2) -> dict[str, str]:
    """Split a page at the headings of a level: heading -> text below it. The part before the first has the key ""."""
    mark, found, heading = "#" * level + " ", {"": ""}, ""
    for line in text.splitlines():
        if line.startswith(mark):
            heading = line.removeprefix(mark).strip()
            found[heading] = ""
        else:
            found[heading] += line + "\n"
    return found


def render(text: str, pictures: Mapping[str, str] | None = None) -> Markup:
    """Render Markdown. Headings become the third level and below, because a page has its own two.

    A picture is shown if `pictures` has its data by its path.
    """
    return join(_render(node, pictures or {}) for node in SyntaxTreeNode(_PARSER.parse(text)).children)


def list_steps(text: str, pictures: Mapping[str, str]) -> Markup:
    """Render a numbered list as steps, each with its picture."""
    # Sheets indent pictures by three columns; below a number of two digits Markdown asks for four.
    (steps,) = SyntaxTreeNode(_PARSER.parse(text.replace("\n   ![", "\n    !["))).children
    return element("ol", *(_render(step, pictures) for step in steps.children), class_="steps")


def _render(node: SyntaxTreeNode, pictures: Mapping[str, str]) -> str:
    inner = [_render(child, pictures) for child in node.children]
    match node.type:
        case "text":
            return node.content.replace("\N{NO-BREAK SPACE}", "")
        case "softbreak":
            return " "
        case "code_inline":
            return element("code", node.content)
        case "image":
            source = pictures.get(str(node.attrs["src"]))
            return element("img", src=source, alt=node.content, decoding="async") if source else ""
        case "heading":
            return element(f"h{min(int(node.tag[1]) + 1, 6)}", *inner)
        case "table":
            head, *rows = (
                [_render(cell, pictures) for cell in row.children] for row in node.walk() if row.type == "tr"
            )
            return table(head, rows)
        case "list_item":  # a picture stands below its text
            return element("li", *[piece for paragraph in inner for piece in (" ", paragraph)][1:])
        case "strong" | "bullet_list" | "ordered_list":
            return element(node.tag, *inner)
        case "paragraph" if node.level == 0:
            return element("p", *inner)
    return join(inner)
