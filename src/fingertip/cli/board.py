"""`fingertip board`: component values of the board, and its files for KiCad and SPICE."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, SetOption, command

if TYPE_CHECKING:
    from fingertip.board.values.board_values import BoardValues
    from fingertip.design import Design


@command
def board(
    design: Annotated[Path | None, typer.Argument(help="Design file; without it, the defaults.")] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the files.")] = Path("pcb"),
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Write nothing; compare the folder (with --fab, OUT/fab too) with the design, exit 1 if it differs.",
        ),
    ] = False,
    fab: Annotated[
        bool, typer.Option("--fab", help="Also gerbers, drill, placement, parts, pictures into OUT/fab; needs KiCad 9.")
    ] = False,
    analysis: Annotated[
        bool, typer.Option("--analysis", help="Also noise, offsets, tolerances (10 000 boards) and sensitivities.")
    ] = False,
    bode: Annotated[
        Path | None, typer.Option("--bode", metavar="FILE", help="Write the Bode table of each stage as CSV.")
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Compute the board's component values; write schematic, layout, netlist, SPICE deck and bill of materials."""
    from fingertip.board import (
        board_values,
        differences,
        fabrication_differences,
        write_board,
        write_fabrication,
    )
    from fingertip.cli.load import load_design

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes)
    if check:
        found = differences(loaded, out) + fabrication_differences(loaded, out, expected=fab)
        current = "" if found else f"{out} is what this design gives"
        console.result({"current": not found, "differences": found}, "\n".join(found) or current)
        if found:
            raise typer.Exit(CHECK_FAILED)
        return
    values = board_values(loaded)
    paths = write_board(loaded, out)
    for path in paths:
        console.progress(f"wrote {path}")
    if fab:
        made = write_fabrication(loaded, out, console.progress)
        for path in made:
            console.progress(f"wrote {path}")
        paths += made
    outdated = fabrication_differences(loaded, out)
    for sentence in outdated:
        console.progress(f"warning: {sentence} Do not send it to anybody.")
    warnings = list(_warnings(loaded, values))
    for sentence in warnings:
        console.progress(f"warning: {sentence}")
    data, text = values.as_data(), _table(loaded, values)
    if bode:
        from fingertip.board.analysis.analyse import bode_table
        from fingertip.files import write_file

        write_file(bode, bode_table(loaded).encode(), "--bode")
        console.progress(f"wrote {bode}")
        paths += (bode,)
    if analysis:
        from fingertip.board.analysis.analyse import analyse
        from fingertip.board.analysis.report import analysis_text

        found_figures = analyse(loaded)
        data["analysis"] = found_figures.as_data()
        text += "\n\n" + analysis_text(found_figures)
    console.result(
        {**data, "files": [path.as_posix() for path in paths], "outdated": outdated, "warnings": warnings}, text
    )


def _warnings(design: Design, values: BoardValues) -> Iterator[str]:
    """What the board will do badly, though nothing forbids it."""
    from fingertip.board.values.white_noise import noise_warning

    if warning := noise_warning(values.noise, design.detector.threshold_v):
        yield warning
    if values.decision:  # here parts decide, so the detector's remarks are the board's; they need numpy
        from fingertip.slip.detectors import noise

        yield from noise.settings_warnings(design)


