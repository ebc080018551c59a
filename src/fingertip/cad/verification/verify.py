"""Every check of a design, run on the bytes its files would hold.

`fingertip build` writes these files; `fingertip check` only verifies them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from fingertip.cad.files import threemf
from fingertip.cad.files.part_formats import PART_FORMATS, MeshFormat, part_file
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.print_files import PrintFiles, make_print_files
from fingertip.cad.verification import assembly, bone, encapsulation, joint, mold, printing, skin
from fingertip.cad.verification.check import Check, RegisteredCheck, Solids
from fingertip.cad.verification.printing import check_mesh_file, check_print_files
from fingertip.cad.verification.strength import BoneStrength
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue
from fingertip.foundation.extras import call_plugins
from fingertip.foundation.progress import Work
from fingertip.models.parts import PARTS, parts_by_name

CHECKS: tuple[RegisteredCheck, ...] = (
    *assembly.CHECKS,
    *printing.CHECKS,
    *skin.CHECKS,
    *bone.CHECKS,
    *joint.CHECKS,
    *mold.CHECKS,
    *encapsulation.CHECKS,
    *bone.STRENGTH_CHECKS,
)
"""Checks of parts, in the order of a report."""


@dataclass(frozen=True)
class VerifiedParts:
    meshes: Mapping[str, Mesh]
    contents: Mapping[str, bytes]
    """File name -> bytes; no file has been written."""
    prints: PrintFiles
    """Files of the printed parts as they lie on the bed."""
    checks: tuple[Check, ...]
    strength: BoneStrength | None
    opinions: tuple[Check, ...] = ()
    """Findings of trimesh in the mesh files, if it was asked."""


def check(
    design: Design,
    *,
    tolerance_mm: float = 0.01,
    progress: Callable[[str], None] = lambda message: None,
) -> VerifiedParts:
    """Check all parts of a design on meshes, as the command does.

    Raises DesignError or GeometryError.
    """
    return verify(
        design,
        parts=parts_by_name(design),
        formats=("stl",),
        evaluator=MeshEvaluator(tolerance_mm),
        progress=progress,
    )


def verify(
    design: Design,
    parts: Iterable[str],
    formats: Iterable[str],
    evaluator: MeshEvaluator,
    progress: Callable[[str], None] = lambda message: None,
) -> VerifiedParts:
    """Make the mesh files of the parts, read them back, and check parts and assembly.

    Raises GeometryError.
    """
    loaders = {name: PART_FORMATS[name].load for name in formats}
    mesh_formats = {name: loader() for name, loader in loaders.items() if loader}
    solids = Solids.of(design, evaluator, parts)
    stages = {f"mesh of {name}": 1.0 for name in solids.parts} | {"checks": 2.0 * len(solids.parts)}
    work = Work("", stages, progress)

    meshes = _mesh_parts(solids, work)
    files = _encode_files(meshes, mesh_formats)
    encoded = {}
    if "3mf" in mesh_formats:
        encoded = {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()}

    prints = make_print_files(design, meshes, encoded, "stl" in mesh_formats)

    work.begin("checks")
    checks = (
        *_check_files(design, files),
        *check_print_files(design, meshes, encoded, prints),
        *run_checks(design, solids),
    )
    return VerifiedParts(
        meshes=meshes,
        contents={file.name: file.data for file in files},
        prints=prints,
        checks=checks,
        strength=solids.strength if "bone" in meshes else None,
    )


def _mesh_parts(solids: Solids, work: Work) -> dict[str, Mesh]:
    meshes = {}
    for name in solids.parts:
        work.begin(f"mesh of {name}")
        meshes[name] = solids.mesh(name)

    return meshes


@dataclass(frozen=True)
class _MeshFile:
    """File of a part, which has not been written."""

    name: str
    part: str
    format_name: str
    mesh_format: MeshFormat
    data: bytes


def _encode_files(
    meshes: Mapping[str, Mesh], mesh_formats: Mapping[str, MeshFormat]
) -> tuple[_MeshFile, ...]:
    """Encode the mesh of each part in each format."""
    return tuple(
        _MeshFile(
            name=part_file(part, name),
            part=part,
            format_name=name,
            mesh_format=mesh_format,
            data=mesh_format.to_bytes(mesh, part, PARTS[part].note),
        )
        for part, mesh in meshes.items()
        for name, mesh_format in mesh_formats.items()
    )


def _check_files(design: Design, files: Iterable[_MeshFile]) -> Iterator[Check]:
    """Read the mesh of each file back, and check it."""
    for file in files:
        mesh = file.mesh_format.from_bytes(file.data)
        yield from check_mesh_file(design, PARTS[file.part], mesh, file.format_name)


def run_checks(design: Design, solids: Solids) -> Iterator[Check]:
    """Check those parts of a design that are there, together with what is wanted of them.

    Raises GeometryError.
    """
    names = set[str]()
    for registered in CHECKS:
        if registered.parts <= solids.parts.keys():
            for check in registered.run(design, solids):
                names.add(check.name)
                yield replace(check, change=registered.find_change(check.name))

    for check in call_plugins("fingertip.checks", design, solids):
        if not isinstance(check, Check) or check.name in names:
            message = (
                f"{check!r} is no Check with a name of its own; correct or remove the package that "
                "brings it."
            )
            raise FingertipError(Issue("fingertip.checks", message))

        names.add(check.name)
        yield check


def list_causes(check_name: str) -> tuple[str, ...]:
    """List the parameters behind a check, by its name.

    There are none if its failure would be a fault of the program.
    """
    return next(filter(None, (registered.find_change(check_name) for registered in CHECKS)), ())
