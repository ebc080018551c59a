"""Diagnosis of a board: which single fault explains the readings best, or which mistake of the person with the meter.

Every fault is simulated, and its readings are compared with those that were taken, each difference in units of what
good boards and meters differ by. Faults that explain the readings alike cannot be told apart and are all named. A
mistake is named ahead of all faults if it explains the readings better than any of them does alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from fingertip.board.bringup import resistances
from fingertip.board.bringup.bench import HOST, Fault, list_exchanges, list_faults
from fingertip.board.bringup.plan import METER_AC, BringUp
from fingertip.board.bringup.prediction import POINTS, Board, Limits, find_failed, is_tone, name_voltage, predict
from fingertip.board.circuits.network import build_network
from fingertip.board.components.front_end import AMPLIFIERS
from fingertip.board.parts.nets import ENVELOPE, RECT_OUT, STAGE1_OUT, VMID
from fingertip.foundation.errors import join_words

# Mistakes of the person with the meter: readings that were taken between other points than the sheet says.
#
# A board whose signal ground is half of the supply has two grounds. With the black probe at the wrong one, every
# direct voltage is off by the same amount, and each looks like a fault of another part. Alternating voltages are the
# same at both grounds.


Voltages = Mapping[str, float]
_GROUND = name_voltage(VMID)


@dataclass(frozen=True)
class Mistake:
    sentence: str
    remedy: str
    apply: Callable[[Voltages], Voltages]
    """Readings that result [V], from those that the sheet asks for."""


def list_mistakes(board: Board) -> tuple[Mistake, ...]:
    """List the mistakes that are possible with the grounds of a board; none where both are one net."""
    return _TWO_GROUNDS if board.signal_ground == VMID else ()


def is_direct(name: str) -> bool:
    """Return whether a reading is a direct voltage: any without the tone, and the envelope and rectifier with it."""
    if not name.endswith("_v"):
        return False
    return not is_tone(name) or name.startswith(tuple(f"{POINTS[net].lower()}_" for net in (ENVELOPE, RECT_OUT)))


def _exchange_ground(values: Voltages, *, at_host: bool) -> Voltages:
    """Take the direct voltages at the host's connector against signal ground, or all others against supply ground."""
    moved = {name for name in values if is_direct(name) and name.startswith(f"{HOST.lower()}_") == at_host} - {_GROUND}
    shift_v = -values[_GROUND] if at_host else values[_GROUND]
    return {name: v + shift_v if name in moved else v for name, v in values.items()}


_TWO_GROUNDS = (
    Mistake(
        "the direct voltages were taken with the black probe at supply ground (GND) instead of signal ground (TP5)",
        f"move the black probe to TP5, for all but {_GROUND} and those at {HOST}, and measure again",
        lambda values: _exchange_ground(values, at_host=False),
    ),
    Mistake(
        f"the direct voltages at {HOST} were taken with the black probe at signal ground (TP5)",
        "move the black probe to supply ground (GND) for them, and measure again",
        lambda values: _exchange_ground(values, at_host=True),
    ),
    Mistake(
        f"{_GROUND} was taken with the black probe at TP5 and the red one at supply ground (GND)",
        "exchange the probes for it, and measure again",
        lambda values: {**values, _GROUND: -values[_GROUND]},
    ),
    Mistake(
        f"{_GROUND} was taken with both probes at signal ground (TP5)",
        "move the black probe to supply ground (GND) for it, and measure again",
        lambda values: {**values, _GROUND: 0.0},
    ),
)

MIN_READINGS = 3
_MODEL_RATIO = 0.03
"""Error of a predicted reading beyond that of a good board, as a ratio of it."""
_LEAKING = 0.04
"""Share of a good board's tone that an output at the end of its swing may still pass."""
_ALIKE = 4.0
"""Difference of two faults' misfits below which they cannot be told apart."""
_CLOSE = 40.0
"""Difference of two faults' misfits below which a further reading is worth its while: errors of the prediction may
exchange them."""
_FAR = 15.0
"""Difference of misfits beyond which a mistake together with one of some hundred faults is more than a coincidence."""
_EXPLAINED = 6.0
"""Mean squared difference per reading up to which a fault explains the readings."""
_CLOSER = 0.5
"""Largest share of a failing reading's difference that is left by a fault which explains it."""
_MOST = 6
_AMPLIFIED = 10.0
"""Gain for direct voltage from which the first stage's own offset shows."""


@dataclass(frozen=True)
class Explanation:
    """Fault, or mistake of the person with the meter, with how well it explains the readings."""

    fault: Fault
    """Fault of the board; one without a reference where a mistake alone explains the readings."""
    misfit: float
    """Mean squared difference per reading, in units of the expected spread."""
    mistake: Mistake | None = None


