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
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fingertip.cad.files.step import DOING, Exact, StepJob
from fingertip.cad.solids import Solid
from fingertip.errors import Fault, FingertipError, GeometryError

Parts = Sequence[tuple[str, Solid, tuple[float, float, float]]]
"""Name, expression, colour."""


def work(job: StepJob, folder: Path) -> dict[str, Exact]:
    """Write `<part>.step` for each part and `assembly.step`; return what was measured on each.

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

    half = len(job.parts) // 2 if sys.platform == "linux" else len(job.parts)
    here, beside = job.parts[:half], job.parts[half:]
    with _Beside(beside, folder) as second:
        solids = _make(here, folder)
        _write(solids, folder)
        exact = _measures(solids) | second.measures()
        solids += [(name, brep.load(folder / f"{name}.brep"), colour) for name, _, colour in beside]
        note(folder, "writing the assembly")
        from fingertip.cad.files import step_file

        step_file.write_assembly(folder / "assembly.step", f"fingertip_{job.title}", solids)
    return exact


def _make(parts: Parts, folder: Path) -> list[Any]:
    """Name, solid and colour of each part."""
    from fingertip.cad.kernel import brep

    evaluator, solids = brep.Evaluator(), []
    for name, expression, colour in parts:
        note(folder, f"making {name}")
        solids.append((name, evaluator.solid(expression), colour))
    return solids


def _measures(solids: list[Any]) -> dict[str, Exact]:
    from fingertip.cad.kernel import brep

    return {name: Exact(brep.volume(solid), brep.genus(solid)) for name, solid, _ in solids}


def _write(solids: list[Any], folder: Path) -> None:
    from fingertip.cad.files import step_file

    for part in solids:
        note(folder, f"writing {part[0]}")
        step_file.write_part(folder / f"{part[0]}.step", part)


class _Beside:
    """Parts made in a forked process: handed over as `<part>.brep`, then written as STEP while the assembly is."""

    def __init__(self, parts: Parts, folder: Path) -> None:
        self._names = ", ".join(name for name, _, _ in parts)
        self._process: Any = None
        if parts:
            fork = multiprocessing.get_context("fork")
            self._answer, answer = fork.Pipe(duplex=False)
            self._process = fork.Process(target=_work_beside, args=(parts, folder, answer), daemon=True)
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

    def measures(self) -> dict[str, Exact]:
        """Wait until the parts are made; what was measured on each."""
        if not self._process:
            return {}
        try:
            answer = self._answer.recv()
        except EOFError:
            raise self._ended() from None
        if isinstance(answer, FingertipError):
            raise answer
        return dict(answer)

    def _ended(self) -> GeometryError:
        sentence = f"the B-rep process of {self._names} ended without an answer; use --formats stl,3mf."
        return GeometryError(Fault("STEP", sentence))


def _work_beside(parts: Parts, folder: Path, answer: Any) -> None:
    from fingertip.cad.kernel import brep

    try:
        solids = _make(parts, folder)
    except FingertipError as error:
        answer.send(error)
        return
    for name, solid, _ in solids:
        brep.save(solid, folder / f"{name}.brep")
    answer.send(_measures(solids))
    _write(solids, folder)


def note(folder: Path, doing: str) -> None:
    """Leave word of what is being done, for whoever stops this process."""
    (folder / DOING).write_text(doing, encoding="utf-8")


def main() -> None:
    """Do the job on stdin; the answer, measures or faults, goes to `answer.json` in the folder."""
    folder = Path(sys.argv[1])
    job: StepJob = pickle.load(sys.stdin.buffer)
    try:
        answer: dict[str, object] = {"exact": {name: asdict(found) for name, found in work(job, folder).items()}}
    except FingertipError as error:
        answer = {"error": type(error).__name__, "faults": [[f.field, f.sentence] for f in error.faults]}
    (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    main()
    os._exit(0)  # everything is written and closed; unloading the kernel's libraries takes a third of a second