def _table(design: Design, values: BoardValues) -> str:
    from fingertip.board.circuit import engineering
    from fingertip.board.values.bridge import sensor_conductance_s
    from fingertip.board.values.limits import converter_line, swing_line

    ideal, preferred = values.ideal, values.preferred
    resistors = [
        ("R1", ideal.r1_ohm, preferred.r1_ohm, "first stage, pole"),
        ("R2", ideal.r2_ohm, preferred.r2_ohm, "Sallen-Key, feedback"),
        ("R3", ideal.r3_ohm, preferred.r3_ohm, "Sallen-Key, to ground"),
        ("R4", ideal.r4_ohm, preferred.r4_ohm, "gain, to ground"),
        ("R5", ideal.r5_ohm, preferred.r5_ohm, "gain, feedback"),
        ("R6", ideal.r_lp_ohm, preferred.r_lp_ohm, "R_LP, envelope"),
    ]
    lines = [f"{'part':10} {'ideal':>14} {design.board.series:>10} {'off by':>9}  what it does"]
    lines += [
        f"{name:10} {ohm:10.1f} ohm {engineering(fitted):>10} {100 * (fitted / ohm - 1):+8.2f}%  {role}"
        for name, ohm, fitted, role in resistors
    ]
    lines += [
        f"{'C1 C2 C3':10} {'':14} {engineering(preferred.c_f):>10} {'':9}  both filters",
        f"{'C4':10} {'':14} {engineering(preferred.c_lp_f):>10} {'':9}  C_LP, envelope",
    ]
    bridge = values.bridge
    lines += [
        f"{name:10} {'':14} {engineering(ohm):>10} {'':9}  bridge, {role}"
        for name, ohm, role in (
            ("R10", bridge.top_ohm, "supply to sensor"),
            ("R11", bridge.shunt_ohm, "parallel to the sensor"),
            ("R12", bridge.high_ohm, "supply to reference"),
            ("R13", bridge.low_ohm, "reference to ground"),
            ("R14", bridge.gain_ohm, f"gain of {bridge.gain:.2f}"),
        )
    ]
    others = [
        ("R7 C8", values.converter.envelope_ohm, values.converter.envelope_f, "anti-alias, envelope"),
        ("R8 C9", values.converter.first_ohm, values.converter.first_f, "anti-alias, tactile voltage"),
        ("R9 C19", values.converter.second_ohm, values.converter.second_f, "the same, second pole"),
    ]
    if values.first_stage:
        series_f, limit_f = values.first_stage.series_f, values.first_stage.limit_f
        others.append(("C14 C20", series_f, limit_f, "no gain at rest, none above the vibrations"))
    lines += [
        f"{name:10} {'':14} {f'{engineering(one)} {engineering(two)}':>10} {'':9}  {role}"
        for name, one, two, role in others
    ]
    wanted, achieved = values.wanted, values.achieved
    quantities = [
        ("largest gain", wanted.passband_gain, achieved.passband_gain, ""),
        ("largest gain", wanted.passband_gain_db, achieved.passband_gain_db, "dB"),
        ("first pole", wanted.first_pole_hz, achieved.first_pole_hz, "Hz"),
        ("Sallen-Key f0", wanted.section_hz, achieved.section_hz, "Hz"),
        ("Sallen-Key Q", wanted.section_quality, achieved.section_quality, ""),
        ("-3 dB overall", wanted.cutoff_hz, achieved.cutoff_hz, "Hz"),
        ("upper -3 dB", wanted.upper_cutoff_hz, achieved.upper_cutoff_hz, "Hz"),
        ("envelope pole", wanted.envelope_pole_hz, achieved.envelope_pole_hz, "Hz"),
        ("envelope decay", 1e3 * wanted.envelope_decay_s, 1e3 * achieved.envelope_decay_s, "ms"),
        ("amplifier bandwidth", wanted.amplifier_bandwidth_hz, achieved.amplifier_bandwidth_hz, "Hz"),
    ]
    lines += ["", f"{'response':20} {'ideal':>12} {'achieved':>12}"]
    lines += [f"{name:20} {was:12.6g} {now:12.6g} {unit}".rstrip() for name, was, now, unit in quantities]
    alias, limits = values.alias, values.limits
    lines += [
        "",
        f"{design.board.supply} supply of {design.board.supply_v:g} V: signals rest at {limits.rest_v:g} V, "
        f"{swing_line(limits)}",
        f"at {alias.nyquist_hz:g} Hz, half the converter's rate, the tactile voltage has lost "
        f"{-alias.raw_nyquist_db:.1f} dB, the envelope {-alias.envelope_nyquist_db:.1f} dB",
        converter_line(limits),
    ]
    lines += ["", f"{'force':>8} {'sensor':>10} {'tactile voltage':>16}"]
    for force in (0.0, 0.2, 0.8, 1.3, 3.0, 8.0, 20.0):
        conductance = sensor_conductance_s(force)
        ohm = f"{1 / conductance:.0f} ohm" if conductance else "open"
        lines.append(f"{force:6g} N {ohm:>10} {bridge.tactile_v(conductance, design.board.supply_v):14.2f} V")
    lines += ["", "The article's own figures:"]
    for finding in values.findings:
        lines += [f"  {finding.subject}", f"    says:  {finding.says}", f"    right: {finding.right}"]
    return "\n".join(lines)
