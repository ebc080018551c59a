"""Costs of the library on controllers, as `tools/firmware/measure.py` measured them."""

from __future__ import annotations

import functools
import json
from importlib import resources
from typing import Any

TABLE = "measured_costs.json"
"""File of the measurements in this folder."""
_COLUMNS = (
    "processor",
    "flash",
    "state",
    "stack",
    "constant force",
    "campaign",
    "slip that lasts",
    "longest step",
)


@functools.cache
def read_costs() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(
        resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8")
    )
    return data


def cost_table() -> str:
    """Return the table of measurements, in Markdown: bytes, and instructions per sample."""
    costs = read_costs()
    rows = [_COLUMNS, ("---", *["---:"] * (len(_COLUMNS) - 1))]

    for name, target in costs["targets"].items():
        sizes = (target["flash_bytes"], costs["state_bytes"], target["stack_bytes"])
        means = (target["instructions"][signal] for signal in ("quiet", "campaign", "slip"))
        rows.append(
            (
                name,
                *(f"{size} B" for size in sizes),
                *map(str, means),
                str(target["max_instructions"]),
            )
        )

    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
