"""Motion of a grasped object along the direction of slip: weight, impact of a pin, friction at each finger.

States: position X [m] and velocity V [m/s] of the object; for each pad, position x [m] and velocity v [m/s] relative to
its finger and bristle deflection z [m]. With w = v - V, the velocity of the pad over the object, and normal forces N:

    dz/dt   = w - sigma0 |w| z / g(w)
    mu      = sigma0 z + sigma1 dz/dt + sigma2 w
    m dv/dt = -k x - c v - N mu
    M dV/dt = weight + sum N mu + pin,   pin = kp d (1 + lambda dd/dt), d = Xp - X > 0

Xp is the position of the pin. Its contact model is that of Hunt and Crossley (Trans. ASME J. Applied Mechanics 42(2),
1975, doi:10.1115/1.3423596). Friction is LuGre friction as in `fingertip.sim.contact.friction`. The method is ROS2 with
the analytic Jacobian, as in `fingertip.sim.contact.tangential`. The fingers are coupled through the velocity of the
object only, so each one is eliminated by itself, and one scalar equation for the object remains.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence

from fingertip.jit import CompiledLoop
from fingertip.sim.contact.friction import ROS2_GAMMA

PAD_STATES = 3
"""Number of states of each pad: x, v, z. The pads come first in the state."""
OBJECT_X, OBJECT_V, HAS_LEFT = range(3)
"""Indices of the object's states, counted from the end of the pads' states."""
OBJECT_STATES = 3
"""Number of states of the object: X, V, and 1 once it has left the fingers."""
_A, _B, _PIVOT_Z, _J_ZW, _PIVOT_V, _J_VZ, _DZ, _DRIFT, _KX1, _KV1, _KZ1, _S, _E, _RX, _RZ = range(15)
"""Indices of the values kept for each finger between the parts of a step, named like the variables of the loop."""
SCRATCH_SIZE = 15
"""Number of these values."""


def pin_n(k: float, damping: float, X: float, V: float, Xp: float, Vp: float) -> float:
    """Force of the pin on the object [N], which never pulls (Hunt and Crossley 1975)."""
    d = Xp - X
    if d <= 0.0:
        return 0.0
    f = k * d * (1 + damping * (Vp - V))
    return f if f > 0.0 else 0.0


def _grasp_loop(
    curve: tuple[float, float, float],
    sigma: tuple[float, float, float, float],
    h: float,
    mass: float,
    pin: tuple[float, float],
    exit_x: float,
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
    object_over_pad: MutableSequence[float],
    z_out: MutableSequence[float],
    object_out: MutableSequence[float],
    pin_out: MutableSequence[float],
) -> None:
    """Integrate object and pads by ROS2."""
    # Parameters: mu_c, drop = mu_s - mu_c, Stribeck velocity vs; bristle coefficients s0, s1, s2 and their rate of
    # relaxation; stiffness and damping of the pin. Arrays hold one finger after the other: mount (mass, stiffness,
    # damping), state (x, v, z), load.
    mu_c, drop, vs = curve
    s0, s1, s2, relax_per_s = sigma
    kp, damping = pin
    G = ROS2_GAMMA * h
    target = PAD_STATES * count  # index of the object's first state
    X, V, has_left = state[target + OBJECT_X], state[target + OBJECT_V], state[target + HAS_LEFT]
    for j in range(length):
        # No finger touches an object that has left.
        if has_left > 0.0:
            for i in range(count):
                load[i * (length + 1) + j + 1] = 0.0

        # First stage, object: forces of weight and pin at the start of the step, their time derivative (drift, from the
        # differences over the step) and their derivatives by X and V.
        P0 = pin_n(kp, damping, X, V, pin_x[j], pin_v[j])
        P1 = pin_n(kp, damping, X, V, pin_x[j + 1], pin_v[j + 1])
        jx = jv = 0.0
        if P0 > 0.0:
            d = pin_x[j] - X
            jx = -kp * (1 + damping * (pin_v[j] - V)) / mass
            jv = -kp * damping * d / mass
        dV = (weight[j] + P0) / mass
        drift_V = ROS2_GAMMA * (weight[j + 1] - weight[j] + P1 - P0) / mass
        # diagonal * kV = rhs is the scalar equation of the object; each finger adds to both sides.
        diagonal, rhs = 1 - G * jv - G * G * jx, 0.0
        for i in range(count):
            # LuGre friction of this finger: dz/dt, and its derivatives J_zz by z and J_zw by w.
            m, k, c = mount[3 * i], mount[3 * i + 1], mount[3 * i + 2]
            x, v, z = state[3 * i], state[3 * i + 1], state[3 * i + 2]
            N, N1 = load[i * (length + 1) + j], load[i * (length + 1) + j + 1]
            w = v - V
            ratio = w / vs
            denominator = 1 + ratio * ratio
            g = mu_c + drop / denominator
            speed = w if w >= 0.0 else -w
            if N > 0.0:
                J_zz = -s0 * speed / g
                dg = -2 * drop * ratio / (vs * denominator * denominator)
                J_zw = 1 - s0 * z * ((1.0 if w >= 0.0 else -1.0) - speed * dg / g) / g
                dz = w + J_zz * z
            else:
                J_zz, J_zw, dz = -relax_per_s, 0.0, -relax_per_s * z
            mu = s0 * z + s1 * dz + s2 * w
            dv = (-k * x - c * v - N * mu) / m
            drift = -ROS2_GAMMA * (N1 - N) * mu / m
            dV += N * mu / mass
            drift_V += ROS2_GAMMA * (N1 - N) * mu / mass

            # Row v of the finger's Jacobian: J_vx, J_vv, J_vz, and J_vV = e / m. Eliminating x and z leaves
            # kv = A + B kV, and with it the finger's contribution to the object's equation.
            J_vx = -k / m
            e = N * (s1 * J_zw + s2)
            J_vv = -(c + e) / m
            J_vz = -N * (s0 + s1 * J_zz) / m
            pivot_z = 1 / (1 - G * J_zz)
            pivot_v = 1 / (1 - G * (J_vv + G * (J_vx + J_vz * J_zw * pivot_z)))
            A = (dv + drift + G * (J_vx * v + J_vz * pivot_z * dz)) * pivot_v
            B = G * (e / m - G * J_vz * J_zw * pivot_z) * pivot_v
            S = -J_vz * m / mass
            E = e / mass
            diagonal += G * E - G * (E * B + S * pivot_z * G * J_zw * (B - 1))
            rhs += G * (E * A + S * pivot_z * (dz + G * J_zw * A))
            offset = SCRATCH_SIZE * i
            scratch[offset + _A], scratch[offset + _B] = A, B
            scratch[offset + _PIVOT_Z], scratch[offset + _PIVOT_V] = pivot_z, pivot_v
            scratch[offset + _J_ZW], scratch[offset + _J_VZ] = J_zw, J_vz
            scratch[offset + _DZ], scratch[offset + _DRIFT] = dz, drift
            scratch[offset + _S], scratch[offset + _E] = S, E
        kV1 = (dV + drift_V + G * jx * V + rhs) / diagonal
        kX1 = V + G * kV1

        # Second stage, object: right-hand side at the end of the step, solved with the same matrix.
        Xe, Ve = X + h * kX1, V + h * kV1
        dV = (weight[j + 1] + pin_n(kp, damping, Xe, Ve, pin_x[j + 1], pin_v[j + 1])) / mass
        rhs = 0.0
        for i in range(count):
            m, k, c = mount[3 * i], mount[3 * i + 1], mount[3 * i + 2]
            x, v, z = state[3 * i], state[3 * i + 1], state[3 * i + 2]
            N1 = load[i * (length + 1) + j + 1]
            offset = SCRATCH_SIZE * i
            pivot_z, pivot_v = scratch[offset + _PIVOT_Z], scratch[offset + _PIVOT_V]
            J_zw, J_vz = scratch[offset + _J_ZW], scratch[offset + _J_VZ]
            dz, drift = scratch[offset + _DZ], scratch[offset + _DRIFT]
            # First-stage increments of this finger, from the object's.
            kv1 = scratch[offset + _A] + scratch[offset + _B] * kV1
            kx1 = v + G * kv1
            kz1 = pivot_z * (dz + G * J_zw * (kv1 - kV1))
            xe, ve, ze = x + h * kx1, v + h * kv1, z + h * kz1
            # Friction at the end of the step, and the finger's contribution to the object's equation.
            w = ve - Ve
            ratio = w / vs
            g = mu_c + drop / (1 + ratio * ratio)
            dz = w - s0 * (w if w >= 0.0 else -w) * ze / g if N1 > 0.0 else -relax_per_s * ze
            mu = s0 * ze + s1 * dz + s2 * w
            dv = (-k * xe - c * ve - N1 * mu) / m
            dV += N1 * mu / mass
            rx, rv, rz = ve - 2 * kx1, dv - drift - 2 * kv1, dz - 2 * kz1
            A = (rv + G * (-k / m * rx + J_vz * pivot_z * rz)) * pivot_v
            rhs += G * (scratch[offset + _E] * A + scratch[offset + _S] * pivot_z * (rz + G * J_zw * A))
            scratch[offset + _A] = A
            scratch[offset + _KX1], scratch[offset + _KV1], scratch[offset + _KZ1] = kx1, kv1, kz1
            scratch[offset + _RX], scratch[offset + _RZ] = rx, rz

        # New state of the object: y + h (3/2 k1 + 1/2 k2).
        rX = Ve - 2 * kX1
        kV2 = (dV - drift_V - 2 * kV1 + G * jx * rX + rhs) / diagonal
        kX2 = rX + G * kV2
        X += h * (1.5 * kX1 + 0.5 * kX2)
        V += h * (1.5 * kV1 + 0.5 * kV2)
        if exit_x < X and has_left == 0.0:
            has_left = 1.0
        if has_left > 0.0:
            X, V = exit_x, 0.0  # the object has left the fingers; its fall does not matter here

        # New state of each pad, and outputs.
        for i in range(count):
            offset = SCRATCH_SIZE * i
            kx1, kv1, kz1 = scratch[offset + _KX1], scratch[offset + _KV1], scratch[offset + _KZ1]
            kv2 = scratch[offset + _A] + scratch[offset + _B] * kV2
            kx2 = scratch[offset + _RX] + G * kv2
            kz2 = scratch[offset + _PIVOT_Z] * (scratch[offset + _RZ] + G * scratch[offset + _J_ZW] * (kv2 - kV2))
            state[3 * i] += h * (1.5 * kx1 + 0.5 * kx2)
            state[3 * i + 1] += h * (1.5 * kv1 + 0.5 * kv2)
            state[3 * i + 2] += h * (1.5 * kz1 + 0.5 * kz2)
            x_out[i * length + j] = state[3 * i]
            object_over_pad[i * length + j] = V - state[3 * i + 1]  # -w
            z_out[i * length + j] = state[3 * i + 2]
            if has_left > 0.0:
                load[i * (length + 1) + j + 1] = 0.0
        object_out[j] = X
        pin_out[j] = 0.0 if has_left > 0.0 else pin_n(kp, damping, X, V, pin_x[j + 1], pin_v[j + 1])
    state[target + OBJECT_X], state[target + OBJECT_V], state[target + HAS_LEFT] = X, V, has_left


run = CompiledLoop(_grasp_loop, pin_n, outputs=8, samples="x_out", plain_us=4.5)
"""Advances the grasp over a chunk.

The state (x, v, z of each pad; X, V and whether the object has left) and the scratch values are carried from chunk to
chunk. Loads become 0 once the object has left. The outputs are, at the end of each step: position of each pad, velocity
of the object over it (the opposite of w), its bristle deflection, position of the object, and force of the pin.
"""
