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
p or this force is negative, it is 0. Between samples Xp is cubic; weight and normal forces are
linear. The method is that of `fingertip.sim.contact.dragged_pad_loop`, with the same control of its
error. The fingers are coupled through the velocity of the object only, so each one is eliminated by
itself, and one scalar equation for the object remains.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.dragged_pad import MAX_STEPS, TOLERANCE_N, Mount, weigh_errors
from fingertip.sim.contact.dragged_pad_loop import (
    A21,
    A31,
    A32,
    ACCEPTED,
    ALPHA2,
    ALPHA3,
    B1,
    B2,
    B3,
    B4,
    C21,
    C31,
    C32,
    C41,
    C42,
    C43,
    D1,
    D2,
    D3,
    D4,
    E1,
    E2,
    E4,
    FAILED_SAMPLE,
    GAMMA,
    GIVEN,
    MIN_STEP_RATIO,
    REJECTED,
    REST,
    REST_S,
    Bristles,
    Curve,
    bristle_rate,
    linearise,
    normal_rate,
)
from fingertip.sim.contact.friction import (
    LOAD_SCALE_N,
    RELAX_PER_S,
    Friction,
    stribeck_fraction,
)

PAD_STATES = 3
"""Number of states of each pad: x, v, s. The pads come first in the state."""
OBJECT_X, OBJECT_V, HAS_LEFT, STEP, MOVED = range(5)
"""Indices of what follows the pads' states: X, V, 1 once the object has left the fingers, length of
the next step [s], and present motion in `REST_S` as a share of the tolerance.
"""
OBJECT_STATES = 5
_PIVOT_S, _PIVOT_V, _Q, _J_SV, _J_VS, _LATE_V, _LATE_S, _DV, _DS, _A, _RX, _RS = range(12)
_UX = 12
_UV = 16
_US = 20
"""Indices of the values kept for each finger within a step, named like the variables of the loop.
The last three begin the increments of the four stages. Those of the object's X and V follow the
fingers.
"""
SCRATCH_SIZE = 24
STAGES = 4
_TIMES = (0.0, ALPHA2, ALPHA3, ALPHA3)
_STATES = ((0.0, 0.0, 0.0), (A21, 0.0, 0.0), (A31, A32, 0.0), (A31, A32, 0.0))
_SIDES = ((0.0, 0.0, 0.0), (C21, 0.0, 0.0), (C31, C32, 0.0), (C41, C42, C43))
_DERIVATIVES = (D1, D2, D3, D4)
_NEW = (B1, B2, B3, B4)
_ERRORS = (E1, E2, 0.0, E4)
"""Coefficients alpha_i, a_ij, c_ij, d_i, b_i and e_i of the method by stage."""


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


def combine(coefficients: tuple[float, float, float], stage: int, u: Floats, first: int) -> float:
    """Sum the increments of the stages before, each with its coefficient."""
    total = 0.0
    for k in range(stage):
        total += coefficients[k] * u[first + k]

    return total


