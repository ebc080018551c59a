"""Tangential contact: a soft pad dragged by a stage, held by LuGre friction per newton of normal force.

States: x, v of the pad [m, m/s] and z, the mean deflection of the bristles [m]. Stick, incipient slip and
gross slip follow from the equations:

    dz/dt = v - sigma0 |v| z / g(v)
    mu    = sigma0 z + sigma1 dz/dt + sigma2 v
    m dv/dt = k (X - x) + c (V - v) - N mu

Per newton, losing contact is not singular: at N = 0 friction vanishes. The step here is fixed: right for the surfaces
and pads of the catalogue, whose convergence is tested. `sim.contact.coupled` controls its error, for all others.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.errors import Issue, TraceError
from fingertip.jit import CompiledLoop
from fingertip.sim.contact.friction import Friction
from fingertip.sim.validation import columns, not_negative, positive, refuse

__all__ = ["Friction", "Motion", "Mount", "drag"]

_GAMMA = 1 - 1 / math.sqrt(2)  # L-stable
_NO_MOTION = 1e3  # metres, or metres per second: no pad ever
_RELAXATION_S = 1e-3  # bristles that touch nothing straighten up; assumption


@dataclass(frozen=True)
class Mount:
    """How the pad hangs on the stage.

    Raises
    ------
    TraceError
        If the mass is not above 0, or stiffness or damping are below.
    """

    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float

    def __post_init__(self) -> None:
        refuse(
            [
                *positive("mount.mass_kg", self.mass_kg, "kg", "0.002"),
                *not_negative("mount.stiffness_n_per_m", self.stiffness_n_per_m, "N/m"),
                *not_negative("mount.damping_n_s_per_m", self.damping_n_s_per_m, "N s/m"),
            ]
        )


@dataclass(frozen=True)
class Motion:
    """What the pad does, on the grid of the drive."""

    position_m: Array
    velocity_m_s: Array
    bristle_m: Array


def drag(friction: Friction, mount: Mount, step_s: float, stage_m: Array, stage_m_s: Array, normal_n: Array) -> Motion:
    """Integrate the pad's motion from rest, with bristles relaxed.

    ROS2 with the analytic Jacobian: linearly implicit, second order, L-stable, two solves a step, no
    iteration (J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, SIAM J. Sci. Comput. 20(4), 1999,
    doi:10.1137/S1064827597326651). At v = 0 the right side has a kink.

    Parameters
    ----------
    friction, mount
        The surface and the pad.
    step_s
        Step of the grid [s].
    stage_m, stage_m_s, normal_n
        Position [m] and velocity [m/s] of the stage and normal force [N] on the grid.

    Raises
    ------
    TraceError
        If the step is not above 0, a column is not finite (with its first such sample), bristles are elasto-plastic, or
        the step is too long for them.
    """
    issues = positive("step_s", step_s, "s", "0.000125")
    issues.extend(columns(stage_m=stage_m, stage_m_s=stage_m_s, normal_n=normal_n))
    if friction.elastic:
        issues.append(Issue("friction.elastic", f"{friction.elastic:g} needs error control; use coupled.integrate."))
    refuse(issues)
    x, v, z = (np.zeros(len(stage_m)) for _ in range(3))
    _drag(
        (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s),
        (friction.sigma0, friction.sigma1, friction.sigma2),
        (mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m),
        step_s, stage_m, stage_m_s, normal_n, x, v, z,
    )  # fmt: skip
    for name, found in (("position_m", x), ("velocity_m_s", v), ("bristle_m", z)):
        lost = np.flatnonzero(~np.isfinite(found) | (np.abs(found) > _NO_MOTION))
        if lost.size:
            sentence = (
                f"{step_s:g} s is too long for so stiff a bristle on so light a pad: {name} is {found[lost[0]]:g}"
            )
            raise TraceError(Issue("step_s", f"{sentence} at sample {lost[0]}; use coupled.integrate."))
    return Motion(x, v, z)


def _loop(
    curve: tuple[float, float, float],
    sigma: tuple[float, float, float],
    mount: tuple[float, float, float],
    h: float,
    X: Sequence[float],
    V: Sequence[float],
    N: Sequence[float],
    xs: MutableSequence[float],
    vs_out: MutableSequence[float],
    zs: MutableSequence[float],
) -> None:
    mu_c, drop, vs = curve
    s0, s1, s2 = sigma
    m, k, c = mount
    G = _GAMMA * h
    x, v, z = X[0], 0.0, 0.0
    xs[0] = x
    for i in range(len(X) - 1):
        # First stage, with the Jacobian at the start of the step; rows v: [p, q, s] and z: [0, b, a].
        load = N[i]
        ratio = v / vs
        denominator = 1 + ratio * ratio
        g = mu_c + drop / denominator
        speed = v if v >= 0.0 else -v
        if load > 0.0:
            a = -s0 * speed / g
            slope = -2 * drop * ratio / (vs * denominator * denominator)
            b = 1 - s0 * z * ((1.0 if v >= 0.0 else -1.0) - speed * slope / g) / g
            dz = v + a * z
        else:
            a, b, dz = -1 / _RELAXATION_S, 0.0, -z / _RELAXATION_S
        mu = s0 * z + s1 * dz + s2 * v
        dv = (k * (X[i] - x) + c * (V[i] - v) - load * mu) / m
        # gamma h times the derivative of dv by time alone, from the drive's own differences.
        drift = _GAMMA * (k * (X[i + 1] - X[i]) + c * (V[i + 1] - V[i]) - (N[i + 1] - load) * mu) / m
        p = -k / m
        q = -(c + load * (s1 * b + s2)) / m
        s = -load * (s0 + s1 * a) / m
        za = 1 / (1 - G * a)
        pivot = 1 / (1 - G * (q + G * (p + s * b * za)))
        kv1 = (dv + drift + G * (p * v + s * za * dz)) * pivot
        kx1 = v + G * kv1
        kz1 = (dz + G * b * kv1) * za
        # Second stage at the end of the step.
        load = N[i + 1]
        xe, ve, ze = x + h * kx1, v + h * kv1, z + h * kz1
        ratio = ve / vs
        g = mu_c + drop / (1 + ratio * ratio)
        dz = ve - s0 * (ve if ve >= 0.0 else -ve) * ze / g if load > 0.0 else -ze / _RELAXATION_S
        dv = (k * (X[i + 1] - xe) + c * (V[i + 1] - ve) - load * (s0 * ze + s1 * dz + s2 * ve)) / m
        rx, rv, rz = ve - 2 * kx1, dv - drift - 2 * kv1, dz - 2 * kz1
        kv2 = (rv + G * (p * rx + s * za * rz)) * pivot
        kx2 = rx + G * kv2
        kz2 = (rz + G * b * kv2) * za
        x += h * (1.5 * kx1 + 0.5 * kx2)
        v += h * (1.5 * kv1 + 0.5 * kv2)
        z += h * (1.5 * kz1 + 0.5 * kz2)
        xs[i + 1] = x
        vs_out[i + 1] = v
        zs[i + 1] = z


_drag = CompiledLoop(_loop, outputs=3, samples="X", plain_us=3.0)
