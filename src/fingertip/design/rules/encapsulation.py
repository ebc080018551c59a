"""Rules of a bone that is encapsulated: it hangs in its holder, and the plug covers the tail."""

from __future__ import annotations

from fingertip.design.geometry import DesignTables
from fingertip.design.rules.ruleset import Limit, Ruleset, Violation
from fingertip.models.dimensions import KNOT_WIRES
from fingertip.models.encapsulation import floor_depth, roof_end_z
from fingertip.models.making import is_encapsulated
from fingertip.models.stand import post_gap_mm

RULES = Ruleset(when=is_encapsulated)

_LEAST_GROOVE_MM = 0.4
"""Least depth of the groove that holds a skin [mm]: silicone does not stick to prints."""


@RULES.rule("skin.made")
def bone_hangs_by_its_post(design: DesignTables) -> Violation | None:
    if design.bone.interface == "post":
        return None

    return Violation(
        f"encapsulated needs a bone with a post, by which it hangs in its holder; this one has the "
        f"interface {design.bone.interface}",
        alternatives={"skin.made": "cast"},
    )


@RULES.at_least("bone.groove_depth_mm", bone_hangs_by_its_post)
def groove_holds_skin(design: DesignTables) -> Limit:
    return Limit(_LEAST_GROOVE_MM, "does not hold silicone, which does not stick to the bone")


@RULES.at_most("mold.core_inset_mm", bone_hangs_by_its_post)
def no_core_is_inset(design: DesignTables) -> Limit:
    return Limit(0.0, "has no core to make smaller: the skin is cast around the bone")


@RULES.at_most("sensor.distance_from_tip_mm", bone_hangs_by_its_post)
def plug_ends_before_head(design: DesignTables) -> Limit:
    """The plug lies on the tail from its end on, and not on the head."""
    dims = design.dimensions
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    room = dims.sensor_z - head - roof_end_z(design)
    return Limit(
        design.sensor.distance_from_tip_mm + room,
        "leaves no room for the plug between collar and head",
    )


@RULES.at_most("sensor.wire_diameter_mm", bone_hangs_by_its_post)
def knot_passes_holder(design: DesignTables) -> Limit:
    room = design.dimensions.collar.section.palmar + post_gap_mm(design) - floor_depth(design)
    return Limit(room / KNOT_WIRES, "makes a knot that does not pass the holder")
