"""A part in other people's types: a cadquery solid for CQ-editor and Jupyter, a trimesh mesh for analysis."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Evaluator, Mesh
from fingertip.cad.shapes.parts import parts_of
from fingertip.cad.solids import Solid
from fingertip.design import Design
from fingertip.design.issues import nearest
from fingertip.errors import DesignError, Issue

if TYPE_CHECKING:
    import cadquery
    import trimesh


def part_solid(design: Design, name: str) -> cadquery.Solid:
    """A part as an exact cadquery solid [mm].

    Raises
    ------
    DesignError
        If there is no such part.
    MissingLibraryError
        If cadquery, or a library of the system it needs, is not there.
    """
    expression = _expression(design, name)
    from fingertip.cad.kernel import brep

    return brep.Evaluator().solid(expression)


def part_mesh(design: Design, name: str, tolerance_mm: float = 0.01) -> Mesh:
    """A part as arrays: vertices (n, 3) [mm] and triangles (m, 3).

    Raises
    ------
    DesignError
        If there is no such part.
    """
    return Evaluator(tolerance_mm).mesh(_expression(design, name))


def part_trimesh(design: Design, name: str, tolerance_mm: float = 0.01) -> trimesh.Trimesh:
    """A part as a `trimesh.Trimesh` [mm].

    Raises
    ------
    DesignError
        If there is no such part.
    """
    mesh = part_mesh(design, name, tolerance_mm)
    import trimesh

    return trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)


def _expression(design: Design, name: str) -> Solid:
    parts = parts_of(design)
    if name not in parts:
        raise DesignError(Issue("part", f"there is no {name!r}; {nearest(name, tuple(parts))}"))
    return parts[name].describe(design)
