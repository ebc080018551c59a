"""Tables and remarks of a validation on what its results depend on: assumptions, omitted effects, the time step."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from fingertip.lab.studies.sensitivity import (
    BOTH,
    ELASTO_PLASTIC,
    HELD_LONGER,
    PATCH_AVERAGE,
    STICK_SLIP,
    VariationResult,
)
from fingertip.lab.studies.step_sensitivity import GOAL_SHARE, SignalError, StepSensitivity
from fingertip.sim.contact.surfaces import SURFACES

LEVELS_ARE_ASSUMED = (
    "Levels of pink noise, hum, vibration of the hand and stick-slip are assumptions that nobody has verified."
)


def variations_as_data(variations: Sequence[VariationResult]) -> list[dict[str, Any]]:
    """Return the results of the variations for JSON; what is infinite or unknown is null."""
    return [
        {
            "variation": v.label,
            "realistic": v.is_realistic,
            "slips": v.slips,
            "found_share": round(v.found_share, 5),
            "median_s": _number(v.median_s),
            "change_s": _number(v.change_s),
            "alarms_per_minute": round(v.alarms_per_minute, 4),
            "onset_change_s": _number(v.onset_change_s),
            "vibration_n": _number(v.vibration_n),
        }
        for v in variations
    ]


def steps_as_data(steps: StepSensitivity) -> dict[str, Any]:
    """Return the effect of the time step for JSON; an infinite shift is null."""
    return {
        "trials": steps.trials,
        "refinement": steps.refinement,
        "goal_share": GOAL_SHARE,
        "delay_shifts": [
            {
                "detector": row.detector,
                "trials": row.trials,
                "beyond_sample": row.beyond_sample,
                "one_grid_only": row.one_grid_only,
                "median_s": _number(row.median_s),
                "p90_s": _number(row.p90_s),
                "worst_s": _number(row.worst_s),
                "meets_goal": row.meets_goal,
            }
            for row in steps.shifts
        ],
        "errors": [
            {"signal": row.signal, "median": _number(row.median), "p90": _number(row.p90), "worst": _number(row.worst)}
            for row in steps.errors
        ],
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
        f"{_ms(v.median_s):>10} {change:>10} {found:>14} {v.alarms_per_minute:10.2f} {onset:>10} "
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
    delay = f"with a median delay of {_ms(row.median_s)}"
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
    return f"{1000 * seconds:.1f} ms" if math.isfinite(seconds) else "not found"


def _ms(seconds: float) -> str:
    return f"{1000 * seconds:.1f} ms" if math.isfinite(seconds) else "missed"


def _signed_ms(seconds: float) -> str:
    return f"{1000 * seconds:+.1f} ms" if math.isfinite(seconds) else "unknown"


def _mn(newtons: float) -> str:
    return f"{1000 * newtons:.1f} mN" if math.isfinite(newtons) else "no slip"


def _milli(row: SignalError, value: float) -> str:
    unit = {"n": "mN", "v": "mV"}[row.signal.rpartition("_")[2]]
    return f"{1000 * value:.3f} {unit}"


def _number(value: float) -> float | None:
    return round(value, 7) if math.isfinite(value) else None
