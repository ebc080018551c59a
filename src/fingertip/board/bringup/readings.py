"""File of a board's readings: its template, and its reading with all faults reported at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.board.bringup.bench import TONE_V, Fault
from fingertip.board.bringup.diagnosis import MIN_READINGS, Diagnosis, diagnose
from fingertip.board.bringup.follow_up import TOP_OHM, limit_resistances, name_resistance
from fingertip.board.bringup.plan import QUIET, SENSOR_OHM, SUPPLY_MA, SUPPLY_PERCENT, BringUp, Limits, find_failed
from fingertip.board.bringup.prediction import Board, is_tone, name_tone
from fingertip.board.parts.nets import RECT_OUT, VCC
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import BoardError, Issue, join_words
from fingertip.foundation.files import format_figure
from fingertip.foundation.tables import read_toml

IDENTITY, TONE = "board", "tone_v"
UNITS = {"_v": "V", "_ohm": "ohm", "_ma": "mA"}
MAX_TONE_RATIO = 2.0
"""Largest ratio of the tone to the planned one, either way: more clips, less drowns in the meter's error."""

_SUPPLY_RATIO = 1.1
"""Largest voltage that is accepted as a reading, in units of the supply."""


@dataclass(frozen=True)
class Readings:
    tone_v: float
    """RMS of the generator's tone [V]."""
    values: Mapping[str, float]
    """Readings by name, each in the unit that its name ends in. What was not measured is left out."""


def unit_of(name: str) -> str:
    return next(unit for end, unit in UNITS.items() if name.endswith(end))


def readings_template(plan: BringUp, name: str) -> str:
    """Write the file of readings, each still without a value."""
    lines = (format_entry(key, limits) for key, limits in plan.all.items())
    return "\n".join((*list_head(plan, name), "", *lines)) + "\n"


def list_head(plan: BringUp, name: str) -> list[str]:
    return [
        f"# Readings of a board of {name}, as bringup.md describes them. Save this file under another name.",
        "# Write each reading in place of nan. What you did not measure stays nan.",
        "",
        f'{IDENTITY} = "{plan.identity}"  # do not change: it names the board that these readings belong to',
        f"{TONE} = {TONE_V}  # V RMS of the tone, measured at the generator while it is connected",
    ]


def format_entry(key: str, limits: Limits) -> str:
    expected = f"expected {round(float(f'{limits.expected_v:.4g}'), 4) + 0.0:.4g}"
    if math.isinf(limits.high_v):
        expected = f"above {limits.low_v:.0f}"
    return f"{key} = nan  # {unit_of(key)}, {expected}"


def read_readings(path: Path, plan: BringUp) -> Readings:
    """Read a file of readings. Raises TomlFileError or BoardError."""
    tables = read_toml(path)
    if issues := list(find_reading_issues(tables, plan, path)):
        raise BoardError(issues)
    return select_readings(tables, plan)


def select_readings(tables: Mapping[str, Any], plan: BringUp) -> Readings:
    return Readings(float(tables.get(TONE, TONE_V)), take_values(tables, plan))


def take_values(tables: Mapping[str, Any], plan: BringUp) -> dict[str, float]:
    """Take what was measured, by the reading's name; what is no number is an issue of its own."""
    known = plan.all.keys() | limit_resistances(plan.board.circuit).keys()
    return {n: float(v) for n, v in tables.items() if n in known and isinstance(v, int | float) and not math.isnan(v)}


def find_reading_issues(
    tables: Mapping[str, Any], plan: BringUp, path: Path, *, needs_reading: bool = True
) -> Iterator[Issue]:
    names = plan.all | limit_resistances(plan.board.circuit)
    if IDENTITY not in tables:
        remedy = "`fingertip board DESIGN --bringup` writes a file to fill in, with the line that names the board"
        yield Issue(f"{path}, {IDENTITY}", f"is missing; {remedy}.")
    for name, value in tables.items():
        if name == IDENTITY:
            if value != plan.identity:
                remedy = "give the design, and the --set, from which the board was made"
                yield Issue(IDENTITY, f"{value!r} is another board than this design's, {plan.identity!r}; {remedy}.")
        elif name != TONE and name not in names:
            yield Issue(name, f"is no reading of this board; {suggest_name(name, [TONE, *names])}")
        elif isinstance(value, bool) or not isinstance(value, int | float):
            yield Issue(name, f"{value!r} is no number; write the reading in {unit_of(name)}, or nan.")
        elif name == TONE and not TONE_V / MAX_TONE_RATIO <= value <= TONE_V * MAX_TONE_RATIO:
            low, high = TONE_V / MAX_TONE_RATIO, TONE_V * MAX_TONE_RATIO
            yield Issue(name, f"{value:g} V is no tone for this test; measure again with {low:g} to {high:g} V RMS.")
        elif name in {*plan.levels, QUIET} and abs(value) > (bound := _SUPPLY_RATIO * plan.board.rails_v[VCC]):
            volts = value / 1e3
            remedy = f"write {volts:g} if the meter showed mV" if abs(volts) <= bound else "measure again, or write nan"
            yield Issue(
                name,
                f"{value:g} V cannot be: no voltage of this board exceeds {plan.board.rails_v[VCC]:g} V; {remedy}.",
            )
        elif math.isinf(value) and not name.endswith("_ohm"):
            yield Issue(name, f"{value} {unit_of(name)} is no reading; write a number, or nan.")
    if needs_reading and not take_values(tables, plan):
        yield Issue(str(path), "holds no reading; write at least one in place of nan.")


