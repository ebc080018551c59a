"""Stages with declared inputs and outputs. Only the stages that the requested values depend on are run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

Values = dict[str, Any]
C = TypeVar("C")


@dataclass(frozen=True)
class Stage(Generic[C]):
    """One stage of the simulation pipeline."""

    name: str
    """Name for reports and progress."""
    needs: tuple[str, ...]
    """Names of the values it reads."""
    provides: tuple[str, ...]
    """Names of the values it computes."""
    run: Callable[[C, Mapping[str, Any]], Values]
    """Function from the context and the needed values to the provided values. It may add "evaluations", the number of
    evaluations of its right-hand side."""
    states: int = 0
    """Number of states it integrates."""


@dataclass(frozen=True)
class StageStats:
    """Cost of one stage in one run."""

    name: str
    """Name of the stage."""
    states: int
    """Number of integrated states."""
    evaluations: int
    """Number of evaluations of the right-hand side."""
    cpu_s: float
    """CPU time [s]."""


def select_stages(stages: Sequence[Stage[C]], requested: Iterable[str]) -> list[Stage[C]]:
    """Return the stages that the requested values depend on, in an order in which they can run.

    Raises
    ------
    KeyError
        If no stage provides a value, or stages depend on each other in a cycle.
    """
    provider = {value: stage for stage in stages for value in stage.provides}
    order: list[Stage[C]] = []
    pending: list[str] = []

    def visit(value: str) -> None:
        stage = provider[value]
        if stage in order:
            return
        if stage.name in pending:
            raise KeyError(f"{stage.name} needs itself")
        pending.append(stage.name)
        for need in stage.needs:
            visit(need)
        order.append(stage)

    for value in requested:
        visit(value)
    return order


def run_stages(
    stages: Sequence[Stage[C]], context: C, requested: Iterable[str], progress: Callable[[str], None] | None = None
) -> tuple[Values, list[StageStats]]:
    """Run the stages that the requested values depend on.

    Parameters
    ----------
    stages
        All stages.
    context
        First argument of every stage.
    requested
        Names of values.
    progress
        Receives a line with the name of each stage before it runs.

    Returns
    -------
    tuple
        All computed values, and the cost of each stage.
    """
    values: Values = {}
    stats = []
    for stage in select_stages(stages, requested):
        if progress:
            progress(f"simulating: {stage.name}")
        start = time.process_time()
        computed = stage.run(context, {name: values[name] for name in stage.needs})
        count = int(computed.pop("evaluations", 0))
        values.update({name: computed[name] for name in stage.provides})
        stats.append(StageStats(stage.name, stage.states, count, time.process_time() - start))
    return values, stats
