"""Skin of a finger in simulators: law of its contact, convex pieces for collisions, and points of a
tactile sensor.

In MuJoCo, a contact of depth r and impedance d(r) holds the force F = s r d^2 / (dmax^2 (1 - d) w),
where s is the stiffness in solref, and w the sum of the inverse masses of both bodies, as
`body_invweight0` has them: s holds for one w. An impedance near 1 would hold back the masses too; a
small one is a spring. Here it grows with the depth, so that the contact stiffens as the pad does: d
= dmin + (dmax - dmin) (1 - (1 - r / width)^power), by a midpoint near 0.

The pieces are slices along the finger, each its convex hull. The skin is cut where its hull is
farthest from it, until the pieces are near enough. A plate that lies on two of them meets two
contacts, and so twice the stiffness: pieces are few, and none ends where a plate touches the pad.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_arrays, to_canonical_mesh
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.skin import skin_outline
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import REFERENCE_POSE, Pad
from fingertip.sim.contact.surface_files import SURFACES

FORCES_N = (0.2, 0.35, 0.6, 1.0, 1.7, 2.8, 4.0, 6.0, 10.0)
"""Forces at which the contact is compared with the pad."""
_WIDTH = 1.6
"""Depth from which on the contact stiffens no more, over that at the largest force."""
REFERENCE_N = 1.0
"""Force at which the damping is linearised."""
_MAX_IMPEDANCE = 0.1
"""Impedance from that depth on: share of other forces on the masses that the contact cancels."""
_POWERS = tuple(1.0 + 0.1 * step for step in range(21))
_MIDPOINT = 1e-4
"""Midpoint of solimp: the least that MuJoCo takes."""
_SLIPPERIEST = "smooth"
"""Surface that gives the friction of the pad: simulators take the greater one of two that touch."""


@dataclass(frozen=True)
class ContactLaw:
    """Contact of a rigid plate with the pad, and its greatest relative error over `FORCES_N`."""

    min_impedance: float
    power: float
    depth_m: float
    """Depth from which on the contact is linear."""
    stiffness_n_per_m: float
    """Stiffness of solref for a sum of inverse masses of 1/kg."""
    damping_n_s_per_m: float
    """Damping of solref for the same."""
    error: float
    depths_mm: tuple[float, ...]
    """Depths of the pad at `FORCES_N`."""
    forces_n: tuple[float, ...]
    """Forces of the contact at these depths."""
    inverse_mass_per_kg: float
    """Inverse of the mass that the simulation of a finger moves on the pad."""
    pad_stiffness_n_per_m: float
    """Stiffness of the pad at `REFERENCE_N`."""
    friction: float
    torsion_m: float
    """Moment over force at which the contact turns."""

    @property
    def solimp(self) -> tuple[float, ...]:
        """Impedance of MuJoCo: least and largest one, width, midpoint and power."""
        return self.min_impedance, _MAX_IMPEDANCE, self.depth_m, _MIDPOINT, self.power

    def solref(self, inverse_mass_per_kg: float) -> tuple[float, float]:
        """Return stiffness and damping for a sum of inverse masses of finger and object [1/kg]."""
        stiffness = -self.stiffness_n_per_m * inverse_mass_per_kg
        damping = -self.damping_n_s_per_m * math.sqrt(inverse_mass_per_kg)
        return stiffness, damping


def fit_contact(design: Design) -> ContactLaw:
    """Fit the contact to the pad in its reference pose. Raises TraceError."""
    contacts = find_contacts(PadForm.of_design(design), REFERENCE_POSE, FORCES_N, math.inf)
    depth_m = 1e-3 * np.array([contact.depth_mm for contact in contacts])
    force_n = np.array(FORCES_N)
    pad = Pad.from_design(design)
    friction = SURFACES[_SLIPPERIEST].friction.mu_c
    fits = []
    width_m = _WIDTH * float(depth_m[-1])

    for least, power in itertools.product(
        np.linspace(0.02 * _MAX_IMPEDANCE, _MAX_IMPEDANCE, 200), _POWERS
    ):
        impedance = _MAX_IMPEDANCE - (_MAX_IMPEDANCE - least) * (1.0 - depth_m / width_m) ** power
        ratio = force_n * (1.0 - impedance) / (depth_m * impedance**2)
        stiffness = math.sqrt(ratio.max() * ratio.min())
        fits.append(
            (math.sqrt(ratio.max() / ratio.min()), stiffness, float(least), power, impedance, ratio)
        )

    spread, stiffness, least, power, impedance, ratio = min(fits, key=lambda fit: fit[0])
    slope = pad.normal_stiffness_n_per_m(REFERENCE_N)
    # 2 zeta sqrt(slope w) = impedance damping / dmax, with the damping ratio of the simulation of a
    # finger.
    damping = 2 * pad.backing.damping_ratio * math.sqrt(slope) * _MAX_IMPEDANCE
    return ContactLaw(
        min_impedance=least,
        power=power,
        depth_m=width_m,
        stiffness_n_per_m=stiffness * _MAX_IMPEDANCE**2,
        damping_n_s_per_m=damping / float(np.interp(REFERENCE_N, force_n, impedance)),
        error=spread - 1.0,
        depths_mm=tuple((1e3 * depth_m).tolist()),
        forces_n=tuple((force_n * stiffness / ratio).tolist()),
        inverse_mass_per_kg=1 / pad.backing.mass_kg,
        pad_stiffness_n_per_m=slope,
        friction=friction,
        torsion_m=2 / 3 * friction * pad.patch_radius_m(REFERENCE_N),
    )


WANTED_MM = 0.15
"""Distance to the skin at which no further cut is made."""
MAX_PIECES = 4
FACET_MM = 0.03
"""Tolerance of the mesh that is cut."""
_EXACT_MM = 0.005
"""Tolerance of the mesh that stands for the skin's true surface."""
_MIN_MM = 1.0
"""Least length of a piece."""
_GRID_MM = 2.0**-10
_SLIVER_MM = 0.005
"""Height of a triangle below which its plane says nothing; its neighbours lie as near."""
_FLAT = 0.99
"""A facet whose normal has at least this component along the finger is a cut, or the skin's end."""


