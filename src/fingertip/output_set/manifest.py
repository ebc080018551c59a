"""Manifest of a set of files: what they are, and what they were made from."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

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
        data = json.loads((folder / MANIFEST).read_bytes())
        manifest = Manifest(**{name: data[name] for name in ("fingertip", "kind", "design", "parameters", "files")})
        # A set is the files of one folder: a manifest that names a file elsewhere is not of this program.
        is_own = all(name == os.path.basename(name) for name in manifest.files)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return manifest if is_own else None


def hash_parameters(data: object) -> str:
    """Hash plain data, such as the parameters that a set was made from."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def hash_file(path: Path) -> str:
    """Hash the content of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
