"""Detector `fast`: short energy in the band of a fingertip's vibration, against a bar that grows with the slope.

The article's chain waits for a window of 30 ms because a shorter one takes contacts for slip (its figure 5). Contacts,
releases and changes of grip are smooth, though: what they leave in the band is in proportion to how fast the force
changes. So the bar is the noise's, plus that slope times a time; it needs no window. Once ON the bar is lower and
forgets the slope, because slip changes the force too; and the noise floor is learnt only while OFF.

The band begins at half the board's cutoff, 33.5 Hz: contacts are located below 30 Hz, slip's spectrum in an embedded
sensor begins lower than 67 Hz and rarely exceeds 100 Hz (article, III.A and figure 2).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, MutableSequence, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fingertip.design import Design
from fingertip.slip.chain import ChainSettings, high_pass
from fingertip.slip.kernel import Loop
from fingertip.slip.noise import input_noise_v
from fingertip.slip.quadratic import bar_for
from fingertip.slip.stream import Array, Output, as_samples

STEEPEST_V_S = 6.0
"""The smoothed slope of a slip that begins stayed below 2.5 V/s on the tuning seeds; a knock of 2 N that rises in 4 ms
reaches 90 V/s, and is beyond this before its energy has reached the bar. Weaker knocks (below some 0.5 N) look like
slip, in the only force there is. After a hard knock the bar itself keeps the detector deaf for 0.1 to 0.2 s."""


@dataclass(frozen=True)
class FastSettings:
    """What the detector needs to know. The times and ratios were chosen on simulated trials of the seeds that
    `fingertip.campaign` names as its tuning seeds, and on no others."""

    sample_rate_hz: float
    low_hz: float
    """Third-order Butterworth high-pass."""
    high_hz: float
    """Second-order Butterworth low-pass."""
    noise_v: float
    """Of the input, white, rms."""
    energy_s: float = 0.005
    """Time constant of the energy."""
    slope_s: float = 0.002
    """Time constant of each of the two poles that smooth the slope."""
    slope_hold_s: float = 0.05
    """Time constant with which the greatest slope is forgotten: longer than the high-pass rings."""
    slope_bar_s: float = 1.4e-3
    """Volts of bar for each volt per second of slope."""
    steepest_v_s: float = math.inf
    """Slope beyond which it was a knock: OFF does not become ON before this is forgotten down to it [V/s]."""
    floor_s: float = 2.0
    """Time constant of the noise floor."""
    stay: float = 0.6
    """The bar of the noise, times this, is where ON ends."""
    scale: float = 1.0
    """Of the bar of the noise, to trade delay against false alarms."""

    @classmethod
    def of(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        """The settings of a design: half and three times its board's cutoff, its rate, its noise unless given [V]."""
        cutoff = design.board.cutoff_hz
        if noise_v is not None:  # of a signal that may be no voltage: what is too steep for slip is not known
            return cls(design.detector.sample_rate_hz, cutoff / 2, 3 * cutoff, noise_v)
        return cls(
            design.detector.sample_rate_hz, cutoff / 2, 3 * cutoff, input_noise_v(design), steepest_v_s=STEEPEST_V_S
        )


@dataclass(frozen=True, eq=False)
class FastOutput(Output):
    """One value per input sample."""

    filtered_v: Array


