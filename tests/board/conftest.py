"""Boards that many tests look at: written once a session, read by each."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from fingertip.board import write_board
from fingertip.board.variants import VARIANTS
from fingertip.design import Design

BOARDS = {name: variant.changes for name, variant in VARIANTS.items()} | {
    "other values": ("board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.series=E96"),
    "chosen capacitors": ("board.cutoff_hz=50", "board.capacitor_series=E12", "board.supply=single"),
}
"""Every variant with every supply, and others of the same places and nets."""

Written = Callable[..., Path]


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """The folder of a design with these changes, for reading only (KiCad's reports may be put beside)."""
    folders: dict[tuple[str, ...], Path] = {}

    def folder(*changes: str) -> Path:
        if changes not in folders:
            folders[changes] = tmp_path_factory.mktemp("board") / "pcb"
            write_board(Design.load(changes=changes), folders[changes])
        return folders[changes]

    return folder
