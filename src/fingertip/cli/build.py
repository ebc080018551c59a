"""Commands that write a set of files of a design: `build`, `make`, `firmware` and `robot`."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fingertip.cli.check_reports import NamedDesign, message
from fingertip.cli.check_tables import describe_cause, offer_fit
from fingertip.cli.console import Console
from fingertip.cli.options import (
    CHANGES,
    DESIGN_FILE,
    FORCE,
    MATERIAL,
    command,
    find_file_issues,
    find_idle_issues,
    flag,
    list_words,
    load_design,
    load_fingers,
    refuse,
)
from fingertip.foundation.errors import FingertipError, Issue, join_words
from fingertip.foundation.files import write_zip

if TYPE_CHECKING:
    from fingertip.cad.build_result import Build
    from fingertip.tasks.make import Made


@command
def build(
    console: Console,
    design: Path = DESIGN_FILE,
    out: str | None = typer.Option(
        None, metavar="PATH", help="Output folder; out/NAME by default."
    ),
    parts: str | None = typer.Option(
        None, help="Parts (bone, skin, ...), separated by commas; all by default."
    ),
    formats: str | None = typer.Option(
        None,
        help="File formats ({formats}), separated by commas; cq: CadQuery scripts. By default all "
        "others, step if it can be made.",
    ),
    tolerance_mm: float = typer.Option(
        0.01, help="Largest distance of a facet from the exact surface, in mm."
    ),
    material: str | None = MATERIAL,
    pictures: bool = flag("Draw a picture of each casting step, for the casting sheet."),
    verify: bool = flag(
        "Read each STL and 3MF file with trimesh too, as a second opinion; with --check, make "
        "them again and compare."
    ),
    only_check: bool = typer.Option(
        False,
        "--check",
        help="Write nothing; compare the folder with the design. Exit code 1: they differ.",
    ),
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
) -> None:
    """Build bone, skin and mold as STL, 3MF and STEP files, check them, and write a report and a
    casting sheet.

    With --check, the folder is compared instead: were its files made from this design, by this
    version of the program, and are they as they were written?
    """
    from fingertip.catalogues.output_files import PART_FILES, REPORT, SHEET

    if only_check:
        writing = {"--formats": formats, "--pictures": pictures, "--force": force}
        refuse(find_idle_issues("--check", writing))

    loaded = load_design(design, changes, console)
    if only_check:
        from fingertip.cli.check_files import compare_with_designs

        loaded = loaded.with_silicone(material)
        words = list_words(changes or (), console)
        if material:
            words = [*words, "--material", material]

        folder = PART_FILES.folder(loaded, out)
        refuse(_find_other_kind(folder))
        comparison = compare_with_designs(
            folder,
            designs=[NamedDesign(design, loaded)],
            words=words,
            remake=verify,
            console=console,
            parts=split_names(parts),
        )
        console.result(comparison.data, comparison.text, comparison.passed)
        return

    from fingertip.tasks.build import build as build_parts

    result = build_parts(
        loaded,
        out,
        parts=split_names(parts),
        formats=split_names(formats),
        tolerance_mm=tolerance_mm,
        material=material,
        pictures=pictures,
        force=force,
        verify=verify,
        progress=console.progress,
    )
    data = json.loads(result.contents[REPORT]) | {
        "folder": str(result.folder),
        "removed": list(result.removed),
    }
    following = ""
    if result.casting:
        following = f"{result.folder / SHEET} says what to print, and how to cast the skin"

    lines = _format_build(result)
    offer = offer_fit(loaded, result.checks, changes or (), console)
    data |= offer
    last = _tell_next(result, following, offer)
    lines += [*_list_remarks(result, _MAX_LINES - len(lines) - len(last)), *last]
    console.result(data, "\n".join(lines), result.passed)


def _find_other_kind(folder: Path) -> Iterator[Issue]:
    """Yield an issue if a folder holds something else than parts."""
    from fingertip.catalogues.output_files import PART_FILES
    from fingertip.foundation.output_set import read_manifest

    manifest = read_manifest(folder)

    if manifest and manifest.kind != PART_FILES.kind:
        message = (
            f"holds the {manifest.kind} of {manifest.design!r} and no parts; give the "
            "folder of the parts."
        )
        yield Issue(str(folder), message)


_MAX_LINES = 12
_MAX_WIDTH = 100
"""Largest summary of what was made, which a terminal shows at once and unbroken."""


def _format_build(result: Build) -> list[str]:
    """Format verdict, effort and strength in five or six lines."""
    from fingertip.cad.verification.check import count_checks
    from fingertip.cad.verification.strength import describe_loads
    from fingertip.casting.shopping import add_prices

    lines = [f"{result.design.name}: {count_checks(result.checks)}; in {result.folder}"]
    sheet = result.casting

    if sheet:
        least, most, in_all = add_prices(sheet.things)
        batch = sheet.batch
        lines += [
            f"print: {sheet.printed_g:g} g of {sheet.material}, some {sheet.print_h:g} h",
            f"cast: {batch.total_g:g} g of silicone, {batch.cure_h:g} h of cure; "
            f"{sheet.days} days, after up to {sheet.mail_days} days of mail",
            f"buy: {least} to {most} US dollars to order, up to {in_all} with all tools "
            "(estimates)",
        ]
    else:
        lines.append(f"parts: {', '.join(built.part.name for built in result.parts)}")

    if result.strength:
        lines += textwrap.wrap(describe_loads(result.strength), _MAX_WIDTH, subsequent_indent="  ")

    return lines


def _list_remarks(result: Build, room: int, rewrite: Callable[[str], str] = str) -> list[str]:
    """List failed checks in `room` lines, each cut to its share; count the rest."""
    from fingertip.catalogues.output_files import REPORT

    remarks = [
        f"FAILED {check.name}: {message(check)}; {describe_cause(check, rewrite is not str)}"
        for check in result.checks
        if not check.passed
    ]
    count = len(remarks) if len(remarks) <= room else len(remarks[: room - 1])
    lines = list[str]()
    for remark in remarks[:count]:
        lines += textwrap.wrap(
            rewrite(remark),
            _MAX_WIDTH,
            max_lines=room // count,
            subsequent_indent="  ",
            placeholder=" ...",
        )

    if count < len(remarks):
        lines.append(f"and {len(remarks) - count} more, in {REPORT}")

    return lines


def _tell_next(result: Build, following: str, offer: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the next step; where checks failed, the command that mends them."""
    if result.passed:
        return [f"next: {following}"] if following else []

    remedies = dict.fromkeys(f"--set {check.remedy}" for check in result.checks if check.remedy)
    offers = [" ".join(remedies)] if remedies else []
    offers += [f"--fit, which moves {join_words(moved)}" for moved in offer.values()]
    return [f"next: run it again with {', or '.join(offers) or 'a change that mends what failed'}"]


