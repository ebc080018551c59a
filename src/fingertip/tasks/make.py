"""All outputs of a design: parts, drawings, board, and a simulated trial with its slip.

The parts stand at the top of the folder, as `build` writes them, with pictures of the casting steps
in `steps/`, and the drawings and the acceptance sheet beside them. The board is in `board/`, the
trial in `signal/`. Each is a set of its own. A design without a board has the sketch for its
controller in `firmware/`.

What you need to print, cast and wire is written first, with the page. STEP files and drawings take
longer: a process beside makes them meanwhile, and they are added at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from fingertip.cad.build_result import Build
from fingertip.cad.files.step_process import StepFiles
from fingertip.cad.verification.verify import verify
from fingertip.catalogues import output_files
from fingertip.design import Design
from fingertip.detection.recordings import FileDetection, detect_file
from fingertip.documents.acceptance import acceptance_sheet, render_acceptance
from fingertip.foundation import extras
from fingertip.foundation.files import encode_json, temporary_folder
from fingertip.foundation.output_set import SetWriter
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.foundation.workers import in_background
from fingertip.page.pad_section import render_pad
from fingertip.page.page import Prepared, prepare_page
from fingertip.page.svg import write_svg
from fingertip.page.trial_section import draw_whole, render_detection
from fingertip.pictures.drawing.draw import file_names
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.simulation import load_simulation
from fingertip.sim.trace_file import encode_trace
from fingertip.slip.detection_results import as_data
from fingertip.slip.detectors.registry import find_second_column
from fingertip.tasks.board_files import BRING_UP_FILES, BoardPlan, plan_board
from fingertip.tasks.build import (
    BuildOptions,
    BuildPlan,
    add_step_files,
    collect,
    find_formats,
    plan_build,
    start_pictures,
    start_step_files,
    write_build,
)
from fingertip.tasks.firmware_files import plan_firmware
from fingertip.tasks.views import write_page


@dataclass(frozen=True)
class Made:
    """Result of `make`."""

    parts: Build
    drawings: tuple[Path, ...]
    """Dimensioned drawings; none if no STEP files were asked for, whose kernel they need."""
    board: tuple[Path, ...]
    signal: tuple[Path, ...]
    """Files of the simulated trial."""
    firmware: tuple[Path, ...]
    """Sketch for a controller; none of a design with a board, which may be read without one."""
    detection: FileDetection
    """Slip that was detected in the trial."""
    page: Path | None
    """Page that shows all of it; None if the parts have no STL files."""


def make(
    design: Design,
    out: str | Path | None = None,
    *,
    formats: Iterable[str] | None = None,
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
    when_usable: Callable[[Made], None] = lambda made: None,
) -> Made:
    """Make parts, drawings, board or sketch, a simulated trial and its detection, in one folder.

    The folder is `out/NAME` by default; `formats` are those of the parts, as for `build`. With
    `force`, files may be overwritten that this function did not write, or that were changed since.
    `progress` is called with a message at each step. `when_usable` is called when all is written
    but STEP files and drawings, if they are still to come.

    Raises as `build`, `write_board`, `simulate` and `detect_file` do. Nothing has been written
    then; or, where the B-rep kernel fails, all but STEP files and drawings.
    """
    folder = output_files.PART_FILES.folder(design, out)
    requested = None if formats is None else tuple(formats)
    plan = _plan(design, folder, find_formats() if requested is None else requested, force)
    stages = {"parts": 4.0, "page": 0.5, "STEP files": 5.0 * plan.has_exact}
    work = Work(design.name, stages, progress)

    with start_step_files(plan.build) as receive_step:
        first = _make_first(plan, work.within("parts"))
        made = _write_first(plan, first, progress)
        work.begin("page")
        made = _write_page(plan, made, first)

        if not plan.has_page:
            progress(
                f"{output_files.PAGE} is left out: it shows the STL files; add stl to the formats"
            )
        if requested is None or "step" in requested:
            extras.say_left_out({"cadquery": "STEP files", "reportlab": "drawings"}, progress)
        if not plan.has_exact:
            return made

        when_usable(made)
        work.begin("STEP files")
        step = receive_step(work.advance)

    return _write_page(plan, _add_step_files(plan, made, step), first)


@dataclass(frozen=True)
class _Plan:
    """Outputs of a design, with the writers of sets whose folders can take them."""

    design: Design
    folder: Path
    force: bool
    build: BuildPlan
    board: BoardPlan
    parts: SetWriter
    signal: SetWriter
    write_sketch: Callable[[], tuple[Path, ...]] | None
    """Writes the sketch of a design without a board; None of one with a board."""

    @property
    def has_page(self) -> bool:
        return "stl" in self.build.formats

    @property
    def has_exact(self) -> bool:
        """True if STEP files are to be made."""
        return bool(self.build.exact)


def _plan(design: Design, folder: Path, formats: tuple[str, ...], force: bool) -> _Plan:
    """Refuse what the folder cannot take, before work starts. Raises OutputError."""
    parts = output_files.PART_FILES.writer(design, folder, force)
    signal = output_files.SIGNAL.writer(design, folder / output_files.SIGNAL_FOLDER, force, folder)
    board_folder = folder / output_files.BOARD_FOLDER
    board = output_files.BOARD.writer(design, board_folder, force, folder)
    parts.check((output_files.ACCEPTANCE, output_files.PAGE))
    board.check(BRING_UP_FILES)
    write_sketch = None

    if not design.board.has_filter:
        write_sketch = plan_firmware(
            design, folder / output_files.FIRMWARE.place, force=force, top=folder
        )

    signal.check((output_files.TRACE, output_files.PLOT, output_files.DETECTION))
    options = BuildOptions(
        formats=formats,
        pictures=True,
        drawings="step" in formats and extras.is_installed("reportlab"),
        force=force,
    )
    return _Plan(
        design=design,
        folder=folder,
        force=force,
        build=plan_build(design, folder, options),
        board=plan_board(design, board_folder, force=force, bring_up=True, top=folder),
        parts=parts,
        signal=signal,
        write_sketch=write_sketch,
    )


@dataclass(frozen=True)
class _First:
    """Everything but STEP files and drawings, before it is written."""

    parts: Build
    pictures: dict[str, bytes]
    """Pictures of the casting steps."""
    trial: Trial
    acceptance: bytes


def _make_first(plan: _Plan, report: ReportProgress) -> _First:
    """Make the meshes, while two processes make the trial and the pictures."""
    stages = Work("", {"parts": 3.0, "trial": 0.5, "pictures": 0.5}, report)
    build = plan.build

    with (
        start_pictures(build) as receive_pictures,
        in_background(_make_trial, plan.design, plan.has_page) as receive_trial,
    ):
        verified = verify(
            plan.design,
            parts=build.names,
            formats=build.formats,
            evaluator=build.evaluator,
            progress=stages.within("parts"),
        )
        acceptance = render_acceptance(acceptance_sheet(plan.design)).encode()
        stages.begin("trial")
        trial = receive_trial()
        stages.begin("pictures")
        pictures = receive_pictures()

    return _First(collect(build, verified, pictures), pictures, trial, acceptance)


def _write_first(plan: _Plan, first: _First, progress: Callable[[str], None]) -> Made:
    parts = write_build(plan.build, first.parts, first.pictures, progress)
    board = plan.board.write(progress)
    plan.signal.write(first.trial.files)
    plan.parts.write({output_files.ACCEPTANCE: first.acceptance})

    return Made(
        parts=parts,
        drawings=(),
        board=board,
        signal=tuple(plan.signal.folder / name for name in first.trial.files),
        firmware=plan.write_sketch() if plan.write_sketch else (),
        detection=first.trial.detection,
        page=None,
    )


def _add_step_files(plan: _Plan, made: Made, step: StepFiles | None) -> Made:
    """Write STEP files and drawings, and the report on them."""
    parts = add_step_files(plan.build, made.parts, step)
    before = made.parts.contents
    plan.parts.add(
        {name: data for name, data in parts.contents.items() if data != before.get(name)}
    )
    drawings = file_names(plan.design) if plan.build.options.drawings else ()

    return replace(made, parts=parts, drawings=tuple(plan.folder / name for name in drawings))


def _write_page(plan: _Plan, made: Made, first: _First) -> Made:
    """Write the page of what is written so far, if it can be shown."""
    if not plan.has_page:
        return made

    page, _, _ = write_page(
        plan.design, plan.folder, force=plan.force, prepared=first.trial.prepared
    )
    return replace(made, page=page)


# Trial of a design: a simulated one, and the slip that its detector finds in it. It runs in a
# process of its own.

DETECTOR = "fast"
"""Detector of the trial: the best there is."""


@dataclass(frozen=True)
class Trial:
    """Simulated trial of a design, with the slip in it."""

    files: dict[str, bytes]
    """Trace, plot and detection: file name -> content."""
    detection: FileDetection
    prepared: Prepared | None
    """Sections of the page that depend on the design alone; None without a page."""


def _make_trial(design: Design, has_page: bool) -> Trial:
    """Simulate a trial, and prepare the page."""
    trial = simulate_and_detect(design)
    if not has_page:
        return trial

    prepared = replace(
        prepare_page(design), pad=render_pad(design), trial=render_detection(trial.detection)
    )
    return replace(trial, prepared=prepared)


def simulate_and_detect(design: Design) -> Trial:
    """Simulate a trial, and detect slip in its trace as it is read back from a file."""
    scene = load_simulation().scene
    assert isinstance(scene, SceneFile)
    second = find_second_column(design, DETECTOR)
    if second:
        scene = scene.model_copy(update={"outputs": [*scene.outputs, f"sampled_{second}"]})

    record = run_scene(design, scene)
    trace = encode_trace(record.time_s, record.columns, Path(output_files.TRACE))
    with temporary_folder() as temporary:
        path = temporary / output_files.TRACE
        path.write_bytes(trace)
        detected = detect_file(path, design, DETECTOR, origin=record.trace.origin)

    files = {
        output_files.TRACE: trace,
        output_files.DETECTION: encode_json(as_data(detected.detection, detected.noise)),
        output_files.PLOT: write_svg(draw_whole(detected.trace, detected.detection)),
    }
    return Trial(files, detected, None)
