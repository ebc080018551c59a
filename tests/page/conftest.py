from __future__ import annotations

import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from fingertip import Design, make
from fingertip.catalogues.output_files import PAGE
from fingertip.tasks.build import parts_writer
from fingertip.tasks.page import write_page

DRAWING = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M1 1h7"/></svg>\n'
VOID = {"br", "col", "hr", "img", "input", "link", "meta", "wbr"}


class Page(HTMLParser):
    """Page as a browser reads it: elements in order, text by element, and whatever is not well-formed."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.source = text
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.faults: list[str] = []
        self.scripts: list[str] = []
        self.words: list[str] = []
        self._open: list[str] = []
        self.feed(text)
        self.close()
        self.faults += [f"<{name}> is not closed" for name in self._open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if len(dict(attrs)) < len(attrs):
            self.faults.append(f"<{tag}> repeats an attribute")
        self.elements.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")
        if tag not in VOID:
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if not self._open or self._open.pop() != tag:
            self.faults.append(f"</{tag}> closes another element, at {self.getpos()}")

    def handle_data(self, data: str) -> None:
        if self._open and self._open[-1] == "script":
            self.scripts[-1] += data
        elif not (self._open and self._open[-1] == "style"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return "".join(self.words)

    def attributes(self, name: str) -> Iterator[str]:
        yield from (value or "" for _, attributes in self.elements for key, value in attributes.items() if key == name)

    @property
    def scene(self) -> list[dict[str, Any]]:
        data: list[dict[str, Any]] = json.loads(self.scripts[0])
        return data


def strip_elements(markup: str) -> str:
    return re.sub(r"<[^>]*>", "", markup)


@pytest.fixture(scope="session")
def design() -> Design:
    return Design.load("fsr400")


@pytest.fixture(scope="session")
def folder(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Everything of a design, with a drawing in place of the one that takes a minute."""
    place = tmp_path_factory.mktemp("page") / "finger"
    made = make(design, place, formats=["stl"])
    assert made.page == place / PAGE
    parts_writer(design, place).add({"drawing_bone.svg": DRAWING})
    write_page(design, place)
    return place


@pytest.fixture(scope="session")
def page(folder: Path) -> Page:
    return Page((folder / PAGE).read_text(encoding="utf-8"))
