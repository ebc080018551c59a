"""Motion of a grasped object along the direction of slip: weight, impact of a pin, friction at each
finger.

States: position X [m] and velocity V [m/s] of the object; for each pad, position x [m] and velocity
v [m/s] relative to its finger and bristle state s [m sqrt(N)]. With w = v - V, the velocity of the
pad over the object, normal forces N, and LuGre friction as in `fingertip.sim.contact.friction`:

    z       = c s,   c = 1 / sqrt(N + N0),   L = w - sigma0 |w| z / g(w)
    ds/dt   = N c L - r(N, z) s
    mu      = sigma0 z + sigma1 c ds/dt + sigma2 w
    m dv/dt = -k x - d v - N mu
    M dV/dt = weight + sum N mu + pin,   pin = kp (p + lambda |p| dp/dt),   p = Xp - X

Xp is the position of the pin. Its contact model is that of Hunt and Crossley (Trans. ASME J.
Applied Mechanics 42(2), 1975, doi:10.1115/1.3423596). Unless it is attached, it never pulls: where
p or this force is negative, it is 0. The method is ROS2 with the analytic Jacobian, as in
`fingertip.sim.contact.tangential`. The fingers are coupled through the velocity of the object only,
so each one is eliminated by itself, and one scalar equation for the object remains.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

import numpy as np

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.friction import (
    LOAD_SCALE_N,
    RELAX_PER_S,
    ROS2_GAMMA,
    Curve,
    Friction,
    stribeck,
)
from fingertip.sim.contact.tangential import MAX_DAMPING, MAX_PHASE, Mount

PAD_STATES = 3
"""Number of states of each pad: x, v, s. The pads come first in the state."""
OBJECT_X, OBJECT_V, HAS_LEFT = range(3)
"""Indices of the object's states, counted from the end of the pads' states."""
OBJECT_STATES = 3
"""Number of states of the object: X, V, and 1 once it has left the fingers."""
PIN_PHASE = 0.15
"""Longest step, as the angle by which the object swings on the pin in one step [rad]: less than on
the bristles, as a pin that is attached hardly damps, and goes on ringing.
"""
_A, _B, _PIVOT_S, _J_SW, _PIVOT_V, _J_VS, _RS1, _DRIFT_S, _DRIFT_V, _C1 = range(10)
_KX1, _KV1, _KS1, _S, _E, _RX, _RS2, _SLIDING, _MOST = range(10, 19)
"""Indices of the values kept for each finger between the parts of a step, named like the variables
of the loop.
"""
SCRATCH_SIZE = 19


def pin_n(
    k: float,
    damping: float,
    attached: float,
    X: float,
    V: float,
    Xp: float,
    Vp: float,
) -> float:
    """Force of the pin on the object [N], which pulls only if it is attached (Hunt and Crossley
    1975).
    """
    depth = Xp - X
    if attached > 0.0:
        return k * depth * (1 + damping * (Vp - V if depth >= 0.0 else V - Vp))
    if depth <= 0.0:
        return 0.0

    f = k * depth * (1 + damping * (Vp - V))
    return f if f > 0.0 else 0.0


def relax_rate(full: float, load_ratio: float, stretch: float) -> tuple[float, float]:
    """Rate at which bristles relax from R, N / N0 and sigma0 z / mu_s, and its derivative by s,
    times s.
    """
    r = full * (1 - load_ratio) if load_ratio < 1.0 else 0.0
    stretch = stretch if stretch >= 0.0 else -stretch
    if stretch <= 1.0:
        return r, 0.0

    return r + full * (stretch - 1), full * stretch


def _grasp_loop(
    curve: Curve,
    sigma: tuple[float, float, float, float, float],
    h: float,
    mass: float,
    pin: tuple[float, float, float],
    exit_x: float,
    count: int,
    length: int,
    mount: Floats,
    weight: Floats,
    pin_x: Floats,
    pin_v: Floats,
    state: MutableFloats,
    scratch: MutableFloats,
    load: MutableFloats,
    x_out: MutableFloats,
    over_object: MutableFloats,
    z_out: MutableFloats,
    object_out: MutableFloats,
    pin_out: MutableFloats,
) -> None:
    # Parameters: bristle coefficients s0, s1, s2, their rate of relaxation, N0; stiffness and
    # damping of the pin, 1 if it is attached. Arrays hold one finger after the other: mount (mass,
    # stiffness, damping), state (x, v, s), load.
    s0, s1, s2, relax_per_s, N0 = sigma
    per_mu_s = 1 / (curve[0] + curve[1])
    kp, damping, attached = pin
    G = ROS2_GAMMA * h
    target = PAD_STATES * count  # index of the object's first state
    X = state[target + OBJECT_X]
    V = state[target + OBJECT_V]
    has_left = state[target + HAS_LEFT]

    for j in range(length):
        # No finger touches an object that has left.
        if has_left > 0.0:
            for i in range(count):
                load[i * (length + 1) + j + 1] = 0.0

        # First stage, object: forces of weight and pin at the start of the step, their time
        # derivative (drift, from the differences over the step) and their derivatives by X and V.
        P0 = pin_n(kp, damping, attached, X, V, pin_x[j], pin_v[j])
        P1 = pin_n(kp, damping, attached, X, V, pin_x[j + 1], pin_v[j + 1])
        jx = jv = 0.0

        if P0 > 0.0 or attached > 0.0:
            depth = pin_x[j] - X
            side = 1.0 if depth >= 0.0 else -1.0
            jx = -kp * (1 + side * damping * (pin_v[j] - V)) / mass
            jv = -kp * side * damping * depth / mass

        dV = (weight[j] + P0) / mass
        drift_V = ROS2_GAMMA * (weight[j + 1] - weight[j] + P1 - P0) / mass
        # diagonal * kV = rhs is the scalar equation of the object; each finger adds to both sides.
        diagonal = 1 - G * jv - G * G * jx
        rhs = 0.0

        for i in range(count):
            # Friction of this finger: ds/dt, and its derivatives J_ss by s and J_sw by w.
            m = mount[3 * i]
            k = mount[3 * i + 1]
            d = mount[3 * i + 2]
            x = state[3 * i]
            v = state[3 * i + 1]
            s = state[3 * i + 2]
            N = load[i * (length + 1) + j]
            N1 = load[i * (length + 1) + j + 1]
            w = v - V
            g, dg = stribeck(curve, w)
            speed = w if w >= 0.0 else -w
            c = 1 / math.sqrt(N + N0)
            z = c * s
            grip = N * c
            slides = grip * c * s0 * speed / g
            relax, steeper = relax_rate(relax_per_s, N / N0, s0 * z * per_mu_s)
            J_ss = -slides - relax - steeper
            J_sw = grip * (1 - s0 * z * ((1.0 if w >= 0.0 else -1.0) - speed * dg / g) / g)
            ds = grip * w - (slides + relax) * s
            mu = s0 * z + s1 * c * ds + s2 * w
            dv = (-k * x - d * v - N * mu) / m

            # Rates at the end of the step for the present state: the step times the partial
            # derivative by time.
            c1 = 1 / math.sqrt(N1 + N0)
            relax, _ = relax_rate(relax_per_s, N1 / N0, s0 * c1 * s * per_mu_s)
            late = N1 * c1 * (w - c1 * s0 * speed / g * s) - relax * s
            change = N1 * (s0 * c1 * s + s1 * c1 * late + s2 * w) - N * mu
            drift_s = ROS2_GAMMA * (late - ds)
            drift_v = -ROS2_GAMMA * change / m
            dV += N * mu / mass
            drift_V += ROS2_GAMMA * change / mass

            # Row v of the finger's Jacobian: J_vx, J_vv, J_vs, and J_vV = e / m. Eliminating x and
            # s leaves kv = A + B kV, and with it the finger's contribution to the object's
            # equation.
            J_vx = -k / m
            e = N * (s1 * c * J_sw + s2)
            J_vv = -(d + e) / m
            J_vs = -grip * (s0 + s1 * J_ss) / m
            pivot_s = 1 / (1 - G * J_ss)
            pivot_v = 1 / (1 - G * (J_vv + G * (J_vx + J_vs * J_sw * pivot_s)))
            rs = ds + drift_s
            A = (dv + drift_v + G * (J_vx * v + J_vs * pivot_s * rs)) * pivot_v
            B = G * (e / m - G * J_vs * J_sw * pivot_s) * pivot_v
            S = -J_vs * m / mass
            E = e / mass
            diagonal += G * E - G * (E * B + S * pivot_s * G * J_sw * (B - 1))
            rhs += G * (E * A + S * pivot_s * (rs + G * J_sw * A))
            offset = SCRATCH_SIZE * i
            scratch[offset + _A] = A
            scratch[offset + _B] = B
            scratch[offset + _PIVOT_S] = pivot_s
            scratch[offset + _PIVOT_V] = pivot_v
            scratch[offset + _J_SW] = J_sw
            scratch[offset + _J_VS] = J_vs
            scratch[offset + _RS1] = rs
            scratch[offset + _DRIFT_S] = drift_s
            scratch[offset + _DRIFT_V] = drift_v
            scratch[offset + _C1] = c1
            scratch[offset + _S] = S
            scratch[offset + _E] = E
            scratch[offset + _MOST] = g

        kV1 = (dV + drift_V + G * jx * V + rhs) / diagonal
        kX1 = V + G * kV1

        # Second stage, object: right-hand side at the end of the step, solved with the same matrix.
        Xe = X + h * kX1
        Ve = V + h * kV1
        dV = (
            weight[j + 1] + pin_n(kp, damping, attached, Xe, Ve, pin_x[j + 1], pin_v[j + 1])
        ) / mass
        rhs = 0.0

        for i in range(count):
            m = mount[3 * i]
            k = mount[3 * i + 1]
            d = mount[3 * i + 2]
            x = state[3 * i]
            v = state[3 * i + 1]
            s = state[3 * i + 2]
            N1 = load[i * (length + 1) + j + 1]
            offset = SCRATCH_SIZE * i
            pivot_s = scratch[offset + _PIVOT_S]
            pivot_v = scratch[offset + _PIVOT_V]
            J_sw = scratch[offset + _J_SW]
            J_vs = scratch[offset + _J_VS]
            c1 = scratch[offset + _C1]
            # First-stage increments of this finger, from the object's.
            kv1 = scratch[offset + _A] + scratch[offset + _B] * kV1
            kx1 = v + G * kv1
            ks1 = pivot_s * (scratch[offset + _RS1] + G * J_sw * (kv1 - kV1))
            xe = x + h * kx1
            ve = v + h * kv1
            se = s + h * ks1
            # Friction at the end of the step, and the finger's contribution to the object's
            # equation.
            w = ve - Ve
            g, _ = stribeck(curve, w)
            most = g if g > scratch[offset + _MOST] else scratch[offset + _MOST]
            z = c1 * se

            if s0 * abs(z) > 2 * most and abs(se) > abs(s):
                # Bristles bent beyond sliding only straighten up. The step is longer than they are:
                # they slide.
                z = (g if w >= 0.0 else -g) / s0
                se = z / c1

            scratch[offset + _SLIDING] = g
            scratch[offset + _MOST] = most
            relax, _ = relax_rate(relax_per_s, N1 / N0, s0 * z * per_mu_s)
            ds = N1 * c1 * (w - s0 * (w if w >= 0.0 else -w) * z / g) - relax * se
            mu = s0 * z + s1 * c1 * ds + s2 * w
            dv = (-k * xe - d * ve - N1 * mu) / m
            dV += N1 * mu / mass
            rx = ve - 2 * kx1
            rv = dv - scratch[offset + _DRIFT_V] - 2 * kv1
            rs = ds - scratch[offset + _DRIFT_S] - 2 * ks1
            A = (rv + G * (-k / m * rx + J_vs * pivot_s * rs)) * pivot_v
            rhs += G * (
                scratch[offset + _E] * A + scratch[offset + _S] * pivot_s * (rs + G * J_sw * A)
            )
            scratch[offset + _A] = A
            scratch[offset + _KX1] = kx1
            scratch[offset + _KV1] = kv1
            scratch[offset + _KS1] = ks1
            scratch[offset + _RX] = rx
            scratch[offset + _RS2] = rs

        # New state of the object: y + h (3/2 k1 + 1/2 k2).
        rX = Ve - 2 * kX1
        kV2 = (dV - drift_V - 2 * kV1 + G * jx * rX + rhs) / diagonal
        kX2 = rX + G * kV2
        X += h * (1.5 * kX1 + 0.5 * kX2)
        V += h * (1.5 * kV1 + 0.5 * kV2)
        if exit_x < X and has_left == 0.0:
            has_left = 1.0

        if has_left > 0.0:
            # the object has left the fingers; its fall does not matter here
            X = exit_x
            V = 0.0

        # New state of each pad, and outputs.
        for i in range(count):
            offset = SCRATCH_SIZE * i
            kx1 = scratch[offset + _KX1]
            kv1 = scratch[offset + _KV1]
            ks1 = scratch[offset + _KS1]
            kv2 = scratch[offset + _A] + scratch[offset + _B] * kV2
            kx2 = scratch[offset + _RX] + G * kv2
            ks2 = scratch[offset + _PIVOT_S] * (
                scratch[offset + _RS2] + G * scratch[offset + _J_SW] * (kv2 - kV2)
            )
            state[3 * i] += h * (1.5 * kx1 + 0.5 * kx2)
            state[3 * i + 1] += h * (1.5 * kv1 + 0.5 * kv2)
            before = abs(state[3 * i + 2])
            state[3 * i + 2] += h * (1.5 * ks1 + 0.5 * ks2)
            w = state[3 * i + 1] - V
            s = state[3 * i + 2]
            z = scratch[offset + _C1] * s

            if s0 * abs(z) > 2 * scratch[offset + _MOST] and abs(s) > before:
                z = (scratch[offset + _SLIDING] if w >= 0.0 else -scratch[offset + _SLIDING]) / s0
                state[3 * i + 2] = z / scratch[offset + _C1]

            x_out[i * length + j] = state[3 * i]
            over_object[i * length + j] = w
            z_out[i * length + j] = z
            if has_left > 0.0:
                load[i * (length + 1) + j + 1] = 0.0

        object_out[j] = X
        pin_out[j] = (
            0.0
            if has_left > 0.0
            else pin_n(kp, damping, attached, X, V, pin_x[j + 1], pin_v[j + 1])
        )

    state[target + OBJECT_X] = X
    state[target + OBJECT_V] = V
    state[target + HAS_LEFT] = has_left


_advance = CompiledLoop(_grasp_loop, stribeck, pin_n, relax_rate, samples="x_out", plain_us=6.0)
"""Advances the grasp over a chunk.

