"""Files that make the library one of Arduino and of PlatformIO."""

from __future__ import annotations

import functools
import json
from importlib import resources
from typing import Any

from fingertip.design import Design
from fingertip.foundation.version import __version__

NAME = "FingertipSlip"
"""Name of the library."""
_SUMMARY = "Slip detector of a prosthetic fingertip."
_LICENSE = "Apache-2.0"


def library_properties(design: Design) -> bytes:
    """Description of the library for Arduino."""
    fields = {
        "name": NAME,
        "version": _semantic_version(),
        "author": "The fingertip contributors",
        "maintainer": "The fingertip contributors",
        "sentence": _SUMMARY,
        "paragraph": _describe(design),
        "category": "Sensors",
        "url": "https://doi.org/10.1109/TMRB.2021.3060032",
        "architectures": "*",
        "includes": "slip_detector.h",
    }
    return "".join(f"{key}={value}\n" for key, value in fields.items()).encode()


def library_manifest(design: Design) -> bytes:
    """Description of the library for PlatformIO."""
    data = {
        "name": NAME,
        "version": _semantic_version(),
        "description": f"{_SUMMARY} {_describe(design)}",
        "keywords": ["slip", "tactile", "prosthetics"],
        "license": _LICENSE,
        "frameworks": "*",
        "platforms": "*",
        "headers": "slip_detector.h",
        "build": {"flags": ["-ffp-contract=off"]},
    }
    return (json.dumps(data, indent=2) + "\n").encode()


def _describe(design: Design) -> str:
    rate, bits = design.detector.sample_rate_hz, design.detector.adc_bits
    return f"Made by fingertip for the design {design.name}: {rate:g} samples per second, converter of {bits} bits."


def _semantic_version() -> str:
    """Version without a suffix that Arduino does not accept."""
    numbers = __version__.split("+")[0].split(".")[:3]
    return ".".join("".join(c for c in number if c.isdigit()) or "0" for number in numbers)


# Costs of the library on a controller, as measured by `tools/firmware/measure.py`, and their limits.


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
