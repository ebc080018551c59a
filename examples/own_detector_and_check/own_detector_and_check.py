"""A slip detector and a check of parts that fingertip finds by the entry points in
pyproject.toml.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from fingertip.cad.verification.check import Check, Solids
from fingertip.design import Design
from fingertip.slip.detectors.detector import Detector, DetectorOutput
from fingertip.slip.detectors.noise_and_threshold import input_noise_v
from fingertip.slip.detectors.registry import DetectorType

MEAN_S = 0.01
NOISE_RATIO = 2.5
"""Time over which the energy is averaged [s], and ratio of the threshold to the noise."""
MAX_BONE_G = 20.0


class ChangeDetector(Detector):
    """RMS change from one sample to the next, which vibration raises and a slow force does not."""

    memory_s = 5.0 * MEAN_S

    def __init__(self, design: Design, noise_v: float, threshold_scale: float) -> None:
        self._threshold_v = NOISE_RATIO * threshold_scale * noise_v
        self._share = 1.0 / (MEAN_S * design.detector.sample_rate_hz)
        self._energy = 0.0
        self._last_v = math.nan

    @classmethod
    def for_design(
        cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
    ) -> Detector:
        return cls(design, input_noise_v(design) if noise_v is None else noise_v, threshold_scale)

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: np.ndarray) -> float:
        return float(np.sqrt(np.mean(np.diff(quiet_v) ** 2) / 2.0))

    def process(self, voltage_v: Iterable[float]) -> DetectorOutput:
        statistic = np.array([self._update(float(value)) for value in voltage_v])
        return DetectorOutput(
            statistic, np.full(len(statistic), self._threshold_v), statistic > self._threshold_v
        )

    def _update(self, voltage_v: float) -> float:
        change = 0.0 if math.isnan(self._last_v) else voltage_v - self._last_v
        self._last_v = voltage_v
        self._energy += self._share * (0.5 * change * change - self._energy)
        return math.sqrt(self._energy)


OWN = DetectorType(
    words="own",
    input_column="voltage_v",
    quantity="statistic of own",
    load=lambda: ChangeDetector,
    colour="black",
    marker="x",
)


def check_mass(design: Design, solids: Solids) -> Iterator[Check]:
    if "bone" in solids.parts:
        mass_g = solids["bone"].volume() / 1000.0 * design.strength.material.density_g_cm3
        yield Check(
            "own.bone_mass",
            mass_g,
            MAX_BONE_G,
            "g",
            change=("bone.base_length_mm",),
            source=__name__,
        )
