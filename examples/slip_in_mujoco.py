"""Feel slip in MuJoCo: a block slides over a fingertip, and a contact becomes what `Finger.read` of
a built one gives.

Needs MuJoCo (pip install mujoco). Run from a clone of the repository: .venv/bin/python
examples/slip_in_mujoco.py

For your own model: make a `FeltContact`, and call its `step` after each `mj_step`, of 0.5 ms, with
what `measure_contact` reads of the geoms of a fingertip and an object. Then let your controller
tighten on `reading.slip`.

MuJoCo's friction does not shake a finger. `FeltContact` adds the vibration by the law of
fingertip's own simulation: the surface that has passed, times the pad's stiffness, through the
resonance of the finger. What is found rests on it.
"""

import math
import random

import mujoco
import numpy as np

from fingertip import Design, Readout
from fingertip.detection.recordings import find_force_scale
from fingertip.drivers import Reading, Slip
from fingertip.pad.response import Pad
from fingertip.pad.touch import Pose
from fingertip.robot.contact import fit_contact
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.contact.surfaces import generate_profile
from fingertip.sim.contact.vibration import ContactResonance, ProfileForce
from fingertip.slip.detectors.fast import FastDetector
from fingertip.slip.force import MEAN_S

STEP_S = 0.0005
MAX_WAY_M = 0.02
"""Time step, as that of a detector with 2000 Hz, and way for which the surface has heights."""
PRESS_S = 0.5
PULL_S = 1.5
END_S = 2.6
SLIDE_S = 0.2
"""Moments at which the block is set down, the pull begins to grow, and
all ends at the latest; time that it slides.
"""
BLOCK_KG = 0.1
PRESS_N = 2.0
PULL_N_PER_S = 2.0
MAX_PULL_N = 1.6


class FeltContact:
    """A contact as a finger feels it: pad, curve of the sensor, board, converter and detector, a
    step at a time.

    A step depends on its arguments and on earlier steps alone; it knows no simulator.
    `copy.deepcopy` branches it.
    """

    def __init__(
        self,
        design: Design,
        surface: str = "medium",
        pose: Pose | None = None,
        seed: int = 1,
    ) -> None:
        if design.detector.sample_rate_hz != 1 / STEP_S:
            raise ValueError(
                f'give the design as design.replace({{"detector.sample_rate_hz": {1 / STEP_S:g}}})'
            )

        table = SURFACES[surface]
        pad = Pad.from_design(design, pose or Pose())
        heights = generate_profile(random.Random(seed), table, 0.0, MAX_WAY_M, 0.0)
        self._profile = ProfileForce(pad, heights, table.load_law == "proportional", STEP_S)
        self._resonance = ContactResonance(
            STEP_S, pad.resonance_hz(PRESS_N), pad.backing.damping_ratio
        )
        self._readout = Readout(design, [pad], seed=seed)
        self._scale = find_force_scale(design)
        self._detector = FastDetector.for_design(design)
        self._way_m = 0.0
        self._steps = 0
        self._mean_v = math.nan

    def step(self, normal_n: float, tangential_n: float, sliding_m_s: float) -> Reading:
        """Return what the finger reads 0.5 ms later, at these
        forces [N] and this speed of sliding [m/s].
        """
        self._way_m += abs(sliding_m_s) * STEP_S
        load_n = np.array([normal_n])
        drive_n = load_n + self._profile.process(load_n, np.array([self._way_m]))
        sample = self._readout.step(
            self._resonance.process(drive_n, load_n), np.array([tangential_n])
        )
        volts = [float(sample.sampled_tactile_v[0]), float(sample.sampled_output_v[0])]
        output = self._detector.process(
            *([each] for each in volts[: 1 + self._readout.has_filtered])
        )

        if output.on[0]:
            slip = Slip.ON
        elif output.incipient[0]:
            slip = Slip.INCIPIENT
        else:
            slip = Slip.NONE

        self._mean_v = (
            volts[0]
            if self._steps == 0
            else self._mean_v + STEP_S / MEAN_S * (volts[0] - self._mean_v)
        )
        self._steps += 1
        force = self._scale.read(self._mean_v)
        interval_n = force.low_n, force.high_n

        return Reading(self._steps * STEP_S, volts[0], force.force_n, interval_n, slip, lost=0)


