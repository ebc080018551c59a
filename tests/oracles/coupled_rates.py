"""Right-hand sides of the coupled contact, without the derivatives that the loop computes beside them."""

from __future__ import annotations

import math

from fingertip.sim.contact.coupled_loop import bristle_rate, normal_rate


def rates(
    curve: tuple[float, float, float, float],
    sigma: tuple[float, float, float, float, float],
    mount: tuple[float, float, float],
    normal: tuple[float, float, float, float],
    pull: float,
    d: float,
    x: float,
    v: float,
    s: float,
    y: float,
    w: float,
) -> tuple[float, float, float]:
    """Return the right-hand sides dv/dt, ds/dt and dw/dt, as the equations in `fingertip.sim.contact.coupled` say.

    `pull` is ``(k X + c_m V) / m``, and `mount` holds k / m, c_m / m and 1 / m.
    """
    s0, s1, s2, _, n0 = sigma
    k_m, c_m, per_m = mount
    load = y if y > 0.0 else 0.0
    scale = 1 / math.sqrt(load + n0)
    ds = bristle_rate(curve, sigma, load, scale, v, s)
    dv = pull - k_m * x - c_m * v - load * per_m * (s0 * scale * s + s1 * scale * ds + s2 * v)
    return dv, ds, normal_rate(normal, d, y, w)
