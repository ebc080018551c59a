"""Example of a bench rig: its script checks the geometry of two
designs, and its checks find defects.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import to_manifold
from tests.conftest import ROOT, run_python

FOLDER = ROOT / "examples/bench_rig"
BREAK = """
import sys; sys.path.insert(0, {folder!r})
import rig
from fingertip import Design
rig.{change}
rig.Rig(Design.load({design!r})).check()
"""


@pytest.mark.full
@pytest.mark.parametrize("design", ["adult_finger", "fsr400"])
def test_rig_passes_its_checks_and_writes_closed_parts(design: str, tmp_path: Path) -> None:
    done = run_python(str(FOLDER / "rig.py"), str(ROOT / f"params/{design}.toml"), str(tmp_path))
    assert done.returncode == 0, done.stderr
    figures = dict(line.split(": ") for line in done.stdout.splitlines())
    assert 0.0 < float(figures["error_s"]) <= 0.005
    assert abs(float(figures["contact_to_sensor_mm"])) <= 1.0
    for name in ("base", "sled", "hook", "arm"):
        mesh = stl.from_bytes((tmp_path / f"rig_{name}.stl").read_bytes())
        assert len(to_manifold(mesh.vertices, mesh.triangles).decompose()) == 1
        assert (tmp_path / f"rig_{name}.step").read_bytes().startswith(b"ISO-10303-21")


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("DRIVER = 6.0", "driver of the screw along x"),
        ("motion.OPEN = 0.08", "error_s <= MAX_ERROR_S"),
        ("hook.STOP_Y = -17.0", "the hook frees the sled at 8.25 degrees, and stops at"),
        ("SCREW = 16", "hook and contact: screw M3 x 16|2 overlap"),
    ],
)
def test_checks_of_the_rig_find_a_defect(change: str, message: str) -> None:
    done = run_python("-c", BREAK.format(folder=str(FOLDER), change=change, design="fsr400"))
    assert done.returncode == 1
    assert message in done.stderr
