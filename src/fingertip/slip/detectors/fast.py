"""Detector `fast`: the article's filter and envelope, with a floor that it learns and a veto for
blows.

    samples -> checks -> high-pass filter -> rectifier, means of 32 and 48 ms
                                          -> energies in five bands, 4 ms each
    floor   <- what is no slip
    incipient: a mean crosses a multiple of the floor
    on:        the table of small trees does not veto it as a blow, a servo's step or a set-down

`fast_inputs` checks and filters, `fast_decision` decides, `fast_features` and `fast_table` make up
the veto. docs/detector.md says what it finds, and when.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.fast_decision import (
    LONG_TICKS,
    QUANTILE_RATIO,
    Decisions,
    FastDecision,
    Floors,
)
from fingertip.slip.detectors.fast_inputs import Block, FastInputs, Singles
from fingertip.slip.detectors.fast_settings import (
    NOISE_MEAN,
    TICK_S,
    FastSettings,
    min_noise_v,
    white_energies,
)
from fingertip.slip.detectors.fast_table import BlowTable, load_table

__all__ = ["FastDetector", "FastOutput", "Floors", "IncipientDetector", "collect_rows"]

BLOCK = 1 << 16
"""Samples that are processed at a time."""


@dataclass(frozen=True, eq=False)
class FastOutput(DetectorOutput):
    """Output of the detector: one value per input sample.

    The statistic is the greater of the two means, the threshold a multiple of the floor.
    """

    filtered_v: Array
    """Vibration behind the high-pass filter, at its input's scale [V]."""
    incipient: NDArray[np.bool_]
    """True if slip may have begun: earlier than `on`, with more false alarms, and true as long as
    `on` is.
    """
    is_replaced: NDArray[np.bool_]
    """True for 50 ms after a sample that was no voltage, or a glitch: the last one was used in its
    place.
    """
    is_outside: NDArray[np.bool_]
    """True while the tactile voltage is one that no force gives: an open wire, a shorted sensor, or
    too much force.
    """


