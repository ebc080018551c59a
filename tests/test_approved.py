"""Approved texts that stand beside a whole: what is stored, and that
the order of their approval does not matter.
"""

from __future__ import annotations

from itertools import permutations
from pathlib import Path

import pytest

from tests.approved import check_text

TEXTS = {"whole": "a\nb\nc\nd\n", "longer": "z\na\nb\nc\nd\ne", "shorter": "a\n\nd\n", "empty": ""}


def test_differences_from_a_whole_are_stored_in_any_order_of_approval(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for names in permutations(TEXTS):
        folder = tmp_path / "-".join(names)
        monkeypatch.setenv("FINGERTIP_APPROVE", "1")
        for names_then, end in ((names[::-1], "old"), (names, "")):
            for name in names_then:
                check_text(
                    folder / name, TEXTS[name] + end, folder / "whole" if name != "whole" else None
                )
        monkeypatch.delenv("FINGERTIP_APPROVE")
        assert (folder / "shorter").read_text() == "Differences from whole:\n@@ -2,2 @@\n+\n"
        for name, text in TEXTS.items():
            check_text(folder / name, text, folder / "whole" if name != "whole" else None)
            with pytest.raises(AssertionError):
                check_text(folder / name, text + "e", folder / "whole" if name != "whole" else None)
