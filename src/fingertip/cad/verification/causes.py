"""Parameters to change if a check fails: the nearest causes, by the names of the checks."""

from __future__ import annotations

from fnmatch import fnmatchcase

_BUG = ()
"""A design that the rules accept never fails these checks: it would be a fault of the program."""

_CAUSES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("*.build_volume_excess", ("printer.bed_x_mm", "printer.bed_y_mm", "printer.bed_z_mm", "skin.length_mm")),
    ("plate_*.bed_excess", ("printer.bed_x_mm", "printer.bed_y_mm", "printer.bed_z_mm", "skin.length_mm")),
    ("plate_*", _BUG),
    ("mold*.overhang", ("mold.bolt_diameter_mm", "mold.chaplet_screw", "mold.engraving_height_mm")),
    ("*.overhang", ("bone.groove_depth_mm", "bone.interface", "mold.chaplet_diameter_mm")),
    ("skin.min_thickness", ("skin.thickness_side_mm", "bone.palmar_fullness", "skin.min_thickness_mm")),
    (
        "skin.*retained*",
        ("mold.fit_clearance_mm", "printer.surface_error_mm", "mold.chaplet_diameter_mm", "mold.chaplet_from_tip_mm"),
    ),
    ("skin.min_thickness_misaligned", ("mold.fit_clearance_mm", "mold.chaplet_from_tip_mm", "skin.min_thickness_mm")),
    ("skin.fitting_stretch", ("mold.max_stretch_percent", "bone.groove_depth_mm", "mold.sleeve_interference_mm")),
    ("bone.wall.channel*", ("bone.channel_diameter_mm", "bone.wall_mm")),
    ("bone.wall.sensor*", ("bone.rim_mm", "bone.wall_mm", "skin.width_mm")),
    ("bone.wall.trough*", ("skin.semi_axis_dorsal_mm", "skin.width_mm", "bone.wall_mm")),
    ("lid.wall", ("skin.semi_axis_dorsal_mm", "sensor.crimp_height_mm", "bone.wall_mm")),
    ("bone.wall.window*", ("bone.wall_mm", "skin.width_mm")),
    ("bone.wall.groove*", ("bone.wall_mm", "bone.tie_hole_diameter_mm")),
    ("bone.wall.pin*", ("hand.pin_diameter_mm", "hand.clearance_radius_mm")),
    ("bone.wall.anchor*", ("hand.tendon_distance_mm", "bone.anchor_diameter_mm")),
    ("bone.wall.socket*", ("bone.socket_diameter_mm", "bone.socket_depth_mm")),
    ("bone.wall.cheek", ("hand.width_mm",)),
    ("bone.wall.tongue", ("hand.width_mm",)),
    ("joint.tendon_overlap", ("hand.tendon_distance_mm", "hand.tendon_diameter_mm")),
    ("joint.*", ("hand.travel_deg", "bone.joint_clearance_mm", "hand.clearance_radius_mm")),
    ("sensor.pocket_clearance", ("sensor.clearance_mm", "sensor.adhesive_thickness_mm")),
    ("sensor.*", ("sensor.distance_from_tip_mm", "bone.relief_length_mm")),
    ("mold.wall.cavity_to_outside", ("mold.wall_mm",)),
    ("mold.wall.cavity_to_cutouts", ("mold.wall_mm", "mold.engraving_depth_mm", "mold.nut_depth_mm")),
    ("mold.land.*", ("mold.land_mm",)),
    ("mold.wall.runners_to_outside", ("mold.wall_mm", "mold.funnel_diameter_mm", "mold.runner_width_mm")),
    ("mold.wall.runners*", ("mold.land_mm", "mold.runner_width_mm", "mold.vent_diameter_mm")),
    ("mold.wall.side_vents*", ("mold.vent_diameter_mm", "mold.land_mm")),
    ("mold.wall.*", ("mold.land_mm", "mold.key_diameter_mm")),
    ("mold*.draft_clearance_gain*", ("mold.draft_deg",)),
    ("mold*.recess_clearance", ("mold.fit_clearance_mm",)),
    ("mold.cable*", ("mold.recess_length_mm", "bone.base_length_mm")),
    ("mold.air_trap_height", ("mold.vent_diameter_mm",)),
    ("mold.air_rise_time", ("silicone.viscosity_pa_s", "mold.filling")),
    ("mold.air_trapped", ("mold.vent_diameter_mm", "mold.chaplet_from_tip_mm", "mold.runner_width_mm")),
    ("mold.fill_time", ("mold.nozzle_bore_mm", "mold.thumb_force_n", "silicone.viscosity_pa_s", "mold.filling")),
    ("mold.syringe_force", ("mold.nozzle_bore_mm", "mold.syringe", "silicone.viscosity_pa_s")),
    ("mold.syringe_volume", ("mold.syringe",)),
    ("mold.bone_load", ("mold.thumb_force_n", "mold.syringe", "mold.chaplet_screw")),
    ("mold.opening_force", ("mold.thumb_force_n", "mold.syringe", "mold.bolt_diameter_mm")),
    (
        "mold.leak_length",
        ("mold.seat_tape_mm", "mold.fit_clearance_mm", "printer.offset_mm", "bone.collar_length_mm"),
    ),
    (
        "bone.safety_factor.grip_fdm",
        ("sensor.model", "bone.base_length_mm", "skin.length_mm", "skin.width_mm"),
    ),
    (
        "bone.safety_factor.*",
        ("sensor.model", "bone.base_length_mm", "skin.length_mm", "skin.width_mm", "strength.print_material"),
    ),
    ("*.step.volume_difference*", _BUG),
    ("*.stl.*", _BUG),
    ("*.3mf.*", _BUG),
    ("*.step.*", _BUG),
    ("step.*", _BUG),
    ("volume_balance.*", _BUG),
    ("overlap.*", _BUG),
    ("demolding_overlap.*", ("mold.draft_deg",)),
    ("skin.surface_deviation", _BUG),
    ("mold*", _BUG),
)
"""Pattern of names, and parameters; the first pattern that matches counts."""


def list_causes(check: str) -> tuple[str, ...]:
    """List the parameters to change if a check of this name fails; none if it would be a fault of the program.

    Raises
    ------
    LookupError
        If no pattern matches the name.
    """
    for pattern, parameters in _CAUSES:
        if fnmatchcase(check, pattern):
            return parameters
    raise LookupError(check)
