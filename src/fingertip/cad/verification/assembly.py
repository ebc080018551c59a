"""Checks of the assembly: overlaps, demolding, and volume balances between the parts.

A volume balance states that volumes which must add up do so, such as core + skin = cavity. The
balances are checked on the meshes, and again on the volumes of the B-rep solids, which involve no
mesh.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import combinations

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check, Checks, Solids
from fingertip.design import Design
from fingertip.models import mold
from fingertip.models.making import making_of
from fingertip.models.mold_layout import RIDGE_HEIGHT_MM
from fingertip.models.outline import skin_outline
from fingertip.models.solids import Box, Cone, Solid, intersection, signed_area, union

CHECKS = Checks()

HALVES = ("mold_palmar", "mold_dorsal")
_PULL_DISTANCES_MM = (0.02, 0.2, 1.0, 4.0, 12.0)
LIFT_MM = RIDGE_HEIGHT_MM + 0.5
"""Height by which a core is lifted out of its grooves before the dorsal half comes off [mm]."""
_BREP_VOLUME_ERROR = 2e-6
"""Relative error allowed in volumes of the B-rep kernel, whose quadrature has a tolerance of 1e-6.
"""


@CHECKS.register()
def check_assembly(design: Design, solids: Solids) -> Iterator[Check]:
    evaluator = solids.evaluator
    making = making_of(design)
    parts = solids.parts
    if "skin" in parts:
        growth = making.scale(design) ** 3
        silicone = evaluator.manifold(parts["skin"]).volume()
        outer = _outline_in_cup(design)
        room = evaluator.manifold(outer).volume()
        core = evaluator.manifold(outer.intersect(making.in_cup(design))).volume()
        yield Check.zero_volume(
            "volume_balance.cavity", abs(float(room - core - growth * silicone))
        )

    inside = {name: solid for name, solid in parts.items() if name in ("skin", *making.lowered)}
    if "skin" in inside:
        inside["skin"] = making.silicone(design, inside["skin"])

    halves = {name: solid for name, solid in parts.items() if name in HALVES}
    yield from _check_overlaps(evaluator, inside, halves)
    if inside:
        whole = evaluator.manifold(union(*inside.values()))
        for name, half in halves.items():
            solid = evaluator.manifold(half)
            direction = -1.0 if name == HALVES[0] else 1.0
            # The palmar half comes off first. Then core and skin are lifted, and the third ridge
            # leaves its groove.
            lift = LIFT_MM if name == HALVES[1] else 0.0
            pulled = (
                solid.translate((0.0, direction * distance, lift))
                for distance in _PULL_DISTANCES_MM
            )
            overlap = max(float((position ^ whole).volume()) for position in pulled)
            yield Check.zero_volume(f"demolding_overlap.{name}", overlap)

    if len(halves) == 2:
        yield Check.zero_volume(
            "volume_balance.mold", _mold_imbalance(design, evaluator, halves.values())
        )


def _outline_in_cup(design: Design) -> Solid:
    """Build the outside of the skin at the scale of what lies in it."""
    return skin_outline(design).scaled(making_of(design).scale(design))


def brep_balance_solids(design: Design, parts: Collection[str]) -> tuple[tuple[str, Solid], ...]:
    """List the solids, besides the parts, whose volumes `check_brep_assembly` needs, by name."""
    solids: list[tuple[str, Solid]] = []
    if "skin" in parts:
        far = 10 * design.skin.length_mm
        above_plate = Box((-far, -far, 0.0), (far, far, far))
        solids += [
            ("cavity", _outline_in_cup(design)),
            ("core_in_cavity", making_of(design).in_cup(design).intersect(above_plate)),
        ]

    if set(HALVES) <= set(parts):
        solids.append(("hollow", mold.hollow(design).intersect(mold.block(design))))

    return tuple(solids)


def check_brep_assembly(
    design: Design, parts: Mapping[str, BrepMeasurements], volumes_mm3: Mapping[str, float]
) -> Iterator[Check]:
    if "cavity" in volumes_mm3:
        growth = making_of(design).scale(design) ** 3
        skin = parts["skin"].volume_mm3
        whole = volumes_mm3["cavity"]
        imbalance = abs(whole - volumes_mm3["core_in_cavity"] - growth * skin)
        yield Check("step.volume_balance.cavity", imbalance, _BREP_VOLUME_ERROR * whole, "mm3")

    if "hollow" in volumes_mm3:
        outline = mold.block(design)
        block = math.prod(high - low for low, high in zip(outline.low, outline.high, strict=True))
        # The letters in closed form save B-rep booleans. Their holes run clockwise, and count as
        # negative.
        rings = []
        for letter in mold.label(design):
            rings += [letter.corners, *letter.holes]

        letters = design.mold.engraving_depth_mm * sum(map(signed_area, rings))
        filled = volumes_mm3["hollow"] + letters + sum(parts[half].volume_mm3 for half in HALVES)
        filled += sum(map(_volume_below_parting_plane_mm3, mold.key_sockets(design)))
        filled -= sum(map(_volume_below_parting_plane_mm3, mold.key_frustums(design)))
        yield Check(
            "step.volume_balance.mold", abs(block - filled), _BREP_VOLUME_ERROR * block, "mm3"
        )


def _check_overlaps(
    evaluator: MeshEvaluator, inside: Mapping[str, Solid], halves: Mapping[str, Solid]
) -> Iterator[Check]:
    """Check that no two parts overlap: those inside the mold, and these with a half.

    Parts inside the mold share surfaces. The intersection of such solids takes four times as long
    as their union, so their overlap is computed as |A & B| = |A| + |B| - |A + B|. Against a half
    they are tested all at once in the same way, and one by one only if the union overlaps it.
    """

    def volume(solid: Solid) -> float:
        return float(evaluator.manifold(solid).volume())

    for (first, solid_of_first), (second, solid_of_second) in combinations(inside.items(), 2):
        yield Check.zero_volume(
            f"overlap.{first}.{second}",
            volume(solid_of_first)
            + volume(solid_of_second)
            - volume(solid_of_first.union(solid_of_second)),
        )

    cast = union(*inside.values()) if inside else None
    for half, solid in halves.items():
        together = volume(cast) + volume(solid) - volume(cast.union(solid)) if cast else 0.0
        for name, inner in inside.items():
            alone = together if together <= VOLUME_TOLERANCE_MM3 else volume(inner.intersect(solid))
            yield Check.zero_volume(f"overlap.{name}.{half}", alone)

    if len(halves) == 2:
        yield Check.zero_volume(
            f"overlap.{'.'.join(halves)}", volume(intersection(*halves.values()))
        )


def _mold_imbalance(design: Design, evaluator: MeshEvaluator, halves: Iterable[Solid]) -> float:
    """Compute |block - halves - hollow - cut-outs| [mm3].

    Hollow and cut-outs are evaluated apart from the halves.
    """
    cuts = union(*mold.belts(design), *mold.label(design))
    block = mold.block(design)
    hollow = mold.hollow(design).union(cuts)
    filled = sum(evaluator.manifold(solid).volume() for solid in (hollow.intersect(block), *halves))
    below = evaluator.manifold(block).trim_by_plane((0.0, -1.0, 0.0), 0.0)

    for socket, key in zip(mold.key_sockets(design), mold.key_frustums(design), strict=True):
        filled += (evaluator.manifold(socket) ^ below).volume() - (
            evaluator.manifold(key) ^ below
        ).volume()

    return abs(float(evaluator.manifold(block).volume() - filled))


def _volume_below_parting_plane_mm3(key: Solid) -> float:
    """Compute the volume [mm3] of the frustum of a key below the parting plane."""
    assert isinstance(key, Cone)
    top = key.low_radius
    height = -key.low
    root = top + (key.high_radius - top) * height / (key.high - key.low)

    return math.pi * height / 3.0 * (top * top + top * root + root * root)
