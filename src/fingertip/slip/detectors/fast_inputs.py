"""What the detector `fast` makes of its inputs: checked samples, vibration, and sums of each tick.

The tactile voltage gives the slow force and, without a board, the vibration. A board's filtered
signal gives the vibration with finer steps and less noise, as long as it can be believed: its
stages below their limits, its wire whole.

All filters work in single precision and in the order of operations of the C library.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.analog_and_digital import FirstOrder, SecondOrder
from fingertip.slip.detectors.fast_settings import (
    BANDS_HZ,
    BLOCKED_S,
    FAULT_S,
    FILTERED_JUMP_RATIO,
    GAP_S,
    JUMP_RATIO,
    LAG_S,
    LIMITED_S,
    MOVE_S,
    REST_SHARE,
    STILL_S,
    FastSettings,
    FilteredSignal,
    design_filters,
)

Singles = NDArray[np.float32]
Flags = NDArray[np.bool_]
Counts = NDArray[np.int64]

JUMP_MOVES = np.float32(8.0)
"""Ratio of a jump to the mean movement before it that the next sample must confirm."""
GLITCH_SHARE = np.float32(0.5)
"""Share of a suspected jump within which the next sample comes back if it was a glitch."""
ENERGIES = len(BANDS_HZ) + 2
"""Energies of a tick: of the slow force, of the bands, and of all vibration."""
SUMS = 1 + ENERGIES + 3
"""Sums of a tick: of the size of the vibration, of the energies, and of three products that tell a
tone.
"""
NO_STEP = np.float32(1e18)
"""Smallest step of a signal that has not changed yet."""
NEVER = 1 << 40
"""Samples since what was not seen yet."""


def shift(values: NDArray[Any], first: Any) -> NDArray[Any]:
    """The value before each one, of which the first is given."""
    return np.concatenate((np.asarray([first], dtype=values.dtype), values[:-1]))


def running_least(values: Singles, before: np.float32) -> Singles:
    """Smallest size so far of values that are not 0."""
    sizes = np.where(values == 0, NO_STEP, np.abs(values))
    sizes[0] = min(sizes[0], before)
    return np.asarray(np.minimum.accumulate(sizes), dtype=np.float32)


class Filter:
    """Digital filter in single precision, in transposed direct form II, with its state."""

    def __init__(self, section: FirstOrder | SecondOrder) -> None:
        self._section = section
        if isinstance(section, FirstOrder):
            self._section = SecondOrder(b0=section.b0, b1=section.b1, b2=0.0, a1=section.a1, a2=0.0)

        self._state = [0.0, 0.0]

    def process(self, values: Singles) -> Singles:
        filtered = np.zeros(len(values))
        _FILTER(self._section, values, self._state, filtered)
        return filtered.astype(np.float32)


def _filter_loop(
    section: Floats, samples: Floats, state: MutableFloats, filtered: MutableFloats
) -> None:
    b0 = np.float32(section[0])
    b1 = np.float32(section[1])
    b2 = np.float32(section[2])
    a1 = np.float32(section[3])
    a2 = np.float32(section[4])
    state_1 = np.float32(state[0])
    state_2 = np.float32(state[1])

    for i in range(len(samples)):
        x = np.float32(samples[i])
        y = state_1 + b0 * x
        state_1 = (state_2 + b1 * x) - a1 * y
        state_2 = b2 * x - a2 * y
        filtered[i] = float(y)

    state[0] = float(state_1)
    state[1] = float(state_2)


_FILTER = CompiledLoop(_filter_loop, samples="samples", plain_us=0.5)


def smoother(settings: FastSettings, time_s: float) -> FirstOrder:
    """Exponential mean with a time constant [s]."""
    share = 1 / (1 + time_s * settings.sample_rate_hz)
    return FirstOrder(b0=share, b1=0.0, a1=share - 1)


class SinceLast:
    """Samples since something was last seen, counted from one block to the next."""

    def __init__(self, before: int) -> None:
        self._before = before

    def count(self, seen: Flags) -> Counts:
        """Count them at each sample: 0 where it is seen."""
        places = np.arange(len(seen))
        last = np.maximum.accumulate(np.where(seen, places, -1 - self._before))
        counts = places - last
        self._before = min(int(counts[-1]), NEVER)
        return np.asarray(counts)


@dataclass(frozen=True, eq=False)
class CheckedSamples:
    """Samples of one input after its check."""

    values_v: Array
    """Each sample or, where it is no voltage, the last one before it [V]."""
    changes: Singles
    """Difference of each sample that is used to the one before [V]."""
    is_wrong: Flags
    """True where a sample was no voltage, and where the one before it proves to be a glitch."""
    is_lost: Flags
    """True from `GAP_S` without a voltage on."""


class InputCheck:
    """Replaces what is no voltage, and a jump that the next sample does not confirm.

    A jump is a change far beyond the movement until then. The sample before is used in its place;
    the sample after it is used in any case, so a real step comes one sample late.
    """

    def __init__(self, settings: FastSettings, jump_limit_v: float) -> None:
        self._number_limit_v = settings.number_limit_v
        self._jump_limit = np.float32(jump_limit_v)
        self._gap_samples = settings.samples(GAP_S)
        self._movement = Filter(smoother(settings, MOVE_S))
        self._mean_move = np.float32(0.0)
        self._since_number = SinceLast(NEVER)
        self._was_lost = True
        self._last_v = 0.0
        self._last_used_v = 0.0
        self._was_suspected = False
        self._has_just_begun = False

    def process(self, values_v: Array) -> CheckedSamples:
        # So written that NaN is no voltage.
        is_number = np.abs(values_v) <= self._number_limit_v
        is_lost = self._since_number.count(is_number) > self._gap_samples
        begins = shift(is_lost, self._was_lost)
        self._was_lost = bool(is_lost[-1])

        places = np.maximum.accumulate(np.where(is_number, np.arange(len(values_v)), -1))
        filled_v = np.where(places >= 0, values_v[places], self._last_v)
        before_v = shift(filled_v, self._last_v)
        self._last_v = float(filled_v[-1])

        moves = np.where(begins, 0.0, filled_v - before_v).astype(np.float32)
        is_jump = self._find_jumps(np.abs(moves))
        # Where the first sample was a glitch, the next one begins anew.
        has_just_begun = shift(begins, self._has_just_begun)
        self._has_just_begun = bool(begins[-1])
        begins |= is_jump & has_just_begun
        is_suspected = self._take_turns(is_jump & ~begins)
        changes, is_glitch = self._replace(filled_v, before_v, is_suspected)

        return CheckedSamples(
            values_v=filled_v,
            changes=np.where(begins, np.float32(0.0), changes),
            is_wrong=~is_number | is_glitch,
            is_lost=is_lost,
        )

    def _find_jumps(self, moves: Singles) -> Flags:
        """Find movements far beyond the mean one before them."""
        means = self._movement.process(moves)
        before = shift(means, self._mean_move)
        self._mean_move = means[-1]
        return np.asarray(moves > np.maximum(self._jump_limit, JUMP_MOVES * before))

    def _take_turns(self, is_jump: Flags) -> Flags:
        """Suspect each jump but the one right after another."""
        is_suspected = np.zeros(len(is_jump), dtype=bool)
        last = -1 if self._was_suspected else -2
        for place in np.flatnonzero(is_jump).tolist():
            if place != last + 1:
                is_suspected[place] = True
                last = place

        return is_suspected

    def _replace(
        self, filled_v: Array, before_v: Array, is_suspected: Flags
    ) -> tuple[Singles, Flags]:
        """Changes from one used sample to the next, and whether each shows a glitch before it."""
        was_suspected = shift(is_suspected, self._was_suspected)
        used_v = np.where(is_suspected, before_v, filled_v)
        last_used_v = np.where(was_suspected, shift(used_v, self._last_used_v), before_v)
        self._was_suspected = bool(is_suspected[-1])
        self._last_used_v = float(used_v[-1])

        changes = (used_v - last_used_v).astype(np.float32)
        jumps = (before_v - last_used_v).astype(np.float32)
        is_glitch = was_suspected & (np.abs(changes) <= GLITCH_SHARE * np.abs(jumps))
        return changes, is_glitch


@dataclass(frozen=True, eq=False)
class Ticks:
    """Sums of each tick of a block, and how the signal stood at its end."""

    sums: Singles
    """(ticks, `SUMS`): means over a tick of the size of the vibration [V], of the energies [V^2],
    and of products of the vibration with itself `LAG_S` and twice as long before.
    """
    slow: Singles
    """Slow force at the end of each tick, as a voltage without drift [V]."""
    step: Singles
    """Smallest step of the signal that gives the vibration, at the filter's input [V]."""
    slow_step: Singles
    """Smallest step of the tactile voltage [V]."""
    is_filtered: Flags
    """True if the vibration comes from the board's filtered signal."""
    is_blocked: Flags
    """True if nothing may be decided: after a gap, or the loss of the filtered signal."""
    is_still: Flags
    """True if the signal that gives the vibration has not changed for `GAP_S`."""


