"""Threshold that a detector used on a trace: of what quantity, and how far it moved. One source for every output."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.slip.detectors.detector import DetectorOutput
from fingertip.slip.detectors.registry import find_detector_type


@dataclass(frozen=True)
class UsedThreshold:
    """Threshold in use, by the detector and over time."""

    quantity: str
    """Quantity of the detector that it applies to."""
    first_on_v: float | None
    """Threshold where the detector turns ON first [V]; None if it stays OFF."""
    last_v: float
    """Threshold at the end [V]."""
    lowest_v: float
    """Lowest threshold of the whole trace [V]."""
    highest_v: float
    """Highest threshold of the whole trace [V]."""

    @classmethod
    def of(cls, detector: str, output: DetectorOutput) -> UsedThreshold:
        """Find the threshold in the output of a detector."""
        used, on = output.threshold_v, np.flatnonzero(output.on)
        first_v = float(used[on[0]]) if len(on) else None
        quantity = find_detector_type(detector).quantity
        return cls(quantity, first_v, float(used[-1]), float(np.nanmin(used)), float(np.nanmax(used)))

    @property
    def adapts(self) -> bool:
        """True if it follows the noise."""
        return self.highest_v - self.lowest_v > 1e-9 * self.highest_v

    def describe(self) -> str:
        """Describe it for people, such as ``threshold 0.186 to 0.374 mV, 0.186 at the first ON``."""
        if not self.adapts:
            return f"threshold {1000 * self.highest_v:.3g} mV"
        span = f"{1000 * self.lowest_v:.3g} to {1000 * self.highest_v:.3g} mV"
        return f"threshold {span}" + (
            "" if self.first_on_v is None else f", {1000 * self.first_on_v:.3g} at the first ON"
        )
