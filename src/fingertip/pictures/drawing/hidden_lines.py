"""Projection of B-rep solids without hidden lines, and longitudinal sections, by Open CASCADE.

Importing this module loads Open CASCADE; import `cad.kernel.brep` first, which says what to install
where that fails.
"""

from __future__ import annotations

import contextlib
from collections.abc import Collection, Iterator
from typing import Any

from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepLib import BRepLib
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.GeomAbs import GeomAbs_Plane
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_PolyAlgo, HLRBRep_PolyHLRToShape
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopoDS import TopoDS, TopoDS_Shape

from fingertip.cad.kernel import occ
from fingertip.design.geometry.sizes import ViewName
from fingertip.models.workplanes import box
from fingertip.pictures.drawing.chains import Segment, chain_segments
from fingertip.pictures.drawing.primitives import (
    PROJECTIONS,
    Line2,
    Point,
    ProjectedView,
    Projection,
)

DEFLECTION_MM = 0.01
"""Distance of facets from their surface on the part [mm]: at most 0.05 mm on paper at 5:1."""
_SMOOTH_RAD = 0.02
"""Angle between faces below which their common edge is smooth and not drawn [rad]."""
_ANGLE_RAD = 0.2
_STRAIGHT_MM = 0.002
"""Distance from a straight line within which a point of it is left out [mm]."""
_DECIMALS = 4
"""Decimals of coordinates [mm]: their last bits must not reach the files."""
_IN_PLANE_MM = 1e-5


def project(solid: TopoDS_Shape, views: Collection[ViewName]) -> dict[ViewName, ProjectedView]:
    """Project a solid in its views. The section removes the half at x < 0 first."""
    half = _cut_half(solid) if "section" in views else None
    projected: dict[ViewName, ProjectedView] = {}

    with _faceted(solid):
        for view, projection in PROJECTIONS.items():
            if view in views and view != "section":
                projected[view] = ProjectedView(*_remove_hidden_lines(solid, projection))

        if half is not None:
            projection = PROJECTIONS["section"]
            with _faceted(half):
                visible, _ = _remove_hidden_lines(half, projection)

            projected["section"] = ProjectedView(visible, (), _cut_outlines(half, projection))

    return projected


def _cut_half(solid: TopoDS_Shape) -> TopoDS_Shape:
    (x, y, z), (_, far_y, far_z) = occ.bounds(solid)
    removed = box((x - 1.0, y - 1.0, z - 1.0), (0.0, far_y + 1.0, far_z + 1.0))
    return occ.cut(solid, removed.val().wrapped)


@contextlib.contextmanager
def _faceted(shape: TopoDS_Shape) -> Iterator[None]:
    """Lay facets on a shape for the length of a block.

    None stay, because a boolean of faces with facets may not end.
    """
    BRepLib.EncodeRegularity_s(shape, _SMOOTH_RAD)
    BRepMesh_IncrementalMesh(shape, DEFLECTION_MM, False, _ANGLE_RAD, False)
    yield
    BRepTools.Clean_s(shape)


def _remove_hidden_lines(
    faceted: TopoDS_Shape, projection: Projection
) -> tuple[tuple[Line2, ...], tuple[Line2, ...]]:
    """Compute the visible and the hidden edges of a shape's facets.

    Smooth edges between faces are neither.
    """
    axes = gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(*projection.towards), gp_Dir(*projection.right))
    algorithm = HLRBRep_PolyAlgo()
    algorithm.Load(faceted)
    algorithm.Projector(HLRAlgo_Projector(axes))
    algorithm.Update()
    result = HLRBRep_PolyHLRToShape()
    result.Update(algorithm)
    visible = _segments(result.VCompound(), result.OutLineVCompound())
    hidden = _segments(result.HCompound(), result.OutLineHCompound())

    return chain_segments(visible, _STRAIGHT_MM), chain_segments(hidden - visible, _STRAIGHT_MM)


def _segments(*compounds: Any) -> set[Segment]:
    """List the projected edges of facets, each once."""
    segments = set()
    for compound in compounds:
        if compound is None or compound.IsNull():
            continue

        for edge in occ.list_shapes(compound, TopAbs_EDGE):
            curve = BRepAdaptor_Curve(TopoDS.Edge_s(edge))
            begin = _rounded(curve.Value(curve.FirstParameter()))
            end = _rounded(curve.Value(curve.LastParameter()))
            segments.add((min(begin, end), max(begin, end)))

    return segments


def _rounded(point: gp_Pnt) -> Point:
    return round(point.X(), _DECIMALS) + 0.0, round(point.Y(), _DECIMALS) + 0.0


def _points(edge: TopoDS_Shape, projection: Projection) -> list[Point]:
    sampled = GCPnts_TangentialDeflection(
        BRepAdaptor_Curve(TopoDS.Edge_s(edge)), _ANGLE_RAD, DEFLECTION_MM
    )
    points: list[Point] = []
    for i in range(1, sampled.NbPoints() + 1):
        at = sampled.Value(i)
        u, v = projection.flatten((at.X(), at.Y(), at.Z()))
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
            ring: list[Point] = []
            edges = BRepTools_WireExplorer(TopoDS.Wire_s(wire))
            while edges.More():
                edge = edges.Current()
                points = _points(edge, projection)
                is_reversed = edge.Orientation() == TopAbs_REVERSED
                ring += reversed(points) if is_reversed else points
                edges.Next()

            rings.append(tuple(ring))

    return tuple(sorted(rings))
