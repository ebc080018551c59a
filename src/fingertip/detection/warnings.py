"""Warnings of a recording and of settings for which the detectors were not made."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from fingertip.design import Design
from fingertip.design.formulas.filter import signal_ground_ratio
from fingertip.foundation.errors import join_words
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.fast import FastDetector, FastOutput
from fingertip.slip.detectors.noise_and_threshold import NoiseLevel
from fingertip.slip.detectors.registry import DEFAULT, find_detector_type
from fingertip.slip.scored_detection import BEGIN_RATIO, BEGIN_S, MAX_NOISE_RATIO, Detection
from fingertip.slip.traces.trace import Trace

_MAX_RESIDUAL = 0.05
"""Largest deviation of a difference from a whole number of steps: rounding of the file."""
_MAX_STEPS = 1000
"""Largest number of steps between neighbouring voltages that rounding leaves whole."""
_RECENT = 4000
"""Samples of a stream that are examined together."""


def find_step_v(volts: Array) -> float | None:
    """Return the step that divides all differences between voltages [V]; None without one."""
    levels = np.unique(volts)
    if len(levels) < 2:
        return None

    gaps = np.diff(levels)
    smallest = gaps.min()
    near = gaps[gaps < _MAX_STEPS * smallest] / smallest
    if np.abs(near - np.round(near)).max() > _MAX_RESIDUAL * np.round(near).max():
        return None

    return float((levels[-1] - levels[0]) / np.round(gaps / smallest).sum())


def step_warnings(volts: Array, design: Design, detector: str) -> Iterator[str]:
    """Warn of steps in the voltages [V] that hide the noise that the thresholds assume."""
    settings = design.detector
    step = find_step_v(volts)
    expected = (1 + _MAX_RESIDUAL) * settings.adc_step_v
    if step is None or step <= max(COARSE_RATIO * settings.noise_v, expected):
        return

    effect = "single steps can be reported as slip"
    remedy = ", or use --detector fast, which learns the steps"
    if detector == "fast":
        effect = "weak slip is missed"
        remedy = ""

    yield (
        f"the voltages come in steps of {1000 * step:.3g} mV, which hide the noise of "
        f"{1000 * settings.noise_v:.3g} mV "
        f"that the thresholds assume: {effect}. Record with more bits or a smaller range{remedy}."
    )


# Warnings of a signal at a limit: the end of the converter, or one below it, as by the supply of an
# amplifier.

_LEAST_RUN = 4
_LEAST_FLAT = 10
_DEVIATIONS = 6.0
"""Samples in a row, and in all, that make a limit, and deviations above chance."""
_BLOCK = 100
"""Samples in a block; the block with most repeats shows what steps explain."""


def flat_warnings(volts: Array, design: Design, detector: str = "") -> Iterator[str]:
    """Warn of voltages [V] at the converter's end, and of runs at the largest or smallest one.

    A divider rests at 0 V.
    """
    settings = design.detector
    high = settings.adc_range_v - 1.5 * settings.adc_step_v
    limits = {"largest": volts.max(initial=-np.inf)}
    low = settings.adc_low_v + settings.adc_step_v / 2 if design.board.has_filter else -np.inf
    if design.board.has_filter:
        limits["smallest"] = volts.min(initial=np.inf)

    clipped = int(np.sum((volts >= high) | (volts <= low)))
    if clipped:
        share = f"all {clipped}" if clipped == len(volts) else f"{clipped} of {len(volts)}"
        yield (
            f"{share} samples are at the limits "
            f"of the ADC range, {settings.adc_range_text}: slip is not visible there. Attenuate "
            "the signal before the "
            "ADC, or record with a wider range (detector.adc_range_v)."
        )

    for noun, limit in limits.items():
        count = _count_flat(volts, limit) if low < limit < high else 0
        if count >= _LEAST_FLAT:
            yield (
                f"{count} of {len(volts)} samples ({100 * count / len(volts):.2g} %) are flat at "
                f"{limit:.4g} V, the "
                f"{noun} voltage: an amplifier, or the sensor itself, is at its limit, and slip "
                "is not visible there. "
                "Lower the gain or the force, or move the rest of the signal."
            )


def _count_flat(volts: Array, limit: float) -> int:
    """Count the samples in runs at a voltage [V] that are longer than chance explains."""
    is_flat = volts == limit
    if np.count_nonzero(is_flat) < _LEAST_FLAT:
        return 0

    edges = np.flatnonzero(np.diff(is_flat.astype(np.int8), prepend=0, append=0))
    rest = volts[~is_flat]
    blocks = (np.diff(rest) == 0.0)[: (len(rest) - 1) // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
    repeats = min(0.999, float(blocks.mean(axis=1).max(initial=1.0 / _BLOCK)) + 1 / len(volts))
    runs = np.sort(edges[1::2] - edges[::2])[::-1]
    chance = len(runs) * repeats ** (runs - 1.0)  # how many runs of a length or more are expected
    is_long = (np.arange(1, len(runs) + 1) - chance > _DEVIATIONS * np.sqrt(chance)) & (
        runs >= _LEAST_RUN
    )

    if not is_long.any() or not len(blocks):
        return 0

    return int(runs[: np.flatnonzero(is_long)[-1] + 1].sum())


class StreamWatch:
    """Watch over the voltages of a stream: warns once of what a recording is warned of."""

    def __init__(
        self,
        design: Design,
        detector: str,
        instance: Detector,
        with_steps: bool,
    ) -> None:
        self._design = design
        self._detector = detector
        self._instance = instance
        self._recent: list[float] = []
        self._count = 0
        self._first_v = 0.0
        self._begin_samples = round(BEGIN_S * design.detector.sample_rate_hz)
        self._checks: list[Callable[..., Iterator[str]]] = [
            flat_warnings,
            preload_warnings,
            *([step_warnings] if with_steps else []),
            lambda *_: noise_warnings(getattr(instance, "noise_v", None), design, None),
            self._doubt_begin,
        ]

    def end(self) -> list[str]:
        """List the warnings of the last samples, at the end of the stream maybe the only ones."""
        volts = np.array(self._recent)
        warnings = list[str]()

        for check in [*self._checks]:
            first = [*check(volts, self._design, self._detector)][:1]
            warnings += first
            if first or check is preload_warnings:  # later there may be a load all the time
                self._checks.remove(check)

        return warnings

    def _doubt_begin(self, *_: object) -> Iterator[str]:
        rests = getattr(self._instance, "threshold_v", 0.0) * BEGIN_RATIO < self._first_v
        return begin_warnings(self._count / self._design.detector.sample_rate_hz if rests else None)

    @property
    def room(self) -> int:
        """Number of samples after which it looks at the detector and at the voltages."""
        room = _RECENT - len(self._recent)
        until_begin = self._begin_samples - self._count
        return min(room, until_begin) if until_begin > 0 else room

    def add(self, volts: Sequence[float]) -> Sequence[str]:
        """Add voltages, no more than there is room for [V]."""
        self._recent += volts
        self._count += len(volts)
        if self._count == self._begin_samples and len({*self._recent}) > 2:
            self._first_v = getattr(self._instance, "threshold_v", 0.0)
        if len(self._recent) < _RECENT:
            return ()

        warnings = self.end()
        del self._recent[: _RECENT // 2]
        return warnings


# Warnings of recorded outputs of a board that cannot be: a broken wire, two wires exchanged, or the
# wrong ground.

MAX_REST_V = 0.3
"""Largest deviation of the rest of a filtered signal from the signal ground [V]."""


def filtered_warnings(trace: Trace, design: Design) -> Iterator[str]:
    """Warn of a filtered signal that is constant, or rests off the board's signal ground."""
    if trace.filtered_v is None or not len(trace.filtered_v):
        return

    rest_v = float(np.median(trace.filtered_v))
    ground_v = _find_ground_v(design)
    if float(np.ptp(trace.filtered_v)) == 0.0:
        yield (
            f"filtered_v stands still at {rest_v:.3g} V: is the board's pin S connected? "
            "The tactile voltage alone is judged."
        )
    elif min(abs(rest_v), abs(rest_v - ground_v)) > MAX_REST_V:
        yield (
            f"filtered_v rests at {rest_v:.3g} V, and neither at the signal ground of "
            f"{ground_v:.3g} V nor at 0 V: are "
            "T and S exchanged?"
        )


