"""The checks of `cad.verify`, on a memory that outlives the design: a test compares the two check by check."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad import checks, measures, stl
from fingertip.cad.checks import Check
from fingertip.cad.mesh import Mesh
from fingertip.cad.parts import Part, parts_of, print_scale
from fingertip.cad.solids import scaled
from fingertip.design import Design
from fingertip.sweep.solids import RememberingEvaluator, digest


def checks_of(design: Design, evaluator: RememberingEvaluator) -> tuple[Check, ...]:
    """Every check of a design's parts, assembly and STL files, in the order of `cad.verify.verify`.

    Raises
    ------
    GeometryError
        If the mesh kernel refuses a solid.
    """
    parts = parts_of(design)
    expressions = {name: part.describe(design) for name, part in parts.items()}
    as_printed = {name: scaled(expressions[name], print_scale(design, part)) for name, part in parts.items()}
    meshes = {name: evaluator.mesh(solid) for name, solid in as_printed.items()}

    def of_file(part: Part) -> Iterator[Check]:
        """Remembered by the mesh and the holes it must have: nothing else is read."""
        key = digest("file", part.name, as_printed[part.name], part.genus(design))
        yield from evaluator.fact(key, lambda: tuple(_of_bytes(design, part, meshes[part.name])))

    found = [check for part in parts.values() for check in of_file(part)]
    found += checks.of_assembly(design, evaluator, expressions)
    found += measures.of_parts(design, evaluator, meshes)
    return tuple(found)


def _of_bytes(design: Design, part: Part, mesh: Mesh) -> Iterator[Check]:
    """On the mesh a reader would get from the file."""
    return checks.of_file(design, part, stl.from_bytes(stl.to_bytes(mesh, part.name)), "stl")
