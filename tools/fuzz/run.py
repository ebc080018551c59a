"""Command `python -m tools.fuzz.run`: run thousands of cases and report what they found.

    python -m tools.fuzz.run --cases 20000 --processes 1000 --computing 20000 --jobs 2 --out
        out/fuzz --resume
    python -m tools.fuzz.run --only 123

Cases read generated and damaged inputs, in this process or as processes of their own, or compute
all that is made of accepted designs and scenes. Those of a seed are the same each time. Each result
stands in the folder `--out` as soon as there is one; with `--resume`, a run goes on where it was
stopped. The files of every case with a fault are kept in the folder `found` in it. Exit code 1:
there is a fault.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import json
import os
import pkgutil
import shlex
import shutil
import tempfile
from collections import Counter, defaultdict
from collections.abc import Callable
from functools import partial
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

import fingertip
from tools.fuzz import as_process, in_process
from tools.fuzz.cases import Case, cases
from tools.fuzz.computing import draw_case
from tools.fuzz.outcome import Outcome, judge, write_files
from tools.fuzz.pieces import Line, Pieces, RunPiece, hash_source

PIECE = 50
"""Number of cases in a piece."""
FAULTS = (
    "traceback",
    "hang",
    "memory",
    "invalid",
    "promise",
    "refused",
    "litter",
    "exit code",
    "silent",
    "control",
    "length",
    "crash",
)
"""Kinds of faults, in the order of the report."""

Report = Callable[[Case, Outcome, list[str]], None]


def run_cases(
    count: int,
    first_seed: int,
    report: Report,
    top: Path,
    run: Callable[[Case, Path], Outcome] = in_process.run,
    done: int = 0,
) -> None:
    """Draw cases from a seed, run each in an empty folder but for
    the first ones, and report its faults.
    """
    drawn = 0

    def try_case(case: Case) -> None:
        nonlocal drawn
        drawn += 1
        if drawn > done:
            report(case, *judge(case, top, run))

    wrapped = given(cases())(try_case)
    wrapped = settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )(wrapped)
    seed(first_seed)(wrapped)()


def compute_cases(first_seed: int, numbers: range, report: Report, top: Path) -> None:
    """Run the computing cases of some numbers."""
    for number in numbers:
        case = draw_case(first_seed, number)
        report(case, *judge(case, top, in_process.run))


def _run_piece(
    kind: str,
    first_seed: int,
    out: Path,
    numbers: range,
    top: Path,
    add: Callable[[Line], None],
) -> None:
    """Run the cases of a piece that have no result yet."""
    source = hash_source()
    number = numbers.start
    piece, done = divmod(number, PIECE)

    def report(case: Case, outcome: Outcome, faults: list[str]) -> None:
        nonlocal number
        line: Line = {
            "family": case.family,
            "code": outcome.code,
            "seconds": round(outcome.seconds, 3),
            "peak": outcome.peak_bytes,
            "source": source,
            "faults": faults,
        }
        if faults:
            again = (
                f"python -m tools.fuzz.run --seed {first_seed} --only {number}"
                if kind == "computing"
                else ""
            )
            keep(out / f"{kind}-{first_seed}-{number:05d}", case, line | {"again": again})

        add(line)
        number += 1

    if kind == "computing":
        compute_cases(first_seed, numbers, report, top)
    else:
        run = in_process.run if kind == "case" else as_process.run
        piece_seed = 10_000 * first_seed + 5000 * (kind == "process") + piece
        run_cases(done + len(numbers), piece_seed, report, top, run, done)


def keep(folder: Path, case: Case, line: Line) -> None:
    """Keep the files of a case with a fault and its commands, and print them."""
    shutil.rmtree(folder, ignore_errors=True)
    write_files(case.files, folder)
    commands = [f"fingertip {shlex.join(words)}" for words in (case.words, *case.then)]
    text = json.dumps(line | {"commands": commands}, indent=1) + "\n"
    (folder / "case.json").write_text(text, encoding="utf-8", errors="backslashreplace")
    print(
        f"FAULT {folder.name}: {line['faults'][0][-600:]!a}",
        *map(ascii, commands),
        line["again"],
        sep="\n  ",
        flush=True,
    )


def load_modules() -> None:
    """Import the program and what it imports late, so that the processes of pieces need not."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    others = [
        "numba",
        "matplotlib.figure",
        "matplotlib.backends.backend_agg",
        "PIL.Image",
        "scipy.stats",
        "lxml.etree",
    ]
    own = [module.name for module in pkgutil.walk_packages(fingertip.__path__, "fingertip.")]

    for name in [*own, *others]:
        if not name.endswith(
            ("__main__", "brep", "occ", "step_writer", "step_process", "hidden_lines")
        ):
            with contextlib.suppress(ImportError):
                importlib.import_module(name)


def _print_summary(every: list[Line]) -> bool:
    """Print what all cases gave, and return whether there is a fault."""
    totals: dict[str, list[Line]] = defaultdict(list)
    for line in every:
        totals[f"{line['family']}, exit code {line['code']}"].append(line)

    print("  cases  mean s  slowest  largest MB")
    for name, group in sorted(totals.items()):
        seconds = [line["seconds"] for line in group]
        largest = max(line["peak"] for line in group) / 2**20
        print(
            f"{len(group):7d}{sum(seconds) / len(group):8.2f}{max(seconds):9.1f}{largest:12.0f}  "
            f"{name}"
        )

    kinds = Counter(fault.partition(":")[0] for line in every for fault in line["faults"])
    for name in sorted({*kinds, *FAULTS}):
        print(f"{kinds[name]:7d}  {name}")

    sources = Counter(line.get("source") for line in every if line["family"] != "crash")
    print(f"{len(every)} cases; sources: {dict(sources)}")
    return bool(kinds)


def _run_only(number: int, first_seed: int, out: Path) -> bool:
    """Run one computing case, keep its files, and print its commands and faults."""
    found: list[str] = []

    def report(case: Case, outcome: Outcome, faults: list[str]) -> None:
        print(f"exit code {outcome.code} after {outcome.seconds:.2f} s\n{outcome.stderr}")
        keep(out / f"only-{number}", case, {"faults": faults or ["none"], "again": ""})
        found.extend(faults)

    with tempfile.TemporaryDirectory() as top:
        compute_cases(first_seed, range(number, number + 1), report, Path(top))

    return bool(found)


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--cases", type=int, default=0, help="cases that read, in process")
    parser.add_argument("--processes", type=int, default=0, help="cases that read, as processes")
    parser.add_argument("--computing", type=int, default=0, help="cases that compute")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1, help="pieces at a time")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("out/fuzz"),
        help="folder for results and cases with a fault",
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on where a run in this folder was stopped"
    )
    parser.add_argument("--only", type=int, metavar="NUMBER", help="run one case that computes")
    options = parser.parse_args()
    out = options.out.resolve()
    if options.only is not None:
        return int(_run_only(options.only, options.seed, out))

    load_modules()
    lines: list[Line] = []
    for kind, count in (
        ("computing", options.computing),
        ("case", options.cases),
        ("process", options.processes),
    ):
        folder = out / f"{kind}-{options.seed}"
        if not options.resume:
            shutil.rmtree(folder, ignore_errors=True)

        run_piece: RunPiece = partial(_run_piece, kind, options.seed, out / "found")
        lines += Pieces(folder, run_piece, options.jobs).run(count, PIECE)

    return int(_print_summary(lines))


if __name__ == "__main__":
    raise SystemExit(main())
