"""HTML document with its style and scripts in it.

The content security policy at its top allows nothing else: the browser itself refuses every script but those whose
hashes it states, and every request that is not named.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable, Sequence
from importlib.resources import files

from fingertip.page.html import Markup, element


def render_document(
    title: str, body: Iterable[Markup], style: str, scripts: Sequence[str], connect: str = "", **attributes: str
) -> bytes:
    """Render a document.

    Parameters
    ----------
    title
        Its title.
    body
        Elements of its body, before the scripts.
    style, scripts
        Style sheet and scripts that stand in it.
    connect
        Source that its scripts may ask, such as "'self'"; none by default.
    attributes
        Attributes of its root element.
    """
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=_policy(style, scripts, connect)),
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


def read_asset(name: str, package: str = "fingertip.page") -> str:
    """Read a style sheet or script of a package."""
    return (files(package) / "assets" / name).read_text(encoding="utf-8")


def _policy(style: str, scripts: Sequence[str], connect: str) -> str:
    hashes = " ".join(_hash(script) for script in scripts)
    asked = f" connect-src {connect};" if connect else ""
    return (
        f"default-src 'none'; script-src {hashes}; style-src {_hash(style)}; img-src data: blob:;{asked} "
        "base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode('ascii')}'"
