"""Checks of mesh files that any program wrote: alone, as one of two mold halves, and as the part of
a design.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Manifold, Mesh, MeshEvaluator, to_manifold
from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check
from fingertip.cad.verification.printing import check_triangles
from fingertip.cad.verification.second_opinion import compare_readings, read_mesh
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.input_files import BODY_LIMIT, read_input
from fingertip.foundation.numerics import Array
from fingertip.models.parts import parts_by_name, print_scale

_PULL_MM = (1.0, 5.0)
"""Distances by which one mold half is pulled off the other [mm]."""
_PARTNERS = {"mold_palmar": ("mold_dorsal", -1.0), "mold_dorsal": ("mold_palmar", 1.0)}
"""Name of a mold half -> that of the other, and the direction along y in which it comes off."""
_SEAM_MM = 0.02
"""Distance from the parting plane at which the two halves are cut [mm].
Halves that are farther apart do not meet.
"""
_KEY_GAP_MM = 0.5
"""Half the width of the widest gap around a key that is closed before two cuts are compared [mm].
"""
_MAX_SEAM_MM2 = 1.0
"""Largest area that the cuts on both sides of the seam may differ by [mm2].
A shift of 0.02 mm leaves 1.4.
"""
_SIZE_ROUNDING_MM = 0.005
"""Difference in size that is left to the rounding of another program [mm]."""
_UNITS_MM = {"inches": 25.4, "centimetres": 10.0, "metres": 1000.0}
"""Units in which other programs export [mm]."""
_SHELL_SHARE = 1.5
"""Thickness of a piece between two meshes of one surface, over their tolerance, that counts as
none.
"""
_SAME_SHARE = 1e-3
"""Largest difference of two shares that counts as none."""
_UNIT_SHARE = 0.05
"""Largest share by which the size of a file may miss that of a part in another unit."""


@dataclass(frozen=True)
class MeshFile:
    """Mesh file with what was found in it."""

    path: Path
    checks: tuple[Check, ...]
    part: str = ""
    """Part of the design with which it was compared; empty if it was not."""
    size_ratios: tuple[float, ...] = ()
    """Size of the mesh over that of the part, along x, y and z."""

    @property
    def passed(self) -> bool:
        """Return whether every check passed."""
        return all(check.passed for check in self.checks)


def check_mesh_file(
    path: Path, design: Design | None = None, tolerance_mm: float = 0.01
) -> MeshFile:
    """Check a mesh file, and half of a mold beside the other half in the same folder.

    With a design, a file that has the name of a part is compared with that part. Raises
    InputFileError, GeometryError or MissingLibraryError.
    """
    data = read_input(path, BODY_LIMIT, "a mesh")
    read = read_mesh(str(path), data)
    mesh = _read_stl(path, data) or Mesh(
        np.asarray(read.vertices, dtype=np.float64), np.asarray(read.faces, dtype=np.int64)
    )
    checks = [
        *check_triangles("", mesh),
        *compare_readings("mesh", read, mesh),
        *_check_halves(path, mesh),
    ]

    name = name_part(path)
    if design is None or name not in parts_by_name(design):
        return MeshFile(path, tuple(checks))

    part = _part_like(design, name, mesh, tolerance_mm)
    checks += _compare_with_part(mesh, part, tolerance_mm)
    ratios = (_size(mesh) / _size(part)).tolist()
    return MeshFile(path, tuple(checks), name, tuple(ratios))


def name_part(path: Path) -> str:
    """Return the name of the part that a file has the name of, in capital letters or not."""
    return path.stem.lower()


def _read_stl(path: Path, data: bytes) -> Mesh | None:
    """Read a binary STL file; None for another format, or STL as text."""
    if path.suffix.lower() != ".stl":
        return None

    try:
        return stl.from_bytes(data)
    except FingertipError:
        return None


# Two halves of one mold
# ----------------------


def _check_halves(path: Path, mesh: Mesh) -> Iterator[Check]:
    """Check that a mold half meets the other at the seam, does not overlap it, and comes off it."""
    partner_name, way = _PARTNERS.get(path.stem, ("", 0.0))
    partner = path.with_name(f"{partner_name}{path.suffix}")
    if not partner_name or not partner.is_file():
        return

    read = read_mesh(str(partner), read_input(partner, BODY_LIMIT, "a mesh"))
    half = to_manifold(mesh.vertices, mesh.triangles)
    other_half = to_manifold(read.vertices, read.faces)

    overlaps = [
        float((half.translate((0.0, way * distance, 0.0)) ^ other_half).volume())
        for distance in (0.0, *_PULL_MM)
    ]
    yield Check.zero_volume(f"{partner_name}.overlap", overlaps[0])
    yield Check.zero_volume(f"{partner_name}.pull_overlap", max(overlaps[1:]))
    yield Check(f"{partner_name}.seam", measure_seam_mm2(half, other_half), _MAX_SEAM_MM2, "mm2")


def measure_seam_mm2(half: Manifold, other_half: Manifold) -> float:
    """Measure by how much two mold halves differ where they meet, in the parting plane y = 0 [mm2].

    Both halves together are cut just palmar and just dorsal of the plane, where a mold that is one
    looks the same:

        dorsal    |#####|       |#####|   <- cut
        y = 0     =======       =======
        palmar    |#####|       |#####|   <- cut

    The gap around a key is closed first. A half that is shifted, of another design, or away from
    the plane differs.
    """
    dorsal, palmar = (
        _close_gaps(_cut(half, y) + _cut(other_half, y)) for y in (_SEAM_MM, -_SEAM_MM)
    )
    return float((dorsal - palmar).area() + (palmar - dorsal).area())


def _cut(solid: Manifold, y_mm: float) -> Any:
    return solid.rotate((90.0, 0.0, 0.0)).slice(y_mm)


def _close_gaps(section: Any) -> Any:
    from manifold3d import JoinType  # noqa: PLC0415

    grown = section.offset(_KEY_GAP_MM, JoinType.Miter, 2.0)
    return grown.offset(-_KEY_GAP_MM, JoinType.Miter, 2.0)


# A part of a design
# ------------------


def _part_like(design: Design, name: str, mesh: Mesh, tolerance_mm: float) -> Mesh:
    """Make the part of a design as it fits the others, or as it lies on the bed, whichever the mesh
    is nearer to.
    """
    part = parts_by_name(design)[name]
    fitted = MeshEvaluator(tolerance_mm).mesh(part.solid(design).scaled(print_scale(design, part)))
    if not part.is_printed:
        return fitted

    lying = bed_pose(fitted, print_orientations(design)[name].rotate_x_deg).apply(fitted)
    return min(
        fitted,
        lying,
        key=lambda candidate: float(np.linalg.norm(_bounds(candidate) - _bounds(mesh))),
    )


def _bounds(mesh: Mesh) -> Array:
    return np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])


def _size(mesh: Mesh) -> Array:
    size: Array = np.ptp(mesh.vertices, axis=0)
    return size


def _compare_with_part(mesh: Mesh, part: Mesh, tolerance_mm: float) -> Iterator[Check]:
    """Compare size and surface with those of a design's part, each with facets within a tolerance.

    The differences of both bodies fall into pieces. Between two meshes of one surface they are thin
    shells; a thicker piece shows another bore, groove or letter, however small.
    """
    difference = float(abs(_size(mesh) - _size(part)).max())
    yield Check("design.size_difference", difference, 2.0 * tolerance_mm + _SIZE_ROUNDING_MM, "mm")

    solid = to_manifold(mesh.vertices, mesh.triangles)
    exact = to_manifold(part.vertices, part.triangles)
    pieces = [*(solid - exact).decompose(), *(exact - solid).decompose()]
    thickness = [
        2.0 * float(piece.volume()) / float(piece.surface_area())
        for piece in pieces
        if piece.volume() > VOLUME_TOLERANCE_MM3
    ]
    yield Check(
        "design.surface_distance", max(thickness, default=0.0), _SHELL_SHARE * tolerance_mm, "mm"
    )


# What to do about it
# -------------------


def describe_mesh_cause(file: MeshFile, check: Check) -> str:
    """Say what to do about a check of a mesh file that failed."""
    subject, _, what = check.name.partition(".")
    if subject == "design":
        return _describe_other_part(file)
    if what == "seam":
        return (
            f"export both halves of one design, without moving them apart ({subject} is the other)"
        )
    if what in ("overlap", "pull_overlap"):
        return f"export both halves of one design, each in its place ({subject} is the other)"

    return "export one body" if what.endswith("bodies") else "repair the mesh"


def _describe_other_part(file: MeshFile) -> str:
    ratio = sum(file.size_ratios) / len(file.size_ratios)
    for unit, length_mm in _UNITS_MM.items():
        if abs(ratio * length_mm - 1.0) < _UNIT_SHARE:
            return f"the file is in {unit}: export it in mm"

    is_scaled = max(file.size_ratios) - min(file.size_ratios) < _SAME_SHARE
    if is_scaled and abs(ratio - 1.0) > _SAME_SHARE:
        return (
            f"it is {ratio:.4g} times as large as {file.part} of this design: make the part again"
        )

    return f"it is not {file.part} of this design, or lies in another place: make the part again"
