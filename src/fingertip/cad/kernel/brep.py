"""Boundary-representation (B-rep) kernel: evaluates solids exactly with cadquery (Open CASCADE).

A B-rep describes a solid by its faces, each a piece of an exact surface, and by the edges where they meet; STEP files
hold the same description. Superconic bodies become rational Bezier faces, sewn into a solid. All other faces are
planes, cylinders, cones and tori. Lofts and fillets are not used, because the kernel sometimes returns wrong solids for
them without an error.

Only this module, `cad.files.step_writer` and `drawing.hidden_lines` import cadquery at the top. Import them only where
exact solids are needed.
"""

from __future__ import annotations

from collections.abc import Iterable
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
    import cadquery as cq
    from OCP.BinTools import BinTools
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.BRepGProp import BRepGProp
    from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
    from OCP.gp import gp_Pnt
    from OCP.GProp import GProp_GProps
    from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal
    from OCP.TopoDS import TopoDS_Shape
except ImportError as error:
    extras.require("STEP", "cadquery", alternative="leave STEP out with --formats stl,3mf")
    message = (
        f"cadquery cannot be loaded ({error}); on Debian or Ubuntu: apt-get install libgl1 libx11-6 libexpat1, or "
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
        self._evaluated: dict[Solid, Any] = {}

    def shape(self, solid: Solid) -> Any:
        """Evaluate a solid as a `cadquery.Shape`."""
        if solid not in self._evaluated:
            self._evaluated[solid] = self._evaluate(solid)
        return self._evaluated[solid]

    def solid(self, solid: Solid) -> cq.Solid:
        """Evaluate a solid as one valid `cadquery.Solid`. Raises GeometryError."""
        shape = self.shape(solid)
        bodies = shape.Solids()
        if len(bodies) != 1 or not shape.isValid():
            found = f"{len(bodies)} solids, {'valid' if shape.isValid() else 'invalid'}"
            message = f"the B-rep kernel returned {found}; one valid solid was expected; use --formats stl,3mf."
            raise GeometryError(Issue("", message))
        return bodies[0]

    def _evaluate(self, solid: Solid) -> Any:
        match solid:
            case Union(solids):
                first, *others = (self.shape(s) for s in solids)
                return first.fuse(*others)
            case Intersection(solids):
                first, *others = (self.shape(s) for s in solids)
                for other in others:
                    first = first.intersect(other)
                return first
            case Difference(first, subtracted):
                return self.shape(first).cut(*(self.shape(s) for s in subtracted))
            case Scaled(inner, factor):
                return self.shape(inner).scale(factor)
            case Placed(inner, turns, shift):
                turned = self.shape(inner).rotate(cq.Vector(), cq.Vector(1, 0, 0), 90.0 * turns)
                return turned.translate(cq.Vector(*shift))
            case Box(low, high):
                size = [b - a for a, b in zip(low, high, strict=True)]
                return cq.Solid.makeBox(*size, cq.Vector(*low))
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


def assemble(title: str, parts: Iterable[tuple[str, cq.Solid, tuple[float, float, float]]]) -> cq.Assembly:
    assembly = cq.Assembly(name=title)
    for name, solid, colour in parts:
        assembly.add(solid, name=name, color=cq.Color(*colour))
    return assembly


def volume(shape: Any) -> float:
    """Compute the volume [mm3] of a shape by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259 mm3. There the
    kernel's plain quadrature (`Shape.Volume()`) is off by 0.3 mm3, and its adaptive Gauss quadrature with a stated
    tolerance of 1e-6 by 11 mm3.
    """
    properties = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(shape.wrapped, properties, 1e-6, False, True, False, False, False)
    return float(properties.Mass())


def genus(solid: Any) -> int:
    """Count the through holes G of a solid by the Euler-Poincare formula V - E + F - (L - F) = 2 (1 - G).

    V, E, F and L are the numbers of vertices, edges, faces and loops (edge cycles that bound faces). Cycles that touch
    in a vertex, such as a bore tangent to the seam between two faces, bound a simply connected face and count as one.
    Degenerate edges, which have no length and occur at the tip's apex, are not counted.
    """
    edges = sum(not BRep_Tool.Degenerated_s(edge.wrapped) for edge in solid.Edges())
    faces = solid.Faces()
    loops = sum(_count_loops(face) for face in faces)
    return 1 - (len(solid.Vertices()) - edges + 2 * len(faces) - loops) // 2


def _count_loops(face: Any) -> int:
    """Count the connected pieces of a face's boundary."""
    pieces: list[set[Any]] = []
    for wire in face.Wires():
        vertices = set(wire.Vertices())
        touched = [piece for piece in pieces if piece & vertices]
        pieces = [piece for piece in pieces if piece not in touched] + [vertices.union(*touched)]
    return len(pieces)


def save(shape: Any, path: Path) -> None:
    """Write a shape to a file in Open CASCADE's binary format, without loss."""
    BinTools.Write_s(shape.wrapped, str(path))


def load(path: Path) -> Any:
    shape = TopoDS_Shape()
    BinTools.Read_s(shape, str(path))
    return cq.Shape.cast(shape)


def _cone(c: Cone) -> Any:
    origin, direction = cq.Vector(*axis_point(c.axis, *c.centre, c.low)), cq.Vector(*axis_point(c.axis, 0.0, 0.0, 1.0))
    height = c.high - c.low
    if c.low_radius == c.high_radius:  # makeCone rejects equal radii
        return cq.Solid.makeCylinder(c.low_radius, height, origin, direction)
    return cq.Solid.makeCone(c.low_radius, c.high_radius, height, origin, direction)


def _prism(p: Prism) -> Any:
    outline, *holes = (
        cq.Wire.makePolygon([cq.Vector(*axis_point(p.axis, u, v, p.low)) for u, v in ring], close=True)
        for ring in (p.corners, *p.holes)
    )
    return cq.Solid.extrudeLinear(outline, holes, cq.Vector(*axis_point(p.axis, 0.0, 0.0, p.high - p.low)))


def _elbow(e: ElbowTube) -> Any:
    down = cq.Solid.makeCylinder(
        e.radius, e.start_z - e.exit_z - e.bend_radius, cq.Vector(0, e.start_y, e.start_z), cq.Vector(0, 0, -1)
    )
    turn_y, turn_z = e.start_y + e.bend_radius, e.exit_z + e.bend_radius
    circle = cq.Wire.makeCircle(e.radius, cq.Vector(0, e.start_y, turn_z), cq.Vector(0, 0, -1))
    bend = cq.Solid.revolve(circle, [], 90, cq.Vector(-1, turn_y, turn_z), cq.Vector(1, turn_y, turn_z))
    if bend.Center().z > turn_z:  # revolved to the wrong side: reverse the axis
        bend = cq.Solid.revolve(circle, [], 90, cq.Vector(1, turn_y, turn_z), cq.Vector(-1, turn_y, turn_z))
    up = cq.Solid.makeCylinder(e.radius, e.end_y - turn_y, cq.Vector(0, turn_y, e.exit_z), cq.Vector(0, 1, 0))
    return down.fuse(bend, up)


def _superconic(body: ConicBody) -> Any:
    """Sew a superconic body from four faces for each span and flat end faces."""
    faces = [_patch(quadrant, span) for quadrant in _quadrants(body.section) for span in body.spans]
    first, last = body.spans[0], body.spans[-1]
    ends = [(first.z[0], first.scale[0], first.palmar[0])]
    if body.tip is None:
        ends.append((last.z[2], last.scale[2], last.palmar[2]))
    faces += [_end(body.section, *end) for end in ends]
    sewing = BRepBuilderAPI_Sewing(_SEWING_MM)
    for face in faces:
        sewing.Add(face.wrapped)
    sewing.Perform()
    shell = cq.Shape.cast(sewing.SewedShape())
    solid = cq.Solid.makeSolid(shell)
    # The shell may have been sewn with its faces pointing inwards.
    return solid if volume(solid) > 0 else cq.Solid.makeSolid(cq.Shape.cast(shell.wrapped.Reversed()))


def _drafted_extrusion(extrusion: DraftedExtrusion) -> Any:
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
            wall = [cq.Vector(mirror * half_width, 0.0, extrusion.low), cq.Vector(row[0][0], row[0][1], extrusion.low)]
            edges += [cq.Edge.makeLine(*wall), _arc(row, extrusion.low)]
    # Arrange the eight edges counter-clockwise, from the right side on (d dorsal, p palmar).
    (right_d, d_right, left_d, d_left, right_p, p_right, left_p, p_left) = edges
    outline = cq.Wire.assembleEdges([right_d, d_right, d_left, left_d, left_p, p_left, p_right, right_p])
    return cq.Solid.extrudeLinear(outline, [], cq.Vector(0.0, 0.0, extrusion.high - extrusion.low))


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
    return cq.Face(BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, weights), _SEWING_MM).Face())


def _end(section: CrossSection, z: float, scale: float, palmar: float) -> Any:
    """Create the flat end face at height `z` [mm], bounded by the section's four arcs."""
    edges = [
        _arc([(x * scale, y * (palmar if y < 0 else scale), w) for x, y, w in quadrant], z)
        for quadrant in _quadrants(section)
    ]
    return cq.Face.makeFromWires(cq.Wire.assembleEdges(edges))


def _arc(row: Any, z: float) -> Any:
    """Create an edge in the plane at height `z` [mm] from control points (x, y, weight)."""
    poles, weights = TColgp_Array1OfPnt(1, len(row)), TColStd_Array1OfReal(1, len(row))
    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)
    return cq.Edge(BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge())
