"""Fit of a finger: derived parameters move until all rules pass."""

from __future__ import annotations

from collections.abc import Callable, Collection

from fingertip.design.fit import Fit, fit_design
from fingertip.design.geometry import DesignTables


def fit_finger(
    tables: DesignTables,
    given: Collection[str] = (),
    before: DesignTables | None = None,
    progress: Callable[[float], None] = lambda share: None,
    guessed: Collection[str] = (),
) -> Fit:
    """Fit a design as `fit_design` does. Raises DesignError."""
    return fit_design(tables, given, before, progress=progress, guessed=guessed)
