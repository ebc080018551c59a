"""Solids as CadQuery workplanes: the one module that imports CadQuery, and Open CASCADE (OCP).

The program makes its STEP files of the same primitives, with Open CASCADE's own booleans.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import cadquery as cq
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepGProp import BRepGProp
from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Solid
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopoDS import TopoDS

from .cad_tags import list_tagged_planes, list_tagged_points
from .named_solids import UnknownPartError, find_solid
from .solids import (
    Box,
    Cone,
    Difference,
    ElbowTube,
    Intersection,
    Prism,
    Scaled,
    Shell,
    Solid,
    SuperconicSolid,
    Union,
)

if TYPE_CHECKING:
    from .program_types import Finger

SEWING_MM = 1e-6
"""Distance within which edges of neighbouring faces are sewn together [mm]."""
_NEAR_MM = 0.02
"""Distance of a face from the point by which it is tagged [mm]."""


def make_part(finger: Finger, name: str) -> cq.Workplane:
    """Make a part, or a bought item such as "sensor", with tagged faces, such as
    `make_part(finger, "bone").faces(tag="pocket")`.

    Raises ValueError where the finger has no such part, or its parameters give no solid.
    """
    try:
        part = to_workplane(find_solid(finger, name))
    except UnknownPartError:
        raise
    except Exception as error:
        message = (
            f"{name}: these parameters give no solid; `fingertip build` says which rule they "
            "break, and what repairs it."
        )
        raise ValueError(message) from error

    faces = part.val().Faces()
    for tag, numbers in find_tagged_faces(part.val(), finger, name).items():
        part.newObject([faces[i] for i in numbers]).tag(tag)

    return part


def find_tagged_faces(made: cq.Solid, finger: Finger, name: str) -> dict[str, list[int]]:
    """Find the faces of each tag, by their numbers in a part."""
    faces = list(enumerate(made.Faces()))
    tagged = {}

    for tag, points in list_tagged_points(finger, name).items():
        near = [cq.Vertex.makeVertex(*point) for point in points]
        tagged[tag] = [i for i, face in faces if min(map(face.distance, near)) < _NEAR_MM]

    for tag, selectors in list_tagged_planes(finger, name).items():
        found = cq.Workplane(made)
        for each in selectors:
            found = found.faces(each if isinstance(each, str) else in_plane(each))

        tagged[tag] = [i for i, face in faces if any(map(face.isSame, found.vals()))]

    return {tag: numbers for tag, numbers in tagged.items() if numbers}


def to_workplane(solid: Solid) -> cq.Workplane:
    """Make the CadQuery workplane of a solid; what occurs in it several times is made once."""
    made: dict[Solid, cq.Workplane] = {}

    def make(solid: Solid) -> cq.Workplane:
        if solid not in made:
            made[solid] = combine(solid)

        return made[solid]

    def combine(solid: Solid) -> cq.Workplane:
        match solid:
            case Union((first, *others)):
                return make(first).union(stack(*map(make, others)), clean=False)
            case Difference(first, tools):
                return make(first).cut(stack(*map(make, tools)), clean=False)
            case Intersection((first, *others)):
                part = make(first)
                for other in others:
                    part = part.intersect(make(other), clean=False)

                return part
            case Shell(outer, inside):
                return make(outer).cut(make(inside), clean=False)
            case Scaled(inner, factor):
                return cq.Workplane(make(inner).val().scale(factor))
            case _:
                return make_primitive(solid)

    return make(solid).solids()  # out of the compound that a boolean returns


def stack(*parts: cq.Workplane) -> cq.Workplane:
    """Put several parts on the stack of one workplane, so that a boolean takes them at once."""
    return cq.Workplane().newObject([part.val() for part in parts])


def make_primitive(solid: Solid) -> cq.Workplane:
    """Make the workplane of a solid without booleans."""
    match solid:
        case Box(low, high):
            return box(low, high)
        case Cone(axis, centre, low, high, low_radius, high_radius):
            return cone(axis, centre, low, high, (low_radius, high_radius))
        case Prism(axis, corners, low, high, holes):
            return prism(axis, corners, low, high, holes)
        case ElbowTube():
            return elbow_tube(solid)
        case SuperconicSolid(body):
            return superconic(body.section, body.spans)

    raise ValueError(f"{type(solid).__name__} has no workplane.")


def volume(shape: Any) -> float:
    """Compute the volume [mm3] of a shape by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259
    mm3. There the kernel's plain quadrature (cadquery's `Volume()`) is off by 0.3 mm3, and its
    adaptive Gauss quadrature with a stated tolerance of 1e-6 by 11 mm3.
    """
    properties = GProp_GProps()
    shape = getattr(shape, "wrapped", shape)
    BRepGProp.VolumePropertiesGK_s(shape, properties, 1e-6, False, True, False, False, False)

    return float(properties.Mass())


def bezier_face(quadrant: Any, span: Any) -> Any:
    """Make a rational Bezier face: the tensor product of an arc of the section with a span."""
    rows = list(zip(span.z, span.scale, span.palmar, (1.0, span.weight, 1.0), strict=True))
    rows = rows[::2] if span.is_straight else rows
    poles = TColgp_Array2OfPnt(1, len(quadrant), 1, len(rows))
    weights = TColStd_Array2OfReal(1, len(quadrant), 1, len(rows))

    for i, (x, y, w) in enumerate(quadrant, 1):
        for j, (z, scale, palmar_scale, v) in enumerate(rows, 1):
            poles.SetValue(i, j, gp_Pnt(x * scale, y * (palmar_scale if y < 0 else scale), z))
            weights.SetValue(i, j, w * v)

    return BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, weights), SEWING_MM).Face()


def bezier_edge(row: Sequence[tuple[float, float, float]], z: float) -> Any:
    """Make an edge in the plane at height z from control points (x, y, weight)."""
    poles = TColgp_Array1OfPnt(1, len(row))
    weights = TColStd_Array1OfReal(1, len(row))

    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)

    return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge()


def superconic(section: Sequence[float], spans: Any) -> cq.Workplane:
    """Sew four faces for each span along z, and flat ends where it has a width, from a section of
    four conic arcs.

    The section holds its half width, the heights of its palmar and dorsal half, and the weights of
    their arcs: 0.707 for an ellipse, more for a squarer one.
    """
    a, palmar, dorsal, palmar_weight, dorsal_weight = section
    quadrants = [  # counter-clockwise
        ((a, 0, 1), (a, dorsal, dorsal_weight), (0, dorsal, 1)),
        ((0, dorsal, 1), (-a, dorsal, dorsal_weight), (-a, 0, 1)),
        ((-a, 0, 1), (-a, -palmar, palmar_weight), (0, -palmar, 1)),
        ((0, -palmar, 1), (a, -palmar, palmar_weight), (a, 0, 1)),
    ]
    faces = [bezier_face(quadrant, span) for quadrant in quadrants for span in spans]

    for span, end in ((spans[0], 0), (spans[-1], 2)):
        z = span.z[end]
        scale = span.scale[end]
        palmar_scale = span.palmar[end]

        if scale:
            rows = [
                [(x * scale, y * (palmar_scale if y < 0 else scale), w) for x, y, w in arc]
                for arc in quadrants
            ]
            outline = cq.Wire.assembleEdges([cq.Edge(bezier_edge(row, z)) for row in rows])
            faces.append(cq.Face.makeFromWires(outline).wrapped)

    sewing = BRepBuilderAPI_Sewing(SEWING_MM)
    for face in faces:
        sewing.Add(face)

    sewing.Perform()
    shell = TopoDS.Shell_s(sewing.SewedShape())
    solid = ShapeFix_Solid().SolidFromShell(shell)
    # The shell may have been sewn with its faces pointing inwards.
    solid = (
        solid
        if volume(solid) > 0
        else ShapeFix_Solid().SolidFromShell(TopoDS.Shell_s(shell.Reversed()))
    )

    return cq.Workplane(cq.Solid(solid))


def point(axis: str, across: Sequence[float], along: float) -> cq.Vector:
    """Place a point by a number along an axis and two across it:
    (y, z) for x, (z, x) for y, (x, y) for z.
    """
    u, v = across
    return cq.Vector(*{"x": (along, u, v), "y": (v, along, u), "z": (u, v, along)}[axis])


def box(low: Sequence[float], high: Sequence[float]) -> cq.Workplane:
    """Make a box between two opposite corners (x, y, z)."""
    return cq.Workplane(
        cq.Solid.makeBox(*(b - a for a, b in zip(low, high, strict=True)), cq.Vector(*low))
    )


def cone(
    axis: str, centre: Sequence[float], low: float, high: float, radii: tuple[float, float]
) -> cq.Workplane:
    """Make the frustum of a cone with radii at `low` and `high`, or a cylinder."""
    base = point(axis, centre, low)
    direction = point(axis, (0.0, 0.0), 1.0)
    low_radius, high_radius = radii
    if low_radius == high_radius:  # the kernel's cones reject equal radii
        return cq.Workplane(cq.Solid.makeCylinder(low_radius, high - low, base, direction))

    return cq.Workplane(cq.Solid.makeCone(low_radius, high_radius, high - low, base, direction))


def prism(
    axis: str,
    corners: Any,
    low: float,
    high: float,
    holes: Any = (),
) -> cq.Workplane:
    """Extrude a polygon, with holes, along an axis; its corners are in the order of `point`."""
    rings = [[point(axis, corner, low) for corner in ring] for ring in (corners, *holes)]
    outline, *inner = (cq.Wire.makePolygon(ring, close=True) for ring in rings)
    return cq.Workplane(cq.Solid.extrudeLinear(outline, inner, point(axis, (0.0, 0.0), high - low)))


def elbow_tube(tube: ElbowTube) -> cq.Workplane:
    """Make a round tube with a bend."""
    turn_y = tube.start_y + tube.bend_radius
    turn_z = tube.exit_z + tube.bend_radius
    down = cq.Vector(0, 0, -1)
    start = cq.Vector(0, tube.start_y, tube.start_z)
    first = cq.Solid.makeCylinder(tube.radius, tube.start_z - turn_z, start, down)
    circle = cq.Wire.makeCircle(tube.radius, cq.Vector(0, tube.start_y, turn_z), down)
    bend = cq.Solid.revolve(
        circle, [], 90, cq.Vector(-1, turn_y, turn_z), cq.Vector(1, turn_y, turn_z)
    )
    turned = cq.Vector(0, turn_y, tube.exit_z)
    last = cq.Solid.makeCylinder(tube.radius, tube.end_y - turn_y, turned, cq.Vector(0, 1, 0))

    return cq.Workplane(first.fuse(bend, last))


def in_plane(y: float) -> cq.Selector:
    """Select the flat faces in the plane at a height y."""
    box_of_plane = cq.selectors.BoxSelector((-999, y - 0.01, -999), (999, y + 0.01, 999))
    return cq.selectors.ParallelDirSelector(cq.Vector(0, 1, 0)) & box_of_plane
