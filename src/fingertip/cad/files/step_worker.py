"""The process that makes STEP files: `python -m fingertip.cad.files.step_worker FOLDER`, its job pickled on stdin.

A process of its own, because the B-rep kernel can hang or crash, counts products through the life of a process
(which would end up in the files), and takes seconds to load while the meshes are made beside it.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import pickle
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.files.step import DOING, Exact, StepJob
from fingertip.errors import FingertipError, GeometryError, Issue


@dataclass(frozen=True)
class Measured:
    """What was found on parts, and volumes of hollows [mm3]."""

    exact: dict[str, Exact]
    hollow_mm3: dict[str, float]

    def __or__(self, other: Measured) -> Measured:
        return Measured(self.exact | other.exact, self.hollow_mm3 | other.hollow_mm3)


def work(job: StepJob, folder: Path) -> Measured:
    """Write `<part>.step` for each part and `assembly.step`; return what was measured.

    Half of the parts are made in a second process where the system can fork: they share little, and most machines have
    two cores. It is forked before any boolean, because the kernel's threads do not outlive a fork.

    Raises
    ------
    MissingLibraryError
        If cadquery or a library of the system it needs is not there.
    GeometryError
        If a part is not one valid solid.
    """
    note(folder, "loading cadquery")
    from fingertip.cad.kernel import brep  # it says what is missing if cadquery cannot be loaded

    here, beside = _shares(job) if sys.platform == "linux" else (job, StepJob(job.title, ()))
    with _Beside(beside, folder) as second:
        evaluator, solids = _make(here, folder)
        _write(solids, folder)
        second.made()
        together = solids + [(name, brep.load(folder / f"{name}.brep"), colour) for name, _, colour in beside.parts]
        note(folder, "writing the assembly")
        from fingertip.cad.files import step_file

        step_file.write_assembly(folder / "assembly.step", f"fingertip_{job.title}", together)
        return _measure(here, evaluator, solids, folder) | second.measured()


def _shares(job: StepJob) -> tuple[StepJob, StepJob]:
    """The first half of parts and of hollows, and the second: neighbours share expressions."""
    parts, hollows = len(job.parts) // 2, (len(job.hollows) + 1) // 2
    return (
        StepJob(job.title, job.parts[:parts], job.hollows[:hollows]),
        StepJob(job.title, job.parts[parts:], job.hollows[hollows:]),
    )


def _make(job: StepJob, folder: Path) -> tuple[Any, list[Any]]:
    """Name, solid and colour of each part, and the evaluator that made them."""
    from fingertip.cad.kernel import brep

    evaluator, solids = brep.Evaluator(), []
    for name, expression, colour in job.parts:
        note(folder, f"making {name}")
        solids.append((name, evaluator.solid(expression), colour))
    return evaluator, solids


def _measure(job: StepJob, evaluator: Any, solids: list[Any], folder: Path) -> Measured:
    from fingertip.cad.kernel import brep

    volumes = {}
    for name, expression in job.hollows:
        note(folder, f"measuring {name}")
        volumes[name] = brep.volume(evaluator.shape(expression))
    exact = {name: Exact(brep.volume(solid), brep.genus(solid)) for name, solid, _ in solids}
    return Measured(exact, volumes)


def _write(solids: list[Any], folder: Path) -> None:
    from fingertip.cad.files import step_file

    for part in solids:
        note(folder, f"writing {part[0]}")
        step_file.write_part(folder / f"{part[0]}.step", part)


class _Beside:
    """Parts made in a forked process: handed over as `<part>.brep`, then measured and written while the assembly is."""

    def __init__(self, job: StepJob, folder: Path) -> None:
        self._names = ", ".join(name for name, _, _ in job.parts)
        self._process: Any = None
        if job.parts:
            fork = multiprocessing.get_context("fork")
            self._answer, answer = fork.Pipe(duplex=False)
            self._process = fork.Process(target=_work_beside, args=(job, folder, answer), daemon=True)
            self._process.start()
            answer.close()  # so that the pipe ends if the other process does

    def __enter__(self) -> _Beside:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if not self._process:
            return
        if error:
            self._process.kill()
        self._process.join()
        if not error and self._process.exitcode:
            raise self._ended()

    def made(self) -> None:
        """Wait until the parts are there."""
        if self._process and isinstance(refusal := self._receive(), FingertipError):
            raise refusal

    def measured(self) -> Measured:
        """Wait for what was measured."""
        answer = self._receive() if self._process else Measured({}, {})
        assert isinstance(answer, Measured)
        return answer

    def _receive(self) -> object:
        try:
            return self._answer.recv()
        except EOFError:
            raise self._ended() from None

    def _ended(self) -> GeometryError:
        sentence = f"the B-rep process of {self._names} ended without an answer; use --formats stl,3mf."
        return GeometryError(Issue("STEP", sentence))


def _work_beside(job: StepJob, folder: Path, answer: Any) -> None:
    from fingertip.cad.kernel import brep

    try:
        evaluator, solids = _make(job, folder)
    except FingertipError as error:
        answer.send(error)
        return
    for name, solid, _ in solids:
        brep.save(solid, folder / f"{name}.brep")
    answer.send("made")
    answer.send(_measure(job, evaluator, solids, folder))
    _write(solids, folder)


def note(folder: Path, doing: str) -> None:
    """Leave word of what is being done, for whoever stops this process."""
    (folder / DOING).write_text(doing, encoding="utf-8")


def main() -> None:
    """Do the job on stdin; the answer, measures or issues, goes to `answer.json` in the folder."""
    folder = Path(sys.argv[1])
    job: StepJob = pickle.load(sys.stdin.buffer)
    try:
        answer: dict[str, object] = asdict(work(job, folder))
    except FingertipError as error:
        answer = {"error": type(error).__name__, "issues": [[f.field, f.message] for f in error.issues]}
    (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    main()
    os._exit(0)  # everything is written and closed; unloading the kernel's libraries takes a third of a second
