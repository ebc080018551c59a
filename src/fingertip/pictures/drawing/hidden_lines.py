"""Projection of B-rep solids with exact removal of hidden lines, and longitudinal sections, by Open CASCADE.

Importing this module loads cadquery; import `cad.kernel.brep` first, which says what to install where that fails.
"""

from __future__ import annotations

from typing import Any

import cadquery as cq
from OCP.BRepLib import BRepLib
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_Algo, HLRBRep_HLRToShape
from OCP.TopAbs import TopAbs_REVERSED

from fingertip.design.geometry.sizes import ViewName
from fingertip.pictures.drawing.primitives import PROJECTIONS, Line2, ProjectedView, Projection

DEFLECTION_MM = 0.002
"""Distance of a polyline from its curve on the part [mm]: at most 0.01 mm on paper at 5:1."""
_SMOOTH_RAD = 0.02
"""Angle between faces below which their common edge is smooth and not drawn [rad]."""
_ANGLE_RAD = 0.3
_DECIMALS = 4
"""Decimals of coordinates [mm]: their last bits must not reach the files."""
_IN_PLANE_MM = 1e-5


def project(solid: Any, view: ViewName) -> ProjectedView:
    """Project a `cadquery.Solid`. The section removes the half at x < 0 first."""
    shape = _far_half(solid) if view == "section" else solid
    visible, hidden = _remove_hidden_lines(shape, PROJECTIONS[view])
    if view == "section":
        return ProjectedView(visible, (), _cut_outlines(shape, PROJECTIONS[view]))
    return ProjectedView(visible, hidden)


def _far_half(solid: Any) -> Any:
    box = solid.BoundingBox()
    margin = 1.0
    corner = cq.Vector(box.xmin - margin, box.ymin - margin, box.zmin - margin)
    near = cq.Solid.makeBox(margin - box.xmin, box.ylen + 2 * margin, box.zlen + 2 * margin, corner)
    return solid.cut(near)


def _remove_hidden_lines(shape: Any, projection: Projection) -> tuple[tuple[Line2, ...], tuple[Line2, ...]]:
    """Compute the visible and the hidden edges. Smooth edges between faces are neither."""
    BRepLib.EncodeRegularity_s(shape.wrapped, _SMOOTH_RAD)
    axes = gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(*projection.towards), gp_Dir(*projection.right))
    algorithm = HLRBRep_Algo()
    algorithm.Add(shape.wrapped)
    algorithm.Projector(HLRAlgo_Projector(axes))
    algorithm.Update()
    algorithm.Hide()
    result = HLRBRep_HLRToShape(algorithm)
    visible = _polylines(result.VCompound(), result.OutLineVCompound())
    hidden = _polylines(result.HCompound(), result.OutLineHCompound())
    return visible, tuple(edge for edge in hidden if edge not in set(visible))


def _polylines(*compounds: Any) -> tuple[Line2, ...]:
    """Discretise projected edges, without points and duplicates, in an order of their own."""
    found: set[Line2] = set()
    for compound in compounds:
        if compound is None or compound.IsNull():
            continue
        BRepLib.BuildCurves3d_s(compound)
        for edge in cq.Shape.cast(compound).Edges():
            points = tuple(_points(edge, lambda p: (p.X(), p.Y())))
            found.add(min(points, points[::-1]))  # begins at its lower end
    return tuple(sorted(edge for edge in found if len(edge) > 1))


def _points(edge: Any, flatten: Any) -> list[tuple[float, float]]:
    sampled = GCPnts_TangentialDeflection(edge._geomAdaptor(), _ANGLE_RAD, DEFLECTION_MM)
    points: list[tuple[float, float]] = []
    for i in range(1, sampled.NbPoints() + 1):
        u, v = flatten(sampled.Value(i))
        point = (round(u, _DECIMALS) + 0.0, round(v, _DECIMALS) + 0.0)
        if not points or point != points[-1]:
            points.append(point)
    return points


def _cut_outlines(half: Any, projection: Projection) -> tuple[Line2, ...]:
    """Return the outlines of the faces in the plane of the section, closed."""
    rings = []
    for face in half.Faces():
        box = face.BoundingBox()
        if face.geomType() != "PLANE" or max(abs(box.xmin), abs(box.xmax)) > _IN_PLANE_MM:
            continue
        for wire in face.Wires():
            ring: list[tuple[float, float]] = []
            for edge in wire:
                points = _points(edge, lambda p: projection.flatten((p.X(), p.Y(), p.Z())))
                ring += reversed(points) if edge.wrapped.Orientation() == TopAbs_REVERSED else points
            rings.append(tuple(ring))
    return tuple(sorted(rings))
