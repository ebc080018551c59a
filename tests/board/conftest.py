"""Boards that many tests read: written once per session."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.tasks.board_files import write_board
from tests.designs import load_article

BOARDS = VARIANT_CHANGES | {
    "other values": ("board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.series=E96"),
    "selected capacitors": (
        "board.variant=precision",
        "board.cutoff_hz=50",
        "board.capacitor_series=E12",
    ),
}
"""Every variant, and two more with the same placement and nets."""

BoardFolder = Callable[..., Path]
"""Function that returns the folder with the board of a design, from changes to the
default design.
"""


@pytest.fixture(scope="session")
def board_folder(tmp_path_factory: pytest.TempPathFactory) -> BoardFolder:
    """Return a function that writes the board of a design with these changes, once, and returns its
    folder.

    Tests only read from the folder. KiCad's reports may be written into it.
    """
    folders: dict[tuple[str, ...], Path] = {}

    def folder(*changes: str) -> Path:
        if changes not in folders:
            folders[changes] = tmp_path_factory.mktemp("board") / "pcb"
            write_board(load_article(changes), folders[changes])
        return folders[changes]

    return folder
