"""Scipy's solvers on a problem with corners."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.foundation.numerics import Array

_MAX_STEPS = 1_000_000


@dataclass(frozen=True)
class System:
    """Right-hand side and Jacobian of a problem, called with time, state and further arguments."""

    rates: Callable[..., Any]
    jacobian: Callable[..., Any]


@dataclass(frozen=True)
class Segment:
    """Time between two corners of the input."""

    time_s: Array
    """Samples, from one corner to the other."""
    arguments: tuple[Any, ...]
    """Arguments of right-hand side and Jacobian."""


def solve_with_scipy(
    method: str,
    system: System,
    segments: Sequence[Segment],
    start: Array,
    relative: float,
    absolute: Array,
    longest_s: float | None = None,
    stops_s: Array | None = None,
) -> tuple[Array, int]:
    """Return the states at the samples, (states, samples), with a fresh start at every corner, and
    the evaluations.

    Raises ArithmeticError.
    """
    integrate = importlib.import_module("scipy.integrate")
    state = start
    parts = [start[:, None]]
    evaluations = 0

    for segment in segments:
        t = segment.time_s
        if method == "odeint":
            found, report = integrate.odeint(
                system.rates,
                state,
                t,
                segment.arguments,
                Dfun=system.jacobian,
                tfirst=True,
                rtol=relative,
                atol=absolute,
                hmax=longest_s or 0.0,
                mxstep=_MAX_STEPS,
                full_output=True,
                tcrit=t[-1:] if stops_s is None else stops_s,
            )
            values = found.T
            message = report["message"]
            calls = int(report["nfe"][-1])
            succeeded = message == "Integration successful."
        else:
            solution = integrate.solve_ivp(
                system.rates,
                (t[0], t[-1]),
                state,
                method,
                t,
                args=segment.arguments,
                rtol=relative,
                atol=absolute,
                max_step=longest_s or np.inf,
                jac=system.jacobian,
            )
            values = solution.y
            message = solution.message
            succeeded = solution.success
            calls = solution.nfev

        if not succeeded:
            raise ArithmeticError(message)

        parts.append(values[:, 1:])
        state = values[:, -1]
        evaluations += calls

    return np.concatenate(parts, axis=1), evaluations


def scipy_version() -> str:
    """Version of scipy."""
    return str(importlib.import_module("scipy").__version__)
