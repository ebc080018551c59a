"""`fingertip board`: component values of a board, and its files for KiCad and SPICE."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli import options
from fingertip.cli.board_tables import analysis_text, channel_lines, gate_lines, table_lines
from fingertip.cli.console import Console
from fingertip.cli.options import (
    command,
    find_file_issues,
    find_idle_issues,
    flag,
    load_design,
    refuse,
)
from fingertip.foundation.errors import Issue

if TYPE_CHECKING:
    from fingertip.board.analysis.board_values import BoardValues
    from fingertip.design import Design


@command
def board(
    console: Console,
    design: Path | None = options.OPTIONAL_DESIGN,
    out: Path | None = typer.Option(
        None,
        "--out",
        "-o",
        help="Output folder; out/NAME/board by default, where only --force replaces a board of "
        "another circuit.",
    ),
    check: bool = flag(
        "Write nothing; compare the folder (with --fab also OUT/fab) with the design; exit 1 if "
        "they differ."
    ),
    fab: bool = flag(
        "Also write gerbers, drill files, placement, parts and renderings to OUT/fab; requires "
        "KiCad 9."
    ),
    panel: str | None = typer.Option(
        None,
        metavar="ROWSxCOLUMNS",
        help="Also write a panel of so many boards, such as 2x3, to OUT/panel; needs KiKit.",
    ),
    analysis: bool = flag("Also analyse noise, offsets, tolerances (10 000 boards)."),
    bode: Path | None = typer.Option(
        None, metavar="FILE", help="Write the Bode table of each stage as CSV."
    ),
    bringup: bool = flag(
        "Also write bringup.md, how to test a soldered board, and a sketch that plays the tones."
    ),
    article: bool = flag("Also print what the article states about its own board, and what is so."),
    verbose: bool = options.VERBOSE,
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Compute the board's component values; write schematic, layout, netlist, SPICE deck and bill
    of materials.
    """
    writing = {"--bode": bode, "--bringup": bringup, "--panel": panel}
    idle = find_idle_issues("--check", writing if check else {})
    refuse(find_file_issues("--bode", bode, ".csv"), idle)
    shape = re.fullmatch("([1-9])x([1-9])", panel or "1x1")
    message = f"{panel} is no panel; write rows and columns, 1 to 9 each, such as 2x3."
    refuse([] if shape else [Issue("--panel", message)])
    loaded = load_design(design, changes, console)
    options = _Options(
        out=out,
        fab=fab,
        panel=shape if panel else None,
        analysis=analysis,
        bode=bode,
        bring_up=bringup,
        article=article,
        verbose=verbose,
        force=force,
    )

    if not loaded.board.has_filter:
        from fingertip.board.components.values import BOARD_REMEDY

        needing = {"--fab": fab, "--analysis": analysis, "--article": article} | writing
        message = f"needs a board, and a divider is none; leave it out, or {BOARD_REMEDY}."
        refuse(Issue(option, message) for option, value in needing.items() if value)

    if check:
        _compare(console, loaded, out, fab)
    elif loaded.board.has_filter:
        _write_board(console, loaded, options)
    else:
        _write_divider(console, loaded, options)


@dataclass(frozen=True)
class _Options:
    """Options of the command: the files and the text that are made of a board."""

    out: Path | None
    fab: bool
    panel: re.Match[str] | None
    """Rows and columns of the panel."""
    analysis: bool
    bode: Path | None
    bring_up: bool
    article: bool
    verbose: bool
    force: bool


def _write_board(console: Console, design: Design, options: _Options) -> None:
    """Write the files of a board; print values, warnings, and what the options add."""
    from fingertip.board.analysis.board_values import board_values

    values = board_values(design)
    folder, report = _write(console, design, options)
    warnings = list(_find_warnings(design, values))
    data = values.as_data()
    verdict = _format_verdict(values, warnings)
    achieved = values.achieved_response
    target = values.target_response
    lines = [
        f"{design.name}, {verdict}",
        f"-3 dB at {achieved.cutoff_hz:.4g} Hz (target {target.cutoff_hz:.4g} Hz), gain "
        f"{achieved.passband_gain:.4g}; "
        f"files in {folder}, --verbose for the conditions",
        *channel_lines(design, values),
        "",
        *table_lines(design, values),
    ]
    if options.panel:
        lines += ["", _write_panel(folder, *map(int, options.panel.groups()))]
    if options.verbose:
        lines += ["", *gate_lines(values)]

    if options.fab:
        from fingertip.board.circuits.board_circuit import board_circuit
        from fingertip.board.fabrication.bom import missing_numbers_note

        data["to_order"] = missing_numbers_note(board_circuit(values, design.board.channels))
        lines += ["", data["to_order"]] if data["to_order"] else []

    if options.article:
        lines += ["", "Errata of the article:"]
        for erratum in values.errata:
            lines += [
                f"  {erratum.subject}",
                f"    article: {erratum.statement}",
                f"    correct: {erratum.correction}",
            ]

    if options.bode:
        from fingertip.board.analysis.board_analysis import bode_table
        from fingertip.foundation.files import write_file

        write_file(options.bode, bode_table(design).encode(), "--bode")
        report["files"].append(options.bode.as_posix())
        lines += ["", f"wrote {options.bode.as_posix()}"]

    if options.analysis:
        from fingertip.board.analysis.board_analysis import analyse

        analysis = analyse(design)
        data["analysis"] = analysis.as_data()
        lines += ["", analysis_text(design, analysis)]

    console.result(data | report | {"verdict": verdict, "warnings": warnings}, "\n".join(lines))


