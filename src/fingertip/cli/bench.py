"""`fingertip bench`: the simulation beside other solvers, slip detectors beside each other, and extreme cases."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import typer

from fingertip.cli.console import Console
from fingertip.cli.help_page import HelpCommand, HelpGroup
from fingertip.cli.options import JOBS, VERBOSE, command, find_file_issues, load_design, refuse

_CHECKOUT = Path(__file__).parents[3]
"""Folder of a clone, whose benchmarks are not in the wheel."""


bench = typer.Typer(
    name="bench", help="Compare the simulation and the detectors with others.", cls=HelpGroup, no_args_is_help=True
)


@bench.command(cls=HelpCommand)
@command
def solvers(
    console: Console,
    out: Path = typer.Option(Path("out/bench"), "--out", "-o", help="Folder for pictures, text and data."),
    seconds: float = typer.Option(
        5.0, help="Seconds of the contact problem, 1 to 60; the board's is a fifth as long, at least 0.5 s."
    ),
    boards: int = typer.Option(10_000, help="Number of boards to simulate at once."),
    peers: str = typer.Option(
        "LSODA,Radau,BDF,odeint,CVODE,RADAU5,RADAU,Rodas5P,ngspice",
        "--solvers",
        help="Solvers to compare with, comma-separated: scipy's, others in C, ngspice.",
    ),
    first_run: bool = typer.Option(
        True, help="Also measure a fresh process, with an empty and with a full compiler cache."
    ),
    verbose: bool = VERBOSE,
) -> None:
    """Measure error and run time of the simulation beside other solvers. Exit code 1: a target is missed."""
    from fingertip.foundation.output_set import SetWriter, hash_parameters

    _find_benchmarks("solvers")
    from benchmarks.peers.options import FILES, read_options, require_libraries

    names = read_options(peers, seconds, boards)
    writer = SetWriter(out, "benchmark", "", hash_parameters([]))
    writer.check(FILES)
    require_libraries()
    from benchmarks.peers.run import run

    found = run(names, seconds, boards, first_run, console.progress)
    writer.write(dict(zip(FILES, found.encode(), strict=True)))
    details = f"details: {out / 'work_precision.txt'}, or --verbose"
    said = found.text if verbose else "\n".join([*found.verdict, details])
    console.result(found.data, said, passed=not found.misses_target)


@bench.command(cls=HelpCommand)
@command
def slip(
    console: Console,
    recordings: Path | None = typer.Argument(
        None,
        help="Folder of a public set, or of recordings with a file labels.csv beside them (lines such as "
        "a.csv,slip,1.2,1.9, with the header file,kind,start_s,end_s); default: the project's own signals.",
    ),
    layout: str | None = typer.Option(
        None, help="Layout of a public set, as its authors publish it; `--layout list` names them."
    ),
    design: Path | None = typer.Option(None, help="Design file or bundled name; the default design if left out."),
    detectors: str | None = typer.Option(
        None,
        help="Detectors to compare, comma-separated: fast, incipient, digital (the article's chain), fft (the "
        "stronger one), plain_fft (as published), cusum, ratio (of energies), recurrent. All if left out.",
    ),
    own: Path | None = typer.Option(
        None, help="Python file with a detector of your own: find_statistic and THRESHOLD."
    ),
    share: float = typer.Option(0.25, help="Share of the project's own signals, 0.05 to 1."),
    out: Path = typer.Option(
        Path("out/bench_slip"), "--out", "-o", help="Folder for slip_curve.png, slip_bench.json and .txt."
    ),
) -> None:
    """Compare slip detectors by delay and false alarms, on labelled recordings or on the project's own signals."""
    from fingertip.foundation.output_set import SetWriter, hash_parameters

    _find_benchmarks("slip")
    from benchmarks.slip.run import FILES, read_options, run

    loaded = load_design(design, None)
    source = read_options(recordings, layout, detectors, own, share)
    writer = SetWriter(out, "slip benchmark", "", hash_parameters([]))
    writer.check(FILES)
    report = run(loaded, source, console.progress, console.warn)
    writer.write(dict(zip(FILES, report.encode(), strict=True)))
    console.result(report.as_data(), f"{report.as_text()}\nwrote {', '.join(FILES)} to {out}")


@bench.command(cls=HelpCommand)
@command
def extremes(
    console: Console,
    cases: int = typer.Option(5000, help="Number of cases of all families together, 1 to 1000000."),
    report: Path | None = typer.Option(
        None, help="Markdown file for the table, or in which it is replaced between its marks."
    ),
    jobs: int | None = JOBS,
    out: Path = typer.Option(
        Path("out/bench_extremes"), "--out", "-o", help="Folder for extremes.txt and extremes.json."
    ),
) -> None:
    """Try extreme and stiff cases of every kernel: held, refused with a reason, or wrong."""
    from fingertip.foundation.errors import Issue
    from fingertip.foundation.files import write_file
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.foundation.workers import find_workers, side_by_side

    _find_benchmarks("extremes")
    outside = Issue("--cases", f"{cases} is out of bounds; choose 1 to 1000000.")
    refuse([] if 1 <= cases <= 1_000_000 else [outside], find_file_issues("--report", report, ".md"))
    from benchmarks.extremes.run import FILES, replace_table, run

    writer = SetWriter(out, "extreme cases", "", hash_parameters([]))
    writer.check(FILES)
    with side_by_side(find_workers(jobs)):
        found = run(cases, console.progress)
    writer.write(dict(zip(FILES, found.encode(), strict=True)))
    if report:
        write_file(report, replace_table(report, found), "--report")
    console.result(found.as_data(), found.as_text(), passed=found.is_passed)


def _find_benchmarks(name: str) -> None:
    """Make the package `benchmarks` of the clone importable. Raises FingertipError."""
    from fingertip.foundation.errors import FingertipError, Issue

    if not (_CHECKOUT / "benchmarks" / "peers" / "run.py").is_file():
        problem = "needs the folder benchmarks/ of a clone of the project, which pip does not install"
        remedy = f"run `sh install.sh` in a clone, then `.venv/bin/fingertip bench {name}` there"
        raise FingertipError(Issue(f"fingertip bench {name}", f"{problem}; {remedy}."))
    sys.path.insert(0, str(_CHECKOUT))
    # Workers find it too.
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(_CHECKOUT), os.environ.get("PYTHONPATH"))))
