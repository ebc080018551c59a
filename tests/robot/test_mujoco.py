"""The model in MuJoCo: it loads without a warning, and a plate presses it as the pad model says."""

from __future__ import annotations

import math
import re
import runpy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip import Design, write_robot
from fingertip.design.finger_set import load_set
from fingertip.drivers import Slip
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import Pose
from fingertip.robot.contact import FORCES_N
from tests.conftest import ROOT
from tests.robot.conftest import INSTALL, Model
from tests.tools import require_module

pytestmark = [pytest.mark.usefixtures("readers"), pytest.mark.full]
OBJECT_KG = 0.035
STEPS = 3000


def test_both_formats_load_without_a_warning(
    model: Model, capfd, monkeypatch: pytest.MonkeyPatch, tmp_path
) -> None:
    mujoco = require_module("mujoco", INSTALL)
    monkeypatch.chdir(tmp_path)  # where MuJoCo would write its warnings
    turns = model.design.bone.interface == "clevis"
    for file in ("finger.xml", "finger.urdf"):
        spec = mujoco.MjSpec.from_file(str(model.folder / file))
        spec.compiler.fusestatic = False
        loaded = spec.compile()
        assert loaded.body(model.design.name).mass[0] == pytest.approx(
            model.figures["mass_kg"], rel=1e-5
        )
        data = mujoco.MjData(loaded)
        mujoco.mj_step(loaded, data)
        assert loaded.njnt == int(turns)
        inertia = sum(model.figures["moments_kg_m2"][:3])
        assert loaded.body(model.design.name).inertia.sum() == pytest.approx(inertia, rel=1e-5)
        assert not any(warning.number for warning in data.warning)
    assert capfd.readouterr() == ("", "")
    assert not any(tmp_path.iterdir())


def test_both_strands_pull_at_the_distance_of_the_tendon(tmp_path: Path) -> None:
    """A strand on the straight finger lies tendon_distance_mm from the
    axis; a bent one farther out, on its horn.
    """
    mujoco = require_module("mujoco", INSTALL)
    design = Design.load("adult_finger")
    write_robot(design, tmp_path / "robot")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot/finger.xml"))
    data = mujoco.MjData(model)
    anchor = design.dimensions.anchor
    joint = design.dimensions.joint
    mujoco.mj_forward(model, data)
    distance = design.hand.tendon_distance_mm
    assert 1e3 * data.ten_J.ravel() == pytest.approx([-distance] * 2, abs=1e-4)
    data.qpos[:] = angle = math.radians(design.hand.travel_deg)
    mujoco.mj_forward(model, data)
    # The lever of the tangent from the guide to the circle about the horn, in the frame of the hand
    radius = anchor.horn_radius + anchor.line / 2
    y = anchor.horn_y + anchor.horn_radius - joint.axis_y
    z = anchor.horn_low_z - joint.axis_z
    horn = np.array(
        [y * math.cos(angle) - z * math.sin(angle), y * math.sin(angle) + z * math.cos(angle)]
    )
    guide = np.array([-distance, -joint.radius - 3.0])
    away = horn - guide
    along = math.atan2(*away) - math.asin(radius / math.hypot(*away))
    lever = guide[1] * math.sin(along) - guide[0] * math.cos(along)
    assert 1e3 * data.ten_J.ravel() == pytest.approx([-lever, -lever], abs=1e-3)


def press(mujoco: Any, model: Model, tilt_deg: float, force_n: float) -> tuple[Any, Any, float]:
    """Press an object with a plane face on the finger, held still,
    and return model, data and depth [mm].
    """
    spec = mujoco.MjSpec.from_file(str(model.folder / "finger.xml"))
    form = PadForm.of_design(model.design)
    for joint in list(spec.joints):
        spec.delete(joint)
    spec.option.gravity = [0, 0, 0]
    slope = math.tan(math.radians(tilt_deg)) + form.base_slope
    out = np.array([0.0, -1.0, slope]) / math.hypot(1.0, slope)  # from the pad, across the plate
    frame = np.array([[1.0, 0.0, 0.0], np.cross(-out, [1.0, 0.0, 0.0]), -out])
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, frame.T.ravel())
    tip = max(float(points @ out) for points in surface(mujoco, spec.compile()))
    plate = spec.worldbody.add_body(
        name="plate", pos=tip * out, quat=turn, mass=OBJECT_KG, inertia=[1e-4] * 3
    )
    plate.explicitinertial = True
    for axis in np.eye(3):
        plate.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    plate.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.05, 0.05, 0.005], pos=[0, 0, -0.005])
    loaded = spec.compile()
    data = mujoco.MjData(loaded)
    for _ in range(STEPS):
        data.xfrc_applied[loaded.body("plate").id, :3] = -force_n * out
        mujoco.mj_step(loaded, data)
    return loaded, data, 1e3 * (tip - float(data.body("plate").xpos @ out))


