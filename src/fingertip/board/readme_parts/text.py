"""Layout of the README's text: paragraphs, bullets, capitals."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable


def paragraph(text: str, first_indent: str = "", indent: str = "") -> str:
    """Wrap a text to lines of 120 characters."""
    return textwrap.fill(text, 120, initial_indent=first_indent, subsequent_indent=indent, break_on_hyphens=False)


def capitalize(text: str) -> str:
    """Begin a text with a capital letter, and leave the rest as it is."""
    return text[:1].upper() + text[1:]


def bullet_list(notes: Iterable[str]) -> str:
    """Bullet list in Markdown, an item for each note."""
    return "\n".join(paragraph(note, "- ", "  ") for note in notes)
