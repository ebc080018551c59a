"""Digest of the program that shapes the parts: its sources, and the
versions of the libraries that compute them.
"""

from __future__ import annotations

import functools
import hashlib
from importlib import metadata
from pathlib import Path

from fingertip.foundation.output_set import fold_lines

_PACKAGE = Path(__file__).resolve().parents[1]
_FOLDERS = ("cad", "catalogues", "design", "foundation", "models", "pad")
"""Packages of fingertip whose code or tables shape a part, or write its files."""
_SUFFIXES = (".csv", ".json", ".py", ".toml")
_LIBRARIES = ("manifold3d", "numpy")


@functools.cache
def digest_program() -> str:
    """Compute the SHA-256 of all that can change the bytes of a
    part's STL and 3MF files, but for the design.
    """
    digest = hashlib.sha256()

    for library in _LIBRARIES:
        digest.update(f"{library} {metadata.version(library)}\n".encode())

    for path in _list_sources():
        content = hashlib.sha256(fold_lines(path.read_bytes())).hexdigest()
        digest.update(f"{path.relative_to(_PACKAGE).as_posix()} {content}\n".encode())

    return digest.hexdigest()


def _list_sources() -> list[Path]:
    found = (path for folder in _FOLDERS for path in (_PACKAGE / folder).rglob("*"))
    return sorted(
        path for path in found if path.suffix in _SUFFIXES and "__pycache__" not in path.parts
    )
