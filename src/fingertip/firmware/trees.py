"""Tables of the detector's trees as constants of C, in the types that take the least memory."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from fingertip.slip.detectors.fast_model import NODES, FastModel

_WIDTH, _INDENT = 119, "    "


def render_trees(model: FastModel) -> str:
    """Render the three tables. Each tree has `NODES` + 1 entries, of which nodes leave the first one unused."""
    features = [f"{feature:.0f}" for feature in model.features.tolist()]
    thresholds = [f"KEY({value!r}, 0x{float_key(value):08X})" for value in model.thresholds.tolist()]
    leaves = [f"R({value!r})" for value in model.leaves.tolist()]
    tables = (
        ("Number of the feature that each node compares.", "uint8_t slip_features", _pad(features, "0")),
        (
            "Value above which a node's second branch is taken, and its key as a float.",
            "slip_key slip_thresholds",
            _pad(thresholds, "KEY(0.0, 0)"),
        ),
        ("Values of the leaves.", "slip_real slip_leaves", leaves),
    )
    return "\n\n".join(
        "\n".join([f"/* {comment} */", f"static const {name}[SLIP_TREES * LEAVES] = {{", *_rows(values), "};"])
        for comment, name, values in tables
    )


def float_key(value: float) -> int:
    """Bits of a number in single precision, as an integer in the order of these numbers."""
    (bits,) = struct.unpack("<I", struct.pack("<f", value))
    return int(~bits & 0xFFFFFFFF if bits & 0x80000000 else bits | 0x80000000)


def _pad(values: list[str], unused: str) -> list[str]:
    """Put the unused entry ahead of the nodes of each tree."""
    rows = (values[i : i + NODES] for i in range(0, len(values), NODES))
    return [entry for row in rows for entry in (unused, *row)]


def _rows(values: list[str]) -> Iterator[str]:
    """Yield the lines of a table; each tree begins a new one, and none ends within an entry."""
    for i in range(0, len(values), NODES + 1):
        line = _INDENT
        for value in values[i : i + NODES + 1]:
            if len(line) + len(value) > _WIDTH:
                yield line.rstrip()
                line = _INDENT
            line += f"{value}, "
        yield line.rstrip()