def envelope_warnings(trace: Trace, design: Design) -> Iterator[str]:
    """Warn of an envelope that was recorded above ground instead of the signal ground."""
    ground_v = _find_ground_v(design)
    if trace.envelope_v is None or not len(trace.envelope_v) or not ground_v:
        return

    rest_v = float(np.median(trace.envelope_v))
    if abs(rest_v - ground_v) <= MAX_REST_V:
        yield (
            f"envelope_v rests at {rest_v:.3g} V, near the signal ground of {ground_v:.3g} V, and "
            "slip is ON all the "
            "time: was E recorded against ground? The envelope is E minus M: subtract the samples "
            "of M."
        )


def _find_ground_v(design: Design) -> float:
    return signal_ground_ratio(design.board) * design.board.supply_v


# Warnings of what the detectors were not made for: hum, a reversed sensor, and more noise than
# `fast` was fitted to.

MAX_HUM_V = 1e-3
"""Largest RMS hum in the signals of the fit [V]."""
_MAINS_HZ = (50, 60)
_PIECE_S = 0.5
"""Length of a piece of which the hum is taken [s]: whole periods of either mains."""
_TOGETHER = 256
"""Pieces of which the spectra are computed together."""
_PEAK_RATIO = 4.0
"""Ratio of a tone to the spectrum around it above which it is hum."""
_HIGH_N = 20.0
_REST_S = 0.2
_PRESSED_SHARE = 0.8
_MOVED_SHARE = 0.1
"""Start and motion of a reversed signal, as shares of the way from no force to `_HIGH_N`."""


