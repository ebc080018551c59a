"""Checks of a single part: topology of its mesh file, and agreement of its B-rep solid with the mesh."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import Mesh, find_degenerate_triangles, to_manifold
from fingertip.cad.shapes.parts import Part
from fingertip.cad.verification.check import Check
from fingertip.design import Design


def check_mesh_file(design: Design, part: Part, mesh: Mesh, file_format: str) -> Iterator[Check]:
    """Check the topology of a part as read back from its file.

    It must be closed, without degenerate triangles, oriented outwards, a single body, and of the expected genus.
    """
    prefix = f"{part.name}.{file_format}"
    yield Check(f"{prefix}.open_edges", count_open_edges(mesh), 0, "edges", "exactly")
    yield Check(f"{prefix}.degenerate_triangles", count_degenerate_triangles(mesh), 0, "triangles", "exactly")
    yield Check(f"{prefix}.inverted", float(mesh.volume() <= 0.0), 0, "", "exactly")
    solid = to_manifold(mesh.vertices, mesh.triangles)
    yield Check(f"{prefix}.bodies", len(solid.decompose()), 1, "bodies", "exactly")
    yield Check(f"{prefix}.genus", solid.genus(), part.genus(design), "through holes", "exactly")


def check_brep_solid(
    design: Design, part: Part, mesh: Mesh, measured: BrepMeasurements, scale: float, tolerance_mm: float
) -> Iterator[Check]:
    """Check the genus of a B-rep solid, and its volume against the mesh.

    The volumes may differ by the tolerance times the surface area. The process that makes the solid has verified that
    it is a single valid one.

    Parameters
    ----------
    design
        The fingertip.
    part
        The part.
    mesh
        The part's mesh, with the printer's compensation.
    measured
        Volume and genus of the B-rep solid.
    scale
        Scale of the mesh relative to the B-rep solid.
    tolerance_mm
        Tolerance of the mesh [mm].
    """
    yield Check(f"{part.name}.step.genus", measured.genus, part.genus(design), "through holes", "exactly")
    difference = abs(mesh.volume() - measured.volume_mm3 * scale**3)
    yield Check(f"{part.name}.step.volume_difference_to_mesh", difference, tolerance_mm * mesh.area(), "mm3")


def count_degenerate_triangles(mesh: Mesh) -> int:
    """Count triangles without area, as a vertex on an edge leaves them.

    Many programs drop such triangles when they read a file, which leaves a hole in the surface.
    """
    return len(find_degenerate_triangles(mesh.vertices, mesh.triangles))


def count_open_edges(mesh: Mesh) -> int:
    """Count directed edges that are not matched by exactly one edge in the opposite direction."""
    forward = np.concatenate([mesh.triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    size = len(mesh.vertices)
    ordered = np.sort(forward[:, 0] * size + forward[:, 1])
    backward = np.sort(forward[:, 1] * size + forward[:, 0])
    if np.array_equal(ordered, backward) and bool((np.diff(ordered) > 0).all()):
        return 0  # the usual case, in which the slower count below is not needed
    keys, counts = np.unique(ordered, return_counts=True)
    matched = np.isin(keys, backward) & (counts == 1)
    return int(len(keys) - matched.sum())
