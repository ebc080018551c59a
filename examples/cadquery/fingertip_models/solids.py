"""Constructive solid geometry: parts as trees of primitives and boolean operations, independent of
any kernel.

Each part is described once as a tree of the frozen dataclasses below. `workplanes` evaluates it
with CadQuery. The program has two kernels for it that share no geometry code, one for meshes and
one for exact solids. All lengths are in mm and all axes are parallel to x, y or z. Solids compare
and hash by value, so that a kernel evaluates equal solids once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal, TypeAlias

from .conic import ConicBody

if TYPE_CHECKING:
    from .program_types import Array, Body

Axis = Literal["x", "y", "z"]
Point3: TypeAlias = tuple[float, float, float]
_DECIMALS = 5
"""Decimals of the corners of a body [mm]: files in single precision are off by so much."""


def axis_point(axis: Axis, u: float, v: float, w: float) -> Point3:
    """Return (x, y, z) at `w` along an axis and (`u`, `v`) across it, in cyclic order:
    (y, z), (z, x) or (x, y).
    """
    return {"x": (w, u, v), "y": (v, w, u), "z": (u, v, w)}[axis]


class Solid:
    """Solid that is combined with others as CadQuery's workplanes are.

    Without other solids, or with a factor of one, a method returns the solid as it is.
    """

    def union(self, *others: Solid) -> Solid:
        return Union((self, *others)) if others else self

    def cut(self, *tools: Solid) -> Solid:
        return Difference(self, tools) if tools else self

    def intersect(self, *others: Solid) -> Solid:
        return Intersection((self, *others)) if others else self

    def hollowed(self, inside: Solid) -> Solid:
        """Cut out a solid that is open in the plane z = 0, and lies within this one above it."""
        return Shell(self, inside)

    def scaled(self, factor: float) -> Solid:
        """Scale the solid about the origin."""
        return Scaled(self, factor) if factor != 1.0 else self


@dataclass(frozen=True)
class Box(Solid):
    """Axis-parallel box between two opposite corners [mm]."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True)
class Cone(Solid):
    """Frustum of a cone about an axis-parallel line; a cylinder if both radii are equal.

    `centre` holds the two coordinates of the line in cyclic order: (y, z) for x, (z, x) for y, (x,
    y) for z [mm].
    """

    axis: Axis
    centre: tuple[float, float]
    low: float
    high: float
    low_radius: float
    high_radius: float
    around_radius: float = 0.0
    """Radius of a circle around it whose division a mesh takes over, so that a wall between both is
    even; 0: none.
    """


def cylinder(
    axis: Axis,
    centre: tuple[float, float],
    low: float,
    high: float,
    radius: float,
    around_radius: float = 0.0,
) -> Cone:
    """Create a cylinder about an axis-parallel line [mm];
    `centre` and `around_radius` as in `Cone`.
    """
    return Cone(
        axis=axis,
        centre=centre,
        low=low,
        high=high,
        low_radius=radius,
        high_radius=radius,
        around_radius=around_radius,
    )


@dataclass(frozen=True)
class Prism(Solid):
    """Polygon extruded along an axis from `low` to `high` [mm].

    `corners` hold the two other coordinates in cyclic order, as in `Cone`, and run
    counter-clockwise in that order. For the y axis this is (z, x), which is clockwise seen from the
    dorsal side. `holes` run clockwise.
    """

    axis: Axis
    corners: tuple[tuple[float, float], ...]
    low: float
    high: float
    holes: tuple[tuple[tuple[float, float], ...], ...] = ()


def signed_area(ring: Sequence[tuple[float, float]]) -> float:
    """Compute the signed area of a ring by the shoelace formula; positive if it runs
    counter-clockwise.
    """
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise([*ring, ring[0]])) / 2


def extrude(axis: Axis, outline: Sequence[tuple[float, float]], low: float, high: float) -> Prism:
    """Extrude an outline, given by heights z and distances across in either direction, along x or
    y.
    """
    ring = tuple(outline) if axis == "y" else tuple((across, z) for z, across in outline)
    return Prism(axis, ring if signed_area(ring) > 0.0 else ring[::-1], low, high)


@dataclass(frozen=True)
class ElbowTube(Solid):
    """Round tube at x = 0 from (`start_y`, `start_z`) along -z, a bend, then along +y to (`end_y`,
    `exit_z`) [mm].
    """

    start_y: float
    start_z: float
    exit_z: float
    end_y: float
    bend_radius: float
    radius: float


@dataclass(frozen=True)
class SuperconicSolid(Solid):
    """Solid bounded by a superconic surface, as `conic` defines it."""

    body: ConicBody


@dataclass(frozen=True)
class Placed(Solid):
    """Body of a file, turned and moved by the rows of a matrix: each point (x, y, z, 1) is
    multiplied by them [mm].
    """

    body: Body
    rows: tuple[tuple[float, ...], ...]

    def move(self) -> Array:
        """Move the corners of the body's mesh, (n, 3) [mm].

        Rounding takes those in a plane of a part into it.
        """
        x, y, z = self.body.vertices.T
        moved = self.body.vertices.copy()
        for i, (a, b, c, by) in enumerate(self.rows):
            moved[:, i] = (a * x + b * y + c * z + by).round(_DECIMALS)

        return moved


@dataclass(frozen=True)
class Union(Solid):
    solids: tuple[Solid, ...]


@dataclass(frozen=True)
class Difference(Solid):
    solid: Solid
    subtracted: tuple[Solid, ...]


@dataclass(frozen=True)
class Intersection(Solid):
    solids: tuple[Solid, ...]


@dataclass(frozen=True)
class Shell(Solid):
    """Solid that ends in the plane z = 0, without what lies inside it.

    Both meet in that plane alone. Their other faces stay whole, so that a kernel may take them over
    and spare itself a boolean between curved surfaces:

          |   .---------------.
          |   |   inside       \
          |   |_________________|___  outer
        z = 0
    """

    outer: Solid
    inside: Solid


@dataclass(frozen=True)
class Scaled(Solid):
    solid: Solid
    factor: float


Shapes: TypeAlias = tuple[tuple[Solid, ...], tuple[Solid, ...]]
"""Solids that an interface adds to the filled bone, and those that it removes from it."""


def union(*solids: Solid) -> Solid:
    """Unite a list of solids; a single one is returned as it is."""
    return solids[0].union(*solids[1:])


def intersection(*solids: Solid) -> Solid:
    """Intersect a list of solids; a single one is returned as it is."""
    return solids[0].intersect(*solids[1:])
