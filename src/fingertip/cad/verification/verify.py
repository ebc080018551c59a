"""Every check a design can be put to, on the bytes its files would have: what `build` writes and `check` does not."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fingertip.cad.files import stl, threemf
from fingertip.cad.kernel.mesh import Evaluator, Mesh
from fingertip.cad.shapes.parts import PARTS, print_scale
from fingertip.cad.solids import scaled
from fingertip.cad.verification import checks, measures
from fingertip.cad.verification.checks import Check
from fingertip.design import Design
from fingertip.errors import DesignError, Issue

MESH_FORMATS = {"stl": stl, "3mf": threemf}
FINEST_MM, COARSEST_MM = 0.0005, 1.0


@dataclass(frozen=True)
class Verified:
    """Parts as meshes, the files they make, and what was found in them."""

    meshes: Mapping[str, Mesh]
    contents: Mapping[str, bytes]
    """File name -> bytes, not written anywhere."""
    checks: tuple[Check, ...]


def verify(
    design: Design,
    parts: Iterable[str],
    formats: Iterable[str],
    evaluator: Evaluator,
    progress: Callable[[str], None] = lambda message: None,
) -> Verified:
    """Make the parts' mesh files in memory, read them back, and check them and the assembly they make.

    Parameters
    ----------
    design
        The fingertip.
    parts
        Names from `PARTS`.
    formats
        Any of "stl", "3mf"; others are ignored.
    evaluator
        The mesh kernel at the tolerance wanted; it keeps what it evaluates for whoever asks next.
    progress
        Called with a sentence at each part.

    Raises
    ------
    GeometryError
        If the mesh kernel refuses a solid.
    """
    kinds = [kind for kind in formats if kind in MESH_FORMATS]
    expressions = {name: PARTS[name].describe(design) for name in parts}
    meshes = {}
    for name, expression in expressions.items():
        meshes[name] = evaluator.mesh(scaled(expression, print_scale(design, PARTS[name])))
        progress(f"{name}: {len(meshes[name].triangles)} triangles, {meshes[name].volume() / 1000:.2f} cm3")
    contents = {
        f"{name}.{kind}": MESH_FORMATS[kind].to_bytes(mesh, name) for name, mesh in meshes.items() for kind in kinds
    }
    found = [check for file, data in contents.items() for check in _of_file(design, file, data)]
    found += checks.of_assembly(design, evaluator, expressions)
    found += measures.of_parts(design, evaluator, meshes)
    return Verified(meshes, contents, tuple(found))


def refuse_tolerance(tolerance_mm: float) -> None:
    """Raise a DesignError unless meshes can be made at this tolerance [mm]."""
    if not FINEST_MM <= tolerance_mm <= COARSEST_MM:
        bounds = f"choose {FINEST_MM:g} to {COARSEST_MM:g} mm; 0.01 is finer than a printer draws."
        raise DesignError(Issue("--tolerance-mm", f"{tolerance_mm:g} mm is out of bounds; {bounds}"))


def settled(value: float) -> float:
    """A figure as it is written down: the last bits of a sum differ between processors, six decimals do not."""
    return round(value, 6) + 0.0


def as_data(check: Check) -> dict[str, Any]:
    """A check as it stands in report.json."""
    return {
        "name": check.name,
        "value": settled(check.value),
        "limit": settled(check.limit),
        "unit": check.unit,
        "passed": check.passed,
    }


def _of_file(design: Design, file: str, data: bytes) -> Iterator[Check]:
    """Checks on the mesh a reader gets from the file, not on the one in memory."""
    name, kind = file.rsplit(".", 1)
    return checks.of_file(design, PARTS[name], MESH_FORMATS[kind].from_bytes(data), kind)
