"""The stages of a scene: hand, friction, surface, contact, sensor, bridge, converter, filter board.

A scene without a slide has no friction state; without vibration sources, no profile; and what nobody asked for is not
among the stages that run (`fingertip.sim.stages.stage`).
"""

from __future__ import annotations

from fingertip.sim.contact import coupled
from fingertip.sim.scenes.scene_file import SceneFile
from fingertip.sim.stages import contact_stages, signal_stages
from fingertip.sim.stages.context import Context
from fingertip.sim.stages.stage import Stage


def stages_of(scene: SceneFile) -> list[Stage[Context]]:
    """All stages that this scene can have."""
    slides = scene.slide.distance_m > 0.0
    shaken = scene.tap.force_n > 0.0 or scene.motor.force_n > 0.0
    controlled = scene.contact.feedback or scene.contact.bristles == "elasto_plastic"
    touched = scene.cable.step_v != 0.0 or scene.cable.hum_v != 0.0
    push = ("push_n",) if shaken else ()
    felt = ("felt_n",) if slides else ()
    shear = ("grid_shear_m",) if slides else ()
    cable = ("cable_v",) if touched else ()
    jump = ("cable_jump_v",) if touched else ()

    found = [Stage[Context]("load", (), ("load_n",), contact_stages.press)]
    if slides:
        found.append(Stage("stage", (), ("stage_m", "stage_m_s"), contact_stages.move_stage))
        moved = ("position_m", "grid_velocity_m_s", "grid_bristle_m", "grid_shear_m")
        if scene.contact.feedback:
            needs = ("load_n", "stage_m", "stage_m_s", *push)
            found.append(
                Stage("coupled contact", needs, (*moved, "contact_n"), contact_stages.rub_fed_back, coupled.STATES)
            )
        elif controlled:
            needs = ("load_n", "stage_m", "stage_m_s")
            found.append(Stage("friction", needs, moved, contact_stages.rub_controlled, coupled.STATES))
        else:
            found.append(Stage("friction", ("load_n", "stage_m", "stage_m_s"), moved, contact_stages.rub, 3))
        found.append(Stage("profile", ("load_n", "position_m"), ("felt_n",), contact_stages.feel_profile, 1))
        needs = ("load_n", "grid_velocity_m_s", "grid_bristle_m")
        found.append(Stage("slip", needs, ("slip", "velocity_m_s"), contact_stages.judge_slip))
        found.append(Stage("shear", ("grid_shear_m",), ("shear_m",), contact_stages.shear_of_samples))
    else:
        found.append(Stage("still", ("load_n",), ("slip", "velocity_m_s", "shear_m"), contact_stages.stand_still))
    if shaken:
        found.append(Stage("shaking", ("load_n",), ("push_n",), contact_stages.shake))
    if not (slides and scene.contact.feedback):
        found.append(Stage("contact", ("load_n", *felt, *push), ("contact_n",), contact_stages.touch, 2))
    found += [
        Stage("force", ("contact_n",), ("force_n",), contact_stages.force_of_samples),
        Stage("sensor", ("contact_n", *shear), ("shown_n",), signal_stages.sense, 1),
        Stage("cable", (), ("cable_v", "cable_jump_v"), signal_stages.touch_cable),
        Stage("bridge", ("shown_n", *cable), ("bridge_v",), signal_stages.bridge),
        Stage("converter", ("bridge_v",), ("voltage_v",), signal_stages.convert),
        Stage("board noise", ("bridge_v",), ("tactile_v",), signal_stages.add_noise),
        Stage("filter board", ("tactile_v", *jump), ("filtered_v", "envelope_v"), signal_stages.filter_and_envelope, 4),
        Stage("comparator", ("filtered_v", "envelope_v"), ("slip_pin_v",), signal_stages.sense_slip_pin, 1),
    ]
    return found