def measure_contact(
    model: mujoco.MjModel, data: mujoco.MjData, finger: int, other: int
) -> tuple[float, float, float]:
    """Measure normal and tangential force [N] and speed of sliding [m/s] between two geoms."""
    forces = np.zeros(6)
    speed_m_s = 0.0
    found = np.zeros(6)
    jacobians = np.zeros((2, 3, model.nv))

    for i, contact in enumerate(data.contact):
        if {*contact.geom} == {finger, other}:
            mujoco.mj_contactForce(model, data, i, found)
            forces += found
            for jacobian, geom in zip(jacobians, (finger, other), strict=True):
                mujoco.mj_jac(model, data, jacobian, None, contact.pos, model.geom_bodyid[geom])

            velocity = contact.frame.reshape(3, 3) @ (jacobians[1] - jacobians[0]) @ data.qvel
            speed_m_s = float(np.hypot(*velocity[1:]))

    return float(forces[0]), float(np.hypot(*forces[1:3])), speed_m_s


def build_model(design: Design) -> mujoco.MjModel:
    """Build a fingertip that points up, with the stiffness of the
    design's pad, and a block that may slide on it.
    """
    law = fit_contact(design)
    numbers = {"solref": law.solref(1 / BLOCK_KG), "solimp": law.solimp}
    stiffness = " ".join(
        f'{name}="{" ".join(map(str, values))}"' for name, values in numbers.items()
    )

    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="{STEP_S}" cone="elliptic" impratio="10000"/>
      <worldbody>
        <geom name="fingertip" type="ellipsoid" size="0.009 0.012 0.009" priority="1" friction="0.5" {stiffness}/>
        <body pos="0 0 0.0295">
          <joint name="along" type="slide" axis="1 0 0" damping="10"/>
          <joint name="down" type="slide" axis="0 0 -1" damping="20"/>
          <geom name="block" type="box" size="0.1 0.03 0.02" mass="{BLOCK_KG}"/>
        </body>
      </worldbody>
      <actuator><motor name="pull" joint="along"/><motor name="press" joint="down"/></actuator>
    </mujoco>""")  # noqa: E501


def slide(
    surface: str, name: str = "adult_finger", seed: int = 1
) -> tuple[dict[Slip, float], int, Reading]:
    """Press a block, pull until it slides; return delays [s] by
    state, false alarms before, and a held reading.
    """
    design = Design.load(name, changes={"detector.sample_rate_hz": 1 / STEP_S})
    model = build_model(design)
    felt = FeltContact(design, surface, seed=seed)
    data = mujoco.MjData(model)
    ids = [model.geom(one).id for one in ("fingertip", "block")]
    onset_s = None
    alarms = 0
    delays = {}
    held = None

    while data.time < min(END_S, (onset_s or END_S) + SLIDE_S):
        pressed_n = PRESS_N * min(1.0, max(0.0, data.time - PRESS_S) / 0.2)
        data.ctrl[:] = (
            min(PULL_N_PER_S * max(0.0, data.time - PULL_S), MAX_PULL_N),
            pressed_n - 9.81 * BLOCK_KG,
        )
        mujoco.mj_step(model, data)
        normal_n, tangential_n, sliding_m_s = measure_contact(model, data, *ids)
        reading = felt.step(normal_n, tangential_n, sliding_m_s)
        if onset_s is None and data.time > PULL_S and sliding_m_s > 1e-3:
            onset_s = data.time

        if onset_s is None:
            held = reading
            alarms = alarms + (reading.slip == Slip.ON and data.time > PRESS_S + 0.4)
        else:
            delays |= {
                state: data.time - onset_s
                for state in Slip
                if state not in delays and state <= reading.slip
            }

    return delays, alarms, held


if __name__ == "__main__":
    for surface in ("smooth", "medium", "gross"):
        delays, alarms, held = slide(surface)
        found = [
            f"{state.name} {1e3 * delay_s:.1f} ms" for state, delay_s in delays.items() if state
        ]
        after = f"{' and '.join(found) or 'nothing'} after the onset; {alarms} false alarms"
        print(f"{surface}: pressed by {PRESS_N:g} N, felt {held.force_n:.2f} N; {after}")
