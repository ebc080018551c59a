"""Rig: its parts pass the checks of printed parts, and nothing meets what it must not on the whole way of the slide."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from manifold3d import Manifold

from fingertip.bench.rig import FILES, SHEET, STROKE_MM, Rig, make_rig
from fingertip.bench.trials import onset_s
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from tests.conftest import run_fingertip

SURFACE, TILT = 14.0, 6.0
DESIGNS = [
    "first_finger",
    *(pytest.param(name, marks=pytest.mark.full) for name in ("fsr402", "article", "adult_finger")),
]


def place_arm(rig: Rig, evaluator: MeshEvaluator) -> Manifold:
    """Turn the arm onto its feet, hang it into its hinge and let it tilt."""
    level = evaluator.manifold(rig.arm()).rotate((180.0, 0.0, 0.0)).translate((0.0, 0.0, 5.0 + rig.bar_size[1] / 2))
    return level.translate((0.0, 0.0, rig.hinge_depth)).rotate((0.0, TILT, 0.0)).translate((0.0, 0.0, SURFACE))


def place_in_arm(rig: Rig, solid: Manifold) -> Manifold:
    """Move what has the finger's coordinates: z to x, y to z, and the bar's rear 12 mm before the hinge."""
    low, high = rig.bar.low, rig.bar.high
    turned = solid.transform([[0.0, 0.0, 1.0, 12.0 - low[2]], [1.0, 0.0, 0.0, 0.0],
                              [0.0, 1.0, 0.0, rig.hinge_depth - (low[1] + high[1]) / 2]])  # fmt: skip
    return turned.rotate((0.0, TILT, 0.0)).translate((0.0, 0.0, SURFACE))


@pytest.mark.parametrize("name", DESIGNS)
def test_parts_meet_nowhere_and_the_pad_touches_the_surface(name: str) -> None:
    design = Design.load(name)
    rig, evaluator = Rig(design), MeshEvaluator(0.05)
    base, arm = evaluator.manifold(rig.base()), place_arm(rig, evaluator)
    bar, skin = (place_in_arm(rig, evaluator.manifold(each)) for each in (rig.bar, PARTS["skin"].solid(design)))
    slide = evaluator.manifold(rig.slide()).rotate((180.0, 0.0, 0.0)).translate((rig.pad_x - 14.0, 0.0, 13.0))
    strip = Manifold.cube((66.0, 24.0, 1.0)).translate((rig.pad_x - 14.0, -12.0, 13.0))
    for moved in (0.0, STROKE_MM / 2, STROKE_MM):
        for part in (slide.translate((-moved, 0.0, 0.0)), strip.translate((-moved, 0.0, 0.0))):
            assert all((part ^ other).volume() == pytest.approx(0.0, abs=1e-3) for other in (base, arm, bar))
    assert (base ^ arm).volume() == pytest.approx(0.0, abs=1e-3)
    assert (arm ^ bar).volume() == pytest.approx(0.0, abs=20.0), "the bar lies on the beam, with the play of the print"
    lowest = skin.bounding_box()[2]
    assert lowest == pytest.approx(SURFACE, abs=0.6)
    corners = skin.to_mesh().vert_properties
    at_x = corners[np.argmin(corners[:, 2]), 0]
    assert rig.pad_x - 12.0 < at_x < rig.pad_x + 12.0, "the pad touches within the strip"


@pytest.mark.full
def test_the_rig_passes_all_checks_with_few_things_and_steps(tmp_path: Path) -> None:
    files, checks = make_rig(Design.load("first_finger"), 0.05)
    assert [check.name for check in checks if not check.passed] == []
    assert [*files] == [*FILES]
    sheet = files[SHEET].decode()
    assert len(re.findall(r"^\| .* \| [\d.]+( m)? \|$", sheet, re.MULTILINE)) <= 8
    assert len(re.findall(r"^\d+\. ", sheet, re.MULTILINE)) == 10
    assert float(re.findall(r"error of\s+([\d.]+)\s+ms", sheet)[0]) <= 5.0
    with pytest.raises(DesignError, match="no bar that the rig could hold"):
        Rig(Design.load("first_finger").with_values({"bone.interface": "flange"}))


def test_the_onset_of_a_constant_acceleration_is_that_of_its_travel() -> None:
    """The way is a t^2 / 2: after the root of a share of the way."""
    travel_s, stroke_m = 0.3, 0.04
    acceleration = 2 * stroke_m / travel_s**2
    opens_s = (2 * 0.02e-3 / acceleration) ** 0.5
    assert onset_s(travel_s, stroke_m, 2000.0) == pytest.approx((opens_s / 2, opens_s / 2 + 0.0005))


@pytest.mark.full
def test_the_command_writes_a_set_that_check_compares(tmp_path: Path) -> None:
    assert run_fingertip("rig", "fsr400", "--out", str(tmp_path / "rig")).returncode == 0
    assert run_fingertip("check", str(tmp_path / "rig")).returncode == 0
    (tmp_path / "rig/rig_arm.stl").write_bytes(b"")
    assert run_fingertip("check", str(tmp_path / "rig")).returncode == 1
