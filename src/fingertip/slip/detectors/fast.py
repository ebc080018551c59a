"""Detector `fast`: short energy in two bands of a fingertip's vibration, against bars that grow with the slope.

The article's chain waits for a window of 30 ms because a shorter one takes contacts for slip (its figure 5). Contacts,
releases and changes of grip are smooth, though: what they leave in a band is in proportion to how fast the force
changes. So the bar is the noise's and, as energies add, that slope times a time; it needs no window. Once ON the bar is
lower and forgets the slope, because slip changes the force too; and the noise floor is learnt only while OFF.

The wide band begins at 0.6 of the board's cutoff, 40 Hz: contacts are located below 30 Hz, slip's spectrum in an
embedded sensor begins lower than 67 Hz and rarely exceeds 100 Hz (article, III.A and figure 2). The upper band begins
at the cutoff. Slip that starts slowly shows in the wide one first. Slip that starts at once, while the force still
changes, shows in the upper one, where a change of force leaves a third as much. Either is enough.

How soon is decided by noise and by these changes alike. A converter's noise is spread over half the sampling rate, so
the same converter read ten times as often leaves a tenth of its power in the bands (`fingertip.campaign.studies`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.slip.detectors.fast_bands import Filters, noise_of
from fingertip.slip.detectors.fast_loop import (
    ENERGY,
    FLOOR,
    LOOP,
    ON,
    SETTLING,
    SLOPES,
    STATES,
    UPPER_ENERGY,
    UPPER_FLOOR,
)
from fingertip.slip.detectors.noise import input_noise_v
from fingertip.slip.detectors.stream import Output, as_samples

STEEPEST_V_S = 10.0
"""From `STEEPEST_FROM_HZ` on; in proportion to the rate below, where the poles ahead of the converter round knocks off.

Of the tuning slips, with starts of 1 to 10 m/s2, one in seventy was steeper than this before it was found, all the
larger finger's with 5 m/s2 or more. Knocks of 1 N and more that rise in 2 to 10 ms are beyond it before their energy
has reached a bar, but for one in fifty of the slowest; of those of 0.5 N the slow ones are not, and look like slip in
the only force there is. After a hard knock the detector is deaf for 60 ms, and so it is to slip that is as strong as
that from the first."""
STEEPEST_FROM_HZ = 2000.0
CHOSEN_AT_HZ = 67.0
"""Cutoff at which the slope bars were chosen."""
LEAKS_BELOW, LEAKS_ABOVE = 2.2, 0.6
"""A smooth change of force leaves in both bands what falls with these powers of the cutoff, below and above that one
(fitted to the noiseless quiet tuning scenes from 30 to 150 Hz)."""
MIN_NOISE_V_RTHZ = 4e-6
"""Noise in which the slope bars were chosen [V/sqrt(Hz)]: 0.4 mV at 20 kHz. In less, the first moments of a change of
force would show before its slope does; so the bars stay at this."""
SETTLING_PERIODS = 1.5
"""Of the wide band's lowest frequency. It starts settled on the first sample, whose noise is a step to it: OFF until
nearly all of that has died away."""
LOWEST = 0.6
"""The wide band begins at this share of the board's cutoff."""
HIGHEST = 0.4
"""The bands end at this share of the sampling rate at the latest."""


