"""Program of the STEP process: `python -m fingertip.cad.files.step_worker FOLDER`, with the pickled job on stdin.

STEP files are made in a process of their own for three reasons. The B-rep kernel can hang or crash. It numbers products
through the life of a process, and the numbers would end up in the files. It takes seconds to load, during which the
calling process makes the meshes.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fingertip.cad.files.step_process import ANSWER_FILE, STATUS_FILE, BrepMeasurements, Measured, StepJob
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.processes import end_with_parent


def run_job(job: StepJob, folder: Path) -> Measured:
    """Write `<part>.step` for each part and `assembly.step`, and measure parts and solids.

    On Linux half of the parts are made in a forked process: the halves share little, and most machines have two cores.
    The fork precedes every boolean, because the kernel's threads do not survive it.

    Raises MissingLibraryError or GeometryError.
    """
    write_status(folder, "loading Open CASCADE")
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if OCP cannot be loaded  # noqa: PLC0415

    own_job, forked_job = _split_job(job) if sys.platform == "linux" else (job, StepJob(job.title, ()))
    with _fork(forked_job, folder) as receive:
        evaluator, solids = _make_solids(own_job, folder)
        _write_parts(solids, folder)
        write_status(folder, "making the hardware")
        bought = [(name, evaluator.solid(solid), colour) for name, solid, colour in job.hardware]
        receive()
        all_solids = solids + [
            (name, brep.load(folder / f"{name}.brep"), colour) for name, _, colour in forked_job.parts
        ]
        all_solids = [solid for solid in all_solids if solid[0] not in job.tools]
        write_status(folder, "writing the assembly")
        from fingertip.cad.files import step_writer  # noqa: PLC0415

        step_writer.write_assembly(folder / "assembly.step", f"fingertip_{job.title}", all_solids + bought)
        measured = _measure(own_job, evaluator, solids, folder)
        parts, volumes, also = receive() or ({}, {}, {})
        return measured[0] | parts, measured[1] | volumes, measured[2] | also


def _split_job(job: StepJob) -> tuple[StepJob, StepJob]:
    """Split a job into two halves; neighbouring parts stay together, because they share solids."""
    parts, measured = len(job.parts) // 2, (len(job.measured_solids) + 1) // 2
    halves = (job.parts[:parts], job.measured_solids[:measured]), (job.parts[parts:], job.measured_solids[measured:])
    own, forked = (
        StepJob(job.title, *half, also=tuple(one for one in job.also if one[0] in {name for name, _, _ in half[0]}))
        for half in halves
    )
    return own, forked


def _make_solids(job: StepJob, folder: Path) -> tuple[Any, list[Any]]:
    """Evaluate the parts; returns the evaluator, and name, solid and colour of each part."""
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    evaluator, solids = brep.BrepEvaluator(), []
    for name, solid, colour in job.parts:
        write_status(folder, f"making {name}")
        solids.append((name, evaluator.solid(solid), colour))
    return evaluator, solids


def _measure(job: StepJob, evaluator: Any, solids: list[Any], folder: Path) -> Measured:
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    volumes = {}
    for name, solid in job.measured_solids:
        write_status(folder, f"measuring {name}")
        volumes[name] = brep.volume(evaluator.shape(solid))
    parts = {name: BrepMeasurements(brep.volume(solid), brep.genus(solid)) for name, solid, _ in solids}
    also = {}
    for name, compute in job.also:
        write_status(folder, f"drawing {name}")
        also[name] = compute(evaluator)
    return parts, volumes, also


def _write_parts(solids: list[Any], folder: Path) -> None:
    from fingertip.cad.files import step_writer  # noqa: PLC0415

    for part in solids:
        write_status(folder, f"writing {part[0]}")
        step_writer.write_part(folder / f"{part[0]}.step", part)


@contextlib.contextmanager
def _fork(job: StepJob, folder: Path) -> Iterator[Callable[[], Any]]:
    """Do a job in a forked process; what is provided waits for its next answer. Without parts there are none.

    The process saves its solids as `<part>.brep`. While this process writes the assembly from them, it writes their
    STEP files, measures them and draws them.
    """
    if not job.parts:
        yield lambda: None
        return
    names = ", ".join(name for name, _, _ in job.parts)
    crash = GeometryError(Issue("STEP", f"the B-rep kernel crashed while it made {names}; use --formats stl,3mf."))
    fork = multiprocessing.get_context("fork")
    answers, sender = fork.Pipe(duplex=False)
    process = fork.Process(target=_run_forked_job, args=(job, folder, sender), daemon=True)
    process.start()
    sender.close()  # so that reading raises EOFError if the process ends

    def receive() -> Any:
        try:
            answer = answers.recv()
        except EOFError:
            raise crash from None
        if isinstance(answer, FingertipError):
            raise answer
        return answer

    try:
        yield receive
    except BaseException:
        process.kill()
        process.join()
        raise
    process.join()
    if process.exitcode:
        raise crash


def _run_forked_job(job: StepJob, folder: Path, answer: Any) -> None:
    """Do the job in the forked process; sends an error, or "made" and then the measurements."""
    end_with_parent()
    from fingertip.cad.kernel import brep  # noqa: PLC0415

    try:
        evaluator, solids = _make_solids(job, folder)
        for name, solid, _ in solids:
            brep.save(solid, folder / f"{name}.brep")
        answer.send("made")
        _write_parts(solids, folder)
        answer.send(_measure(job, evaluator, solids, folder))
    except FingertipError as error:
        answer.send(error)


def write_status(folder: Path, status: str) -> None:
    """Add the current step to the status file, for the calling process. Both processes write to it."""
    with (folder / STATUS_FILE).open("a", encoding="utf-8") as file:
        file.write(f"{status}\n")


def main() -> None:
    """Run the job on stdin and write the measurements, or the error, to a file in the folder."""
    end_with_parent()
    folder = Path(sys.argv[1])
    job: StepJob = pickle.load(sys.stdin.buffer)
    try:
        answer: Measured | FingertipError = run_job(job, folder)
    except FingertipError as error:
        answer = error
    (folder / ANSWER_FILE).write_bytes(pickle.dumps(answer))


if __name__ == "__main__":
    main()
    os._exit(0)  # all files are closed; unloading the kernel's libraries would take a third of a second
