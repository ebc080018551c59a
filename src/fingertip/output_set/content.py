"""Content of a file that is to be written: its bytes, or the path of a finished file that is too large for memory."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

from fingertip.output_set.manifest import hash_file

Content = bytes | Path


def hash_content(content: Content) -> str:
    """Return the SHA-256 hash."""
    if isinstance(content, Path):
        return hash_file(content)
    return hashlib.sha256(content).hexdigest()


def write_content(content: Content, path: Path) -> None:
    """Write the content to a file."""
    if isinstance(content, Path):
        shutil.copyfile(content, path)
    else:
        path.write_bytes(content)


def equals_file(content: Content, path: Path) -> bool:
    """Return whether a file has this content."""
    if isinstance(content, Path):
        return hash_file(content) == hash_file(path)
    return path.stat().st_size == len(content) and path.read_bytes() == content