def split_names(text: str | None) -> list[str] | None:
    """Split a comma-separated option into names; None if it is not given."""
    return None if text is None else [name.strip() for name in text.split(",") if name.strip()]


@command
def make(
    console: Console,
    design: Path = DESIGN_FILE,
    out: Path | None = typer.Option(
        None, "--out", "-o", help="Output folder; out/NAME by default."
    ),
    formats: str | None = typer.Option(
        None, help="File formats of the parts ({formats}), separated by commas; as for build."
    ),
    zip_file: Path | None = typer.Option(
        None,
        "--zip",
        metavar="PATH",
        help="Also write the whole folder as one ZIP file, to be mailed.",
    ),
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
) -> None:
    """Make parts, drawings, board or sketch, and a simulated trial with its slip. Exit code 1: a
    check failed.

    A set of fingers, such as adult_hand, gives a folder for each of its forms, and casting plan,
    parts list, acceptance sheet and page of the set.
    """
    from fingertip.design.finger_set import is_set
    from fingertip.foundation.output_set import is_packed_set

    is_replaced = force or (zip_file is not None and is_packed_set(zip_file))
    refuse(
        find_file_issues(
            "--zip", zip_file, ".zip", kept="" if is_replaced else "add --force to overwrite it"
        )
    )

    if is_set(design):
        _make_set(
            console,
            file=design,
            out=out,
            formats=split_names(formats),
            force=force,
            changes=changes or (),
            zip_file=zip_file,
        )
        return

    from fingertip.slip.detection_results import as_data
    from fingertip.tasks.make import make as make_everything

    loaded = load_design(design, changes, console)
    shown: list[Made] = []

    def show_summary(finger: Made) -> None:
        shown.append(finger)
        console.warn(finger.detection.warnings)
        offer = offer_fit(loaded, finger.parts.checks, changes or (), console)
        console.show(_summarise(finger, offer))

    finger = make_everything(
        loaded,
        out,
        formats=split_names(formats),
        force=force,
        progress=console.progress,
        when_usable=show_summary,
    )
    parts = finger.parts
    offer = offer_fit(loaded, parts.checks, changes or (), console)
    data = {
        "folder": str(parts.folder),
        "parts": parts.report(),
        "drawings": [path.as_posix() for path in finger.drawings],
        "board": [path.as_posix() for path in finger.board],
        "signal": [path.as_posix() for path in finger.signal],
        "firmware": [path.as_posix() for path in finger.firmware],
        "page": None if finger.page is None else str(finger.page),
        "detection": as_data(finger.detection.detection, finger.detection.noise),
        **offer,
    }
    if zip_file:
        write_zip(zip_file, parts.folder)

    if shown:
        console.result(data, _tell_added(finger, shown[0]), parts.passed)
    else:
        console.warn(finger.detection.warnings)
        console.result(data, _summarise(finger, offer), parts.passed)