# Readings that are all off by one ratio: what feeds the board differs from what the sheet assumes, and no part does.
#
# Constant voltages are proportional to the supply, and readings with the tone to the tone.

_LEAST_V = 0.05
"""Least expected voltage from which a ratio is computed; a smaller one is an offset."""
_MOST = 4.0
_DEAD = 0.02
"""Ratio below which there is no supply, or no tone."""
_LEAST_TONE_CHANGE = 0.1
"""Least deviation of the tone's ratio from 1 that is named: the meter for alternating voltage has some percent."""


@dataclass(frozen=True)
class Sources:
    """Supply and tone that explain readings which fail."""

    sentences: tuple[str, ...] = ()
    """Sentences on them, each without a full stop."""
    explain_all: bool = False


def find_sources(board: Board, limits: Mapping[str, Limits], readings: Mapping[str, float], tone_v: float) -> Sources:
    """Find the supply and the tone that explain the readings which fail, if those of each are off by one ratio.

    `tone_v` is the tone's RMS for which the limits hold [V]. A tone is named only if nothing else is wrong: a fault may
    weaken all readings with it too.
    """
    failed = find_failed(limits, readings)
    supply = _describe_supply(board, limits, readings)
    tone = _describe_tone(board, limits, readings, tone_v)
    explained = {name for name in failed if (tone if is_tone(name) else supply)}
    if explained == {*failed}:
        return Sources(tuple(each for each in (supply, tone) if each), bool(failed))
    return Sources((supply,) if supply else ())


def _describe_supply(board: Board, limits: Mapping[str, Limits], readings: Mapping[str, float]) -> str | None:
    """Describe the supply that explains all constant voltages; None if they are not off by one ratio."""
    ratio = _find_ratio([name for name in readings if not is_tone(name)], limits, readings)
    nominal_v = board.rails_v[VCC]
    if ratio is None or abs(ratio - 1.0) <= 0.01 * SUPPLY_PERCENT:
        return None
    if ratio < _DEAD:
        return "no direct voltage is there: check that the supply is on and not reversed"
    return (
        f"all direct voltages are {ratio:.3g} of those expected: check the supply, which would be "
        f"{ratio * nominal_v:.2f} V and has to be {nominal_v:g} V within {SUPPLY_PERCENT:g} %"
    )


def _describe_tone(
    board: Board, limits: Mapping[str, Limits], readings: Mapping[str, float], tone_v: float
) -> str | None:
    """Describe the tone that explains all readings with it; None if they are not off by one ratio."""
    # The rectifier's output holds the drops of its diodes, which do not follow the tone.
    drops = name_tone(RECT_OUT, board.bench.tones_hz[-1])
    ratio = _find_ratio([name for name in readings if is_tone(name) and name != drops], limits, readings)
    if ratio is None or abs(ratio - 1.0) < _LEAST_TONE_CHANGE:
        return None
    if ratio < _DEAD:
        return "nothing of the tone is there: check the generator and its wires"
    return (
        f"all readings with the tone are {ratio:.2g} of those expected: the tone would be {ratio * tone_v:.2g} V RMS; "
        f"check that tone_v = {tone_v:g} is what the generator gave"
    )


def _find_ratio(names: Iterable[str], limits: Mapping[str, Limits], readings: Mapping[str, float]) -> float | None:
    """Find the ratio that these readings have to those expected, if they have one, and if any is beyond its limits."""
    names = list(names)
    large = [n for n in names if abs(limits[n].expected_v) >= _LEAST_V]
    if len(large) < MIN_READINGS:
        return None
    # A reading counts the more, the narrower its limits are.
    weights = {n: (limits[n].expected_v / (limits[n].high_v - limits[n].low_v)) ** 2 for n in large}
    ratio = sum(weights[n] * readings[n] / limits[n].expected_v for n in large) / sum(weights.values())
    if all(limits[n].allow(readings[n]) for n in names) or not 0.0 <= ratio <= _MOST:
        return None
    for n in names:
        # The ratio moves the limits of a reading, which keep the meter's constant error.
        below, above = limits[n].expected_v - limits[n].low_v, limits[n].high_v - limits[n].expected_v
        width = max(ratio, 0.1) if abs(limits[n].expected_v) >= _LEAST_V else 1.0
        expected_v = ratio * limits[n].expected_v
        if not expected_v - width * below <= readings[n] <= expected_v + width * above:
            return None
    return ratio