@dataclass(frozen=True, eq=False)
class Block:
    """What the inputs of a block of samples say."""

    vibration: Singles
    """Voltage behind the high-pass filter, at its input's scale [V]."""
    is_replaced: Flags
    is_outside: Flags
    ends: NDArray[np.int64]
    """Sample at which each tick ends."""
    ticks: Ticks


class LimitedSum:
    """Sum of the changes of a filtered signal that forgets drift, while no stage is at its limit.

    What a limit cuts off leaves an offset, so the sum begins anew when the stages have been within
    their limits for a while.
    """

    def __init__(self, leak: FirstOrder, limit_v: float, limited_samples: int) -> None:
        self._constants = np.array([-leak.a1, limit_v, limited_samples])
        self._state = [0.0, 0.0]

    def process(self, changes: Singles, stage: Singles) -> tuple[Singles, Flags]:
        """Return the sum [V], and whether it can be believed, at each sample."""
        summed = np.zeros(len(changes))
        limited = np.zeros(len(changes))
        _SUM(self._constants, changes, stage, self._state, summed, limited)
        return summed.astype(np.float32), limited == 0


def _sum_loop(
    constants: Floats,
    changes: Floats,
    stage: Floats,
    state: MutableFloats,
    summed: MutableFloats,
    limited: MutableFloats,
) -> None:
    keep = np.float32(constants[0])
    limit = np.float32(constants[1])
    total = np.float32(state[0])
    left = state[1]

    for i in range(len(changes)):
        total = np.float32(changes[i]) + keep * total
        if abs(total) > limit or abs(np.float32(stage[i])) > limit:
            left = constants[2]
        elif left > 0:
            left -= 1
            if left == 0:
                total = np.float32(0.0)

        summed[i] = float(total)
        limited[i] = left

    state[0] = float(total)
    state[1] = left


