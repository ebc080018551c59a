"""Table of `fast`: small decision trees that tell a blow, a servo's step or a set-down from slip.

`tools/detector_training` fits it. Every tree is complete, so that an evaluation takes the same
number of comparisons for every signal.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

TABLE = "fast_table.json"
DEPTH = 4
"""Comparisons of one tree."""
NODES = (1 << DEPTH) - 1
"""Comparisons that a tree stores."""
ALWAYS_LEFT = 3e38
"""Threshold of a node below which a tree does not branch."""


@dataclass(frozen=True, eq=False)
class BlowTable:
    """Trees: the branches of node k are nodes 2 k + 1 and 2 k + 2; the leaves follow the nodes."""

    features: NDArray[np.int64]
    """(trees, `NODES`): number of the feature that each node compares."""
    thresholds: NDArray[np.float32]
    """(trees, `NODES`): value above which the second branch is taken."""
    leaves: NDArray[np.float32]
    """(trees, `NODES` + 1): log odds that a leaf adds."""
    offset: np.float32
    """Log odds before the first tree."""

    @property
    def trees(self) -> int:
        return len(self.leaves)

    @property
    def numbers(self) -> int:
        """Thresholds, leaves and the offset: what was fitted."""
        return self.thresholds.size + self.leaves.size + 1

    def evaluate(self, row: NDArray[np.float32]) -> np.float32:
        """Log odds of slip for one row of features. The leaves are added in their order."""
        trees = np.arange(self.trees)
        node = np.zeros(self.trees, dtype=np.int64)
        for _ in range(DEPTH):
            is_above = row[self.features[trees, node]] > self.thresholds[trees, node]
            node = 2 * node + 1 + is_above

        terms = np.concatenate(([self.offset], self.leaves[trees, node - NODES]))
        return np.float32(np.add.accumulate(terms, dtype=np.float32)[-1])


NO_TABLE = BlowTable(
    features=np.zeros((0, NODES), dtype=np.int64),
    thresholds=np.zeros((0, NODES), dtype=np.float32),
    leaves=np.zeros((0, NODES + 1), dtype=np.float32),
    offset=np.float32(1.0),
)
"""Table that takes everything for slip."""


@functools.cache
def load_table() -> BlowTable:
    """Load the table of the package."""
    text = resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8")
    return read_table(json.loads(text))


def read_table(data: Mapping[str, Any]) -> BlowTable:
    return BlowTable(
        features=np.array(data["features"], dtype=np.int64).reshape(-1, NODES),
        thresholds=np.array(data["thresholds"], dtype=np.float32).reshape(-1, NODES),
        leaves=np.array(data["leaves"], dtype=np.float32).reshape(-1, NODES + 1),
        offset=np.float32(data["offset"]),
    )


def write_table(table: BlowTable, card: Mapping[str, Any]) -> str:
    """Write a table as JSON, one tree to a line, with a card of what it was fitted to."""
    lines = [
        f'"card": {json.dumps(dict(card))}',
        f'"offset": {_digits(table.offset)}',
        f'"features": {_write_rows(table.features.tolist())}',
        f'"thresholds": {_write_rows(_round_rows(table.thresholds))}',
        f'"leaves": {_write_rows(_round_rows(table.leaves))}',
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _round_rows(values: NDArray[np.float32]) -> list[list[float]]:
    return [[_digits(value) for value in row] for row in values]


def _digits(value: Any) -> float:
    """Round to six digits."""
    return float(f"{float(value):.6g}")


def _write_rows(rows: list[list[Any]]) -> str:
    return "[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]"
