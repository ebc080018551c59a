"""Formats of a part's files: their endings, and the modules that write and read meshes.

A module is imported when its format is written, so that help pages list the formats without numpy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from fingertip.cad.kernel.mesh import Mesh


class MeshFormat(Protocol):
    """Module that writes a mesh as the bytes of a file, and reads them."""

    def to_bytes(self, mesh: Mesh, name: str, note: str = "") -> bytes: ...

    def from_bytes(self, data: bytes) -> Mesh: ...


@dataclass(frozen=True)
class PartFormat:
    suffix: str
    load: Callable[[], MeshFormat] | None = None
    """Function that imports the module of a format of meshes; None for a format of solids."""
    is_default: bool = True
    """False if it is written only where it is named."""


def load_stl() -> MeshFormat:
    from fingertip.cad.files import stl  # noqa: PLC0415

    return stl


def load_3mf() -> MeshFormat:
    from fingertip.cad.files import threemf  # noqa: PLC0415

    return threemf


PART_FORMATS = {
    "stl": PartFormat(".stl", load_stl),
    "3mf": PartFormat(".3mf", load_3mf),
    "step": PartFormat(".step"),
    "cq": PartFormat(".cq.py", is_default=False),
}
"""Formats of a part's files, by the name that `--formats` takes."""


def part_file(part: str, file_format: str) -> str:
    return f"{part}{PART_FORMATS[file_format].suffix}"


def default_formats() -> tuple[str, ...]:
    """List the formats that a build writes unless others are named."""
    return tuple(name for name, part_format in PART_FORMATS.items() if part_format.is_default)
