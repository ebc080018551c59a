"""The stages of a scene: hand, friction, surface, contact, sensor, bridge, converter, filter board.

A scene without a slide has no friction state; without vibration sources, no profile; and what nobody asked for is not
among the stages that run (`fingertip.sim.stages`).
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.sim import analog, comparator, coupled, disturbances, fsr, vibration
from fingertip.sim.circuit import Analog
from fingertip.sim.contact import Mount, drag
from fingertip.sim.friction import ELASTO_PLASTIC, Friction
from fingertip.sim.pad import DAMPING_RATIO, HAND_N_PER_M, Pad
from fingertip.sim.scene_file import SceneFile
from fingertip.sim.sensing import on_sensor_n, voltage_of
from fingertip.sim.stages import Stage
from fingertip.sim.surfaces import SURFACES, Surface
from fingertip.sim.timeline import Timeline, plan

Array = NDArray[np.float64]
Given = Mapping[str, Any]

GROSS_SLIP_M_S = 1e-3
"""Velocity of the pad over the surface above which slip is gross [m/s]. Assumption: 1/40 of the slowest
sliding."""
_LONGEST_STEP_S = 1.25e-4  # velocities are then within 1e-5 m/s of the limit (the convergence test holds that)


@dataclass(frozen=True)
class Context:
    """One run of a scene: what every stage may read."""

    design: Design
    scene: SceneFile
    seed: int

    def stream(self, what: str) -> random.Random:
        """Random numbers for one purpose: setting the force changes neither the surface nor the noise."""
        return random.Random(f"{self.seed}:{what}")

    @cached_property
    def force_n(self) -> float:
        """Holding force on this finger [N], drawn by the seed."""
        hold = self.scene.hold
        force = hold.force_least_n + (hold.force_most_n - hold.force_least_n) * self.stream("force").random()
        return force * hold.share if hold.mode == "grasp" else force

    @cached_property
    def pad(self) -> Pad:
        """The pad."""
        return Pad.of(self.design, self.scene.contact.resonance_hz)

    @cached_property
    def surface(self) -> Surface:
        """The surface."""
        return SURFACES[self.scene.contact.surface]

    @cached_property
    def timeline(self) -> Timeline:
        """When what happens."""
        return plan(self.scene, self.pad, self.force_n)

    @property
    def substeps(self) -> int:
        """Steps of the grid for each sample."""
        return math.ceil(1 / (self.design.detector.sample_rate_hz * _LONGEST_STEP_S) - 1e-9)

    @property
    def step_s(self) -> float:
        """Step of the grid [s]."""
        return 1 / (self.design.detector.sample_rate_hz * self.substeps)

    @cached_property
    def time_s(self) -> Array:
        """The grid [s]."""
        count = math.ceil(self.timeline.duration_s * self.design.detector.sample_rate_hz) * self.substeps + 1
        return np.arange(count, dtype=np.float64) * self.step_s

    @property
    def every(self) -> slice:
        """The samples among the grid's points."""
        return slice(None, None, self.substeps)

    @cached_property
    def mount(self) -> Mount:
        """The pad along the surface."""
        k = self.pad.tangential_stiffness_n_per_m(self.force_n)
        return Mount(self.pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * self.pad.mass_kg))


