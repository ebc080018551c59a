"""Checks of the parts: named lines with a value, a limit and a verdict. Each is an identity or a topological count,
so that a wrong solid cannot pass for a roundish one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Literal

import numpy as np

from fingertip.cad.files.step import Exact
from fingertip.cad.kernel.mesh import Evaluator, Mesh, to_manifold
from fingertip.cad.shapes import core, mold
from fingertip.cad.shapes import skin as skin_part
from fingertip.cad.shapes.parts import Part
from fingertip.cad.solids import Solid, intersection, scaled, union
from fingertip.design import Design
from fingertip.design.mold_layout import lay_out

if TYPE_CHECKING:
    from manifold3d import Manifold

NO_VOLUME_MM3 = 1e-3
"""Volumes below this are nothing: the rounding of 10 000 mm2 of surface to a grid of 8 nm stays below it."""
_FLAT_MM = 1e-6
"""A triangle this low has no area that a file of single precision could hold."""
HALVES = ("mold_palmar", "mold_dorsal")
PULL_DISTANCES_MM = (0.02, 0.2, 1.0, 4.0, 12.0)


Relation = Literal["at most", "at least", "exactly"]


@dataclass(frozen=True)
class Check:
    """One line of the report: `value` must be `relation` `limit`."""

    name: str
    value: float
    limit: float
    unit: str
    relation: Relation = "at most"

    @property
    def sign(self) -> str:
        """The relation as a sign, for tables."""
        return {"at most": "<=", "at least": ">=", "exactly": "="}[self.relation]

    @property
    def passed(self) -> bool:
        """The verdict."""
        match self.relation:
            case "at most":
                return self.value <= self.limit
            case "at least":
                return self.value >= self.limit
            case "exactly":
                return self.value == self.limit


def of_file(design: Design, part: Part, mesh: Mesh, file_format: str) -> Iterator[Check]:
    """Topology of a part as re-read from its file: closed, one body, the expected genus, right side out."""
    where = f"{part.name}.{file_format}"
    yield Check(f"{where}.open_edges", open_edges(mesh), 0, "edges", "exactly")
    yield Check(f"{where}.flat_triangles", flat_triangles(mesh), 0, "triangles", "exactly")
    yield Check(f"{where}.inside_out", float(mesh.volume() <= 0.0), 0, "", "exactly")
    solid = to_manifold(mesh.vertices, mesh.triangles)
    yield Check(f"{where}.bodies", len(solid.decompose()), 1, "bodies", "exactly")
    yield Check(f"{where}.genus", solid.genus(), part.genus(design), "holes", "exactly")


def flat_triangles(mesh: Mesh) -> int:
    """Triangles without area: as poles leave them, or a vertex on an edge. Programs drop them, and the hole is open."""
    corners = mesh.vertices[mesh.triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    twice = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    longest = np.sqrt(np.max(np.einsum("ijk,ijk->ij", sides, sides), axis=1))
    return int(np.sum(twice <= _FLAT_MM * longest))


def open_edges(mesh: Mesh) -> int:
    """Directed edges that are not matched by exactly one in the opposite direction."""
    forward = np.concatenate([mesh.triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    size = len(mesh.vertices)
    ordered = np.sort(forward[:, 0] * size + forward[:, 1])
    backward = np.sort(forward[:, 1] * size + forward[:, 0])
    if np.array_equal(ordered, backward) and bool((np.diff(ordered) > 0).all()):
        return 0  # as it should be: nothing needs to be counted
    keys, counts = np.unique(ordered, return_counts=True)
    matched = np.isin(keys, backward) & (counts == 1)
    return int(len(keys) - matched.sum())


def of_brep(design: Design, part: Part, mesh: Mesh, exact: Exact, scale: float, tolerance_mm: float) -> Iterator[Check]:
    """The exact solid: its holes, and its volume at the mesh's `scale`, which differs by less than tolerance x surface.

    That it is one valid solid, right side out, is seen to where it is made.
    """
    yield Check(f"{part.name}.step.genus", exact.genus, part.genus(design), "holes", "exactly")
    difference = abs(mesh.volume() - exact.volume_mm3 * scale**3)
    yield Check(f"{part.name}.step.volume_against_mesh", difference, tolerance_mm * mesh.area(), "mm3")


def of_assembly(design: Design, evaluator: Evaluator, parts: Mapping[str, Solid]) -> Iterator[Check]:
    """Identities between the parts that were asked for, each by its name."""
    if "skin" in parts:
        yield _nothing("cavity_less_core_is_skin", _cast_defect(design, evaluator, parts["skin"]))
    inside = {name: solid for name, solid in parts.items() if name not in HALVES}
    if design.mold.method == "sleeve":
        inside.pop("bone", None)  # it is not in the mold, and the skin is smaller than it on purpose
        if "skin" in inside:
            inside["skin"] = scaled(inside["skin"], design.dimensions.shrinkage)  # its size before it shrinks
    halves = {name: solid for name, solid in parts.items() if name in HALVES}
    yield from _overlaps(evaluator, inside, halves)
    if inside:
        cast = evaluator.manifold(union(*inside.values()))
        for name, half in halves.items():
            yield _nothing(f"pull.{name}", _caught(evaluator.manifold(half), cast, -1.0 if name == HALVES[0] else 1.0))
    if len(halves) == 2:
        yield _nothing("halves_and_hollows_are_block", _block_defect(design, evaluator, halves.values()))


def _overlaps(evaluator: Evaluator, inside: Mapping[str, Solid], halves: Mapping[str, Solid]) -> Iterator[Check]:
    """Overlap of each pair. What lies inside is held against a half as one: only if they overlap is it by pairs.

    Parts inside share their surfaces, whose intersection costs four times their union: |A & B| = |A| + |B| - |A + B|.
    """

    def volume(solid: Solid) -> float:
        return float(evaluator.manifold(solid).volume())

    for (first, one), (second, other) in combinations(inside.items(), 2):
        yield _nothing(f"overlap.{first}.{second}", volume(one) + volume(other) - volume(union(one, other)))
    for half, solid in halves.items():
        together = volume(intersection(union(*inside.values()), solid)) if inside else 0.0
        for name, one in inside.items():
            alone = together if together <= NO_VOLUME_MM3 else volume(intersection(one, solid))
            yield _nothing(f"overlap.{name}.{half}", alone)
    if len(halves) == 2:
        yield _nothing(f"overlap.{'.'.join(halves)}", volume(intersection(*halves.values())))


def _cast_defect(design: Design, evaluator: Evaluator, skin: Solid) -> float:
    """|cavity - core - what shrinks to the skin| [mm3].

    A sleeve shrinks with its core. Overmolded silicone does not shrink the bone: what the cavity is larger by around
    it is silicone too.
    """
    cavity, around = evaluator.manifold(skin_part.cavity(design)), evaluator.manifold(core.cast_around(design))
    cast = cavity.volume() - (cavity ^ around).volume()
    growth = design.dimensions.shrinkage**3
    expected = growth * evaluator.manifold(skin).volume()
    if design.mold.method == "overmold":
        expected += (growth - 1.0) * (cavity.scale((1.0 / design.dimensions.shrinkage,) * 3) ^ around).volume()
    return abs(float(cast - expected))


def _nothing(name: str, volume: float) -> Check:
    return Check(name, volume, NO_VOLUME_MM3, "mm3")


def _caught(half: Manifold, cast: Manifold, direction: float) -> float:
    """Most volume [mm3] a half drags through what lies in the mold while it is pulled off."""
    moved = (half.translate((0.0, direction * distance, 0.0)) for distance in PULL_DISTANCES_MM)
    return max(float((there ^ cast).volume()) for there in moved)


def _block_defect(design: Design, evaluator: Evaluator, halves: Iterable[Solid]) -> float:
    """|block - (halves + everything hollow)| [mm3]; the hollows are built apart from the halves."""
    m = lay_out(design, design.dimensions)
    block = mold.block(design)
    hollows = (intersection(mold.openings(design), block), intersection(mold.cuts(design, m), block))
    filled = sum(evaluator.manifold(solid).volume() for solid in (*hollows, *halves))
    below = evaluator.manifold(block).trim_by_plane((0.0, -1.0, 0.0), 0.0)
    for grown, key in zip(mold.keys(design, m, design.mold.key_clearance_mm), mold.keys(design, m), strict=True):
        filled += (evaluator.manifold(grown) ^ below).volume() - (evaluator.manifold(key) ^ below).volume()
    return abs(float(evaluator.manifold(block).volume() - filled))
