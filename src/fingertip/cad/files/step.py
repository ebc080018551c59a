"""Asks the STEP process for files, beside whatever else is being done, and within a time limit."""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from fingertip import errors
from fingertip.cad.solids import Solid
from fingertip.errors import GeometryError, Issue

TIME_LIMIT_S = 180.0
DOING = "doing.txt"
"""Where the process leaves word of what it is doing."""


@dataclass(frozen=True)
class StepJob:
    """What to make and to measure; `title` names the assembly."""

    title: str
    parts: tuple[tuple[str, Solid, tuple[float, float, float]], ...]
    """Name, expression, colour."""
    hollows: tuple[tuple[str, Solid], ...] = ()
    """Solids of which only the volume is asked for."""


@dataclass(frozen=True)
class Exact:
    """What the B-rep kernel measured on a part; one valid solid it is, or there is no answer."""

    volume_mm3: float
    genus: int


@dataclass(frozen=True)
class StepFiles:
    """What came back: file name -> bytes, each part's measures, and the hollows' volumes."""

    contents: dict[str, bytes]
    exact: dict[str, Exact]
    hollow_mm3: dict[str, float]


class StepRequest:
    """A STEP job under way; a context manager, so that the process never outlives its use."""

    def __init__(self, job: StepJob) -> None:
        self._job = job

    def __enter__(self) -> StepRequest:
        self._folder = tempfile.TemporaryDirectory(prefix="fingertip-step-")
        self._process = subprocess.Popen(
            [sys.executable, "-m", "fingertip.cad.files.step_worker", self._folder.name],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,  # the kernel prints there
            stderr=subprocess.PIPE,
            start_new_session=True,  # so that its own child ends with it
        )
        assert self._process.stdin is not None
        self._process.stdin.write(pickle.dumps(self._job))
        self._process.stdin.flush()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._kill()
        self._process.communicate()
        self._folder.cleanup()

    def _kill(self) -> None:
        """End the process, and the one it may have begun."""
        if sys.platform == "win32":
            self._process.kill()
            return
        with contextlib.suppress(ProcessLookupError, PermissionError):  # both are over
            os.killpg(self._process.pid, signal.SIGKILL)

    def result(self, time_limit_s: float = TIME_LIMIT_S) -> StepFiles:
        """Wait for the files.

        Raises
        ------
        GeometryError
            If the kernel fails, crashes, or takes longer than `time_limit_s` [s].
        MissingLibraryError
            If cadquery cannot be loaded; the sentence names the packages to install.
        """
        try:
            _, words = self._process.communicate(timeout=time_limit_s)
        except subprocess.TimeoutExpired:
            doing = Path(self._folder.name) / DOING
            stage = doing.read_text(encoding="utf-8") if doing.exists() else "starting"
            sentence = f"the B-rep kernel was still {stage} after {time_limit_s:g} s; use --formats stl,3mf."
            raise GeometryError(Issue("STEP", sentence)) from None
        folder = Path(self._folder.name)
        answer_file = folder / "answer.json"
        if not answer_file.exists():
            last = words.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
            raise GeometryError(Issue("STEP", f"the B-rep process ended without an answer ({last[0]})."))
        answer = json.loads(answer_file.read_text(encoding="utf-8"))
        if "error" in answer:
            raise getattr(errors, answer["error"])([Issue(*issue) for issue in answer["issues"]])
        contents = {path.name: path.read_bytes() for path in sorted(folder.glob("*.step"))}
        exact = {name: Exact(**measures) for name, measures in answer["exact"].items()}
        return StepFiles(contents, exact, answer["hollow_mm3"])