def _summarise(finger: Made, offer: Mapping[str, Sequence[str]]) -> str:
    """Summarise what was made for a terminal, with the next step."""
    from fingertip.catalogues.output_files import PRINT_FOLDER, SHEET

    parts = finger.parts
    prints = ""
    if parts.prints.contents:
        prints = f", {PRINT_FOLDER}/{'plate_*.3mf' if parts.prints.plates else '*.stl'}"

    following = f"order what the page lists, print the parts{prints}, then follow {SHEET}"
    lines = _format_build(parts)
    last = [
        f"look at: {finger.page or parts.folder}{' in a browser' if finger.page else ''}",
        *_tell_next(parts, following, offer),
    ]
    lines += [*_list_remarks(parts, _MAX_LINES - len(lines) - len(last)), *last]

    return "\n".join(lines)


def _tell_added(finger: Made, before: Made) -> str:
    """Tell what came after the summary: the STEP files, with the checks that failed."""
    from fingertip.cad.verification.check import count_checks

    known = {check.name for check in before.parts.checks}
    added = tuple(check for check in finger.parts.checks if check.name not in known)
    files = "STEP files and drawings" if finger.drawings else "STEP files"
    remarks = _list_remarks(replace(finger.parts, checks=added), _MAX_LINES)

    return "\n".join([f"{files}: {count_checks(added)}", *remarks])


def _make_set(
    console: Console,
    file: Path,
    out: Path | None,
    formats: list[str] | None,
    force: bool,
    changes: Sequence[str],
    zip_file: Path | None,
) -> None:
    from dataclasses import asdict

    from fingertip.catalogues.output_files import OVERVIEW, PAGE
    from fingertip.tasks.make_set import make_set

    fingers = load_fingers(file, changes, console)
    finger_set = make_set(fingers, out, formats=formats, force=force, progress=console.progress)
    if zip_file:
        write_zip(zip_file, finger_set.folder)

    totals = finger_set.sheets.totals
    plan = finger_set.sheets.plan
    lines = list[str]()
    silicone_g = sum(totals.silicone_g.values())
    boards = "; one board for all fingers" if finger_set.board else ""
    last = [
        f"{totals.fingers} fingers of {len(finger_set.forms)} forms; to print: {plan.print_h:g} h, "
        f"{totals.printed_g:g} g; to buy: {len(finger_set.sheets.things)} things",
        f"{silicone_g:g} g of silicone in {totals.mixtures} mixtures on day {plan.cast_day}, "
        f"{plan.cure_h:g} h to cure; {plan.days} days{boards}",
        f"look at: {finger_set.folder / PAGE}",
    ]
    following = f"{finger_set.folder / OVERVIEW} says what to print, cast and build"
    if not finger_set.passed:
        following = "mend what failed, and make it again"

    last.append(f"next: {following}")
    room = (_MAX_LINES - len(last)) // len(finger_set.forms) - 1
    for finger, form in zip(finger_set.forms, fingers.forms, strict=True):
        console.warn(map(form.name_values, finger.detection.warnings))
        remarks = _list_remarks(finger.parts, room, form.name_values) if room > 0 else []
        lines += [_format_build(finger.parts)[0], *remarks]

    lines += last
    data = {
        "folder": str(finger_set.folder),
        "passed": finger_set.passed,
        **asdict(finger_set.sheets),
    }
    console.result(data, "\n".join(lines), finger_set.passed)


