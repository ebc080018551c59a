"""Detector `fast`: short-time energy in two bands, compared with thresholds that grow with the force's slew rate.

The article's chain needs a window of 30 ms, because a shorter one reports contacts as slip (its figure 5). Contacts,
releases and changes of grip are smooth, however: the voltage that they leave in a band is proportional to the slew rate
of the force. This detector therefore adds two energies for its threshold, that of the noise and that of the slew rate
times a constant, and needs no window. While ON the threshold is lower and ignores the slew rate, because slip changes
the force too. The noise floor adapts only while OFF.

The wide band begins at 0.6 of the board's cutoff, 40 Hz by default. Contacts lie below 30 Hz, and the spectrum of slip
in an embedded sensor begins below 67 Hz and rarely exceeds 100 Hz (article, section III.A and figure 2). The upper band
begins at the cutoff. Slip that starts slowly appears in the wide band first. Slip that starts at once, while the force
still changes, appears in the upper band, where a change of force leaves a third as much. Either band is sufficient.

Noise and changes of force limit the delay alike. The noise of an ADC is spread over half the sampling rate, so the same
ADC sampled ten times as fast leaves a tenth of its noise power in the bands (`fingertip.campaign.studies`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.slip.detectors import fast_loop
from fingertip.slip.detectors.detector import DetectorOutput, as_samples
from fingertip.slip.detectors.fast_bands import BandFilters, compute_noise
from fingertip.slip.detectors.fast_loop import LOOP, FastCoefficients
from fingertip.slip.detectors.noise import input_noise_v

MAX_SLEW_RATE_V_S = 10.0
"""Slew rate above which a signal is a knock [V/s], for sampling rates from `FULL_SLEW_RATE_HZ` on.

Below that rate the limit is proportional to the sampling rate, because the ADC's anti-aliasing poles round knocks off.

Of the tuning slips, which start with 1 to 10 m/s2, one in seventy exceeds this limit before its detection. All of those
are of the larger finger and start with 5 m/s2 or more. Knocks of 1 N and more that rise in 2 to 10 ms exceed the limit
before their energy reaches a threshold, except one in fifty of the slowest. Slow knocks of 0.5 N do not exceed it; the
force alone does not distinguish them from slip. After a hard knock the detector is blanked for 60 ms, and so it is at
the onset of slip that is as strong as a knock."""
FULL_SLEW_RATE_HZ = 2000.0
"""Sampling rate from which `MAX_SLEW_RATE_V_S` applies in full [Hz]."""
REFERENCE_CUTOFF_HZ = 67.0
"""Cutoff for which the slew thresholds were chosen [Hz]."""
LEAKAGE_EXPONENT_BELOW, LEAKAGE_EXPONENT_ABOVE = 2.2, 0.6
"""Exponents with which the leakage of a smooth change of force into the bands falls with the cutoff, below and above
`REFERENCE_CUTOFF_HZ` (fitted to the noiseless negative tuning scenes from 30 to 150 Hz)."""
MIN_NOISE_V_RTHZ = 4e-6
"""Noise density for which the slew thresholds were chosen [V/sqrt(Hz)]: 0.4 mV at 20 kHz.

In less noise the first moments of a change of force would appear before its slew rate does. The noise thresholds
therefore never assume less."""
SETTLING_PERIODS = 1.5
"""Duration of the initial OFF, in periods of the wide band's lower edge.

The detector starts in the steady state of the first sample. The noise of that sample acts as a step, most of which has
decayed after this time."""
LOW_EDGE_RATIO = 0.6
"""Lower edge of the wide band, as a share of the board's cutoff."""
MAX_HIGH_EDGE_RATIO = 0.4
"""Greatest upper edge of the bands, as a share of the sampling rate."""


