"""Boundary-representation (B-rep) kernel: evaluates solids exactly with Open CASCADE.

A B-rep describes a solid by its faces, each a piece of an exact surface, and by the edges where they meet; STEP files
hold the same description. Superconic bodies become rational Bezier faces, sewn into a solid. All other faces are
planes, cylinders, cones and tori. Lofts and fillets are not used, because the kernel sometimes returns wrong solids for
them without an error.

Only this module, `kernel.occ`, `cad.files.step_writer` and `drawing.hidden_lines` import Open CASCADE's bindings (OCP)
at the top. Import them only where exact solids are needed, and this module first. cadquery and build123d stand on the
same bindings: `cadquery.Solid` takes a shape as it is.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from fingertip.design.geometry.conic import ConicBody, CrossSection
from fingertip.design.geometry.profile import Span
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    Difference,
    DraftedExtrusion,
    ElbowTube,
    Intersection,
    Placed,
    Point3,
    Prism,
    Scaled,
    Solid,
    SuperconicSolid,
    Union,
    axis_point,
)
from fingertip.foundation import extras
from fingertip.foundation.errors import GeometryError, Issue, MissingLibraryError

try:
    from OCP.BinTools import BinTools
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakePolygon,
        BRepBuilderAPI_Sewing,
    )
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeRevol
    from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
    from OCP.gp import gp_Ax1, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.GProp import GProp_GProps
    from OCP.ShapeFix import ShapeFix_Solid
    from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID, TopAbs_VERTEX, TopAbs_WIRE
    from OCP.TopoDS import TopoDS, TopoDS_Shape
    from OCP.TopTools import TopTools_IndexedMapOfShape

    from fingertip.cad.kernel import occ
except ImportError as error:
    extras.require("STEP", "OCP", alternative="leave STEP out with --formats stl,3mf")
    message = (
        f"Open CASCADE cannot be loaded ({error}); on Debian or Ubuntu: apt-get install libgl1 libx11-6 libexpat1, or "
        "leave STEP out with --formats stl,3mf."
    )
    raise MissingLibraryError(Issue("STEP", message)) from error

ControlPoint = tuple[float, float, float]
"""Control point of a plane rational Bezier curve: (x, y, weight)."""
_SEWING_MM = 1e-6
"""Distance within which edges of neighbouring faces are sewn together [mm]."""


class BrepEvaluator:
    """Evaluates solids as exact shapes; equal solids are evaluated once."""

    def __init__(self) -> None:
        self._evaluated: dict[Solid, TopoDS_Shape] = {}

    def shape(self, solid: Solid) -> TopoDS_Shape:
        if solid not in self._evaluated:
            self._evaluated[solid] = self._evaluate(solid)
        return self._evaluated[solid]

    def solid(self, solid: Solid) -> TopoDS_Shape:
        """Evaluate a solid as one valid solid. Raises GeometryError."""
        shape = self.shape(solid)
        bodies, is_valid = occ.list_shapes(shape, TopAbs_SOLID), BRepCheck_Analyzer(shape).IsValid()
        if len(bodies) != 1 or not is_valid:
            found = f"{len(bodies)} solids, {'valid' if is_valid else 'invalid'}"
            message = f"the B-rep kernel returned {found}; one valid solid was expected; use --formats stl,3mf."
            raise GeometryError(Issue("", message))
        return bodies[0]

    def _evaluate(self, solid: Solid) -> TopoDS_Shape:
        match solid:
            case Union(solids):
                return occ.fuse(*(self.shape(s) for s in solids))
            case Intersection(solids):
                first, *others = (self.shape(s) for s in solids)
                for other in others:
                    first = occ.intersect(first, other)
                return first
            case Difference(first, subtracted):
                return occ.cut(self.shape(first), *(self.shape(s) for s in subtracted))
            case Scaled(inner, factor):
                scaling = gp_Trsf()
                scaling.SetScale(gp_Pnt(), factor)
                return occ.transform(self.shape(inner), scaling)
            case Placed(inner, turns, shift):
                turn, move = gp_Trsf(), gp_Trsf()
                turn.SetRotation(_axis((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), turns * math.pi / 2)
                move.SetTranslation(gp_Vec(*shift))
                return occ.transform(occ.transform(self.shape(inner), turn), move)
            case Box(low, high):
                return occ.make_box(low, high)
            case Cone():
                return _cone(solid)
            case Prism():
                return _prism(solid)
            case ElbowTube():
                return _elbow(solid)
            case SuperconicSolid(body):
                return _superconic(body)
            case DraftedExtrusion():
                return _drafted_extrusion(solid)


def volume(shape: TopoDS_Shape) -> float:
    """Compute the volume [mm3] of a shape by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259 mm3. There the
    kernel's plain quadrature (cadquery's `Volume()`) is off by 0.3 mm3, and its adaptive Gauss quadrature with a stated
    tolerance of 1e-6 by 11 mm3.
    """
    properties = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(shape, properties, 1e-6, False, True, False, False, False)
    return float(properties.Mass())


def genus(solid: TopoDS_Shape) -> int:
    """Count the through holes G of a solid by the Euler-Poincare formula V - E + F - (L - F) = 2 (1 - G).

    V, E, F and L are the numbers of vertices, edges, faces and loops (edge cycles that bound faces). Cycles that touch
    in a vertex, such as a bore tangent to the seam between two faces, bound a simply connected face and count as one.
    Degenerate edges, which have no length and occur at the tip's apex, are not counted.
    """
    edges = [TopoDS.Edge_s(edge) for edge in occ.list_shapes(solid, TopAbs_EDGE)]
    real_edges = sum(not BRep_Tool.Degenerated_s(edge) for edge in edges)
    faces = occ.list_shapes(solid, TopAbs_FACE)
    loops = sum(_count_loops(face) for face in faces)
    return 1 - (len(occ.list_shapes(solid, TopAbs_VERTEX)) - real_edges + 2 * len(faces) - loops) // 2


def _count_loops(face: TopoDS_Shape) -> int:
    """Count the connected pieces of a face's boundary."""
    numbers = TopTools_IndexedMapOfShape()
    pieces: list[set[int]] = []
    for wire in occ.list_shapes(face, TopAbs_WIRE):
        vertices = {numbers.Add(vertex) for vertex in occ.list_shapes(wire, TopAbs_VERTEX)}
        touched = [piece for piece in pieces if piece & vertices]
        pieces = [piece for piece in pieces if piece not in touched] + [vertices.union(*touched)]
    return len(pieces)


