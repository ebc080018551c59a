"""The detector `analog` behind the design's board, which is simulated: raw voltage in, ON or OFF out."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fingertip.design import Design
from fingertip.sim.electronics.board_output import BoardStream
from fingertip.slip.detectors.analog import AnalogDetector
from fingertip.slip.detectors.detector import DetectorOutput


class BoardDetector:
    """A detector like those of `fingertip.slip`, with its state: any chunks give the same bits, nothing looks ahead.

    Parameters
    ----------
    design
        Its board, converter, window and threshold.
    """

    def __init__(self, design: Design) -> None:
        self._board, self._window = BoardStream(design), AnalogDetector.from_design(design)

    @property
    def threshold_v(self) -> float:
        """Mean of the envelope above which slip is ON [V]."""
        return self._window.threshold_v

    @property
    def memory_s(self) -> float:
        """The window [s]."""
        return self._window.memory_s

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        """Take the next samples of the tactile voltage [V], any number of them, and return as many outputs."""
        samples = np.asarray(voltage_v if isinstance(voltage_v, np.ndarray) else list(voltage_v), dtype=np.float64)
        return self._window.process(self._board.process(samples[None])[0] if len(samples) else samples)

    def step(self, voltage_v: float) -> bool:
        """Take one sample [V] and return whether slip is ON."""
        return self._window.step(float(self._board.process(np.array([[voltage_v]]))[0, 0]))
