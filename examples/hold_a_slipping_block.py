"""Hold a block in MuJoCo: a finger presses it against a wall, somebody pulls at it, and the slip
detector tightens.

Run from a clone of the repository, with numba and MuJoCo installed (pip install mujoco):
.venv/bin/python examples/hold_a_slipping_block.py

MuJoCo's friction knows no stick-slip and no roughness, so that a sliding block does not shake the
finger there. The vibration is added here by the law of fingertip's own simulation: the profile of
the surface that has passed under the pad, times the pad's stiffness, through the resonance of the
finger. What the detector finds depends on that law.
"""

import math
import random
import tempfile
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from fingertip import Design, Readout, write_robot
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import Pad
from fingertip.pad.touch import Pose
from fingertip.robot.finger_model import build_finger
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.contact.surfaces import generate_profile
from fingertip.sim.contact.vibration import ContactResonance, ProfileForce
from fingertip.slip.detectors.fast import FastDetector

BLOCK_KG = 0.1
HOLD_N = 2.5
TIGHT_N = 5.0
CLOSE_S = 0.5
HELD_S = 1.0
PULL_S = 2.0
END_S = 2.7
"""Moments at which the grip closes, the block is let go, somebody pulls at it, and all ends."""
PULL_N = 0.5
"""Force of the pull. The block weighs 1 N, and the grip holds 1.2 N."""
SURFACE = SURFACES["medium"]


@dataclass
class Outcome:
    """What became of the block."""

    slipped_mm: float
    detected_s: float | None
    """Time from the first millimetre per second of slip until
    the detector was ON; None if it was not.
    """
    false_alarms: int
    """Samples of ON before the pull."""


def build_scene(
    design: Design, folder: str
) -> tuple[mujoco.MjModel, ProfileForce, Readout, ContactResonance]:
    """Build finger, wall and block, and what turns the forces of a contact into voltages."""
    write_robot(design, folder)
    finger = build_finger(design)
    spec = mujoco.MjSpec.from_file(f"{folder}/finger.xml")
    body = spec.body(finger.name)
    body.add_joint(
        name="close",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=[0, -1, 0],
        damping=20.0,
    )
    # What moves with a finger on its hand, not the finger alone.
    body.mass = 1 / finger.contact.inverse_mass_per_kg
    spec.add_actuator(name="grip", target="close", trntype=mujoco.mjtTrn.mjTRN_JOINT)
    # The face of the block is parallel to the finger, so the pad's straight part is tilted by its
    # own slope.
    pose = Pose(-math.degrees(math.atan(PadForm.of_design(design).base_slope)))
    size = 0.02
    palm = (
        min(float(piece.vertices[:, 1].min()) for piece in finger.collision.pieces) * 1e-3
        + finger.offset_m[1]
    )
    at = [0, palm - size - 1e-4, finger.sensor.middle_m[2]]
    block = spec.worldbody.add_body(
        name="block",
        pos=at,
        mass=BLOCK_KG,
        inertia=[1e-5] * 3,
        explicitinertial=True,
    )

    # It may not turn; a damper keeps its fall as slow as the article's slides.
    for axis in np.eye(3):
        block.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, damping=5.0 * axis[2])

    box = {"type": mujoco.mjtGeom.mjGEOM_BOX, "friction": [SURFACE.friction.mu_c, 0.005, 0.0001]}
    block.add_geom(size=[size, size, 0.06], **box)
    # The wall has no friction, as if the block stood on rollers: the finger alone holds it.
    spec.worldbody.add_geom(
        type=box["type"],
        size=[0.1, 0.01, 0.5],
        pos=[0, at[1] - size - 0.01, at[2]],
        condim=1,
        priority=1,
    )
    model = spec.compile()
    inverse_mass = sum(model.body(name).invweight0[0] for name in (finger.name, "block"))
    for i in range(1, len(finger.collision.pieces) + 1):
        model.geom(f"{finger.name}_collision_{i}").solref[:] = finger.contact.solref(inverse_mass)

    pad = Pad.from_design(design, pose)
    step_s = model.opt.timestep
    profile = ProfileForce(
        pad,
        generate_profile(random.Random(1), SURFACE, 0.0, 0.1, 0.0),
        SURFACE.load_law == "proportional",
        step_s,
    )
    resonance = ContactResonance(step_s, pad.resonance_hz(HOLD_N), pad.backing.damping_ratio)

    return model, profile, Readout(design, [pad], seed=1), resonance


def hold(
    with_detector: bool, watch: Callable[[mujoco.MjData, bool], None] = lambda data, on: None
) -> Outcome:
    """Close the grip, pull at the block, and tighten the grip when the detector finds slip, if it
    may.

    After each step, `watch` gets what MuJoCo knows, and whether the detector is ON.
    """
    design = Design.load("fsr400", changes=["detector.sample_rate_hz=2000"])
    with tempfile.TemporaryDirectory() as folder:
        model, profile, readout, resonance = build_scene(design, f"{folder}/robot")

    data = mujoco.MjData(model)
    detector = FastDetector.for_design(design)
    name = design.name
    force_n = 0.0
    is_tight = False
    slip_s = None
    found_s = None
    alarms = 0
    block = data.body("block")
    slide = model.joint(model.body("block").jntadr[0] + 2).dofadr[0]
    mujoco.mj_forward(model, data)
    start_m = float(block.xpos[2])

    for _ in range(round(END_S / model.opt.timestep)):
        if is_tight:
            goal_n = TIGHT_N
        elif data.time >= CLOSE_S:
            goal_n = HOLD_N
        else:
            goal_n = 0.0

        force_n += float(np.clip(goal_n - force_n, -0.02, 0.02))  # a motor of 40 N/s
        data.ctrl[0] = force_n
        # The block rests on a hand until the grip holds it.
        if data.time < HELD_S:
            data.qfrc_applied[slide] = 9.81 * BLOCK_KG
        elif data.time >= PULL_S:
            data.qfrc_applied[slide] = -PULL_N
        else:
            data.qfrc_applied[slide] = 0.0

        mujoco.mj_step(model, data)
        load_n = np.array([data.sensor(f"{name}_contact").data[0]])
        drive_n = load_n + profile.process(load_n, np.array([abs(block.xpos[2] - start_m)]))
        sample = readout.step(resonance.process(drive_n, load_n))
        voltages = sample.sampled_tactile_v[0], sample.sampled_output_v[0]
        on = detector.step(*map(float, voltages if readout.has_filtered else voltages[:1]))
        watch(data, on)

        if data.time < PULL_S:
            alarms += on and data.time > HELD_S  # while the grip closes nothing is judged
            continue

        if slip_s is None and abs(data.qvel[slide]) > 1e-3:
            slip_s = data.time

        if on and slip_s is not None and found_s is None:
            found_s = data.time
            is_tight = with_detector

    delay_s = None if found_s is None or slip_s is None else found_s - slip_s
    return Outcome(1e3 * abs(float(block.xpos[2]) - start_m), delay_s, alarms)


if __name__ == "__main__":
    for with_detector in (True, False):
        found = hold(with_detector)
        after = (
            "never"
            if found.detected_s is None
            else f"{1e3 * found.detected_s:.1f} ms after its onset"
        )
        print(
            f"detector {'on ' if with_detector else 'off'}: slipped {found.slipped_mm:7.2f} mm, "
            f"slip found {after}"
        )
