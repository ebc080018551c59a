"""All outputs of a set of fingers: each form as `make` makes it, and shared files.

The folder of a form stands below that of the set, whose own files say what is printed, cast and
bought for all of them. The forms are written one after the other, the files of the set last.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.orientations import build_volume_excess, print_orientations
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.verification.check import count_checks
from fingertip.catalogues.output_files import (
    ACCEPTANCE,
    BOARD,
    BOARD_DESIGN,
    BOARD_FOLDER,
    CASTING_PLAN,
    OVERVIEW,
    PAGE,
    PART_FILES,
    PARTS_CSV,
    PARTS_LIST,
    README,
    SET_FILES,
    SET_REPORT,
)
from fingertip.design import Design
from fingertip.design.finger_set import FingerSet, Form
from fingertip.documents.acceptance import acceptance_sheet
from fingertip.documents.set_sheets import (
    FormSheets,
    SetSheets,
    find_short_pot_lives,
    render_sheet,
    set_sheets,
    write_parts_csv,
)
from fingertip.foundation.errors import DesignError, Issue, OutputError, raise_issues
from fingertip.foundation.files import encode_json
from fingertip.foundation.input_files import find_link
from fingertip.foundation.progress import Work
from fingertip.models.parts import PARTS, print_scale
from fingertip.page.page import render_set_page
from fingertip.pictures.casting_scenes import draw_finger
from fingertip.tasks.board_files import BRING_UP_FILES, plan_board
from fingertip.tasks.build import copy_design
from fingertip.tasks.make import Made, make

_FILES = (SET_REPORT, OVERVIEW, CASTING_PLAN, PARTS_LIST, PARTS_CSV, BOARD_DESIGN, ACCEPTANCE, PAGE)
_COARSE_MM = 0.1
_PICTURE_PX = 320
_SHOWN = (".md", ".csv", ".svg", ".kicad_pro")
"""Ends of the names of the board's files that the page of a set links to."""


@dataclass(frozen=True)
class MadeSet:
    """Result of `make_set`."""

    folder: Path
    forms: tuple[Made, ...]
    board: tuple[Path, ...]
    """Files of the board for all fingers; none if each finger keeps its own."""
    sheets: SetSheets

    @property
    def passed(self) -> bool:
        """True if no check of any form failed."""
        return all(form.parts.passed for form in self.forms)


