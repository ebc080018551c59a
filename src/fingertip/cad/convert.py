"""Parts as objects of other libraries: cadquery solids, trimesh meshes, and plain arrays.

Use them in CQ-editor and Jupyter, or for analysis.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.parts import hardware, parts_by_name
from fingertip.design import Design
from fingertip.design.geometry.solids import Solid
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation import extras
from fingertip.foundation.errors import DesignError, Issue

if TYPE_CHECKING:
    import cadquery
    import trimesh


def part_solid(design: Design, name: str) -> cadquery.Solid:
    """Build a part as an exact `cadquery.Solid` [mm].

    Raises
    ------
    DesignError
        If the design has no part of this name.
    MissingLibraryError
        If cadquery, or a system library it needs, is missing.
    """
    solid = _find_solid(design, name)
    extras.require("part_solid", "cadquery")
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    return brep.BrepEvaluator().solid(solid)


def part_mesh(design: Design, name: str, tolerance_mm: float = 0.01) -> Mesh:
    """Build a part as a mesh: vertices (n, 3) [mm] and triangles (m, 3).

    Raises
    ------
    DesignError
        If the design has no part of this name.
    """
    return MeshEvaluator(tolerance_mm).mesh(_find_solid(design, name))


def part_trimesh(design: Design, name: str, tolerance_mm: float = 0.01) -> trimesh.Trimesh:
    """Build a part as a `trimesh.Trimesh` [mm].

    Raises
    ------
    DesignError
        If the design has no part of this name.
    MissingLibraryError
        If trimesh is not installed.
    """
    trimesh_module = extras.load("trimesh", "part_trimesh", alternative="use part_mesh")
    mesh = part_mesh(design, name, tolerance_mm)
    return trimesh_module.Trimesh(mesh.vertices, mesh.triangles, process=False)


def assembly(design: Design) -> cadquery.Assembly:
    """Build all parts of a design with the hardware in their places, as a `cadquery.Assembly` that Jupyter shows.

    Raises
    ------
    MissingLibraryError
        If cadquery, or a system library it needs, is missing.
    """
    extras.require("assembly", "cadquery")
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    evaluator, parts = brep.BrepEvaluator(), parts_by_name(design)
    placed = [(name, part.solid(design), part.colour) for name, part in parts.items()]
    placed += [(item.name, item.solid, item.colour) for item in hardware(design, list(parts))]
    return brep.assemble(design.name, [(name, evaluator.solid(solid), colour) for name, solid, colour in placed])


def _find_solid(design: Design, name: str) -> Solid:
    parts = parts_by_name(design)
    if name not in parts:
        raise DesignError(Issue("part", f"there is no {name!r}; {suggest_name(name, tuple(parts))}"))
    return parts[name].solid(design)
