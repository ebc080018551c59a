"""The process that makes STEP files: `python -m fingertip.cad.step_worker FOLDER`, its job pickled on stdin.

A process of its own, because the B-rep kernel can hang or crash, counts products through the life of a process
(which would end up in the files), and takes seconds to load while the meshes are made beside it.
"""

from __future__ import annotations

import json
import pickle
import sys
from pathlib import Path

from fingertip.cad.step import DOING, StepJob
from fingertip.errors import FingertipError


def work(job: StepJob, folder: Path) -> dict[str, float]:
    """Write `<part>.step` for each part and `assembly.step`; return the exact volumes [mm3].

    Raises
    ------
    MissingLibraryError
        If cadquery or a library of the system it needs is not there.
    GeometryError
        If a part is not one valid solid.
    """
    note(folder, "loading cadquery")
    from fingertip.cad import brep, step_file

    evaluator = brep.Evaluator()
    solids = []
    for name, expression, colour in job.parts:
        note(folder, f"making {name}")
        solids.append((name, evaluator.solid(expression), colour))
    note(folder, "writing the files")
    for part in solids:
        step_file.write_part(folder / f"{part[0]}.step", part)
    step_file.write_assembly(folder / "assembly.step", f"fingertip_{job.title}", solids)
    return {name: brep.volume(solid) for name, solid, _ in solids}


def note(folder: Path, doing: str) -> None:
    """Leave word of what is being done, for whoever stops this process."""
    (folder / DOING).write_text(doing, encoding="utf-8")


def main() -> int:
    """Do the job on stdin; the answer, volumes or faults, goes to `answer.json` in the folder."""
    folder = Path(sys.argv[1])
    job: StepJob = pickle.load(sys.stdin.buffer)
    try:
        answer: dict[str, object] = {"volumes_mm3": work(job, folder)}
    except FingertipError as error:
        answer = {"error": type(error).__name__, "faults": [[f.field, f.sentence] for f in error.faults]}
    (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
