"""Order of RODAS, including its reduction by stiffness (Prothero and Robinson, Math. Comp. 28, 1974)."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

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
    """State at the end of equal steps from time 0: f(t, y), its derivative by y and its partial derivative by t."""
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


def prothero_robinson_errors(stiffness: float, steps: tuple[int, ...]) -> list[float]:
    """Errors at t = 2 for y' = lambda (y - sin t) + cos t, whose solution is sin t for every lambda."""
    found = []
    for n in steps:
        y = integrate_with_fixed_steps(
            lambda t, y: stiffness * (y - math.sin(t)) + math.cos(t),
            lambda t, y: np.array([[stiffness]]),
            lambda t, y: np.array([-stiffness * math.cos(t) - math.sin(t)]),
            np.array([0.0]), 2.0, n,
        )  # fmt: skip
        found.append(abs(float(y[0]) - math.sin(2.0)))
    return found


@pytest.mark.parametrize(
    ("stiffness", "order"),
    [
        (-1.0, 4.0),  # nominal order
        (-1e3, 1.1),  # |lambda| h above 10: order reduction to about 1
        (-1e6, 0.9),  # no practical step size restores the order, but the error is small
    ],
)
def test_order_with_stiffness(stiffness, order):
    found = prothero_robinson_errors(stiffness, (10, 20, 40))
    for coarse, fine in pairwise(found):
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.15)
    assert found[0] < 5e-6


def test_order_with_full_varying_jacobian():
    """The van der Pol oscillator (mu 2) has a Jacobian that depends on the state."""
    from scipy.integrate import solve_ivp

    def rates(t, y):
        return np.array([y[1], 2 * (1 - y[0] * y[0]) * y[1] - y[0]])

    exact = solve_ivp(rates, (0, 2), [2.0, 0.0], "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    found = []
    for n in (20, 40, 80, 160):
        y = integrate_with_fixed_steps(
            rates,
            lambda t, y: np.array([[0, 1], [-4 * y[0] * y[1] - 1, 2 * (1 - y[0] * y[0])]]),
            lambda t, y: np.zeros(2),
            np.array([2.0, 0.0]), 2.0, n,
        )  # fmt: skip
        found.append(float(np.abs(y - exact).max()))
    assert math.log2(found[-2] / found[-1]) == pytest.approx(4.0, abs=0.5)
