"""Files of the fit coupon: both pieces, a template for the readings, a page that says how to use them, and a plan."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.files.step_process import StepFiles, StepJob, StepProcess
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.orientations import build_volume_excess
from fingertip.cad.report import FORMATS
from fingertip.cad.shapes.coupon import COUPON_PARTS
from fingertip.cad.shapes.parts import print_scale
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.printing import check_brep_solid, check_mesh_file
from fingertip.cad.verification.verify import MESH_FORMATS
from fingertip.calibration.readings import identify_coupon, list_lengths, write_template
from fingertip.catalogues.output_files import COUPON, COUPON_READINGS, COUPON_SHEET, PLAN, SHEET
from fingertip.design import Design
from fingertip.design.geometry.solids import scaled
from fingertip.documents.coupon import render_instructions
from fingertip.foundation import extras
from fingertip.foundation.errors import DesignError, Issue
from fingertip.foundation.files import round_for_output
from fingertip.foundation.progress import Work
from fingertip.pictures.coupon_plan import draw_plan
from fingertip.tasks.build import select_names


@dataclass(frozen=True)
class Coupon:
    """Coupon of a design: its files, and the checks made on them."""

    design: Design
    folder: Path
    meshes: Mapping[str, Mesh]
    contents: Mapping[str, bytes]
    """File name -> bytes."""
    checks: tuple[Check, ...]

    @property
    def passed(self) -> bool:
        return all(check.passed for check in self.checks)

    def data(self) -> dict[str, Any]:
        return {
            "design": self.design.name,
            "coupon": identify_coupon(self.design),
            "passed": self.passed,
            "folder": str(self.folder),
            "files": list(self.contents),
            "volumes_mm3": {name: round_for_output(mesh.volume()) for name, mesh in self.meshes.items()},
            "lengths_mm": {length.name: length.nominal_mm for length in list_lengths(self.design)},
            "checks": [check.to_dict() for check in self.checks],
        }


def write_coupon(
    design: Design,
    out: str | Path | None = None,
    *,
    formats: Iterable[str] = ("stl", "3mf"),
    tolerance_mm: float = 0.01,
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> Coupon:
    """Write a coupon. Raises DesignError or GeometryError or MissingLibraryError or OutputError."""
    if design.mold.method == "plunge":
        message = f"needs no coupon: print the parts, and take the one reading that {SHEET} asks for."
        raise DesignError(Issue(design.name, message))
    folder = COUPON.folder(design, out)
    file_formats = select_names("--formats", formats, FORMATS)
    if "step" in file_formats:
        extras.require("--formats", "OCP", subject="step", alternative="leave step out with --formats stl,3mf")
    writer = COUPON.writer(design, folder, force)
    names = [f"{part}.{file_format}" for part in COUPON_PARTS for file_format in file_formats]
    writer.check([*names, COUPON_READINGS, COUPON_SHEET, PLAN])
    coupon = make_coupon(design, folder, file_formats, tolerance_mm, progress)
    writer.write(coupon.contents)
    return coupon


def make_coupon(
    design: Design, folder: Path, formats: Sequence[str], tolerance_mm: float, progress: Callable[[str], None]
) -> Coupon:
    """Make all files of the coupon in memory, read the meshes back and check them."""
    solids = {name: part.solid(design) for name, part in COUPON_PARTS.items()}
    evaluator, contents, checks = MeshEvaluator(tolerance_mm), {}, []
    with contextlib.ExitStack() as stack:
        process = None
        if "step" in formats:
            parts = tuple((name, solid, COUPON_PARTS[name].colour) for name, solid in solids.items())
            process = stack.enter_context(StepProcess.start(StepJob(f"{design.name}_coupon", parts)))
        meshes = {}
        work = Work("", dict.fromkeys((*solids, "STEP files", "plan view"), 1.0), progress)
        for name, solid in solids.items():
            work.begin(name)
            meshes[name] = evaluator.mesh(scaled(solid, print_scale(design, COUPON_PARTS[name])))
            checks.append(Check(f"{name}.build_volume_excess", build_volume_excess(design, meshes[name]), 0.0, "mm"))
            for file_format in (each for each in formats if each in MESH_FORMATS):
                data = MESH_FORMATS[file_format].to_bytes(meshes[name], name)
                contents[f"{name}.{file_format}"] = data
                read = MESH_FORMATS[file_format].from_bytes(data)
                checks += check_mesh_file(design, COUPON_PARTS[name], read, file_format)
        step = StepFiles({}, {}, {}, {})
        if process:
            work.begin("STEP files")
            step = process.result(advance=work.advance)
    for name, measured in step.measurements.items():
        part = COUPON_PARTS[name]
        checks += check_brep_solid(design, part, meshes[name], measured, print_scale(design, part), tolerance_mm)
        contents[f"{name}.step"] = step.contents[f"{name}.step"]
    contents[COUPON_READINGS] = write_template(design).encode()
    contents[COUPON_SHEET] = render_instructions(design, COUPON_READINGS).encode()
    work.begin("plan view")
    contents[PLAN] = draw_plan(design, meshes)
    return Coupon(design, folder, meshes, contents, tuple(checks))
