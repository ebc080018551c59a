"""Rules of a calibrated force curve: its forces are in order."""

from __future__ import annotations

from fingertip.design.geometry.design_tables import DesignTables
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_least, at_most

RULES = Ruleset()


@RULES.rule("force_curve.turn_on_n")
def turn_on_below_calibration(design: DesignTables) -> Violation | None:
    """The sensor conducts at the smallest force of the calibration."""
    curve = design.force_curve
    if curve.turn_on_n <= curve.min_force_n + SLACK:
        return None
    return Violation(
        f"{curve.turn_on_n:g} N is above the smallest force of the calibration", at_most(curve.min_force_n)
    )


@RULES.rule("force_curve.max_force_n")
def calibration_spans_forces(design: DesignTables) -> Violation | None:
    """The largest force of the calibration is not below the smallest."""
    curve = design.force_curve
    if curve.max_force_n >= curve.min_force_n - SLACK:
        return None
    return Violation(
        f"{curve.max_force_n:g} N is below the smallest force of the calibration", at_least(curve.min_force_n)
    )
