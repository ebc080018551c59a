"""Costs of the library on a controller, as measured by `tools/firmware/measure.py`, and their limits."""

from __future__ import annotations

import functools
import json
from importlib import resources
from typing import Any

TABLE = "measured_costs.json"
"""Name of the measurements, beside this module."""
MAX_FLASH_BYTES = 32 * 1024
"""Largest flash for code and tables [byte]."""
MAX_STATE_BYTES, MAX_STACK_BYTES = 512, 512
"""Largest state and stack [byte]."""
MAX_INSTRUCTIONS = 1000
"""Largest mean number of instructions per sample on a Cortex-M4F."""
_COLUMNS = (
    "processor", "flash", "state", "stack", "constant force", "campaign", "slip that lasts", "longest step",
)  # fmt: skip


@functools.cache
def read_costs() -> dict[str, Any]:
    """Read the measurements."""
    data: dict[str, Any] = json.loads(resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8"))
    return data


def cost_table() -> str:
    """Table of the measurements, in Markdown: bytes, and instructions per sample."""
    costs = read_costs()
    rows = [_COLUMNS, ("---", *["---:"] * (len(_COLUMNS) - 1))]
    for name, target in costs["targets"].items():
        counts = target["instructions"]
        rows.append(
            (
                name,
                *(f"{size} B" for size in (target["flash_bytes"], costs["state_bytes"], target["stack_bytes"])),
                *(str(counts[signal]) for signal in ("quiet", "campaign", "slip")),
                str(target["max_instructions"]),
            )
        )
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