def _write_panel(folder: Path, rows: int, columns: int) -> str:
    """Write a panel of a board, or return the command for it if KiKit is not installed."""
    from fingertip.board.fabrication.fabrication_files import panel_command, run_kikit
    from fingertip.catalogues.output_files import LAYOUT

    panel = folder / "panel" / LAYOUT
    command = panel_command(folder / LAYOUT, panel, rows, columns)
    panel.parent.mkdir(exist_ok=True)
    if run_kikit(command):
        return f"panel of {rows} x {columns} in {panel}"

    return f"KiKit is not installed; where it is, this writes the panel: {shlex.join(command)}"


def _write_divider(console: Console, design: Design, options: _Options) -> None:
    """Write the files of a divider, and print what its voltage must be."""
    from fingertip.board.analysis.board_values import find_range_warnings
    from fingertip.documents.board.divider import describe_readings, list_readings

    folder, report = _write(console, design, options)
    console.warn(
        [*find_range_warnings(design), *design.force_curve.find_doubt(design.sensor.model)]
    )
    first = (
        f"{design.name}, divider of {design.board.divider_ohm:g} ohm on one analog input; "
        f"files in {folder}"
    )
    readings = list_readings(design)
    console.result(
        report | {"readings": readings}, "\n  ".join([first, *describe_readings(readings)])
    )


def _compare(console: Console, design: Design, out: Path | None, fab: bool) -> None:
    from fingertip.catalogues.output_files import BOARD
    from fingertip.tasks.board_files import board_differences, fabrication_differences

    folder = out or BOARD.folder(design)

    if folder.is_dir():
        differences = board_differences(design, folder)
        differences += fabrication_differences(design, folder, expected=fab)
    else:
        problem = "is no folder" if folder.exists() else "does not exist"
        differences = [f"{folder} {problem}; name the folder with --out."]

    text = "\n".join(differences) or f"{folder} is up to date with this design"
    data = {"current": not differences, "differences": differences}
    console.result(data, text, passed=not differences)


def _write(console: Console, design: Design, options: _Options) -> tuple[Path, dict[str, Any]]:
    """Write the files of a board, and those for its maker; return their folder and a report."""
    from fingertip.catalogues.output_files import BOARD
    from fingertip.tasks import board_files as task

    folder = options.out or BOARD.folder(design)
    force = options.force

    # A folder that was not named keeps a board of another circuit.
    if options.out is None and not force:
        task.refuse_other_board(design)
    if options.fab:
        task.check_fabrication(design, folder, force=force)

    notes: list[str] = []
    paths = task.write_board(
        design, folder, force=force, bring_up=options.bring_up, progress=notes.append
    )
    for note in notes:
        console.progress(note)

    if options.fab:
        paths += task.write_fabrication(design, folder, console.progress, force)

    # Fabrication files of an earlier design may be left in the folder.
    differences = task.fabrication_differences(design, folder)
    console.warn(
        f"{difference} Do not send these files to a board house." for difference in differences
    )
    files = [path.as_posix() for path in paths]
    return folder, {"files": files, "notes": notes, "fabrication_differences": differences}


def _find_warnings(design: Design, values: BoardValues) -> Iterator[str]:
    """Yield warnings of settings that are valid but make a bad board."""
    from fingertip.board.analysis.gate import gate_warnings
    from fingertip.board.analysis.interference import crosstalk_warning
    from fingertip.board.analysis.loads import load_warnings
    from fingertip.board.analysis.noise import noise_warning

    warning = noise_warning(values.noise, design.detector.threshold_v)
    if warning:
        yield warning
    if values.shared:
        warning = crosstalk_warning(values.shared, design.board)
        if warning:
            yield warning

    yield from load_warnings(design, values.filter_load_ohm, values.preferred.c_f)
    yield from gate_warnings(values.gate)
    if values.comparator_levels:
        # The comparator is the detector here, so the warnings on detector settings apply. They need
        # numpy.
        from fingertip.detection.warnings import settings_warnings

        yield from settings_warnings(design)


def _format_verdict(values: BoardValues, warnings: Sequence[str]) -> str:
    """Return the verdict on a board's conditions, with the warnings."""
    failed = sum(not condition.passed for condition in values.gate)
    verdict = f"all {len(values.gate)} conditions of a working board are met"
    if failed:
        verdict = f"{failed} of its {len(values.gate)} conditions FAIL"

    if len(warnings) == 1:
        more = ", with a warning:"
    elif warnings:
        more = f", with {len(warnings)} warnings:"
    else:
        more = ""

    lines = [f"variant {values.variant}: {verdict}{more}"]
    return "\n".join([*lines, *(f"  warning: {warning}" for warning in warnings)])