def surface(mujoco: Any, loaded: Any) -> np.ndarray:
    """Vertices of the collision pieces in the world [m]."""
    data = mujoco.MjData(loaded)
    mujoco.mj_forward(loaded, data)
    found = []
    for i in range(loaded.ngeom):
        if "collision" in loaded.geom(i).name:
            mesh = loaded.mesh(int(loaded.geom_dataid[i]))
            first = int(mesh.vertadr[0])
            count = int(mesh.vertnum[0])
            found.append(
                loaded.mesh_vert[first : first + count] @ data.geom_xmat[i].reshape(3, 3).T
                + data.geom_xpos[i]
            )
    return np.concatenate(found)


@pytest.mark.parametrize("force_n", [0.2, 1.0, 4.0, 10.0])
def test_a_plate_meets_the_force_applied_and_the_depth_of_the_pad(
    model: Model, force_n: float
) -> None:
    mujoco = require_module("mujoco", INSTALL)
    tilt_deg = 2.0
    _, data, depth_mm = press(mujoco, model, tilt_deg, force_n)
    for sensor in ("touch", "contact"):
        assert data.sensor(f"{model.design.name}_{sensor}").data[0] == pytest.approx(
            force_n, rel=0.03
        )
    contacts = find_contacts(PadForm.of_design(model.design), Pose(tilt_deg), FORCES_N, math.inf)
    # The pad's force over its depth.
    of_pad = np.polyfit(np.log([c.depth_mm for c in contacts]), np.log(FORCES_N), 3)
    of_pad_n = math.exp(float(np.polyval(of_pad, math.log(depth_mm))))
    assert of_pad_n == pytest.approx(force_n, rel=model.figures["contact_error"] + 0.01)


def test_points_of_the_skin_read_the_depth_under_a_plate_and_its_slip(model: Model) -> None:
    mujoco = require_module("mujoco", INSTALL)
    slip_m_s = 0.02
    loaded, data, depth_mm = press(mujoco, model, 2.0, 1.0)
    data.qvel[-2] = slip_m_s  # along the finger
    mujoco.mj_forward(loaded, data)
    depth_m, across_m_s, along_m_s = data.sensor(f"{model.design.name}_tactile").data.reshape(3, -1)
    radius_m = 1e-3 * PadForm.of_design(model.design).active_radius_mm
    assert len(depth_m) == model.figures["taxels"] == (2 * round(radius_m / 5e-4) + 1) ** 2
    assert 1e3 * depth_m.max() == pytest.approx(depth_mm, abs=0.02)
    pressed = depth_m > 0.0
    assert 0.2 < pressed.mean() < 0.8
    assert along_m_s[pressed] == pytest.approx(slip_m_s, rel=0.02)
    assert across_m_s == pytest.approx(0.0, abs=0.05 * slip_m_s)


