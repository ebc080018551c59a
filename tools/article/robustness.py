"""Tables of what the delays depend on: changed assumptions, effects
that the trials leave out, and the time step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import partial
from typing import TYPE_CHECKING, Any

from fingertip.lab.report.results import format_ms, to_number
from tools.article.sensitivity import LOADED_ON, LOADS_N, VariationResult
from tools.article.steps import GOAL_SHARE, StepSensitivity

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

LEVELS_ARE_ASSUMED = (
    "Levels of pink noise, hum, vibration of the hand and stick-slip are "
    "assumptions that nobody has verified."
)


def variations_as_data(variations: Sequence[VariationResult]) -> list[dict[str, Any]]:
    """Return the results of the variations for JSON; what is infinite or unknown is null."""
    rows = (to_data(v, {"found_share": 5, "alarms_per_minute": 4}) for v in variations)
    names = {"label": "variation", "is_realistic": "realistic", "is_law": "law"}
    return [{names.get(name, name): value for name, value in row.items()} for row in rows]


def variation_table(variations: Sequence[VariationResult], detector: str) -> list[str]:
    """Table of the assumptions: first the changed values by size of
    their effect, then the realistic effects.
    """
    base, *others = variations
    ranked = sorted(
        (v for v in others if not (v.is_realistic or v.is_law)),
        key=lambda v: -abs(v.change_s) if math.isfinite(v.change_s) else -math.inf,
    )
    lines = [
        "",
        f"{detector} with each assumption changed, delays in ms; worst: largest mean of a "
        "surface; onset: change of",
        "the true onset of slip; vibration: RMS of the normal force above 30 Hz in slip; "
        "envelope: mean of the",
        f"board's in slip on {LOADED_ON}, at {LOADS_N[0]:g} and {LOADS_N[1]:g} N:",
        f"{'found':>13} {'median':>7} {'change':>7} {'p90':>7} {'worst':>7} {'alarms/min':>10} "
        f"{'onset':>6} "
        f"{'vibration':>9} {'envelope':>15}",
        _variation_row(base, base),
        *(_variation_row(v, base) for v in ranked),
    ]
    laws = [v for v in others if v.is_law]
    realistic = [v for v in others if v.is_realistic]
    if laws:
        lines += ["other laws of the contact:", *(_variation_row(v, base) for v in laws)]

    if realistic:
        lines += ["effects of real fingers that the trials leave out by default:"]
        lines += [_variation_row(v, base) for v in realistic]
        lines.append(LEVELS_ARE_ASSUMED)

    return lines


_ms = partial(format_ms, unit="")


def _variation_row(v: VariationResult, base: VariationResult) -> str:
    found = f"{100 * v.found_share:5.1f}% of {v.slips:3}"
    if v is base:
        change = ""
    elif math.isfinite(v.change_s):
        change = f"{1000 * v.change_s:+.1f}"
    else:
        change = "found" if math.isfinite(v.median_s) > math.isfinite(base.median_s) else "missed"

    onset = "" if v is base else _ms(v.onset_change_s, "?", "+.1f")
    envelope = f"{format_mv(v.light_v)} / {format_mv(v.firm_v)} mV"
    return (
        f"{found:>13} {_ms(v.median_s):>7} {change:>7} {_ms(v.p90_s):>7} {_ms(v.worst_mean_s):>7} "
        f"{v.alarms_per_minute:10.2f} {onset:>6} {format_mn(v.vibration_n):>9} {envelope:>15}  "
        f"{v.label}"
    )


def step_table(steps: StepSensitivity) -> list[str]:
    """Table of the shifts of each detector's delay with the time
    step, and of the largest errors of the signals.
    """
    count = f"{steps.trials} trial{'s' * (steps.trials != 1)}"
    shift_ms = partial(format_ms, otherwise="not found")
    lines = [
        "",
        f"effect of the time step: {count}, with a step {steps.refinement} times as fine and the "
        "same noise; goal: in "
        f"{100 * GOAL_SHARE:g} % of the",
        "trials that a detector finds, its delay shifts by no more than one sample:",
        f"{'shift of':12} {'beyond one sample':>18} {'median':>10} {'p90':>10} "
        f"{'worst':>10}   goal",
    ]
    lines += [
        f"{row.detector:12} {f'{row.beyond_sample} of {row.trials}':>18} "
        f"{shift_ms(row.median_s):>10} "
        f"{shift_ms(row.p90_s):>10} {shift_ms(row.worst_s):>10}   "
        f"{'met' if row.meets_goal else 'MISSED'}"
        for row in steps.shifts
    ]
    lines.append("largest error in a trial:")

    for row in steps.errors:
        median, p90, worst = (
            format_milli(value, row.signal) for value in (row.median, row.p90, row.worst)
        )
        lines.append(f"{row.signal:12} {'':18} {median:>10} {p90:>10} {worst:>10}")

    return lines


def format_mn(newtons: float) -> str:
    return f"{1000 * newtons:.1f} mN" if math.isfinite(newtons) else "no slip"


def format_mv(volts: float) -> str:
    """Format a voltage in millivolts, without the unit."""
    return f"{1000 * volts:{'.0f' if volts >= 0.1 else '.2g'}}" if math.isfinite(volts) else "-"


def format_milli(value: float, signal: str) -> str:
    """Format a value of a signal in thousandths of its unit, which its name ends with."""
    return f"{1000 * value:.3f} m{signal.rpartition('_')[2].upper()}"


def to_data(row: DataclassInstance, decimals: Mapping[str, int] | None = None) -> dict[str, Any]:
    """Fields of a row by name, rounded, some of them to fewer
    decimals; None stands for what is not finite.
    """
    data = {field.name: getattr(row, field.name) for field in fields(row)}
    data |= {name: to_number(value) for name, value in data.items() if isinstance(value, float)}
    return data | {
        name: round(getattr(row, name), count) for name, count in (decimals or {}).items()
    }
