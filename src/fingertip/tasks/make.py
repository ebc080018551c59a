"""All outputs of a design: parts, drawings, board, and a simulated trial with its slip.

The parts stand at the top of the folder, as `build` writes them, with pictures of the casting steps
in `steps/`, and the drawings and the acceptance sheet beside them. The board is in `board/`, the
trial in `signal/`. Each is a set of its own. A design without a board has the sketch for its
controller in `firmware/`. STEP files, trial and pictures are made in processes beside, while this
process makes the others, and prepares what the page shows of the design alone. The page is made
last, from what was written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from fingertip.cad.build_result import Build
from fingertip.cad.verification.second_opinion import list_packages
from fingertip.catalogues import output_files
from fingertip.design import Design
from fingertip.detection.recordings import FileDetection, detect_file
from fingertip.documents.acceptance import acceptance_sheet, render_acceptance
from fingertip.foundation import extras
from fingertip.foundation.files import encode_json, temporary_folder
from fingertip.foundation.output_set import SetWriter
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.foundation.workers import in_background
from fingertip.page.html import Markup
from fingertip.page.pad_section import render_pad
from fingertip.page.page import Prepared, prepare_page
from fingertip.pictures.drawing.draw import file_names
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.simulation import load_simulation
from fingertip.sim.trace_file import encode_trace
from fingertip.slip.detection_results import as_data
from fingertip.slip.detectors.registry import find_second_column
from fingertip.slip.plots import draw_detection
from fingertip.tasks.board_files import BRING_UP_FILES, plan_board
from fingertip.tasks.build import BuildOptions, find_formats, plan_build, run_build
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
) -> Made:
    """Make parts, drawings, board or sketch, a simulated trial and its detection, in one folder.

    The folder is `out/NAME` by default; `formats` are those of the parts, as for `build`. With
    `force`, files may be overwritten that this function did not write, or that were changed since.
    `progress` is called with a message at each step. Raises as `build`, `write_board`, `simulate`
    and `detect_file` do; nothing has been written then.
    """
    folder = output_files.PART_FILES.folder(design, out)
    requested = None if formats is None else tuple(formats)
    plan = _plan(design, folder, find_formats() if requested is None else requested, force)
    rest = list[_Rest]()
    work = Work(design.name, {"parts": 6.0, "page": 0.5}, progress)
    report = work.within("parts")

    with in_background(_simulate_and_draw, design, plan.has_page) as beside:
        board = plan_board(
            design, folder / output_files.BOARD_FOLDER, force=force, bring_up=True, top=folder
        )
        options = BuildOptions(
            formats=plan.formats,
            pictures=True,
            drawings=plan.has_drawings,
            force=force,
            verify=all(map(extras.is_installed, list_packages(plan.formats))),
        )
        parts = run_build(
            plan_build(design, folder, options),
            report,
            lambda stage: rest.append(_make_rest(plan, beside, stage)),
        )

    (outputs,) = rest
    board_paths = board.write(progress)
    plan.signal.write(outputs.signal)
    plan.parts.write({output_files.ACCEPTANCE: outputs.acceptance})
    sketch = plan.write_sketch() if plan.write_sketch else ()
    signal_paths = tuple(plan.signal.folder / name for name in outputs.signal)
    drawings = tuple(folder / name for name in file_names(design)) if plan.has_drawings else ()
    page = None

    if outputs.page:
        work.begin("page")
        page, _, _ = write_page(design, folder, force=force, prepared=outputs.page)
    else:
        progress(f"{output_files.PAGE} is left out: it shows the STL files; add stl to the formats")

    packages = {}
    if requested is None or "step" in requested:
        packages = {"cadquery": "STEP files", "reportlab": "drawings"}

    extras.say_left_out({**packages, "matplotlib": output_files.PLOT}, progress)
    return Made(
        parts=parts,
        drawings=drawings,
        board=board_paths,
        signal=signal_paths,
        firmware=sketch,
        detection=outputs.detection,
        page=page,
    )


@dataclass(frozen=True)
class _Plan:
    """Outputs of a design, with the writers of sets whose folders can take them."""

    design: Design
    folder: Path
    formats: tuple[str, ...]
    has_drawings: bool
    parts: SetWriter
    signal: SetWriter
    write_sketch: Callable[[], tuple[Path, ...]] | None
    """Writes the sketch of a design without a board; None of one with a board."""

    @property
    def has_page(self) -> bool:
        return "stl" in self.formats


def _plan(design: Design, folder: Path, formats: tuple[str, ...], force: bool) -> _Plan:
    """Refuse what the folder cannot take, before work starts. Raises OutputError."""
    parts = output_files.PART_FILES.writer(design, folder, force)
    signal = output_files.SIGNAL.writer(design, folder / output_files.SIGNAL_FOLDER, force, folder)
    board = output_files.BOARD.writer(design, folder / output_files.BOARD_FOLDER, force, folder)
    parts.check((output_files.ACCEPTANCE, output_files.PAGE))
    board.check(BRING_UP_FILES)
    write_sketch = None

    if not design.board.has_filter:
        write_sketch = plan_firmware(
            design, folder / output_files.FIRMWARE.place, force=force, top=folder
        )

    signal.check((output_files.TRACE, output_files.PLOT, output_files.DETECTION))
    has_drawings = "step" in formats and extras.is_installed("reportlab")
    return _Plan(
        design=design,
        folder=folder,
        formats=formats,
        has_drawings=has_drawings,
        parts=parts,
        signal=signal,
        write_sketch=write_sketch,
    )


@dataclass(frozen=True)
class _Rest:
    """Outputs that are made while the B-rep kernel works."""

    signal: dict[str, bytes]
    detection: FileDetection
    acceptance: bytes
    page: Prepared | None


def _make_rest(plan: _Plan, beside: Callable[[], _Simulated], report: ReportProgress) -> _Rest:
    stages = Work("", {"page": 1.0, "trial": 1.0}, report)
    stages.begin("page")
    page = prepare_page(plan.design) if plan.has_page else None
    stages.begin("trial")
    signal, detection, pad = beside()
    acceptance = render_acceptance(acceptance_sheet(plan.design)).encode()

    return _Rest(signal, detection, acceptance, page and replace(page, pad=pad))


_Simulated = tuple[dict[str, bytes], FileDetection, Markup | None]
"""Files of the trial, the slip in it, and what the page shows of the pad."""


def _simulate_and_draw(design: Design, has_page: bool) -> _Simulated:
    signal, detection = simulate_and_detect(design)
    return signal, detection, render_pad(design) if has_page else None


# Trial of a design: a simulated one, and the slip that its detector finds in it. It runs in a
# process of its own.

DETECTOR = "fast"
"""Detector of the trial: the best there is."""


def simulate_and_detect(design: Design) -> tuple[dict[str, bytes], FileDetection]:
    """Simulate a trial, and detect slip in its trace as it is read back from a file."""
    scene = load_simulation().scene
    assert isinstance(scene, SceneFile)
    second = find_second_column(design, DETECTOR)
    if second:
        scene = scene.model_copy(update={"outputs": [*scene.outputs, f"sampled_{second}"]})

    record = run_scene(design, scene)
    contents = {
        output_files.TRACE: encode_trace(record.time_s, record.columns, Path(output_files.TRACE))
    }
    with temporary_folder() as temporary:
        path = temporary / output_files.TRACE
        path.write_bytes(contents[output_files.TRACE])
        detected = detect_file(path, design, DETECTOR, origin=record.trace.origin)

    data = as_data(detected.detection, detected.noise)
    contents[output_files.DETECTION] = encode_json(data)
    if extras.is_installed("matplotlib"):
        title = f"{design.name}: simulated trial"
        contents[output_files.PLOT] = draw_detection(detected.detection, title)

    return contents, detected
