"""Tables and remarks on what the results of a validation depend on.

Changed assumptions, effects that the trials leave out, the time step, several ranges of seeds, and the wider mix.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fingertip.foundation.statistics import poisson_interval
from fingertip.lab.campaign import DetectorResult
from fingertip.lab.mix import MixSummary
from fingertip.lab.report.numbers import format_ms, to_data, to_number
from fingertip.lab.studies.sensitivity import (
    BOTH,
    ELASTO_PLASTIC,
    HELD_LONGER,
    PATCH_AVERAGE,
    STICK_SLIP,
    VariationResult,
)
from fingertip.lab.studies.steps import GOAL_SHARE, SignalError, StepSensitivity
from fingertip.sim.contact.surface_profile import SURFACES
from fingertip.slip.traces.origin import ENCODER_NOTE

LEVELS_ARE_ASSUMED = (
    "Levels of pink noise, hum, vibration of the hand and stick-slip are assumptions that nobody has verified."
)


def variations_as_data(variations: Sequence[VariationResult]) -> list[dict[str, Any]]:
    """Return the results of the variations for JSON; what is infinite or unknown is null."""
    rows = (to_data(v, {"found_share": 5, "alarms_per_minute": 4}) for v in variations)
    return [{"variation": row.pop("label"), "realistic": row.pop("is_realistic"), **row} for row in rows]


def steps_as_data(steps: StepSensitivity) -> dict[str, Any]:
    """Return the effect of the time step for JSON; an infinite shift is null."""
    return {
        "trials": steps.trials,
        "refinement": steps.refinement,
        "goal_share": GOAL_SHARE,
        "delay_shifts": [to_data(row) | {"meets_goal": row.meets_goal} for row in steps.shifts],
        "errors": list(map(to_data, steps.errors)),
    }


def variation_table(variations: Sequence[VariationResult], detector: str) -> list[str]:
    """Table of the assumptions: first the changed values by size of their effect, then the realistic effects."""
    base, *others = variations
    ranked = sorted(
        (v for v in others if not v.is_realistic),
        key=lambda v: -abs(v.change_s) if math.isfinite(v.change_s) else -math.inf,
    )
    lines = [
        "",
        f"{detector} with each assumption changed; onset: change of the true onset of slip; vibration: RMS of the",
        "normal force above 30 Hz in slip:",
        f"{'median':>10} {'change':>10} {'found':>14} {'alarms/min':>10} {'onset':>10} {'vibration':>11}",
        _variation_row(base, base),
        *(_variation_row(v, base) for v in ranked),
    ]
    realistic = [v for v in others if v.is_realistic]
    if realistic:
        lines += ["effects of real fingers that the trials leave out by default:"]
        lines += [_variation_row(v, base) for v in realistic]
        lines.append(LEVELS_ARE_ASSUMED)
    return lines


def _variation_row(v: VariationResult, base: VariationResult) -> str:
    found = f"{100 * v.found_share:5.1f}% of {v.slips:3}"
    if v is base:
        change = ""
    elif math.isfinite(v.change_s):
        change = f"{1000 * v.change_s:+.1f} ms"
    else:
        change = "found" if math.isfinite(v.median_s) > math.isfinite(base.median_s) else "missed"
    onset = "" if v is base else _signed_ms(v.onset_change_s)
    return (
        f"{format_ms(v.median_s):>10} {change:>10} {found:>14} {v.alarms_per_minute:10.2f} {onset:>10} "
        f"{_mn(v.vibration_n):>11}  {v.label}"
    )


def step_table(steps: StepSensitivity) -> list[str]:
    """Table of the shifts of each detector's delay with the time step, and of the largest errors of the signals."""
    count = f"{steps.trials} trial{'s' * (steps.trials != 1)}"
    lines = [
        "",
        f"effect of the time step: {count}, with a step {steps.refinement} times as fine and the same noise; goal: in "
        f"{100 * GOAL_SHARE:g} % of the",
        "trials that a detector finds, its delay shifts by no more than one sample:",
        f"{'shift of':12} {'beyond one sample':>18} {'median':>10} {'p90':>10} {'worst':>10}   goal",
    ]
    lines += [
        f"{row.detector:12} {f'{row.beyond_sample} of {row.trials}':>18} {_shift_ms(row.median_s):>10} "
        f"{_shift_ms(row.p90_s):>10} {_shift_ms(row.worst_s):>10}   {'met' if row.meets_goal else 'MISSED'}"
        for row in steps.shifts
    ]
    lines.append("largest error in a trial:")
    lines += [
        f"{row.signal:12} {'':18} {_milli(row, row.median):>10} {_milli(row, row.p90):>10} {_milli(row, row.worst):>10}"
        for row in steps.errors
    ]
    return lines


