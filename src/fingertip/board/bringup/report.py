"""Readings of a board against their limits, and the likely fault, as data and as text."""

from __future__ import annotations

import math
from typing import Any

from fingertip.board.bringup.common_ratio import Sources, find_sources
from fingertip.board.bringup.diagnosis import MIN_READINGS, Diagnosis, diagnose
from fingertip.board.bringup.idle_level import note_idle_level
from fingertip.board.bringup.plan import QUIET_ENVELOPE, SENSOR_OHM, SUPPLY_MA, BringUp
from fingertip.board.bringup.readings import Readings, unit_of

_HINTS = {
    "supply_ohm": "the supply is shorted: look for a bridge at the connector, the capacitors and the amplifiers",
    "negative_supply_ohm": "the negative supply is shorted: look for a bridge at the connector and the amplifiers",
    SENSOR_OHM: "the bridge is wrong: R10 to R13, C7 or the sensor's connector",
    SUPPLY_MA: "too much: an amplifier is rotated or bridged; too little: an amplifier is not soldered",
    "tp3_quiet_v": "hum or oscillation: shorten and twist the wires, and use a battery for the supply",
    "slip_tone_v": "turn RV1 until SLIP falls at the expected tone; if it does not reach it, check R19 to R21 and U4",
}
"""Meanings of the readings that are not part of the diagnosis."""
_NO_CURRENT = 0.1
"""Share of the least current up to which the board draws none."""


def assess_readings(plan: BringUp, readings: Readings, threshold_v: float | None = None) -> dict[str, Any]:
    """Compare readings with their limits and name the likely fault, as plain data.

    `threshold_v` is that of a detector of the envelope in software [V], if the board has no comparator.
    """
    limits = plan.all
    rows = [
        {
            "name": name,
            "unit": unit_of(name),
            "measured": value if math.isfinite(value) else None,
            # Beyond a lower limit alone, what a good board reads depends on the amplifiers and on the meter.
            "expected": _round(limits[name].expected_v) if math.isfinite(limits[name].high_v) else None,
            "limits": [_round(limits[name].low_v), _round(limits[name].high_v)],
            "passed": limits[name].low_v <= value <= limits[name].high_v,
        }
        for name, value in readings.values.items()
    ]
    levels = {name: value for name, value in readings.values.items() if name in plan.levels}
    diagnosis = diagnose(plan.board, plan.levels, levels, readings.tone_v)
    hints = [f"{row['name']}: {_explain_reading(row)}." for row in rows if row["name"] in _HINTS and not row["passed"]]
    if threshold_v is not None and QUIET_ENVELOPE in levels and not diagnosis.mistake:
        hints += note_idle_level(plan, levels[QUIET_ENVELOPE], threshold_v)
    sources = find_sources(plan.board, plan.levels, levels, readings.tone_v)
    return {
        "passed": all(row["passed"] for row in rows),
        "readings": rows,
        "missing": [name for name in limits if name not in readings.values],
        "hints": hints,
        "likely": [each.fault.sentence for each in diagnosis.likely if each.fault.reference],
        "mistake": diagnosis.mistake.sentence if diagnosis.mistake else None,
        "explained": diagnosis.is_explained,
        "verdict": _verdict(diagnosis, len(levels), rows, sources),
    }


def _explain_reading(row: dict[str, Any]) -> str:
    """Say what a reading that fails means."""
    if row["name"] == SUPPLY_MA and abs(row["measured"]) <= _NO_CURRENT * row["limits"][0]:
        return "no current: the supply is reversed or not connected, or the meter is not in series with it"
    return _HINTS[row["name"]]


def format_assessment(data: dict[str, Any]) -> str:
    """Format an assessment as text, the verdict first."""
    lines = [data["verdict"], *data["hints"], ""]
    lines.append(f"{'reading':20} {'measured':>10} {'expected':>10}   {'limits':24}")
    for row in data["readings"]:
        measured = "infinite" if row["measured"] is None else f"{row['measured']:.4g}"
        low, high = row["limits"]
        bounds = f"above {low:.4g}" if high is None else f"{low:.4g} to {high:.4g}"
        expected = _text(row["expected"], "-")
        mark = "" if row["passed"] else "  FAILS"
        lines.append(f"{row['name']:20} {measured:>10} {expected:>10}   {bounds:24}{row['unit']:4}{mark}")
    if data["missing"]:
        lines.append(f"not measured: {', '.join(data['missing'])}")
    return "\n".join(lines)


def _verdict(diagnosis: Diagnosis, count: int, rows: list[dict[str, Any]], sources: Sources) -> str:
    """Say what is likely: what feeds the board where all readings are off by one ratio, mistakes, and faults."""
    failed = [row["name"] for row in rows if not row["passed"]]
    if not failed:
        return "All readings are within their limits."
    if not diagnosis.failed and not count:
        return f"Readings fail: {', '.join(failed)}. No voltage was entered."
    if not diagnosis.failed:
        return "The voltages entered are within their limits; see the readings that fail."
    likely, said = _name_likely(diagnosis, count), "; and ".join(sources.sentences)
    if not said:
        return likely
    if not sources.explain_all:
        return f"First, {said}. Beside that: {likely}"
    return f"No part need be faulty: {said}." + (f" Or: {likely}" if diagnosis.is_explained else "")


def _name_likely(diagnosis: Diagnosis, count: int) -> str:
    """Name the likely faults, or the mistake of the measurement."""
    names = [each.fault.sentence for each in diagnosis.likely if each.fault.reference]
    again = f"measure {', '.join(diagnosis.failed)} again"
    if not diagnosis.likely and count >= MIN_READINGS:
        return f"No single fault explains this; {again}."
    if not diagnosis.likely:
        needed = f"take at least {MIN_READINGS} voltages for a diagnosis ({count} so far)"
        return f"Readings fail: {', '.join(diagnosis.failed)}; {needed}."
    if not (mistake := diagnosis.mistake):
        return _name_faults(names, diagnosis.is_explained, again)
    said = f"Likely a mistake of the measurement{'' if names else ', and no fault'}: {mistake.sentence}."
    if names:
        said += f" Together with it: {_name_faults(names, diagnosis.is_explained, again)}"
    return f"{said} To be sure, {mistake.remedy}."


def _name_faults(names: list[str], is_explained: bool, again: str) -> str:
    if not is_explained:
        return f"No single fault explains all readings. Nearest: {names[0]}. Look for two faults, or {again}."
    if len(names) == 1:
        return f"Likely fault: {names[0]}."
    return (
        f"Likely fault, one of these, which the readings do not tell apart, the more common first: {'; '.join(names)}."
    )


def _round(value: float) -> float | None:
    """Round to five significant digits; None for infinity."""
    return float(f"{value:.5g}") if math.isfinite(value) else None


def _text(value: float | None, missing: str) -> str:
    return missing if value is None else f"{value:.4g}"