class FastDetector(Detector):
    """Fast detector with its state. It starts in the steady state of the first sample."""

    memory_s = (LONG_TICKS + 8) * TICK_S
    """Time until an abrupt end is recognised [s]: the longer mean must have left the slip, and what
    the filters kept of it.
    """

    def __init__(
        self,
        settings: FastSettings,
        table: BlowTable | None = None,
        floors: Floors | None = None,
    ) -> None:
        self.settings = settings
        self.stored_floors = floors
        self._table = table or load_table()
        self._inputs: FastInputs | None = None
        self._decision = FastDecision(settings, self._table, with_filtered=False, floors=floors)
        self._waiting = list[tuple[float, float | None]]()
        self._taken = settings.phase
        self._incipient = False
        self._on = False
        self._statistic_v = np.float32(0.0)
        self._threshold_v = self._decision.threshold_v

    @classmethod
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> FastDetector:
        settings = FastSettings.from_design(design, noise_v)
        return cls(replace(settings, threshold_scale=threshold_scale))

    @property
    def floors(self) -> Floors:
        """Floors that were learned, for the next start of a detector of the same inputs."""
        return self._decision.floors

    @property
    def noise_v(self) -> float:
        """White RMS noise whose floor is the learned one [V]."""
        wide = white_energies(self.settings.sample_rate_hz, self.settings.cutoff_hz)[-1]
        return float(self._decision.floor) / (QUANTILE_RATIO * NOISE_MEAN * math.sqrt(wide))

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: Array) -> float:
        """Compute the white RMS noise that vibrates as much as these samples of a rest [V]."""
        settings = FastSettings.from_design(design, 1.0)
        settling = min(len(quiet_v) // 2, settings.samples(0.1))
        vibration = FastInputs(settings, with_filtered=False).process(quiet_v, None).vibration
        wide = white_energies(settings.sample_rate_hz, settings.cutoff_hz)[-1]
        rest = vibration[settling:].astype(np.float64)
        return math.sqrt(float(np.mean(rest * rest)) / wide)

    @staticmethod
    def min_noise_v(design: Design) -> float:
        """Smallest noise that is taken for stated, where the input is in volts [V]."""
        return min_noise_v(design.detector.sample_rate_hz)

    def process(
        self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None = None
    ) -> FastOutput:
        self._take_waiting()
        outputs = [self._process_block(*part) for part in self._divide(voltage_v, filtered_v)]
        return _join(outputs)

    def select(self, output: FastOutput) -> FastOutput:
        """Return the output of a detector `fast` with this flag as its verdict."""
        return output

    def is_off_beyond(self, output: FastOutput) -> bool:
        """Return whether a greater threshold would give no ON either.

        Both thresholds grow with the scale, and no state depends on it before the first crossing.
        """
        return not output.incipient.any()

    def step(self, voltage_v: float, filtered_v: float | None = None) -> bool:
        """Process one sample of the tactile voltage, and of the filtered signal if given [V];
        return if slip is ON.
        """
        self._waiting.append((voltage_v, filtered_v))
        if (self._taken + len(self._waiting)) % self.settings.tick_samples == 0:
            self._take_waiting()

        return self._on

    def _take_waiting(self) -> None:
        """Process the samples of steps: nothing is decided between two ticks, so they wait."""
        if not self._waiting:
            return

        tactile, filtered = zip(*self._waiting, strict=True)
        self._waiting.clear()
        has_filtered = filtered[0] is not None
        self._process_block(_as_array(tactile), _as_array(filtered) if has_filtered else None)

    @property
    def is_incipient(self) -> bool:
        """Whether slip may have begun, at the last sample."""
        return self._incipient

    def _divide(
        self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None
    ) -> Iterator[tuple[Array, Array | None]]:
        """Divide samples into blocks that fit into memory; one empty block if there are none."""
        tactile = _as_array(voltage_v)
        filtered = None if filtered_v is None else _as_array(filtered_v)
        for begin in range(0, max(len(tactile), 1), BLOCK):
            part = slice(begin, begin + BLOCK)
            yield tactile[part], None if filtered is None else filtered[part]

    def _process_block(self, voltage_v: Array, filtered_v: Array | None) -> FastOutput:
        if not len(voltage_v):
            return _empty_output()

        self._taken += len(voltage_v)
        block = self._take(voltage_v, filtered_v)
        decisions = self._decision.process(block.ticks)
        return self._spread(block, decisions)

    def _take(self, voltage_v: Array, filtered_v: Array | None) -> Block:
        """Check and filter a block; the first one tells which inputs there are."""
        if self._inputs is None:
            with_filtered = filtered_v is not None and self.settings.filtered is not None
            self._inputs = FastInputs(self.settings, with_filtered)
            self._decision = FastDecision(
                self.settings, self._table, with_filtered=with_filtered, floors=self.stored_floors
            )

        return self._inputs.process(voltage_v, filtered_v)

    def _spread(self, block: Block, decisions: Decisions) -> FastOutput:
        """Let each decision hold from its tick on until the next."""
        count = len(block.vibration)
        lengths = np.diff(np.concatenate(([0], block.ends, [count])))

        def spread(before: Any, values: NDArray[Any]) -> NDArray[Any]:
            return np.repeat(np.concatenate(([before], values)), lengths)

        output = FastOutput(
            statistic_v=spread(self._statistic_v, decisions.statistic_v).astype(np.float64),
            threshold_v=spread(self._threshold_v, decisions.threshold_v).astype(np.float64),
            on=spread(self._on, decisions.on).astype(bool),
            filtered_v=block.vibration.astype(np.float64),
            incipient=spread(self._incipient, decisions.incipient).astype(bool),
            is_replaced=block.is_replaced,
            is_outside=block.is_outside,
        )
        if len(block.ends):
            self._statistic_v = decisions.statistic_v[-1]
            self._threshold_v = float(decisions.threshold_v[-1])
            self._on = bool(decisions.on[-1])
            self._incipient = bool(decisions.incipient[-1])

        return output


class IncipientDetector(FastDetector):
    """Detector `fast` by its early flag: ON from the first signs of slip."""

    def process(
        self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None = None
    ) -> FastOutput:
        return self.select(super().process(voltage_v, filtered_v))

    def select(self, output: FastOutput) -> FastOutput:
        return replace(output, on=output.incipient)

    def step(self, voltage_v: float, filtered_v: float | None = None) -> bool:
        super().step(voltage_v, filtered_v)
        return self._incipient


def collect_rows(
    detector: FastDetector, voltage_v: Array, filtered_v: Array | None, is_slip: NDArray[np.bool_]
) -> tuple[Singles, NDArray[np.int64]]:
    """Compute the features at all ticks at which the table would be asked, for its training.

    `is_slip` is the truth at each sample; it takes the place of the table.

    Returns:
        (asked, features), and the sample at which each of these ticks ends.
    """
    block = detector._take(_as_array(voltage_v), filtered_v)
    asked = detector._decision.collect(block.ticks, is_slip[block.ends])
    return asked.rows, block.ends[asked.ticks]


def _as_array(values: Iterable[float]) -> Array:
    sized = values if isinstance(values, (np.ndarray, list, tuple)) else list(values)
    return np.asarray(sized, dtype=np.float64)


def _empty_output() -> FastOutput:
    numbers = np.zeros(0)
    flags = np.zeros(0, dtype=bool)
    return FastOutput(
        statistic_v=numbers,
        threshold_v=numbers,
        on=flags,
        filtered_v=numbers,
        incipient=flags,
        is_replaced=flags,
        is_outside=flags,
    )


def _join(outputs: list[FastOutput]) -> FastOutput:
    if len(outputs) == 1:
        return outputs[0]

    columns = {
        name: np.concatenate([getattr(output, name) for output in outputs])
        for name in vars(outputs[0])
    }
    return FastOutput(**columns)
