"""Trained part of the detector `fast`: a sum of small decision trees, read from a table.

`tools/detector_training/` fits the trees to simulated slips and to the wider mix of what is not slip, and writes the
table. Every tree is complete: it compares one feature with one threshold at each of its `DEPTH` levels. An evaluation
therefore takes the same number of comparisons for every input.
"""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from importlib import resources

import numpy as np

from fingertip.arrays import Array

TABLE = "fast_model.json"
"""Name of the table, beside this module."""
DEPTH = 4
"""Comparisons of one tree."""
NODES = (1 << DEPTH) - 1
"""Comparisons that a tree stores."""
FEATURES = (
    "upper energy, 6 ms",
    "upper energy, 20 ms",
    "wide energy, 6 ms",
    "wide energy, 20 ms",
    "greatest slope",
    "change over 100 ms",
    "signed change over 48 ms",
    "net over total movement, 6 ms",
    "upper energy over its peak",
    "wide energy over greatest slope",
    "upper energy over greatest slope",
    "upper over wide energy",
    "total movement, 6 ms",
    "slope over greatest slope",
    "net over total movement, 20 ms",
    "ticks of lasting upper energy",
)
"""Names of the features, in the order of their numbers.

All but the last are squares or ratios of squares. The first seven and the thirteenth are relative to the learned noise,
so no feature depends on the unit of the input. "Greatest" and "peak" are those of the last 80 to 120 ms."""


@dataclass(frozen=True, eq=False)
class FastModel:
    """Trees, flattened: node k of tree t stands at ``t * NODES + k``; its branches are nodes 2 k + 1 and 2 k + 2."""

    features: Array
    """Number of the feature that each node compares."""
    thresholds: Array
    """Value above which the second branch is taken."""
    leaves: Array
    """Values of the leaves, `NODES` + 1 for each tree."""
    offset: float
    """Score before the first tree."""
    threshold: float
    """Score above which slip is ON, in the stated noise."""
    noise_rise: float
    """Rise of this threshold in more noise."""
    incipient_threshold: float
    """Score above which slip may begin."""

    @functools.cached_property
    def lists(self) -> tuple[list[float], list[float], list[float]]:
        """Features, thresholds and leaves as lists, which plain Python reads fastest."""
        return self.features.tolist(), self.thresholds.tolist(), self.leaves.tolist()

    @property
    def trees(self) -> int:
        """Number of trees."""
        return len(self.leaves) // (NODES + 1)


@functools.cache
def load_model() -> FastModel:
    """Read the table."""
    table = json.loads(resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8"))
    return FastModel(
        np.array(table["features"], dtype=np.float64),
        np.array(table["thresholds"], dtype=np.float64),
        np.array(table["leaves"], dtype=np.float64),
        table["offset"],
        table["threshold"],
        table["noise_rise"],
        table["incipient_threshold"],
    )
