"""The one face of all detectors: samples in, a level, a bar and ON or OFF out, whatever the chunks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array


@dataclass(frozen=True, eq=False)
class Output:
    """One value per input sample."""

    level_v: Array
    """What the detector looks at, in the input's unit (volts for a voltage)."""
    bar_v: Array
    """What the level is held against."""
    on: NDArray[np.bool_]


class Detector(Protocol):
    """A causal detector with its state.

    The output does not depend on how the input is cut into chunks, to the last bit, and the state can be pickled
    between any two.
    """

    @property
    def threshold_v(self) -> float:
        """The bar in noise alone."""
        ...

    @property
    def memory_s(self) -> float:
        """How long ON may outlast the slip that caused it: the time the detector still rests on its samples [s]."""
        ...

    def process(self, voltage_v: Iterable[float]) -> Output:
        """Take the next samples, any number of them, and return as many outputs."""
        ...

    def step(self, voltage_v: float) -> bool:
        """Take one sample and return whether slip is ON: `process` without its arrays."""
        ...


def as_samples(voltage_v: Iterable[float]) -> list[float] | Array:
    """Samples as the loops take them."""
    return voltage_v if isinstance(voltage_v, np.ndarray) else list(voltage_v)
