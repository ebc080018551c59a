"""Every check of a design, run on the bytes its files would hold.

`fingertip build` writes these files; `fingertip check` only verifies them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module

from fingertip.cad.files import threemf
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.orientations import build_volume_excess, print_orientations
from fingertip.cad.printing.print_files import PrintFiles, make_print_files
from fingertip.cad.shapes.parts import PARTS, parts_by_name, print_scale
from fingertip.cad.verification.assembly import check_assembly, check_joint
from fingertip.cad.verification.bench import check_hand_stub, check_stand
from fingertip.cad.verification.bone import check_air_vent, check_bone, check_strength
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.laid_in import check_laid_in
from fingertip.cad.verification.lying_skin import check_rest_force
from fingertip.cad.verification.mold import check_mold
from fingertip.cad.verification.printing import check_mesh_file, check_overhang, check_print_files
from fingertip.cad.verification.skin import check_pad, check_skin
from fingertip.cad.verification.strength import BoneStrength, assess_strength
from fingertip.catalogues.output_files import PART_FORMATS, part_file
from fingertip.design import Design
from fingertip.design.geometry.solids import scaled
from fingertip.foundation.progress import Work


@dataclass(frozen=True)
class VerifiedParts:
    meshes: Mapping[str, Mesh]
    contents: Mapping[str, bytes]
    """File name -> bytes; no file has been written."""
    prints: PrintFiles
    """Files of the printed parts as they lie on the bed."""
    checks: tuple[Check, ...]
    strength: BoneStrength | None


def check(
    design: Design, *, tolerance_mm: float = 0.01, progress: Callable[[str], None] = lambda message: None
) -> VerifiedParts:
    """Check all parts of a design on meshes, as the command does. Raises DesignError or GeometryError."""
    return verify(design, parts_by_name(design), ("stl",), MeshEvaluator(tolerance_mm), progress)


def verify(
    design: Design,
    parts: Iterable[str],
    formats: Iterable[str],
    evaluator: MeshEvaluator,
    progress: Callable[[str], None] = lambda message: None,
) -> VerifiedParts:
    """Make the mesh files of the parts, read them back, and check parts and assembly. Raises GeometryError."""
    codes = {name: import_module(code) for name in formats if (code := PART_FORMATS[name].code)}
    solids = {name: PARTS[name].solid(design) for name in parts}
    meshes, work = {}, Work("", {**{f"mesh of {name}": 1.0 for name in solids}, "checks": 2.0 * len(solids)}, progress)
    for name, solid in solids.items():
        work.begin(f"mesh of {name}")
        meshes[name] = evaluator.mesh(scaled(solid, print_scale(design, PARTS[name])))
    files = [(part_file(name, each), name, each) for name in meshes for each in codes]
    contents = {file: codes[each].to_bytes(meshes[name], name, PARTS[name].note) for file, name, each in files}
    encoded = {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()} if "3mf" in codes else {}
    prints = make_print_files(design, meshes, encoded, "stl" in codes)
    work.begin("checks")
    checks: list[Check] = []
    for file, name, each in files:
        checks += check_mesh_file(design, PARTS[name], codes[each].from_bytes(contents[file]), each)
    checks += check_print_files(design, meshes, encoded, prints)
    checks += check_assembly(design, evaluator, solids)
    checks += check_parts(design, evaluator, meshes)
    strength = assess_strength(design, evaluator) if "bone" in meshes else None
    checks += check_strength(design, strength) if strength else ()
    return VerifiedParts(meshes, contents, prints, tuple(checks), strength)


def check_parts(design: Design, evaluator: MeshEvaluator, meshes: Mapping[str, Mesh]) -> Iterator[Check]:
    """Check print size, walls, clearances and mold function of those parts that have a mesh in `meshes`."""
    for name, mesh in meshes.items():
        if PARTS[name].is_printed:
            excess = build_volume_excess(design, mesh, print_orientations(design)[name].rotate_x_deg)
            yield Check(f"{name}.build_volume_excess", excess, 0.0, "mm")
            yield check_overhang(design, evaluator, name, mesh)
    if "skin" in meshes:
        yield from check_skin(design, evaluator, meshes["skin"])
        yield check_pad(design)
        if not design.skin.bonded:
            yield check_rest_force(design)
    if "bone" in meshes:
        yield from check_bone(design, evaluator)
    if "bone" in meshes and "skin" in meshes:
        yield check_air_vent(design, evaluator)
        yield from check_laid_in(design, evaluator)
        yield from check_joint(design, evaluator)
        yield from check_hand_stub(design, evaluator) if "hand_stub" in meshes else ()
    if "bone" in meshes and "stand" in meshes:
        yield from check_stand(design, evaluator)
    yield from check_mold(design, evaluator, meshes)
