"""Tables made by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fingertip.sweep.rows import Table


def table(
    axes: dict[str, Any], outputs: dict[str, Any], status: ArrayLike, field: Sequence[str], reason: Sequence[str]
) -> Table:
    """A table of these columns, its points counted from 0."""
    columns = {name: np.asarray(column) for name, column in axes.items()}
    figures = {name: np.asarray(column, dtype=float) for name, column in outputs.items()}
    count = len(np.asarray(status))
    return Table(np.arange(count), columns, figures, np.asarray(status), np.asarray(field), np.asarray(reason))
