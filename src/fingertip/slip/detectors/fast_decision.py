"""Floor and flags of `fast`, decided every 2 ms.

Stage 1 is the article's chain: the mean of the rectified vibration against a multiple of a floor.
Its crossing is `incipient`. The floor follows three sentences:

1. It is the level below which four of five means lie: each tick it rises by a fixed share where the
   mean lies above it, falls by a quarter of that where it lies below, and fast where it lies below
   half of it.
2. It stands while the mean is above the threshold, while slip is ON and 0.3 s after that: this may
   be slip.
3. Only what was vetoed for a second on end lifts it all the same.

Stage 2 looks at each tick above the threshold: a table of small trees gives the log odds of slip,
and their sum turns ON. A strong slip gathers them sooner; a blow loses what it gathered. ON holds
while the mean lies above a lower multiple of the floor and the table does not call it a blow. A
tone of two seconds is learned as rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.slip.detectors.fast_features import RING, measure
from fingertip.slip.detectors.fast_inputs import ENERGIES, Flags, Singles, Ticks
from fingertip.slip.detectors.fast_settings import (
    MIN_FILTERED_V,
    NOISE_MEAN,
    FastSettings,
    white_energies,
)
from fingertip.slip.detectors.fast_table import BlowTable

SHORT_TICKS = 16
LONG_TICKS = 24
"""Ticks of the two means of stage 1: 32 and 48 ms."""
SHORT_RATIO = 1.85
LONG_RATIO = 1.65
"""Multiples of the floor above which the two means are incipient slip."""
HOLD_RATIO = 0.95
"""Multiple of the floor above which a mean keeps slip ON."""
UNHEARD_S = 0.5
"""Time without a crossing after which ON ends [s]: what is left may be noise."""
MIN_AGE_TICKS = 3
"""Ticks after the crossing from which on the table is asked."""
GAP_TICKS = 5
"""Ticks below the threshold that a crossing outlasts."""
NEED = 2.0
"""Sum of log odds above which slip is ON."""
MOST_ODDS = 6.0
LEAST_SUM = -4.0
"""Most that a tick adds to the sum, and the least sum."""
STAY_ODDS = -2.0
STAY_LOOKS = 8
"""Log odds below which a look at slip that is ON finds a blow, and how many such looks on end turn
it OFF. A look follows every second tick.
"""
TONE_S = 2.0
TONE_RATIO = 1.3
"""Time for which vibration that varies by less than a ratio is a tone, as of a motor or of the
mains [s]: slip varies more.
"""
SETTLING_S = 0.04
LEARNING_S = 0.3
"""Time in which the filters settle, and end of the first learning of floors [s]. OFF until then."""
RISE_PER_S = 1.0
FALL_PER_S = 0.25
DROP_PER_S = 10.0
"""Growth rates of the floor [1/s]: above it, below it, and below half of it."""
QUANTILE_RATIO = 1.12
"""Ratio of the level below which four of five means of noise lie to their mean."""
BAND_SHARE = 0.3
BAND_DROP_SHARE = 4.0
"""Rates at which energies at rest are averaged, over 1 / `LEARNING_S`."""
CLIP_RATIO = 4.0
"""Multiple of its value at rest above which an energy counts for no more."""
CALM_RATIO = 16.0
CALM_S = 0.05
"""Ratio below its energy at rest that the slow force keeps for a time [s], whereupon that energy is
halved at each tick: it was learned from a contact.
"""
AFTER_S = 0.3
"""Time after ON for which the floor stands [s]: a slide falters."""
VETOED_S = 1.0
"""Time of vibration that the table calls no slip after which the floor learns it [s]."""
STEP_RATIO = 0.5
"""Least noise that is learned, over the smallest step of the converter: halfway between two codes
it toggles between them.
"""


@dataclass(frozen=True)
class Floors:
    """What a detector has learned while its signal rested, for a start in which nothing rests."""

    level_v: float
    """Floor of the mean vibration [V]."""
    energies_v2: tuple[float, ...]
    """Energies of the slow force, of the bands and of all vibration [V^2]."""


@dataclass(frozen=True, eq=False)
class Decisions:
    """Flags, mean vibration and threshold at each tick."""

    on: Flags
    incipient: Flags
    statistic_v: Singles
    threshold_v: Singles


@dataclass(frozen=True, eq=False)
class AskedTicks:
    """Ticks at which the table would be asked, for its training."""

    rows: Singles
    """(asked, features)"""
    ticks: NDArray[np.int64]
    """Number of each tick."""


@dataclass(frozen=True, eq=False)
class DecisionConstants:
    """What a detector decides with, at its sampling rate and its stated noise."""

    short_ratio: np.float32
    long_ratio: np.float32
    """Multiples of the floor above which the two means are incipient slip."""
    need: np.float32
    """Sum of log odds above which slip is ON."""
    rise: np.float32
    fall: np.float32
    drop: np.float32
    """Factors of the floor in a tick: above it, below it, and below half of it."""
    band_share: np.float32
    band_drop_share: np.float32
    """Shares of a tick in the energies at rest, the second one far below the floor."""
    settling_ticks: int
    learning_ticks: int
    after_ticks: int
    vetoed_ticks: int
    tone_ticks: int
    calm_ticks: int
    unheard_ticks: int
    step_level: np.float32
    step_energies: Singles
    """Least floor and least energies for a converter's step of 1 V."""
    least_v: np.float32
    least_energies: Singles
    """Least floor [V] and least energies [V^2] of the tactile voltage, from the stated noise."""
    least_filtered_v: np.float32
    """Least floor of the board's filtered signal [V]."""

    @classmethod
    def for_settings(cls, settings: FastSettings) -> DecisionConstants:
        scale = settings.threshold_scale
        tick_s = settings.tick_s
        learning_ticks = settings.ticks(LEARNING_S)
        white = white_energies(settings.sample_rate_hz, settings.cutoff_hz)
        wide_root = math.sqrt(white[-1])
        least_noise_v = settings.min_noise_share * settings.noise_v
        return cls(
            short_ratio=np.float32(SHORT_RATIO * scale),
            long_ratio=np.float32(LONG_RATIO * scale),
            need=np.float32(NEED * scale),
            rise=np.float32(math.exp(RISE_PER_S * tick_s)),
            fall=np.float32(math.exp(-FALL_PER_S * tick_s)),
            drop=np.float32(math.exp(-DROP_PER_S * tick_s)),
            band_share=np.float32(BAND_SHARE / learning_ticks),
            band_drop_share=np.float32(BAND_DROP_SHARE / learning_ticks),
            settling_ticks=settings.ticks(SETTLING_S),
            learning_ticks=learning_ticks,
            after_ticks=settings.ticks(AFTER_S),
            vetoed_ticks=settings.ticks(VETOED_S),
            tone_ticks=settings.ticks(TONE_S),
            calm_ticks=settings.ticks(CALM_S),
            unheard_ticks=settings.ticks(UNHEARD_S),
            step_level=np.float32(STEP_RATIO * NOISE_MEAN * wide_root),
            step_energies=np.array(white, dtype=np.float32) * np.float32(STEP_RATIO**2),
            least_v=np.float32(least_noise_v * NOISE_MEAN * wide_root),
            least_energies=np.array(white, dtype=np.float32) * np.float32(least_noise_v**2),
            least_filtered_v=np.float32(MIN_FILTERED_V),
        )


