"""Readings of a coupon as calipers would give them on a printer of known scale and offset."""

from __future__ import annotations

from typing import Any

import numpy as np

from fingertip.calibration.readings import Length, Measured, identify_coupon, list_lengths
from fingertip.design import Design

SCALE, OFFSET_MM, NOISE_MM, THINNEST_MM = 1.005, 0.1, 0.02, 0.5


def true_length(length: Length, scale: float = SCALE, offset_mm: float = OFFSET_MM) -> float:
    """Length as printed [mm]; thin walls come out as told."""
    return length.nominal_mm * (scale if length.kind != "wall" else 1.0) + offset_mm * {
        "outer": 1.0, "inner": -1.0, "wall": 0.0,
    }[length.kind]  # fmt: skip


def simulate(
    design: Design,
    seed: int,
    count: int = 4,
    noise_mm: float = NOISE_MM,
    length_error_mm: float = 0.0,
    offset_mm: float = OFFSET_MM,
    scale: float = SCALE,
) -> dict[str, Any]:
    """Contents of a file of readings, rounded to the 0.01 mm that calipers show."""
    rng = np.random.default_rng(seed)
    tables: dict[str, Any] = {"coupon": identify_coupon(design)}
    for length in list_lengths(design):
        if length.kind == "wall" and length.nominal_mm < THINNEST_MM:
            tables[length.name] = []
            continue
        centre = true_length(length, scale, offset_mm) + rng.normal(0.0, length_error_mm or 1e-12)
        tables[length.name] = [round(float(value), 2) for value in rng.normal(centre, noise_mm, count)]
    return tables


def measured(design: Design, tables: dict[str, Any]) -> tuple[Measured, ...]:
    """Readings of outer and inner lengths, without checking them."""
    used = (length for length in list_lengths(design) if length.kind != "wall")
    return tuple(Measured(length, tuple(tables[length.name])) for length in used)


def to_toml(tables: dict[str, Any]) -> str:
    """Text of a file of readings."""
    lines = [f'coupon = "{tables["coupon"]}"']
    lines += [f"{name} = {list(values)!r}" for name, values in tables.items() if name != "coupon"]
    return "\n".join(lines) + "\n"