_SUM = CompiledLoop(_sum_loop, samples="changes", plain_us=0.7)


@dataclass(frozen=True, eq=False)
class Filtered:
    """What the board's filtered signal says."""

    vibration: Singles
    """Vibration at the filter's input [V]."""
    changes: Singles
    """Its differences from sample to sample [V]."""
    still: Counts
    """Samples since the last change."""
    is_wrong: Flags
    is_within: Flags
    """True where no stage of the board is at its limit, nor was shortly before."""
    is_alive: Flags
    """True where the signal moves about its rest: its wire is whole."""


class FilteredInput:
    """The board's filtered signal, and whether to believe it."""

    def __init__(self, settings: FastSettings, signal: FilteredSignal) -> None:
        filters = design_filters(settings.sample_rate_hz, settings.cutoff_hz)
        self._share = np.float32(1 / signal.gain)
        self._rest_v = signal.rest_v
        self._level_limit = np.float32(REST_SHARE * signal.range_v)
        jump_limit_v = FILTERED_JUMP_RATIO * settings.noise_v * signal.gain
        self._check = InputCheck(settings, jump_limit_v)
        self._sum = LimitedSum(filters.leak, signal.limit_v, settings.samples(LIMITED_S))
        self._level = Filter(smoother(settings, STILL_S))
        self._still_samples = settings.samples(STILL_S)
        self._since_change = SinceLast(NEVER)

    def process(self, values_v: Array, stage: Singles) -> Filtered:
        """`stage` is the first stage of the board's filter, from the tactile voltage [V]."""
        checked = self._check.process(values_v)
        changes = self._share * checked.changes
        vibration, is_within = self._sum.process(changes, stage)
        still = self._since_change.count(changes != 0)
        is_moved = still < self._still_samples
        return Filtered(
            vibration=vibration,
            changes=changes,
            still=still,
            is_wrong=checked.is_wrong,
            is_within=is_within,
            is_alive=is_moved & ~checked.is_lost & self._is_at_rest(checked.values_v),
        )

    def _is_at_rest(self, values_v: Array) -> Flags | np.bool_:
        """Whether the mean lies about the stated rest; a recording states none."""
        if self._rest_v is None:
            return np.bool_(True)

        level = self._level.process((values_v - self._rest_v).astype(np.float32))
        return np.asarray(np.abs(level) <= self._level_limit)


