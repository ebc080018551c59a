"""A grasped object along the way in which it can slip: its weight, a pin that hits it, friction at every finger.

States: X, V of the object [m, m/s]; of each pad x, v [m, m/s] against its finger and z of its bristles [m]. With
w = v - V, the pad's velocity over the object, and normal forces N:

    dz/dt   = w - sigma0 |w| z / g(w)
    mu      = sigma0 z + sigma1 dz/dt + sigma2 w
    m dv/dt = -k x - c v - N mu
    M dV/dt = weight + sum N mu + pin,   pin = kp d (1 + lambda dd/dt), d = Xp - X > 0

The pin is Hunt and Crossley's (Trans. ASME J. Applied Mechanics 42(2), 1975, doi:10.1115/1.3423596). ROS2 with the
analytic Jacobian, as in `sim.contact`; the fingers meet in the object's velocity only, so each is eliminated by itself.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence

from fingertip.jit import CompiledLoop

GAMMA = 1 - 1 / math.sqrt(2)
RELAX_PER_S = 1e3
"""Rate at which bristles that touch nothing straighten up. Assumption."""


WIDTH = 13
"""Numbers kept for each finger from the first stage to the second."""


def pin_n(k: float, damping: float, X: float, V: float, Xp: float, Vp: float) -> float:
    """The pin's force [N], never pulling."""
    d = Xp - X
    if d <= 0.0:
        return 0.0
    f = k * d * (1 + damping * (Vp - V))
    return f if f > 0.0 else 0.0


