"""Docstrings of the folders of src: what comes in, what goes out, and a call that runs."""

from __future__ import annotations

import ast
import doctest

import pytest

from tests.conftest import ROOT

SRC = ROOT / "src" / "fingertip"
FOLDERS = sorted(
    path.parent.relative_to(SRC).as_posix()
    for path in SRC.rglob("__init__.py")
    if path.parent != SRC
)


@pytest.mark.every_case
@pytest.mark.parametrize("folder", FOLDERS)
def test_each_folder_begins_with_a_call_that_runs(folder: str) -> None:
    path = SRC / folder / "__init__.py"
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    assert len(text.splitlines()) >= 4, "what comes in, what goes out, one call"
    example = doctest.DocTestParser().get_doctest(text, {}, folder, str(path), 0)
    assert example.examples
    messages: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=messages.append)
    assert not messages, "".join(messages)
