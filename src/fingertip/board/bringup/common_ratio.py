"""Readings that are all off by one ratio: what feeds the board differs from what the sheet assumes, and no part does.

Constant voltages are proportional to the supply, and readings with the tone to the tone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from fingertip.board.bringup.limits import SUPPLY_PERCENT, Limits
from fingertip.board.bringup.prediction import Board, is_tone, name_tone
from fingertip.board.circuits.signal_paths import RECT_OUT
from fingertip.board.nets import VCC

_MIN_READINGS = 3
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
    """True if they explain every reading that fails."""


def find_sources(board: Board, limits: Mapping[str, Limits], readings: Mapping[str, float], tone_v: float) -> Sources:
    """Find the supply and the tone that explain the readings which fail, if those of each are off by one ratio.

    `tone_v` is the tone's RMS for which the limits hold [V]. A tone is named only if nothing else is wrong: a fault may
    weaken all readings with it too.
    """
    failed = [name for name, volts in readings.items() if not limits[name].low_v <= volts <= limits[name].high_v]
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
    if len(large) < _MIN_READINGS:
        return None
    # A reading counts the more, the narrower its limits are.
    weights = {n: (limits[n].expected_v / (limits[n].high_v - limits[n].low_v)) ** 2 for n in large}
    ratio = sum(weights[n] * readings[n] / limits[n].expected_v for n in large) / sum(weights.values())
    failed = any(not limits[n].low_v <= readings[n] <= limits[n].high_v for n in names)
    if not failed or not 0.0 <= ratio <= _MOST:
        return None
    return ratio if all(_fits(readings[n], ratio, limits[n]) for n in names) else None


def _fits(volts: float, ratio: float, limits: Limits) -> bool:
    """Return whether a reading lies where the ratio moves its limits, which keep the meter's constant error."""
    below, above = limits.expected_v - limits.low_v, limits.high_v - limits.expected_v
    width = max(ratio, 0.1) if abs(limits.expected_v) >= _LEAST_V else 1.0
    expected_v = ratio * limits.expected_v
    return expected_v - width * below <= volts <= expected_v + width * above