def cut_skin(design: Design) -> tuple[tuple[Mesh, ...], float]:
    """Cut the skin, filled with what lies in it, into convex pieces.

    Returns the pieces, and the greatest distance of their outside to the skin's surface [mm].
    """
    outline = skin_outline(design)
    evaluator = MeshEvaluator(FACET_MM)
    body = evaluator.manifold(outline)
    surface = MeshEvaluator(_EXACT_MM).mesh(outline).vertices
    cuts = [0.0, design.skin.length_mm]
    dims = design.dimensions
    last_cut_mm = dims.sensor_z - dims.sensor.active_diameter_mm / 2

    while True:
        pieces = []
        for low, high in itertools.pairwise(cuts):
            slab = body.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
            # The hull of manifold3d folds where points are not rounded first.
            points = np.unique(np.round(to_arrays(slab)[0] / _GRID_MM), axis=0) * _GRID_MM
            pieces.append(to_canonical_mesh(slab.hull_points(points)))

        distance = _measure(pieces, cuts, surface)
        worst = int(distance.argmax())
        cut = min(round(float(surface[worst, 2]), 3), last_cut_mm)
        is_short = min(abs(cut - end) for end in cuts) < _MIN_MM
        if distance[worst] <= WANTED_MM or len(pieces) == MAX_PIECES or is_short:
            return tuple(pieces), float(distance[worst])

        cuts = sorted([*cuts, cut])


def _measure(pieces: list[Mesh], cuts: list[float], points: Array) -> Array:
    """Measure how far points of the true surface lie from the outside of the piece around them
    [mm].

    Distances are those to the planes of the facets: exact for a point inside a piece, and for one
    outside that lies before a facet, as those of a smooth surface do.
    """
    distances = np.zeros(len(points))
    for piece, (low, high) in zip(pieces, itertools.pairwise(cuts), strict=True):
        normals, offsets = _list_side_planes(piece, is_last=high == cuts[-1])
        inside = np.flatnonzero((points[:, 2] > low) & (points[:, 2] <= high))

        # In blocks, as a table of all points by all planes would not fit the memory.
        for block in np.array_split(inside, 1 + len(inside) // 2000):
            distances[block] = np.abs((points[block] @ normals.T - offsets).max(axis=1))

    return distances


def _list_side_planes(piece: Mesh, is_last: bool) -> tuple[Array, Array]:
    """List the planes of the facets that stand for the skin: normals, and offsets.

    Left out are slivers, and the facets of cuts; the last piece ends in the skin's own tip.
    """
    a, b, c = (piece.vertices[piece.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    twice_area = np.linalg.norm(normals, axis=1)
    normals /= twice_area[:, None]
    edges = (a - b, b - c, c - a)
    longest = np.max([np.linalg.norm(edge, axis=1) for edge in edges], axis=0)

    is_cut = normals[:, 2] <= -_FLAT if is_last else np.abs(normals[:, 2]) >= _FLAT
    sides = ~is_cut & (twice_area > _SLIVER_MM * longest)
    return normals[sides], np.einsum("ij,ij->i", normals, a)[sides]


SPACING_MM = 0.5
"""Distance of the vertices. At 1 mm the deepest point of a light press lies between them."""
_STEP_MM = 1e-4


@dataclass(frozen=True, eq=False)
class TactileMesh:
    """Mesh on the skin over the sensor.

    MuJoCo's sensor `tactile` reads depth and speed of slip at its vertices.
    """

    points_mm: Array
    normals: Array
    """Outward normal of each point, and the two directions along the skin in which slip is read:
    across the finger, and to its tip.
    """
    triangles: Array


def mesh_active_area(form: PadForm) -> TactileMesh:
    """Mesh the square around the active area, in the axes of the design."""
    radius = form.active_radius_mm
    count = 2 * round(form.active_radius_mm / SPACING_MM) + 1
    line = np.linspace(-radius, radius, count)
    x, z = (part.ravel() for part in np.meshgrid(line, form.sensor_z_mm + line, indexing="ij"))
    slope_x = (form.skin_mm(x + _STEP_MM, z) - form.skin_mm(x - _STEP_MM, z)) / (2 * _STEP_MM)
    slope_z = (form.skin_mm(x, z + _STEP_MM) - form.skin_mm(x, z - _STEP_MM)) / (2 * _STEP_MM)
    out = _unit(np.stack([-slope_x, -np.ones_like(x), -slope_z], axis=1))
    across = _unit(np.array([1.0, 0.0, 0.0]) - out[:, :1] * out)
    corner = np.arange(count * count).reshape(count, count)
    a, b, c, d = (
        part.ravel()
        for part in (corner[:-1, :-1], corner[1:, :-1], corner[:-1, 1:], corner[1:, 1:])
    )
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
    points = np.stack([x, -form.skin_mm(x, z), z], axis=1)
    normals: Array = np.concatenate([out, across, np.cross(out, across)], axis=1)

    # Processors differ in digits beyond these.
    return TactileMesh(points.round(6), normals.round(9), triangles)


def _unit(vectors: Array) -> Array:
    lengths: Array = np.linalg.norm(vectors, axis=1)
    return vectors / lengths[:, None]