def make_set(
    fingers: FingerSet,
    out: str | Path | None = None,
    *,
    formats: Iterable[str] | None = None,
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> MadeSet:
    """Make every form of a set in a folder of its own, and the plan and sheets of the set.

    Options are those of `make`. The folder is `out/<set name>` by default. Raises FingertipError as
    `make` does for each form, or if a part is too large for the bed or a silicone thickens too
    soon. Nothing has been written then, but for forms whose own files were complete.
    """
    folder = SET_FILES.folder(fingers, out)
    formats = None if formats is None else tuple(formats)
    writer = SET_FILES.writer(fingers, folder, force)
    writer.check(_FILES)
    places = {form.design.name: folder / form.design.name for form in fingers.forms}
    # A folder may come from a stranger, and links may lead anywhere.
    links = (find_link(folder, place) for place in places.values())
    issues = [Issue(str(link), "is a link; remove it.") for link in links if link]

    if BOARD_FOLDER in places:
        message = f"{BOARD_FOLDER} is a folder of every set, and the name of a design; rename it."
        issues.append(Issue("name", message))

    raise_issues(OutputError, issues)
    for form in fingers.forms:
        PART_FILES.writer(form.design, places[form.design.name], force).check((PAGE, ACCEPTANCE))

    board_design = fingers.board_design
    if board_design:
        BOARD.writer(board_design, folder / BOARD_FOLDER, force, folder).check(BRING_UP_FILES)

    labels = [
        f"{form.design.name} ({number} of {len(fingers.forms)})"
        for number, form in enumerate(fingers.forms, 1)
    ]
    work = Work(fingers.name, {"forms": 1.0, **dict.fromkeys(labels, 15.0), "set": 2.0}, progress)
    work.begin("forms")
    _refuse_early(fingers)

    forms: list[Made] = []

    for label, form in zip(labels, fingers.forms, strict=True):
        place = places[form.design.name]
        report = work.within(label)
        forms.append(make(form.design, place, formats=formats, force=force, progress=report))

    work.begin("set")
    collected = [
        _collect(fingers, form, finger) for form, finger in zip(fingers.forms, forms, strict=True)
    ]
    board: tuple[Path, ...] = ()

    if board_design:
        board_folder = folder / BOARD_FOLDER
        plan = plan_board(board_design, board_folder, force=force, bring_up=True, top=folder)
        board = plan.write(progress)

    sheets = set_sheets(fingers, collected, has_board=board_design is not None)
    failed = [finger.parts.design.name for finger in forms if not finger.parts.passed]
    contents = _render_sheets(fingers, sheets, _list_files(collected, board, folder), failed)
    if board_design:
        contents |= copy_design(board_design, BOARD_DESIGN, "Design of the board for all fingers.")

    writer.write(contents)
    return MadeSet(folder, tuple(forms), board, sheets)


def _list_files(sheets: Iterable[FormSheets], board: Iterable[Path], folder: Path) -> list[str]:
    """List the files of a set that its page links to, without those of the page's own making."""
    files = list[str]()
    for sheet in sheets:
        name = sheet.form.design.name
        files += [f"{name}/{BOARD_FOLDER}/{README}", f"{name}/{sheet.casting.plate}"]

    files += [path.relative_to(folder).as_posix() for path in board if path.suffix in _SHOWN]
    return files


def _render_sheets(
    fingers: FingerSet, sheets: SetSheets, files: Sequence[str], failed: Sequence[str]
) -> dict[str, bytes]:
    names = {
        OVERVIEW: "overview",
        CASTING_PLAN: "plan",
        PARTS_LIST: "parts",
        ACCEPTANCE: "acceptance",
    }
    pages = {file: render_sheet(name, sheets) for file, name in names.items()}
    pictures = {form.design.name: draw_finger(form.design, _PICTURE_PX) for form in fingers.forms}
    start = render_sheet("start", sheets)

    return {
        **{name: text.encode() for name, text in pages.items()},
        PARTS_CSV: write_parts_csv(sheets.things),
        SET_REPORT: encode_json(asdict(sheets)),
        PAGE: render_set_page(
            sheets,
            pictures=pictures,
            start=start,
            texts=pages.values(),
            files=[*pages, PARTS_CSV, *files],
            failed=failed,
        ),
    }


def _refuse_early(fingers: FingerSet) -> None:
    """Refuse parts larger than the bed, and silicones that thicken too soon."""
    evaluator = MeshEvaluator(_COARSE_MM)
    issues = list(find_short_pot_lives(form.design for form in fingers.forms))

    for design in (form.design for form in fingers.forms):
        for name, lies in print_orientations(design).items():
            mesh = evaluator.mesh(
                PARTS[name].solid(design).scaled(print_scale(design, PARTS[name]))
            )
            excess = build_volume_excess(design, mesh, lies.rotate_x_deg)
            if excess > 0.0:
                text = f"{name} of {design.name} exceeds the build volume by {excess:.1f} mm"
                remedy = _name_larger_bed(design, name, mesh)
                issues.append(Issue("printer.bed_x_mm", f"{text}; {remedy}."))

    raise_issues(DesignError, issues)


def _name_larger_bed(design: Design, part: str, mesh: Mesh) -> str:
    size = bed_pose(mesh, print_orientations(design)[part].rotate_x_deg).size(mesh)
    short, long = sorted(size[:2])
    beds = sorted(("printer.bed_x_mm", "printer.bed_y_mm"), key=design.value)
    needed = zip((*beds, "printer.bed_z_mm"), (short, long, size[2]), strict=True)
    changes = [
        f"--set {path}={math.ceil(least + 0.1)}"
        for path, least in needed
        if least > design.value(path)
    ]

    return f"it fits with {' '.join(changes)}"


def _collect(fingers: FingerSet, form: Form, finger: Made) -> FormSheets:
    assert finger.parts.casting is not None, "all parts are built"
    own = {
        name: acceptance_sheet(fingers.calibrated[name])
        for name in form.fingers
        if name in fingers.calibrated
    }
    verdict = count_checks(finger.parts.checks)
    return FormSheets(
        form=form,
        casting=finger.parts.casting,
        acceptance=acceptance_sheet(form.design),
        verdict=verdict,
        calibrated=own,
    )
