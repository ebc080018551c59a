"""Manifest of a set of files: what they are, and what they were made from."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from fingertip.errors import InputFileError
from fingertip.input_files import OUTPUT_LIMIT, read_input

MANIFEST = "manifest.json"


@dataclass(frozen=True)
class Manifest:
    """Files of a set, and what they were made from."""

    fingertip: str
    """Version that wrote the set."""
    kind: str
    """Kind of set, such as "parts" or "board"."""
    design: str
    """Name of the design."""
    parameters: str
    """Hash of the parameters that the files depend on."""
    files: Mapping[str, str]
    """Name of each file -> SHA-256 hash."""

    def to_bytes(self) -> bytes:
        """Content of the file."""
        return (json.dumps(asdict(self) | {"files": dict(sorted(self.files.items()))}, indent=2) + "\n").encode()


def read_manifest(folder: Path) -> Manifest | None:
    """Read the manifest of a folder; None if it has none, or one that is not of this program."""
    try:
        data = json.loads(read_input(folder / MANIFEST, OUTPUT_LIMIT, "a manifest"))
        manifest = Manifest(**{name: data[name] for name in ("fingertip", "kind", "design", "parameters", "files")})
        # A set is the files of one folder: a manifest that names a file elsewhere is not of this program.
        is_own = all(_is_file_name(name) and isinstance(digest, str) for name, digest in manifest.files.items())
    except (InputFileError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    return manifest if is_own else None


def _is_file_name(name: str) -> bool:
    return name == os.path.basename(name) and name not in ("", ".", "..") and "\0" not in name


def hash_parameters(data: object) -> str:
    """Hash plain data, such as the parameters that a set was made from."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def hash_file(path: Path) -> str:
    """Hash the content of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
