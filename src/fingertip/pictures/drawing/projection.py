"""Projection of parts, and the separate process that it runs in: the B-rep kernel can hang or crash, as in
`cad.files.step_process`, whose processes project the parts that they have made anyway.
"""

from __future__ import annotations

import pickle
import subprocess
from collections.abc import Callable, Collection
from typing import Any, TypeVar

from fingertip.design.geometry.sizes import ViewName
from fingertip.design.geometry.solids import Solid
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.processes import python_command, python_environment
from fingertip.pictures.drawing.primitives import PROJECTIONS, ProjectedView

T = TypeVar("T")
Job = tuple[tuple[str, Callable[[Any], T]], ...]
"""Functions of the B-rep evaluator by the names of their results."""


def project_part(solid: Solid, wanted: Collection[ViewName], evaluator: Any) -> dict[ViewName, ProjectedView]:
    """Project a part in its views. Raises GeometryError."""
    from fingertip.pictures.drawing.hidden_lines import project  # noqa: PLC0415

    shape = evaluator.solid(solid)
    return {view: project(shape, view) for view in PROJECTIONS if view in wanted}


def run_job(job: Job[T]) -> dict[str, T]:
    """Compute everything with one evaluator. Raises MissingLibraryError or GeometryError."""
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if OCP cannot be loaded  # noqa: PLC0415

    evaluator = brep.BrepEvaluator()
    return {name: compute(evaluator) for name, compute in job}


TIME_LIMIT_S = 180.0


def run_apart(job: Job[T], time_limit_s: float = TIME_LIMIT_S) -> dict[str, T]:
    """Run a job in a process of its own. Raises MissingLibraryError or GeometryError."""
    with temporary_folder() as folder:  # ezdxf reads settings of the current folder
        try:
            done = subprocess.run(
                python_command("fingertip.foundation.processes"),
                input=pickle.dumps((None, None, run_job, (job,))),
                capture_output=True,
                timeout=time_limit_s,
                cwd=folder,
                env=python_environment(),
                check=False,
            )
        except subprocess.TimeoutExpired:
            message = f"the B-rep kernel was still projecting after {time_limit_s:g} s; check the design with build."
            raise GeometryError(Issue("drawing", message)) from None
    last = done.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
    found, error = ({}, last[0]) if done.returncode else pickle.loads(done.stdout)
    if isinstance(error, FingertipError):
        raise error
    if error is not None:
        raise GeometryError(Issue("drawing", f"the B-rep kernel crashed ({error}); check the design with build."))
    return found  # type: ignore[no-any-return]
