"""Processes of the B-rep kernel: CadQuery without its viewer, and files of a kernel never used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SOLID = """
from fingertip.cad.kernel import brep
from fingertip.models.solids import Box, cylinder
box = Box((0.0, 0.0, 0.0), (2.0, 3.0, 4.0)).cut(cylinder("z", (1.0, 1.5), -1.0, 5.0, 0.5))
print(f"{brep.volume(brep.BrepEvaluator().solid(box)):.6f}")
"""
LEAN = """
import sys
from fingertip.cad.kernel import kernel_process
kernel_process.import_without_viewer()
"""


def run(program: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return done.stdout


@pytest.mark.second
def test_solids_are_those_of_the_whole_cadquery_and_no_viewer_is_loaded() -> None:
    loaded = "print([sys.modules[n].__file__ for n in ('vtkmodules', 'casadi') if n in sys.modules"
    loaded += " and hasattr(sys.modules[n], '__file__')])"
    assert run(LEAN + SOLID + loaded) == "20.858407\n[]\n"


@pytest.mark.second
def test_a_cadquery_that_needs_its_viewer_is_imported_whole() -> None:
    spoil = (
        "from fingertip.cad.kernel import kernel_process\n"
        "kernel_process._LEFT_OUT = ('OCP.gp',)\n"  # whose numbers it computes with
    )
    whole = "import sys; print('vtkmodules' in sys.modules)"
    assert run(spoil + LEAN + SOLID + whole) == "20.858407\nTrue\n"


FILE = """
import hashlib
from fingertip import Design, build
built = build(Design(), {out!r}, parts=["stand"], formats=["step"])
print(hashlib.sha256(built.contents["stand.step"]).hexdigest())
"""
BEFORE = """
from pathlib import Path
from fingertip.cad.kernel import brep
from fingertip.cad.files import step_writer
from fingertip.models.solids import Box
solid = brep.BrepEvaluator().solid(Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
step_writer.write_part(Path({path!r}), ("box", solid, (0.5, 0.5, 0.5)))
"""


@pytest.mark.full
def test_a_file_does_not_depend_on_what_the_kernel_has_written_before(tmp_path: Path) -> None:
    fresh = run(FILE.format(out=str(tmp_path / "a")))
    before = BEFORE.format(path=str(tmp_path / "box.step"))
    assert run(before + FILE.format(out=str(tmp_path / "b"))) == fresh
