"""Detector `fast`: short-time energies over a learned noise floor, beside the slow force, judged by
small trees.

A contact, a release, a change of grip and a knock leave energy in the band of slip, as slip does.
What distinguishes them is the slow force: it changes much for the energy it leaves, and one way,
and the energy of a knock decays. The detector computes features that express this
(`fast_coefficients.FEATURES`), and a sum of small decision trees weighs them. The trees were fitted
to simulated slips and to a wider mix of what is not slip (`tools/detector_training/`).

A board for a controller gives its filtered signal beside the tactile voltage. Ahead of the
converter it is amplified, so that the converter's steps and noise hardly count in it. The energies
then come from this signal, and the slow force from the tactile voltage. Where a stage of the board
is at its limit, and on boards without that signal, the same filter is computed from the tactile
voltage instead.

Every feature is relative: to the noise floors, which the detector learns, or to another feature. So
the unit of the input does not matter, and the stated noise hardly does. docs/detector.md says when
the floors learn and the flags end.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation.jit import as_samples
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors import fast_coefficients, fast_settings, fast_state
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.fast_loop import LOOP
from fingertip.slip.detectors.fast_settings import (
    FILTERS_SETTLE_S,
    LONG_S,
    SETTLING_S,
    STAY_RATIO,
    STAY_SCORE,
    FastSettings,
)
from fingertip.slip.detectors.fast_state import COUNT


@dataclass(frozen=True)
class Floors:
    """Floors that a detector has learned while its signal rested,
    stored for a start in which nothing rests [V^2].
    """

    wide: float
    upper: float
    tactile: float


@dataclass(frozen=True, eq=False)
class FastOutput(DetectorOutput):
    """Output of the detector: one value per input sample."""

    filtered_v: Array
    """Wide band [V]."""
    confidence: Array
    """Statistic over threshold: from 1 on, slip turns ON."""
    incipient: NDArray[np.bool_]
    """True if slip may have begun: earlier than `on`, with more
    false alarms, and true as long as `on` is.
    """
    is_replaced: NDArray[np.bool_]
    """True for 50 ms after a sample that was no voltage, or a
    glitch: the last one was used in its place.
    """
    is_outside: NDArray[np.bool_]
    """True while the tactile voltage is one that no force gives: an
    open wire, a shorted sensor, or too much force.
    """


class FastDetector(Detector):
    """Fast detector with its state. It starts in the steady state of the first sample."""

    memory_s = math.log(1 / (fast_state.DECAY_RATIO * STAY_RATIO)) * LONG_S
    """Time until an abrupt end is recognised [s]: by the ratio of the
    energies or, after a weak slip, the floor.
    """

    def __init__(
        self,
        settings: FastSettings,
        model: fast_coefficients.FastModel | None = None,
        floors: Floors | None = None,
    ) -> None:
        self.settings = settings
        self.stored_floors = floors
        self._model = model = model or fast_coefficients.load_model()
        self.coefficients = fast_settings.compute_coefficients(settings, model, with_filtered=False)
        """Constants of the loop at this sampling rate and noise."""
        self._state = [0.0] * fast_state.STATES
        self._state[fast_state.FLOOR] = self.coefficients.wide_share * settings.noise_v**2
        self._state[fast_state.PHASE] = float(settings.phase % int(self.coefficients.tick_samples))
        self._started = False

    @classmethod
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> FastDetector:
        return cls(
            replace(FastSettings.from_design(design, noise_v), threshold_scale=threshold_scale)
        )

    @property
    def state(self) -> tuple[float, ...]:
        """Present state, by the indices of `fingertip.slip.detectors.fast_state`."""
        return tuple(self._state)

    @property
    def floors(self) -> Floors:
        """Floors that were learned, for the next start of a detector of the same inputs."""
        return Floors(
            *(
                self._state[at]
                for at in (fast_state.FLOOR, fast_state.UPPER_FLOOR, fast_state.INPUT_FLOOR)
            )
        )

    @property
    def threshold_v(self) -> float:
        """Threshold above the present noise floor, as a voltage in the wide band [V]."""
        return self.coefficients.statistic_gain * math.sqrt(self._state[fast_state.FLOOR])

    @property
    def noise_v(self) -> float:
        """White RMS noise that has the energy of the learned wide
        floor, which lies below the mean [V].
        """
        return math.sqrt(self._state[fast_state.FLOOR] / self.coefficients.wide_share)

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: Array) -> float:
        """Compute the white RMS noise that has as much energy in the
        bands as these samples of a quiet signal [V].
        """
        rate = design.detector.sample_rate_hz
        responses = fast_coefficients.design_filters(rate).impulse_responses(
            round(4 * rate / fast_coefficients.LOW_HZ)
        )
        return max(
            math.sqrt(float(np.mean(np.convolve(quiet_v - quiet_v[0], h, "valid") ** 2)) / energy)
            for h, energy in zip(responses, fast_coefficients.noise_energies(rate), strict=True)
        )

    @staticmethod
    def min_noise_v(design: Design) -> float:
        """Smallest noise that is taken for stated, where the input is in volts [V]."""
        return fast_settings.min_noise_v(design.detector.sample_rate_hz)

    def process(
        self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None = None
    ) -> FastOutput:
        return self._run(voltage_v, filtered_v, np.zeros(COUNT), 0)

    def select(self, output: FastOutput) -> FastOutput:
        """Return the output of a detector `fast` at this operating point."""
        return output

    def is_off_beyond(self, output: FastOutput) -> bool:
        """Return whether a greater threshold would give no ON either, because nothing here came
        near this one.

        Every threshold grows with the scale, and until a score exceeds one of them no state depends
        on it.
        """
        return self.coefficients.stay_threshold == STAY_SCORE and not output.incipient.any()

    def compute_features(
        self, voltage_v: Array, filtered_v: Array | None = None
    ) -> tuple[FastOutput, Array]:
        """Process samples and return the output and the features of every tick, (ticks,
        features).
        """
        ticks = len(voltage_v) // int(self.coefficients.tick_samples)
        rows = np.zeros((ticks + 1) * COUNT)
        output = self._run(voltage_v, filtered_v, rows, COUNT)

        return output, rows[: ticks * COUNT].reshape(ticks, COUNT)

    def step(self, voltage_v: float, filtered_v: float | None = None) -> bool:
        """Process one sample of the tactile voltage, and of the
        filtered signal if given [V]; return if slip is ON.
        """
        self._start(voltage_v, filtered_v)
        m = self._model
        filtered = (voltage_v if filtered_v is None else filtered_v,)
        LOOP.plain(
            self.coefficients,
            *m.lists,
            0,
            (voltage_v,),
            filtered,
            self._state,
            [0.0] * COUNT,
            [0.0],
            [0.0],
            [0.0],
            [0.0],
        )

        return self._state[fast_state.ON] > 0.0

    def _run(
        self,
        voltage_v: Iterable[float],
        filtered_v: Iterable[float] | None,
        rows: Array,
        stride: int,
    ) -> FastOutput:
        samples = as_samples(voltage_v)
        filtered = samples if filtered_v is None else as_samples(filtered_v)
        if len(samples):
            self._start(float(samples[0]), None if filtered_v is None else float(filtered[0]))

        out: Array = np.zeros((4, len(samples)))
        m = self._model
        LOOP(
            self.coefficients,
            m.features,
            m.thresholds,
            m.leaves,
            stride,
            samples,
            filtered,
            self._state,
            rows,
            *out,
        )
        wide, confidence, level, flags = out
        bits = flags.astype(np.int8)
        on, incipient, is_replaced, is_outside = (
            np.asarray(bits & int(flag) > 0)
            for flag in (
                fast_state.IS_ON,
                fast_state.IS_INCIPIENT,
                fast_state.IS_REPLACED,
                fast_state.IS_OUTSIDE,
            )
        )

        return FastOutput(
            statistic_v=confidence * level,
            threshold_v=level,
            on=on,
            filtered_v=wide,
            confidence=confidence,
            incipient=incipient,
            is_replaced=is_replaced,
            is_outside=is_outside,
        )

    def _start(self, voltage_v: float, filtered_v: float | None) -> None:
        """Take the first sample for constant inputs until then: there
        is no difference, and nothing in the bands.
        """
        if self._started:
            return

        self._started = True
        settings = self.settings
        state = self._state
        with_filtered = filtered_v is not None and settings.filtered is not None
        self.coefficients = c = fast_settings.compute_coefficients(
            settings, self._model, with_filtered
        )
        state[fast_state.INPUT] = voltage_v if abs(voltage_v) <= c.number_limit else 0.0
        state[fast_state.MEAN_SCORE] = c.lowest_score
        state[fast_state.STEP] = state[fast_state.FILTERED_STEP] = math.inf
        state[fast_state.REST] = (
            filtered_v if filtered_v is not None and abs(filtered_v) <= c.number_limit else 0.0
        )
        state[fast_state.LEVEL] = state[fast_state.REST]
        state[fast_state.STILL] = c.still_samples  # until it changes for the first time
        state[fast_state.MEAN_MOVE] = c.filtered_jump_limit  # noise that may be as great as stated
        # Energies and floors start at those of the stated noise.
        band_noise_v = fast_settings.band_noise_v(settings, with_filtered)
        wide = c.wide_share * band_noise_v**2
        upper = c.upper_share * band_noise_v**2

        for index in (
            fast_state.WIDE_SHORT,
            fast_state.WIDE_LONG,
            fast_state.WIDE_MEAN,
            fast_state.FLOOR,
        ):
            state[index] = wide

        for index in (
            fast_state.UPPER_SHORT,
            fast_state.UPPER_LONG,
            fast_state.UPPER_MEAN,
            fast_state.UPPER_FLOOR,
        ):
            state[index] = upper

        for index in (fast_state.INPUT_LONG, fast_state.INPUT_FLOOR):
            state[index] = settings.noise_v**2

        ticks_per_s = settings.sample_rate_hz / c.tick_samples
        if self.stored_floors:  # only the filters must settle
            state[fast_state.FLOOR] = max(self.stored_floors.wide, c.min_floor)
            state[fast_state.UPPER_FLOOR] = max(self.stored_floors.upper, c.min_upper_floor)
            state[fast_state.INPUT_FLOOR] = max(self.stored_floors.tactile, c.min_input_floor)
            state[fast_state.SETTLING] = float(round(FILTERS_SETTLE_S * ticks_per_s))
            state[fast_state.FLOOR_TICKS] = c.max_floor_ticks
            return

        state[fast_state.SETTLING] = float(round(SETTLING_S * ticks_per_s))
        state[fast_state.FLOOR_TICKS] = -float(round(FILTERS_SETTLE_S * ticks_per_s))


class IncipientDetector(FastDetector):
    """Detector `fast` at its early operating point: ON from the first signs of slip."""

    def process(
        self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None = None
    ) -> FastOutput:
        return self.select(super().process(voltage_v, filtered_v))

    def select(self, output: FastOutput) -> FastOutput:
        return replace(output, on=output.incipient)

    def step(self, voltage_v: float, filtered_v: float | None = None) -> bool:
        super().step(voltage_v, filtered_v)
        return self._state[fast_state.INCIPIENT] > 0.0