@dataclass(frozen=True)
class Diagnosis:
    failed: tuple[str, ...]
    likely: tuple[Explanation, ...]
    """Nearest explanations, which cannot be told apart and have the same mistake; empty if no reading failed, or if no
    fault explains any that did."""
    follow_up: tuple[str, ...] = ()
    """Resistors to measure in place, without power, which would tell them apart."""

    @property
    def is_explained(self) -> bool:
        """Return whether a single fault or mistake explains all readings."""
        return any(each.misfit <= _EXPLAINED for each in self.likely)

    @property
    def mistake(self) -> Mistake | None:
        """Mistake that explains the readings best, if one does."""
        return next((each.mistake for each in self.likely if each.mistake), None)


def diagnose(
    board: Board,
    limits: Mapping[str, Limits],
    readings: Mapping[str, float],
    tone_v: float,
    is_possible: Callable[[Fault], bool] = lambda fault: True,
) -> Diagnosis:
    """Compare readings [V, or ohm across parts] with their limits and, if any fails, find faults that explain them."""
    failed = tuple(find_failed(limits, readings))
    if not failed or len(readings) < MIN_READINGS:
        return Diagnosis(failed, ())
    singles, exchanges = list_faults(board.circuit, board.ends_v), list_exchanges(board.circuit)
    faults = [Fault("", "", board.circuit), *filter(is_possible, singles), *filter(is_possible, exchanges)]
    predicted = []
    measurable = {resistances.name_resistance(name): name for name in resistances.list_measurable(board.circuit)}
    across = {reading: name for reading, name in measurable.items() if reading in readings}
    for fault, values in zip(faults, predict(board, faults, tone_v), strict=True):
        ohms = {reading: resistances.predict_resistance(fault.circuit, name) for reading, name in across.items()}
        predicted.append((fault, fit_offset(board, fault, values, readings) | ohms))
    likely = explain(predicted, limits, readings, list_mistakes(board))
    named = likely[0].fault.reference.split(" and ") if likely else []
    is_measured = {resistances.name_resistance(name) for name in named} <= readings.keys()
    if not likely or likely[0].mistake or (len(likely) == 1 and is_measured):
        return Diagnosis(failed, likely)
    # Where the best explanation is poor, errors of the prediction are larger.
    margin = max(_CLOSE / len(readings), likely[0].misfit)
    alone = find_alone(predicted, limits, readings)
    near = [each.fault.circuit for each in alone if each.misfit - likely[0].misfit < margin]
    return Diagnosis(failed, likely, resistances.choose_follow_up(board.circuit, near, readings, named))


def fit_offset(board: Board, fault: Fault, values: dict[str, float], readings: Mapping[str, float]) -> dict[str, float]:
    """Readings of a fault with the offset of U1 that explains the first stage best.

    A bridged capacitor may let the first stage amplify its own offset, which a board without a fault does not. The
    offset is not known, only its maximum.
    """
    name = name_voltage(STAGE1_OUT)
    if fault.rarity != 1 or not fault.reference.startswith("C") or name not in readings:
        return values
    network = build_network(fault.circuit, board.gain_bandwidth_hz).restrict(STAGE1_OUT)
    gain = abs(network.constant_transfers(STAGE1_OUT)[STAGE1_OUT])
    if gain < _AMPLIFIED:
        return values
    span_v = gain * AMPLIFIERS[board.circuit.component("U1").symbol.name].max_offset_v
    low_v, high_v = values[name] - span_v, values[name] + span_v
    return {**values, name: min(max(readings[name], low_v), high_v)}


def find_alone(
    predicted: Iterable[tuple[Fault, Mapping[str, float]]], limits: Mapping[str, Limits], readings: Mapping[str, float]
) -> list[Explanation]:
    """Find the faults that explain any failing reading, and all readings better than no fault does."""
    expected = {name: limits[name].expected_v for name in readings}
    no_fault = _misfit(expected, readings, limits)
    # The largest difference that a fault which explains a failing reading may leave of it.
    largest = {
        name: _CLOSER * abs(_difference(name, expected[name], readings[name], limits))
        for name in find_failed(limits, readings)
    }

    # A fault that explains none of the failing readings, or all of them worse than no fault, is no explanation.
    return [
        Explanation(fault, misfit)
        for fault, values in predicted
        if fault.reference
        if any(abs(_difference(n, values[n], readings[n], limits)) <= most for n, most in largest.items())
        if (misfit := _misfit(values, readings, limits)) < no_fault
    ]


