"""Projection of B-rep solids without hidden lines, and longitudinal sections, by Open CASCADE.

Importing this module loads Open CASCADE; import `cad.kernel.brep` first, which says what to install
where that fails.
"""

from __future__ import annotations

from typing import Any

from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepLib import BRepLib
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.GeomAbs import GeomAbs_Plane
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_Algo, HLRBRep_HLRToShape
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopoDS import TopoDS, TopoDS_Shape

from fingertip.cad.kernel import occ
from fingertip.design.geometry.sizes import ViewName
from fingertip.models.workplanes import box
from fingertip.pictures.drawing.primitives import PROJECTIONS, Line2, ProjectedView, Projection

DEFLECTION_MM = 0.002
"""Distance of a polyline from its curve on the part [mm]: at most 0.01 mm on paper at 5:1."""
_SMOOTH_RAD = 0.02
"""Angle between faces below which their common edge is smooth and not drawn [rad]."""
_ANGLE_RAD = 0.3
_DECIMALS = 4
"""Decimals of coordinates [mm]: their last bits must not reach the files."""
_IN_PLANE_MM = 1e-5


def project(solid: TopoDS_Shape, view: ViewName) -> ProjectedView:
    """Project a solid. The section removes the half at x < 0 first."""
    if view != "section":
        return ProjectedView(*_remove_hidden_lines(solid, PROJECTIONS[view]))

    (x, y, z), (_, far_y, far_z) = occ.bounds(solid)
    removed = box((x - 1.0, y - 1.0, z - 1.0), (0.0, far_y + 1.0, far_z + 1.0))
    half = occ.cut(solid, removed.val().wrapped)
    visible, _ = _remove_hidden_lines(half, PROJECTIONS[view])
    return ProjectedView(visible, (), _cut_outlines(half, PROJECTIONS[view]))


def _remove_hidden_lines(
    shape: TopoDS_Shape, projection: Projection
) -> tuple[tuple[Line2, ...], tuple[Line2, ...]]:
    """Compute the visible and the hidden edges. Smooth edges between faces are neither."""
    BRepLib.EncodeRegularity_s(shape, _SMOOTH_RAD)
    axes = gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(*projection.towards), gp_Dir(*projection.right))
    algorithm = HLRBRep_Algo()
    algorithm.Add(shape)
    algorithm.Projector(HLRAlgo_Projector(axes))
    algorithm.Update()
    algorithm.Hide()
    result = HLRBRep_HLRToShape(algorithm)
    visible = _polylines(result.VCompound(), result.OutLineVCompound())
    hidden = _polylines(result.HCompound(), result.OutLineHCompound())

    return visible, tuple(edge for edge in hidden if edge not in set(visible))


def _polylines(*compounds: Any) -> tuple[Line2, ...]:
    """Discretise projected edges, without points and duplicates, in an order of their own."""
    edges: set[Line2] = set()
    for compound in compounds:
        if compound is None or compound.IsNull():
            continue

        BRepLib.BuildCurves3d_s(compound)
        for edge in occ.list_shapes(compound, TopAbs_EDGE):
            points = tuple(_points(edge, lambda point: (point.X(), point.Y())))
            edges.add(min(points, points[::-1]))  # begins at its lower end

    return tuple(sorted(edge for edge in edges if len(edge) > 1))


def _points(edge: TopoDS_Shape, flatten: Any) -> list[tuple[float, float]]:
    sampled = GCPnts_TangentialDeflection(
        BRepAdaptor_Curve(TopoDS.Edge_s(edge)), _ANGLE_RAD, DEFLECTION_MM
    )
    points: list[tuple[float, float]] = []
    for i in range(1, sampled.NbPoints() + 1):
        u, v = flatten(sampled.Value(i))
        point = (round(u, _DECIMALS) + 0.0, round(v, _DECIMALS) + 0.0)
        if not points or point != points[-1]:
            points.append(point)

    return points


def _cut_outlines(half: TopoDS_Shape, projection: Projection) -> tuple[Line2, ...]:
    """Return the outlines of the faces in the plane of the section, closed."""
    rings = []
    for face in occ.list_shapes(half, TopAbs_FACE):
        low, high = occ.bounds(face)
        is_plane = BRepAdaptor_Surface(TopoDS.Face_s(face)).GetType() == GeomAbs_Plane
        if not is_plane or max(abs(low[0]), abs(high[0])) > _IN_PLANE_MM:
            continue

        for wire in occ.list_shapes(face, TopAbs_WIRE):
            ring: list[tuple[float, float]] = []
            edges = BRepTools_WireExplorer(TopoDS.Wire_s(wire))
            while edges.More():
                edge = edges.Current()
                points = _points(
                    edge, lambda point: projection.flatten((point.X(), point.Y(), point.Z()))
                )
                is_reversed = edge.Orientation() == TopAbs_REVERSED
                ring += reversed(points) if is_reversed else points
                edges.Next()

            rings.append(tuple(ring))

    return tuple(sorted(rings))
