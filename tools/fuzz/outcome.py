"""Outcome of a case, and the faults it shows."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from tools.fuzz import promises
from tools.fuzz.cases import Case

WAIT_LIMIT_S = 300.0
"""Time of a case that waits for something other than a processor,
which a process of its own may wait for [s].
"""
MEMORY_LIMIT_BYTES = 2**30
EXIT_CODES = frozenset({0, 1, 2})
"""Documented exit codes, but those of faults of the program and of interruptions."""
MAX_LINE = 5000
_SATURATED = "the converter is saturated"
"""A design may belong to recordings of another board, so that it is
accepted and its own board is not made.
"""
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e]")
_ANSI_STYLE = re.compile("\x1b\\[[0-9;]*m")


def read_delay_s(process: int | str = "self") -> float:
    """Return how long a process was ready and waited for a
    processor [s]; 0 where the system does not say.
    """
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError, ValueError):
        return 0.0


@dataclass(frozen=True)
class Outcome:
    """Result of a run."""

    code: int | None
    """Exit code; None if the run was ended at the time limit."""
    stdout: str
    stderr: str
    peak_bytes: int
    """Largest memory that was resident."""
    seconds: float


def find_faults(case: Case, outcome: Outcome, folder: Path) -> Iterator[str]:
    """Yield the faults of the run of one command: kind and detail."""
    if outcome.code is None:
        yield f"hang: no end after {outcome.seconds:.0f} s"
        return

    if outcome.peak_bytes > MEMORY_LIMIT_BYTES:
        yield f"memory: {outcome.peak_bytes / 2**20:.0f} MB"

    if outcome.code == 70 or "Traceback (most recent call last)" in outcome.stderr:
        yield f"traceback: {outcome.stderr[-600:]}"
    elif outcome.code not in EXIT_CODES or (outcome.code == 1 and not case.may_fail):
        yield f"exit code: {outcome.code}: {outcome.stderr[-300:]}"

    if outcome.code == 2 and "rror" not in outcome.stderr:
        yield "silent: refused without a message"
    if outcome.code == 2 and case.is_accepted and _SATURATED not in outcome.stderr:
        yield f"refused: {outcome.stderr[-600:]}"

    for name, text in (("stdout", outcome.stdout), ("stderr", _ANSI_STYLE.sub("", outcome.stderr))):
        found = _CONTROL.search(text)
        if found:
            yield f"control: {found[0]!r} on {name}"

    longest = max(map(len, outcome.stderr.splitlines()), default=0)
    if longest > MAX_LINE:
        yield f"length: a line of {longest} characters on stderr"

    try:
        if outcome.code in (0, 1) and "--json" in case.words:
            promises.read_json(outcome.stdout)
        if outcome.code == 0 and case.promise in _PROMISES:
            _PROMISES[case.promise](outcome, folder)
    except Exception as error:
        yield f"invalid: {type(error).__name__}: {str(error)[:300]}"


def judge(case: Case, top: Path, run: Callable[[Case, Path], Outcome]) -> tuple[Outcome, list[str]]:
    """Run the commands of a case in a folder within another, one after the other, and find the
    faults of all.

    The case ends at the first command that is refused, and at the first fault. A command that is
    refused writes nothing, and none leaves temporary files, which stand beside the folder, or
    processes.
    """
    folder = top / "case"
    temporary = top / "tmp"
    for path in (folder, temporary):
        path.mkdir()

    outcomes = []
    faults = list[str]()
    before_tempdir = tempfile.tempdir
    tempfile.tempdir = str(temporary)
    os.environ["TMPDIR"] = str(temporary)

    try:
        write_files(case.files, folder)
        for words in (case.words, *case.then):
            before = sorted(folder.rglob("*"))
            outcomes.append(run(replace(case, words=words), folder))
            faults += find_faults(replace(case, words=words), outcomes[-1], folder)

            if (
                outcomes[-1].code == 2
                and sorted(folder.rglob("*")) != before
                and case.promise == "files"
            ):
                faults.append("litter: refused, and yet written")

            left = [
                path
                for place in (temporary, folder)
                for path in place.rglob("[.]*" if place == folder else "*")
                if path.name != ".gitattributes"
            ]
            if left:
                faults.append(f"litter: {[read_end(path) for path in left]}")
            if faults or outcomes[-1].code == 2:
                break

        if case.promise == "files" and not faults:
            faults += (f"promise: {broken}" for broken in promises.check_folder(folder))
    finally:
        tempfile.tempdir = before_tempdir
        shutil.rmtree(folder)
        shutil.rmtree(temporary)

    seconds = sum(outcome.seconds for outcome in outcomes)
    peak = max(outcome.peak_bytes for outcome in outcomes)
    return replace(outcomes[-1], seconds=seconds, peak_bytes=peak), faults


def write_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Write the files of a case."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)


def read_end(path: Path) -> str:
    """Read name and end of what a command left: of a fault of the program, its details."""
    return (
        f"{path.name}: {path.read_bytes()[-1500:].decode(errors='replace')}"
        if path.is_file()
        else path.name
    )


def _check_design(outcome: Outcome, folder: Path) -> None:
    """Check that the design that was printed can be read, is valid and is printed again alike."""
    from fingertip.design import Design
    from fingertip.design.design_file import to_toml

    path = folder / "printed.toml"
    path.write_text(outcome.stdout, encoding="utf-8")
    assert to_toml(Design.load(path)).strip() == outcome.stdout.strip()


def _check_detection(outcome: Outcome, folder: Path) -> None:
    """Check that the detection is JSON whose intervals are finite and in order."""
    found = json.loads(outcome.stdout)
    times = [interval[key] for interval in found["intervals"] for key in ("onset_s", "end_s")]
    assert all(time is not None and math.isfinite(time) for time in times), times
    assert times == sorted(times), times


_PROMISES = {"design": _check_design, "detection": _check_detection}
