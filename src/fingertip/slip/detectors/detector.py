"""Interface that all detectors share: samples in, statistic, threshold and ON out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fingertip.design import Design
    from fingertip.foundation.numerics import Array


@dataclass(frozen=True, eq=False)
class DetectorOutput:
    """Output of a detector: one value per input sample."""

    statistic_v: Array
    """Quantity that the detector compares with its threshold, in
    the input's unit (volts for a voltage).
    """
    threshold_v: Array
    """Threshold at each sample, in the same unit."""
    on: NDArray[np.bool_]


class Detector(ABC):
    """Causal detector that keeps its state between chunks of samples.

    The output has the same bits however the input is divided into chunks. The state can be pickled
    between any two chunks.
    """

    _threshold_v: float
    memory_s: float
    """Longest time that ON outlasts the slip that caused it,
    because its samples are still averaged [s].
    """

    @classmethod
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> Detector:
        """Create it for a design, a noise [V] (None: the design's) and a factor of the threshold.

        Raises TraceError.
        """
        raise NotImplementedError

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: Array) -> float:
        """Compute the white noise for which its threshold exceeds
        a quiet signal as its rule requires [V].
        """
        raise NotImplementedError

    @staticmethod
    def min_noise_v(design: Design) -> float:
        """Smallest noise of a voltage that is taken for stated [V]."""
        return 0.0

    @property
    def threshold_v(self) -> float:
        """Threshold in noise alone, while the force is constant [V]."""
        return self._threshold_v

    @abstractmethod
    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        """Process the next samples [V], any number of them, and return one output per sample."""

    def step(self, voltage_v: float) -> bool:
        """Process one sample [V] and return whether slip is ON;
        some detectors do so without arrays.
        """
        return bool(self.process([voltage_v]).on[0])