@dataclass(frozen=True)
class FastSettings:
    """What the detector needs to know. The times and ratios were chosen on simulated trials of the seeds that
    `fingertip.campaign` names as its tuning seeds, and on no others."""

    sample_rate_hz: float
    low_hz: float
    """Third-order Butterworth high-pass: the wide band begins."""
    upper_hz: float
    """Second-order Butterworth high-pass behind it: the upper band begins."""
    high_hz: float
    """Second-order Butterworth low-pass: both end."""
    noise_v: float
    """Of the input, white, rms."""
    energy_s: float = 0.005
    """Time constant of the energies."""
    slope_s: float = 0.00125
    """Lag of each of the two poles that smooth the slope."""
    quick_s: float = 0.0005
    """Lag of the one pole that smooths the slope by which knocks are known."""
    slope_hold_s: float = 0.05
    """Time constant with which the greatest slope is forgotten: longer than the high-pass rings."""
    slope_bar_s: float = 8.9e-4
    """Volts of the wide band's bar for each volt per second of slope."""
    upper_slope_bar_s: float = 3.4e-4
    """And of the upper band's."""
    steepest_v_s: float = math.inf
    """Slope beyond which it was a knock: OFF does not become ON before the slope is forgotten down to this [V/s], or
    has been kept up for longer than a knock rings."""
    deaf_s: float = 0.06
    """How long a knock rings."""
    floor_s: float = 2.0
    """Time constant of the noise floor."""
    stay: float = 0.5
    """The bars of the noise, times this, are where ON ends."""
    patience_s: float = 3.0
    """ON for longer than any slip lasts is hum, or more noise than was stated: then the floor learns it after all."""
    scale: float = 1.0
    """Of the bars of the noise, to trade delay against false alarms."""

    @classmethod
    def of(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        """The settings of a design: bands from 0.6, once and up to four times its board's cutoff, its rate, its noise
        unless given [V]."""
        cutoff, rate = design.board.cutoff_hz, design.detector.sample_rate_hz
        leaks = (CHOSEN_AT_HZ / cutoff) ** (LEAKS_BELOW if cutoff < CHOSEN_AT_HZ else LEAKS_ABOVE)
        found = cls(rate, LOWEST * cutoff, cutoff, min(4 * cutoff, HIGHEST * rate), 0.0)
        found = replace(found, slope_bar_s=found.slope_bar_s * leaks, upper_slope_bar_s=found.upper_slope_bar_s * leaks)
        if noise_v is not None:  # of a signal that may be no voltage: what is too steep for slip is not known
            return replace(found, noise_v=noise_v)
        noise = max(input_noise_v(design), MIN_NOISE_V_RTHZ * math.sqrt(rate / 2))
        return replace(found, noise_v=noise, steepest_v_s=STEEPEST_V_S * min(1.0, rate / STEEPEST_FROM_HZ))


@dataclass(frozen=True, eq=False)
class FastOutput(Output):
    """One value per input sample."""

    filtered_v: Array


class Fast:
    """The detector with its state. It starts settled on the first sample it is given."""

    def __init__(self, settings: FastSettings) -> None:
        self.settings = s = settings
        rate, filters = s.sample_rate_hz, Filters.of(s.sample_rate_hz, s.low_hz, s.upper_hz, s.high_hz)
        self._noise = noise = noise_of(filters, rate, s.low_hz, s.high_hz, s.energy_s, s.slope_s)
        wide, upper = noise.wide, noise.upper
        # Poles that lag by their time at every rate, so that level and slope keep their places.
        energy_share, slope_share, quick_share, floor_share = (
            1 / (1 + rate * t) for t in (s.energy_s, s.slope_s, s.quick_s, s.floor_s)
        )
        keep = math.exp(-1 / (rate * s.slope_hold_s))
        self._ratio = s.scale**2 * wide.bar / wide.energy
        upper_ratio = s.scale**2 * upper.bar / upper.energy
        self._coefficients = (
            *filters.coefficients, energy_share, slope_share, quick_share, floor_share, keep, rate,
            self._ratio, upper_ratio, s.stay**2, s.slope_bar_s**2, s.upper_slope_bar_s**2, noise.slope_ratio**2,
            s.steepest_v_s, s.deaf_s * rate, s.patience_s * rate,
            wide.energy * s.noise_v**2, upper.energy * s.noise_v**2,
        )  # fmt: skip
        # Energies and floors start at what the stated noise gives, and floors never fall below it.
        self._state = [0.0] * STATES
        self._state[ENERGY] = self._state[FLOOR] = wide.energy * s.noise_v**2
        self._state[UPPER_ENERGY] = self._state[UPPER_FLOOR] = upper.energy * s.noise_v**2
        self._state[SETTLING] = round(SETTLING_PERIODS * rate / s.low_hz)
        self._ring = [0.0]
        self._seen = 0

    @property
    def threshold_v(self) -> float:
        """The wide band's bar in the noise that was learnt [V], where the force does not change."""
        return math.sqrt(self._ratio * self._state[FLOOR])

    @property
    def memory_s(self) -> float:
        """An energy falls from a hundred bars to where ON ends within this [s]."""
        return 2 * math.log(100 / self.settings.stay) * self.settings.energy_s

    @property
    def noise_energy_v2(self) -> float:
        """Mean power of the stated noise in the wide band [V^2]."""
        return self._noise.wide.energy * self.settings.noise_v**2

    def noise_bars(self) -> Iterator[tuple[Array, float, float]]:
        """What `quadratic.bar_for` made each bar of: weights [V^2], time above the bar [s]; and the bar [V]."""
        for band in (self._noise.wide, self._noise.upper):
            bar_v = self.settings.scale * math.sqrt(band.bar) * self.settings.noise_v
            yield band.weights * self.settings.noise_v**2, band.excursion_s, bar_v

    def white_v(self, quiet_v: Array) -> float:
        """White noise that would leave as much in the bands as these samples of a quiet signal do, rms [V]."""
        rate, memory = self.settings.sample_rate_hz, round(4 * self.settings.sample_rate_hz / self.settings.low_hz)
        wide, upper = Filters.of(rate, self.settings.low_hz, self.settings.upper_hz, self.settings.high_hz).impulses(
            memory
        )
        shown = ((h, band.energy) for h, band in ((wide, self._noise.wide), (upper, self._noise.upper)))
        return max(math.sqrt(float(np.mean(np.convolve(quiet_v - quiet_v[0], h, "valid") ** 2)) / e) for h, e in shown)

    def process(self, voltage_v: Iterable[float]) -> FastOutput:
        """Take the next samples [V], any number of them, and return as many outputs."""
        samples = as_samples(voltage_v)
        if len(samples):
            self._settle(float(samples[0]))
        filtered, level, bar, on = LOOP.run(self._coefficients, self._state, self._ring, samples, self._seen)
        self._seen += len(samples)
        return FastOutput(level, bar, on > 0.0, filtered)

    def step(self, voltage_v: float) -> bool:
        """Take one sample [V] and return whether slip is ON."""
        self._settle(voltage_v)
        self._seen += 1
        LOOP.plain(self._coefficients, self._state, self._ring, (voltage_v,), [0.0], [0.0], [0.0], [0.0])
        return self._state[ON] > 0.0

    def _settle(self, x: float) -> None:
        if not self._seen:
            self._state[0] = -self._coefficients[0] * x
            for pole in SLOPES:
                self._state[pole] = x
