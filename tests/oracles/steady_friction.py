"""Steady-state LuGre friction in closed form (Canudas de Wit et al. 1995)."""

from __future__ import annotations

import math

from fingertip.sim.contact.friction import Friction


def stribeck_coefficient(friction: Friction, v: float) -> float:
    """Stribeck curve g(v): coefficient that the bristles carry in steady sliding at `v` [m/s]."""
    return friction.mu_c + (friction.mu_s - friction.mu_c) / (1 + (v / friction.stribeck_m_s) ** 2)


def steady_coefficient(friction: Friction, v: float) -> float:
    """Coefficient of friction in steady sliding at `v` [m/s], with the sign of `v`."""
    return math.copysign(stribeck_coefficient(friction, v), v) + friction.sigma2 * v if v else 0.0
