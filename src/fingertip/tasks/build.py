"""Build of a design: writes its parts, casting sheet and report to a folder."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from fingertip.cad.files.cadquery_script import write_script
from fingertip.cad.files.step_process import StepFiles, StepJob, StepProcess
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.settings import FDM, SLA
from fingertip.cad.report import DESIGN_HEADING, Build, BuiltPart
from fingertip.cad.shapes.parts import PARTS, hardware, parts_by_name, print_scale
from fingertip.cad.verification.assembly import brep_balance_solids, check_brep_assembly
from fingertip.cad.verification.printing import check_brep_solid
from fingertip.cad.verification.verify import verify
from fingertip.casting.sheet import casting_sheet
from fingertip.catalogues import output_files
from fingertip.catalogues.output_files import PART_FORMATS, part_file
from fingertip.design import Design
from fingertip.design.files import to_toml
from fingertip.design.parameters.declaration import suggest_name
from fingertip.documents.finger import list_steps, render_sheet
from fingertip.foundation import extras
from fingertip.foundation.errors import DesignError, Issue
from fingertip.foundation.output_set import SetWriter, read_manifest
from fingertip.foundation.processes import in_background
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.pictures.drawing.draw import file_names, render_sheets, sheet_jobs


def build(
    design: Design,
    out: str | Path | None = None,
    *,
    parts: Iterable[str] | None = None,
    formats: Iterable[str] | None = None,
    tolerance_mm: float = 0.01,
    material: str | None = None,
    pictures: bool = False,
    drawings: bool = False,
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
    meanwhile: Callable[[ReportProgress], None] | None = None,
) -> Build:
    """Build parts, check them, and write them with `design.toml`, `casting.md` and `report.json`.

    Only the requested parts and formats are made. Open CASCADE is loaded for "step" only, in a separate process.

    The folder `print/` in it holds each printed part as it lies on the bed (with "stl"), and plates of all printed
    parts (with "3mf", if all are built).

    A folder holds the files of one design. Files that a build of other parameters wrote there, and that nobody changed
    since, are removed. The folder holds either the old files or the new ones at any moment.

    Parameters
    ----------
    design
        The fingertip.
    out
        Output folder; `out/<design name>` if None.
    parts
        Names from `PARTS`; all parts of the design if None.
    formats
        Any of "stl", "3mf", "step" and "cq", a CadQuery script; `find_formats` if None.
    tolerance_mm
        Largest distance of a facet from the exact surface [mm], 0.0005 to 1.
    material
        Silicone of the casting sheet, a name from `fingertip.catalogues.silicones` or "own"; the design's
        silicone.product if None. The sheet is written if all parts are built.
    pictures
        Whether a picture of each casting step is drawn, for the casting sheet.
    drawings
        Whether the drawings are made too, beside the STEP files of all parts.
    force
        Whether files may be overwritten that no build wrote, or that were changed since.
    progress
        Called with a message at each step.
    meanwhile
        Called once before anything is written, while the B-rep kernel works, with a function that takes its progress.
        An error that it raises ends the build.

    Raises
    ------
    DesignError
        If a part, format, tolerance, silicone or folder name is not valid.
    MissingLibraryError
        If STEP files are requested and Open CASCADE cannot be loaded.
    GeometryError
        If a kernel rejects a solid. No file has been written then.
    OutputError
        If the folder cannot be written, or holds a file of these names that is somebody's own. No file has been
        written then.
    """
    folder = output_files.PART_FILES.folder(design, out)
    known = tuple(parts_by_name(design))
    names = select_names("--parts", known if parts is None else parts, known)
    file_formats = select_names(
        "--formats", find_formats(progress) if formats is None else formats, tuple(PART_FORMATS)
    )
    if "step" in file_formats:
        extras.require("--formats", "OCP", subject="step", alternative="leave step out with --formats stl,3mf")
    design, evaluator, all_built = design.with_silicone(material), MeshEvaluator(tolerance_mm), names == [*known]
    writer = output_files.PART_FILES.writer(design, folder, force)
    writer.check([*_file_names(names, file_formats, all_built), *(file_names(design) if drawings else ())])
    print_writer = output_files.PRINTS.writer(design, folder / output_files.PRINT_FOLDER, force, folder)
    print_writer.check(_print_names(names, file_formats, all_built))
    picture_writer = output_files.STEPS.writer(design, folder / output_files.STEPS_FOLDER, force, folder)
    picture_writer.check(())

    stages = {
        "parts": 2.0, "rest": 3.0 * (meanwhile is not None),
        "pictures": 1.0 * pictures, "STEP files": (4.0 + 6.0 * drawings) * ("step" in file_formats),
    }  # fmt: skip
    work = Work("", stages, progress)

    with contextlib.ExitStack() as stack:
        # The B-rep kernel and the pictures have processes of their own while this process makes and checks the meshes.
        process = None
        if "step" in file_formats:
            solids = tuple((name, PARTS[name].solid(design), PARTS[name].colour) for name in names)
            bought = tuple((item.name, item.solid, item.colour) for item in hardware(design, names))
            tools = tuple(name for name in names if PARTS[name].is_tool)
            balance, sheets = brep_balance_solids(design, names), sheet_jobs(design) if drawings else ()
            job = StepJob(design.name, solids, balance, bought, tools, sheets)
            process = stack.enter_context(StepProcess.start(job))
        drawing: Callable[[], dict[str, bytes]] = dict
        if pictures and all_built:
            drawing = stack.enter_context(in_background(_draw_steps, design, tolerance_mm))
        verified = verify(design, names, file_formats, evaluator, work.within("parts"))
        meshes, checks, strength = verified.meshes, list(verified.checks), verified.strength
        casting = None
        if all_built:
            casting = casting_sheet(design, evaluator)
        if meanwhile:
            meanwhile(work.within("rest"))
        work.begin("pictures")
        steps_drawn = drawing()
        step = StepFiles({}, {}, {}, {})
        if process:
            work.begin("STEP files")
            step = process.result(advance=work.advance)
            for name, measured in step.measurements.items():
                scale = print_scale(design, PARTS[name])
                checks += check_brep_solid(design, PARTS[name], meshes[name], measured, scale, tolerance_mm)
            checks += check_brep_assembly(design, step.measurements, step.volumes_mm3)
        contents = dict(verified.contents) | step.contents
        if drawings:
            contents |= render_sheets(design, step.also)
    if "cq" in file_formats:
        contents |= {part_file(name, "cq"): write_script(design, name) for name in names}

    files = {name: {file_format: part_file(name, file_format) for file_format in file_formats} for name in names}
    built = tuple(BuiltPart(PARTS[n], meshes[n], files[n], step.measurements.get(n)) for n in names)
    if casting:
        pictures_of_steps = [f"{output_files.STEPS_FOLDER}/{name}" for name in steps_drawn]
        contents[output_files.SHEET] = render_sheet(casting, pictures_of_steps).encode()
    prints = verified.prints
    result = Build(design, folder, tolerance_mm, built, contents, prints, tuple(checks), strength, casting)
    contents[output_files.REPORT] = (json.dumps(result.report(), indent=2) + "\n").encode()
    contents[output_files.DESIGN] = to_toml(design, DESIGN_HEADING).encode()
    print_writer.check(prints.contents)
    picture_writer.check(steps_drawn)
    removed = writer.write(contents)
    removed += _replace_subset(print_writer, prints.contents, ".3mf" if prints.plates else None)
    removed += _replace_subset(picture_writer, steps_drawn, ".png")
    if removed:
        progress(f"removed files of another design from {folder}: {', '.join(removed)}")
    return replace(result, removed=removed)


def _replace_subset(writer: SetWriter, contents: Mapping[str, bytes], obsolete: str | None) -> tuple[str, ...]:
    """Write a set below the parts, without older files ending with `obsolete`; return what was removed."""
    old = read_manifest(writer.folder, writer.top)
    if not contents and (old is None or old.parameters == writer.parameters):
        return ()
    unwanted = [name for name in old.files if name.endswith(obsolete)] if old and obsolete else []
    removed = writer.write(contents, unwanted)
    return tuple(f"{writer.folder.name}/{name}" for name in removed)


def _draw_steps(design: Design, tolerance_mm: float) -> dict[str, bytes]:
    from fingertip.pictures.steps.scenes import draw_steps  # noqa: PLC0415

    sheet = casting_sheet(design, MeshEvaluator(tolerance_mm))
    return draw_steps(design, sheet, [step.picture for step in list_steps(sheet)])


def _file_names(parts: Iterable[str], formats: Iterable[str], is_whole: bool) -> list[str]:
    names = [part_file(part, file_format) for part in parts for file_format in formats]
    names += [output_files.ASSEMBLY] if "step" in formats else []
    return [*names, *([output_files.SHEET] if is_whole else []), output_files.REPORT, output_files.DESIGN]


def _print_names(parts: Iterable[str], formats: Iterable[str], is_whole: bool) -> list[str]:
    """Names of the files for the printer that a build writes if it needs one plate, for either printer."""
    names = [f"{part}.stl" for part in parts if PARTS[part].is_printed] if "stl" in formats else []
    plates = [name for kind in (FDM, SLA) for name in kind.file_names(1)]
    return [*names, *(plates if "3mf" in formats and is_whole else [])]


def find_formats(progress: Callable[[str], None] = lambda message: None) -> tuple[str, ...]:
    """Return the formats of a build that names none: STL and 3MF, and STEP where its kernel is installed."""
    if extras.is_installed("OCP"):
        return output_files.default_formats()
    extras.say_left_out({"OCP": "STEP files and checks against exact solids"}, progress)
    return tuple(name for name in output_files.default_formats() if name != "step")


def select_names(option: str, requested: Iterable[str], known: tuple[str, ...]) -> list[str]:
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
    if name in PARTS:  # a stand, or the hand's part of a joint
        return f"this design has no {name!r}."
    return f"{name!r} is not one of the choices; {suggest_name(name, known)}"