class Fast:
    """The detector with its state. It starts settled on the first sample it is given."""

    def __init__(self, settings: FastSettings) -> None:
        self.settings = settings
        rate = settings.sample_rate_hz
        high, low = _band(settings)
        shares = [1 - math.exp(-1 / (rate * t)) for t in (settings.energy_s, settings.slope_s, settings.floor_s)]
        keep = math.exp(-1 / (rate * settings.slope_hold_s))
        self._noise = noise = _noise_of(replace(settings, noise_v=0.0, scale=1.0))
        self._ratio = noise.bar_ratio * settings.scale**2
        self._coefficients = (
            *high[0], *high[1], *low, *shares, keep, rate, self._ratio, settings.stay**2,
            settings.slope_bar_s, noise.slope_ratio, settings.steepest_v_s,
        )  # fmt: skip
        # Energy and floor start at what the stated noise gives.
        start = noise.energy * settings.noise_v**2
        self._state = [0.0] * 11
        self._state[5] = self._state[9] = start
        self._ring = [0.0]
        self._seen = 0

    @property
    def threshold_v(self) -> float:
        """The bar in the noise that was learnt [V], where the force does not change."""
        return math.sqrt(self._ratio * self._state[9])

    @property
    def memory_s(self) -> float:
        """The energy falls from a hundred bars to where ON ends within this [s]."""
        return 2 * math.log(100 / self.settings.stay) * self.settings.energy_s

    @property
    def noise_energy_v2(self) -> float:
        """Mean power of the stated noise in the band [V^2]."""
        return self._noise.energy * self.settings.noise_v**2

    def noise_weights(self) -> tuple[Array, float, float]:
        """What `quadratic.bar_for` made the bar of: weights, time above the bar [s], noise [V]."""
        return self._noise.weights, self._noise.excursion_s, self.settings.noise_v

    def process(self, voltage_v: Iterable[float]) -> FastOutput:
        """Take the next samples [V], any number of them, and return as many outputs."""
        samples = as_samples(voltage_v)
        if len(samples):
            self._settle(float(samples[0]))
        filtered, level, bar, on = _LOOP.run(self._coefficients, self._state, self._ring, samples, self._seen)
        self._seen += len(samples)
        return FastOutput(level, bar, on > 0.0, filtered)

    def step(self, voltage_v: float) -> bool:
        """Take one sample [V] and return whether slip is ON."""
        self._settle(voltage_v)
        self._seen += 1
        _LOOP.plain(self._coefficients, self._state, self._ring, (voltage_v,), [0.0], [0.0], [0.0], [0.0])
        return self._state[10] > 0.0

    def _settle(self, x: float) -> None:
        if not self._seen:
            self._state[0] = -self._coefficients[0] * x
            self._state[6] = self._state[7] = x


def _band(settings: FastSettings) -> tuple[tuple[tuple[float, ...], tuple[float, ...]], tuple[float, ...]]:
    """Coefficients of the high-pass (as the article's) and of the low-pass: ``b0, a1, a2``, b1 = 2 b0, b2 = b0."""
    chain = ChainSettings(settings.sample_rate_hz, settings.low_hz, 1.0, settings.low_hz, 1, 1.0)
    K = math.tan(math.pi * settings.high_hz / settings.sample_rate_hz)
    norm = 1 / (1 + math.sqrt(2) * K + K * K)
    return high_pass(chain), (K * K * norm, 2 * (K * K - 1) * norm, (1 - math.sqrt(2) * K + K * K) * norm)


@dataclass(frozen=True, eq=False)
class _Noise:
    """What white noise of unit variance gives."""

    weights: Array
    """Of the energy, as a sum of squares (`quadratic.tail`)."""
    excursion_s: float
    """How long the energy stays above a high bar [s]."""
    energy: float
    """Mean of the band's energy."""
    bar_ratio: float
    """Energy of the bar over the mean energy, by the rule of `quadratic.bar_for`."""
    slope_ratio: float
    """Slope [1/s] that noise alone keeps up, over the square root of the mean energy."""


