"""RODAS with fixed steps for any small system of equations: the method itself, apart from the contact that uses it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.sim.contact.coupled_loop import ALPHA, GAMMA, A, C, D


def integrate_with_fixed_steps(
    rates: Callable[[float, Array], Array],
    jacobian: Callable[[float, Array], Array],
    time_derivative: Callable[[float, Array], Array],
    start: Array,
    end_s: float,
    steps: int,
) -> Array:
    """Return the state after equal steps from time 0.

    Parameters
    ----------
    rates, jacobian, time_derivative
        f(t, y), its derivative by y, and its partial derivative by t.
    start
        State at time 0.
    end_s, steps
        End time [s] and number of steps.
    """
    y, h = np.asarray(start, dtype=np.float64), end_s / steps
    for n in range(steps):
        t = n * h
        inverse = np.linalg.inv(np.eye(len(y)) / (h * GAMMA) - jacobian(t, y))
        drift = time_derivative(t, y)
        u: list[Array] = []
        stage = y
        for i in range(6):
            if i:
                stage = y + sum(a * w for a, w in zip((*A, (*A[-1], 1.0))[i - 1], u, strict=True))
            right = rates(t + ALPHA[i] * h, stage) + D[i] * h * drift
            u.append(inverse @ (right + sum(c * w for c, w in zip(((), *C)[i], u, strict=True)) / h))
        y = stage + u[5]
    return y
