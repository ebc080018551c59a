"""Hooks of mkdocs: pages and pictures that are generated when the site is built.

A comment such as `<!-- steps -->` in a page is replaced by pictures of the bundled designs, by the
parameter reference, by the help pages of all commands or by the executed notebook.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tools.docs_site import notebook, pictures, reference

POLICY = (
    "default-src 'self' file: data: blob: 'unsafe-inline' 'unsafe-eval'; object-src 'none'; "
    "form-action 'none'; "
    "base-uri 'none'"
)
"""Content security policy of every page: the browser asks no other server."""

STYLE_SHEET = "site.css"
STYLE = """\
.md-typeset td code, .md-typeset th code { word-break: normal; white-space: nowrap; }
.md-typeset table:not([class]) { display: table; font-size: .64rem; }
.md-typeset table:not([class]) td, .md-typeset table:not([class]) th { padding: .4em .8em; min-width: 0; }
.md-typeset table caption { text-align: left; font-weight: bold; padding: .4em .8em; }
.md-typeset pre > code { white-space: pre-wrap; overflow-wrap: anywhere; }
.md-typeset a:not(.headerlink):not(:has(> img)), .md-copyright a { text-decoration: underline; }
.md-copyright { color: var(--md-footer-fg-color--light); }
.md-typeset .highlight :is(.c, .c1, .cm) { color: var(--md-code-fg-color); font-style: italic; }
@media (max-width: 45em) {
  .md-typeset__scrollwrap { overflow: visible; margin: 0; } .md-typeset__table { padding: 0; width: 100%; }
  .md-typeset table:not([class]) { table-layout: fixed; width: 100%; overflow-wrap: anywhere; }
  .md-typeset td code, .md-typeset th code { white-space: normal; }
}
"""  # noqa: E501
"""Style sheet of the site: long lines wrap, for nothing may scroll
that no key reaches, and links are underlined.
"""

_PICTURE = re.compile(r'(<img\b[^>]*\bsrc="([^":]+)"[^>]*>)')
"""Picture from a file, which is shown no wider than the text: a link leads to it in its
own size.
"""

_GENERATED: dict[str, Callable[[], str]] = {
    "parameters": reference.list_all_parameters,
    "commands": reference.list_all_commands,
    "notebook": notebook.execute,
    "steps": pictures.list_steps,
    "gallery": pictures.list_designs,
}
"""Name in a comment of a page -> function that writes the Markdown in its place."""

_OUTSIDE = re.compile(r"(?<!!)\[([^\]]+)\]\((\.\./[^)#]*)(?:#[^)]*)?\)")
"""Link out of `docs/`, which the site does not hold."""


def on_files(files: Files, config: Any) -> Files:
    """Add the generated pictures, and the notebook to download."""
    files.append(File.generated(config, STYLE_SHEET, content=STYLE))
    files.append(
        File.generated(
            config, notebook.SCRIPT.with_suffix(".ipynb").name, content=notebook.to_ipynb()
        )
    )
    for name, content in pictures.draw_all().items():
        files.append(File.generated(config, name, content=content))

    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Insert what is generated, and turn links out of `docs/` into the names of the files."""
    for marker, text in _GENERATED.items():
        comment = f"<!-- {marker} -->"
        if comment in markdown:
            markdown = markdown.replace(comment, text())

    return _OUTSIDE.sub(_name_file, markdown)


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Put the policy at the top of the page."""
    return _with_policy(output)


def on_post_template(output: str, template_name: str, config: Any) -> str:
    """Put the policy at the top of the page of errors."""
    return _with_policy(output) if template_name.endswith(".html") else output


def _with_policy(page: str) -> str:
    page = _PICTURE.sub(r'<a href="\2">\1</a>', page)
    return page.replace(
        "<head>", f'<head><meta http-equiv="Content-Security-Policy" content="{POLICY}">', 1
    )


def _name_file(link: re.Match[str]) -> str:
    """Text of a link with the name of its file."""
    text = link[1]
    path = link[2].removeprefix("../")
    return f"`{path}`" if text.strip("`") == path else f"{text} (`{path}` in the repository)"