def hum_warnings(volts: Array, rate_hz: float) -> Iterator[str]:
    """Warn of mains hum that is stronger than in the signals of the fit."""
    size = round(_PIECE_S * rate_hz)
    pieces = volts[: len(volts) // size * size].reshape(-1, size)
    if len(pieces) < 2:
        return

    parts = [
        _measure_low_tones(part)
        for part in np.split(pieces, range(_TOGETHER, len(pieces), _TOGETHER))
    ]
    spectrum_v = np.median(np.concatenate(parts), axis=0)  # a slip passes, hum stays

    for hertz in _MAINS_HZ:
        place = round(hertz * size / rate_hz)
        around_v = float(np.median(spectrum_v[[place - 4, place - 3, place + 3, place + 4]]))
        if spectrum_v[place] > max(MAX_HUM_V, _PEAK_RATIO * around_v):
            yield (
                f"hum of {1000 * spectrum_v[place]:.2g} mV RMS at {hertz} Hz, more than the "
                f"{1000 * MAX_HUM_V:g} mV "
                "that the detectors were tried in: slip is found late or not at all, or hum taken "
                "for it. Shield the "
                "sensor's cable, or power the board from a battery."
            )


def _measure_low_tones(pieces: Array) -> Array:
    """Measure the tones of each piece up to a little above the mains [V RMS]."""
    size = pieces.shape[1]
    window = np.hanning(size + 1)[:-1]
    spectra = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window)
    highest = round(_PIECE_S * max(_MAINS_HZ)) + 5
    rms_v: Array = np.abs(spectra[:, :highest]) * math.sqrt(2) / window.sum()
    return rms_v