@command
def firmware(
    console: Console,
    design: Path = DESIGN_FILE,
    out: Path | None = typer.Option(
        None, metavar="PATH", help="Output folder; out/NAME/firmware by default."
    ),
    fingers: str | None = typer.Option(
        None,
        help="Fingers that the controller reads: their number, or names separated by commas; "
        "those of the board.",
    ),
    controller: str | None = typer.Option(
        None,
        help="The controller, such as pico2, or generic:240MHz,12bit,A0,A1; black_pill_f411 for "
        "several fingers.",
    ),
    inputs: str | None = typer.Option(
        None,
        help="Its analog inputs, T and S of each finger in turn (one for a divider), separated by "
        "commas.",
    ),
    check: bool = flag("Write nothing; compare the folder with the design; exit 1 if they differ."),
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
) -> None:
    """Write the slip detector of a design as a C99 library for a controller, for Arduino,
    PlatformIO or plain C.

    The README beside it states the wiring to the board's output connector, and what the detector
    costs in instructions and memory.
    """
    from fingertip.catalogues.output_files import FIRMWARE, README
    from fingertip.design.finger_set import is_set
    from fingertip.firmware.controller_fit import find_warnings
    from fingertip.firmware.fingers import plan_fingers, plan_set
    from fingertip.firmware.measured_costs import read_costs
    from fingertip.tasks.firmware_files import firmware_differences, write_firmware

    if is_set(design):
        if fingers:
            raise FingertipError(
                Issue(
                    "--fingers", "does not apply to a set, which names its fingers; leave it out."
                )
            )

        loaded, planned = plan_set(load_fingers(design, changes, console), controller, inputs)
    else:
        loaded = load_design(design, changes, console)
        planned = plan_fingers(loaded, fingers, controller, inputs)

    folder = out or FIRMWARE.folder(loaded)
    if check:
        differences = firmware_differences(loaded, folder, planned)
        text = "\n".join(differences) or f"{folder} is up to date with this design"
        data = {"current": not differences, "differences": differences}
        console.result(data, text, passed=not differences)
        return

    paths = write_firmware(loaded, folder, fingers=planned, force=force)
    warnings = list(find_warnings(loaded, planned.controller))
    console.warn(warnings)
    data = {
        "files": [path.as_posix() for path in paths],
        "warnings": warnings,
        "costs": read_costs(),
    }
    states = (
        "states wiring, use, and what each sample costs"
        if loaded.board.has_filter
        else "says what to open"
    )
    text = f"{len(paths)} files in {folder}\nnext: {folder / README} {states}"
    console.result(data, text)


@command
def robot(
    console: Console,
    design: Path = DESIGN_FILE,
    file_format: str = typer.Option(
        "mjcf", "--format", help="mjcf (MuJoCo) or urdf (ROS and many simulators)."
    ),
    out: Path | None = typer.Option(
        None, metavar="PATH", help="Output folder; out/NAME/robot by default."
    ),
    force: bool = FORCE,
    changes: list[str] | None = CHANGES,
) -> None:
    """Write a model of a finger, or of a set, for simulators: meshes, inertia, frames, collision
    pieces and contact.

    The README beside it states the frames, the errors of collision pieces and contact, and how to
    attach a finger.
    """
    from fingertip.design.finger_set import is_set
    from fingertip.tasks.robot_files import write_robot

    load = load_fingers if is_set(design) else load_design
    model = write_robot(
        load(design, changes, console),
        out,
        file_format=file_format,
        force=force,
        progress=console.progress,
    )
    lines = [
        f"{form['design']}: {1e3 * form['mass_kg']:.2f} g in {len(form['parts'])} parts. "
        f"{form['errors']}"
        for form in model.get("forms", {"": model}).values()
    ]
    lines.append(f"{len(model['files'])} files in {model['folder']}; its README.md explains them")
    console.result(model, "\n".join(lines))
