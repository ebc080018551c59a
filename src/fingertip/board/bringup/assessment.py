"""Assessment of a board's readings against their limits: what feeds the board, and the likely fault.

A fault of a part that several fingers share shows at all of them, and one of a finger's own part at no other. So a
finger whose readings pass clears the shared parts, and where all fail alike the shared parts alone are suspected.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from fingertip.board.bringup.bench import HOST, Fault
from fingertip.board.bringup.diagnosis import MIN_READINGS, Diagnosis, diagnose
from fingertip.board.bringup.plan import SUPPLY_MA, SUPPLY_PERCENT, BringUp
from fingertip.board.bringup.prediction import Board, Limits, find_failed, is_tone, name_tone
from fingertip.board.bringup.readings import COMMON_READINGS, WHOLE_BOARD, Readings, unit_of
from fingertip.board.bringup.resistances import SENSOR_OHM, TOP_OHM, limit_resistances, name_resistance
from fingertip.board.circuits.channels import SHARED_PARTS, name_part
from fingertip.board.parts.nets import RECT_OUT, VCC
from fingertip.foundation.errors import join_words
from fingertip.foundation.files import format_figure

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


@dataclass(frozen=True)
class AssessedReading:
    name: str
    unit: str
    measured: float | None
    """None for infinity."""
    expected: float | None
    """Reading of a good board; None where that depends on the amplifiers and on the meter."""
    limits: tuple[float | None, float | None]
    passed: bool


@dataclass(frozen=True)
class Assessment:
    """Readings of one finger's circuit with their limits, and what explains those that fail."""

    passed: bool
    readings: tuple[AssessedReading, ...]
    missing: tuple[str, ...]
    hints: tuple[str, ...]
    likely: tuple[str, ...]
    """Faults that explain the readings best, the more common first."""
    mistake: str | None
    explained: bool
    measure_next: tuple[str, ...]
    verdict: str

    def as_text(self) -> str:
        """Text for people, the verdict first."""
        lines = [self.verdict, *self.hints, ""]
        lines.append(f"{'reading':20} {'measured':>10} {'expected':>10}   {'limits':24}")
        for row in self.readings:
            measured = "infinite" if row.measured is None else f"{row.measured:.4g}"
            low, high = row.limits
            bounds = f"above {low:.4g}" if high is None else f"{low:.4g} to {high:.4g}"
            expected = "-" if row.expected is None else f"{row.expected:.4g}"
            mark = "" if row.passed else "  FAILS"
            lines.append(f"{row.name:20} {measured:>10} {expected:>10}   {bounds:24}{row.unit:4}{mark}")
        if self.missing:
            lines.append(f"not measured: {', '.join(self.missing)}")
        return "\n".join(lines)


def assess_readings(
    plan: BringUp, readings: Readings, is_possible: Callable[[Fault], bool] = lambda fault: True
) -> Assessment:
    """Compare readings with their limits and name the likely fault among the possible ones."""
    across = limit_resistances(plan.board.circuit)
    limits = plan.all | across
    rows = tuple(_assess_reading(name, value, limits[name]) for name, value in readings.values.items())
    levels = {name: value for name, value in readings.values.items() if name in plan.levels}
    ohms = {name: min(value, TOP_OHM) for name, value in readings.values.items() if name in across}
    diagnosis = diagnose(plan.board, {**plan.levels, **across}, {**levels, **ohms}, readings.tone_v, is_possible)
    sources = find_sources(plan.board, plan.levels, levels, readings.tone_v)
    question = "" if sources.explain_all else _ask(diagnosis, across)
    return Assessment(
        passed=all(row.passed for row in rows),
        readings=rows,
        missing=tuple(name for name in plan.all if name not in readings.values),
        hints=tuple(f"{row.name}: {_explain(row)}." for row in rows if row.name in _HINTS and not row.passed),
        likely=tuple(each.fault.sentence for each in diagnosis.likely if each.fault.reference),
        mistake=diagnosis.mistake.sentence if diagnosis.mistake else None,
        explained=diagnosis.is_explained,
        measure_next=tuple(map(name_resistance, diagnosis.follow_up)),
        verdict=_verdict(diagnosis, len(levels), [row.name for row in rows if not row.passed], sources) + question,
    )


def _assess_reading(name: str, value: float, limits: Limits) -> AssessedReading:
    # Beyond a lower limit alone, what a good board reads depends on the amplifiers and on the meter.
    expected = _round(limits.expected_v) if math.isfinite(limits.high_v) else None
    measured = value if math.isfinite(value) else None
    ends = _round(limits.low_v), _round(limits.high_v)
    return AssessedReading(name, unit_of(name), measured, expected, ends, limits.allow(value))


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


