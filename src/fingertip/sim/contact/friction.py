"""LuGre friction under a varying normal force, and the definition of gross slip.

    z     = c s,   c = 1 / sqrt(N + N0)                                 mean bristle deflection
    L    = v - alpha(v, z) sigma0 |v| z / g(v)    rate at which motion bends bristles
    ds/dt = N c L - r(N, z) s
    mu    = sigma0 z + sigma1 c ds/dt + sigma2 v,   friction force N mu

At constant load this is the model of C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky,
IEEE Trans. Automatic Control 40(3), 1995, doi:10.1109/9.376053, with alpha = 1. The Stribeck curve
g has the rational form of D. P. Hess and A. Soom (Trans. ASME J. Tribology 112(1), 1990), which
needs no exponential. Elasto-plastic bristles (alpha): P. Dupont, V. Hayward, B. Armstrong, F.
Altpeter, IEEE Trans. Automatic Control 47(5), 2002, doi:10.1109/TAC.2002.1000274.

The state is s, because the bristles store the energy ``sigma0 s^2 / 2``. A change of the load at
rest leaves s and this energy as they are. With z as state, as usual, the stored energy ``sigma0 N
z^2 / 2`` would grow with the load, and nobody would have done that work. Friction is therefore
passive under any load, with the bound of `Friction.is_passive`.

Bristles relax at the rate ``r = R ((1 - N / N0)+ + (sigma0 |z| / mu_s - 1)+)``, which only takes
energy: where the load is nearly gone, and where a falling load has left them more friction than
breakaway. At constant load they never are. (Relaxation is part of the damping sigma1 too, which is
harmless while sigma1^2 R is far below 4 sigma0 sigma2.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.foundation.numerics import Array

ELASTO_PLASTIC = 0.7
"""Usual value of `Friction.elastic`: bristles yield from 0.7 of their deflection in fast sliding.
Assumption.
"""

LOAD_SCALE_N = 1e-3
"""N0, a load far below all that matter [N].
It keeps the model smooth where contact begins and ends.
"""
RELAXATION_S = 1e-3
"""Time in which bristles without contact straighten up [s]. Assumption.