def _grasp_loop(
    curve: Curve,
    sigma: Bristles,
    max_steps: int,
    H: float,
    mass: float,
    pin: tuple[float, float, float],
    exit_x: float,
    count: int,
    length: int,
    mount: Floats,
    weights: Floats,
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
    stats: MutableFloats,
) -> None:
    # Parameters: as in `dragged_pad_loop`; stiffness and damping of the pin, 1 if it is attached.
    # Arrays hold one finger after the other: mount (stiffness and damping per mass, inverse mass),
    # weights of the errors (x, v, s, and at the end X and V), state (x, v, s), load.
    s0, s1, s2, _, n0 = sigma
    kp, damping, attached = pin
    per_H = 1 / H
    target = PAD_STATES * count  # index of the object's first state
    object_u = SCRATCH_SIZE * count
    X = state[target + OBJECT_X]
    V = state[target + OBJECT_V]
    has_left = state[target + HAS_LEFT]
    h = state[target + STEP]
    moved = state[target + MOVED]
    steps = rejected = 0

    for j in range(length):
        # Drive between the samples: the pin's position is Xp + t (Vp + t (q2 + t q3)).
        Xp = pin_x[j]
        Vp = pin_v[j]
        rise = (pin_x[j + 1] - Xp) * per_H
        q2 = (3 * rise - 2 * Vp - pin_v[j + 1]) * per_H
        q3 = (Vp + pin_v[j + 1] - 2 * rise) * per_H * per_H
        falls = weight[j]
        falls_more = (weight[j + 1] - falls) * per_H

        # Nothing moves pads and an object that have come to rest, as long as weight, pin and loads
        # stay; loads on straight bristles may change.
        if attached > 0.0:
            is_still = Xp == pin_x[j + 1] and Vp == 0.0 and pin_v[j + 1] == 0.0
        else:
            is_still = Xp <= X and pin_x[j + 1] <= X

        is_still = is_still and moved < REST and falls_more == 0.0

        for i in range(count):
            at = i * (length + 1) + j
            # No finger touches an object that has left.
            if has_left > 0.0:
                load[at] = 0.0
                load[at + 1] = 0.0

            if load[at] != load[at + 1] and state[PAD_STATES * i + 2] != 0.0:
                is_still = False

        t = 0.0
        if is_still:
            t = H
            steps += 1

        attempts = 0

        while t < H:
            attempts += 1
            if attempts > max_steps:
                stats[FAILED_SAMPLE] = j + 1
                return

            h = max(h, MIN_STEP_RATIO * H)
            is_last = t + h >= H * (1 - 1e-9)
            if is_last:
                step = H - t
            elif t + 2 * h > H:
                step = 0.5 * (H - t)
            else:
                step = h

            per_step = 1 / step
            e = per_step / GAMMA
            per_e = GAMMA * step

            # The pin at the start of the step: its force, and the derivatives by X, V and time of
            # the acceleration that it gives.
            at_x = Xp + t * (Vp + t * (q2 + t * q3))
            at_v = Vp + t * (2 * q2 + 3 * q3 * t)
            pushed = 0.0 if has_left > 0.0 else pin_n(kp, damping, attached, X, V, at_x, at_v)
            jx = 0.0
            jv = 0.0

            if pushed != 0.0:
                depth = at_x - X
                side = 1.0 if depth >= 0.0 else -1.0
                jx = -kp * (1 + side * damping * (at_v - V)) / mass
                jv = -kp * side * damping * depth / mass

            late_V = -jx * at_v - jv * (2 * q2 + 6 * q3 * t)
            late_V += 0.0 if has_left > 0.0 else falls_more / mass
            diagonal = e - jx * per_e - jv

            # Each finger's rates and derivatives by its own states, and what it adds to the object.
            for i in range(count):
                k_m = mount[3 * i]
                c_m = mount[3 * i + 1]
                per_m = mount[3 * i + 2]
                N = load[i * (length + 1) + j]
                slope = (load[i * (length + 1) + j + 1] - N) * per_H
                x = state[3 * i]
                v = state[3 * i + 1]
                dv, ds, _, J_vv, J_vs, J_vN, J_sv, J_ss, J_sN, _, _ = linearise(
                    curve,
                    sigma,
                    (k_m, c_m, per_m),
                    GIVEN,
                    -c_m * V,
                    0.0,
                    x,
                    v - V,
                    state[3 * i + 2],
                    N + slope * t,
                    0.0,
                )
                pivot_s = 1 / (e - J_ss)
                q = -(J_vv + c_m) - J_vs * pivot_s * J_sv
                pivot_v = 1 / (e + c_m + k_m * per_e + q)
                diagonal += q * (1 - pivot_v * q) / (per_m * mass)
                late_V -= J_vN * slope / (per_m * mass)
                offset = SCRATCH_SIZE * i
                scratch[offset + _PIVOT_S] = pivot_s
                scratch[offset + _PIVOT_V] = pivot_v
                scratch[offset + _Q] = q
                scratch[offset + _J_SV] = J_sv
                scratch[offset + _J_VS] = J_vs
                scratch[offset + _LATE_V] = step * J_vN * slope
                scratch[offset + _LATE_S] = step * J_sN * slope
                scratch[offset + _DV] = dv
                scratch[offset + _DS] = ds

            dV = 0.0

            for stage in range(STAGES):
                # The fourth stage has the argument of the third, and its rates.
                ts = t + _TIMES[stage] * step
                Xe = X + combine(_STATES[stage], stage, scratch, object_u)
                Ve = V + combine(_STATES[stage], stage, scratch, object_u + STAGES)
                rX = Ve + per_step * combine(_SIDES[stage], stage, scratch, object_u)
                rV = per_step * combine(_SIDES[stage], stage, scratch, object_u + STAGES)
                rV += _DERIVATIVES[stage] * step * late_V
                is_new = stage < STAGES - 1

                if is_new:
                    dV = 0.0
                    if has_left == 0.0:
                        at_x = Xp + ts * (Vp + ts * (q2 + ts * q3))
                        at_v = Vp + ts * (2 * q2 + 3 * q3 * ts)
                        dV = pin_n(kp, damping, attached, Xe, Ve, at_x, at_v)
                        dV = (dV + falls + falls_more * ts) / mass

                for i in range(count):
                    offset = SCRATCH_SIZE * i
                    k_m = mount[3 * i]
                    c_m = mount[3 * i + 1]
                    per_m = mount[3 * i + 2]
                    xe = state[3 * i] + combine(_STATES[stage], stage, scratch, offset + _UX)
                    ve = state[3 * i + 1] + combine(_STATES[stage], stage, scratch, offset + _UV)

                    if is_new:
                        if stage > 0:
                            N = load[i * (length + 1) + j]
                            N += (load[i * (length + 1) + j + 1] - N) * per_H * ts
                            scale = 1 / math.sqrt(N + n0)
                            se = state[3 * i + 2]
                            se += combine(_STATES[stage], stage, scratch, offset + _US)
                            ds = bristle_rate(curve, sigma, N, scale, ve - Ve, se)
                            mu = s0 * scale * se + s1 * scale * ds + s2 * (ve - Ve)
                            scratch[offset + _DS] = ds
                            scratch[offset + _DV] = -k_m * xe - c_m * ve - N * per_m * mu

                        dV -= (scratch[offset + _DV] + k_m * xe + c_m * ve) / (per_m * mass)

                    rx = ve + per_step * combine(_SIDES[stage], stage, scratch, offset + _UX)
                    r = scratch[offset + _DV] + _DERIVATIVES[stage] * scratch[offset + _LATE_V]
                    r += per_step * combine(_SIDES[stage], stage, scratch, offset + _UV)
                    rs = scratch[offset + _DS] + _DERIVATIVES[stage] * scratch[offset + _LATE_S]
                    rs += per_step * combine(_SIDES[stage], stage, scratch, offset + _US)
                    bent = scratch[offset + _J_VS] * scratch[offset + _PIVOT_S] * rs
                    a = scratch[offset + _PIVOT_V] * (r - k_m * per_e * rx + bent)
                    rV += (scratch[offset + _Q] * a - bent) / (per_m * mass)
                    scratch[offset + _RX] = rx
                    scratch[offset + _RS] = rs
                    scratch[offset + _A] = a

                UV = (rV + dV + jx * per_e * rX) / diagonal
                scratch[object_u + stage] = (rX + UV) * per_e
                scratch[object_u + STAGES + stage] = UV

                for i in range(count):
                    offset = SCRATCH_SIZE * i
                    uv = scratch[offset + _PIVOT_V] * scratch[offset + _Q] * UV
                    uv += scratch[offset + _A]
                    scratch[offset + _UX + stage] = (scratch[offset + _RX] + uv) * per_e
                    scratch[offset + _UV + stage] = uv
                    scratch[offset + _US + stage] = scratch[offset + _PIVOT_S] * (
                        scratch[offset + _RS] + scratch[offset + _J_SV] * (uv - UV)
                    )

            # Error: the largest of all states, each as a force relative to the tolerance.
            error = 0.0
            change = 0.0
            for n in range(target + 2):
                # Pads have three states with four increments each, then the object has two.
                offset = n // 3 * SCRATCH_SIZE + _UX + n % 3 * STAGES
                if n >= target:
                    offset = object_u + (n - target) * STAGES

                new = off = 0.0
                for k in range(STAGES):
                    new += _NEW[k] * scratch[offset + k]
                    off += _ERRORS[k] * scratch[offset + k]

                # NaN counts as too large.
                if not abs(off) * weights[n] <= error:
                    error = abs(off) * weights[n]

                change += abs(new) * weights[n]
                scratch[offset] = new

            factor = 6.0 if error <= 1e-6 else 0.9 / math.sqrt(math.sqrt(error))
            if factor > 6.0:
                factor = 6.0
            elif not factor > 0.15:
                factor = 0.15

            if error <= 1.0 or step <= MIN_STEP_RATIO * H:
                for i in range(count):
                    offset = SCRATCH_SIZE * i
                    state[3 * i] += scratch[offset + _UX]
                    state[3 * i + 1] += scratch[offset + _UV]
                    state[3 * i + 2] += scratch[offset + _US]

                X += scratch[object_u]
                V += scratch[object_u + STAGES]
                moved = change * REST_S * per_step
                steps += 1
                t = H if is_last else t + step
                # A step that a sample cut short is no reason to give up a longer one.
                h = max(h, step * factor) if is_last and factor > 1.0 else step * factor
                if h > 64 * H:
                    h = 64 * H

                if exit_x < X and has_left == 0.0:
                    # The object has left the fingers; its fall does not matter here.
                    has_left = 1.0
                    for i in range(count):
                        load[i * (length + 1) + j] = 0.0
                        load[i * (length + 1) + j + 1] = 0.0

                if has_left > 0.0:
                    X = exit_x
                    V = 0.0
            else:
                rejected += 1
                h = step * factor

        for i in range(count):
            x_out[i * length + j] = state[3 * i]
            over_object[i * length + j] = state[3 * i + 1] - V
            N = load[i * (length + 1) + j + 1]
            z_out[i * length + j] = state[3 * i + 2] / math.sqrt(N + n0)

        object_out[j] = X
        pin_out[j] = (
            0.0
            if has_left > 0.0
            else pin_n(kp, damping, attached, X, V, pin_x[j + 1], pin_v[j + 1])
        )

    state[target + OBJECT_X] = X
    state[target + OBJECT_V] = V
    state[target + HAS_LEFT] = has_left
    state[target + STEP] = h
    state[target + MOVED] = moved
    stats[ACCEPTED] = steps
    stats[REJECTED] = rejected


