"""Parts as plain expressions: primitives and booleans that know no kernel.

Each part is described once as a tree of these frozen values and evaluated by two kernels that share no geometry
code: `cad.kernel.mesh` (numpy and manifold3d) and `cad.kernel.brep` (cadquery). All lengths in mm, all axes along x, y
or z; expressions compare and hash by value, so equal solids are recognised and evaluated once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from fingertip.conic import ConicBody
from fingertip.design.draft import DraftedSection

Axis = Literal["x", "y", "z"]
Point3: TypeAlias = tuple[float, float, float]


def place(axis: Axis, u: float, v: float, w: float) -> Point3:
    """The point at w along the axis and (u, v) across it, in cyclic order."""
    match axis:
        case "x":
            return w, u, v
        case "y":
            return v, w, u
        case "z":
            return u, v, w


@dataclass(frozen=True)
class Box:
    """Axis-parallel box between two corners [mm]."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True)
class Cone:
    """Frustum about an axis-parallel line; equal radii make a cylinder.

    `centre` is the line's two other coordinates in cyclic order: (y, z) for x, (z, x) for y, (x, y) for z [mm].
    """

    axis: Axis
    centre: tuple[float, float]
    low: float
    high: float
    low_radius: float
    high_radius: float


def cylinder(axis: Axis, centre: tuple[float, float], low: float, high: float, radius: float) -> Cone:
    """Cylinder about an axis-parallel line; see `Cone` for `centre` [mm]."""
    return Cone(axis, centre, low, high, radius, radius)


@dataclass(frozen=True)
class Prism:
    """Polygon across an axis, drawn out along it [mm].

    `corners` are the two other coordinates in cyclic order, as in `Cone`, and run counter-clockwise in that order:
    (z, x) for y, which is clockwise seen from the back of the finger. `holes` run the other way round.
    """

    axis: Axis
    corners: tuple[tuple[float, float], ...]
    low: float
    high: float
    holes: tuple[tuple[tuple[float, float], ...], ...] = ()


def hexagon(z: float, x: float, width: float, low: float, high: float) -> Prism:
    """Hexagonal prism along y around (z, x), its corners towards +-x: a nut trap. `width` is across flats [mm]."""
    r = width / math.sqrt(3.0)
    half, side = r / 2, width / 2
    ring = ((0.0, r), (-side, half), (-side, -half), (0.0, -r), (side, -half), (side, half))
    return Prism("y", tuple((z + dz, x + dx) for dz, dx in ring), low, high)


@dataclass(frozen=True)
class ElbowTube:
    """Round tube in the plane x = 0: down along -z, a quarter turn, then up along +y [mm].

    The centre line starts at (`start_y`, `start_z`), turns with `bend_radius`, and ends at (`end_y`, `exit_z`).
    """

    start_y: float
    start_z: float
    exit_z: float
    end_y: float
    bend_radius: float
    radius: float


@dataclass(frozen=True)
class Form:
    """A superconic body."""

    body: ConicBody


@dataclass(frozen=True)
class Bar:
    """A drafted section drawn out along z [mm]."""

    section: DraftedSection
    low: float
    high: float


@dataclass(frozen=True)
class Union:
    """What any of `solids` covers."""

    solids: tuple[Solid, ...]


@dataclass(frozen=True)
class Difference:
    """What `solid` covers and none of `without` does."""

    solid: Solid
    without: tuple[Solid, ...]


@dataclass(frozen=True)
class Intersection:
    """What all of `solids` cover."""

    solids: tuple[Solid, ...]


@dataclass(frozen=True)
class Scaled:
    """`solid` scaled about the origin."""

    solid: Solid
    factor: float


Primitive: TypeAlias = Box | Cone | Prism | ElbowTube | Form | Bar
Solid: TypeAlias = Primitive | Union | Difference | Intersection | Scaled


def union(*solids: Solid) -> Solid:
    """What any of the solids covers."""
    return solids[0] if len(solids) == 1 else Union(solids)


def difference(solid: Solid, *without: Solid) -> Solid:
    """`solid` with the others taken away."""
    return Difference(solid, without) if without else solid


def intersection(*solids: Solid) -> Solid:
    """What all of the solids cover."""
    return solids[0] if len(solids) == 1 else Intersection(solids)


def scaled(solid: Solid, factor: float) -> Solid:
    """`solid` scaled about the origin; itself at a factor of one."""
    return solid if factor == 1.0 else Scaled(solid, factor)
