"""Rules of a custom sensor: an outline that no sensor can have is refused."""

from __future__ import annotations

from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.geometry.dimensions import TAB_WIDTH_MM
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_least, at_most

RULES = Ruleset()


@RULES.rule("custom_sensor.active_diameter_mm")
def active_area_within_head(design: DesignTables) -> Violation | None:
    """The active area is not wider than the sensor's head."""
    if design.sensor.model != "custom":
        return None
    active, head = design.custom_sensor.active_diameter_mm, design.custom_sensor.head_diameter_mm
    if active <= head + SLACK:
        return None
    return Violation(f"{active:g} mm is wider than the sensor's head", at_most(head))


@RULES.rule("custom_sensor.tail_width_mm")
def tail_holds_its_tabs(design: DesignTables) -> Violation | None:
    """The tail is wide enough for two solder tabs."""
    if design.sensor.model != "custom":
        return None
    width, pitch = design.custom_sensor.tail_width_mm, design.dimensions.sensor.tab_pitch_mm
    minimum = pitch + TAB_WIDTH_MM
    if width >= minimum - SLACK:
        return None
    return Violation(
        f"{width:g} mm does not hold two solder tabs of {TAB_WIDTH_MM:g} mm, {pitch:g} mm apart", at_least(minimum)
    )
