"""Second opinion on files of meshes, by trimesh, which shares no code with this project."""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, to_manifold
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.printing import check_triangles
from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, InputFileError, Issue
from fingertip.foundation.input_files import BODY_LIMIT, read_input

_ROUNDING_MM, _PULL_MM = 1e-6, (1.0, 5.0)
"""Difference of bounds that counts as none, and ways by which the half of a mold is pulled off the other [mm]."""
_PARTNERS = {"mold_palmar": ("mold_dorsal", -1.0), "mold_dorsal": ("mold_palmar", 1.0)}
"""Name of a mold half -> that of the other, and the way along y by which it comes off."""


def second_opinions(contents: Mapping[str, bytes], meshes: Mapping[str, Mesh]) -> tuple[Check, ...]:
    """Read the STL and 3MF file of each part with trimesh. Raises GeometryError or MissingLibraryError."""
    files = ((f"{name}{suffix}", mesh) for name, mesh in meshes.items() for suffix in (".stl", ".3mf"))
    found = (_compare(file, _read(file, contents[file]), mesh) for file, mesh in files if file in contents)
    return tuple(itertools.chain(*found))


def check_file(path: Path) -> tuple[Check, ...]:
    """Check any mesh, and half of a mold beside its other half too. Raises InputFileError or MissingLibraryError."""
    data = read_input(path, BODY_LIMIT, "a mesh")
    read = _read(str(path), data)
    try:
        mesh = stl.from_bytes(data) if path.suffix.lower() == ".stl" else None
    except FingertipError:  # STL as text
        mesh = None
    mesh = mesh or Mesh(np.asarray(read.vertices, dtype=np.float64), np.asarray(read.faces, dtype=np.int64))
    return (*check_triangles("", mesh), *_compare("mesh", read, mesh), *_check_halves(path, mesh))


def _read(name: str, data: bytes) -> Any:
    trimesh = extras.load("trimesh", "check", alternative="leave --verify and meshes out")
    try:
        read = trimesh.load(io.BytesIO(data), file_type=name.rpartition(".")[2].lower(), force="mesh")
        if not len(read.faces):
            raise ValueError("it holds no triangles")
    except Exception as error:
        message = f"cannot be read as a mesh ({str(error) or type(error).__name__}); export it again, in mm."
        raise InputFileError(Issue(name, message)) from None
    return read


def _compare(name: str, read: Any, mesh: Mesh) -> Iterator[Check]:
    yield Check(f"{name}.trimesh.open", float(not read.is_watertight), 0, "", "exactly")
    yield Check(f"{name}.trimesh.winding", float(not read.is_winding_consistent), 0, "", "exactly")
    yield Check(f"{name}.trimesh.bodies", read.body_count, 1, "bodies", "exactly")
    yield Check.zero_volume(f"{name}.trimesh.volume_difference", abs(float(read.volume) - mesh.volume()))
    bounds = np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    yield Check(f"{name}.trimesh.bounds_difference", float(abs(read.bounds - bounds).max()), _ROUNDING_MM, "mm")


def _check_halves(path: Path, mesh: Mesh) -> Iterator[Check]:
    """Check that half of a mold does not overlap the other, nor on the way by which it comes off."""
    other, way = _PARTNERS.get(path.stem, ("", 0.0))
    partner = path.with_name(f"{other}{path.suffix}")
    if not other or not partner.is_file():
        return
    read = _read(str(partner), read_input(partner, BODY_LIMIT, "a mesh"))
    first, second = to_manifold(mesh.vertices, mesh.triangles), to_manifold(read.vertices, read.faces)
    moved = [float((first.translate((0.0, way * by, 0.0)) ^ second).volume()) for by in (0.0, *_PULL_MM)]
    yield Check.zero_volume(f"{other}.overlap", moved[0])
    yield Check.zero_volume(f"{other}.pull_overlap", max(moved[1:]))
