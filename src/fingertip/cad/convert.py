"""Parts as objects of other libraries: cadquery solids, trimesh meshes, and plain arrays.

Use them in CQ-editor and Jupyter, or for analysis.
"""

from __future__ import annotations

import importlib
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fingertip.cad.kernel.mesh import (
    Mesh,
    MeshEvaluator,
    join_equal,
    to_canonical_mesh,
    to_manifold,
)
from fingertip.design import Design
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation import extras
from fingertip.foundation.errors import ArgumentError, DesignError, Issue
from fingertip.models.frames import find_frames
from fingertip.models.hardware import hardware
from fingertip.models.making import making_of
from fingertip.models.named_solids import find_solid
from fingertip.models.parts import parts_by_name
from fingertip.models.solids import Solid

if TYPE_CHECKING:
    import cadquery
    import trimesh


_ANGLE_RAD = 0.1
_DECIMALS = 6
"""Angle between neighbouring facets of cadquery's meshes, and
decimals [mm] to which their corners are joined.
"""
_KEPT = 32
"""Number of exact solids that are kept, and made once: a design has some ten."""


def part_solid(design: Design, name: str) -> cadquery.Solid:
    """Build a part, or a bought item such as "sensor", as an exact `cadquery.Solid` [mm]; equal
    ones are made once.

    Raises DesignError for another name, and MissingLibraryError without cadquery or a system
    library it needs.
    """
    cadquery = _load_cadquery("part_solid")
    return cadquery.Solid(_evaluate(_find_solid(design, name)))


class Mold(NamedTuple):
    """Two-part mold, and the core that is lowered into it, or the holder of the bone that is."""

    palmar: cadquery.Workplane
    dorsal: cadquery.Workplane
    core: cadquery.Workplane


def bone(design: Design) -> cadquery.Workplane:
    """Build the bone, with the cable channel and the sensor's pocket, as `part_workplane`."""
    return part_workplane(design, "bone")


def skin(design: Design) -> cadquery.Workplane:
    """Build the silicone skin as `part_workplane`."""
    return part_workplane(design, "skin")


def mold(design: Design) -> Mold:
    """Build the mold of the skin as `part_workplane`."""
    names = ("mold_palmar", "mold_dorsal", making_of(design).hanger)
    return Mold(*(part_workplane(design, name) for name in names))


def part_workplane(design: Design, name: str) -> cadquery.Workplane:
    """Build a part as a `cadquery.Workplane` with tagged faces, such as
    `bone.faces(tag="post").workplane()`.

    The tag "pad" is on the skin over the sensor, or on what shapes it; "pocket" on the floor that
    the sensor lies on; "flat" on the palmar flat of the bone; "channel" on the wall of the cable
    channel; "post" on the proximal end of the bone, or "cheek_left" and "cheek_right" on one face
    of each cheek of a clevis; "parting" on the parting plane of a mold half. A workplane in the
    middle of a face has `centerOption="CenterOfMass"`. Raises as `part_solid`.
    """
    made = part_solid(design, name)
    workplane = _load_cadquery("part_workplane").Workplane(made)
    numbers = _tag_faces(_find_solid(design, name), design, name)
    faces = made.Faces()
    for tag, tagged in numbers.items():
        workplane.newObject([faces[i] for i in tagged]).tag(tag)

    return workplane


@lru_cache(_KEPT)
def _evaluate(solid: Solid) -> Any:
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    return brep.BrepEvaluator().solid(solid)


@lru_cache(_KEPT)
def _tag_faces(solid: Solid, design: Design, name: str) -> dict[str, list[int]]:
    """Find the faces of each tag, by their numbers in the solid."""
    cadquery = _load_cadquery("part_workplane")
    from fingertip.models.workplanes import find_tagged_faces  # noqa: PLC0415

    return find_tagged_faces(cadquery.Solid(_evaluate(solid)), design, name)


def frames(design: Design) -> dict[str, cadquery.Location]:
    """Locate the interface to the hand, the tip and the sensor, whose z
    axis points out of the pad and y to the tip.
    """
    cadquery = _load_cadquery("frames")
    across = (1.0, 0.0, 0.0)
    outward = {"sensor": (0.0, -1.0, 0.0)}

    return {
        name: cadquery.Location(cadquery.Plane(at, across, outward.get(name, (0.0, 0.0, 1.0))))
        for name, at in find_frames(design).items()
    }


def part_mesh(design: Design, name: str, tolerance_mm: float = 0.01) -> Mesh:
    """Build a part as a mesh: vertices (n, 3) [mm] and triangles (m, 3).

    Raises DesignError for another name.
    """
    return MeshEvaluator(tolerance_mm).mesh(_find_solid(design, name))


def mesh_of(shape: cadquery.Workplane | cadquery.Shape, tolerance_mm: float = 0.01) -> Mesh:
    """Mesh what was made with cadquery, such as a part with a nail, for the STL writer and the
    checks of files.

    Raises DesignError if the tolerance is out of bounds, and GeometryError if the mesh is not
    closed.
    """
    tolerance_mm = MeshEvaluator(tolerance_mm).tolerance_mm
    whole = getattr(shape, "val", lambda: shape)()

    if not hasattr(whole, "tessellate"):
        raise ArgumentError(
            Issue(
                "shape", f"is of type {type(shape).__name__}; give a cadquery Workplane or Shape."
            )
        )

    points, triangles = whole.tessellate(tolerance_mm, _ANGLE_RAD)
    joined, number = join_equal(np.round(np.array([each.toTuple() for each in points]), _DECIMALS))
    corners = number[np.array(triangles)]
    distinct = (corners != np.roll(corners, 1, axis=1)).all(axis=1)

    return to_canonical_mesh(to_manifold(joined, corners[distinct]))


def part_trimesh(design: Design, name: str, tolerance_mm: float = 0.01) -> trimesh.Trimesh:
    """Build a part as a `trimesh.Trimesh` [mm].

    Raises as `part_mesh`, and MissingLibraryError without trimesh.
    """
    trimesh_module = extras.load("trimesh", "part_trimesh", alternative="use part_mesh")
    mesh = part_mesh(design, name, tolerance_mm)
    return trimesh_module.Trimesh(mesh.vertices, mesh.triangles, process=False)


def assembly(design: Design) -> cadquery.Assembly:
    """Build all parts of a design with the hardware in their places, as a `cadquery.Assembly` that
    Jupyter shows.

    Raises MissingLibraryError as `part_solid`.
    """
    cadquery = _load_cadquery("assembly")
    parts = parts_by_name(design)
    placed = [(name, part.solid(design), part.colour) for name, part in parts.items()]
    placed += [(item.name, item.solid, item.colour) for item in hardware(design, list(parts))]
    whole = cadquery.Assembly(name=design.name)
    for name, solid, colour in placed:
        whole.add(cadquery.Solid(_evaluate(solid)), name=name, color=cadquery.Color(*colour))

    return whole


def _load_cadquery(field: str) -> Any:
    extras.require(field, "cadquery")
    from fingertip.cad.kernel import brep  # noqa: F401, PLC0415 # names a missing system library

    return importlib.import_module("cadquery")


def _find_solid(design: Design, name: str) -> Solid:
    parts = parts_by_name(design)
    known = (*parts, *(item.name for item in hardware(design, parts)))
    if name not in known:
        raise DesignError(Issue("name", f"there is no {name!r}; {suggest_name(name, known)}"))

    return find_solid(design, name)
