"""Build of a design: writes its parts, casting sheet and report to a folder."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from fingertip.cad.build_result import DESIGN_HEADING, Build, BuiltPart
from fingertip.cad.files.cadquery_scripts import write_models, write_scripts
from fingertip.cad.files.part_formats import PART_FORMATS, default_formats, part_file
from fingertip.cad.files.step_process import StepFiles, StepJob, StepProcess
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.parts import exact_parts
from fingertip.cad.printing.settings import FDM, SLA
from fingertip.cad.program import digest_program
from fingertip.cad.verification.assembly import brep_balance_solids, check_brep_assembly
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.printing import check_brep_solid
from fingertip.cad.verification.second_opinion import list_packages, second_opinions
from fingertip.cad.verification.verify import VerifiedParts, verify
from fingertip.casting.sheet import casting_sheet
from fingertip.catalogues import output_files
from fingertip.design import Design
from fingertip.design.design_file import to_toml
from fingertip.design.parameters.declaration import suggest_name
from fingertip.documents.finger_sheets import list_steps, render_sheet
from fingertip.foundation import extras
from fingertip.foundation.errors import DesignError, Issue, raise_issues
from fingertip.foundation.output_set import SetWriter, read_manifest
from fingertip.foundation.progress import Work
from fingertip.foundation.workers import in_background
from fingertip.models.hardware import hardware
from fingertip.models.parts import PARTS, parts_by_name, print_scale
from fingertip.pictures.drawing.draw import file_names, render_sheets, sheet_jobs


@dataclass(frozen=True)
class BuildOptions:
    """Arguments of `build`: what it makes."""

    parts: Iterable[str] | None = None
    formats: Iterable[str] | None = None
    tolerance_mm: float = 0.01
    material: str | None = None
    pictures: bool = False
    drawings: bool = False
    force: bool = False
    verify: bool = False


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
    verify: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> Build:
    """Build parts, check them, and write them with `design.toml`, `casting.md` and `report.json`.

    Only the requested parts and formats are made. Open CASCADE is loaded for "step" only, in a
    separate process.

    The folder `print/` in it holds each printed part as it lies on the bed (with "stl"), and plates
    of all printed parts (with "3mf", if all are built).

    A folder holds the files of one design. Files that a build of other parameters wrote there, and
    that nobody changed since, are removed. The folder holds either the old files or the new ones at
    any moment.

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
        Silicone of the casting sheet, a name from `fingertip.catalogues.materials` or "own"; the
        design's silicone.product if None. The sheet is written if all parts are built.
    pictures
        Whether a picture of each casting step is drawn, for the casting sheet.
    drawings
        Whether the drawings are made too, beside the STEP files of all parts.
    force
        Whether files may be overwritten that no build wrote, or that were changed since.
    verify
        Whether trimesh reads each STL and 3MF file too, as a second opinion in the report, in a
        process of its own.
    progress
        Called with a message at each step.

    Raises DesignError if a part, format, tolerance, silicone or folder name is not valid,
    MissingLibraryError if STEP files are requested and Open CASCADE cannot be loaded, GeometryError
    if a kernel rejects a solid, and OutputError if the folder cannot be written, or holds a file of
    these names that is somebody's own. No file has been written then.
    """
    options = BuildOptions(
        parts=parts,
        formats=formats,
        tolerance_mm=tolerance_mm,
        material=material,
        pictures=pictures,
        drawings=drawings,
        force=force,
        verify=verify,
    )
    return run_build(plan_build(design, out, options, progress), progress)


@dataclass(frozen=True)
class BuildPlan:
    """Build of a design whose folder can take it."""

    design: Design
    names: tuple[str, ...]
    """Parts to make."""
    formats: tuple[str, ...]
    options: BuildOptions
    evaluator: MeshEvaluator
    is_whole: bool
    """True if all parts of the design are made."""
    parts: SetWriter
    prints: SetWriter
    pictures: SetWriter
    models: SetWriter

    @property
    def exact(self) -> tuple[str, ...]:
        """Parts with a STEP file."""
        return exact_parts(self.design, self.names) if "step" in self.formats else ()

    def formats_of(self, part: str) -> Iterator[str]:
        """Yield the formats of a part; "step" is not one of every part."""
        return (name for name in self.formats if name != "step" or part in self.exact)


def plan_build(
    design: Design,
    out: str | Path | None,
    options: BuildOptions,
    progress: Callable[[str], None] = lambda message: None,
) -> BuildPlan:
    """Plan a build, and refuse what it or its folder cannot take, as `build` does."""
    folder = output_files.PART_FILES.folder(design, out)
    all_parts = tuple(parts_by_name(design))
    parts = all_parts if options.parts is None else options.parts
    names = select_names("--parts", parts, all_parts)
    requested = find_formats(progress) if options.formats is None else options.formats
    formats = select_names("--formats", requested, tuple(PART_FORMATS))

    if "step" in formats:
        extras.require(
            "--formats",
            "cadquery",
            subject="step",
            alternative="leave step out with --formats stl,3mf",
        )
    if options.verify:
        extras.require("--verify", *list_packages(formats), alternative="leave it out")
    if "cq" in formats and "bone" in names and design.bone.interface == "file":
        raise DesignError(
            Issue("--formats", "cq cannot hold the adapter of bone.adapter_file; leave cq out.")
        )
    if "step" in formats and exact_parts(design, names) != names:
        progress(
            "left out: bone.step, and the bone in drawing and assembly; its adapter is an STL file"
        )

    design = design.with_silicone(options.material)
    evaluator = MeshEvaluator(options.tolerance_mm)
    force = options.force
    plan = BuildPlan(
        design=design,
        names=names,
        formats=formats,
        options=options,
        evaluator=evaluator,
        is_whole=names == all_parts,
        parts=output_files.PART_FILES.writer(design, folder, force),
        prints=output_files.PRINTS.writer(
            design, folder / output_files.PRINT_FOLDER, force, folder
        ),
        pictures=output_files.STEPS.writer(
            design, folder / output_files.STEPS_FOLDER, force, folder
        ),
        models=output_files.MODELS.writer(
            design, folder / output_files.MODELS_FOLDER, force, folder
        ),
    )
    plan.parts.check([*_name_files(plan), *(file_names(design) if options.drawings else ())])
    plan.prints.check(_name_prints(plan))
    plan.pictures.check(())
    plan.models.check(())

    return plan


def run_build(plan: BuildPlan, progress: Callable[[str], None]) -> Build:
    """Make, check and write what a plan states."""
    stages = {
        "parts": 2.0,
        "pictures": 1.0 * plan.options.pictures,
        "STEP files": (2.0 + 3.0 * plan.options.drawings) * bool(plan.exact),
        "second opinion": 0.5 * plan.options.verify,
    }
    work = Work("", stages, progress)

    # The B-rep kernel and the pictures have processes of their own while this process makes and
    # checks the meshes.
    with start_step_files(plan) as receive_step, start_pictures(plan) as receive_pictures:
        verified = verify(
            plan.design,
            parts=plan.names,
            formats=plan.formats,
            evaluator=plan.evaluator,
            progress=work.within("parts"),
        )
        opinions: Callable[[], tuple[Check, ...]] = tuple
        with contextlib.ExitStack() as stack:
            if plan.options.verify:
                opinions = stack.enter_context(
                    in_background(second_opinions, dict(verified.contents), dict(verified.meshes))
                )

            work.begin("pictures")
            pictures = receive_pictures()
            work.begin("STEP files")
            step = receive_step(work.advance)
            work.begin("second opinion")
            verified = replace(verified, opinions=opinions())

    result = add_step_files(plan, collect(plan, verified, pictures), step)
    return write_build(plan, result, pictures, progress)


@contextlib.contextmanager
def start_step_files(
    plan: BuildPlan,
) -> Iterator[Callable[[Callable[[float], None]], StepFiles | None]]:
    """Start to make the STEP files of a plan in another process, which ends with this block.

    The block gets a function that waits for them, and takes one that is told the share that is
    done. It returns None if the plan has none.
    """
    if not plan.exact:
        yield lambda advance: None
        return

    with StepProcess.start(_describe_step_job(plan)) as process:
        yield lambda advance: process.result(advance=advance)


@contextlib.contextmanager
def start_pictures(plan: BuildPlan) -> Iterator[Callable[[], dict[str, bytes]]]:
    """Start to draw the casting steps in another process, which ends with this block.

    The block gets a function that waits for the pictures: file name -> PNG, empty if the plan has
    none.
    """
    if not plan.options.pictures or not plan.is_whole:
        yield dict
        return

    with in_background(_draw_steps, plan.design, plan.options.tolerance_mm) as receive:
        yield receive


def _describe_step_job(plan: BuildPlan) -> StepJob:
    design = plan.design
    names = plan.exact
    solids = tuple((name, PARTS[name].solid(design), PARTS[name].colour) for name in names)
    bought = tuple((item.name, item.solid, item.colour) for item in hardware(design, names))
    tools = tuple(name for name in names if PARTS[name].is_tool)
    sheets = sheet_jobs(design) if plan.options.drawings else ()

    return StepJob(
        title=design.name,
        parts=solids,
        measured_solids=brep_balance_solids(design, names),
        hardware=bought,
        tools=tools,
        also=sheets,
    )


def collect(plan: BuildPlan, verified: VerifiedParts, pictures: Iterable[str]) -> Build:
    """Collect the files and checks of the meshes, and report on them.

    `pictures` are the names of those of the casting steps.
    """
    design = plan.design
    failed = [opinion for opinion in verified.opinions if not opinion.passed]
    contents = dict(verified.contents)
    if "cq" in plan.formats:
        contents |= write_scripts(design, plan.names)

    casting = casting_sheet(design, plan.evaluator) if plan.is_whole else None
    if casting:
        picture_files = [f"{output_files.STEPS_FOLDER}/{name}" for name in pictures]
        contents[output_files.SHEET] = render_sheet(casting, picture_files).encode()

    built = []
    for name in plan.names:
        formats = (each for each in plan.formats if each != "step")
        files = {file_format: part_file(name, file_format) for file_format in formats}
        built.append(BuiltPart(PARTS[name], verified.meshes[name], files, None))

    result = Build(
        design=design,
        folder=plan.parts.folder,
        tolerance_mm=plan.options.tolerance_mm,
        parts=tuple(built),
        contents=contents | copy_design(design, output_files.DESIGN, DESIGN_HEADING),
        prints=verified.prints,
        checks=(*verified.checks, *failed),
        strength=verified.strength,
        casting=casting,
        opinions=verified.opinions,
    )
    return _report(result)


def add_step_files(plan: BuildPlan, result: Build, step: StepFiles | None) -> Build:
    """Add STEP files and drawings, and the checks of the exact solids, and report on all."""
    if step is None:
        return result

    design = plan.design
    checks = list(result.checks)
    built = []
    for part in result.parts:
        name = part.part.name
        measured = step.measurements.get(name)
        if measured is None:
            built.append(part)
            continue

        files = {each: part_file(name, each) for each in plan.formats_of(name)}
        built.append(replace(part, files=files, brep=measured))
        checks += check_brep_solid(
            design,
            part=part.part,
            mesh=part.mesh,
            measured=measured,
            scale=print_scale(design, part.part),
            tolerance_mm=plan.options.tolerance_mm,
        )

    checks += check_brep_assembly(design, step.measurements, step.volumes_mm3)
    contents = dict(result.contents) | step.contents
    if plan.options.drawings:
        contents |= render_sheets(design, step.also)

    return _report(replace(result, parts=tuple(built), contents=contents, checks=tuple(checks)))


def _report(result: Build) -> Build:
    """Write the report of a build into its files."""
    text = json.dumps(result.report(), indent=2) + "\n"
    return replace(result, contents={**result.contents, output_files.REPORT: text.encode()})


def copy_design(design: Design, name: str, heading: str) -> dict[str, bytes]:
    """Write a design as a file of this name, with its adapter beside it."""
    if design.bone.interface != "file":
        return {name: to_toml(design, heading).encode()}

    body = design.read_adapter()
    beside = f"adapter{'.step' if body.brep else '.stl'}"
    copy = design.with_values({"bone.adapter_file": beside})
    return {name: to_toml(copy, heading).encode(), beside: body.data}


def write_build(
    plan: BuildPlan, result: Build, pictures: Mapping[str, bytes], progress: Callable[[str], None]
) -> Build:
    """Write the sets, and remove what is of another design."""
    prints = result.prints
    models = write_models() if "cq" in plan.formats else {}
    plan.prints.check(prints.contents)
    plan.pictures.check(pictures)
    plan.models.check(models)
    removed = _record_program(plan.parts, result.contents).write(result.contents)
    removed += _replace_subset(plan.prints, prints.contents, ".3mf" if prints.plates else None)
    removed += _replace_subset(plan.pictures, pictures, ".png")
    removed += _replace_subset(plan.models, models, None)
    if removed:
        progress(f"removed files of another design from {plan.parts.folder}: {', '.join(removed)}")

    return replace(result, removed=removed)


def _record_program(writer: SetWriter, contents: Mapping[str, bytes]) -> SetWriter:
    """Record the program in a set, unless a mesh of another version stays in it."""
    old = read_manifest(writer.folder)
    if old and old.parameters == writer.parameters and old.program != digest_program():
        remaining = set(old.files) - set(contents)
        if any(name.endswith((".stl", ".3mf")) for name in remaining):
            return writer

    return replace(writer, program=digest_program())


def _replace_subset(
    writer: SetWriter, contents: Mapping[str, bytes], obsolete: str | None
) -> tuple[str, ...]:
    """Write a set below the parts, without obsolete files; return what was removed."""
    old = read_manifest(writer.folder, writer.top)
    if not contents and (old is None or old.parameters == writer.parameters):
        return ()

    unwanted = []
    if old and obsolete:
        unwanted = [name for name in old.files if name.endswith(obsolete)]

    removed = writer.write(contents, unwanted)
    return tuple(f"{writer.folder.name}/{name}" for name in removed)


def _draw_steps(design: Design, tolerance_mm: float) -> dict[str, bytes]:
    from fingertip.pictures.casting_scenes import draw_steps  # noqa: PLC0415

    sheet = casting_sheet(design, MeshEvaluator(tolerance_mm))
    return draw_steps(design, sheet, [step.picture for step in list_steps(sheet)])


def _name_files(plan: BuildPlan) -> list[str]:
    names = list[str]()
    for part in plan.names:
        names += [part_file(part, file_format) for file_format in plan.formats_of(part)]
    if "cq" in plan.formats:
        names.append(output_files.PARAMETERS)
    if plan.exact:
        names.append(output_files.ASSEMBLY)
    if plan.is_whole:
        names.append(output_files.SHEET)

    return [*names, output_files.REPORT, *copy_design(plan.design, output_files.DESIGN, "")]


def _name_prints(plan: BuildPlan) -> list[str]:
    """Return the names of the printer's files for one plate, for either printer."""
    names = list[str]()
    if "stl" in plan.formats:
        names += [f"{part}.stl" for part in plan.names if PARTS[part].is_printed]
    if "3mf" in plan.formats and plan.is_whole:
        names += [*FDM.file_names(1), *SLA.file_names(1)]

    return names


def find_formats(progress: Callable[[str], None] = lambda message: None) -> tuple[str, ...]:
    """Return the default formats: STL and 3MF, and STEP if its kernel is installed."""
    if extras.is_installed("cadquery"):
        return default_formats()

    extras.say_left_out({"cadquery": "STEP files and checks against exact solids"}, progress)
    return tuple(name for name in default_formats() if name != "step")


def select_names(option: str, requested: Iterable[str], known: tuple[str, ...]) -> tuple[str, ...]:
    """Return the requested names in the order of `known` and without duplicates."""
    if isinstance(requested, str):
        names = requested.split(",")
        raise DesignError(
            Issue(option, f"{requested!r} is a single text; give a list, such as {names!r}.")
        )

    selected = set(requested)
    issues = []
    for name in sorted(selected - set(known)):
        is_of_others = name in PARTS  # a stand, or the hand's part of a joint
        message = f"{name!r} is not one of the choices; {suggest_name(name, known)}"
        issues.append(Issue(option, f"this design has no {name!r}." if is_of_others else message))

    raise_issues(DesignError, issues)
    if not selected:
        raise DesignError(Issue(option, f"is empty; choose from {', '.join(known)}."))

    return tuple(name for name in known if name in selected)
