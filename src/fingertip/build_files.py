"""Build of a design: writes its parts, casting sheet and report to a folder.

The module is not called `build`, because importing a submodule `fingertip.build` would replace the function
`fingertip.build` of the package.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip._version import __version__
from fingertip.cad.files.step_process import BrepMeasurements, StepFiles, StepJob, StepProcess
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.parts import PARTS, Part, parts_by_name, print_scale
from fingertip.cad.verification.assembly import brep_balance_solids, check_brep_assembly
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.part_files import check_brep_solid
from fingertip.cad.verification.verify import validate_tolerance, verify
from fingertip.casting.markdown import render_sheet
from fingertip.casting.materials import find_silicone
from fingertip.casting.quantities import measure_volumes
from fingertip.casting.sheet import casting_sheet_data
from fingertip.design import Design
from fingertip.design.export import to_toml
from fingertip.design.issues import suggest_name
from fingertip.errors import DesignError, Issue
from fingertip.files import atomic_write, round_for_output

FORMATS = ("stl", "3mf", "step")
DESIGN, REPORT, SHEET, ASSEMBLY = "design.toml", "report.json", "casting.md", "assembly.step"
ALL_FILES = (*(f"{part}.{file_format}" for part in PARTS for file_format in FORMATS), ASSEMBLY, SHEET, REPORT, DESIGN)
"""Names of all files that a build may write."""


@dataclass(frozen=True)
class BuiltPart:
    """Part as built: its mesh, its files, and measurements of its B-rep solid."""

    part: Part
    mesh: Mesh
    files: Mapping[str, str]
    """Format -> file name."""
    brep: BrepMeasurements | None
    """Measurements of the B-rep solid; None unless STEP files were made."""


@dataclass(frozen=True)
class Build:
    """Result of a build: all files and all checks."""

    design: Design
    folder: Path
    tolerance_mm: float
    parts: tuple[BuiltPart, ...]
    contents: Mapping[str, bytes]
    """File name -> bytes."""
    checks: tuple[Check, ...]
    casting: Mapping[str, Any] | None
    """Data of the casting sheet, from `casting.sheet.casting_sheet_data`; None unless all parts were built."""
    removed: tuple[str, ...] = ()
    """Files of another design that were removed from the folder."""

    @property
    def passed(self) -> bool:
        """True if every check passed."""
        return all(check.passed for check in self.checks)

    def report(self) -> dict[str, Any]:
        """Return the content of report.json, which depends on the design alone, not on time or machine."""
        report: dict[str, Any] = {
            "fingertip": __version__,
            "design": self.design.name,
            "tolerance_mm": self.tolerance_mm,
            "passed": self.passed,
            "parts": {built.part.name: self._part_entry(built) for built in self.parts},
            "checks": [check.to_dict() for check in self.checks],
        }
        return report | ({"casting": self.casting} if self.casting else {})

    def _part_entry(self, built: BuiltPart) -> dict[str, Any]:
        entry: dict[str, Any] = {
            "volume_mm3": round_for_output(built.mesh.volume()),
            "area_mm2": round_for_output(built.mesh.area()),
            "triangles": len(built.mesh.triangles),
            "files": dict(built.files),
            "sha256": {
                file_format: hashlib.sha256(self.contents[file]).hexdigest()
                for file_format, file in built.files.items()
            },
        }
        if built.brep:
            entry["brep_volume_mm3"] = round_for_output(built.brep.volume_mm3)
        return entry


def build(
    design: Design,
    out: str | Path | None = None,
    *,
    parts: Iterable[str] | None = None,
    formats: Iterable[str] = FORMATS,
    tolerance_mm: float = 0.01,
    material: str = "addition_40a",
    progress: Callable[[str], None] = lambda message: None,
) -> Build:
    """Build parts, check them, and write them with `design.toml`, `casting.md` and `report.json`.

    Only the requested parts and formats are made. cadquery is loaded for "step" only, in a separate process.

    A folder holds the files of one design. If the folder's `design.toml` is that of another design, files that its
    build wrote and this one does not replace are removed at the end.

    Parameters
    ----------
    design
        The fingertip.
    out
        Output folder; `out/<design name>` if None.
    parts
        Names from `PARTS`; all parts of the design if None.
    formats
        Any of "stl", "3mf", "step".
    tolerance_mm
        Largest distance of a facet from the exact surface [mm], 0.0005 to 1.
    material
        Silicone of the casting sheet, a name from `casting.materials`. The sheet is written if all parts are built.
    progress
        Called with a message at each step.

    Raises
    ------
    DesignError
        If a part, format, tolerance, silicone or folder name is not valid.
    MissingLibraryError
        If STEP files are requested and cadquery cannot be loaded.
    GeometryError
        If a kernel rejects a solid. No file has been written then.
    OutputError
        If the folder cannot be written. No file has been written then.
    """
    if out is not None and not str(out).strip():
        message = "is empty; give a folder, such as . for the current one, or omit the option."
        raise DesignError(Issue("--out", message))
    folder = Path("out") / design.name if out is None else Path(out)
    known = tuple(parts_by_name(design))
    names = _select("--parts", known if parts is None else parts, known)
    file_formats = _select("--formats", formats, FORMATS)
    validate_tolerance(tolerance_mm)
    silicone, evaluator = find_silicone(material), MeshEvaluator(tolerance_mm)

    with contextlib.ExitStack() as stack:
        # The B-rep kernel works in a process of its own while this process makes and checks the meshes.
        process = None
        if "step" in file_formats:
            progress("starting the B-rep kernel in a second process")
            solids = tuple((name, PARTS[name].solid(design), PARTS[name].colour) for name in names)
            job = StepJob(design.name, solids, brep_balance_solids(design, names))
            process = stack.enter_context(StepProcess(job))
        verified = verify(design, names, file_formats, evaluator, progress)
        meshes, checks = verified.meshes, list(verified.checks)
        all_built = names == [*known]
        casting = casting_sheet_data(design, measure_volumes(design, evaluator), silicone) if all_built else None
        step = StepFiles({}, {}, {})
        if process:
            progress("waiting for the B-rep kernel")
            step = process.result()
            for name, measured in step.measurements.items():
                scale = print_scale(design, PARTS[name])
                checks += check_brep_solid(design, PARTS[name], meshes[name], measured, scale, tolerance_mm)
            checks += check_brep_assembly(design, step.measurements, step.volumes_mm3)
        contents = dict(verified.contents) | step.contents

    built = tuple(
        BuiltPart(
            PARTS[name],
            meshes[name],
            {file_format: f"{name}.{file_format}" for file_format in file_formats},
            step.measurements.get(name),
        )
        for name in names
    )
    heading = "Design from which these files were built. `fingertip build` accepts this file."
    if casting:
        contents[SHEET] = render_sheet(casting).encode()
    other_files = _files_of_another_design(folder, design)
    removed = tuple(name for name in other_files if name not in (*contents, DESIGN, REPORT))
    result = Build(design, folder, tolerance_mm, built, contents, tuple(checks), casting, removed)
    contents[REPORT] = (json.dumps(result.report(), indent=2) + "\n").encode()
    # The design is written last: until it is replaced, the folder belongs to the other design.
    contents[DESIGN] = to_toml(design, heading).encode()
    atomic_write(folder, contents, removed)
    progress(f"{len(contents)} files in {folder}")
    if removed:
        progress(f"removed files of another design from {folder}: {', '.join(removed)}")
    return result


def _files_of_another_design(folder: Path, design: Design) -> list[str]:
    """List the files in a folder that a build of another design wrote; none if the folder has no `design.toml`."""
    try:
        if not (folder / DESIGN).is_file() or Design.load(folder / DESIGN) == design:
            return []
    except DesignError:
        pass  # the file no longer holds a valid design, so it is not this one
    return [name for name in ALL_FILES if (folder / name).is_file()]


def _select(option: str, requested: Iterable[str], known: tuple[str, ...]) -> list[str]:
    """Return the requested names in the order of `known` and without duplicates."""
    if isinstance(requested, str):
        names = requested.split(",")
        raise DesignError(Issue(option, f"{requested!r} is a single text; give a list, such as {names!r}."))
    selected = set(requested)
    if unknown := sorted(selected - set(known)):
        raise DesignError([Issue(option, _describe_unknown_name(name, known)) for name in unknown])
    if not selected:
        raise DesignError(Issue(option, f"is empty; choose from {', '.join(known)}."))
    return [name for name in known if name in selected]


def _describe_unknown_name(name: str, known: tuple[str, ...]) -> str:
    if name in PARTS:  # only the core is missing from some designs
        return f"this design has no {name!r}, which only a sleeve is cast around; --set mold.method=sleeve."
    return f"{name!r} is not one of the choices; {suggest_name(name, known)}"
