"""Tangential contact: a soft pad dragged by a stage, held by LuGre friction per newton of normal force.

States: x, v of the pad [m, m/s] and z, the mean deflection of the bristles [m]. Stick, incipient slip and
gross slip follow from the equations:

    dz/dt = v - sigma0 |v| z / g(v)
    mu    = sigma0 z + sigma1 dz/dt + sigma2 v
    m dv/dt = k (X - x) + c (V - v) - N mu

C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automatic Control 40(3), 1995,
doi:10.1109/9.376053. Per newton, losing contact is not singular: at N = 0 friction vanishes. Stribeck's
curve in the rational form of D. P. Hess and A. Soom (Trans. ASME J. Tribology 112(1), 1990), which
needs no exponential.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.errors import Fault, TraceError

Array = NDArray[np.float64]

_GAMMA = 1 - 1 / math.sqrt(2)  # L-stable
_RELAXATION_S = 1e-3  # bristles that touch nothing straighten up; assumption


@dataclass(frozen=True)
class Friction:
    """LuGre friction of one surface, per newton of normal force.

    Raises
    ------
    TraceError
        If a parameter is out of its bound, or the bristles could deliver energy they never took up.
    """

    mu_s: float
    """Breakaway coefficient."""
    mu_c: float
    """Coefficient of fast sliding."""
    stribeck_m_s: float = 0.005
    """Velocity at which half of the way from `mu_s` to `mu_c` is gone [m/s]. Assumption."""
    sigma0: float = 25e3
    """Bristle stiffness [1/m]: breakaway after some 20 um. Assumption."""
    sigma1: float = 2.0
    """Bristle damping [s/m]. Assumption within the passivity bound."""
    sigma2: float = 0.6
    """Viscous friction [s/m]. Assumption; at 8 cm/s it adds 0.05 to the coefficient."""

    def __post_init__(self) -> None:
        faults = [
            Fault(f"friction.{name}", f"{value:g} is refused; it must be a finite number above 0.")
            for name, value in vars(self).items()
            if not (math.isfinite(value) and value > 0.0)
        ]
        if not faults and self.mu_s < self.mu_c:
            faults.append(Fault("friction.mu_s", f"{self.mu_s:g} is below mu_c; at least {self.mu_c:g}."))
        if not faults and not self.is_passive:
            most = self.sigma2 * self.mu_c / (self.mu_s - self.mu_c)
            faults.append(
                Fault("friction.sigma1", f"{self.sigma1:g} s/m lets bristles deliver energy; below {most:g}.")
            )
        if faults:
            raise TraceError(faults)

    @property
    def is_passive(self) -> bool:
        """Whether friction only ever takes energy: ``sigma2 > sigma1 (mu_s - mu_c) / mu_c``.

        N. Barabanov, R. Ortega, IEEE Trans. Automatic Control 45(4), 2000, doi:10.1109/9.847131.
        """
        return self.sigma2 * self.mu_c > self.sigma1 * (self.mu_s - self.mu_c)

    def stribeck(self, v: float) -> float:
        """Coefficient g(v) that the bristles carry in steady sliding."""
        return self.mu_c + (self.mu_s - self.mu_c) / (1 + (v / self.stribeck_m_s) ** 2)

    def steady(self, v: float) -> float:
        """Coefficient of friction in steady sliding at `v` [m/s], signed as `v`."""
        return math.copysign(self.stribeck(v), v) + self.sigma2 * v if v else 0.0


@dataclass(frozen=True)
class Mount:
    """How the pad hangs on the stage."""

    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float


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
    """
    mu_c, drop, vs = friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s
    s0, s1, s2 = friction.sigma0, friction.sigma1, friction.sigma2
    m, k, c = mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m
    h, G = step_s, _GAMMA * step_s
    X, V, N = stage_m.tolist(), stage_m_s.tolist(), normal_n.tolist()
    x, v, z = X[0], 0.0, 0.0
    xs, vs_out, zs = [x], [v], [z]
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
        xs.append(x)
        vs_out.append(v)
        zs.append(z)
    return Motion(np.array(xs), np.array(vs_out), np.array(zs))
