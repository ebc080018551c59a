"""Command `python -m benchmarks.peers`: error and run time of the simulation beside other solvers.

Exit code 1: a target is missed.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from benchmarks.command import answer
from benchmarks.peers.options import FILES, PEERS, read_options, require_libraries
from fingertip.cli.console import Console
from fingertip.foundation.output_set import SetWriter, hash_parameters


def main(words: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument(
        "--out",
        "-o",
        type=Path,
        default=Path("out/bench"),
        help="folder for pictures, text and data",
    )
    parser.add_argument(
        "--seconds",
        type=float,
        default=5.0,
        help="seconds of the contact problem, 1 to 60; the board's is a fifth as long, at least "
        "0.5 s",
    )
    parser.add_argument(
        "--boards", type=int, default=10_000, help="number of boards to simulate at once"
    )
    parser.add_argument(
        "--solvers", default=",".join(PEERS), help="comma-separated: scipy's, others in C, ngspice"
    )
    parser.add_argument(
        "--first-run",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="also measure a fresh process, with an empty and with a full compiler cache",
    )
    parser.add_argument(
        "--verbose", "-v", action="store_true", help="print the details too, not only the verdict"
    )
    answer(parser, _run, words)


def _run(options: argparse.Namespace, console: Console) -> None:
    names = read_options(options.solvers, options.seconds, options.boards)
    writer = SetWriter(options.out, "benchmark", "", hash_parameters([]))
    writer.check(FILES)
    require_libraries()
    from benchmarks.peers.run import run

    found = run(
        names,
        seconds=options.seconds,
        boards=options.boards,
        first_run=options.first_run,
        progress=console.progress,
    )
    writer.write(dict(zip(FILES, found.encode(), strict=True)))
    details = f"details: {options.out / 'work_precision.txt'}, or --verbose"
    text = found.text if options.verbose else "\n".join([*found.verdict, details])
    console.result(found.data, text, passed=not found.misses_target)


if __name__ == "__main__":
    main()
