"""Manifest of the figures: its entries, whether they are old, and
the sentences and tables that quote them.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tools.figures.hashing import hash_basis

ROOT = Path(__file__).resolve().parents[2]
FILE = Path(__file__).with_name("figures.toml")


@dataclass(frozen=True)
class Quote:
    """Sentence or table of a page that quotes figures."""

    page: str
    template: str
    """Template (Jinja2) of the text, in which each command's
    output stands under the command's name.
    """
    text: str
    """Text as it was rendered last, which stands on the page."""


@dataclass(frozen=True)
class Entry:
    """Figures that are renewed together."""

    name: str
    title: str
    """Subject of the sentence that a page holds while the figures are old."""
    commands: Mapping[str, str]
    """Commands that renew the figures, in this order, each by a name."""
    rests_on: tuple[str, ...]
    """Files and folders whose code and tables compute the figures."""
    presets: tuple[str, ...]
    """Designs that the figures are of."""
    writes: tuple[str, ...]
    """Files that the commands write."""
    quotes: tuple[Quote, ...]
    sha256: str
    """Hash of what the figures rested on when they were renewed."""
    renewed: str
    """Date on which they were renewed."""
    seconds: int
    """CPU time of the commands [s]."""
    is_old: bool
    """True if the page says that the figures are old."""

    @property
    def old_sentence(self) -> str:
        """Sentence that tells the reader of a page that the figures are old."""
        return f"{self.title} is of {self.renewed}; the program has changed since."

    def hash_now(self, root: Path = ROOT) -> str:
        """Hash what the figures rest on today."""
        return hash_basis(root, self.rests_on, self.presets)


def read_manifest(text: str) -> list[Entry]:
    """Read the entries of a manifest."""
    data = tomllib.loads(text)
    return [_read_entry(name, table, data["groups"]) for name, table in data["figures"].items()]


def _read_entry(name: str, table: Mapping[str, Any], groups: Mapping[str, Sequence[str]]) -> Entry:
    paths = dict.fromkeys(path for word in table["rests_on"] for path in groups.get(word, [word]))
    return Entry(
        name=name,
        title=table["title"],
        commands=table["commands"],
        rests_on=tuple(paths),
        presets=tuple(table.get("presets", ())),
        writes=tuple(table.get("writes", ())),
        quotes=tuple(
            Quote(quote["page"], quote["template"], quote["text"])
            for quote in table.get("quotes", ())
        ),
        sha256=table["sha256"],
        renewed=str(table["renewed"]),
        seconds=table["seconds"],
        is_old=table.get("is_old", False),
    )


def find_problems(entries: Sequence[Entry], root: Path = ROOT) -> Iterator[str]:
    """Yield a sentence for each entry that is old and does not say
    so, and for each page that differs from one.
    """
    for entry in entries:
        renew = f"run `python -m tools.figures renew {entry.name}` ({entry.seconds} s)"
        if not entry.is_old and entry.hash_now(root) != entry.sha256:
            yield (
                f"{entry.name}: what these figures rest on has changed since {entry.renewed}; "
                f"{renew}."
            )

        for quote in entry.quotes:
            if not find_text(quote.text, (root / quote.page).read_text(encoding="utf-8")):
                yield (
                    f"{entry.name}: {quote.page} does not hold the recorded {quote.text!r}; "
                    f"correct it, or {renew}."
                )

        for path in entry.writes:
            if not (root / path).is_file():
                yield f"{entry.name}: {path} is missing; {renew}."

        said = [
            page.name
            for page in list_pages(root)
            if find_text(entry.old_sentence, page.read_text("utf-8"))
        ]
        if entry.is_old and not said:
            yield f"{entry.name}: its page must say {entry.old_sentence!r}; add it, or {renew}."
        if said and not entry.is_old:
            yield (
                f"{entry.name}: the figures are current; take {entry.old_sentence!r} off {said[0]}."
            )


def list_pages(root: Path = ROOT) -> list[Path]:
    """List README and the pages of the manual."""
    return [root / "README.md", *sorted((root / "docs").glob("*.md"))]


def find_text(text: str, page: str) -> re.Match[str] | None:
    """Find a text on a page, whose lines may break elsewhere."""
    return re.search(r"\s+".join(map(re.escape, text.split())), page)


def replace_text(page: str, old: str, new: str) -> str:
    """Replace a text on a page; a sentence keeps the page's breaks of lines, if it keeps its number
    of words.

    Raises LookupError if the page does not hold the text.
    """
    found = find_text(old, page)
    if found is None:
        raise LookupError(f"the page does not hold {old!r}")

    words = new.split()
    gaps = re.findall(r"\s+", found[0])
    if "\n" not in new and len(words) == len(gaps) + 1:
        new = "".join(word + gap for word, gap in zip(words, [*gaps, ""], strict=True))

    return page[: found.start()] + new + page[found.end() :]
