"""Tangential contact: a soft pad dragged over a surface against LuGre friction, integrated with
fixed steps.

States: position x [m] and velocity v [m/s] of the pad, and state s of its bristles [m sqrt(N)]. The
carriage, the moving part of the linear stage that drags the pad, has position X and velocity V. N
is the normal force. The equations cover stick, incipient slip and gross slip
(`fingertip.sim.contact.friction`):

    z  = c s,   c = 1 / sqrt(N + N0),   L = v - sigma0 |v| z / g(v)
    ds/dt   = N c L - r(N, z) s
    m dv/dt = k (X - x) + d (V - v) - N (sigma0 z + sigma1 c ds/dt + sigma2 v)

Losing contact is not singular: at N = 0 friction vanishes. A step that is too long for the
stiffness of the bristles is refused (`admissible_step_s`). `fingertip.sim.contact.coupled` controls
its own error.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import round_down
from fingertip.sim.contact.friction import (
    LOAD_SCALE_N,
    RELAX_PER_S,
    ROS2_GAMMA,
    Curve,
    Friction,
    stribeck,
)

MAX_PHASE = 0.5
"""Longest step, as the angle by which the stuck pad oscillates on its bristles in one step [rad].

Up to this limit the largest error of the friction was 0.4 % of the load, in 400 random contacts of
any stiffness, mass and Stribeck velocity, and 0.02 % in nine of ten (tests/sim/test_tangential.py).
The article's trials are below 0.2.
"""
MAX_DAMPING = 3.0
"""Longest step, as the exponent by which friction damps the free pad in one step. A load that grows
from nothing within some steps multiplies errors from 1000 on; the article's trials are below 0.1.
"""


@dataclass(frozen=True)
class Mount:
    """Spring and damper between the pad and the carriage that drags it."""

    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float


@dataclass(frozen=True)
class PadMotion:
    position_m: Array
    velocity_m_s: Array
    bristle_m: Array

    @property
    def evaluations(self) -> int:
        """Number of evaluations of the right-hand side."""
        return 2 * len(self.position_m)


def admissible_step_s(friction: Friction, mount: Mount, max_load_n: float) -> float:
    """Longest step for a stuck pad, which turns by ``sqrt((k + N sigma0) / m)`` radians per second,
    and free [s].
    """
    stiffness = mount.stiffness_n_per_m + max_load_n * friction.sigma0
    damping = max_load_n * (friction.sigma1 + friction.sigma2)
    phase_s = MAX_PHASE * math.sqrt(mount.mass_kg / stiffness) if stiffness > 0.0 else math.inf

    return min(phase_s, MAX_DAMPING * mount.mass_kg / damping if damping > 0.0 else math.inf)


class DraggedPad:
    """Pad that a carriage drags from standstill, with relaxed bristles, over any number of chunks.

    The method is ROS2 with the analytic Jacobian: linearly implicit, second order, L-stable, two
    linear solves per step and no iteration (J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer,
    SIAM J. Sci. Comput. 20(4), 1999, doi:10.1137/S1064827597326651). At v = 0 the right-hand side
    has a kink. Elasto-plastic bristles need error control.
    """

    def __init__(self, friction: Friction, mount: Mount, step_s: float) -> None:
        self._friction = friction
        self._mount = mount
        self._step_s = step_s
        self._state: Array | None = None
        self._last: tuple[Array, ...] = (np.zeros(0),) * 3

    def process(self, carriage_m: Array, carriage_m_s: Array, normal_n: Array) -> PadMotion:
        """Follow the pad over the next points; the first chunk begins with the initial point.

        Raises TraceError.
        """
        friction = self._friction
        mount = self._mount
        max_load_n = float(np.max(normal_n, initial=0.0))
        longest = admissible_step_s(friction, mount, max_load_n)

        if not self._step_s <= longest:
            stiff = (
                f"for bristles of {friction.sigma0:g} /m under {max_load_n:g} N on a pad of "
                f"{mount.mass_kg:g} kg"
            )
            remedy = (
                f"choose at most {round_down(longest):g} s, or use coupled.integrate, which "
                "controls its error"
            )
            raise TraceError(Issue("step_s", f"{self._step_s:g} s is too long {stiff}; {remedy}."))

        if self._state is None:
            self._state = np.array([carriage_m[0], 0.0, 0.0])

        # The step to the first point of a chunk begins at the last point of the chunk before.
        columns = [
            np.concatenate(pair)
            for pair in zip(self._last, (carriage_m, carriage_m_s, normal_n), strict=True)
        ]
        known = len(self._last[0])
        self._last = (carriage_m[-1:].copy(), carriage_m_s[-1:].copy(), normal_n[-1:].copy())
        x, v, z = (np.zeros(len(columns[0])) for _ in range(3))
        _drag(
            friction.curve,
            (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S, LOAD_SCALE_N),
            (mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m),
            self._step_s,
            *columns,
            self._state,
            x,
            v,
            z,
        )

        if not np.isfinite(self._state).all():
            remedy = (
                f"choose less than {self._step_s / 2:.3g} s, or use coupled.integrate, which "
                "controls its error."
            )
            raise TraceError(
                Issue("step_s", f"{self._step_s:g} s leads to motion that is no number; {remedy}")
            )

        return PadMotion(x[known:], v[known:], z[known:])


def _drag_loop(
    curve: Curve,
    sigma: tuple[float, float, float, float, float],
    mount: tuple[float, float, float],
    h: float,
    X: Sequence[float],
    V: Sequence[float],
    N: Sequence[float],
    state: MutableSequence[float],
    xs: MutableSequence[float],
    vs_out: MutableSequence[float],
    zs: MutableSequence[float],
) -> None:
    s0, s1, s2, relax_per_s, N0 = sigma
    m, k, d = mount
    G = ROS2_GAMMA * h
    x = state[0]
    v = state[1]
    s = state[2]
    xs[0] = x
    vs_out[0] = v
    zs[0] = 1 / math.sqrt(N[0] + N0) * s
    # A pad that nothing has moved yet stays where it is, with the bits of the steps below.
    first = 0
    rests = v == s == 0.0 and math.copysign(1.0, v) + math.copysign(1.0, s) == 2.0

    while (
        rests
        and first < len(X) - 1
        and X[first] == X[first + 1] == x
        and V[first] == V[first + 1] == 0.0
    ):
        first += 1
        xs[first] = x
        vs_out[first] = v
        zs[first] = s

    load = N[first]
    c = 1 / math.sqrt(load + N0)
    # Relaxation without load, the first part of r.
    unloaded = relax_per_s * (1 - load / N0) if load < N0 else 0.0
    per_mu_s = 1 / (curve[0] + curve[1])

    for i in range(first, len(X) - 1):
        # Friction at the start of the step: g(v), ds/dt, and its derivatives J_ss by s and J_sv by
        # v.
        g, dg = stribeck(curve, v)
        speed = v if v >= 0.0 else -v
        z = c * s
        grip = load * c
        slides = grip * c * s0 * speed / g
        ratio = s0 * (z if z >= 0.0 else -z) * per_mu_s
        relax = unloaded + (relax_per_s * (ratio - 1) if ratio > 1.0 else 0.0)
        J_ss = -slides - relax - (relax_per_s * ratio if ratio > 1.0 else 0.0)
        J_sv = grip * (1 - s0 * z * ((1.0 if v >= 0.0 else -1.0) - speed * dg / g) / g)
        ds = grip * v - (slides + relax) * s
        mu = s0 * z + s1 * c * ds + s2 * v
        dv = (k * (X[i] - x) + d * (V[i] - v) - load * mu) / m

        # The same rates at the end of the step, for the present state: their difference is the step
        # times the partial derivative by time.
        next_load = N[i + 1]
        next_c = 1 / math.sqrt(next_load + N0)
        next_unloaded = relax_per_s * (1 - next_load / N0) if next_load < N0 else 0.0
        next_grip = next_load * next_c
        ratio = s0 * next_c * (s if s >= 0.0 else -s) * per_mu_s
        relax = next_unloaded + (relax_per_s * (ratio - 1) if ratio > 1.0 else 0.0)
        late = next_grip * (v - next_c * s0 * speed / g * s) - relax * s
        late_mu = s0 * next_c * s + s1 * next_c * late + s2 * v
        drift_s = ROS2_GAMMA * (late - ds)
        drift_v = (
            ROS2_GAMMA
            * (k * (X[i + 1] - X[i]) + d * (V[i + 1] - V[i]) - (next_load * late_mu - load * mu))
            / m
        )

        # Row v of the Jacobian; row x is [0, 1, 0]. Eliminating x and s from (I - gamma h J) k =
        # right-hand side leaves one scalar equation for the velocity.
        J_vx = -k / m
        J_vv = -(d + load * (s1 * c * J_sv + s2)) / m
        J_vs = -grip * (s0 + s1 * J_ss) / m
        pivot_s = 1 / (1 - G * J_ss)
        pivot_v = 1 / (1 - G * (J_vv + G * (J_vx + J_vs * J_sv * pivot_s)))

        # First stage of ROS2.
        rs = ds + drift_s
        kv1 = (dv + drift_v + G * (J_vx * v + J_vs * pivot_s * rs)) * pivot_v
        kx1 = v + G * kv1
        ks1 = (rs + G * J_sv * kv1) * pivot_s

        # Second stage: right-hand side at the end of the step, solved with the same matrix.
        load = next_load
        c = next_c
        unloaded = next_unloaded
        xe = x + h * kx1
        ve = v + h * kv1
        se = s + h * ks1
        most = g
        g, _ = stribeck(curve, ve)
        most = g if g > most else most
        z = c * se
        ratio = s0 * (z if z >= 0.0 else -z) * per_mu_s
        before = s if s >= 0.0 else -s

        if s0 * (z if z >= 0.0 else -z) > 2 * most and (se if se >= 0.0 else -se) > before:
            # Bristles bent beyond sliding only straighten up. The step is longer than they are:
            # they slide.
            z = (g if ve >= 0.0 else -g) / s0
            se = z / c
            ratio = 1.0

        relax = unloaded + (relax_per_s * (ratio - 1) if ratio > 1.0 else 0.0)
        ds = next_grip * (ve - s0 * (ve if ve >= 0.0 else -ve) * z / g) - relax * se
        dv = (
            k * (X[i + 1] - xe) + d * (V[i + 1] - ve) - load * (s0 * z + s1 * c * ds + s2 * ve)
        ) / m
        rx = ve - 2 * kx1
        rv = dv - drift_v - 2 * kv1
        rs = ds - drift_s - 2 * ks1
        kv2 = (rv + G * (J_vx * rx + J_vs * pivot_s * rs)) * pivot_v
        kx2 = rx + G * kv2
        ks2 = (rs + G * J_sv * kv2) * pivot_s

        # New state: y + h (3/2 k1 + 1/2 k2).
        x += h * (1.5 * kx1 + 0.5 * kx2)
        v += h * (1.5 * kv1 + 0.5 * kv2)
        s += h * (1.5 * ks1 + 0.5 * ks2)
        z = c * s

        if s0 * (z if z >= 0.0 else -z) > 2 * most and (s if s >= 0.0 else -s) > before:
            z = (g if v >= 0.0 else -g) / s0
            s = z / c

        xs[i + 1] = x
        vs_out[i + 1] = v
        zs[i + 1] = z

    state[0] = x
    state[1] = v
    state[2] = s


_drag = CompiledLoop(_drag_loop, stribeck, samples="X", plain_us=4.0)
"""Carries the state (x, v, s) and fills position, velocity and bristle deflection at each point of
the grid.
"""
