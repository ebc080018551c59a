"""Boxes and rods of CadQuery, and their meshes for the checks; lengths in mm."""

import cadquery as cq

from fingertip import mesh_of
from fingertip.cad.kernel.mesh import to_manifold

THREAD = 1.35
FREE = 1.65
"""Radii of a hole in which M3 cuts its thread, and of one that it passes."""


def box(low, high):
    size = [b - a for a, b in zip(low, high, strict=True)]
    return cq.Workplane("XY").box(*size, centered=False).translate(tuple(low))


def rod(
    axis,
    at,
    low,
    high,
    radius,
):
    """Cylinder along `axis`; `at` holds y and z, z and x, or x and y."""
    plane, origin = {
        "x": ("YZ", (low, *at)),
        "y": ("ZX", (at[1], low, at[0])),
        "z": ("XY", (*at, low)),
    }[axis]
    return cq.Workplane(plane, origin=origin).circle(radius).extrude(high - low)


def headed(at, height, radius):
    """Pin along z from 0 to `height`, below a head whose underside
    is a cone that prints without supports.
    """
    cone = (
        cq.Workplane("XY", origin=(*at, height))
        .circle(radius)
        .workplane(offset=2.5)
        .circle(radius + 2.0)
        .loft()
    )
    return union(
        rod("z", at, 0, height, radius),
        cone,
        rod("z", at, height + 2.5, height + 3.5, radius + 2.0),
    )


def solid_of(part):
    mesh = mesh_of(part)
    return to_manifold(mesh.vertices, mesh.triangles)


def union(first, *others):
    for each in others:
        first = first.union(each)

    return first.clean()


def cut(first, *others):
    for each in others:
        first = first.cut(each)

    return first.clean()
