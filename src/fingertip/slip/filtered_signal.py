"""Warnings of recorded outputs of a board that cannot be: a broken wire, two wires exchanged, or the wrong ground."""

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
    rest_v, ground_v = float(np.median(trace.filtered_v)), _find_ground_v(design)
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


def envelope_warnings(trace: Trace, design: Design) -> Iterator[str]:
    """Warn of an envelope that was recorded above ground, on a board whose envelope is that above the signal ground.

    Parameters
    ----------
    trace
        Trace with the envelope.
    design
        Design of the board.
    """
    ground_v = _find_ground_v(design)
    if trace.envelope_v is None or not len(trace.envelope_v) or not ground_v:
        return
    rest_v = float(np.median(trace.envelope_v))
    if abs(rest_v - ground_v) <= MAX_REST_V:
        yield (
            f"envelope_v rests at {rest_v:.3g} V, near the signal ground of {ground_v:.3g} V, and slip is ON all the "
            "time: was E recorded against ground? The envelope is E minus M: subtract the samples of M."
        )


def _find_ground_v(design: Design) -> float:
    """Find the voltage of the board's signal ground above ground [V]."""
    return signal_ground_ratio(design.board.supply) * design.board.supply_v
