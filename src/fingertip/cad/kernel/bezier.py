"""Faces and edges of rational Bezier arcs, and the superconic bodies that are sewn from them, in Open CASCADE.

The scripts of `fingertip build --formats cq` hold these functions too.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.BRepGProp import BRepGProp
from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Solid
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopoDS import TopoDS

# Functions

SEWING_MM = 1e-6
"""Distance within which edges of neighbouring faces are sewn together [mm]."""


def volume(shape: Any) -> float:
    """Compute the volume [mm3] of a shape by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259 mm3. There the
    kernel's plain quadrature (cadquery's `Volume()`) is off by 0.3 mm3, and its adaptive Gauss quadrature with a stated
    tolerance of 1e-6 by 11 mm3.
    """
    properties, shape = GProp_GProps(), getattr(shape, "wrapped", shape)
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
    """Make an edge in the plane at height z from control points (x, y, weight); two are a straight line."""
    if len(row) == 2:
        return BRepBuilderAPI_MakeEdge(*(gp_Pnt(x, y, z) for x, y, _ in row)).Edge()
    poles, weights = TColgp_Array1OfPnt(1, len(row)), TColStd_Array1OfReal(1, len(row))
    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)
    return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge()


def sew_superconic(section: Sequence[float], spans: Any) -> Any:
    """Sew four faces for each span along z, and flat ends where it has a width, from a section of four conic arcs.

    The section holds its half width, the heights of its palmar and dorsal half, and the weights of their arcs.
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
        z, scale, palmar_scale = span.z[end], span.scale[end], span.palmar[end]
        if scale:
            rows = [[(x * scale, y * (palmar_scale if y < 0 else scale), w) for x, y, w in arc] for arc in quadrants]
            outline = cq.Wire.assembleEdges([cq.Edge(bezier_edge(row, z)) for row in rows])
            faces.append(cq.Face.makeFromWires(outline).wrapped)
    sewing = BRepBuilderAPI_Sewing(SEWING_MM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shell = TopoDS.Shell_s(sewing.SewedShape())
    solid = ShapeFix_Solid().SolidFromShell(shell)
    # The shell may have been sewn with its faces pointing inwards.
    return solid if volume(solid) > 0 else ShapeFix_Solid().SolidFromShell(TopoDS.Shell_s(shell.Reversed()))
