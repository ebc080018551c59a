"""Separate process that projects parts, because the B-rep kernel can hang or crash, as in `cad.files.step_process`."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path

from fingertip.design.geometry.sizes import ViewName
from fingertip.design.geometry.solids import Solid
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.files import TemporaryFolder
from fingertip.foundation.processes import end_with_parent, python_command, python_environment
from fingertip.pictures.drawing.primitives import PROJECTIONS, ProjectedView

# Program that projects parts: `python -m fingertip.pictures.drawing.projection FOLDER`, with a pickled job on stdin.


ANSWER_FILE = "answer.pickle"
"""File with the views of each part, or with a `FingertipError`."""
Job = tuple[tuple[str, Solid, tuple[ViewName, ...]], ...]
"""Name, solid and views of each part."""
PartViews = dict[str, dict[ViewName, ProjectedView]]


def run_job(job: Job) -> PartViews:
    """Project every part in its views. Raises MissingLibraryError or GeometryError."""
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if cadquery cannot be loaded  # noqa: PLC0415
    from fingertip.pictures.drawing.hidden_lines import project  # noqa: PLC0415

    evaluator = brep.BrepEvaluator()
    views: PartViews = {}
    for name, solid, wanted in job:
        shape = evaluator.solid(solid)
        views[name] = {view: project(shape, view) for view in PROJECTIONS if view in wanted}
    return views


def main() -> None:
    """Run the job on stdin and write its result or its error."""
    end_with_parent()
    answer: PartViews | FingertipError
    try:
        answer = run_job(pickle.load(sys.stdin.buffer))
    except FingertipError as error:
        answer = error
    (Path(sys.argv[1]) / ANSWER_FILE).write_bytes(pickle.dumps(answer))


if __name__ == "__main__":
    main()
    os._exit(0)  # unloading the kernel's libraries would take a third of a second


TIME_LIMIT_S = 180.0


def project_parts(job: Job, time_limit_s: float = TIME_LIMIT_S) -> PartViews:
    with TemporaryFolder() as folder:
        try:
            done = subprocess.run(
                python_command("fingertip.pictures.drawing.projection", str(folder)),
                input=pickle.dumps(job),
                stdout=subprocess.DEVNULL,  # Open CASCADE prints there
                stderr=subprocess.PIPE,
                timeout=time_limit_s,
                cwd=folder,  # ezdxf reads settings of the current folder
                env=python_environment(),
                check=False,
            )
        except subprocess.TimeoutExpired:
            message = f"the B-rep kernel was still projecting after {time_limit_s:g} s; check the design with build."
            raise GeometryError(Issue("drawing", message)) from None
        answer_file = folder / ANSWER_FILE
        if not answer_file.exists():
            last = done.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
            raise GeometryError(Issue("drawing", f"the B-rep kernel crashed ({last[0]}); check the design with build."))
        answer: PartViews | FingertipError = pickle.loads(answer_file.read_bytes())
    if isinstance(answer, FingertipError):
        raise answer
    return answer
