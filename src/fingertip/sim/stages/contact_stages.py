"""Stages of a scene up to the contact force: load, carriage, friction, surface profile, disturbances."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.contact import coupled, vibration
from fingertip.sim.contact.friction import ELASTO_PLASTIC, GROSS_SLIP_M_S, Friction
from fingertip.sim.contact.pad import DAMPING_RATIO, HAND_N_PER_M
from fingertip.sim.contact.tangential import PadMotion, drag
from fingertip.sim.scene import disturbances
from fingertip.sim.stages.context import SceneContext

Inputs = Mapping[str, Any]

_FAST_CONTACT = coupled.NormalContact(2000.0, 1.0)
"""Contact that follows the load, because it is far faster than any change of the load."""
_TOLERANCE_N = 1e-6
"""Permitted error of one step of the error-controlled integration [N]."""


def compute_load(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the pressing force of the hand, without vibration."""
    return {"load_n": context.timeline.load_n(context.pad, context.time_s)}


def move_carriage(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute position and velocity of the robot's carriage."""
    slide = context.timeline.slide
    assert slide
    return {"carriage_m": slide.position_m(context.time_s), "carriage_m_s": slide.velocity_m_s(context.time_s)}


def integrate_friction(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Drag the pad over the surface, with fixed steps."""
    load, carriage = inputs["load_n"], inputs["carriage_m"]
    motion = drag(context.surface.friction, context.mount, context.step_s, carriage, inputs["carriage_m_s"], load)
    return _motion_values(motion, carriage) | {"evaluations": 2 * (len(load) - 1)}


def integrate_friction_with_error_control(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Drag the pad over the surface, with error control. The contact force follows the load."""
    return _integrate(context, inputs, inputs["load_n"], _FAST_CONTACT)


def integrate_with_feedback(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Integrate the contact in both directions, so that vibration acts back on friction.

    The surface profile is read along the path that results without this feedback.
    """
    first = integrate_friction(context, inputs)
    profile = compute_profile_force(context, {**inputs, "position_m": first["position_m"]})["profile_n"]
    pressing = inputs["load_n"] + profile + inputs.get("disturbance_n", 0.0)
    hand_ratio = HAND_N_PER_M / context.pad.normal_stiffness_n_per_m(context.force_n)
    normal = coupled.NormalContact(context.pad.resonance_hz(context.force_n), DAMPING_RATIO, hand_ratio)
    values = _integrate(context, inputs, pressing, normal)
    values["evaluations"] += first["evaluations"]
    values["contact_n"] = np.where(inputs["load_n"] > 0.0, values["contact_n"], 0.0)
    return values


def _integrate(
    context: SceneContext, inputs: Inputs, pressing_n: Array, normal: coupled.NormalContact
) -> dict[str, Any]:
    carriage, speed = inputs["carriage_m"], inputs["carriage_m_s"]
    motion = coupled.integrate(
        _friction(context), context.mount, normal, context.step_s, carriage, speed, pressing_n, _TOLERANCE_N
    )
    return _motion_values(motion, carriage) | {"contact_n": motion.force_n, "evaluations": motion.evaluations}


def _friction(context: SceneContext) -> Friction:
    friction = context.surface.friction
    if context.scene.contact.bristles == "elasto_plastic":
        return Friction(**(vars(friction) | {"elastic": ELASTO_PLASTIC}))
    return friction


def _motion_values(motion: PadMotion | coupled.CoupledMotion, carriage_m: Array) -> dict[str, Any]:
    return {
        "position_m": motion.position_m,
        "grid_velocity_m_s": motion.velocity_m_s,
        "grid_bristle_m": motion.bristle_m,
        "grid_shear_m": carriage_m - motion.position_m,
    }


def compute_profile_force(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the force with which the surface profile shakes the pad."""
    surface, length = context.surface, context.scene.slide.distance_m
    rng = context.random_stream("surface")
    profile = vibration.generate_profile(rng, surface.roughness_um, surface.cutoff_wavelength_m, length)
    height = vibration.interpolate_height_m(profile, inputs["position_m"])
    deflection = vibration.compute_pad_deflection_m(height, context.step_s, context.pad.hand_hz)
    # The load presses the pad into the profile: stiffness at the present force, and none without contact.
    return {"profile_n": context.pad.normal_stiffness_n_per_m(1.0) * np.cbrt(inputs["load_n"]) * deflection}


def compute_disturbances(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the forces of knocks and motors."""
    scene, held = context.scene, context.timeline.held_s
    force = np.zeros_like(context.time_s)
    if scene.tap.force_n:
        force += disturbances.knock_force_n(scene.tap, held, context.time_s)
    if scene.motor.force_n:
        force += disturbances.motor_force_n(scene.motor, context.random_stream("motor"), held, context.time_s)
    return {"disturbance_n": np.where(inputs["load_n"] > 0.0, force, 0.0)}


def compute_contact_force(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the contact force: the load and all vibration, through the resonance of the pad."""
    load = inputs["load_n"]
    drive = load + inputs["profile_n"] if "profile_n" in inputs else load
    if "disturbance_n" in inputs:
        drive = drive + inputs["disturbance_n"]
    frequency = context.pad.resonance_hz(context.force_n)
    contact = vibration.apply_resonance(drive, load > 0.0, context.step_s, frequency, DAMPING_RATIO)
    return {"contact_n": contact, "evaluations": len(load)}


def sample_force(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Select the contact force at the samples."""
    return {"force_n": inputs["contact_n"][context.samples]}


def compute_true_slip(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the ground truth: gross slip, and the velocity of the pad."""
    velocity = inputs["grid_velocity_m_s"][context.samples]
    sliding = _friction(context).sliding_speed_m_s(velocity, inputs["grid_bristle_m"][context.samples])
    slip = (sliding > GROSS_SLIP_M_S) & (inputs["load_n"][context.samples] > 0.0)
    return {"slip": slip, "velocity_m_s": velocity}


def sample_shear(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Select the shear of the pad at the samples."""
    return {"shear_m": inputs["grid_shear_m"][context.samples]}


def zero_motion(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Return the ground truth of a scene without a slide: no slip, no velocity, no shear."""
    zeros = np.zeros_like(inputs["load_n"][context.samples])
    return {"slip": zeros > 0.0, "velocity_m_s": zeros, "shear_m": zeros}