def realism_remarks(variations: Sequence[VariationResult], detector: str, patch_radius_m: float) -> Iterator[str]:
    """Say what the realistic effects mean for a detector, one remark each."""
    base, rows = variations[0], {v.label: v for v in variations}
    if PATCH_AVERAGE in rows:
        yield _patch_remark(base, rows[PATCH_AVERAGE], rows.get(STICK_SLIP), rows.get(BOTH), detector, patch_radius_m)
    if ELASTO_PLASTIC in rows:
        row = rows[ELASTO_PLASTIC]
        yield (
            f"Model of the bristles: with elasto-plastic instead of plain bristles, the true onset of slip moves by "
            f"{_signed_ms(row.onset_change_s)} (median of the trials). Delays count from this onset, so they depend on "
            f"the model by as much: {_describe(row, detector)}."
        )
    for row in variations[1:]:
        if row.is_realistic and row.label not in (PATCH_AVERAGE, STICK_SLIP, BOTH, ELASTO_PLASTIC):
            yield f"{row.label[0].upper()}{row.label[1:]}: {_describe(row, detector)}."
    yield (
        "A detector that is ON already when slip begins has not found it. The trials hold for 1 s before slip, in "
        f"which the noise floor of the detector fast has not adapted yet; the rows that are {HELD_LONGER} show it "
        "adapted. Their recordings are longer, which alone lowers the false alarms per minute. Thresholds follow from "
        "white noise; with other noise, `fingertip detect --calibrate` sets them from a quiet part of the recording."
    )
    yield LEVELS_ARE_ASSUMED


def _patch_remark(
    base: VariationResult,
    patch: VariationResult,
    stick_slip: VariationResult | None,
    both: VariationResult | None,
    detector: str,
    patch_radius_m: float,
) -> str:
    wavelengths = sorted({1000 * surface.cutoff_wavelength_m for surface in SURFACES.values()})
    ratio = base.vibration_n / patch.vibration_n if patch.vibration_n else math.inf
    text = (
        f"Patch average: a pad that averages the surface over its contact patch (radius {1000 * patch_radius_m:.3g} mm "
        f"at 1 N, against roughness of wavelengths up to {wavelengths[0]:g} mm, or {wavelengths[-1]:g} mm on the "
        f"roughest surfaces) vibrates {ratio:.0f} times less in slip ({_mn(base.vibration_n)} become "
        f"{_mn(patch.vibration_n)}). The unchanged trials, in which it follows one line, are therefore the favourable "
        f"case. Detection then rests on shear and stick-slip: {_describe(patch, detector)}"
    )
    if stick_slip and both:
        text += f"; with stick-slip as well, {_describe(both, detector)}; with stick-slip alone, "
        text += _describe(stick_slip, detector)
    return f"{text}. Unchanged, {_describe(base, detector)}."


def _describe(row: VariationResult, detector: str) -> str:
    """Result of a variation in words."""
    found = f"{100 * row.found_share:.0f} % of {row.slips} slips"
    delay = f"with a median delay of {format_ms(row.median_s)}"
    if not math.isfinite(row.median_s):
        delay = "too few for a median delay"
    return f"{detector} finds {found}, {delay}, at {row.alarms_per_minute:.2f} false alarms per minute"


def step_remarks(steps: StepSensitivity) -> Iterator[str]:
    """Say what the time step changes."""
    parts = [
        f"{row.detector} {row.beyond_sample} of {row.trials} (worst {_shift_ms(row.worst_s)})" for row in steps.shifts
    ]
    missed = [row.detector for row in steps.shifts if not row.meets_goal]
    goal = f"missed by {', '.join(missed)}" if missed else "met by all detectors"
    yield (
        f"Delays that shift by more than one sample with a step {steps.refinement} times as fine and the same noise: "
        f"{', '.join(parts)}. The goal, no such shift in {100 * GOAL_SHARE:g} % of the trials, is {goal}."
    )
    once = [row for row in steps.shifts if row.one_grid_only]
    if once:
        yield f"Found with one step only: {', '.join(f'{row.detector} {row.one_grid_only}' for row in once)}."
    errors = [f"{row.signal} {_milli(row, row.worst)}" for row in steps.errors]
    yield f"Largest error in {steps.trials} trials: {', '.join(errors)}; voltage_v is resolved to one ADC step."


