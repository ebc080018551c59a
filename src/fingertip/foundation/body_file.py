"""Bodies that other programs have drawn: one closed body of a STEP or STL file, read once for each
version of the file.

A process of its own reads it, within limits of time and memory.
"""

from __future__ import annotations

import io
import os
import re
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation import extras
from fingertip.foundation.errors import InputFileError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.input_files import BODY_LIMIT, check_regular, read_input
from fingertip.foundation.numerics import Array
from fingertip.foundation.workers import call_within_limits

_TIME_S = 60.0
_MEMORY_BYTES = 4 * 2**30
_MIN_MM = 4.0
_MAX_MM = 120.0
"""Range of a body's length along an axis [mm]. A smaller one is drawn in inches or in metres."""
_MAX_TRIANGLES = 200_000
_DEFLECTION_MM = 0.005
"""Largest distance of a facet from the surface of a STEP file."""
_ANGLE_RAD = 0.3
"""Largest angle between neighbouring facets of a STEP file."""
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


@dataclass(frozen=True)
class Body:
    """Closed body; bodies of equal files are equal."""

    data: bytes = field(repr=False)
    """Content of the file."""
    vertices: Array = field(compare=False, repr=False)
    """Coordinates, shape (n, 3) [mm]."""
    triangles: NDArray[np.int64] = field(compare=False, repr=False)
    """Vertex indices, shape (m, 3), counter-clockwise seen from outside."""
    brep: bytes = field(compare=False, repr=False)
    """Exact solid in Open CASCADE's binary format; empty for an STL file."""


def read_body(path: Path) -> Body:
    """Read the body of a file that is no link. Raises InputFileError or MissingLibraryError."""
    check_regular(path, BODY_LIMIT, below=path.parent)
    status = path.stat()
    body = _read(path, (status.st_mtime_ns, status.st_size, status.st_ino))
    if isinstance(body, str):
        raise InputFileError(Issue(str(path), f"{body}."))

    return body


@lru_cache(8)
def _read(path: Path, _version: tuple[int, ...]) -> Body | str:
    """Read a body; or return why it cannot be used, with a remedy."""
    read = {".stl": _read_stl, ".step": _read_step, ".stp": _read_step}.get(path.suffix.lower())
    if read is None:
        return "is neither .step, .stp nor .stl; export one of these"
    if read is _read_step:
        extras.require("STEP", "OCP", alternative="give an STL file")

    data = read_input(path, BODY_LIMIT, below=path.parent)
    try:
        return Body(data, *call_within_limits(_TIME_S, _MEMORY_BYTES, read, data))
    except ValueError as error:
        return str(error)
    except MemoryError:
        return "takes too much memory; make it simpler"


def _read_stl(data: bytes) -> tuple[Array, NDArray[np.int64], bytes]:
    """Read vertices and triangles of a binary STL file, or of one of text. Raises ValueError."""
    from manifold3d import Error, Manifold, Mesh64  # noqa: PLC0415

    if len(data) == 84 + int.from_bytes(data[80:84], "little") * _RECORD.itemsize:
        corners = (
            np.frombuffer(data, _RECORD, offset=84)["corners"].astype(np.float64).reshape(-1, 3)
        )
    elif data.lstrip()[:5].lower() == b"solid":
        corners = np.array(_VERTEX.findall(data)).astype(np.float64).reshape(-1, 3)
    else:
        raise ValueError("is no whole STL file; export it again")

    count = len(corners) // 3
    if not 4 <= count <= _MAX_TRIANGLES or len(corners) % 3 or not np.isfinite(corners).all():
        raise ValueError(f"needs {count} triangles; make it a body of 4 to {_MAX_TRIANGLES}")

    longest = float(np.ptp(corners, axis=0).max())
    if not _MIN_MM <= longest <= _MAX_MM:
        raise ValueError(
            f"is {longest:.4g} mm long; export it in mm, {_MIN_MM:g} to {_MAX_MM:g} long"
        )

    mesh = Mesh64(corners, np.arange(len(corners), dtype=np.uint64).reshape(-1, 3))
    mesh.merge()
    solid = Manifold(mesh)

    if solid.status() != Error.NoError:
        raise ValueError(
            "is not closed, or not all its facets face outwards; repair it, or export a STEP file"
        )

    pieces = solid.decompose()
    bodies = sum(piece.volume() > 0.0 for piece in pieces)
    if bodies > 1:
        raise ValueError(f"holds {bodies} bodies; unite them to one")
    if len(pieces) > bodies:
        raise ValueError(
            "is inside out, or has a hollow without a mouth; turn it, or open the hollow"
        )

    united: Any = solid.to_mesh64()
    return np.asarray(united.vert_properties), np.asarray(united.tri_verts, dtype=np.int64), b""


def _read_step(data: bytes) -> tuple[Array, NDArray[np.int64], bytes]:
    """Read the one valid solid of a STEP file in mm, and divide its faces into triangles.

    Raises ValueError.
    """
    with temporary_folder() as folder:
        os.chdir(folder)  # Open CASCADE looks for settings in the current folder
        from OCP import BinTools, BRepMesh, StlAPI  # noqa: PLC0415

        Path("body.step").write_bytes(data)
        solid = _read_solid("body.step")
        exact = io.BytesIO()
        writer = StlAPI.StlAPI_Writer()
        BinTools.BinTools.Write_s(solid, exact)
        BRepMesh.BRepMesh_IncrementalMesh(solid, _DEFLECTION_MM, False, _ANGLE_RAD, False)
        writer.ASCIIMode = False
        writer.Write(solid, "body.stl")
        vertices, triangles, _ = _read_stl(Path("body.stl").read_bytes())
        os.chdir(os.sep)

    return vertices, triangles, exact.getvalue()


def _read_solid(path: str) -> Any:
    """Read the one solid of a STEP file. Raises ValueError."""
    from OCP import BRepCheck, IFSelect, STEPControl, TColStd, TopAbs, TopExp, TopTools  # noqa: PLC0415

    reader = STEPControl.STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect.IFSelect_RetDone:
        raise ValueError("is no whole STEP file; export it again")

    lengths, *other_units = (TColStd.TColStd_SequenceOfAsciiString() for _ in range(3))
    reader.FileUnits(lengths, *other_units)
    units = {lengths.Value(i).ToCString().lower() for i in range(1, lengths.Length() + 1)}

    if units != {"millimetre"}:
        raise ValueError(
            f"is drawn in {', '.join(sorted(units)) or 'an unknown unit'}; export it in mm"
        )

    reader.TransferRoots()
    solids = TopTools.TopTools_IndexedMapOfShape()
    shape = reader.OneShape()
    if not shape.IsNull():
        TopExp.TopExp.MapShapes_s(shape, TopAbs.TopAbs_SOLID, solids)

    count = solids.Extent()
    if not count:
        raise ValueError("holds no solid; make one of its surfaces or facets")
    if count > 1:
        raise ValueError(f"holds {count} solids; unite those of an assembly to one")
    if not BRepCheck.BRepCheck_Analyzer(solids.FindKey(1)).IsValid():
        raise ValueError(
            "has faces that cut each other or do not meet; repair it where it was drawn"
        )

    return solids.FindKey(1)