The loops take it as an argument: numba's cache would not notice a change of a constant in another
file.
"""
RELAX_PER_S = 1 / RELAXATION_S
"""Rate R of this relaxation [1/s]."""
STICK_SLIP_STRIBECK_M_S = 0.06
"""Stribeck velocity of `Friction.with_stick_slip` [m/s]: friction still falls at the article's
speeds. Assumption.
"""
MAX_MU = 100.0
"""Largest static friction: no surface holds a hundred times its load, and steps for stuck pads are
too long beyond.
"""
GROSS_SLIP_M_S = 1e-3
"""Sliding speed above which slip is gross [m/s].
Assumption: 1/40 of the article's slowest slide.
"""

Velocity = TypeVar("Velocity", float, Array)


def stribeck_fraction(mu_c: float, mu_s: float, ratio: Velocity) -> tuple[Velocity, Velocity]:
    """Compute numerator and denominator of the Stribeck curve g from v / vs: loops need fewer
    divisions.
    """
    square = ratio * ratio
    return mu_s + mu_c * square, 1 + square


@dataclass(frozen=True)
class Friction:
    """LuGre friction of one surface, per newton of normal force. Raises TraceError."""

    mu_s: float
    """Static (breakaway) coefficient of friction."""
    mu_c: float
    """Kinetic coefficient of friction, at high speed."""
    stribeck_m_s: float = 0.005
    """Stribeck velocity, at which half of the drop from `mu_s` to `mu_c` has happened [m/s].
    Assumption.
    """
    sigma0: float = 25e3
    """Bristle stiffness [1/m]. Assumption: breakaway after some 20 um."""
    sigma1: float = 2.0
    """Bristle damping [s/m]. Assumption within the passivity bound."""
    sigma2: float = 0.6
    """Viscous friction [s/m]. Assumption: at 8 cm/s it adds 0.05 to the coefficient."""
    elastic: float = 0.0
    """Fraction of ``mu_c / sigma0`` up to which bristles bend elastically.
    0 is plain LuGre friction.
    """

    def __post_init__(self) -> None:
        issues = [
            Issue(f"friction.{name}", f"{value:g} is refused; it must be a finite number above 0.")
            for name, value in vars(self).items()
            if name != "elastic" and not (math.isfinite(value) and value > 0.0)
        ]
        if not 0.0 <= self.elastic <= 0.99:
            issues.append(
                Issue("friction.elastic", f"{self.elastic:g} is refused; choose 0 (plain) to 0.99.")
            )
        if not issues and self.mu_s > MAX_MU:
            issues.append(Issue("friction.mu_s", f"{self.mu_s:g} is refused; at most {MAX_MU:g}."))
        if not issues and self.mu_s < self.mu_c:
            issues.append(
                Issue("friction.mu_s", f"{self.mu_s:g} is below mu_c; at least {self.mu_c:g}.")
            )

        if not issues and not self.is_passive:
            maximum = self.sigma2 * self.mu_c / (self.mu_s - self.mu_c)
            message = f"{self.sigma1:g} s/m lets bristles deliver energy; below {maximum:g}."
            issues.append(Issue("friction.sigma1", message))

        raise_issues(TraceError, issues)

    def with_stick_slip(self) -> Friction:
        """Friction that falls with speed so far and so widely that a pad swings on its mount.

        Assumption.

        From 0.03 to 0.08 m/s and from some 2 N on the pad also sticks at moments, a straight one
        from 3 N on. Slower slides stay smooth, because the curve is flat there, and at light loads
        the damping of the mount is stronger.
        """
        return Friction(
            mu_s=2.2 * self.mu_c,
            mu_c=self.mu_c,
            stribeck_m_s=STICK_SLIP_STRIBECK_M_S,
            sigma0=self.sigma0,
            sigma1=0.1,
            sigma2=0.15,
        )

    @property
    def max_ratio(self) -> float:
        """Ratio of `mu_s` to `mu_c` below which friction is passive."""
        return 1 + self.sigma2 / self.sigma1

    @property
    def is_passive(self) -> bool:
        """True if friction only ever takes energy: ``sigma2 > sigma1 (mu_s - mu_c) / mu_c``.

        The bound holds for plain LuGre friction (N. Barabanov, R. Ortega, IEEE Trans. Automatic
        Control 45(4), 2000, doi:10.1109/9.847131). Elasto-plastic bristles yield less, so the same
        bound serves for them. The tests ``test_friction_is_passive`` look for a counterexample with
        both kinds of bristles.
        """
        return self.sigma2 * self.mu_c > self.sigma1 * (self.mu_s - self.mu_c)

    def is_gross_slip(
        self, velocity_m_s: Array, bristle_m: Array, load_n: Array
    ) -> NDArray[np.bool_]:
        """Return where the contact slides faster than `GROSS_SLIP_M_S`.

        Without load nothing slides.
        """
        return (self.sliding_speed_m_s(velocity_m_s, bristle_m) > GROSS_SLIP_M_S) & (load_n > 0.0)

    def sliding_speed_m_s(self, velocity_m_s: Array, bristle_m: Array) -> Array:
        """Speed at which the contact slides [m/s]: the part of the velocity that does not bend
        bristles, ``v - dz/dt``.

        A pad that is pulled creeps as long as it sticks. Its bent bristles spring back when it is
        released, so bending is no slip. The remaining motion does not spring back: it is the
        plastic displacement of Dupont et al.
        """
        v = np.abs(velocity_m_s)
        z = np.abs(bristle_m)
        top, bottom = stribeck_fraction(self.mu_c, self.mu_s, v / self.stribeck_m_s)
        g = top / bottom
        speed = self.sigma0 * v * z / g

        if self.elastic:
            # alpha(v, z) of Dupont et al.: 0 below the elastic limit and for bristles that
            # straighten up, 1 in sliding.
            minimum = self.elastic * self.mu_c
            fraction = np.clip((self.sigma0 * z - minimum) / (g - minimum), 0.0, 1.0)
            speed = np.where(
                velocity_m_s * bristle_m > 0.0,
                fraction * fraction * (3 - 2 * fraction) * speed,
                0.0,
            )

        return np.asarray(speed, dtype=np.float64)