def save(shape: TopoDS_Shape, path: Path) -> None:
    """Write a shape to a file in Open CASCADE's binary format, without loss."""
    BinTools.Write_s(shape, str(path))


def load(path: Path) -> TopoDS_Shape:
    shape = TopoDS_Shape()
    BinTools.Read_s(shape, str(path))
    return shape


def _axis(origin: Point3, direction: Point3) -> gp_Ax1:
    return gp_Ax1(gp_Pnt(*origin), gp_Dir(*direction))


def _cone(c: Cone) -> TopoDS_Shape:
    base = occ.axes(axis_point(c.axis, *c.centre, c.low), axis_point(c.axis, 0.0, 0.0, 1.0))
    height = c.high - c.low
    if c.low_radius == c.high_radius:  # MakeCone rejects equal radii
        return BRepPrimAPI_MakeCylinder(base, c.low_radius, height).Shape()
    return BRepPrimAPI_MakeCone(base, c.low_radius, c.high_radius, height).Shape()


def _prism(p: Prism) -> TopoDS_Shape:
    outline, *holes = (_polygon([axis_point(p.axis, u, v, p.low) for u, v in ring]) for ring in (p.corners, *p.holes))
    return occ.extrude(occ.make_face(outline, holes), axis_point(p.axis, 0.0, 0.0, p.high - p.low))


def _polygon(corners: list[Point3]) -> Any:
    builder = BRepBuilderAPI_MakePolygon()
    for corner in corners:
        builder.Add(gp_Pnt(*corner))
    builder.Close()
    return builder.Wire()


def _elbow(e: ElbowTube) -> TopoDS_Shape:
    turn_y, turn_z = e.start_y + e.bend_radius, e.exit_z + e.bend_radius
    start, down = occ.axes((0.0, e.start_y, e.start_z), (0.0, 0.0, -1.0)), e.start_z - e.exit_z - e.bend_radius
    circle = gp_Circ(occ.axes((0.0, e.start_y, turn_z), (0.0, 0.0, -1.0)), e.radius)
    section = occ.make_face(occ.make_wire([BRepBuilderAPI_MakeEdge(circle).Edge()]))
    axis = _axis((-1.0, turn_y, turn_z), (1.0, 0.0, 0.0))
    return occ.fuse(
        BRepPrimAPI_MakeCylinder(start, e.radius, down).Shape(),
        BRepPrimAPI_MakeRevol(section, axis, math.pi / 2, True).Shape(),
        BRepPrimAPI_MakeCylinder(
            occ.axes((0.0, turn_y, e.exit_z), (0.0, 1.0, 0.0)), e.radius, e.end_y - turn_y
        ).Shape(),
    )


