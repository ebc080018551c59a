"""Small sweeps that several tests run."""

from __future__ import annotations

from typing import Any

from fingertip.sweep.plan import Plan

BOARD: dict[str, Any] = {
    "name": "boards",
    "outputs": ["q", "cutoff_3db_hz", "board.r2_ohm"],
    "axes": {
        "board.cutoff_hz": {"low": 20.0, "high": 2000.0, "steps": 12, "spacing": "logarithmic"},
        "board.capacitor_uf": [0.01, 1.0, 1000.0],
        "board.series": ["E12", "E96"],
    },
}


def plan(**changes: Any) -> Plan:
    """The boards' sweep, changed."""
    return Plan.of({**BOARD, **changes})
