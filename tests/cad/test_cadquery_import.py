"""CadQuery without its viewer gives the same solids, and is imported whole where that fails."""

from __future__ import annotations

import subprocess
import sys

SOLID = """
from fingertip.cad.kernel import brep
from fingertip.models.solids import Box, cylinder
box = Box((0.0, 0.0, 0.0), (2.0, 3.0, 4.0)).cut(cylinder("z", (1.0, 1.5), -1.0, 5.0, 0.5))
print(f"{brep.volume(brep.BrepEvaluator().solid(box)):.6f}")
"""
LEAN = """
import sys
from fingertip.cad.kernel import cadquery_import
cadquery_import.import_without_viewer()
"""


def run(program: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return done.stdout


def test_solids_are_those_of_the_whole_cadquery_and_no_viewer_is_loaded() -> None:
    loaded = "print([sys.modules[n].__file__ for n in ('vtkmodules', 'casadi') if n in sys.modules"
    loaded += " and hasattr(sys.modules[n], '__file__')])"
    assert run(LEAN + SOLID + loaded) == "20.858407\n[]\n"


def test_a_cadquery_that_needs_its_viewer_is_imported_whole() -> None:
    spoil = (
        "from fingertip.cad.kernel import cadquery_import\n"
        "cadquery_import._LEFT_OUT = ('OCP.gp',)\n"  # whose numbers it computes with
    )
    whole = "import sys; print('vtkmodules' in sys.modules)"
    assert run(spoil + LEAN + SOLID + whole) == "20.858407\nTrue\n"
