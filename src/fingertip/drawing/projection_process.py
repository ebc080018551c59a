"""Separate process that projects parts, because the B-rep kernel can hang or crash, as in `cad.files.step_process`."""

from __future__ import annotations

import pickle
import subprocess
import sys

from fingertip import errors
from fingertip.drawing.projection_worker import ANSWER_FILE, Failure, Job, PartViews
from fingertip.errors import GeometryError, Issue
from fingertip.temporary import TemporaryFolder

TIME_LIMIT_S = 180.0
"""Time after which the process is stopped [s]."""


def project_parts(job: Job, time_limit_s: float = TIME_LIMIT_S) -> PartViews:
    """Project every part of a job in its views.

    Raises
    ------
    GeometryError
        If the kernel fails, crashes, or takes longer than `time_limit_s` [s].
    MissingLibraryError
        If cadquery cannot be loaded. The message names the packages to install.
    """
    with TemporaryFolder() as folder:
        command = [sys.executable, "-m", "fingertip.drawing.projection_worker", str(folder)]
        try:
            done = subprocess.run(
                command,
                input=pickle.dumps(job),
                stdout=subprocess.DEVNULL,  # Open CASCADE prints there
                stderr=subprocess.PIPE,
                timeout=time_limit_s,
                check=False,
            )
        except subprocess.TimeoutExpired:
            message = f"the B-rep kernel was still projecting after {time_limit_s:g} s; check the design with build."
            raise GeometryError(Issue("drawing", message)) from None
        answer_file = folder / ANSWER_FILE
        if not answer_file.exists():
            last = done.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
            raise GeometryError(Issue("drawing", f"the B-rep kernel crashed ({last[0]}); check the design with build."))
        answer: PartViews | Failure = pickle.loads(answer_file.read_bytes())
    if isinstance(answer, tuple):
        raise getattr(errors, answer[0])(answer[1])
    return answer
