"""A scene's stages up to the contact's force: hand, stage, friction, profile, shaking."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.contact import coupled, vibration
from fingertip.sim.contact.friction import ELASTO_PLASTIC, GROSS_SLIP_M_S, Friction
from fingertip.sim.contact.pad import DAMPING_RATIO, HAND_N_PER_M
from fingertip.sim.contact.tangential import Motion, drag
from fingertip.sim.scenes import disturbances
from fingertip.sim.stages.context import Context

Given = Mapping[str, Any]


def press(c: Context, given: Given) -> dict[str, Any]:
    """What the hand presses with, before vibration."""
    return {"load_n": c.timeline.load_n(c.pad, c.time_s)}


def move_stage(c: Context, given: Given) -> dict[str, Any]:
    """Way and velocity of the robot."""
    slide = c.timeline.slide
    assert slide
    return {"stage_m": slide.position_m(c.time_s), "stage_m_s": slide.velocity_m_s(c.time_s)}


def rub(c: Context, given: Given) -> dict[str, Any]:
    """The pad dragged over the surface, with fixed steps."""
    load, stage = given["load_n"], given["stage_m"]
    motion = drag(c.surface.friction, c.mount, c.step_s, stage, given["stage_m_s"], load)
    return _moved(motion, stage) | {"evaluations": 2 * (len(load) - 1)}


def rub_controlled(c: Context, given: Given) -> dict[str, Any]:
    """Friction with error control; the load is followed by a contact far faster than any of its changes."""
    press = coupled.Press(2000.0, 1.0)
    return _integrated(c, given, given["load_n"], press)


def rub_fed_back(c: Context, given: Given) -> dict[str, Any]:
    """Vibration acts back on friction. The profile is felt along the way that friction gives without it."""
    first = rub(c, given)
    felt = feel_profile(c, {**given, "position_m": first["position_m"]})["felt_n"]
    pressing = given["load_n"] + felt + given.get("push_n", 0.0)
    share = HAND_N_PER_M / c.pad.normal_stiffness_n_per_m(c.force_n)
    made = _integrated(c, given, pressing, coupled.Press(c.pad.resonance_hz(c.force_n), DAMPING_RATIO, share))
    made["evaluations"] += first["evaluations"]
    made["contact_n"] = np.where(given["load_n"] > 0.0, made["contact_n"], 0.0)
    return made


def _integrated(c: Context, given: Given, pressing_n: Array, press: coupled.Press) -> dict[str, Any]:
    run = coupled.integrate(
        _friction(c), c.mount, press, c.step_s, given["stage_m"], given["stage_m_s"], pressing_n, 1e-6
    )
    return _moved(run, given["stage_m"]) | {"contact_n": run.force_n, "evaluations": run.evaluations}


def _friction(c: Context) -> Friction:
    friction = c.surface.friction
    if c.scene.contact.bristles == "elasto_plastic":
        return Friction(**(vars(friction) | {"elastic": ELASTO_PLASTIC}))
    return friction


def _moved(motion: Motion | coupled.Coupled, stage_m: Array) -> dict[str, Any]:
    return {
        "position_m": motion.position_m,
        "grid_velocity_m_s": motion.velocity_m_s,
        "grid_bristle_m": motion.bristle_m,
        "grid_shear_m": stage_m - motion.position_m,
    }


def feel_profile(c: Context, given: Given) -> dict[str, Any]:
    """Force with which the surface shakes the pad."""
    s = c.surface
    line = vibration.profile(c.stream("surface"), s.roughness_um, s.cutoff_wavelength_m, c.scene.slide.distance_m)
    height = vibration.height_m(line, given["position_m"])
    felt = vibration.left_by_hand(height, c.step_s, c.pad.hand_hz)
    # The load presses the pad into the profile: stiffness at the force of the moment, none without contact.
    return {"felt_n": c.pad.normal_stiffness_n_per_m(1.0) * np.cbrt(given["load_n"]) * felt}


def shake(c: Context, given: Given) -> dict[str, Any]:
    """Forces of taps and motors."""
    scene, held = c.scene, c.timeline.held_s
    push = np.zeros_like(c.time_s)
    if scene.tap.force_n:
        push += disturbances.taps_n(scene.tap, held, c.time_s)
    if scene.motor.force_n:
        push += disturbances.motor_n(scene.motor, c.stream("motor"), held, c.time_s)
    return {"push_n": np.where(given["load_n"] > 0.0, push, 0.0)}


def touch(c: Context, given: Given) -> dict[str, Any]:
    """Contact force: the load and all that shakes it, through the pad's resonance."""
    load = given["load_n"]
    drive = load + given["felt_n"] if "felt_n" in given else load
    if "push_n" in given:
        drive = drive + given["push_n"]
    contact = vibration.resonate(drive, load > 0.0, c.step_s, c.pad.resonance_hz(c.force_n), DAMPING_RATIO)
    return {"contact_n": contact, "evaluations": len(load)}


def force_of_samples(c: Context, given: Given) -> dict[str, Any]:
    """Contact force at the samples."""
    return {"force_n": given["contact_n"][c.every]}


def judge_slip(c: Context, given: Given) -> dict[str, Any]:
    """The truth: gross slip, and the pad's velocity."""
    velocity = given["grid_velocity_m_s"][c.every]
    sliding = _friction(c).sliding_m_s(velocity, given["grid_bristle_m"][c.every])
    return {"slip": (sliding > GROSS_SLIP_M_S) & (given["load_n"][c.every] > 0.0), "velocity_m_s": velocity}


def shear_of_samples(c: Context, given: Given) -> dict[str, Any]:
    """Shear of the pad at the samples."""
    return {"shear_m": given["grid_shear_m"][c.every]}


def stand_still(c: Context, given: Given) -> dict[str, Any]:
    """The truth where nothing moves."""
    nothing = np.zeros_like(given["load_n"][c.every])
    return {"slip": nothing > 0.0, "velocity_m_s": nothing, "shear_m": nothing}