def state_floors(settings: FastSettings, with_filtered: bool) -> Floors:
    """Return the floors before the first learning: those of the stated noise."""
    white = white_energies(settings.sample_rate_hz, settings.cutoff_hz)
    noise_v = MIN_FILTERED_V / NOISE_MEAN if with_filtered else settings.noise_v
    return Floors(
        level_v=noise_v * NOISE_MEAN * QUANTILE_RATIO * math.sqrt(white[-1]),
        energies_v2=tuple(noise_v * noise_v * energy for energy in white),
    )


class FastDecision:
    """Decides tick by tick; its state has the names of the C library's."""

    def __init__(
        self, settings: FastSettings, table: BlowTable, with_filtered: bool, floors: Floors | None
    ) -> None:
        self._table = table
        self.constants = DecisionConstants.for_settings(settings)
        self._learning_ticks = self.constants.learning_ticks
        if floors is not None:
            self._learning_ticks = self.constants.settling_ticks

        begin = floors or state_floors(settings, with_filtered)
        self.floor = np.float32(begin.level_v)
        self.band_floors = np.array(begin.energies_v2, dtype=np.float32)
        self.ticks = 0
        self.heard = 0
        self.age = 0
        self.missed = 0
        self.odds = np.float32(0.0)
        self.vetoed = 0
        self.after = 0
        self.refused = 0
        self.calm = 0
        self.is_second = False
        self.steady = 0
        self.lowest = np.float32(0.0)
        self.highest = np.float32(0.0)
        self.incipient = False
        self.on = False
        self._levels = np.zeros(LONG_TICKS - 1, dtype=np.float32)
        self._energy = np.zeros((RING - 1, ENERGIES), dtype=np.float32)
        self._tone = np.zeros((RING - 1, 3), dtype=np.float32)
        self._force = np.zeros(RING - 1, dtype=np.float32)

    @property
    def floors(self) -> Floors:
        return Floors(float(self.floor), tuple(self.band_floors.tolist()))

    @property
    def threshold_v(self) -> float:
        """Threshold of the shorter mean above the present floor [V]."""
        return float(self.constants.short_ratio * self.floor)

    def process(self, ticks: Ticks) -> Decisions:
        """Decide at each tick of a block."""
        decisions, _ = self._run(ticks, None)
        return decisions

    def collect(self, ticks: Ticks, is_slip: Flags) -> AskedTicks:
        """Compute the features of all ticks at which the table would be asked.

        `is_slip`, the truth at each tick, takes the place of the table.
        """
        _, asked = self._run(ticks, is_slip)
        return asked

    def _run(self, ticks: Ticks, is_slip: Flags | None) -> tuple[Decisions, AskedTicks]:
        count = len(ticks.sums)
        past = RING - 1
        levels = np.concatenate((self._levels, ticks.sums[:, 0]))
        energy = np.concatenate((self._energy, ticks.sums[:, 1 : 1 + ENERGIES]))
        tone = np.concatenate((self._tone, ticks.sums[:, 1 + ENERGIES :]))
        force = np.concatenate((self._force, ticks.slow))
        short, long = _compute_means(levels)
        least, least_energies = self._find_least(ticks)

        on = np.zeros(count, dtype=bool)
        incipient = np.zeros(count, dtype=bool)
        floors = np.zeros(count, dtype=np.float32)
        rows = list[Singles]()
        asked = list[int]()
        for i in range(count):
            self.ticks += 1
            floor = max(self.floor, least[i])
            looks = self._follow(short[i], long[i], floor, bool(ticks.is_blocked[i]))
            if looks:
                newest = slice(i + past, i - 1 if i else None, -1)
                row = measure(
                    energy=energy[newest],
                    tone=tone[newest],
                    force=force[newest],
                    floors=np.maximum(self.band_floors, least_energies[i]),
                    level_ratio=short[i] / floor,
                    age=self.age,
                )
                if is_slip is None:
                    self._judge(self._table.evaluate(row))
                else:
                    rows.append(row)
                    asked.append(i)

            if is_slip is not None:
                self.on = self.incipient and bool(is_slip[i])

            self._wait()
            self._end_tone(short[i], energy[i + past])
            if not (ticks.is_still[i] or ticks.is_blocked[i]):
                self._learn(short[i], levels[i + LONG_TICKS - 1], energy[i + past])

            on[i] = self.on
            incipient[i] = self.incipient or self.on
            floors[i] = floor

        self._levels = levels[count:]
        self._energy = energy[count:]
        self._tone = tone[count:]
        self._force = force[count:]
        statistic = np.maximum(
            short, long * (self.constants.short_ratio / self.constants.long_ratio)
        )
        decisions = Decisions(on, incipient, statistic, self.constants.short_ratio * floors)
        return decisions, AskedTicks(np.array(rows, dtype=np.float32), np.array(asked, dtype=int))

    def _find_least(self, ticks: Ticks) -> tuple[Singles, Singles]:
        """Least floor and least energies at rest: those of a converter's steps, or of the noise."""
        least = np.where(ticks.is_filtered, self.constants.least_filtered_v, self.constants.least_v)
        energies = (ticks.step * ticks.step)[:, None] * self.constants.step_energies
        energies[:, 0] = ticks.slow_step * ticks.slow_step * self.constants.step_energies[0]
        is_noisy = ~ticks.is_filtered[:, None] | (np.arange(ENERGIES) == 0)
        energies = np.maximum(energies, np.where(is_noisy, self.constants.least_energies, 0))
        return np.maximum(least, ticks.step * self.constants.step_level), energies

    def _follow(
        self, short: np.float32, long: np.float32, floor: np.float32, is_blocked: bool
    ) -> bool:
        """Follow the crossing and, in ON, the hold; return whether the table is to be asked."""
        if is_blocked or self.ticks <= self._learning_ticks:
            self.on = False
            self.incipient = False
            self._forget()
            return False

        above = bool(
            short > self.constants.short_ratio * floor or long > self.constants.long_ratio * floor
        )
        self.incipient = above
        if above:
            self.age = self.age + 1 + self.missed if self.age else 1
            self.missed = 0
        else:
            self.missed += 1

        if self.missed > GAP_TICKS:
            self._forget()

        if self.on:
            hold = np.float32(HOLD_RATIO) * floor
            is_heard = self.missed <= self.constants.unheard_ticks
            self.on = bool(is_heard and (short > hold or long > hold))
            self.is_second = not self.is_second
            if not self.on:
                self.odds = np.float32(0.0)

            return self.on and self.is_second

        return above and self.age >= MIN_AGE_TICKS

    def _forget(self) -> None:
        """Forget the crossing, which has ended."""
        self.age = 0
        self.vetoed = 0
        self.odds = np.float32(0.0)

    def _judge(self, odds: np.float32) -> None:
        """Take the log odds of one look: towards ON, or for staying ON."""
        if self.on:
            self.refused = self.refused + 1 if odds < STAY_ODDS else 0
            if self.refused > STAY_LOOKS:
                self.on = False
                self.odds = np.float32(0.0)

            return

        total = self.odds + min(odds, np.float32(MOST_ODDS))
        self.odds = max(total, np.float32(LEAST_SUM))
        self.on = bool(self.odds > self.constants.need)
        self.vetoed += 1
        self.refused = 0
        self.is_second = False

    def _wait(self) -> None:
        """Count the time since ON."""
        if self.on:
            self.after = self.constants.after_ticks
            self.vetoed = 0
        elif self.after > 0:
            self.after -= 1

    def _end_tone(self, short: np.float32, energy: Singles) -> None:
        """End ON, and learn the vibration as rest, where it has hardly varied for `TONE_S`."""
        self.steady += 1
        self.lowest = min(self.lowest, short)
        self.highest = max(self.highest, short)
        if not self.on or self.highest > np.float32(TONE_RATIO) * self.lowest:
            self.steady = 0
            self.lowest = short
            self.highest = short

        if self.steady >= self.constants.tone_ticks:
            self.on = False
            self.incipient = False
            self.after = 0
            self.steady = 0
            self._forget()
            self.floor = short * np.float32(QUANTILE_RATIO)
            self.band_floors[:] = energy

    def _learn(self, short: np.float32, level: np.float32, energy: Singles) -> None:
        """Let the floor and the energies at rest follow what is no slip.

        A signal that stands still teaches nothing: the stated noise holds, or what was learned.
        """
        if self.ticks <= self._learning_ticks:
            if self.ticks > self.constants.settling_ticks:
                self.heard += 1
                share = np.float32(1.0) / np.float32(self.heard)
                self.floor += share * (level * np.float32(QUANTILE_RATIO) - self.floor)
                self.band_floors += share * (energy - self.band_floors)

            return

        may_be_slip = self.incipient or self.on or self.after > 0
        if may_be_slip and self.vetoed < self.constants.vetoed_ticks:
            return

        is_far_below = short < np.float32(0.5) * self.floor
        share = self.constants.band_drop_share if is_far_below else self.constants.band_share
        clipped = np.minimum(energy, np.float32(CLIP_RATIO) * self.band_floors)
        self.band_floors += share * (clipped - self.band_floors)
        self._forget_contact(energy[0])
        if short > self.floor:
            self.floor *= self.constants.rise
        else:
            self.floor *= self.constants.drop if is_far_below else self.constants.fall

    def _forget_contact(self, slow_energy: np.float32) -> None:
        """Halve the slow force's energy at rest where the force has been far calmer for a while."""
        is_calm = np.float32(CALM_RATIO) * slow_energy < self.band_floors[0]
        self.calm = self.calm + 1 if is_calm else 0
        if self.calm > self.constants.calm_ticks:
            self.band_floors[0] *= np.float32(0.5)


def _compute_means(levels: Singles) -> tuple[Singles, Singles]:
    """Means of stage 1 at each tick; `levels` begin before the first.

    Sums of 2, 4, 8 and 16 ticks are each made of two of the one before, as in the C library.
    """
    twos = levels[1:] + levels[:-1]
    fours = twos[2:] + twos[:-2]
    eights = fours[4:] + fours[:-4]
    sixteens = eights[8:] + eights[:-8]
    long = sixteens[8:] + eights[: len(sixteens) - 8]
    return sixteens[8:] * np.float32(1 / SHORT_TICKS), long * np.float32(1 / LONG_TICKS)
