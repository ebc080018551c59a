"""Program that projects parts: `python -m fingertip.drawing.projection_worker FOLDER`, with a pickled job on stdin."""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path

from fingertip.cad.solids import Solid
from fingertip.child_process import end_with_parent
from fingertip.drawing.views import PROJECTIONS, ProjectedView, ViewName
from fingertip.errors import FingertipError, Issue

ANSWER_FILE = "answer.pickle"
"""File with the views of each part, or with the name and the issues of a `FingertipError`."""
Job = tuple[tuple[str, Solid, tuple[ViewName, ...]], ...]
"""Name, solid and views of each part."""
PartViews = dict[str, dict[ViewName, ProjectedView]]
Failure = tuple[str, tuple[Issue, ...]]


def run_job(job: Job) -> PartViews:
    """Project every part in its views.

    Raises
    ------
    MissingLibraryError
        If cadquery or a system library it needs is missing.
    GeometryError
        If a part is not a single valid solid.
    """
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if cadquery cannot be loaded
    from fingertip.drawing.hidden_lines import project

    evaluator = brep.BrepEvaluator()
    views: PartViews = {}
    for name, solid, wanted in job:
        shape = evaluator.solid(solid)
        views[name] = {view: project(shape, view) for view in PROJECTIONS if view in wanted}
    return views


def main() -> None:
    """Run the job on stdin and write its result or its error."""
    end_with_parent()
    answer: PartViews | Failure
    try:
        answer = run_job(pickle.load(sys.stdin.buffer))
    except FingertipError as error:
        answer = (type(error).__name__, error.issues)
    (Path(sys.argv[1]) / ANSWER_FILE).write_bytes(pickle.dumps(answer))


if __name__ == "__main__":
    main()
    os._exit(0)  # unloading the kernel's libraries would take a third of a second
