"""Strength of the bone beside finite elements of the exported solid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.strength.anchor_elements import solve_anchor
from benchmarks.strength.bone_elements import solve_bone, write_step
from benchmarks.strength.eye_elements import solve_eye
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification import strength
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from tests.conftest import design_file
from tests.tools import require_tool

DESIGNS = {
    "post": ("fsr400", "", 1.15),
    "post, wide": ("fsr402", "", 1.15),
    "post, short": ("first_finger", "", 1.15),
    "socket": ("fsr402", "bone.interface=socket bone.base_length_mm=32", 1.15),
    "flange": (
        "fsr400",
        "bone.interface=flange bone.base_length_mm=27 bone.foot_radius_mm=1.65",
        1.25,
    ),
    "cheeks of a joint": ("adult_finger", "", 1.25),
}
"""Bundled design, its changes, and the largest stress of beam theory over that of the elements."""
ELEMENTS_MM = (0.8, 0.65, 0.5)
BESIDE_MM = 3.0
"""Length of the fine mesh on each side of the predicted place, within
which the elements must find theirs [mm].
"""


@pytest.mark.long
@pytest.mark.parametrize("name", DESIGNS)
def test_elements_find_the_predicted_stress(name: str, tmp_path: Path) -> None:
    """Under forces at the apex: at the weakest section the stress of
    beam theory holds, and nowhere is it exceeded.
    """
    require_elements()
    design = Design.load(design_file(DESIGNS[name][0]), changes=DESIGNS[name][1].split())
    write_step(design, tmp_path)
    cuts = [
        (z, cut, strength._find_concentration(design, z))
        for z, cut in strength._cut(design, MeshEvaluator(0.02), strength.STATIONS)
    ]
    (weakest,) = strength._find_weakest_section(
        design, strength.list_load_points(design)["apex"], cuts
    )
    low = interface_of(design).beam_begin_z(design, -np.inf)
    if design.bone.interface == "post":
        # Past it the model holds the post.
        low = -design.bone.base_length_mm - design.bone.post_length_mm / 3
    if design.bone.interface == "socket":
        low = -design.bone.base_length_mm + 0.6 * design.bone.socket_depth_mm
    predicted = weakest.stress_per_n
    zone = (weakest.z_mm - BESIDE_MM, weakest.z_mm + BESIDE_MM)
    for fine_mm in ELEMENTS_MM:
        solved = solve_bone(design, tmp_path, fine_mm, zone)
        z = solved.points_mm[:, 2]
        stresses = solved.tension_mpa_per_n * ((z > low) & (z < design.dimensions.taper_end_z))
        there = stresses[abs(z - weakest.z_mm) < BESIDE_MM].max()
        largest = stresses.max()
    assert predicted / DESIGNS[name][2] <= there <= 1.02 * predicted
    assert largest <= 1.02 * predicted


JOINTED = ("adult_finger", "adult_thumb", "child_finger")
LOAD_N = 20.0


@pytest.mark.long
@pytest.mark.parametrize("name", JOINTED)
def test_elements_with_contact_find_the_predicted_stress_of_the_eye(
    name: str, tmp_path: Path
) -> None:
    """On a straight finger the largest tension lies at the bore of the
    pin, and the prediction is on the safe side.
    """
    require_elements()
    design = Design.load(name)
    points, tension, load_z = solve_eye(design, tmp_path, 0.5, LOAD_N)
    joint = design.dimensions.joint
    predicted = predict(design, load_z, "eye")
    at = points[tension.argmax()]
    found = tension.max() / LOAD_N
    assert joint
    assert abs(np.hypot(at[1] - joint.axis_y, at[2] - joint.axis_z) - joint.pin_radius) < 0.1
    assert predicted / 1.3 <= found <= 1.02 * predicted


@pytest.mark.long
@pytest.mark.parametrize("name", JOINTED)
def test_elements_find_the_predicted_stress_of_the_horn(name: str, tmp_path: Path) -> None:
    """On a bent finger, which the tendon holds: at most 15 % more, and
    25 % less on the safe side, with two meshes.
    """
    require_elements()
    design = Design.load(name)
    predicted = predict(design, design.skin.length_mm, "horn of the tendon")
    for fine_mm in (0.35, 0.25):
        found = solve_anchor(design, tmp_path, fine_mm)
        assert 0.75 * predicted <= found <= 1.15 * predicted


def predict(design: Design, load_z: float, place: str) -> float:
    """Stress of a place of the joint [MPa/N]."""
    return {
        found.place: found.stress_per_n
        for found in interface_of(design).local_stresses(design, load_z)
    }[place]


def require_elements() -> None:
    require_tool("ccx", "as root on Debian, sh .ci/install-calculix")
    require_tool("gmsh", "as root on Debian, sh .ci/install-gmsh")
