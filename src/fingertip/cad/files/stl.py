"""Binary STL files: writing, and reading with equal vertices merged."""

from __future__ import annotations

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, join_equal
from fingertip.foundation.errors import GeometryError, Issue

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def to_bytes(mesh: Mesh, name: str, note: str = "") -> bytes:
    """Write a mesh as binary STL in mm; the header names the part, with a note, and
    holds no date.
    """
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt((normal * normal).sum(axis=1, keepdims=True))
    records = np.zeros(len(corners), dtype=_RECORD)
    records["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0) + 0.0
    records["corners"] = corners
    text = f"fingertip {name}, unit mm" + (f", {note}" if note else "")
    header = text.encode("ascii")[:80].ljust(80, b" ")  # must not begin with "solid"

    return header + len(records).to_bytes(4, "little") + records.tobytes()


def from_bytes(data: bytes) -> Mesh:
    """Read a binary STL file; equal corners become one vertex. Raises GeometryError."""
    count = int(np.frombuffer(data[80:84], "<u4")[0]) if len(data) >= 84 else -1
    if len(data) != 84 + count * _RECORD.itemsize:
        raise GeometryError(
            Issue("STL", f"file of {len(data)} bytes does not match its triangle count of {count}.")
        )

    corners = np.frombuffer(data, _RECORD, offset=84)["corners"].astype(np.float64).reshape(-1, 3)
    vertices, index = join_equal(corners)
    return Mesh(vertices, index.reshape(-1, 3))
