"""Second opinion on mesh files, by trimesh, which shares no code with this project."""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, to_manifold
from fingertip.cad.verification.check import Check
from fingertip.foundation import extras
from fingertip.foundation.errors import InputFileError, Issue

_READERS = {"3mf": ("lxml", "networkx")}
"""Packages beside trimesh that it needs to read a format."""
_ROUNDING_MM = 1e-6
"""Difference between two bounds that counts as none [mm]."""


def list_packages(formats: Iterable[str]) -> tuple[str, ...]:
    """List the packages that read meshes of these formats."""
    readers = itertools.chain.from_iterable(_READERS.get(name, ()) for name in formats)
    return ("trimesh", *readers)


def second_opinions(contents: Mapping[str, bytes], meshes: Mapping[str, Mesh]) -> tuple[Check, ...]:
    """Read the STL and 3MF file of each part with trimesh.

    Raises GeometryError or MissingLibraryError.
    """
    checks = list[Check]()
    for name, mesh in meshes.items():
        for file in (f"{name}.stl", f"{name}.3mf"):
            if file in contents:
                checks += compare_readings(file, read_mesh(file, contents[file]), mesh)

    return tuple(checks)


def read_mesh(name: str, data: bytes) -> Any:
    """Read a mesh file as a `trimesh.Trimesh`. Raises InputFileError or MissingLibraryError."""
    file_format = Path(name).suffix.lower().removeprefix(".")
    extras.require(name, *list_packages([file_format]), alternative="leave --verify and meshes out")
    trimesh = extras.load("trimesh", name)

    try:
        read = trimesh.load(io.BytesIO(data), file_type=file_format, force="mesh")
        if not len(read.faces):
            raise ValueError("it holds no triangles")
        if not np.isfinite(read.vertices).all():
            raise ValueError("it holds coordinates that are not finite")
    except Exception as error:
        message = (
            f"cannot be read as a mesh ({str(error) or type(error).__name__}); export it "
            "again, in mm."
        )
        raise InputFileError(Issue(name, message)) from None

    return read


def compare_readings(name: str, read: Any, mesh: Mesh) -> Iterator[Check]:
    """Check a mesh that trimesh has read, and compare it with the mesh that was written."""
    yield Check(
        name=f"{name}.trimesh.open",
        value=float(not read.is_watertight),
        limit=0,
        unit="",
        relation="exactly",
    )
    yield Check(
        name=f"{name}.trimesh.winding",
        value=float(not read.is_winding_consistent),
        limit=0,
        unit="",
        relation="exactly",
    )
    yield Check(
        name=f"{name}.trimesh.bodies",
        value=count_bodies(read),
        limit=1,
        unit="bodies",
        relation="exactly",
    )
    yield Check.zero_volume(
        f"{name}.trimesh.volume_difference", abs(float(read.volume) - mesh.volume())
    )

    bounds = np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    yield Check(
        f"{name}.trimesh.bounds_difference",
        float(abs(read.bounds - bounds).max()),
        _ROUNDING_MM,
        "mm",
    )


def count_bodies(read: Any) -> int:
    """Count the separate shells of a mesh. `body_count` of trimesh would need SciPy."""
    return len(to_manifold(read.vertices, read.faces).decompose())