def explain(
    predicted: Iterable[tuple[Fault, Mapping[str, float]]],
    limits: Mapping[str, Limits],
    readings: Mapping[str, float],
    mistakes: Iterable[Mistake] = (),
) -> tuple[Explanation, ...]:
    """Find the faults whose predicted readings are nearest, with all that are as near, or the mistake that is nearer.

    `predicted` holds the board without a fault too, which has no reference. A mistake together with a fault explains
    nearly everything, so it is named only if it is nearer by far than the mistake alone, and than any fault alone.
    """
    predicted = list(predicted)
    no_fault = _misfit({name: limits[name].expected_v for name in readings}, readings, limits)
    alone = find_alone(predicted, limits, readings)
    likely = _select_closest(alone, len(readings)) if alone else ()
    for mistake in mistakes:
        found = [Explanation(f, _misfit(mistake.apply(values), readings, limits), mistake) for f, values in predicted]
        closest = [each for each in found if not each.fault.reference]
        nearest = min(each.misfit for each in found)
        if (closest[0].misfit - nearest) * len(readings) >= _FAR:
            closest = [each for each in found if each.fault.reference]
        margin = _FAR if closest[0].fault.reference else _ALIKE
        best = min(each.misfit for each in closest)
        nearer = min((each.misfit for each in likely), default=no_fault) - best
        if best <= _EXPLAINED and nearer * len(readings) >= margin:
            likely = _select_closest(closest, len(readings))
    return likely


def _select_closest(found: list[Explanation], count: int) -> tuple[Explanation, ...]:
    """Select the nearest explanation, with all that so many readings do not tell from it."""
    nearest = min(each.misfit for each in found)
    close = [each for each in found if (each.misfit - nearest) * count < _ALIKE]
    # The readings do not tell these apart; the more common ones come first.
    close.sort(key=lambda each: (each.fault.rarity, each.misfit))
    return tuple(_merge_exchanges(close)[:_MOST])


def _merge_exchanges(found: list[Explanation]) -> list[Explanation]:
    """Name exchanges of one part with others of equal value together: only its own value shows in the readings."""
    merged = list(found)
    while True:
        pairs = {i: each.fault.reference.split(" and ") for i, each in enumerate(merged)}
        shared = Counter(name for pair in pairs.values() if len(pair) == 2 for name in pair)
        if not shared or max(shared.values()) < 2:
            return merged
        common = max(shared, key=shared.__getitem__)
        group = [i for i, pair in pairs.items() if len(pair) == 2 and common in pair]
        others = join_words([next(name for name in pairs[i] if name != common) for i in group])
        fault = replace(merged[group[0]].fault, reference=f"{common} and one of {others}")
        merged[group[0]] = replace(merged[group[0]], fault=fault)
        merged = [each for i, each in enumerate(merged) if i not in group[1:]]


def _misfit(predicted: Mapping[str, float], readings: Mapping[str, float], limits: Mapping[str, Limits]) -> float:
    return sum(_difference(name, predicted[name], v, limits) ** 2 for name, v in readings.items()) / len(readings)


def _difference(name: str, predicted_v: float, measured_v: float, limits: Mapping[str, Limits]) -> float:
    spread = (limits[name].high_v - limits[name].low_v) / 4.0
    if name.endswith("_ohm"):
        spread = resistances.METER_CONSTANT_OHM + spread * predicted_v / limits[name].expected_v
    if is_tone(name) and limits[name].low_v > 0.0:
        # What is left of a tone has the same relative spread, and the meter's own error.
        expected_v = limits[name].expected_v
        spread = spread / expected_v * abs(predicted_v) + METER_AC[1]
        # Exactly 0 is an output that is held; what passes an open part is tiny, but not 0.
        if predicted_v == 0.0:
            spread += _LEAKING * expected_v
    spread += _MODEL_RATIO * abs(predicted_v)
    return (measured_v - predicted_v) / spread


# Faults that no reading of a bring-up reveals: every reading of a board that has one is within its limits.

_VALUES = 2
"""Rarity from which a fault is a wrong value: those are left to the placement file."""


def list_hidden_faults(plan: BringUp) -> dict[str, list[str]]:
    """List the parts whose fault shows in no reading, by what is wrong with them."""
    board = plan.board
    faults = [fault for fault in list_faults(board.circuit, board.ends_v) if fault.rarity < _VALUES]
    hidden: dict[str, list[str]] = {}
    first_stage = name_voltage(STAGE1_OUT)
    beyond = {first_stage: 2.0 * plan.levels[first_stage].high_v}
    for fault, found in zip(faults, predict(board, faults), strict=True):
        # An offset that the fault lets through shows, unless it happens to be nearly none.
        values = fit_offset(board, fault, found, beyond)
        if not all(limits.allow(values[name]) for name, limits in plan.levels.items()):
            continue
        ohms = resistances.limit_board_resistances(replace(board, circuit=fault.circuit))
        if all(limits.allow(ohms[name].expected_v) for name, limits in plan.before_power.items()):
            what = fault.description.removeprefix("is ").partition(":")[0]
            hidden.setdefault(what, []).append(fault.reference)
    return hidden


def list_unsimulated(plan: BringUp) -> list[str]:
    """List the clamps, whose faults are not simulated: without them every reading is as it should be."""
    return [part.reference for part in plan.board.circuit.components if part.symbol.name == "BAT54S"]
