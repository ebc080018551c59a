"""Masses of the written models, added up in PyBullet and MuJoCo: a
link that states none weighs 1 kg in PyBullet.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from fingertip import Design, write_robot
from fingertip.design.finger_set import load_set
from fingertip.tasks import robot_files
from tests.robot.conftest import INSTALL
from tests.tools import require_module

pytestmark = [pytest.mark.usefixtures("readers"), pytest.mark.full]
DESIGNS = ("first_finger", "adult_finger", "adult_hand")
"""A rigid finger, one that turns on a stub of the hand, and two fingers of a set."""
STUB_G_CM3 = 1.27
"""Density of the stub's material, PETG."""
GRAVITY_M_S2 = 9.81


@dataclass(frozen=True)
class Written:
    """Folders of both formats, and what the fingers and their stubs weigh [kg]."""

    urdf: Path
    mjcf: Path
    fingers_kg: dict[str, float]
    stubs_kg: dict[str, float]

    @property
    def total_kg(self) -> float:
        return sum(self.fingers_kg.values()) + sum(self.stubs_kg.values())


@pytest.fixture(scope="module", params=DESIGNS)
def written(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Written:
    name = request.param
    folder = tmp_path_factory.mktemp("masses") / request.param
    if name == "adult_hand":
        hand = load_set(name)
        design: Any = replace(hand, forms=hand.forms[:2])
        forms = {finger: form.design.name for finger, form in design.fingers}
    else:
        design = Design.load(name)
        forms = {name: name}

    with pytest.MonkeyPatch.context() as patch:  # both formats are of one model
        patch.setattr(robot_files, "build_finger", functools.cache(robot_files.build_finger))
        figures = write_robot(design, folder / "urdf", file_format="urdf")
        write_robot(design, folder / "mjcf", file_format="mjcf")

    fingers_kg = {}
    stubs_kg = {}
    for finger, form in forms.items():
        parts = figures["forms"][form]["parts"] if name == "adult_hand" else figures["parts"]
        prefix = f"{form}_" if name == "adult_hand" else ""
        densities = {part: density for part, (density, _) in parts.items()}
        fingers_kg[finger] = sum(
            weigh(folder / f"urdf/{prefix}{part}.stl", g) for part, g in densities.items()
        )
        stub = folder / f"urdf/{prefix}hand_stub.stl"
        if stub.exists():
            stubs_kg[finger] = weigh(stub, STUB_G_CM3)
    return Written(folder / "urdf/finger.urdf", folder / "mjcf/finger.xml", fingers_kg, stubs_kg)


def weigh(file: Path, density_g_cm3: float) -> float:
    """Weigh a written mesh, in mm, by the volume that trimesh finds [kg]."""
    return 1e-6 * density_g_cm3 * float(require_module("trimesh").load(file).volume)


@pytest.fixture
def bullet() -> Iterator[Any]:
    pybullet = require_module("pybullet", INSTALL)
    pybullet.connect(pybullet.DIRECT)
    yield pybullet
    pybullet.disconnect()


def test_every_link_weighs_what_it_is_in_pybullet(written: Written, bullet: Any, capfd) -> None:
    model = bullet.loadURDF(str(written.urdf))
    assert capfd.readouterr() == ("", ""), "PyBullet has nothing to warn of"
    joints = [bullet.getJointInfo(model, joint) for joint in range(bullet.getNumJoints(model))]
    found_kg = {joint[12].decode(): bullet.getDynamicsInfo(model, joint[0])[0] for joint in joints}
    first_kg = bullet.getDynamicsInfo(model, -1)[0]

    assert first_kg + sum(found_kg.values()) == pytest.approx(written.total_kg, rel=1e-5)
    for finger, mass_kg in written.fingers_kg.items():
        assert found_kg.pop(finger) == pytest.approx(mass_kg, rel=1e-5)
    for finger, mass_kg in written.stubs_kg.items():
        assert found_kg.pop(f"{finger}_hand_stub") == pytest.approx(mass_kg, rel=1e-5)
    assert set(found_kg) == {
        f"{finger}_{frame}" for finger in written.fingers_kg for frame in ("tip", "sensor")
    }
    assert max(first_kg, *found_kg.values()) < 1e-8


def test_a_model_that_nothing_holds_falls_in_pybullet(written: Written, bullet: Any) -> None:
    """Bullet would hold a model whose first link weighs 0 where it is."""
    model = bullet.loadURDF(str(written.urdf))
    bullet.setGravity(0, 0, -GRAVITY_M_S2)
    bullet.setTimeStep(1e-3)
    for link in range(-1, bullet.getNumJoints(model)):
        bullet.changeDynamics(model, link, linearDamping=0.0, angularDamping=0.0)
    for _ in range(100):
        bullet.stepSimulation()
    (_, _, z_m), turned = bullet.getBasePositionAndOrientation(model)
    assert z_m == pytest.approx(-GRAVITY_M_S2 * 0.1**2 / 2, rel=0.02)
    assert turned == pytest.approx((0.0, 0.0, 0.0, 1.0), abs=1e-3)


@pytest.mark.parametrize("written", DESIGNS[1:2], indirect=True)
def test_a_finger_on_its_pin_begins_to_swing_as_its_inertia_says(
    written: Written, bullet: Any
) -> None:
    """Gravity along -y: the acceleration is m g z / I about the pin, frames and stub
    take no part.
    """
    mujoco = require_module("mujoco", INSTALL)
    inertial = ElementTree.parse(written.mjcf).find("worldbody/body/inertial")
    assert inertial is not None
    (_, y_m, z_m), moments = (
        [float(word) for word in inertial.get(key, "").split()] for key in ("pos", "fullinertia")
    )
    mass_kg = written.fingers_kg["adult_finger"]
    expected = mass_kg * GRAVITY_M_S2 * z_m / (moments[0] + mass_kg * (y_m**2 + z_m**2))

    model = bullet.loadURDF(
        str(written.urdf), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE
    )
    bullet.setGravity(0, -GRAVITY_M_S2, 0)
    (moment,) = bullet.calculateInverseDynamics(model, [0.0], [0.0], [0.0])
    ((moved,),) = bullet.calculateMassMatrix(model, [0.0])
    assert -moment / moved == pytest.approx(expected, rel=1e-4)

    for file in (written.urdf, written.mjcf):
        spec = mujoco.MjSpec.from_file(str(file))
        spec.option.gravity = [0, -GRAVITY_M_S2, 0]
        loaded = spec.compile()
        data = mujoco.MjData(loaded)
        mujoco.mj_forward(loaded, data)
        assert data.qacc_smooth.tolist() == pytest.approx([expected], rel=1e-4)


def test_both_formats_weigh_the_same_in_mujoco_and_can_be_carried(written: Written) -> None:
    mujoco = require_module("mujoco", INSTALL)
    for file in (written.urdf, written.mjcf):
        spec = mujoco.MjSpec.from_file(str(file))
        spec.compiler.fusestatic = False
        loaded = spec.compile()
        assert sum(loaded.body_mass) == pytest.approx(written.total_kg, rel=1e-5)
        for finger, mass_kg in written.fingers_kg.items():
            assert loaded.body(finger).mass[0] == pytest.approx(mass_kg, rel=1e-5)
        for finger, mass_kg in written.stubs_kg.items():
            assert loaded.body(f"{finger}_hand_stub").mass[0] == pytest.approx(mass_kg, rel=1e-5)

    # MuJoCo refuses moving bodies without mass: here nothing but the model moves.
    carrier = mujoco.MjSpec()
    hand = carrier.worldbody.add_body(name="hand")
    hand.add_freejoint()
    carrier.attach(
        mujoco.MjSpec.from_file(str(written.urdf)), frame=hand.add_frame(), prefix="carried_"
    )
    loaded = carrier.compile()
    assert sum(loaded.body_mass) == pytest.approx(written.total_kg, rel=1e-5)