def test_snippets_of_the_readme_attach_the_finger_and_correct_its_contact(
    model: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    mujoco = require_module("mujoco", INSTALL)
    name = model.design.name
    correct, attach = re.findall(
        r"```python\n(.*?)```", (model.folder / "README.md").read_text(), re.DOTALL
    )
    link = '<site name="end_of_last_link"/><geom size="0.01" pos="0 0 -0.1"/>'
    thing = '<body name="object"><freejoint/><geom size="0.01" mass="0.1"/></body>'
    hand = f"<mujoco><worldbody><body>{link}</body>{thing}</worldbody></mujoco>"
    (model.folder / "hand.xml").write_text(hand)
    monkeypatch.chdir(model.folder)
    names: dict[str, Any] = {"mujoco": mujoco}
    exec(attach, names)
    exec(correct.replace(name, f"index_{name}"), names)
    loaded = names["model"]
    stiffness = loaded.geom(f"index_{name}_collision_1").solref[0] / names["ratio"]
    assert stiffness == pytest.approx(model.figures["solref"][0], rel=1e-5)
    assert names["ratio"] * model.figures["inverse_mass_per_kg"] == pytest.approx(
        sum(loaded.body(body).invweight0[0] for body in (f"index_{name}", "object")), rel=1e-5
    )
    assert (loaded.opt.timestep, loaded.opt.impratio) == (0.0005, 10000)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_set_is_one_model_whose_fingers_stand_side_by_side_and_feel_by_themselves(
    tmp_path: Path, side: str
) -> None:
    mujoco = require_module("mujoco", INSTALL)
    every = load_set("adult_hand")
    loaded_set = replace(every, forms=every.forms[:3])
    figures = write_robot(replace(loaded_set, side=side), tmp_path)
    loaded = mujoco.MjModel.from_xml_path(str(tmp_path / "finger.xml"))
    data = mujoco.MjData(loaded)
    mujoco.mj_forward(loaded, data)
    names = [name for name, _ in loaded_set.fingers]
    bodies = [loaded.body(i).name for i in range(1, loaded.nbody)]
    assert bodies == [body for name in names for body in (name, f"{name}_hand_stub")]
    places = [float(data.body(name).xpos[0]) for name in names]
    # Seen from the palm, the right thumb is on the right.
    assert places == sorted(places, reverse=side == "right")
    assert list(figures["places_m"].values()) == pytest.approx(places)
    assert sum(places) == pytest.approx(0.0, abs=1e-6)
    assert data.ncon == 0
    for name, form in loaded_set.fingers:
        assert loaded.body(name).mass[0] == pytest.approx(
            figures["forms"][form.design.name]["mass_kg"], rel=1e-5
        )
        for sensor in ("touch", "contact", "tactile"):
            assert not data.sensor(f"{name}_{sensor}").data.any()
    assert all((tmp_path / f"{form.design.name}_README.md").exists() for form in loaded_set.forms)
    if side != loaded_set.side:
        return  # what follows reads the URDF of the right hand
    write_robot(loaded_set, tmp_path, file_format="urdf", force=True)
    spec = mujoco.MjSpec.from_file(str(tmp_path / "finger.urdf"))
    spec.compiler.fusestatic = False
    in_urdf = spec.compile()
    assert in_urdf.njnt == loaded.njnt == len(names)
    for name in names:
        assert in_urdf.body(name).mass[0] == pytest.approx(loaded.body(name).mass[0], rel=1e-5)


def test_a_block_on_the_pad_swings_at_the_resonance_and_damping_of_the_pad(model: Model) -> None:
    """A small push on an object of 35 g at 1 N: period and
    decrement of the mass on the pad's stiffness.
    """
    mujoco = require_module("mujoco", INSTALL)
    loaded, data, _ = press(mujoco, model, 2.0, 1.0)
    data.qvel[-1] = 0.002  # along the normal of the plate
    start = data.body("plate").xpos.copy()
    out = data.body("plate").xmat[[2, 5, 8]].copy()
    swing = []
    for _ in range(60):
        mujoco.mj_step(loaded, data)
        swing.append(float((data.body("plate").xpos - start) @ out))
    first, second = np.flatnonzero(np.diff(np.sign(swing[1:])))[:2].tolist()
    expected_hz = math.sqrt(model.figures["stiffness_n_per_m"] / OBJECT_KG) / math.tau
    assert 0.5 / (loaded.opt.timestep * (second - first)) == pytest.approx(expected_hz, rel=0.06)
    decrement = math.log(max(swing) / -min(swing)) / math.pi
    assert decrement / math.hypot(1.0, decrement) == pytest.approx(0.15, rel=0.1)


def test_example_holds_the_block_with_the_detector_and_loses_it_without() -> None:
    require_module("mujoco", INSTALL)
    example = runpy.run_path(str(ROOT / "examples/hold_a_slipping_block.py"))
    held, lost = (example["hold"](with_detector) for with_detector in (True, False))
    assert held.slipped_mm < 3.0
    assert lost.slipped_mm > 25.0
    assert 0.005 < held.detected_s < 0.06
    assert held.false_alarms == lost.false_alarms == 0


def test_example_feels_the_slip_of_a_contact_and_nothing_without_its_vibration() -> None:
    require_module("mujoco", INSTALL)
    example = runpy.run_path(str(ROOT / "examples/slip_in_mujoco.py"))
    delays, alarms, held = example["slide"]("medium")
    assert (alarms, held.force_n) == (0, pytest.approx(2.0, rel=0.1))
    assert (
        0.005
        < min(delay_s for state, delay_s in delays.items() if state)
        < max(delays.values())
        < 0.1
    )
    step = example["FeltContact"].step
    example["FeltContact"].step = lambda self, normal_n, shear_n, speed_m_s: step(
        self, normal_n, shear_n, 0.0
    )
    # The change of force alone may cross the threshold, but it is vetoed.
    assert max(example["slide"]("medium")[0]) <= Slip.INCIPIENT