@dataclass(frozen=True)
class FastSettings:
    """Settings of the detector.

    The times and ratios were chosen on simulated trials of the seeds that `fingertip.campaign` names as its tuning
    seeds, and on no others.
    """

    sample_rate_hz: float
    low_hz: float
    """Lower edge of the wide band [Hz]: cutoff of a third-order Butterworth high-pass filter."""
    upper_hz: float
    """Lower edge of the upper band [Hz]: cutoff of a second-order Butterworth high-pass filter after the wide band."""
    high_hz: float
    """Upper edge of both bands [Hz]: cutoff of a second-order Butterworth low-pass filter."""
    noise_v: float
    """White RMS noise at the input [V]."""
    energy_s: float = 0.005
    """Time constant of the energies [s]."""
    slew_smoothing_s: float = 0.00125
    """Time constant of each of the two poles that smooth the slew rate [s]."""
    knock_smoothing_s: float = 0.0005
    """Time constant of the one pole that smooths the slew rate by which knocks are identified [s]."""
    peak_decay_s: float = 0.05
    """Time constant with which peak slew rates decay [s]; longer than the high-pass filter rings."""
    slew_threshold_s: float = 8.9e-4
    """Wide band's threshold per slew rate [V per V/s]."""
    upper_slew_threshold_s: float = 3.4e-4
    """Upper band's threshold per slew rate [V per V/s]."""
    max_slew_rate_v_s: float = math.inf
    """Slew rate above which a signal is a knock [V/s].

    A knock inhibits the transition to ON until its peak slew rate has decayed to this limit, or until the slew rate has
    exceeded it for longer than `blanking_s`."""
    blanking_s: float = 0.06
    """Longest time for which a knock inhibits detection [s]: knocks ring for as long."""
    floor_s: float = 2.0
    """Time constant of the noise floors [s]."""
    hysteresis_ratio: float = 0.5
    """Factor of the noise thresholds while ON."""
    max_on_s: float = 3.0
    """Duration of ON that exceeds any slip [s]. After it the input is taken for hum or for more noise than stated, and
    the noise floors adapt although the detector is ON."""
    threshold_scale: float = 1.0
    """Factor of the noise thresholds, to trade delay for false alarms."""

    @classmethod
    def from_design(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        """Take the settings from a design.

        The wide band extends from 0.6 to four times the board's cutoff, and the upper band begins at the cutoff.

        Parameters
        ----------
        design
            Source of the sampling rate, the cutoff and the noise.
        noise_v
            White RMS noise of the input; by default the design's [V]. The input may then have another unit than volts,
            so no signal is treated as a knock.
        """
        cutoff, rate = design.board.cutoff_hz, design.detector.sample_rate_hz
        exponent = LEAKAGE_EXPONENT_BELOW if cutoff < REFERENCE_CUTOFF_HZ else LEAKAGE_EXPONENT_ABOVE
        leakage = (REFERENCE_CUTOFF_HZ / cutoff) ** exponent
        settings = cls(rate, LOW_EDGE_RATIO * cutoff, cutoff, min(4 * cutoff, MAX_HIGH_EDGE_RATIO * rate), 0.0)
        settings = replace(
            settings,
            slew_threshold_s=settings.slew_threshold_s * leakage,
            upper_slew_threshold_s=settings.upper_slew_threshold_s * leakage,
        )
        if noise_v is not None:
            return replace(settings, noise_v=noise_v)
        noise = max(input_noise_v(design), MIN_NOISE_V_RTHZ * math.sqrt(rate / 2))
        max_slew_rate_v_s = MAX_SLEW_RATE_V_S * min(1.0, rate / FULL_SLEW_RATE_HZ)
        return replace(settings, noise_v=noise, max_slew_rate_v_s=max_slew_rate_v_s)


@dataclass(frozen=True, eq=False)
class FastOutput(DetectorOutput):
    """Output of the detector: one value per input sample."""

    filtered_v: Array
    """Wide band [V]."""


class FastDetector:
    """Fast detector with its state. It starts in the steady state of the first sample."""

    def __init__(self, settings: FastSettings) -> None:
        self.settings = s = settings
        rate = s.sample_rate_hz
        self._filters = BandFilters.butterworth(rate, s.low_hz, s.upper_hz, s.high_hz)
        self._noise = compute_noise(self._filters, rate, s.low_hz, s.high_hz, s.energy_s, s.slew_smoothing_s)
        self._coefficients = self._compute_coefficients()
        # Energies and noise floors start at those of the stated noise.
        self._state = [0.0] * fast_loop.STATES
        self._state[fast_loop.ENERGY] = self._state[fast_loop.FLOOR] = self._coefficients.min_floor
        self._state[fast_loop.UPPER_ENERGY] = self._coefficients.upper_min_floor
        self._state[fast_loop.UPPER_FLOOR] = self._coefficients.upper_min_floor
        self._state[fast_loop.SETTLING_SAMPLES] = round(SETTLING_PERIODS * rate / s.low_hz)
        self._started = False

    def _compute_coefficients(self) -> FastCoefficients:
        s, noise, filters = self.settings, self._noise, self._filters
        rate, wide, upper = s.sample_rate_hz, noise.wide, noise.upper
        # Smoothing factors of poles whose group delay is the time constant at every sampling rate, so that energy and
        # slew rate keep their alignment.
        energy, slew, knock, floor = (
            1 / (1 + rate * t) for t in (s.energy_s, s.slew_smoothing_s, s.knock_smoothing_s, s.floor_s)
        )
        return FastCoefficients(
            *filters.first,
            *filters.second,
            low_pass_b0=filters.low_pass.b0,
            low_pass_a1=filters.low_pass.a1,
            low_pass_a2=filters.low_pass.a2,
            upper_b0=filters.upper.b0,
            upper_a1=filters.upper.a1,
            upper_a2=filters.upper.a2,
            energy_smoothing=energy,
            slew_smoothing=slew,
            knock_smoothing=knock,
            floor_smoothing=floor,
            peak_decay=math.exp(-1 / (rate * s.peak_decay_s)),
            sample_rate_hz=rate,
            noise_ratio=s.threshold_scale**2 * wide.threshold / wide.energy,
            upper_noise_ratio=s.threshold_scale**2 * upper.threshold / upper.energy,
            hysteresis=s.hysteresis_ratio**2,
            slew_gain=s.slew_threshold_s**2,
            upper_slew_gain=s.upper_slew_threshold_s**2,
            slew_noise=noise.slew_rate_ratio**2,
            max_slew_rate=s.max_slew_rate_v_s,
            blanking_samples=s.blanking_s * rate,
            max_on_samples=s.max_on_s * rate,
            min_floor=wide.energy * s.noise_v**2,
            upper_min_floor=upper.energy * s.noise_v**2,
        )

    @property
    def threshold_v(self) -> float:
        """Wide band's threshold above the present noise floor, while the force is constant [V]."""
        return math.sqrt(self._coefficients.noise_ratio * self._state[fast_loop.FLOOR])

    @property
    def memory_s(self) -> float:
        """Time in which an energy decays from a hundred times the threshold to the end of ON [s]."""
        return 2 * math.log(100 / self.settings.hysteresis_ratio) * self.settings.energy_s

    @property
    def noise_energy_v2(self) -> float:
        """Mean power of the stated noise in the wide band [V^2]."""
        return self._noise.wide.energy * self.settings.noise_v**2

    def noise_thresholds(self) -> Iterator[tuple[Array, float, float]]:
        """Yield, for each band, the weights [V^2] and excursion time [s] of its threshold, and the threshold [V]."""
        for band in (self._noise.wide, self._noise.upper):
            threshold_v = self.settings.threshold_scale * math.sqrt(band.threshold) * self.settings.noise_v
            yield band.weights * self.settings.noise_v**2, band.excursion_s, threshold_v

    def equivalent_noise_v(self, quiet_v: Array) -> float:
        """Compute the white RMS noise that has as much energy in the bands as these samples of a quiet signal [V]."""
        count = round(4 * self.settings.sample_rate_hz / self.settings.low_hz)
        responses = self._filters.impulse_responses(count)
        energies = (self._noise.wide.energy, self._noise.upper.energy)
        return max(
            math.sqrt(float(np.mean(np.convolve(quiet_v - quiet_v[0], h, "valid") ** 2)) / energy)
            for h, energy in zip(responses, energies, strict=True)
        )

    def process(self, voltage_v: Iterable[float]) -> FastOutput:
        """Process the next samples [V], any number of them, and return one output per sample."""
        samples = as_samples(voltage_v)
        if len(samples):
            self._start(float(samples[0]))
        filtered, statistic, threshold, on = np.zeros((4, len(samples)))
        LOOP(self._coefficients, samples, self._state, filtered, statistic, threshold, on)
        return FastOutput(statistic, threshold, on > 0.0, filtered)

    def step(self, voltage_v: float) -> bool:
        """Process one sample [V] and return whether slip is ON."""
        self._start(voltage_v)
        LOOP.plain(self._coefficients, (voltage_v,), self._state, [0.0], [0.0], [0.0], [0.0])
        return self._state[fast_loop.ON] > 0.0

    def _start(self, voltage_v: float) -> None:
        """Set the steady state of a constant input before the first sample."""
        if not self._started:
            self._started = True
            self._state[fast_loop.FIRST] = -self._coefficients.first_b0 * voltage_v
            for index in fast_loop.SMOOTHED_VOLTAGES:
                self._state[index] = voltage_v
