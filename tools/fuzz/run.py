"""Command `python -m tools.fuzz.run`: run thousands of cases and report what they found.

    python -m tools.fuzz.run --cases 20000 --processes 1000 --seed 0 --out found

The cases of a seed are the same each time. Each piece of cases runs in a process of its own, so that one that dies is
counted and the others go on. The files of every case with a fault are kept in the folder `--out`. Exit code 1: there is
a fault.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from multiprocessing.pool import ThreadPool
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings

from tools.fuzz import as_process, in_process
from tools.fuzz.cases import Case, cases
from tools.fuzz.outcome import Outcome, find_faults

PIECE = 100
"""Number of cases in a piece."""
PIECE_LIMIT_S = 3600.0
MAX_CRASHES = 20


def run_cases(
    count: int,
    first_seed: int,
    report: Callable[[Case, Outcome, list[str]], None],
    run: Callable[[Case, Path], Outcome] = in_process.run,
) -> None:
    """Draw cases from a seed, run each in an empty folder, and report its faults."""
    with tempfile.TemporaryDirectory(prefix="fingertip-fuzz-") as top:
        folder = Path(top) / "case"

        def try_case(case: Case) -> None:
            folder.mkdir()
            try:
                outcome = run(case, folder)
                report(case, outcome, list(find_faults(case, outcome, folder)))
            finally:
                shutil.rmtree(folder)

        wrapped = given(cases())(try_case)
        wrapped = settings(
            max_examples=count, database=None, deadline=None, phases=(Phase.generate,),
            suppress_health_check=list(HealthCheck),
        )(wrapped)  # fmt: skip
        seed(first_seed)(wrapped)()


def _run_piece(count: int, first_seed: int, kind: str) -> None:
    """Run a piece and print a line of JSON for each case."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    def report(case: Case, outcome: Outcome, faults: list[str]) -> None:
        line: dict[str, object] = {
            "family": case.family, "code": outcome.code, "seconds": round(outcome.seconds, 3),
            "peak": outcome.peak_bytes, "faults": faults,
        }  # fmt: skip
        if faults:
            line |= {"words": case.words, "files": {name: data.hex() for name, data in case.files.items()}}
        print(json.dumps(line), flush=True)

    run_cases(count, first_seed, report, as_process.run if kind == "process" else in_process.run)


def _start_piece(piece: tuple[str, int, int]) -> tuple[int, list[dict[str, Any]], str]:
    """Run a piece in a process of its own: its seed, its lines, and what it said if it did not end well."""
    kind, count, piece_seed = piece
    command = [sys.executable, "-m", "tools.fuzz.run", "--piece", kind, str(count), str(piece_seed)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PIECE_LIMIT_S)
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.endswith("}")]
    return piece_seed, lines, f"exit code {done.returncode}, {done.stderr[-2000:]}" if done.returncode else ""


def _keep(found: Path, number: int, line: dict[str, object]) -> None:
    """Keep the files of a case with a fault, and its command."""
    folder = found / f"{number:05d}"
    files = line.pop("files")
    assert isinstance(files, dict)
    folder.mkdir(parents=True, exist_ok=True)
    in_process.write_files({name: bytes.fromhex(data) for name, data in files.items()}, folder)
    (folder / "case.json").write_text(json.dumps(line, indent=1) + "\n", encoding="utf-8")


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--cases", type=int, default=20_000, help="cases in process")
    parser.add_argument("--processes", type=int, default=1_000, help="cases as processes")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1, help="pieces at a time")
    parser.add_argument("--out", type=Path, default=Path("found"), help="folder for the cases with a fault")
    parser.add_argument("--piece", nargs=3, metavar=("KIND", "COUNT", "SEED"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.piece:
        kind, count, first_seed = options.piece
        _run_piece(int(count), int(first_seed), kind)
        return 0
    begun = time.monotonic()
    totals: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    slowest, largest = 0.0, 0
    seeds = itertools.count(options.seed * 10_000)
    for kind, wanted in (("case", options.cases), ("process", options.processes)):
        done = 0
        with ThreadPool(options.jobs) as pool:
            while done < wanted:  # a piece whose process dies is made up for by another
                counts = [min(PIECE, wanted - done - start) for start in range(0, wanted - done, PIECE)]
                pieces = [(kind, count, next(seeds)) for count in counts]
                for piece_seed, lines, error in pool.imap(_start_piece, pieces):
                    done += len(lines)
                    for line in lines:
                        totals[f"{line['family']}, exit code {line['code']}"] += 1
                        slowest, largest = max(slowest, line["seconds"]), max(largest, line["peak"])
                        for fault in line["faults"]:
                            kinds[fault.partition(":")[0]] += 1
                        if line["faults"]:
                            print(f"{' '.join(line['words'])[:150]!a}: {line['faults'][0][-300:]!a}", flush=True)
                            _keep(options.out, sum(kinds.values()), line)
                    if error:
                        kinds["crash"] += 1
                        print(f"crash of the piece with seed {piece_seed}: {error}", flush=True)
                    print(f"{done} as {kind} after {time.monotonic() - begun:.0f} s", flush=True)
                if kinds["crash"] > MAX_CRASHES:
                    print("too many pieces ended before their end", flush=True)
                    return 1
    for name, number in sorted(totals.items()):
        print(f"{number:6d}  {name}")
    print(f"slowest {slowest:.1f} s, largest {largest / 2**20:.0f} MB")
    for name in ("traceback", "hang", "memory", "invalid", "exit code", "silent", "control", "length", "crash"):
        print(f"{kinds[name]:6d}  {name}")
    return 1 if kinds else 0


if __name__ == "__main__":
    raise SystemExit(main())
