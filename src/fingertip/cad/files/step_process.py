"""Separate process that makes STEP files: its job, its result, and a handle that starts it and waits for it.

The process runs `cad.files.step_worker`. It works while this process makes the meshes, and within a time limit.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.design.geometry.solids import Solid
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.processes import python_command, python_environment

TIME_LIMIT_S = 180.0
POLL_S = 0.5
"""Time between two looks at the files of the process [s]."""
STATUS_FILE, ANSWER_FILE = "status.txt", "answer.pickle"
"""Files in which the process lists its steps, for the progress and for the message if it is stopped, and its answer."""


@dataclass(frozen=True)
class StepJob:
    """Parts to write as STEP files, and further solids to measure."""

    title: str
    parts: tuple[tuple[str, Solid, tuple[float, float, float]], ...]
    """Name, solid and colour of each part."""
    measured_solids: tuple[tuple[str, Solid], ...] = ()
    """Name and solid of what is not written, and of which only the volume is computed."""
    hardware: tuple[tuple[str, Solid, tuple[float, float, float]], ...] = ()
    """Name, solid and colour of what only the assembly holds."""
    tools: tuple[str, ...] = ()
    """Names of parts that the assembly leaves out."""
    also: tuple[tuple[str, Callable[[Any], Any]], ...] = ()
    """Name of a part, and a function of the evaluator: what else is computed by the process that makes the part."""


@dataclass(frozen=True)
class BrepMeasurements:
    """Measurements of a part's B-rep solid, which is known to be a single valid solid."""

    volume_mm3: float
    genus: int


Measured = tuple[dict[str, BrepMeasurements], dict[str, float], dict[str, Any]]
"""Measurements of the parts, volumes of the other solids [mm3], and what else was computed, by name."""


@dataclass(frozen=True)
class StepFiles:
    contents: dict[str, bytes]
    """File name -> bytes."""
    measurements: dict[str, BrepMeasurements]
    volumes_mm3: dict[str, float]
    also: dict[str, Any]


@dataclass(frozen=True)
class StepProcess:
    """Running STEP job, in a folder of its own."""

    job: StepJob
    folder: Path
    process: subprocess.Popen[bytes]

    @classmethod
    @contextlib.contextmanager
    def start(cls, job: StepJob) -> Iterator[StepProcess]:
        """Start a job in a process that ends with the block."""
        with temporary_folder() as folder:
            process = subprocess.Popen(
                python_command("fingertip.cad.files.step_worker", str(folder)),
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,  # Open CASCADE prints there
                stderr=subprocess.PIPE,
                cwd=folder,  # ezdxf and Open CASCADE read settings of the current folder
                env=python_environment(),
                start_new_session=True,  # the process group lets `_kill` end its child process too
            )
            try:
                assert process.stdin is not None
                process.stdin.write(pickle.dumps(job))
                process.stdin.flush()
                yield cls(job, folder, process)
            finally:
                _kill(process)
                process.communicate()

    def _steps(self) -> list[str]:
        status_file = self.folder / STATUS_FILE
        return ["starting", *(status_file.read_text(encoding="utf-8").splitlines() if status_file.exists() else ())]

    def result(
        self, time_limit_s: float = TIME_LIMIT_S, *, advance: Callable[[float], None] = lambda _: None
    ) -> StepFiles:
        """Wait for the files. Raises GeometryError or MissingLibraryError."""
        begun, stderr = time.monotonic(), None
        while stderr is None and (left_s := time_limit_s - (time.monotonic() - begun)) > 0:
            with contextlib.suppress(subprocess.TimeoutExpired):
                _, stderr = self.process.communicate(timeout=min(POLL_S, left_s))
            steps = len(("starting", "loading", "hardware", "assembly"))
            steps += 2 * len(self.job.parts) + len(self.job.measured_solids) + len(self.job.also)
            advance((len(self._steps()) - 1) / steps)
        if stderr is None:
            status = self._steps()[-1]
            message = f"the B-rep kernel was still {status} after {time_limit_s:g} s; use --formats stl,3mf."
            raise GeometryError(Issue("STEP", message))
        if not (self.folder / ANSWER_FILE).exists():
            last = stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
            message = f"the B-rep kernel crashed ({last[0]}); use --formats stl,3mf."
            raise GeometryError(Issue("STEP", message))
        answer: Measured | FingertipError = pickle.loads((self.folder / ANSWER_FILE).read_bytes())
        if isinstance(answer, FingertipError):
            raise answer
        return StepFiles({path.name: path.read_bytes() for path in sorted(self.folder.glob("*.step"))}, *answer)


def _kill(process: subprocess.Popen[bytes]) -> None:
    if sys.platform == "win32":
        process.kill()
        return
    with contextlib.suppress(ProcessLookupError, PermissionError):  # both have ended
        os.killpg(process.pid, signal.SIGKILL)