def polarity_warnings(volts: Array, design: Design) -> Iterator[str]:
    """Warn of a voltage that begins as if pressed hard, and then goes towards no force."""
    from fingertip.sim.signal.bridge import Bridge  # noqa: PLC0415

    rest_v, pressed_v = Bridge.of_board(design).voltage_v(np.array([0.0, _HIGH_N])).tolist()
    means = _average(volts, design)
    shares = (means - rest_v) / (pressed_v - rest_v)

    if len(shares) and shares[0] > _PRESSED_SHARE and shares.min() < shares[0] - _MOVED_SHARE:
        yield (
            f"the voltage begins at {means[0]:.3g} V, as under {_HIGH_N:g} N, and goes towards "
            f"the {rest_v:.3g} V of a "
            "sensor without force: is the signal reversed? On this board it "
            f"{'rises' if pressed_v > rest_v else 'falls'} with the force; give the design of the "
            "board that was used."
        )


def preload_warnings(volts: Array, design: Design, detector: str = "") -> Iterator[str]:
    """Warn of a voltage that comes near that of an untouched finger, and not to it."""
    from fingertip.board.analysis.tactile_response import find_tactile_response  # noqa: PLC0415

    response = find_tactile_response(design)
    means = _average(volts, design)

    if len(means):
        preload = response.describe_preload(means.min() if response.rises else means.max())
        if preload:
            yield preload


def _average(volts: Array, design: Design) -> Array:
    """Average over parts that are long enough to tell a rest [V]."""
    width = max(1, round(_REST_S * design.detector.sample_rate_hz))
    means: Array = volts[: len(volts) // width * width].reshape(-1, width).mean(axis=1)
    return means


def noise_warnings(
    learned_v: float | None, design: Design, measured_v: float | None
) -> Iterator[str]:
    """Warn of more noise [V] than `fast` was fitted to, over the design's or a quiet part's."""
    stated_v = _stated_noise_v(design, measured_v)
    if learned_v is not None and learned_v > MAX_NOISE_RATIO * stated_v:
        yield (
            f"fast has learned a noise of {1000 * learned_v:.2g} mV, {learned_v / stated_v:.0f} "
            "times the stated one "
            f"of {1000 * stated_v:.2g} mV: if something slides all the time, no slip is found. "
            f"{_BEGIN} "
            f"Else shield the cable: above {MAX_NOISE_RATIO:g} times, weak slip is missed."
        )


def calibration_warnings(
    noise_v: float,
    before: Detection,
    quiet: slice,
    design: Design,
    part: str,
) -> Iterator[str]:
    """Warn of a quiet part in which something may move, by its noise [V] or a detection."""
    stated_v = _stated_noise_v(design)
    on = before.output.on[quiet]

    if noise_v > MAX_NOISE_RATIO * stated_v:
        yield (
            f"{part} has a noise of {1000 * noise_v:.2g} mV, {noise_v / stated_v:.0f} times the "
            "stated one of "
            f"{1000 * stated_v:.2g} mV, and no slip weaker than that is found: if anything slides "
            "or vibrates there, "
            "choose another part; if all of the recording is like that, shield the cable."
        )
    elif on.any():
        yield (
            f"before the calibration {before.detector} is ON at "
            f"{before.trace.time_s[quiet][on][0]:.4f} s, within "
            f"{part}: if that is slip, it is taken for noise now; choose another part."
        )


def _stated_noise_v(design: Design, measured_v: float | None = None) -> float:
    """Return the stated noise: that of a quiet part, or the design's [V]."""
    return max(measured_v or design.detector.noise_v, FastDetector.min_noise_v(design))


def glitch_warnings(output: DetectorOutput, trace: Trace) -> Iterator[str]:
    """Warn of samples that the detector `fast` took for glitches.

    It reports each from the next sample on.
    """
    if not isinstance(output, FastOutput):
        return

    places = np.flatnonzero(np.diff(output.is_replaced.astype(np.int8), prepend=0) > 0) - 1
    places = np.maximum(places, 0)
    places = places[~output.incipient[places]]  # strong slip may look like it
    if not len(places):
        return

    times = join_words([f"{time_s:.4f}" for time_s in trace.time_s[places[:3]].tolist()])
    more = f" and {len(places) - 3} more times" if len(places) > 3 else ""
    yield (
        f"the signal jumps and is back in the next sample at {times} s{more}: fast takes such "
        "samples for glitches, "
        "and uses the ones before them in their place. Look for a loose contact, or for bytes "
        "that were lost."
    )


_BEGIN = "Begin while nothing moves, or give a rest of the same finger and board with --floors."


def begin_warnings(end_s: float | None) -> Iterator[str]:
    """Warn of a signal that begins in vibration, and rests from a time on [s]."""
    if end_s is not None:
        yield (
            f"the signal begins in more vibration than it rests in: before {end_s:.1f} s it "
            "cannot be told whether "
            f"something slips. {_BEGIN}"
        )


# Warnings of thresholds and settings that are permitted but degrade a detector.

HIGH_RATIO = 3.0
"""Ratio to the noise-derived threshold above which a lower one is advised."""
CLEAR_DEVIATIONS = 4.0
"""Deviations above the mean noise level below which noise soon turns a detector ON."""


def threshold_warnings(
    threshold_v: float, level: NoiseLevel, may_be_lower: bool = True
) -> Iterator[str]:
    """Warn of a threshold that lies within the noise, or far above it."""
    if threshold_v < level.mean_v + CLEAR_DEVIATIONS * level.deviation_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is within the noise, which crosses it "
            "repeatedly (mean level "
            f"{level.mean_v:.3g} V, standard deviation {level.deviation_v:.2g} V); the "
            "noise-derived threshold is "
            f"{level.threshold_v:.3g} V."
        )
    elif may_be_lower and threshold_v > HIGH_RATIO * level.threshold_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is "
            f"{threshold_v / level.rounded_threshold_v:.0f} times the "
            f"noise-derived threshold: --set detector.threshold_v={level.rounded_threshold_v:g} "
            "detects weaker slip."
        )