_advance = CompiledLoop(
    _grasp_loop,
    stribeck_fraction,
    bristle_rate,
    linearise,
    normal_rate,
    pin_n,
    combine,
    samples="x_out",
    plain_us=20.0,
)
"""Advances the grasp over a chunk.

The state and the scratch values are carried from chunk to chunk. Loads become 0 once the object has
left. The outputs are, at the samples: position of each pad, its velocity w over the object, its
bristle deflection, position of the object, and force of the pin; then the statistics.
"""


@dataclass(frozen=True)
class Pin:
    """Contact of the pin with the object."""

    stiffness_n_per_m: float
    damping_s_per_m: float
    is_attached: bool


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
    evaluations: int = 0
    """Number of evaluations of the right-hand side, at most: a sample at rest counts as a step."""


class Grasp:
    """Held object and its pads in motion, at rest before the first chunk. Raises TraceError."""

    def __init__(
        self, held: HeldObject, step_s: float, max_load_n: float, tolerance_n: float = TOLERANCE_N
    ) -> None:
        friction = held.friction
        mounts = held.mounts
        pin = held.pin
        self._constants = (
            (friction.mu_c, friction.mu_s, 1 / friction.stribeck_m_s, 0.0),
            (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S, LOAD_SCALE_N),
            MAX_STEPS,
            step_s,
            held.mass_kg,
            (pin.stiffness_n_per_m, pin.damping_s_per_m, float(pin.is_attached)),
            held.length_m,
            len(mounts),
        )
        per_kg = [
            (m.stiffness_n_per_m / m.mass_kg, m.damping_n_s_per_m / m.mass_kg, 1 / m.mass_kg)
            for m in mounts
        ]
        self._mounts = np.array(per_kg).ravel()
        weights = [weigh_errors(friction, m, max_load_n, step_s, tolerance_n) for m in mounts]
        of_object = np.max(weights, axis=0)[:2]
        self._weights = np.concatenate((np.ravel(weights), of_object))
        self._state = np.zeros(PAD_STATES * len(mounts) + OBJECT_STATES)
        self._state[STEP - OBJECT_STATES] = step_s
        self._scratch = np.zeros(SCRATCH_SIZE * len(mounts) + 2 * STAGES)
        self._samples = 0

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
        """Advance by one step of the grid less than there are loads, (fingers, points).

        Weight, and position and velocity of the pin, are given at the same points.
        """
        count = len(load_n)
        length = len(weight_n) - 1
        load = load_n.ravel().copy()
        pads = [np.zeros(count * length) for _ in range(3)]
        object_m = np.zeros(length)
        pin = np.zeros(length)
        stats = np.zeros(3)
        _advance(
            *self._constants,
            length,
            self._mounts,
            self._weights,
            weight_n,
            pin_m,
            pin_m_s,
            self._state,
            self._scratch,
            load,
            *pads,
            object_m,
            pin,
            stats,
        )
        failed = int(stats[FAILED_SAMPLE])
        if failed:
            problem = f"needs more than {MAX_STEPS} steps"
            remedy = "choose a heavier object, or a softer pin or surface."
            raise TraceError(Issue(f"point {self._samples + failed}", f"{problem}; {remedy}"))

        self._samples += length
        x, w, z = (values.reshape(count, -1) for values in pads)

        return GraspMotion(
            load_n=load.reshape(count, -1)[:, 1:],
            position_m=x,
            over_object_m_s=w,
            bristle_m=z,
            object_m=object_m,
            pin_n=pin,
            evaluations=3 * int(stats[ACCEPTED] + stats[REJECTED]),
        )
