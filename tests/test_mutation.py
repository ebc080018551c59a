"""Mutation testing: equivalent mutants fit a line."""

from __future__ import annotations

import re

from tests.conftest import ROOT
from tools.mutation.mutants import list_modules, read_equivalent


def test_equivalent_mutants_fit_a_line_of_their_module_and_say_why() -> None:
    wrong = []
    for entry in read_equivalent():
        paths = (
            [ROOT / entry["module"]] if "module" in entry else [path for _, path in list_modules()]
        )
        texts = (path.read_text(encoding="utf-8") for path in paths if path.is_file())
        lines = [line.strip() for text in texts for line in text.splitlines()]
        fits = any(
            re.fullmatch(entry.get("before", f".*{entry.get('part')}.*"), line) for line in lines
        )
        changed = "after" in entry and any(
            re.fullmatch(entry["after"], line) for line in lines if line
        )
        if not fits or changed or len(entry["reason"]) < 20:
            wrong.append(entry)
    assert wrong == [], "the line is gone, or has no reason: remove the entry or mend it"