def stages_of(scene: SceneFile) -> list[Stage[Context]]:
    """All stages that this scene can have."""
    slides = scene.slide.distance_m > 0.0
    shaken = scene.tap.force_n > 0.0 or scene.motor.force_n > 0.0
    controlled = scene.contact.feedback or scene.contact.bristles == "elasto_plastic"
    touched = scene.cable.step_v != 0.0 or scene.cable.hum_v != 0.0
    push = ("push_n",) if shaken else ()
    felt = ("felt_n",) if slides else ()
    shear = ("grid_shear_m",) if slides else ()

    found = [Stage[Context]("hand", (), ("load_n",), _hand)]
    if slides:
        found.append(Stage("stage", (), ("stage_m", "stage_m_s"), _stage))
        moved = ("position_m", "grid_velocity_m_s", "grid_shear_m")
        if scene.contact.feedback:
            needs = ("load_n", "stage_m", "stage_m_s", *push)
            found.append(Stage("coupled contact", needs, (*moved, "contact_n"), _fed_back, coupled.STATES))
        elif controlled:
            needs = ("load_n", "stage_m", "stage_m_s")
            found.append(Stage("friction", needs, moved, _controlled, coupled.STATES))
        else:
            found.append(Stage("friction", ("load_n", "stage_m", "stage_m_s"), moved, _friction, 3))
        found.append(Stage("profile", ("load_n", "position_m"), ("felt_n",), _profile, 1))
        found.append(Stage("slip", ("load_n", "grid_velocity_m_s"), ("slip", "velocity_m_s"), _slip))
        found.append(Stage("shear", ("grid_shear_m",), ("shear_m",), _shear))
    else:
        found.append(Stage("still", ("load_n",), ("slip", "velocity_m_s", "shear_m"), _still))
    if shaken:
        found.append(Stage("shaking", ("load_n",), ("push_n",), _shaking))
    if not (slides and scene.contact.feedback):
        found.append(Stage("contact", ("load_n", *felt, *push), ("contact_n",), _contact, 2))
    found += [
        Stage("force", ("contact_n",), ("force_n",), _force),
        Stage("sensor", ("contact_n", *shear), ("shown_n",), _sensor, 1),
        Stage("cable", (), ("cable_v",), _cable),
        Stage("bridge", ("shown_n", *(("cable_v",) if touched else ())), ("tactile_v",), _bridge),
        Stage("converter", ("tactile_v",), ("voltage_v",), _converter),
        Stage("filter board", ("tactile_v",), ("filtered_v", "envelope_v"), _board, 4),
        Stage("comparator", ("filtered_v", "envelope_v"), ("slip_pin_v",), _comparator, 1),
    ]
    return found


def _hand(c: Context, given: Given) -> dict[str, Any]:
    return {"load_n": c.timeline.load_n(c.pad, c.time_s)}


def _stage(c: Context, given: Given) -> dict[str, Any]:
    slide = c.timeline.slide
    assert slide
    return {"stage_m": slide.position_m(c.time_s), "stage_m_s": slide.velocity_m_s(c.time_s)}


def _friction(c: Context, given: Given) -> dict[str, Any]:
    load, stage = given["load_n"], given["stage_m"]
    motion = drag(c.surface.friction, c.mount, c.step_s, stage, given["stage_m_s"], load)
    return _moved(motion.position_m, motion.velocity_m_s, stage) | {"evaluations": 2 * (len(load) - 1)}


def _controlled(c: Context, given: Given) -> dict[str, Any]:
    """Friction with error control; the load is followed by a contact far faster than any of its changes."""
    press = coupled.Press(2000.0, 1.0)
    return _integrated(c, given, given["load_n"], press)


def _fed_back(c: Context, given: Given) -> dict[str, Any]:
    """Vibration acts back on friction. The profile is felt along the way that friction gives without it."""
    first = _friction(c, given)
    felt = _profile(c, {**given, "position_m": first["position_m"]})["felt_n"]
    pressing = given["load_n"] + felt + given.get("push_n", 0.0)
    share = HAND_N_PER_M / c.pad.normal_stiffness_n_per_m(c.force_n)
    made = _integrated(c, given, pressing, coupled.Press(c.pad.resonance_hz(c.force_n), DAMPING_RATIO, share))
    made["evaluations"] += first["evaluations"]
    made["contact_n"] = np.where(given["load_n"] > 0.0, made["contact_n"], 0.0)
    return made


def _integrated(c: Context, given: Given, pressing_n: Array, press: coupled.Press) -> dict[str, Any]:
    friction = c.surface.friction
    if c.scene.contact.bristles == "elasto_plastic":
        friction = Friction(**(vars(friction) | {"elastic": ELASTO_PLASTIC}))
    run = coupled.integrate(friction, c.mount, press, c.step_s, given["stage_m"], given["stage_m_s"], pressing_n, 1e-6)
    moved = _moved(run.position_m, run.velocity_m_s, given["stage_m"])
    return moved | {"contact_n": run.force_n, "evaluations": run.evaluations}


def _moved(position_m: Array, velocity_m_s: Array, stage_m: Array) -> dict[str, Any]:
    return {
        "position_m": position_m,
        "grid_velocity_m_s": velocity_m_s,
        "grid_shear_m": stage_m - position_m,
    }


def _profile(c: Context, given: Given) -> dict[str, Any]:
    s = c.surface
    line = vibration.profile(c.stream("surface"), s.roughness_um, s.cutoff_wavelength_m, c.scene.slide.distance_m)
    height = vibration.height_m(line, given["position_m"])
    felt = vibration.left_by_hand(height, c.step_s, c.pad.hand_hz)
    # The load presses the pad into the profile: stiffness at the force of the moment, none without contact.
    return {"felt_n": c.pad.normal_stiffness_n_per_m(1.0) * np.cbrt(given["load_n"]) * felt}


