"""Documents of a board, compared whole with approved ones: the README and the bring-up sheet of each kind of board.

The approved documents of the default board and of the article's are those in `pcb/`, which the manifest compares.
After a change that is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest tests/board/test_readme.py` writes the rest.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.tasks.board import board_files, bring_up_files
from tests.designs import load_article

APPROVED = Path(__file__).parent / "approved"


def check_approved(name: str, data: bytes) -> None:
    """Compare a document with the approved one, or approve it."""
    if os.environ.get("FINGERTIP_APPROVE"):
        (APPROVED / name).write_bytes(data)
    assert data.decode() == (APPROVED / name).read_text(encoding="utf-8")


@pytest.mark.every_case
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_is_the_approved_one(name: str) -> None:
    check_approved(f"{name}.md", board_files(load_article(BOARD_CONFIGURATIONS[name].changes))["README.md"])


@pytest.mark.full
@pytest.mark.parametrize("name", ["article_single", "precision_split", "comparator_split", "comparator_single_3v3"])
def test_bring_up_sheet_is_the_approved_one(name: str) -> None:
    check_approved(f"{name}_bringup.md", bring_up_files(load_article(BOARD_CONFIGURATIONS[name].changes))["bringup.md"])
