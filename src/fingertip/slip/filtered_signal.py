"""Warnings of a recorded filtered signal that cannot be one: a broken wire, or two wires exchanged."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fingertip.design import Design
from fingertip.design.signal_ground import signal_ground_ratio
from fingertip.slip.traces.trace import Trace

MAX_REST_V = 0.3
"""Largest deviation of the rest of a filtered signal from the signal ground [V]."""


def filtered_warnings(trace: Trace, design: Design) -> Iterator[str]:
    """Warn of a filtered signal that stands still, or that does not rest at the board's signal ground.

    Parameters
    ----------
    trace
        Trace with the filtered signal, above ground or above signal ground.
    design
        Design of the board.
    """
    if trace.filtered_v is None or not len(trace.filtered_v):
        return
    rest_v, ground_v = (
        float(np.median(trace.filtered_v)),
        signal_ground_ratio(design.board.supply) * design.board.supply_v,
    )
    if float(np.ptp(trace.filtered_v)) == 0.0:
        yield (
            f"filtered_v stands still at {rest_v:.3g} V: is the board's pin S connected? "
            "The tactile voltage alone is judged."
        )
    elif min(abs(rest_v), abs(rest_v - ground_v)) > MAX_REST_V:
        yield (
            f"filtered_v rests at {rest_v:.3g} V, and neither at the signal ground of {ground_v:.3g} V nor at 0 V: are "
            "T and S exchanged?"
        )