MIN_CUTOFF_HZ = 45.0
"""Cutoff below which contacts count as slip [Hz]: they lie below 30 Hz (article, III.A)."""
MIN_WINDOW_S = 0.02
"""Window length below which contacts are reported as slip [s] (article, figure 5)."""
TOO_LONG_S = 0.1
"""Window from which a detector is slower than a person [s] (article, fig. 5)."""
COARSE_RATIO = 2.0
"""Ratio of the ADC's step to the noise above which the step hides the noise."""


def settings_warnings(design: Design, detector: str = DEFAULT) -> Iterator[str]:
    """Warn of permitted settings of filter, ADC or window that degrade a detector."""
    settings = design.detector
    cutoff = design.board.cutoff_hz

    if cutoff < MIN_CUTOFF_HZ:
        yield (
            f"board.cutoff_hz of {cutoff:g} Hz passes contacts and changes of grip, which are "
            "then reported as slip; "
            f"choose at least {MIN_CUTOFF_HZ:g} Hz (article: 67 Hz)."
        )

    step = settings.adc_step_v
    if step > COARSE_RATIO * settings.noise_v > 0.0:
        yield (
            f"detector.adc_bits of {settings.adc_bits} over {settings.adc_range_text} gives steps "
            f"of {1000 * step:.3g} mV, which hide the noise of {1000 * settings.noise_v:.3g} mV: "
            "weak slip is not detected, and single steps resemble slip. "
            "Choose more bits or a smaller detector.adc_range_v."
        )

    window_s = settings.window_samples / settings.sample_rate_hz
    has_window = find_detector_type(detector).has_design_threshold
    if has_window and not MIN_WINDOW_S <= window_s < TOO_LONG_S:
        if window_s < MIN_WINDOW_S:
            effect = f"below {1000 * MIN_WINDOW_S:g} ms contacts are reported as slip"
        else:
            effect = (
                f"from {1000 * TOO_LONG_S:g} ms on slip is reported, and its end too, later than "
                "a person responds"
            )

        yield (
            f"detector.window_samples of {settings.window_samples} at "
            f"{settings.sample_rate_hz:g} Hz is {1000 * window_s:.3g} ms; "
            f"{effect}. Choose {round(0.03 * settings.sample_rate_hz)} samples for 30 ms."
        )
