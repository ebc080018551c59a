"""Stages that say what they need and what they give; only those on the way to the wanted values are run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

Values = dict[str, Any]
C = TypeVar("C")


@dataclass(frozen=True)
class Stage(Generic[C]):
    """One step of a simulation."""

    name: str
    needs: tuple[str, ...]
    gives: tuple[str, ...]
    run: Callable[[C, Mapping[str, Any]], Values]
    """From the context and what it needs, to what it gives; may add "evaluations", of its right side."""
    states: int = 0
    """How many states it integrates."""


@dataclass(frozen=True)
class Ran:
    """What a stage took."""

    name: str
    states: int
    evaluations: int
    cpu_s: float


def on_the_way(stages: Sequence[Stage[C]], wanted: Iterable[str]) -> list[Stage[C]]:
    """The stages that the wanted values need, in an order in which they can run.

    Raises
    ------
    KeyError
        If nothing gives a value, or the stages need each other.
    """
    giver = {value: stage for stage in stages for value in stage.gives}
    order: list[Stage[C]] = []
    open_stages: list[str] = []

    def visit(value: str) -> None:
        stage = giver[value]
        if stage in order:
            return
        if stage.name in open_stages:
            raise KeyError(f"{stage.name} needs itself")
        open_stages.append(stage.name)
        for need in stage.needs:
            visit(need)
        order.append(stage)

    for value in wanted:
        visit(value)
    return order


def run(
    stages: Sequence[Stage[C]], context: C, wanted: Iterable[str], progress: Callable[[str], None] | None = None
) -> tuple[Values, list[Ran]]:
    """Run what is needed for the wanted values; returns all values made, and what each stage took.

    `progress` is told the name of each stage before it runs.
    """
    values: Values = {}
    ran = []
    for stage in on_the_way(stages, wanted):
        if progress:
            progress(stage.name)
        start = time.process_time()
        made = stage.run(context, {name: values[name] for name in stage.needs})
        count = int(made.pop("evaluations", 0))
        values.update({name: made[name] for name in stage.gives})
        ran.append(Ran(stage.name, stage.states, count, time.process_time() - start))
    return values, ran