def _shaking(c: Context, given: Given) -> dict[str, Any]:
    scene, held = c.scene, c.timeline.held_s
    push = np.zeros_like(c.time_s)
    if scene.tap.force_n:
        push += disturbances.taps_n(scene.tap, held, c.time_s)
    if scene.motor.force_n:
        push += disturbances.motor_n(scene.motor, c.stream("motor"), held, c.time_s)
    return {"push_n": np.where(given["load_n"] > 0.0, push, 0.0)}


def _contact(c: Context, given: Given) -> dict[str, Any]:
    load = given["load_n"]
    drive = load + given["felt_n"] if "felt_n" in given else load
    if "push_n" in given:
        drive = drive + given["push_n"]
    contact = vibration.resonate(drive, load > 0.0, c.step_s, c.pad.resonance_hz(c.force_n), DAMPING_RATIO)
    return {"contact_n": contact, "evaluations": len(load)}


def _force(c: Context, given: Given) -> dict[str, Any]:
    return {"force_n": given["contact_n"][c.every]}


def _slip(c: Context, given: Given) -> dict[str, Any]:
    velocity = given["grid_velocity_m_s"]
    slip = (np.abs(velocity) > GROSS_SLIP_M_S) & (given["load_n"] > 0.0)
    return {"slip": slip[c.every], "velocity_m_s": velocity[c.every]}


def _shear(c: Context, given: Given) -> dict[str, Any]:
    return {"shear_m": given["grid_shear_m"][c.every]}


def _still(c: Context, given: Given) -> dict[str, Any]:
    nothing = np.zeros_like(given["load_n"][c.every])
    return {"slip": nothing > 0.0, "velocity_m_s": nothing, "shear_m": nothing}


def _sensor(c: Context, given: Given) -> dict[str, Any]:
    sensed = given["contact_n"]
    if "grid_shear_m" in given:
        sensed = on_sensor_n(sensed, given["grid_shear_m"])
    shown = fsr.with_hysteresis(sensed[c.every])
    if c.scene.drift.share_per_decade:
        shown = disturbances.creep(c.scene.drift, shown, 1 / c.design.detector.sample_rate_hz)
    return {"shown_n": shown, "evaluations": len(shown)}


def _cable(c: Context, given: Given) -> dict[str, Any]:
    return {"cable_v": disturbances.cable_v(c.scene.cable, c.timeline.held_s, c.time_s[c.every])}


def _bridge(c: Context, given: Given) -> dict[str, Any]:
    d, rng = c.design.detector, c.stream("noise")
    clean = map(voltage_of(c.design, c.scene.sensing.bridge), given["shown_n"].tolist())
    voltage = np.array([v + rng.gauss(0.0, d.noise_v) for v in clean])
    if "cable_v" in given:
        voltage = voltage + given["cable_v"]
    if c.scene.drift.volt_per_s:
        voltage = voltage + c.scene.drift.volt_per_s * c.time_s[c.every]
    return {"tactile_v": voltage}


def _converter(c: Context, given: Given) -> dict[str, Any]:
    d, jitter = c.design.detector, c.scene.sensing.jitter_s
    voltage = given["tactile_v"]
    if jitter:
        rng, time = c.stream("jitter"), c.time_s[c.every]
        # The voltage is taken a little early or late, on the straight line between samples.
        voltage = np.interp(time + [rng.gauss(0.0, jitter) for _ in range(len(time))], time, voltage)
    return {"voltage_v": fsr.quantise(voltage, d.adc_bits, d.adc_range_v)}


def _board(c: Context, given: Given) -> dict[str, Any]:
    out = analog.respond(Analog.of(c.design), 1 / c.design.detector.sample_rate_hz, given["tactile_v"])
    return {"filtered_v": out.filtered_v, "envelope_v": out.envelope_v, "evaluations": out.steps + out.rejected}


def _comparator(c: Context, given: Given) -> dict[str, Any]:
    step = 1 / c.design.detector.sample_rate_hz
    pin = comparator.pin_v(c.design, step, given["filtered_v"], given["envelope_v"])
    return {"slip_pin_v": pin, "evaluations": len(pin)}
