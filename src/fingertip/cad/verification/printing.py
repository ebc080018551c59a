"""Checks of the files of parts and plates, and of the printed parts as they lie on the bed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import chain, combinations

import numpy as np

from fingertip.cad.files import stl, threemf
from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, find_degenerate_triangles, to_manifold
from fingertip.cad.printing.orientations import (
    build_volume_excess,
    print_orientations,
    supports_by_part,
)
from fingertip.cad.printing.overhang import (
    MAX_UNSUPPORTED_MM2,
    Ceiling,
    Pose,
    bed_pose,
    find_ceilings,
)
from fingertip.cad.printing.print_files import Placed, PrintFiles, parts_on_plates
from fingertip.cad.printing.settings import choose_plate_kind
from fingertip.cad.verification.check import Check, Checks, Solids
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.foundation.numerics import Array
from fingertip.models.hand_stub import guide
from fingertip.models.joint import joint_of
from fingertip.models.parts import PARTS, Part, print_scale
from fingertip.models.solids import Solid

_HOLDER_GENUS = 3
"""Number of through holes of a holder: that of the bone, and those of the cross bolt into it."""
_STAND_GENUS = 2
"""Number of through holes of a stand: those of the cross bolt open into its blind socket."""


def check_mesh_file(design: Design, part: Part, mesh: Mesh, file_format: str) -> Iterator[Check]:
    """Check that a file's mesh is closed, not degenerate, oriented outwards, one body, and of the
    expected genus.
    """
    prefix = f"{part.name}.{file_format}."
    solid = to_manifold(mesh.vertices, mesh.triangles)
    yield from check_triangles(prefix, mesh)
    yield Check(
        name=f"{prefix}bodies",
        value=len(solid.decompose()),
        limit=1,
        unit="bodies",
        relation="exactly",
    )
    yield Check(
        name=f"{prefix}genus",
        value=solid.genus(),
        limit=part_genus(design, part.name),
        unit="through holes",
        relation="exactly",
    )


def check_triangles(prefix: str, mesh: Mesh) -> Iterator[Check]:
    yield Check(
        name=f"{prefix}open_edges",
        value=count_open_edges(mesh),
        limit=0,
        unit="edges",
        relation="exactly",
    )
    # Programs drop triangles without area when they read a file, which leaves holes.
    degenerate = find_degenerate_triangles(mesh.vertices, mesh.triangles)
    yield Check(
        name=f"{prefix}degenerate_triangles",
        value=len(degenerate),
        limit=0,
        unit="triangles",
        relation="exactly",
    )
    yield Check(
        name=f"{prefix}inverted",
        value=float(mesh.volume() <= 0.0),
        limit=0,
        unit="",
        relation="exactly",
    )


def check_brep_solid(
    design: Design,
    part: Part,
    mesh: Mesh,
    measured: BrepMeasurements,
    scale: float,
    tolerance_mm: float,
) -> Iterator[Check]:
    """Check a valid B-rep solid's genus, and its volume against the mesh to the tolerance times the
    surface area.
    """
    yield Check(
        name=f"{part.name}.step.genus",
        value=measured.genus,
        limit=part_genus(design, part.name),
        unit="through holes",
        relation="exactly",
    )
    difference = abs(mesh.volume() - measured.volume_mm3 * scale**3)
    yield Check(
        f"{part.name}.step.volume_difference_to_mesh", difference, tolerance_mm * mesh.area(), "mm3"
    )


def count_open_edges(mesh: Mesh) -> int:
    """Count directed edges that are not matched by exactly one edge in the opposite direction."""
    forward = np.concatenate([mesh.triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    size = len(mesh.vertices)
    ordered = np.sort(forward[:, 0] * size + forward[:, 1])
    backward = np.sort(forward[:, 1] * size + forward[:, 0])
    if np.array_equal(ordered, backward) and bool((np.diff(ordered) > 0).all()):
        return 0  # the usual case, in which the slower count below is not needed

    keys, counts = np.unique(ordered, return_counts=True)
    matched = np.isin(keys, backward) & (counts == 1)
    return int(len(keys) - matched.sum())


CHECKS = Checks()

_BED = ("printer.bed_x_mm", "printer.bed_y_mm", "printer.bed_z_mm", "skin.length_mm")
_INTO_AIR_MM = 0.02
"""Distance from a facet at which it is found in a place for supports [mm]."""
_RAY = np.array([0.6, 0.64, 0.48])
"""Direction of a ray that no plane, edge or axis of a part is parallel to."""
_ROUNDING_MM = 1e-5
"""Rounding of positions on a plate [mm]."""


@CHECKS.register(
    change={
        "*.build_volume_excess": _BED,
        "*.overhang": (
            "bone.groove_depth_mm",
            "bone.platform_mm",
            "skin.bump_height_mm",
            "bone.interface",
        ),
        "plate.bed_excess": _BED,
    }
)
def check_on_bed(design: Design, solids: Solids) -> Iterator[Check]:
    """Check that each printed part fits the printer as it lies on the bed, and its overhangs."""
    for name in solids.parts:
        if PARTS[name].is_printed:
            excess = build_volume_excess(
                design, solids.mesh(name), print_orientations(design)[name].rotate_x_deg
            )
            yield Check(f"{name}.build_volume_excess", excess, 0.0, "mm")
            yield check_overhang(design, solids, name)


def check_overhang(design: Design, solids: Solids, name: str) -> Check:
    """Check the largest unsupported overhang of a part that lies on the bed, away from the places
    of supports.
    """
    places = supports_by_part(design)[name].places
    mesh = solids.mesh(name)
    evaluator = solids.evaluator
    pose = bed_pose(mesh, print_orientations(design)[name].rotate_x_deg)
    scale = print_scale(design, PARTS[name])
    largest = 0.0

    for ceiling in find_ceilings(pose.apply(mesh)):
        area = ceiling.unsupported_mm2()
        needs_support = area > MAX_UNSUPPORTED_MM2  # smaller ones count wherever they are
        if area > largest and not (
            needs_support
            and _may_be_supported(
                ceiling,
                mesh=mesh,
                scale=scale,
                evaluator=evaluator,
                places=places,
            )
        ):
            largest = area

    return Check(f"{name}.overhang", largest, MAX_UNSUPPORTED_MM2, "mm2")


def _may_be_supported(
    ceiling: Ceiling,
    mesh: Mesh,
    scale: float,
    evaluator: MeshEvaluator,
    places: tuple[Solid, ...],
) -> bool:
    """Return whether the air below all facets of a ceiling lies within places for supports."""
    corners = mesh.vertices[mesh.triangles[ceiling.facets]] / scale
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    points = corners.mean(axis=1) + _INTO_AIR_MM * normal

    for place in places:
        region = evaluator.manifold(place)
        low, high = np.split(np.array(region.bounding_box()), 2)
        is_inside = ((points >= low) & (points <= high)).all(axis=1)
        far = float(np.linalg.norm(high - low)) * _RAY

        # A ray from a point inside leaves the region once more than it enters.
        for i in is_inside.nonzero()[0]:
            is_inside[i] = (
                len(region.ray_cast(points[i].tolist(), (points[i] + far).tolist())) % 2 == 1
            )

        points = points[~is_inside]

    return not len(points)


def check_print_files(
    design: Design, meshes: Mapping[str, Mesh], encoded: Mapping[str, str], prints: PrintFiles
) -> Iterator[Check]:
    for file, data in prints.contents.items():
        if file in prints.plates:
            continue

        name = file.removesuffix(".stl")
        printed = stl.from_bytes(data)
        prefix = f"{name}.print.stl"
        yield Check(
            name=f"{prefix}.open_edges",
            value=count_open_edges(printed),
            limit=0,
            unit="edges",
            relation="exactly",
        )
        yield Check(
            name=f"{prefix}.bed_distance",
            value=float(printed.vertices[:, 2].min()),
            limit=0.0,
            unit="mm",
            relation="exactly",
        )
        yield Check.zero_volume(
            f"{prefix}.volume_difference", abs(printed.volume() - meshes[name].volume())
        )

    if prints.plates:
        yield from _check_plates(design, meshes, encoded, prints)


def _check_plates(
    design: Design, meshes: Mapping[str, Mesh], encoded: Mapping[str, str], prints: PrintFiles
) -> Iterator[Check]:
    """Check that the plates hold each of their parts once, apart from the others and within the
    bed.
    """
    bed = (design.printer.bed_x_mm, design.printer.bed_y_mm, design.printer.bed_z_mm)
    kind = choose_plate_kind(design)
    plates = [threemf.read_items(prints.contents[file]) for file in prints.plates]
    items_on_plates = chain.from_iterable(plates)
    placed = sorted(item.name for item in items_on_plates if item.mesh == encoded.get(item.name))
    wrong = set(parts_on_plates(design)).symmetric_difference(placed)
    repeated = len(placed) - len(set(placed))
    yield Check(
        name="plate.wrong_parts",
        value=len(wrong) + repeated,
        limit=0,
        unit="parts",
        relation="exactly",
    )
    gaps = [math.inf]
    low = []
    excess = []

    for items in plates:
        boxes = [_bounds(item, meshes[item.name]) for item in items]
        low += [float(box[0, 2]) for box in boxes]
        excess += [max(float((-box[0]).max()), float((box[1] - bed).max())) for box in boxes]
        rectangles = [
            Placed("", False, *box[0, :2].tolist(), *(box[1] - box[0])[:2].tolist())
            for box in boxes
        ]
        gaps += [first.distance(second) for first, second in combinations(rectangles, 2)]

    yield Check("plate.bed_distance", max(map(abs, low)), _ROUNDING_MM, "mm")
    yield Check("plate.bed_excess", max(excess), _ROUNDING_MM, "mm", change=_BED)
    if math.isfinite(min(gaps)):
        yield Check(
            name="plate.gap",
            value=min(gaps),
            limit=kind.gap_mm - _ROUNDING_MM,
            unit="mm",
            relation="at least",
        )


def _bounds(item: threemf.Item, mesh: Mesh) -> Array:
    assert item.rotation is not None
    placed = Pose(item.rotation, item.shift).apply(mesh).vertices
    return np.stack([placed.min(axis=0), placed.max(axis=0)])


def part_genus(design: Design, name: str) -> int:
    """Count the through holes that a part must have.

    A different count in the built solid reveals a hollow that breaks through a wall.
    """
    match name:
        case "bone":  # the cable channel, and those of the interface
            return 1 + interface_of(design).genus(design)
        case "stand":
            return _STAND_GENUS
        case "holder":
            return _HOLDER_GENUS
        case "hand_stub":  # the bore, in each cheek of a fork, and the guides
            way = guide(design)
            return (1 if joint_of(design).is_fork else 2) + (len(way.x) if way else 0)
        case _:
            return 0
