"""Uses of consumables that depend on the design, for the steps that name them and for the list to buy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Data = Mapping[str, Any]

OPEN_OHM = 1e6
"""Resistance above which an untouched sensor must stay [ohm]."""
PRESSED_OHM = 30e3
"""Resistance below which a pressed head must fall [ohm]: some 0.2 N by the data sheet's curve."""


def sensor_limits_data() -> dict[str, float]:
    """Return the limits of the sensor's resistance in the units of the sheets."""
    return {"open_mohm": OPEN_OHM / 1e6, "pressed_kohm": PRESSED_OHM / 1e3}


def uses_primer(data: Data) -> bool:
    """Tell whether a step primes the bone: for the skin cast around it, or for the patch."""
    return data["insert"] == "bone" or data["chaplet"] is not None


def uses_adhesive(data: Data) -> bool:
    """Tell whether silicone adhesive seals a passage or a lid."""
    passes = data["method"] == "overmold" and data["mold"]["tail_passes_collar"]
    return bool(passes or data["sensor_tail"] == "folded")


def describe_range(limits: Sequence[float]) -> str:
    """Write the lower and the upper limit of a size; one figure if they agree."""
    low, high = limits
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def join(names: Sequence[str]) -> str:
    """Join names to a list in words."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


# Step of the procedure: what to do, and which picture shows it.


@dataclass(frozen=True)
class Step:
    """Step of the casting sheet."""

    picture: str
    """Name of the scene in `fingertip.pictures.steps` that shows the step."""
    text: str
