"""Tangential contact: a soft pad dragged over a surface against LuGre friction, integrated with fixed steps.

States: position x [m] and velocity v [m/s] of the pad, and mean bristle deflection z [m]. The carriage, the moving part
of the linear stage that drags the pad, has position X and velocity V. N is the normal force. The equations cover stick,
incipient slip and gross slip (Canudas de Wit et al. 1995, see `fingertip.sim.contact.friction`):

    dz/dt = v - sigma0 |v| z / g(v)
    mu    = sigma0 z + sigma1 dz/dt + sigma2 v
    m dv/dt = k (X - x) + c (V - v) - N mu

Friction is written per newton of normal force, so losing contact is not singular: at N = 0 friction vanishes. The fixed
step suits the surfaces and pads of the catalogue, for which tests check its convergence. For all others,
`fingertip.sim.contact.coupled` controls its own error.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.errors import Issue, TraceError
from fingertip.jit import CompiledLoop
from fingertip.sim.contact.friction import RELAXATION_S, ROS2_GAMMA, Friction
from fingertip.sim.validation import find_column_issues, find_negative, find_not_positive, raise_issues

_DIVERGED = 1e3
"""Position [m] or velocity [m/s] that no pad reaches, so the integration has diverged."""


@dataclass(frozen=True)
class Mount:
    """Spring and damper between the pad and the carriage that drags it.

    Raises
    ------
    TraceError
        If the mass is not above 0, or stiffness or damping is negative.
    """

    mass_kg: float
    """Mass that moves with the pad [kg]."""
    stiffness_n_per_m: float
    """Tangential stiffness [N/m]."""
    damping_n_s_per_m: float
    """Tangential damping [N s/m]."""

    def __post_init__(self) -> None:
        raise_issues(
            [
                *find_not_positive("mount.mass_kg", self.mass_kg, "kg", "0.002"),
                *find_negative("mount.stiffness_n_per_m", self.stiffness_n_per_m, "N/m"),
                *find_negative("mount.damping_n_s_per_m", self.damping_n_s_per_m, "N s/m"),
            ]
        )


@dataclass(frozen=True)
class PadMotion:
    """Motion of the pad at the points of the time grid."""

    position_m: Array
    """Position [m]."""
    velocity_m_s: Array
    """Velocity [m/s]."""
    bristle_m: Array
    """Mean bristle deflection [m]."""


def drag(
    friction: Friction, mount: Mount, step_s: float, carriage_m: Array, carriage_m_s: Array, normal_n: Array
) -> PadMotion:
    """Integrate the pad's motion from standstill, with relaxed bristles.

    The method is ROS2 with the analytic Jacobian: linearly implicit, second order, L-stable, two linear solves per step
    and no iteration (J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, SIAM J. Sci. Comput. 20(4), 1999,
    doi:10.1137/S1064827597326651). At v = 0 the right-hand side has a kink.

    Parameters
    ----------
    friction, mount
        Surface, and mount of the pad.
    step_s
        Step of the time grid [s].
    carriage_m, carriage_m_s, normal_n
        Position [m] and velocity [m/s] of the carriage, and normal force [N], at the points of the grid.

    Raises
    ------
    TraceError
        If the step is not above 0, a column is not finite (the error names the first such sample), the bristles are
        elasto-plastic, or the step is too long for the stiffness of the bristles.
    """
    issues = find_not_positive("step_s", step_s, "s", "0.000125")
    issues.extend(find_column_issues(carriage_m=carriage_m, carriage_m_s=carriage_m_s, normal_n=normal_n))
    if friction.elastic:
        issues.append(Issue("friction.elastic", f"{friction.elastic:g} needs error control; use coupled.integrate."))
    raise_issues(issues)
    x, v, z = (np.zeros(len(carriage_m)) for _ in range(3))
    _drag(
        (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s),
        (friction.sigma0, friction.sigma1, friction.sigma2, RELAXATION_S),
        (mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m),
        step_s, carriage_m, carriage_m_s, normal_n, x, v, z,
    )  # fmt: skip
    for name, values in (("position_m", x), ("velocity_m_s", v), ("bristle_m", z)):
        diverged = np.flatnonzero(~np.isfinite(values) | (np.abs(values) > _DIVERGED))
        if diverged.size:
            first = diverged[0]
            reason = f"{step_s:g} s is too long for such stiff bristles on such a light pad"
            state = f"{name} is {values[first]:g} at sample {first}"
            raise TraceError(Issue("step_s", f"{reason}: {state}; use coupled.integrate."))
    return PadMotion(x, v, z)


def _drag_loop(
    curve: tuple[float, float, float],
    sigma: tuple[float, float, float, float],
    mount: tuple[float, float, float],
    h: float,
    X: Sequence[float],
    V: Sequence[float],
    N: Sequence[float],
    xs: MutableSequence[float],
    vs_out: MutableSequence[float],
    zs: MutableSequence[float],
) -> None:
    """Integrate the pad's motion by ROS2."""
    mu_c, drop, vs = curve  # drop = mu_s - mu_c, vs = Stribeck velocity
    s0, s1, s2, relaxation_s = sigma
    m, k, c = mount
    G = ROS2_GAMMA * h
    x, v, z = X[0], 0.0, 0.0
    xs[0] = x
    for i in range(len(X) - 1):
        # Friction at the start of the step: g(v), dz/dt, and its derivatives J_zz by z and J_zv by v.
        load = N[i]
        ratio = v / vs
        denominator = 1 + ratio * ratio
        g = mu_c + drop / denominator
        speed = v if v >= 0.0 else -v
        if load > 0.0:
            J_zz = -s0 * speed / g
            dg = -2 * drop * ratio / (vs * denominator * denominator)  # derivative of g by v
            J_zv = 1 - s0 * z * ((1.0 if v >= 0.0 else -1.0) - speed * dg / g) / g
            dz = v + J_zz * z
        else:
            J_zz, J_zv, dz = -1 / relaxation_s, 0.0, -z / relaxation_s
        mu = s0 * z + s1 * dz + s2 * v
        dv = (k * (X[i] - x) + c * (V[i] - v) - load * mu) / m

        # gamma h times the partial derivative of dv by time, from the differences of the drive over the step.
        drift = ROS2_GAMMA * (k * (X[i + 1] - X[i]) + c * (V[i + 1] - V[i]) - (N[i + 1] - load) * mu) / m

        # Row v of the Jacobian; row x is [0, 1, 0]. Eliminating x and z from (I - gamma h J) k = right-hand side leaves
        # one scalar equation for the velocity.
        J_vx = -k / m
        J_vv = -(c + load * (s1 * J_zv + s2)) / m
        J_vz = -load * (s0 + s1 * J_zz) / m
        pivot_z = 1 / (1 - G * J_zz)
        pivot_v = 1 / (1 - G * (J_vv + G * (J_vx + J_vz * J_zv * pivot_z)))

        # First stage of ROS2.
        kv1 = (dv + drift + G * (J_vx * v + J_vz * pivot_z * dz)) * pivot_v
        kx1 = v + G * kv1
        kz1 = (dz + G * J_zv * kv1) * pivot_z

        # Second stage: right-hand side at the end of the step, solved with the same matrix.
        load = N[i + 1]
        xe, ve, ze = x + h * kx1, v + h * kv1, z + h * kz1
        ratio = ve / vs
        g = mu_c + drop / (1 + ratio * ratio)
        dz = ve - s0 * (ve if ve >= 0.0 else -ve) * ze / g if load > 0.0 else -ze / relaxation_s
        dv = (k * (X[i + 1] - xe) + c * (V[i + 1] - ve) - load * (s0 * ze + s1 * dz + s2 * ve)) / m
        rx, rv, rz = ve - 2 * kx1, dv - drift - 2 * kv1, dz - 2 * kz1
        kv2 = (rv + G * (J_vx * rx + J_vz * pivot_z * rz)) * pivot_v
        kx2 = rx + G * kv2
        kz2 = (rz + G * J_zv * kv2) * pivot_z

        # New state: y + h (3/2 k1 + 1/2 k2).
        x += h * (1.5 * kx1 + 0.5 * kx2)
        v += h * (1.5 * kv1 + 0.5 * kv2)
        z += h * (1.5 * kz1 + 0.5 * kz2)
        xs[i + 1] = x
        vs_out[i + 1] = v
        zs[i + 1] = z


_drag = CompiledLoop(_drag_loop, outputs=3, samples="X", plain_us=3.0)
"""Fills position, velocity and bristle deflection at each point of the grid."""