class FastInputs:
    """Checks, filters and sums of a detector, with their state."""

    def __init__(self, settings: FastSettings, with_filtered: bool) -> None:
        filters = design_filters(settings.sample_rate_hz, settings.cutoff_hz)
        self._settings = settings
        self._check = InputCheck(settings, JUMP_RATIO * settings.noise_v)
        self._high_1 = Filter(filters.high_1)
        self._high_2 = Filter(filters.high_2)
        self._leak = Filter(filters.leak)
        self._slow = Filter(filters.slow)
        self._bands = [Filter(band) for band in filters.bands]
        self._filtered: FilteredInput | None = None
        if with_filtered and settings.filtered:
            self._filtered = FilteredInput(settings, settings.filtered)

        self._since_wrong = SinceLast(NEVER)
        self._since_inside = SinceLast(0)
        self._since_loss = SinceLast(NEVER)
        self._since_change = SinceLast(NEVER)
        self._was_alive = False
        self._past = np.zeros(2 * settings.samples(LAG_S), dtype=np.float32)
        self._step = NO_STEP
        self._filtered_step = NO_STEP
        self._waiting = np.zeros((settings.phase % settings.tick_samples, SUMS), dtype=np.float32)

    def process(self, voltage_v: Array, filtered_v: Array | None) -> Block:
        """Process a block of at least one sample of each input [V]."""
        tactile = self._check.process(voltage_v)
        stage = self._high_1.process(tactile.changes)
        vibration = self._high_2.process(stage)
        slow = self._slow.process(self._leak.process(tactile.changes))
        slow_step = running_least(tactile.changes, self._step)
        self._step = slow_step[-1]
        step = slow_step
        still = self._since_change.count(tactile.changes != 0)
        is_wrong = tactile.is_wrong
        is_lost = tactile.is_lost
        is_filtered = np.zeros(len(voltage_v), dtype=bool)

        if self._filtered and filtered_v is not None:
            filtered = self._filtered.process(filtered_v, stage)
            is_alive = filtered.is_alive
            is_filtered = filtered.is_within & is_alive
            vibration = np.where(is_filtered, filtered.vibration, vibration)
            filtered_step = running_least(filtered.changes, self._filtered_step)
            self._filtered_step = filtered_step[-1]
            step = np.where(is_alive, filtered_step, slow_step)
            still = np.where(is_alive, filtered.still, still)
            is_wrong = is_wrong | filtered.is_wrong
            is_lost = is_lost | (shift(is_alive, self._was_alive) & ~is_alive)
            self._was_alive = bool(is_alive[-1])

        is_blocked = self._since_loss.count(is_lost) < self._settings.samples(BLOCKED_S)
        sums, ends = self._sum_ticks(self._list_products(vibration, slow))
        return Block(
            vibration=vibration,
            is_replaced=self._since_wrong.count(is_wrong) < self._settings.samples(FAULT_S),
            is_outside=self._find_outside(tactile.values_v),
            ends=ends,
            ticks=Ticks(
                sums=sums,
                slow=slow[ends],
                step=step[ends],
                slow_step=slow_step[ends],
                is_filtered=is_filtered[ends],
                is_blocked=is_blocked[ends],
                is_still=still[ends] > self._settings.samples(GAP_S),
            ),
        )

    def _find_outside(self, voltage_v: Array) -> Flags:
        """Whether the tactile voltage has been one that no force gives for `FAULT_S`."""
        lowest_v, highest_v = self._settings.possible_v
        count = self._since_inside.count((voltage_v >= lowest_v) & (voltage_v <= highest_v))
        return np.asarray(count > self._settings.samples(FAULT_S))

    def _list_products(self, vibration: Singles, slow: Singles) -> Singles:
        """What is summed over a tick, at each sample, as columns."""
        lag = len(self._past) // 2
        count = len(vibration)
        known = np.concatenate((self._past, vibration))
        one = known[lag : lag + count]
        two = known[:count]
        self._past = known[count:]
        in_bands = [band.process(vibration) for band in self._bands]
        columns = [np.abs(vibration), slow * slow, *(value * value for value in in_bands)]
        columns += [vibration * vibration, vibration * one, vibration * two, one * one]
        return np.column_stack(columns)

    def _sum_ticks(self, products: Singles) -> tuple[Singles, Counts]:
        """Means over each tick that ends here, and the sample at which it ends.

        The samples of a tick are added in their order: so does the C library.
        """
        size = self._settings.tick_samples
        waited = len(self._waiting)
        rows = np.concatenate((self._waiting, products))
        count = len(rows) // size
        self._waiting = rows[count * size :]
        samples = rows[: count * size].reshape(count, size, SUMS)
        total = samples[:, 0]
        for k in range(1, size):
            total = total + samples[:, k]

        ends = np.arange(1, count + 1) * size - 1 - waited
        return total * np.float32(1 / size), ends
