"""Errors of what the program states, and what stating it costs: declared once, in
`stated_errors.csv`.

They are differences from better computations, not from a real finger: docs/limitations.md tells
those.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from fingertip.foundation.tables import load_table, read_rows


@dataclass(frozen=True)
class StatedError:
    """Error of one figure, and the CPU time that stating it takes."""

    key: str
    figure: str
    low: float
    high: float
    """Ends of its error, the figure minus the better one [unit]."""
    unit: str | None
    detail: str | None
    against: str
    """What it was compared with."""
    cpu_s: float

    @property
    def bounds(self) -> str:
        """Return the ends with their unit, and the detail in brackets."""
        ends = f"±{self.high:g}" if self.low == -self.high else f"{self.low:g} to {self.high:+g}"
        unit = f" {self.unit}" if self.unit else ""
        return f"{ends}{unit}" + (f" ({self.detail})" if self.detail else "")

    @property
    def line(self) -> str:
        return (
            f"{self.figure}: {self.bounds}, beside {self.against}; {self.cpu_s:.2g} s of CPU time"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of a report; its key is that of the entry."""
        return {name: value for name, value in asdict(self).items() if name != "key"}


@cache
def load_errors() -> dict[str, StatedError]:
    """Load all rows by their key."""
    rows = read_rows(Path(__file__).with_name("stated_errors.csv"))
    return {row.key: row for row in load_table(StatedError, rows)}


def list_mesh_errors(tolerance_mm: float) -> tuple[StatedError, ...]:
    """List the errors of meshes at a tolerance."""
    errors = load_errors()
    return tuple(
        replace(
            error,
            low=tolerance_mm * error.low,
            high=tolerance_mm * error.high,
            cpu_s=error.cpu_s / math.sqrt(tolerance_mm),
        )
        for error in (errors["facets"], errors["volumes"])
    )


def list_pad_errors(*, bonded: bool) -> tuple[StatedError, ...]:
    """List the errors of what is stated of a pad."""
    keys = ("share", "turn_on") if bonded else ("share_lying", "turn_on_lying")
    return tuple(load_errors()[key] for key in keys)


def find_volume_error_mm3(tolerance_mm: float, area_mm2: float) -> float:
    """Return the bound of the error of a mesh's volume."""
    return load_errors()["volumes"].high * tolerance_mm * area_mm2


def to_entries(errors: Iterable[StatedError]) -> dict[str, dict[str, Any]]:
    """Return the section `errors` of a report."""
    return {error.key: error.to_dict() for error in errors}