def _shift_ms(seconds: float) -> str:
    return format_ms(seconds, "not found")


def _signed_ms(seconds: float) -> str:
    return format_ms(seconds, "unknown", "+.1f")


def _mn(newtons: float) -> str:
    return f"{1000 * newtons:.1f} mN" if math.isfinite(newtons) else "no slip"


def _milli(row: SignalError, value: float) -> str:
    unit = {"n": "mN", "v": "mV"}[row.signal.rpartition("_")[2]]
    return f"{1000 * value:.3f} {unit}"


def format_rate(result: DetectorResult) -> str:
    """Alarms per minute with their interval, such as ``0.02 (0.00-0.11)``."""
    low, high = result.alarm_interval
    return f"{result.alarms_per_minute:.2f} ({low:.2f}-{high:.2f})"


def pool_ranges(ranges: Sequence[DetectorResult]) -> tuple[int, float, float, float]:
    """Pool the alarms of all ranges: their number, the time [min], and the interval of the rate [1/min]."""
    alarms, minutes = sum(r.limited_alarms for r in ranges), sum(r.limited_minutes for r in ranges)
    low, high = poisson_interval(alarms)
    return (alarms, minutes, low / minutes, high / minutes) if minutes else (alarms, minutes, 0.0, math.inf)


def ranges_as_data(ranges: Sequence[DetectorResult]) -> dict[str, Any]:
    """Return the alarms of all ranges for JSON."""
    alarms, minutes, low, high = pool_ranges(ranges)
    return {
        "ranges": [{"alarms": r.limited_alarms, "minutes": round(r.limited_minutes, 3)} for r in ranges],
        "alarms": alarms,
        "minutes": round(minutes, 3),
        "alarms_per_minute_95": [round(low, 5), to_number(high)],
    }


def mix_as_data(mix: Mapping[str, MixSummary]) -> dict[str, Any]:
    """Return the wider mix for JSON; what a kind does not have is null."""
    return {
        kind: {
            "slips": summary.slides,
            "found_share": to_number(summary.found_share),
            "median_s": to_number(summary.delay_s(0.5)),
            "p90_s": to_number(summary.delay_s(0.9)),
            "worst_s": to_number(summary.worst_s),
            "p90_since_motion_s": to_number(summary.motion_delay_s(0.9)),
            "smallest_on_share": to_number(summary.on_share),
            "events": summary.events,
            "disturbed_share": to_number(summary.disturbed_share),
            "alarms": summary.alarms,
            "minutes": round(summary.minutes, 3),
        }
        for kind, summary in mix.items()
    }


def mix_table(ranges: Sequence[DetectorResult], mix: Mapping[str, MixSummary], detector: str) -> list[str]:
    """Format both tables as text."""
    alarms, minutes, low, high = pool_ranges(ranges)
    counts = ", ".join(f"{r.limited_alarms} in {r.limited_minutes:.1f} min" for r in ranges)
    lines = [
        "",
        f"alarms of {detector} over {len(ranges)} ranges of seeds: {counts};",
        f"together {alarms} in {minutes:.1f} min, with 95 % probability {low:.3f} to {high:.3f} per minute",
        "",
        f"{detector} on the wider mix; delays since gross slip, p90 also since motion; disturbed: events with alarm;",
        f"{ENCODER_NOTE}:",
        f"{'':26} {'found':>7} {'median':>9} {'p90':>9} {'worst':>9} {'p90 motion':>10} {'disturbed':>12} "
        f"{'alarms/min':>10}",
    ]
    for kind, summary in mix.items():
        found = f"{100 * summary.found_share:6.1f}%" if summary.slides else ""
        delays = (summary.delay_s(0.5), summary.delay_s(0.9), summary.worst_s, summary.motion_delay_s(0.9))
        cells = [format_ms(delay) if summary.slides else "" for delay in delays]
        events = f"{100 * summary.disturbed_share:.1f}% of {summary.events}" if summary.events else ""
        lines.append(
            f"{kind:26} {found:>7} {cells[0]:>9} {cells[1]:>9} {cells[2]:>9} {cells[3]:>10} {events:>12} "
            f"{summary.alarms_per_minute:10.2f}"
        )
    return lines
