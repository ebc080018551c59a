"""RODAS: a linearly implicit Runge-Kutta method of order 4 with an embedded one of order 3, L-stable, six stages.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., 1996, section IV.10 and its code RODAS,
doi:10.1007/978-3-642-05221-7. One factorised matrix ``E = 1/(h gamma) - J`` serves all six solves:

    E u_i = f(t + alpha_i h, y + sum_j a_ij u_j) + sum_j c_ij u_j / h + d_i h df/dt
    y_new = y + sum_j a_5j u_j + u_5 + u_6, and u_6 estimates the error.

On very stiff problems its order falls to 1 or 2 (tests/sim/test_rosenbrock.py has the figures).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fingertip.arrays import Array

GAMMA = 0.25
ALPHA = (0.0, 0.386, 0.21, 0.63, 1.0, 1.0)
D = (0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0)
_LAST = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950)
A = (
    (1.544,),
    (0.9466785280815826, 0.2557011698983284),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817),
    _LAST,
)
C = (
    (-5.6688,),
    (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
    (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
)


def fixed_steps(
    rates: Callable[[float, Array], Array],
    jacobian: Callable[[float, Array], Array],
    by_time: Callable[[float, Array], Array],
    start: Array,
    until_s: float,
    steps: int,
) -> Array:
    """The state after equal steps from time 0, for any small system: the method itself, apart from the contact's.

    Parameters
    ----------
    rates, jacobian, by_time
        f(t, y), its derivative by y, and its derivative by t alone.
    start
        State at time 0.
    until_s, steps
        End [s] and how many steps lead there.
    """
    y, h = np.asarray(start, dtype=np.float64), until_s / steps
    for n in range(steps):
        t = n * h
        inverse = np.linalg.inv(np.eye(len(y)) / (h * GAMMA) - jacobian(t, y))
        drift = by_time(t, y)
        u: list[Array] = []
        at = y
        for i in range(6):
            if i:
                at = y + sum(a * w for a, w in zip((*A, (*_LAST, 1.0))[i - 1], u, strict=True))
            right = rates(t + ALPHA[i] * h, at) + D[i] * h * drift
            u.append(inverse @ (right + sum(c * w for c, w in zip(((), *C)[i], u, strict=True)) / h))
        y = at + u[5]
    return y
