"""Which board fabrication files were made from, as hashes beside them: nobody sends old gerbers for a new board."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

_SOURCES = (".kicad_pcb", ".kicad_sch", "bom.csv")
"""Ends of the names of the board's files that fabrication files follow from."""
_UP = "../"


def origin(board: Mapping[str, bytes], files: Mapping[str, bytes]) -> bytes:
    """Hashes of the board's files that `files` were made from, one folder up, and of `files` themselves.

    `sha256sum --check` reads it.
    """
    lines = [f"{_hash(data)}  {_UP}{name}" for name, data in board.items() if name.endswith(_SOURCES)]
    lines += [f"{_hash(data)}  {name}" for name, data in files.items()]
    return ("\n".join(lines) + "\n").encode()


def differing(folder: Path, record: str, board: Mapping[str, bytes]) -> list[str]:
    """What in a folder of fabrication files is not of these files of a board, as sentences.

    Parameters
    ----------
    folder
        The fabrication files'.
    record
        Name of the file with what `origin` gave.
    board
        The board's files, as its design gives them.
    """
    anew = "make it anew with --fab"
    try:
        pairs = [line.split("  ", 1) for line in (folder / record).read_text("utf-8").splitlines()]
        told = {name: kept for kept, name in pairs}
    except (OSError, UnicodeDecodeError, ValueError):
        return [f"{folder}: holds no {record} that says which board its files are of; {anew}."]
    of_board = {f"{_UP}{name}": data for name, data in board.items() if name.endswith(_SOURCES)}
    found = [
        f"{folder}: was made from another {name.removeprefix(_UP)} than this design gives; {anew}."
        for name, data in of_board.items()
        if told.get(name) != _hash(data)
    ]
    for name, kept in told.items():
        if not name.startswith(_UP):
            found += _kept(folder / name, kept)
    return found


def _kept(path: Path, expected: str) -> list[str]:
    try:
        same = _hash(path.read_bytes()) == expected
    except OSError as error:
        return [f"{path}: cannot be read ({error.strerror})."]
    return [] if same else [f"{path}: was changed after it was made."]


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