The state (x, v, s of each pad; X, V and whether the object has left) and the scratch values are
carried from chunk to chunk. Loads become 0 once the object has left. The outputs are, at the end of
each step: position of each pad, its velocity w over the object, its bristle deflection, position of
the object, and force of the pin.
"""


@dataclass(frozen=True)
class Pin:
    """Contact of the pin with the object."""

    stiffness_n_per_m: float
    damping_s_per_m: float
    is_attached: bool
    speed_m_s: float
    """Largest velocity."""


@dataclass(frozen=True)
class HeldObject:
    """Object between pads."""

    friction: Friction
    mounts: tuple[Mount, ...]
    """Mount of each finger's pad."""
    mass_kg: float
    length_m: float
    """Distance after which it has left the fingers."""
    pin: Pin

    def count_parts(self, max_load_n: float, step_s: float) -> int:
        """Return the number of parts into which a step is divided, so that they resolve all motion
        under a load.

        Pads and object swing against each other on the bristles of all fingers, and the object on
        the pin. Thumb and fingers press alike.
        """
        friction = self.friction
        pin = self.pin
        rate = 0.0
        on_pin = (
            pin.stiffness_n_per_m * (1 + 2 * pin.damping_s_per_m * pin.speed_m_s) / self.mass_kg
        )

        for mount in self.mounts:
            per_kg = 1 / mount.mass_kg + 2 / self.mass_kg
            on_bristles = (
                mount.stiffness_n_per_m / mount.mass_kg + max_load_n * friction.sigma0 * per_kg
            )
            turns = math.sqrt(on_bristles / MAX_PHASE**2 + on_pin / PIN_PHASE**2)
            damping = max_load_n * (friction.sigma1 + friction.sigma2) * per_kg / MAX_DAMPING
            rate = max(rate, turns, damping)

        return max(1, math.ceil(step_s * rate))


