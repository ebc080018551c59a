"""STEP files of a design, made by a process of its own, and a handle that starts it and waits for
it.

There are three reasons for that. The B-rep kernel can hang or crash. It numbers products through
the life of a process, and the numbers would end up in the files. It takes seconds to load and to
compute, and leaves the processors to this process, whose meshes are wanted first.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.kernel.kernel_process import import_without_viewer, start_kernel
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.workers import Worker, WorkerDiedError, report_step
from fingertip.models.solids import Solid

TIME_LIMIT_S = 180.0
_NICENESS = 10
"""Priority that leaves the processors to other processes, where the system has priorities."""
_BESIDE_OWN = ("bone", "skin")
"""Parts that one process makes, while another makes all others: they share the bone's body, and
take as long as the rest together.
"""
_SAVED = "saving the solids"


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
    """Name of a part, and a function of the evaluator: what else is
    computed by the process that makes the part.
    """


@dataclass(frozen=True)
class BrepMeasurements:
    """Measurements of a part's B-rep solid, which is known to be a single valid solid."""

    volume_mm3: float
    genus: int


Measured = tuple[dict[str, BrepMeasurements], dict[str, float], dict[str, Any]]
"""Measurements of the parts, volumes of the other solids [mm3],
and what else was computed, by name.
"""


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
    worker: Worker

    @classmethod
    @contextlib.contextmanager
    def start(cls, job: StepJob) -> Iterator[StepProcess]:
        """Start a job in a process that ends with the block."""
        # Open CASCADE reads settings of the current folder.
        with temporary_folder() as folder, start_kernel(folder) as worker:
            worker.send(run_job, job, folder)
            yield cls(job, folder, worker)

    def result(
        self,
        time_limit_s: float = TIME_LIMIT_S,
        *,
        advance: Callable[[float], None] = lambda _: None,
    ) -> StepFiles:
        """Wait for the files. Raises GeometryError or MissingLibraryError."""
        steps = len(("starting", "loading", "hardware", "assembly"))
        steps += 2 * len(self.job.parts) + len(self.job.measured_solids) + len(self.job.also)

        try:
            measured: Measured = self.worker.receive_within(
                time_limit_s, lambda: advance(len(self.worker.steps) / steps)
            )
        except FingertipError:
            raise
        except TimeoutError:
            status = self.worker.steps[-1] if self.worker.steps else "starting"
            problem = f"was still {status} after {time_limit_s:g} s"
        except WorkerDiedError as death:
            problem = f"crashed ({death})"
        except Exception as error:
            problem = f"crashed ({type(error).__name__}: {error})"
        else:
            return StepFiles(
                {path.name: path.read_bytes() for path in sorted(self.folder.glob("*.step"))},
                *measured,
            )

        raise GeometryError(Issue("STEP", f"the B-rep kernel {problem}; use --formats stl,3mf."))


def run_job(job: StepJob, folder: Path) -> Measured:
    """Write `<part>.step` for each part and `assembly.step`, and measure parts and solids, as the
    process does it.

    On Linux the parts are made in two processes: these share little, and most machines have two
    cores. The fork precedes every boolean, because the kernel's threads do not survive it.

    Raises MissingLibraryError or GeometryError.
    """
    if hasattr(os, "nice"):
        os.nice(_NICENESS)

    report_step("loading Open CASCADE")
    import_without_viewer()
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if OCP cannot be loaded  # noqa: PLC0415

    own_job, other_job = (
        _split_job(job) if sys.platform == "linux" else (job, StepJob(job.title, ()))
    )

    with _run_beside(other_job, folder) as receive:
        evaluator, solids = _make_solids(own_job)
        _write_parts(solids, folder)
        report_step("making the hardware")
        bought = [(name, evaluator.solid(solid), colour) for name, solid, colour in job.hardware]
        receive(_SAVED)
        solids_beside = [
            (name, brep.load(folder / f"{name}.brep"), colour)
            for name, _, colour in other_job.parts
        ]
        assembled = [solid for solid in solids + solids_beside if solid[0] not in job.tools]
        report_step("writing the assembly")
        from fingertip.cad.files import step_writer  # noqa: PLC0415

        step_writer.write_assembly(
            folder / "assembly.step", f"fingertip_{job.title}", assembled + bought
        )
        measured = _measure(own_job, evaluator, solids)
        parts, volumes, also = receive(None) or ({}, {}, {})
        return measured[0] | parts, measured[1] | volumes, measured[2] | also


def _split_job(job: StepJob) -> tuple[StepJob, StepJob]:
    """Split a job into those of two processes; what is measured belongs to the second."""
    own_parts = tuple(part for part in job.parts if part[0] in _BESIDE_OWN)
    others = tuple(part for part in job.parts if part[0] not in _BESIDE_OWN)
    if not own_parts:
        return job, StepJob(job.title, ())

    own_names = {name for name, _, _ in own_parts}
    own = StepJob(
        title=job.title,
        parts=own_parts,
        measured_solids=() if others else job.measured_solids,
        also=tuple(one for one in job.also if one[0] in own_names),
    )
    other = StepJob(
        title=job.title,
        parts=others,
        measured_solids=job.measured_solids,
        also=tuple(one for one in job.also if one[0] not in own_names),
    )

    return own, other


@contextlib.contextmanager
def _run_beside(job: StepJob, folder: Path) -> Iterator[Callable[[str | None], Any]]:
    """Do a job in a forked process; what is provided waits for one of its steps, or for its
    measurements.

    The process saves its solids as `<part>.brep`. While this process writes the assembly from them,
    it writes their STEP files, measures them and draws them.
    """
    if not job.parts:
        yield lambda _: None
        return

    with Worker(is_fork=True) as worker:
        worker.send(_run_other_job, job, folder)

        def receive(until: str | None) -> Any:
            try:
                return worker.receive(until, report_step)
            except WorkerDiedError:
                names = ", ".join(name for name, _, _ in job.parts)
                message = f"the B-rep kernel crashed while it made {names}; use --formats stl,3mf."
                raise GeometryError(Issue("STEP", message)) from None

        yield receive


def _run_other_job(job: StepJob, folder: Path) -> Measured:
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    evaluator, solids = _make_solids(job)
    for name, solid, _ in solids:
        brep.save(solid, folder / f"{name}.brep")

    report_step(_SAVED)
    _write_parts(solids, folder)
    return _measure(job, evaluator, solids)


def _make_solids(job: StepJob) -> tuple[Any, list[Any]]:
    """Evaluate the parts; returns the evaluator, and name, solid and colour of each part."""
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    evaluator = brep.BrepEvaluator()
    solids = []

    for name, solid, colour in job.parts:
        report_step(f"making {name}")
        solids.append((name, evaluator.solid(solid), colour))

    return evaluator, solids


def _write_parts(solids: list[Any], folder: Path) -> None:
    from fingertip.cad.files import step_writer  # noqa: PLC0415

    for part in solids:
        report_step(f"writing {part[0]}")
        step_writer.write_part(folder / f"{part[0]}.step", part)


def _measure(job: StepJob, evaluator: Any, solids: list[Any]) -> Measured:
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    volumes = {}
    for name, solid in job.measured_solids:
        report_step(f"measuring {name}")
        volumes[name] = brep.volume(evaluator.shape(solid))

    parts = {
        name: BrepMeasurements(brep.volume(solid), brep.genus(solid)) for name, solid, _ in solids
    }
    also = {}
    for name, compute in job.also:
        report_step(f"drawing {name}")
        also[name] = compute(evaluator)

    return parts, volumes, also
