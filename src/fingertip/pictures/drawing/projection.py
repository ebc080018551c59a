"""Separate process that projects parts, because the B-rep kernel can hang or crash, as in `cad.files.step_process`."""

from __future__ import annotations

import pickle
import subprocess

from fingertip.design.geometry.sizes import ViewName
from fingertip.design.geometry.solids import Solid
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.files import TemporaryFolder
from fingertip.foundation.processes import python_command, python_environment
from fingertip.pictures.drawing.primitives import PROJECTIONS, ProjectedView

Job = tuple[tuple[str, Solid, tuple[ViewName, ...]], ...]
"""Name, solid and views of each part."""
PartViews = dict[str, dict[ViewName, ProjectedView]]


def run_job(job: Job) -> PartViews:
    """Project every part in its views. Raises MissingLibraryError or GeometryError."""
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if OCP cannot be loaded  # noqa: PLC0415
    from fingertip.pictures.drawing.hidden_lines import project  # noqa: PLC0415

    evaluator = brep.BrepEvaluator()
    views: PartViews = {}
    for name, solid, wanted in job:
        shape = evaluator.solid(solid)
        views[name] = {view: project(shape, view) for view in PROJECTIONS if view in wanted}
    return views


TIME_LIMIT_S = 180.0


def project_parts(job: Job, time_limit_s: float = TIME_LIMIT_S) -> PartViews:
    with TemporaryFolder() as folder:  # ezdxf reads settings of the current folder
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
    views, error = ({}, last[0]) if done.returncode else pickle.loads(done.stdout)
    if isinstance(error, FingertipError):
        raise error
    if error is not None:
        raise GeometryError(Issue("drawing", f"the B-rep kernel crashed ({error}); check the design with build."))
    return views  # type: ignore[no-any-return]
