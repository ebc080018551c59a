"""Tables of the detector's trees as constants of C, in the types that take the least memory."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator

from fingertip.slip.detectors.fast_model import NODES, FastModel

_WIDTH = 116


def render_trees(model: FastModel) -> str:
    """Render the three tables, one paragraph for each tree."""
    return "\n\n".join(
        "\n".join([f"/* {comment} */", f"static const {kind} {name}[{size}] = {{", *_rows(values, row), "};"])
        for comment, kind, name, size, values, row in (
            (
                "Number of the feature that each node compares.",
                "uint8_t",
                "slip_features",
                "SLIP_TREES * NODES",
                [f"{feature:.0f}" for feature in model.features.tolist()],
                NODES,
            ),
            (
                "Value above which a node's second branch is taken.",
                "slip_real",
                "slip_thresholds",
                "SLIP_TREES * NODES",
                [f"R({threshold!r})" for threshold in model.thresholds.tolist()],
                NODES,
            ),
            (
                "Values of the leaves.",
                "slip_real",
                "slip_leaves",
                "SLIP_TREES * (NODES + 1)",
                [f"R({leaf!r})" for leaf in model.leaves.tolist()],
                NODES + 1,
            ),
        )
    )


def _rows(values: list[str], length: int) -> Iterator[str]:
    for tree in range(0, len(values), length):
        yield from _wrap(values[tree : tree + length])


def _wrap(values: Iterable[str]) -> list[str]:
    text = ", ".join(values) + ","
    return textwrap.wrap(text, _WIDTH, initial_indent="    ", subsequent_indent="    ", break_long_words=False)
