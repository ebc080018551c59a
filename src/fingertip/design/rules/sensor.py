"""Rules of a sensor that is not in the catalogue: what no sensor can be is refused."""

from __future__ import annotations

from fingertip.design.geometry.dimensions import compute_dimensions
from fingertip.design.parameters import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, ceil2

RULES = Ruleset()
_TAB_MM = 1.0  # width of a solder tab: an assumption


@RULES.rule("custom_sensor.active_diameter_mm", "custom_sensor.head_diameter_mm", "sensor.model")
def _active_area_within_head(d: DesignTables) -> str | None:
    maximum = d.custom_sensor.head_diameter_mm
    if d.sensor.model != "custom" or d.custom_sensor.active_diameter_mm <= maximum + SLACK:
        return None
    return f"{d.custom_sensor.active_diameter_mm:g} mm is wider than the sensor's head; at most {maximum:g} mm."


@RULES.rule("custom_sensor.tail_width_mm", "sensor.model")
def _tail_holds_its_tabs(d: DesignTables) -> str | None:
    pitch = compute_dimensions(d).sensor.tab_pitch_mm
    minimum = pitch + _TAB_MM
    if d.sensor.model != "custom" or d.custom_sensor.tail_width_mm >= minimum - SLACK:
        return None
    return (
        f"{d.custom_sensor.tail_width_mm:g} mm does not hold two solder tabs of {_TAB_MM:g} mm, {pitch:g} mm apart; "
        f"at least {ceil2(minimum)} mm."
    )
