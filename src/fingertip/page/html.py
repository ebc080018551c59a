"""HTML elements and documents from Python calls; text that is not markup is escaped."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape, unescape
from importlib.resources import files

_VOID = frozenset({"br", "col", "hr", "img", "input", "link", "meta"})
"""Elements without content."""


class Markup(str):
    """Text that is HTML already."""

    __slots__ = ()


def element(name: str, /, *children: str, **attributes: str | float | bool | None) -> Markup:
    """Build an element; an attribute `data_part` becomes `data-part`, `class_` becomes `class`."""
    pairs = ""
    for key, value in attributes.items():
        if value is not None and value is not False:
            pairs += f" {key.rstrip('_').replace('_', '-')}"
            pairs += "" if value is True else f'="{escape(str(value))}"'

    if name in _VOID:
        return Markup(f"<{name}{pairs}>")

    return Markup(f"<{name}{pairs}>{join(children)}</{name}>")


def code(name: str) -> Markup:
    """Build a name of parameters, checks or files, which may break after a dot or an underscore."""
    return Markup(
        "<wbr>".join(escape(piece, quote=False) for piece in re.split(r"(?<=[._])", name))
    )


def join(children: Iterable[str]) -> Markup:
    """Join pieces of content; text that is not markup is escaped."""
    return Markup(
        "".join(
            child if isinstance(child, Markup) else escape(child, quote=False) for child in children
        )
    )


def figure(picture: Markup, caption: str, label: str = "", class_: str = "") -> Markup:
    """Build a picture with its caption.

    It is as wide as the page at most; `page.js` adds a button that enlarges it.
    """
    below = [element("figcaption", caption)] if caption else []
    return element("figure", picture, *below, class_=class_ or None, aria_label=label or None)


def table(
    head: Sequence[str],
    rows: Iterable[Sequence[str]],
    caption: str = "",
    class_: str = "",
    **attributes: str,
) -> Markup:
    """Build a table.

    Where there is no room for its columns, each row stands as a card, its cells with their names.
    """
    title = [element("caption", caption)] if caption else []
    header = element("thead", element("tr", *(element("th", cell, scope="col") for cell in head)))
    names = [_strip(cell) for cell in head]
    lines = []
    for row in rows:
        cells = zip(names, row, strict=True)
        lines.append(element("tr", *(element("td", cell, data_label=name) for name, cell in cells)))

    body = element("tbody", *lines)
    kinds = " ".join(kind for kind in ("cards" if len(head) > 2 else "", class_) if kind)
    inner = element("table", *title, header, body, class_=kinds or None, **attributes)

    return scrolling(inner, _strip(caption) or ", ".join(names))


def _strip(text: str) -> str:
    """Return text without elements, which an attribute cannot hold."""
    return unescape(re.sub(r"<[^>]*>", "", text)) if isinstance(text, Markup) else text


def fold(title: str, *content: str, name: str = "", state: str = "", level: int = 3) -> Markup:
    """Build a folded section; "open", or "roomy": open at first on a wide screen."""
    heading = element("summary", element(f"h{level}", title, id=name or None))
    return element(
        "details", heading, *content, open=bool(state), class_="roomy" if state == "roomy" else None
    )


def scrolling(inner: Markup, label: str) -> Markup:
    """Build what scrolls by itself where its content is wider than the page."""
    return element(
        "div",
        inner,
        class_="scroll",
        role="group",
        tabindex="0",
        aria_label=label,
    )


def button(*children: str, **attributes: str | bool | None) -> Markup:
    """Build a button for a script: it sends no form."""
    return element("button", *children, type="button", **attributes)


def list_links(paths: Iterable[str], links: Mapping[str, str], class_: str | None = None) -> Markup:
    """Build a list of links to files, by the address of each path."""
    items = (element("li", element("a", path, href=links[path])) for path in paths)
    return element("ul", *items, class_=class_)


_NOT_EXPLAINED = re.compile(
    r"</?(a|abbr|button|caption|code|dfn|h\d|label|option|script|select|span|summary|svg|th)\b"
)
"""Elements without explained words: titles, and what has a purpose under the pointer."""


def explain(content: Markup, meanings: Mapping[str, str]) -> Markup:
    """Give the first mention of each word its meaning, which shows under the pointer."""
    waiting = dict(meanings)
    inside = 0
    pieces = list[str]()

    def mark(match: re.Match[str]) -> str:
        meaning = waiting.pop(match[0], None)
        return element("abbr", match[0], title=meaning) if meaning else match[0]

    word = re.compile(rf"(?<!paper )\b(?:{'|'.join(map(re.escape, meanings))})\b")
    for piece in re.split(r"(<[^>]*>)", content):
        if _NOT_EXPLAINED.match(piece):
            inside += -1 if piece[1] == "/" else 1

        pieces.append(piece if inside or piece.startswith("<") else word.sub(mark, piece))

    return Markup("".join(pieces))


def note(*children: str) -> Markup:
    """Build a paragraph that stands out from the text around it."""
    return element("p", *children, class_="note")


def embed(data: bytes, media_type: str) -> str:
    """Make an address that holds the data of a picture itself."""
    return f"data:{media_type};base64,{base64.b64encode(data).decode('ascii')}"


_SIGNS = {
    "": "",
    "at most": "≤ ",
    "at least": "≥ ",
    "exactly": "= ",
}


def quantity(value: float, unit: str, bound: str = "") -> Markup:
    """Build a number with its unit; it may be a bound, such as "at most"."""
    return element("span", f"{_SIGNS[bound]}{value:.4g} {unit}".rstrip(), class_="num")


def render_document(
    title: str,
    body: Iterable[Markup],
    style: str,
    scripts: Sequence[str],
    connect: str = "",
    **attributes: str,
) -> bytes:
    """Render a document with its style and scripts in it.

    The content security policy at its top allows nothing else: the browser itself refuses every
    script but those whose hashes it states, and every request that is not named.
    """
    connections = f" connect-src {connect};" if connect else ""
    policy = (
        f"default-src 'none'; script-src {' '.join(map(_hash, scripts))}; style-src "
        f"{_hash(style)}; "
        f"img-src data: blob:;{connections} base-uri 'none'; form-action 'none'"
    )
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=policy),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("title", title),
        element("style", Markup(style)),
    )
    whole = element("body", *body, *(element("script", Markup(script)) for script in scripts))
    page = element("html", head, whole, lang="en", **attributes)

    return f"<!DOCTYPE html>\n{page}\n".encode()


def read_viewer_library() -> str:
    """Read the library of the 3D view with its licence."""
    return f"/*\n{read_asset('three.LICENSE')}*/\n{read_asset('three.bundle.js')}"


def read_asset(name: str, package: str = __package__ or "") -> str:
    return (files(package) / "assets" / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode('ascii')}'"
