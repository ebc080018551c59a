"""Cost of each stage of a simulation: integrated states, evaluations of right-hand sides, CPU time."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass

STAGES = (
    "load", "hand", "object", "disturbances", "carriage", "friction", "coupled contact", "profile", "contact", "force",
    "sensor", "bridge", "interference", "ADC", "board noise", "filter board", "comparator", "ADC of the envelope",
    "ADC of the filtered signal", "no motion", "slip", "shear",
)  # fmt: skip
"""Names of all stages, in the order from hand to voltages. Each finger of a hand adds to the same stages."""


@dataclass(frozen=True)
class StageCost:
    """Cost of one stage in one run."""

    name: str
    """Name of the stage."""
    states: int
    """Number of integrated states."""
    evaluations: int
    """Number of evaluations of the right-hand side."""
    cpu_s: float
    """CPU time [s]."""


class CostMeter:
    """Sum of the cost of each stage over all chunks. A stage that never ran is not listed."""

    def __init__(self) -> None:
        self._costs: dict[str, StageCost] = {}

    @contextlib.contextmanager
    def stage(self, name: str, states: int = 0, evaluations: int = 0) -> Iterator[None]:
        """Measure one run of a stage."""
        start = time.process_time()
        yield
        self.add(StageCost(name, states, evaluations, time.process_time() - start))

    def add(self, cost: StageCost) -> None:
        """Add the cost of one run of a stage."""
        assert cost.name in STAGES
        before = self._costs.get(cost.name, StageCost(cost.name, 0, 0, 0.0))
        self._costs[cost.name] = StageCost(
            cost.name, cost.states, before.evaluations + cost.evaluations, before.cpu_s + cost.cpu_s
        )

    @property
    def costs(self) -> tuple[StageCost, ...]:
        """Costs of the stages that ran, in the order of `STAGES`."""
        return tuple(self._costs[name] for name in STAGES if name in self._costs)