def _superconic(body: ConicBody) -> TopoDS_Shape:
    """Sew a superconic body from four faces for each span and flat end faces."""
    faces = [_patch(quadrant, span) for quadrant in _quadrants(body.section) for span in body.spans]
    first, last = body.spans[0], body.spans[-1]
    ends = [(first.z[0], first.scale[0], first.palmar[0])]
    if body.tip is None:
        ends.append((last.z[2], last.scale[2], last.palmar[2]))
    faces += [_end(body.section, *end) for end in ends]
    sewing = BRepBuilderAPI_Sewing(_SEWING_MM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shell = TopoDS.Shell_s(sewing.SewedShape())
    solid = ShapeFix_Solid().SolidFromShell(shell)
    # The shell may have been sewn with its faces pointing inwards.
    return solid if volume(solid) > 0 else ShapeFix_Solid().SolidFromShell(TopoDS.Shell_s(shell.Reversed()))


def _drafted_extrusion(extrusion: DraftedExtrusion) -> TopoDS_Shape:
    """Extrude the outline of a drafted section: four arcs and the straight walls between them."""
    section, half_width = extrusion.section.section, extrusion.section.half_width
    edges = []
    for side, start, height, weight in (
        (1.0, extrusion.section.dorsal_start, section.dorsal, section.dorsal_weight),
        (-1.0, extrusion.section.palmar_start, section.palmar, section.palmar_weight),
    ):
        arc = _split_arc(section.half_width, height, weight, start)
        for mirror in (1.0, -1.0):
            row = [(mirror * x, side * y, w) for x, y, w in arc]
            wall = [gp_Pnt(mirror * half_width, 0.0, extrusion.low), gp_Pnt(row[0][0], row[0][1], extrusion.low)]
            edges += [BRepBuilderAPI_MakeEdge(*wall).Edge(), _arc(row, extrusion.low)]
    # Arrange the eight edges counter-clockwise, from the right side on (d dorsal, p palmar).
    (right_d, d_right, left_d, d_left, right_p, p_right, left_p, p_left) = edges
    outline = occ.make_wire([right_d, d_right, d_left, left_d, left_p, p_left, p_right, right_p])
    return occ.extrude(occ.make_face(outline), (0.0, 0.0, extrusion.high - extrusion.low))


def _split_arc(a: float, b: float, weight: float, start: float) -> list[ControlPoint]:
    """Compute the control points (x, y, weight) of the part of an arc from parameter `start` to its end.

    De Casteljau's algorithm in homogeneous coordinates (G. Farin, Curves and Surfaces for CAGD). The whole arc runs
    from (`a`, 0) over the control point (`a`, `b`) with `weight` to (0, `b`).
    """
    first, middle, last = ((a, 0.0, 1.0), (weight * a, weight * b, weight), (0.0, b, 1.0))

    def between(p: ControlPoint, q: ControlPoint) -> ControlPoint:
        return (p[0] + start * (q[0] - p[0]), p[1] + start * (q[1] - p[1]), p[2] + start * (q[2] - p[2]))

    later = between(middle, last)
    controls = (between(between(first, middle), later), later, last)
    return [(x / w, y / w, w) for x, y, w in controls]


def _quadrants(section: CrossSection) -> list[tuple[ControlPoint, ...]]:
    """List the control points (x, y, weight) of the section's four arcs, counter-clockwise."""
    a, dorsal, palmar = section.half_width, section.dorsal, section.palmar
    wd, wp = section.dorsal_weight, section.palmar_weight
    return [
        ((a, 0, 1), (a, dorsal, wd), (0, dorsal, 1)),
        ((0, dorsal, 1), (-a, dorsal, wd), (-a, 0, 1)),
        ((-a, 0, 1), (-a, -palmar, wp), (0, -palmar, 1)),
        ((0, -palmar, 1), (a, -palmar, wp), (a, 0, 1)),
    ]


def _patch(quadrant: Any, span: Span) -> Any:
    """Create a rational Bezier face: the tensor product of a section arc with a span; straight ones have two rows."""
    rows = [*zip(span.z, span.scale, span.palmar, (1.0, span.weight, 1.0), strict=True)]
    rows = rows[::2] if span.is_straight else rows
    poles = TColgp_Array2OfPnt(1, len(quadrant), 1, len(rows))
    weights = TColStd_Array2OfReal(1, len(quadrant), 1, len(rows))
    for i, (x, y, w) in enumerate(quadrant, 1):
        for j, (z, scale, palmar, v) in enumerate(rows, 1):
            poles.SetValue(i, j, gp_Pnt(x * scale, y * (palmar if y < 0 else scale), z))
            weights.SetValue(i, j, w * v)
    return BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, weights), _SEWING_MM).Face()


def _end(section: CrossSection, z: float, scale: float, palmar: float) -> Any:
    """Create the flat end face at height `z` [mm], bounded by the section's four arcs."""
    edges = [
        _arc([(x * scale, y * (palmar if y < 0 else scale), w) for x, y, w in quadrant], z)
        for quadrant in _quadrants(section)
    ]
    return occ.make_face(occ.make_wire(edges))


def _arc(row: Any, z: float) -> Any:
    """Create an edge in the plane at height `z` [mm] from control points (x, y, weight)."""
    poles, weights = TColgp_Array1OfPnt(1, len(row)), TColStd_Array1OfReal(1, len(row))
    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)
    return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge()
