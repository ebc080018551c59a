"""Mutation testing: equivalent mutants fit a line."""

from __future__ import annotations

import re

from tests.conftest import ROOT
from tools.mutation.mutants import read_equivalent


def test_equivalent_mutants_fit_a_line_of_their_module_and_say_why() -> None:
    wrong = []
    for entry in read_equivalent():
        path = ROOT / entry["module"]
        lines = [line.strip() for line in path.read_text(encoding="utf-8").splitlines()] if path.is_file() else []
        fits = any(re.fullmatch(entry["before"], line) for line in lines)
        if not fits or any(re.fullmatch(entry["after"], line) for line in lines if line) or len(entry["reason"]) < 20:
            wrong.append(entry)
    assert wrong == [], "the line is gone, or has no reason: remove the entry or mend it"
