"""A sweep's rows as columns: what maps, plots and exports read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Status: TypeAlias = Literal["ok", "refused", "failed", "timeout"]
STATUSES: tuple[Status, ...] = ("ok", "refused", "failed", "timeout")
"""ok: computed; refused: the design breaks a rule, which is a result; failed: an error, or the worker died; timeout:
took longer than the sweep's limit."""


@dataclass(frozen=True, eq=False)
class Table:
    """Rows in order of their points; all columns are of one length n."""

    point: NDArray[np.int64]
    """(n,) number of the point in its plan; points without a row yet are left out."""
    axes: dict[str, NDArray[Any]]
    """Swept parameter, dotted (`skin.width_mm`, `scene.slide.speed_m_s`) -> (n,) values: float, int, bool or str."""
    outputs: dict[str, NDArray[np.float64]]
    """Output, its unit in the name -> (n,); NaN where it was not computed, infinite where it has no bound (the delay of
    slips of which fewer than half were found)."""
    status: NDArray[np.str_]
    """(n,) of `STATUSES`."""
    field: NDArray[np.str_]
    """(n,) the parameter a refusal blames first; of a row that is ok, the first check that failed; "" otherwise."""
    reason: NDArray[np.object_]
    """(n,) of str: why a row is not ok, or what its checks found, as sentences; "" otherwise."""

    def __len__(self) -> int:
        return len(self.point)
