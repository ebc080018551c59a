"""Pieces of a run: each in a forked process, with a file of its
results, so that a run goes on where it was stopped.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import multiprocessing
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterable
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import fingertip
from fingertip.foundation.workers import end_with

SILENCE_S = 600.0
"""Time after which a piece that has no new result hangs where no time limit of a case reaches."""
SAID_S = 15.0
"""Time between two messages on progress."""
MAX_CRASHES = 20
_CONTEXT = multiprocessing.get_context("fork")

Line = dict[str, Any]
"""Result of a case."""
RunPiece = Callable[[range, Path, Callable[[Line], None]], None]
"""Function of the numbers of a piece that have no result yet, a
folder to work in, and where results go.
"""
_CRASH: Line = {
    "family": "crash",
    "code": None,
    "seconds": 0.0,
    "peak": 0,
    "words": [],
    "files": {},
}


def hash_source() -> str:
    """Hash the program's source, which a stopped run may find changed."""
    found = hashlib.sha256()
    for path in sorted(Path(fingertip.__file__).parent.rglob("*.py")):
        found.update(path.read_bytes())

    return found.hexdigest()[:8]


def read_lines(path: Path) -> list[Line]:
    """Read the results of a piece; the last one may have been cut off."""
    lines = []
    for text in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        with contextlib.suppress(json.JSONDecodeError):
            lines.append(json.loads(text))

    return lines


class Pieces:
    """Results of pieces in a folder, and the processes that make them."""

    def __init__(self, folder: Path, run_piece: RunPiece, jobs: int) -> None:
        self.folder = folder
        self._run_piece = run_piece
        self._jobs = jobs
        folder.mkdir(parents=True, exist_ok=True)

    def run(self, count: int, size: int) -> list[Line]:
        """Run what is left of a number of cases, in pieces of a
        size, and return the results of all.
        """
        pieces = {
            number: range(start, min(start + size, count))
            for number, start in enumerate(range(0, count, size))
        }
        earlier = self._count(pieces)
        begun = time.monotonic()
        said = 0.0
        crashes = 0
        waiting = [piece for piece, cases in pieces.items() if not self._has_ended(piece, cases)]
        running: dict[int, _Running] = {}

        try:
            while (waiting or running) and crashes <= MAX_CRASHES:
                while waiting and len(running) < self._jobs:
                    piece = waiting.pop(0)
                    running[piece] = _Running(
                        _CONTEXT.Process(target=self._work, args=(piece, pieces[piece]))
                    )

                time.sleep(0.05)
                for piece, one in list(running.items()):
                    if one.is_alive(self._path(piece)):
                        continue

                    del running[piece]
                    if one.process.exitcode:
                        crashes += 1
                        print(f"crash in piece {piece}: exit code {one.process.exitcode}")
                        self._add(
                            piece, _CRASH | {"faults": [f"crash: exit code {one.process.exitcode}"]}
                        )
                        waiting = (
                            waiting if self._has_ended(piece, pieces[piece]) else [piece, *waiting]
                        )
                    # Hypothesis may find no more cases before there are as many as were asked for
                    else:
                        self._end(piece, pieces[piece]).touch()

                if time.monotonic() - said > SAID_S or not (waiting or running):
                    said = time.monotonic()
                    done = self._count(pieces)
                    rate = (done - earlier) / (said - begun)
                    left = f", {(count - done) / rate / 60:.0f} min left" if rate else ""
                    print(
                        f"{self.folder.name}: {done} of {count}, {rate:.2f} per second{left}",
                        flush=True,
                    )
        finally:
            for one in running.values():
                one.process.kill()

        return [line for piece in pieces for line in read_lines(self._path(piece))]

    def _path(self, piece: int) -> Path:
        return self.folder / f"{piece:05d}.jsonl"

    def _count(self, pieces: Iterable[int]) -> int:
        return sum(len(read_lines(self._path(piece))) for piece in pieces)

    def _has_ended(self, piece: int, cases: range) -> bool:
        return self._end(piece, cases).exists() or self._count([piece]) >= len(cases)

    def _end(self, piece: int, cases: range) -> Path:
        return self._path(piece).with_suffix(f".{len(cases)}-ended")

    def _add(self, piece: int, line: Line) -> None:
        with self._path(piece).open("a", encoding="utf-8") as file:
            file.write("\n" + json.dumps(line))  # after what a process that was killed has left

    def _work(self, piece: int, cases: range) -> None:
        """Run a piece, in a process of its own."""
        end_with(os.getppid())
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that started this one kills it
        work = self.folder / f"work-{piece:05d}"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()

        try:
            self._run_piece(
                cases[self._count([piece]) :], work, lambda line: self._add(piece, line)
            )
        finally:
            shutil.rmtree(work, ignore_errors=True)


class _Running:
    """Process of a piece, which is killed when its results do not grow."""

    def __init__(self, process: BaseProcess) -> None:
        self.process = process
        self._length = -1
        self._grew = time.monotonic()
        process.start()

    def is_alive(self, results: Path) -> bool:
        """Return whether the piece goes on."""
        length = results.stat().st_size if results.exists() else 0
        if length != self._length:
            self._length = length
            self._grew = time.monotonic()
        elif time.monotonic() - self._grew > SILENCE_S:
            self.process.kill()

        return self.process.is_alive()