@functools.lru_cache(maxsize=64)
def _noise_of(settings: FastSettings) -> _Noise:
    rate, energy_s = settings.sample_rate_hz, settings.energy_s
    count = math.ceil(8 * rate / settings.low_hz)
    h = _impulse(settings, count)
    full = np.correlate(h, h, "full")[count - 1 :]
    # The energy's memory, in steps that still resolve the band.
    every = max(1, int(rate / (8 * settings.high_hz)))
    steps = np.arange(0, math.ceil(6 * energy_s * rate), every)
    weight = np.exp(-steps / (energy_s * rate))
    weight /= weight.sum()
    root = np.sqrt(weight)
    lags = np.abs(steps[:, None] - steps[None, :])
    spread = np.where(lags < count, full[np.minimum(lags, count - 1)], 0.0) * root[:, None] * root[None, :]
    weights = np.linalg.eigvalsh(spread)
    mean = float(weights.sum())
    # A stay above the bar ends when the energy, which decays with energy_s, has lost its excess: about the share
    # 2 w_max / bar of it. A third of the time constant stands for that (a test counts alarms in noise).
    weights, excursion_s = weights[weights > 1e-9 * weights.max()], energy_s / 3
    bar = bar_for(weights, excursion_s)
    share = 1 - math.exp(-1 / (rate * settings.slope_s))
    k = np.arange(math.ceil(12 * rate * settings.slope_s))
    smooth = share * share * (k + 1) * (1 - share) ** k
    slope = np.diff(smooth, prepend=0.0) * rate
    return _Noise(weights, excursion_s, mean, bar / mean, 4.0 * math.sqrt(float(slope @ slope) / mean))


def _impulse(settings: FastSettings, count: int) -> Array:
    """The band's impulse response."""
    high, low = _band(settings)
    shares = (1.0, 1.0, 1.0)
    coefficients = (*high[0], *high[1], *low, *shares, 1.0, 1.0, math.inf, 1.0, 0.0, 0.0, math.inf)
    filtered = [0.0] * count
    rest = [[0.0] * count for _ in range(3)]
    _LOOP.plain(coefficients, [0.0] * 11, [0.0], [1.0] + [0.0] * (count - 1), filtered, *rest)
    return np.array(filtered)


def _fast_loop(
    coefficients: tuple[float, ...],
    state: MutableSequence[float],
    ring: MutableSequence[float],
    samples: Sequence[float],
    filtered: MutableSequence[float],
    levels: MutableSequence[float],
    bars: MutableSequence[float],
    flags: MutableSequence[float],
) -> None:
    g0, g1, p1, b0, b1, b2, a1, a2, c0, d1, d2 = coefficients[:11]
    energy_share, slope_share, floor_share, keep, rate, ratio, stay, slope_bar, slope_noise, steepest = coefficients[
        11:
    ]
    s1, s2, s3, l1, l2, energy = state[0], state[1], state[2], state[3], state[4], state[5]
    q1, q2, held, floor, on = state[6], state[7], state[8], state[9], state[10]
    for i in range(len(samples)):
        x = samples[i]
        w = g0 * x + s1
        s1 = g1 * x - p1 * w
        u = b0 * w + s2
        s2 = b1 * w - a1 * u + s3
        s3 = b2 * w - a2 * u
        y = c0 * u + l1
        l1 = 2 * c0 * u - d1 * y + l2
        l2 = c0 * u - d2 * y
        energy += energy_share * (y * y - energy)

        q1 += slope_share * (x - q1)
        change = slope_share * (q1 - q2)
        q2 += change
        slope = rate * abs(change)
        held *= keep
        if slope > held:
            held = slope

        root = math.sqrt(floor)
        extra = held - slope_noise * root
        bar = math.sqrt(ratio) * root + (slope_bar * extra if extra > 0.0 else 0.0)
        level = math.sqrt(energy)
        if on > 0.0:
            bar = math.sqrt(ratio * stay) * root
            on = 1.0 if level > bar else 0.0
        else:
            on = 1.0 if level > bar and held < steepest else 0.0
        if on == 0.0 and energy < ratio * floor and extra <= 0.0:
            floor += floor_share * (energy - floor)  # frozen while ON, and while the force changes
        filtered[i] = y
        levels[i] = level
        bars[i] = bar
        flags[i] = on
    state[0], state[1], state[2], state[3], state[4], state[5] = s1, s2, s3, l1, l2, energy
    state[6], state[7], state[8], state[9], state[10] = q1, q2, held, floor, on


_LOOP = Loop(_fast_loop, outputs=4)
