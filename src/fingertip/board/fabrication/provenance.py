"""Provenance of fabrication files: hashes of the board they were made from.

They reveal gerbers of an earlier board before anybody sends them to a board house.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from fingertip.errors import InputFileError
from fingertip.input_files import OUTPUT_LIMIT, PARSED_LIMIT, read_input

_SOURCES = (".kicad_pcb", ".kicad_sch", "bom.csv")
"""Endings of the names of the board files that the fabrication files depend on."""
_PARENT = "../"


def provenance_record(board_files: Mapping[str, bytes], fabrication_files: Mapping[str, bytes]) -> bytes:
    """Content of the record, in the format of `sha256sum --check`.

    It lists the board files that the fabrication files were made from, one folder up, and the fabrication files.
    """
    lines = [f"{_sha256(data)}  {_PARENT}{name}" for name, data in board_files.items() if name.endswith(_SOURCES)]
    lines += [f"{_sha256(data)}  {name}" for name, data in fabrication_files.items()]
    return ("\n".join(lines) + "\n").encode()


def find_outdated_files(folder: Path, record: str, board_files: Mapping[str, bytes]) -> list[str]:
    """Describe how a folder of fabrication files differs from what a board's files give; empty if it does not.

    Parameters
    ----------
    folder
        Folder with the fabrication files.
    record
        Name of the file with the provenance record.
    board_files
        Content of the board's files by name, as its design gives them.
    """
    remedy = "write it again with --fab"
    try:
        text = read_input(folder / record, PARSED_LIMIT, below=folder.parent).decode()
        lines = [line.split("  ", 1) for line in text.splitlines()]
        recorded = {name: digest for digest, name in lines}
    except (InputFileError, ValueError):  # a UnicodeDecodeError is a ValueError
        return [f"{folder}: has no valid {record} that names the board its files were made from; {remedy}."]
    sources = {f"{_PARENT}{name}": data for name, data in board_files.items() if name.endswith(_SOURCES)}
    differences = [
        f"{folder}: was made from another {name.removeprefix(_PARENT)} than this design gives; {remedy}."
        for name, data in sources.items()
        if recorded.get(name) != _sha256(data)
    ]
    for name, digest in recorded.items():
        if not name.startswith(_PARENT):
            differences += _compare_file(folder, name, digest)
    return differences


def _compare_file(folder: Path, name: str, digest: str) -> list[str]:
    path = folder / name
    try:
        is_unchanged = _sha256(read_input(path, OUTPUT_LIMIT, below=folder)) == digest
    except InputFileError as error:
        return [str(issue) for issue in error.issues]
    return [] if is_unchanged else [f"{path}: was changed after it was made."]


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