# Readings of a board against their limits, and the likely fault, as data and as text.

_HINTS = {
    "supply_ohm": "the supply is shorted: look for a bridge at the connector, the capacitors and the amplifiers",
    "negative_supply_ohm": "the negative supply is shorted: look for a bridge at the connector and the amplifiers",
    SENSOR_OHM: "the front end is wrong: its resistors, the capacitors beside them, or the sensor's connector",
    SUPPLY_MA: "too much: an amplifier is rotated or bridged; too little: an amplifier is not soldered",
    "tp3_quiet_v": "hum or oscillation: shorten and twist the wires, or use a battery behind a regulator",
    "slip_tone_v": "turn RV1 until SLIP falls at the expected tone; if it does not reach it, check R19 to R21 and U4",
}
"""Meanings of the readings that are not part of the diagnosis."""
_NO_CURRENT = 0.1
"""Share of the least current up to which the board draws none."""


def assess_readings(
    plan: BringUp, readings: Readings, is_possible: Callable[[Fault], bool] = lambda fault: True
) -> dict[str, Any]:
    """Compare readings with their limits and name the likely fault among the possible ones, as plain data."""
    across = limit_resistances(plan.board.circuit)
    limits = plan.all | across
    rows = [
        {
            "name": name,
            "unit": unit_of(name),
            "measured": value if math.isfinite(value) else None,
            # Beyond a lower limit alone, what a good board reads depends on the amplifiers and on the meter.
            "expected": _round(limits[name].expected_v) if math.isfinite(limits[name].high_v) else None,
            "limits": [_round(limits[name].low_v), _round(limits[name].high_v)],
            "passed": limits[name].allow(value),
        }
        for name, value in readings.values.items()
    ]
    levels = {name: value for name, value in readings.values.items() if name in plan.levels}
    ohms = {name: min(value, TOP_OHM) for name, value in readings.values.items() if name in across}
    diagnosis = diagnose(plan.board, {**plan.levels, **across}, {**levels, **ohms}, readings.tone_v, is_possible)
    hints = [f"{row['name']}: {_explain_reading(row)}." for row in rows if row["name"] in _HINTS and not row["passed"]]
    sources = find_sources(plan.board, plan.levels, levels, readings.tone_v)
    return {
        "passed": all(row["passed"] for row in rows),
        "readings": rows,
        "missing": [name for name in plan.all if name not in readings.values],
        "hints": hints,
        "likely": [each.fault.sentence for each in diagnosis.likely if each.fault.reference],
        "mistake": diagnosis.mistake.sentence if diagnosis.mistake else None,
        "explained": diagnosis.is_explained,
        "measure_next": [name_resistance(name) for name in diagnosis.follow_up],
        "verdict": _verdict(diagnosis, len(levels), rows, sources)
        + ("" if sources.explain_all else _ask(diagnosis, across)),
    }


def _ask(diagnosis: Diagnosis, across: Mapping[str, Limits]) -> str:
    """Ask for the readings that tell the likely faults apart; empty if there are none."""
    if not diagnosis.follow_up:
        return ""
    good = {name: across[name_resistance(name)].expected_v for name in diagnosis.follow_up}
    asked = join_words([f"{name} ({format_figure(ohm)} ohm on a good board)" for name, ohm in good.items()])
    lines = join_words([f"{name_resistance(name)} = ..." for name in good])
    purpose = "tell them apart" if len(diagnosis.likely) > 1 else "be sure"
    return (
        f" To {purpose}, without power and with nothing plugged in, measure the resistance across {asked}, in "
        f"place; add {lines} to the file, inf where the meter shows an open circuit, and run this again."
    )


def _explain_reading(row: dict[str, Any]) -> str:
    if row["name"] == SUPPLY_MA and abs(row["measured"]) <= _NO_CURRENT * row["limits"][0]:
        return "no current: the supply is reversed or not connected, or the meter is not in series with it"
    return _HINTS[row["name"]]


def format_assessment(data: dict[str, Any]) -> str:
    lines = [data["verdict"], *data["hints"], ""]
    lines.append(f"{'reading':20} {'measured':>10} {'expected':>10}   {'limits':24}")
    for row in data["readings"]:
        measured = "infinite" if row["measured"] is None else f"{row['measured']:.4g}"
        low, high = row["limits"]
        bounds = f"above {low:.4g}" if high is None else f"{low:.4g} to {high:.4g}"
        expected = "-" if row["expected"] is None else f"{row['expected']:.4g}"
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