def _explain(row: AssessedReading) -> str:
    low = row.limits[0]
    if row.name == SUPPLY_MA and row.measured is not None and low and abs(row.measured) <= _NO_CURRENT * low:
        return "no current: the supply is reversed or not connected, or the meter is not in series with it"
    return _HINTS[row.name]


def _verdict(diagnosis: Diagnosis, count: int, failed: Sequence[str], sources: Sources) -> str:
    """Say what is likely: what feeds the board where all readings are off by one ratio, mistakes, and faults."""
    if not failed:
        return "All readings are within their limits."
    if not diagnosis.failed and not count:
        return f"Readings fail: {', '.join(failed)}. No voltage was entered."
    if not diagnosis.failed:
        return "The voltages entered are within their limits; see the readings that fail."
    likely, fed = _name_likely(diagnosis, count), "; and ".join(sources.sentences)
    if not fed:
        return likely
    if not sources.explain_all:
        return f"First, {fed}. Beside that: {likely}"
    return f"No part need be faulty: {fed}." + (f" Or: {likely}" if diagnosis.is_explained else "")


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
    text = f"Likely a mistake of the measurement{'' if names else ', and no fault'}: {mistake.sentence}."
    if names:
        text += f" Together with it: {_name_faults(names, diagnosis.is_explained, again)}"
    return f"{text} To be sure, {mistake.remedy}."


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


# Readings of several fingers, and what they tell together.


@dataclass(frozen=True)
class FingersAssessment:
    passed: bool
    verdict: str
    fingers: Mapping[str, Assessment]
    """Assessment of each finger that was measured, and of what is read once for all."""

    def as_text(self) -> str:
        """Text for people, the verdict first."""
        parts = [f"{finger}: {each.as_text()}" for finger, each in self.fingers.items()]
        return "\n\n".join((self.verdict, *parts))


def assess_fingers(plan: BringUp, measured: Mapping[str, Readings], fingers: Sequence[str]) -> FingersAssessment:
    """Compare the readings of all fingers with their limits and name the likely faults."""
    levels = {
        finger: {name: v for name, v in taken.values.items() if name in plan.levels}
        for finger, taken in measured.items()
    }
    failed_at = {finger: set(find_failed(plan.levels, taken)) for finger, taken in levels.items()}
    failing = [finger for finger, names in failed_at.items() if names]
    # A finger clears the shared parts of what fails elsewhere if it passes in the same readings.
    cleared = {
        finger
        for finger in failing
        if any(failed_at[finger] <= levels[other].keys() and not failed_at[other] for other in levels)
    }
    found = {}
    for finger, taken in measured.items():
        found[finger] = assess_readings(plan, taken, _has_own_parts if finger in cleared else lambda fault: True)
    names = [{sentence.split(" ")[0] for sentence in found[finger].likely} for finger in failing]
    if not cleared and len(failing) > 1 and not any(map(SHARED_PARTS.isdisjoint, names)):
        found |= {finger: assess_readings(plan, measured[finger], _has_shared_parts) for finger in failing}
    named = {WHOLE_BOARD: found[WHOLE_BOARD]} if WHOLE_BOARD in found else {}
    named |= {finger: _rename(found[finger], k) for k, finger in enumerate(fingers, start=1) if finger in found}
    for finger, each in named.items():
        missing = (name for name in each.missing if (name in COMMON_READINGS) == (finger == WHOLE_BOARD))
        named[finger] = replace(each, missing=tuple(missing))
    failed = [finger for finger, each in named.items() if not each.passed]
    verdict = (
        f"{', '.join(failed)}: readings fail." if failed else f"All readings of {', '.join(named)} are within limits."
    )
    return FingersAssessment(not failed, verdict, named)


def _has_shared_parts(fault: Fault) -> bool:
    return SHARED_PARTS.issuperset(fault.reference.split(" and "))


def _has_own_parts(fault: Fault) -> bool:
    return SHARED_PARTS.isdisjoint(fault.reference.split(" and "))


_PART = re.compile(r"\b(?:RV|TP|[CDJQRU])\d{1,2}(?=[ab]?\b)")


def _rename(assessment: Assessment, channel: int) -> Assessment:
    """Name the parts in sentences as the board of several fingers does."""

    def rename(sentence: str) -> str:
        return _PART.sub(
            lambda match: match[0] if match[0] in (*SHARED_PARTS, HOST) else name_part(match[0], channel), sentence
        )

    return replace(
        assessment,
        hints=tuple(map(rename, assessment.hints)),
        likely=tuple(map(rename, assessment.likely)),
        mistake=assessment.mistake and rename(assessment.mistake),
        verdict=rename(assessment.verdict),
    )
