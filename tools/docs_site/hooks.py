"""Hooks of mkdocs: pages and pictures that are generated when the site is built.

A comment such as `<!-- steps -->` in a page is replaced by pictures of the bundled designs. The parameter reference,
the help pages of all commands and the executed notebook are pages without a file in `docs/`.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tools.docs_site import notebook, pictures, reference

POLICY = (
    "default-src 'self' file: data: blob: 'unsafe-inline' 'unsafe-eval'; object-src 'none'; form-action 'none'; "
    "base-uri 'none'"
)
"""Content security policy of every page: the browser asks no other server."""

_OUTSIDE = re.compile(r"(?<!!)\[([^\]]+)\]\((\.\./[^)#]*)(?:#[^)]*)?\)")
"""Link out of `docs/`, which the site does not hold."""


def on_files(files: Files, config: Any) -> Files:
    """Add the generated pages and pictures."""
    generated: dict[str, str | bytes] = {
        "parameters.md": reference.parameter_page(),
        "commands.md": reference.command_page(),
        "notebook.md": notebook.execute(),
        "tour_in_jupyter.ipynb": notebook.to_ipynb(),
        **pictures.draw_all(),
    }
    for name, content in generated.items():
        files.append(File.generated(config, name, content=content))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Insert generated pictures, and turn links out of `docs/` into the names of the files."""
    for marker, text in pictures.markers().items():
        markdown = markdown.replace(f"<!-- {marker} -->", text)
    return _OUTSIDE.sub(_name_file, markdown)


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Put the policy at the top of the page."""
    return _with_policy(output)


def on_post_template(output: str, template_name: str, config: Any) -> str:
    """Put the policy at the top of the page of errors."""
    return _with_policy(output) if template_name.endswith(".html") else output


def _with_policy(page: str) -> str:
    return page.replace("<head>", f'<head><meta http-equiv="Content-Security-Policy" content="{POLICY}">', 1)


def _name_file(link: re.Match[str]) -> str:
    """Text of a link with the name of its file."""
    text, path = link[1], link[2].removeprefix("../")
    return f"`{path}`" if text.strip("`") == path else f"{text} (`{path}` in the repository)"
