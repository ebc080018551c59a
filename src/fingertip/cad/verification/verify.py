"""Every check of a design, run on the bytes its files would hold.

`fingertip build` writes these files; `fingertip check` only verifies them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from fingertip.cad.files import threemf
from fingertip.cad.files.part_formats import PART_FORMATS, part_file
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.print_files import PrintFiles, make_print_files
from fingertip.cad.verification import assembly, bone, joint, mold, printing, skin
from fingertip.cad.verification.check import Check, RegisteredCheck, Solids
from fingertip.cad.verification.printing import check_mesh_file, check_print_files
from fingertip.cad.verification.strength import BoneStrength
from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit
from fingertip.design.rules.ruleset import SLACK, RuleChecker
from fingertip.design.search import RULES
from fingertip.foundation.errors import FingertipError, Issue
from fingertip.foundation.extras import call_plugins
from fingertip.foundation.progress import Work
from fingertip.foundation.validation import Comparison, Relation
from fingertip.models.parts import PARTS, parts_by_name

CHECKS: tuple[RegisteredCheck, ...] = (
    *assembly.CHECKS,
    *printing.CHECKS,
    *skin.CHECKS,
    *bone.CHECKS,
    *joint.CHECKS,
    *mold.CHECKS,
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
    meshes = {}
    work = Work("", stages, progress)

    for name in solids.parts:
        work.begin(f"mesh of {name}")
        meshes[name] = solids.mesh(name)

    files = []
    for name in meshes:
        files += [(part_file(name, code), name, code) for code in mesh_formats]

    contents = {
        file: mesh_formats[file_format].to_bytes(meshes[name], name, PARTS[name].note)
        for file, name, file_format in files
    }
    encoded = {}
    if "3mf" in mesh_formats:
        encoded = {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()}

    prints = make_print_files(design, meshes, encoded, "stl" in mesh_formats)
    work.begin("checks")
    checks: list[Check] = []
    for file, name, file_format in files:
        checks += check_mesh_file(
            design, PARTS[name], mesh_formats[file_format].from_bytes(contents[file]), file_format
        )

    checks += check_print_files(design, meshes, encoded, prints)
    checks += run_checks(design, solids)
    return VerifiedParts(
        meshes=meshes,
        contents=contents,
        prints=prints,
        checks=tuple(checks),
        strength=solids.strength if "bone" in meshes else None,
    )


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
                f"{check!r} is no Check with a name of its own; correct or remove the "
                "package that brings it."
            )
            raise FingertipError(Issue("fingertip.checks", message))

        names.add(check.name)
        yield check


def list_causes(check: str) -> tuple[str, ...]:
    """List the parameters behind a check, by its name.

    There are none if its failure would be a fault of the program.
    """
    return next(filter(None, (registered.find_change(check) for registered in CHECKS)), ())


# Margins of a design: how near its checks and its rules are to their limits.

_TRIED: tuple[tuple[float, Relation], ...] = ((0.7, "at least"), (1.3, "at most"))
"""Shares of a value at which its rules are asked for their limits: what passes there too is not
near.
"""

_CHOSEN = 1e-4
"""Margin below which a value stands at a limit of a rule because it was chosen there [%]."""


def list_margins(design: Design, checks: Iterable[Check]) -> list[Comparison]:
    """List the checks and the rules of a design that compare a number with a limit, the nearest to
    it first.
    """
    limits = (
        comparison
        for comparison in _list_limits(design)
        if abs(comparison.margin_percent) > _CHOSEN
    )
    compared = (
        comparison for comparison in (*checks, *limits) if comparison.margin_percent < math.inf
    )
    return sorted(compared, key=lambda comparison: comparison.margin_percent)


def _list_limits(design: Design) -> Iterator[Comparison]:
    """List the limits that rules set to a length or the like while all others stay, as far as they
    are near it.
    """
    for name in dict.fromkeys(
        rule.field for rule in RULES if isinstance(design.value(rule.field), float)
    ):
        value = design.value(name)
        unit = find_unit(PARAMETERS[name])
        bounds = find_bounds(PARAMETERS[name])

        for share, relation in _TRIED:
            tried = design.with_values({name: share * value})
            if not bounds.contain(share * value):
                tried = design.with_values(
                    {name: bounds.minimum if share < 1.0 else bounds.maximum}
                )

            for broken in RuleChecker(tried).find_broken(
                rule for rule in RULES if rule.field == name
            ):
                label = f"{name}: {broken.rule.check.__name__.replace('_', ' ')}"
                for low, high in broken.violation.passing:
                    if low - SLACK <= value <= high + SLACK:
                        yield Comparison(
                            name=label,
                            value=value,
                            limit=low if share < 1.0 else high,
                            unit=unit,
                            relation=relation,
                        )
