"""What of a design reaches the trace through its pad, with sign
and size, and what rightly does not.
"""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.pad.response import REFERENCE_POSE, Pad
from fingertip.pad.touch import Pose
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from tests.pad.bonded import CROWNED

ONE = np.ones(1)
OWN = "skin.made=encapsulated silicone.product=own silicone.modulus_mpa="
POSES = {"share": REFERENCE_POSE, "tilted": Pose(12.0), "rolled": Pose(2.0, 8.0)}
ACTS = {
    "skin.crown_radius_mm=14": {
        "stiffness": 0.102,
        "area": 0.102,
        "tilted": -0.245,
        "shear": -0.264,
    },
    "skin.crown_offset_mm=0.7": {
        "stiffness": -0.013,
        "share": 0.023,
        "tilted": -0.046,
        "rolled": 0.024,
        "shear": -0.351,
    },
    "skin.width_mm=18": {"stiffness": 0.040, "area": 0.037, "rolled": -0.086},
    "skin.thickness_palmar_mm=2.9": {
        "stiffness": 0.019,
        "share": 0.024,
        "tilted": 0.022,
        "rolled": 0.017,
        "shear": 0.028,
    },
    "skin.taper_ratio=0.926": {"stiffness": -0.0095, "rolled": 0.0095},
    "skin.semi_axis_palmar_mm=7.2 skin.crown_drop_mm=1.8": {"rolled": -0.017},
}
"""Change -> relative changes of the bonded pad's figures at 1 N; those below 1 % are left out."""
SILENT = (
    "skin.thickness_tip_mm=3",
    "skin.nail_fullness=0.9",
    "bone.wall_mm=0.9 bone.base_length_mm=20",
    "bone.platform_mm=1.7",
    "mold.wall_mm=4",
    "sensor.model=fsr400_short",
    "silicone.shore_a=20",
    "printer.bed_x_mm=200",
)
"""Changes that the pad under the finger's tip rightly does not feel,
or that the catalogue's silicone overrides.
"""


def figures(changes: str = "") -> dict[str, float]:
    design = CROWNED.with_values(
        {name: float(x) for name, x in (one.split("=") for one in changes.split())}
    )
    pad = Pad.from_design(design)
    sensed = {name: Pad.from_design(design, pose).sensed_n(ONE)[0] for name, pose in POSES.items()}
    shear = pad.sensed_n(ONE, 0.2 * ONE)[0] - sensed["share"]
    return {"stiffness": pad.stiffness_1n_n_per_m, "area": pad.area_1n_m2, "shear": shear} | sensed


@pytest.mark.parametrize("changes", ACTS)
def test_a_parameter_acts_on_the_trace_s_pad(changes: str) -> None:
    before = figures()
    after = figures(changes)
    for name, value in before.items():
        wanted = ACTS[changes].get(name, 0.0)
        assert after[name] / value - 1.0 == pytest.approx(
            wanted, abs=max(0.01, 0.1 * abs(wanted))
        ), name


@pytest.mark.parametrize("changes", SILENT)
def test_what_does_not_touch_the_pad_leaves_it_as_it_is(changes: str) -> None:
    base = ["skin.made=encapsulated", "silicone.product=addition_40a"]
    assert Pad.from_design(Design.load(changes=[*base, *changes.split()])) == Pad.from_design(
        CROWNED
    )


def test_a_silicone_acts_as_its_modulus_over_the_force() -> None:
    """All lengths depend on force over modulus, so four times both give
    the same share and four times the stiffness.
    """
    soft, hard = (Pad.from_design(Design.load(changes=f"{OWN}{mpa}".split())) for mpa in (0.5, 2.0))
    forces = np.array([0.2, 0.5, 1.0])
    assert hard.sensed_n(4 * forces) == pytest.approx(4 * soft.sensed_n(forces), rel=5e-3)
    # A cubic through the share differs a little; the stiffness does so more, by the layer's
    # stiffening beyond Hertz.
    ratio = hard.stiffness_1n_n_per_m / soft.stiffness_1n_n_per_m
    assert 4 ** (2 / 3) * 0.7 < ratio < 4 ** (2 / 3)


@pytest.mark.full
def test_silicone_and_pose_change_the_recorded_voltage() -> None:
    def volts(changes: str = "skin.made=encapsulated", **pose: float) -> float:
        scene = SceneFile(
            hold={"min_force_n": 1.0, "max_force_n": 1.0, "release": False}, pose=pose
        )
        return float(
            run_scene(Design.load(changes=changes.split()), scene)
            .columns["voltage_v"][-200:]
            .mean()
        )

    reference = volts()
    assert abs(volts(f"{OWN}0.05") - volts(f"{OWN}50")) > 0.01
    deaf = volts(tilt_deg=25.0, roll_deg=15.0)
    less = volts(tilt_deg=15.0)
    assert reference > less > deaf, "the voltage rises with the force on the sensor"
    assert deaf == pytest.approx(volts(tilt_deg=30.0, roll_deg=20.0), abs=1e-3), (
        "silent below the turn-on"
    )
