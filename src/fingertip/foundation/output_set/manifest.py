"""Manifest of a set of files: what they are, and what they were made from."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from fingertip.foundation.errors import InputFileError
from fingertip.foundation.input_files import PARSED_LIMIT, RECORDING_LIMIT, find_unsafe_names, open_input, read_input

MANIFEST = "manifest.json"
_SHA256 = re.compile("[0-9a-f]{64}")


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


def read_manifest(folder: Path, below: Path | None = None) -> Manifest | None:
    """Read the manifest of a folder; None if it has none, or one that is not of this program.

    A set is the files of one folder: a manifest that names a file elsewhere is not of this program. `below` is the
    folder that the user has named, if that is another one above.
    """
    try:
        data = json.loads(read_input(folder / MANIFEST, PARSED_LIMIT, below=below or folder))
        manifest = Manifest(**{name: data[name] for name in ("fingertip", "kind", "design", "parameters", "files")})
        texts = (manifest.fingertip, manifest.kind, manifest.design, manifest.parameters)
        is_own = all(isinstance(text, str) for text in texts) and not find_unsafe_names(manifest.files)
        is_own &= all(_SHA256.fullmatch(digest) for digest in manifest.files.values())
    except (InputFileError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    return manifest if is_own else None


def hash_parameters(data: object) -> str:
    """Hash plain data, such as the parameters that a set was made from."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def hash_file(path: Path) -> str:
    """Hash the content of a file in a folder that may be a stranger's. Raises InputFileError."""
    with open_input(path, RECORDING_LIMIT, below=path.parent) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def has_hash(path: Path, *digests: str | None) -> bool:
    """Return whether a file is a regular one with one of these hashes."""
    try:
        return hash_file(path) in digests
    except InputFileError:
        return False