@dataclass(frozen=True, eq=False)
class GraspMotion:
    """Motion at the end of each step, of each pad (fingers, steps) and of the object (steps,)."""

    load_n: Array
    """Force of each finger, 0 once the object has left."""
    position_m: Array
    """Position of each pad relative to its finger."""
    over_object_m_s: Array
    bristle_m: Array
    object_m: Array
    pin_n: Array


class Grasp:
    """Held object and its pads in motion, at rest before the first chunk, with steps that are
    divided into parts.
    """

    def __init__(self, held: HeldObject, step_s: float, parts: int) -> None:
        friction = held.friction
        mounts = held.mounts
        pin = held.pin
        self.parts = parts
        self._constants = (
            friction.curve,
            (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S, LOAD_SCALE_N),
            step_s / parts,
            held.mass_kg,
            (pin.stiffness_n_per_m, pin.damping_s_per_m, float(pin.is_attached)),
            held.length_m,
            len(mounts),
        )
        self._mounts = np.array([astuple(mount) for mount in mounts]).ravel()
        self._state = np.zeros(PAD_STATES * len(mounts) + OBJECT_STATES)
        self._scratch = np.zeros(SCRATCH_SIZE * len(mounts))

    @property
    def is_lost(self) -> bool:
        return bool(self._state[HAS_LEFT - OBJECT_STATES] > 0.0)

    def advance(
        self,
        load_n: Array,
        weight_n: Array,
        pin_m: Array,
        pin_m_s: Array,
    ) -> GraspMotion:
        """Advance by one step less than there are loads, (fingers, points).

        Weight, and position and velocity of the pin, are given at the ends of the parts of all
        steps.
        """
        count = len(load_n)
        length = len(weight_n) - 1
        load = refine(load_n, self.parts).ravel()
        pads = [np.zeros(count * length) for _ in range(3)]
        object_m = np.zeros(length)
        pin = np.zeros(length)
        _advance(
            *self._constants,
            length,
            self._mounts,
            weight_n,
            pin_m,
            pin_m_s,
            self._state,
            self._scratch,
            load,
            *pads,
            object_m,
            pin,
        )
        every = slice(self.parts - 1, None, self.parts)
        x, w, z = (values.reshape(count, -1)[:, every] for values in pads)

        return GraspMotion(
            load_n=load.reshape(count, -1)[:, 1:][:, every],
            position_m=x,
            over_object_m_s=w,
            bristle_m=z,
            object_m=object_m[every],
            pin_n=pin[every],
        )


def refine(values: Array, parts: int) -> Array:
    """Divide the steps between the points of each row into parts, by straight lines."""
    if parts == 1:
        return values.copy()

    fraction = np.arange(1, parts + 1) / parts
    steps = values[:, :-1, None] + (values[:, 1:] - values[:, :-1])[:, :, None] * fraction
    steps[:, :, -1] = values[:, 1:]
    return np.concatenate((values[:, :1], steps.reshape(len(values), -1)), axis=1)