def _loop(
    curve: tuple[float, float, float],
    sigma: tuple[float, float, float],
    h: float,
    mass: float,
    pin: tuple[float, float],
    leaves: float,
    count: int,
    length: int,
    mount: Sequence[float],
    weight: Sequence[float],
    pin_x: Sequence[float],
    pin_v: Sequence[float],
    state: MutableSequence[float],
    scratch: MutableSequence[float],
    load: MutableSequence[float],
    x_out: MutableSequence[float],
    w_out: MutableSequence[float],
    z_out: MutableSequence[float],
    object_out: MutableSequence[float],
    pin_out: MutableSequence[float],
) -> None:
    mu_c, drop, vs = curve
    s0, s1, s2 = sigma
    kp, damping = pin
    G = GAMMA * h
    X, V, gone = state[3 * count], state[3 * count + 1], state[3 * count + 2]
    for j in range(length):
        if gone > 0.0:
            for i in range(count):
                load[i * (length + 1) + j + 1] = 0.0
        # First stage, with the Jacobian at the step's start.
        P0 = pin_n(kp, damping, X, V, pin_x[j], pin_v[j])
        P1 = pin_n(kp, damping, X, V, pin_x[j + 1], pin_v[j + 1])
        jx = jv = 0.0
        if P0 > 0.0:
            d = pin_x[j] - X
            jx = -kp * (1 + damping * (pin_v[j] - V)) / mass
            jv = -kp * damping * d / mass
        dV = (weight[j] + P0) / mass
        drift_V = GAMMA * (weight[j + 1] - weight[j] + P1 - P0) / mass
        down, right = 1 - G * jv - G * G * jx, 0.0
        for i in range(count):
            m, k, c = mount[3 * i], mount[3 * i + 1], mount[3 * i + 2]
            x, v, z = state[3 * i], state[3 * i + 1], state[3 * i + 2]
            N, N1 = load[i * (length + 1) + j], load[i * (length + 1) + j + 1]
            w = v - V
            ratio = w / vs
            denominator = 1 + ratio * ratio
            g = mu_c + drop / denominator
            speed = w if w >= 0.0 else -w
            if N > 0.0:
                a = -s0 * speed / g
                slope = -2 * drop * ratio / (vs * denominator * denominator)
                b = 1 - s0 * z * ((1.0 if w >= 0.0 else -1.0) - speed * slope / g) / g
                dz = w + a * z
            else:
                a, b, dz = -RELAX_PER_S, 0.0, -RELAX_PER_S * z
            mu = s0 * z + s1 * dz + s2 * w
            dv = (-k * x - c * v - N * mu) / m
            drift = -GAMMA * (N1 - N) * mu / m
            dV += N * mu / mass
            drift_V += GAMMA * (N1 - N) * mu / mass
            p = -k / m
            e = N * (s1 * b + s2)
            q = -(c + e) / m
            s = -N * (s0 + s1 * a) / m
            za = 1 / (1 - G * a)
            pivot = 1 / (1 - G * (q + G * (p + s * b * za)))
            # kv = A + B kV, kz = za (dz + G b (kv - kV)).
            A = (dv + drift + G * (p * v + s * za * dz)) * pivot
            B = G * (e / m - G * s * b * za) * pivot
            S = -s * m / mass
            E = e / mass
            down += G * E - G * (E * B + S * za * G * b * (B - 1))
            right += G * (E * A + S * za * (dz + G * b * A))
            at = WIDTH * i
            scratch[at], scratch[at + 1], scratch[at + 2], scratch[at + 3] = A, B, za, b
            scratch[at + 4], scratch[at + 5], scratch[at + 6], scratch[at + 7] = pivot, s, dz, drift
            scratch[at + 11], scratch[at + 12] = S, E
        kV1 = (dV + drift_V + G * jx * V + right) / down
        kX1 = V + G * kV1
        # Second stage at the step's end.
        Xe, Ve = X + h * kX1, V + h * kV1
        dV = (weight[j + 1] + pin_n(kp, damping, Xe, Ve, pin_x[j + 1], pin_v[j + 1])) / mass
        right = 0.0
        for i in range(count):
            m, k, c = mount[3 * i], mount[3 * i + 1], mount[3 * i + 2]
            x, v, z = state[3 * i], state[3 * i + 1], state[3 * i + 2]
            N1 = load[i * (length + 1) + j + 1]
            at = WIDTH * i
            za, b = scratch[at + 2], scratch[at + 3]
            pivot, s, dz, drift = scratch[at + 4], scratch[at + 5], scratch[at + 6], scratch[at + 7]
            kv1 = scratch[at] + scratch[at + 1] * kV1
            kx1 = v + G * kv1
            kz1 = za * (dz + G * b * (kv1 - kV1))
            xe, ve, ze = x + h * kx1, v + h * kv1, z + h * kz1
            w = ve - Ve
            ratio = w / vs
            g = mu_c + drop / (1 + ratio * ratio)
            dz = w - s0 * (w if w >= 0.0 else -w) * ze / g if N1 > 0.0 else -RELAX_PER_S * ze
            mu = s0 * ze + s1 * dz + s2 * w
            dv = (-k * xe - c * ve - N1 * mu) / m
            dV += N1 * mu / mass
            rx, rv, rz = ve - 2 * kx1, dv - drift - 2 * kv1, dz - 2 * kz1
            A = (rv + G * (-k / m * rx + s * za * rz)) * pivot
            right += G * (scratch[at + 12] * A + scratch[at + 11] * za * (rz + G * b * A))
            scratch[at], scratch[at + 6] = A, rz
            scratch[at + 8], scratch[at + 9], scratch[at + 10] = kx1, kv1, kz1
            scratch[at + 7] = rx
        rX = Ve - 2 * kX1
        kV2 = (dV - drift_V - 2 * kV1 + G * jx * rX + right) / down
        kX2 = rX + G * kV2
        X += h * (1.5 * kX1 + 0.5 * kX2)
        V += h * (1.5 * kV1 + 0.5 * kV2)
        if leaves < X and gone == 0.0:
            gone = 1.0
        if gone > 0.0:
            X, V = leaves, 0.0  # it has left; where it falls does not matter here
        for i in range(count):
            at = WIDTH * i
            kx1, kv1, kz1 = scratch[at + 8], scratch[at + 9], scratch[at + 10]
            kv2 = scratch[at] + scratch[at + 1] * kV2
            kx2 = scratch[at + 7] + G * kv2
            kz2 = scratch[at + 2] * (scratch[at + 6] + G * scratch[at + 3] * (kv2 - kV2))
            state[3 * i] += h * (1.5 * kx1 + 0.5 * kx2)
            state[3 * i + 1] += h * (1.5 * kv1 + 0.5 * kv2)
            state[3 * i + 2] += h * (1.5 * kz1 + 0.5 * kz2)
            x_out[i * length + j] = state[3 * i]
            w_out[i * length + j] = V - state[3 * i + 1]
            z_out[i * length + j] = state[3 * i + 2]
            if gone > 0.0:
                load[i * (length + 1) + j + 1] = 0.0
        object_out[j] = X
        pin_out[j] = 0.0 if gone > 0.0 else pin_n(kp, damping, X, V, pin_x[j + 1], pin_v[j + 1])
    state[3 * count], state[3 * count + 1], state[3 * count + 2] = X, V, gone


run = CompiledLoop(_loop, pin_n, outputs=8, samples="x_out", plain_us=9.0)
"""Carries state (x, v, z of each pad; X, V, gone) and scratch; sets loads to 0 where the object has left; fills each
pad's way, the object's velocity over it, its bristles' deflection, the object's way and the pin's force, at the end of
each step."""
