"""Parts as objects of other libraries: cadquery solids, trimesh meshes, and plain arrays.

Use them in CQ-editor and Jupyter, or for analysis.
"""

from __future__ import annotations

import contextlib
import importlib
from importlib import metadata
from typing import TYPE_CHECKING, Any

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.parts import find_frames, hardware, parts_by_name
from fingertip.design import Design
from fingertip.design.geometry.solids import Solid
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation import extras
from fingertip.foundation.errors import DesignError, Issue, MissingLibraryError
from fingertip.pad.pad_geometry import PadForm

if TYPE_CHECKING:
    import cadquery
    import trimesh


_ALONG, _NEAR_MM, _POCKET_MM = 0.999, 0.02, 0.3
"""Component of a normal along an axis, distance from a place, and depth of the pocket besides the sensor's."""


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
    cadquery = _load_cadquery("part_solid")
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    return cadquery.Solid(brep.BrepEvaluator().solid(solid))


def part_workplane(design: Design, name: str) -> cadquery.Workplane:
    """Build a part as a `cadquery.Workplane` with tagged faces, such as `bone.faces(tag="post").workplane()`.

    The tag "pad" is on the skin over the sensor, or on what shapes it; "pocket" on the floor that the sensor lies on;
    "post" on the proximal end of the bone, in several faces on a clevis; "parting" on the parting plane of a mold half.
    Raises as `part_solid`.
    """
    solid, cadquery = part_solid(design, name), _load_cadquery("part_workplane")
    workplane, form, dims = cadquery.Workplane(solid), PadForm.of_design(design), design.dimensions
    over_sensor = cadquery.Vertex.makeVertex(0.0, -form.platform_mm - form.over_sensor_mm, form.sensor_z_mm)
    tagged = {"pad": [face for face in solid.Faces() if face.distance(over_sensor) < _NEAR_MM]}
    level = [(face, face.normalAt(), face.Center()) for face in solid.Faces() if face.geomType() == "PLANE"]
    if name == "bone":
        base_z, least_y = solid.BoundingBox().zmin, -form.platform_mm
        tagged["post"] = [face for face, _, at in level if abs(at.z - base_z) < _NEAR_MM]
        # The floor is the deepest of the faces under the sensor's head that look out of the pad.
        under = [
            (face, at.y) for face, normal, at in level
            if normal.y < -_ALONG and abs(at.z - dims.sensor_z) < dims.sensor.head_diameter_mm / 2
            and at.y < least_y + dims.sensor.thickness_mm + _POCKET_MM
        ]  # fmt: skip
        tagged["pocket"] = [face for face, y in under if y > max(y for _, y in under) - _NEAR_MM]
    elif name.startswith("mold"):
        tagged["parting"] = [face for face, normal, at in level if abs(normal.y) > _ALONG and abs(at.y) < _NEAR_MM]
    for tag, faces in tagged.items():
        if faces:
            workplane.newObject(faces).tag(tag)
    return workplane


def frames(design: Design) -> dict[str, cadquery.Location]:
    """Locate the interface to the hand, the tip and the sensor, whose z axis points out of the pad and y to the tip."""
    cadquery = _load_cadquery("frames")
    across, outward = (1.0, 0.0, 0.0), {"sensor": (0.0, -1.0, 0.0)}
    return {
        name: cadquery.Location(cadquery.Plane(at, across, outward.get(name, (0.0, 0.0, 1.0))))
        for name, at in find_frames(design).items()
    }


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
    cadquery = _load_cadquery("assembly")
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    evaluator, parts = brep.BrepEvaluator(), parts_by_name(design)
    placed = [(name, part.solid(design), part.colour) for name, part in parts.items()]
    placed += [(item.name, item.solid, item.colour) for item in hardware(design, list(parts))]
    whole = cadquery.Assembly(name=design.name)
    for name, solid, colour in placed:
        whole.add(cadquery.Solid(evaluator.solid(solid)), name=name, color=cadquery.Color(*colour))
    return whole


def _load_cadquery(field: str) -> Any:
    """Import cadquery, whose build of OCP may have been replaced by that of the extra `step`, which lacks VTK."""
    extras.require(field, "cadquery")
    from fingertip.cad.kernel import brep  # noqa: F401, PLC0415 # names a missing system library

    try:
        return importlib.import_module("cadquery")
    except ImportError as error:
        message = f"cadquery cannot be loaded ({error})"
        with contextlib.suppress(metadata.PackageNotFoundError):
            remedy = f"--force-reinstall --no-deps cadquery-ocp=={metadata.version('cadquery-ocp')}"
            replacing = f"cadquery-ocp-novtk {metadata.version('cadquery-ocp-novtk')}"
            message += f": {replacing} has replaced its OCP; {extras.find_pip()} {remedy}"
        raise MissingLibraryError(Issue(field, f"{message}.")) from error


def _find_solid(design: Design, name: str) -> Solid:
    parts = parts_by_name(design)
    if name not in parts:
        raise DesignError(Issue("name", f"there is no {name!r}; {suggest_name(name, tuple(parts))}"))
    return parts[name].solid(design)
