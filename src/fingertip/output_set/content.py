"""Content of a file that is to be written: its bytes, or the path of a finished file that is too large for memory."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

Content = bytes | Path


def hash_content(content: Content) -> str:
    """Return the SHA-256 hash."""
    if isinstance(content, Path):
        with content.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    return hashlib.sha256(content).hexdigest()


def write_content(content: Content, path: Path) -> None:
    """Write the content to a file."""
    if isinstance(content, Path):
        shutil.copyfile(content, path)
    else:
        path.write_bytes(content)
