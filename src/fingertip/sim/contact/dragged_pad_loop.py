"""Loop of `fingertip.sim.contact.dragged_pad`: a Rosenbrock method on five states, with linear
systems in closed form.

The method is Shampine's (L. F. Shampine, ACM TOMS 8(2), 1982, doi:10.1145/355993.355994; form and
coefficients of E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., 1996,
section IV.7): linearly implicit, of order 4 with an embedded method of order 3, and A-stable; a
stiff component falls to a third in a step. Its four stages need three evaluations, as the fourth
has the argument of the third. One factorised matrix ``E = 1/(gamma h) - J`` serves all four solves:

    E u_i = f(t + alpha_i h, y + sum_j a_ij u_j) + sum_j c_ij u_j / h + d_i h df/dt
    y_new = y + sum_i b_i u_i, and sum_i e_i u_i estimates the error.

It is solved block by block, because y and w do not depend on the other states: y and w first, then
v, from which x and s follow.

On very stiff problems the order falls to 1 or 2. The loop is written out without arrays, because
numba and plain Python must both execute it fast and with the same bits.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence

from fingertip.foundation.jit import CompiledLoop
from fingertip.sim.contact.friction import stribeck_fraction

# Coefficients: gamma, times of the stages as fractions of the step, those of the time derivative,
# a_ij, c_ij, and those of the new state and of the error.
GAMMA = 0.5
ALPHA2 = 1.0
ALPHA3 = 0.6
D1 = 0.5
D2 = -1.5
D3 = 2.42
D4 = 0.116
A21 = 2.0
A31 = 1.92
A32 = 0.24
C21 = -8.0
C31 = 14.88
C32 = 2.4
C41 = -0.896
C42 = -0.432
C43 = -0.4
B1 = 19 / 9
B2 = 0.5
B3 = 25 / 108
B4 = 125 / 108
E1 = 17 / 54
E2 = 7 / 36
E4 = 125 / 108

MIN_STEP_RATIO = 1e-12
"""Shortest step as a fraction of the time between samples.
Such a step is accepted whatever its error; motion that is no number takes no longer one, and runs
out of steps.
"""
REST = 1e-3
REST_S = 1e-4
"""Motion, as a share of a step's tolerance, below which a pad has come to rest, and the time in
which it is counted [s].
"""
POSITION, VELOCITY, BRISTLE, COMPRESSION, RATE, STEP, MOVED = range(7)
"""Indices of what a chunk carries to the next one: the states x, v, s, y and w, the length of the
next step [s], and the present motion in `REST_S` as a share of the tolerance.
"""
ACCEPTED, REJECTED, FAILED_SAMPLE = range(3)
"""Indices of the statistics: accepted steps, of which a sample at rest counts as one; rejected
steps; and the sample at which the loop gave up, or 0.
"""

Curve = tuple[float, float, float, float]
Bristles = tuple[float, float, float, float, float]
Normal = tuple[float, float, float, float]
GIVEN: Normal = (0.0, 0.0, 0.0, 0.0)
"""Contact without a resonance: its force is the pressing force."""


def bristle_rate(
    curve: Curve,
    sigma: Bristles,
    load: float,
    scale: float,
    v: float,
    s: float,
) -> float:
    """Return ds/dt, with relaxation of bristles that hardly touch or are bent beyond breakaway.

    `scale` is c.
    """
    mu_c, mu_s, per_vs, elastic = curve
    s0, _, _, relax_per_s, n0 = sigma
    pull = s0 * scale * s
    top, bottom = stribeck_fraction(mu_c, mu_s, v * per_vs)
    creep = pull * (abs(v) * bottom) / top

    # alpha(v, z) of Dupont et al. 2002: 0 while bristles bend elastically or straighten up, 1 in
    # full sliding.
    if elastic > 0.0:
        fraction = (abs(pull) - elastic * mu_c) / (top / bottom - elastic * mu_c)
        if v * s <= 0.0 or fraction <= 0.0:
            creep = 0.0
        elif fraction < 1.0:
            creep *= fraction * fraction * (3 - 2 * fraction)

    ds = load * scale * (v - creep)
    if load < n0:
        ds -= relax_per_s * (1 - load / n0) * s
    if abs(pull) > mu_s:
        ds -= relax_per_s * (abs(pull) / mu_s - 1) * s

    return ds


def normal_rate(normal: Normal, d: float, y: float, w: float) -> float:
    """Return dw/dt: contact resonance while touching, the softer and slower hand in flight."""
    stiffness, damping, rho, flight_damping = normal
    if y > 0.0:
        return stiffness * (d - y) - damping * w

    return stiffness * (d - rho * y) - flight_damping * w


def linearise(
    curve: Curve,
    sigma: Bristles,
    mount: tuple[float, float, float],
    normal: Normal,
    pull: float,
    d: float,
    x: float,
    v: float,
    s: float,
    y: float,
    w: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """Return dv/dt, ds/dt and dw/dt, and the entries of the Jacobian that vary.

    These are J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, J_wy and J_ww. J_sv is the derivative of ds/dt by
    v, and so on. J_vx is -k / m, the only entries of the rows of x and y are 1, and all others are
    0. At y = 0 and at v = 0, where the right-hand side has corners, the derivatives are those of
    one side.
    """
    mu_c, mu_s, per_vs, elastic = curve
    s0, s1, s2, relax_per_s, n0 = sigma
    k_m, c_m, per_m = mount
    stiffness, damping, rho, flight_damping = normal
    load = y if y > 0.0 else 0.0
    scale = 1 / math.sqrt(load + n0)
    z = scale * s
    ratio = v * per_vs
    top, bottom = stribeck_fraction(mu_c, mu_s, ratio)
    per_product = 1 / (bottom * top)
    per_g = bottom * bottom * per_product
    # Derivatives: of g by v, divided by g; of alpha by v and z.
    dg_g = 2 * (mu_c - mu_s) * ratio * per_vs * per_product
    speed = abs(v)
    sign = 1.0 if v >= 0.0 else -1.0
    alpha = 1.0
    alpha_v = 0.0
    alpha_z = 0.0

    if elastic > 0.0:
        alpha = 0.0
        if v * s > 0.0:
            width = 1 / per_g - elastic * mu_c
            fraction = (s0 * abs(z) - elastic * mu_c) / width
            if fraction >= 1.0:
                alpha = 1.0
            elif fraction > 0.0:
                alpha = fraction * fraction * (3 - 2 * fraction)
                rise = 6 * fraction * (1 - fraction)
                alpha_z = rise * (s0 if s > 0.0 else -s0) / width
                alpha_v = -rise * fraction * dg_g / (per_g * width)

    # Bending rate L = v - alpha sigma0 |v| z / g of the bristles and its derivatives by v and z;
    # ds/dt = N c L - r s.
    flow = load * scale
    bending = v - alpha * s0 * speed * z * per_g
    L_v = 1 - s0 * z * per_g * (alpha * (sign - speed * dg_g) + alpha_v * speed)
    L_z = -s0 * speed * per_g * (alpha + alpha_z * z)
    ds = flow * bending
    J_sv = flow * L_v
    J_ss = flow * scale * L_z
    J_sy = 0.0
    scale_y = -0.5 * scale * scale * scale  # derivative of c by N
    if y > 0.0:
        J_sy = (scale + load * scale_y) * bending + flow * L_z * scale_y * s

    if load < n0:
        relax = relax_per_s * (1 - load / n0)
        ds -= relax * s
        J_ss -= relax
        if y > 0.0:
            J_sy += relax_per_s / n0 * s

    stretch = s0 * abs(z) / mu_s
    if stretch > 1.0:
        ds -= relax_per_s * (stretch - 1) * s
        J_ss -= relax_per_s * (2 * stretch - 1)
        if y > 0.0:
            J_sy -= relax_per_s * stretch * scale_y / scale * s

    mu = s0 * z + s1 * scale * ds + s2 * v
    dv = pull - k_m * x - c_m * v - load * per_m * mu
    J_vv = -c_m - load * per_m * (s1 * scale * J_sv + s2)
    J_vs = -flow * per_m * (s0 + s1 * J_ss)
    dw = normal_rate(normal, d, y, w)

    if y > 0.0:
        J_vy = -(mu + load * (scale_y * (s0 * s + s1 * ds) + s1 * scale * J_sy)) * per_m
        return dv, ds, dw, J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, -stiffness, -damping

    return dv, ds, dw, J_vv, J_vs, 0.0, J_sv, J_ss, J_sy, -stiffness * rho, -flight_damping


def _drag_loop(
    curve: Curve,
    sigma: Bristles,
    mount: tuple[float, float, float],
    normal: Normal,
    weights: tuple[float, float, float, float, float],
    max_steps: int,
    H: float,
    Xs: Sequence[float],
    Vs: Sequence[float],
    forces: Sequence[float],
    carried: MutableSequence[float],
    xs: MutableSequence[float],
    vs_out: MutableSequence[float],
    ss: MutableSequence[float],
    ys: MutableSequence[float],
    stats: MutableSequence[float],
) -> None:
    # Parameters: mu_c, mu_s, inverse of the Stribeck velocity, and elastic fraction; bristle
    # coefficients sigma, their rate of relaxation, and the load N0; stiffness k and damping c_m of
    # the mount per mass, and the inverse mass; omega^2 and 2 zeta omega of the normal resonance,
    # ratio of the hand's stiffness to the contact's, and damping in flight.
    s0, s1, s2, _, n0 = sigma
    k_m, c_m, per_m = mount
    weight_x, weight_v, weight_s, weight_y, weight_w = weights
    per_H = 1 / H
    is_given = normal[0] == 0.0

    x = carried[POSITION]
    v = carried[VELOCITY]
    s = carried[BRISTLE]
    y = carried[COMPRESSION]
    w = carried[RATE]
    h = carried[STEP]
    moved = carried[MOVED]
    xs[0] = x
    vs_out[0] = v
    ss[0] = s
    ys[0] = y
    steps = rejected = 0

    for i in range(len(Xs) - 1):
        X0 = Xs[i]
        V0 = Vs[i]
        X1 = Xs[i + 1]
        V1 = Vs[i + 1]
        d0 = forces[i]
        d1 = forces[i + 1]
        # Drive between the samples: cubic Hermite polynomial X = X0 + t (V0 + t (q2 + t q3)), and a
        # linear force d. The mount's pull (k X + c_m V) / m is then P0 + t (P1 + t (P2 + t P3)).
        q2 = (3 * (X1 - X0) * per_H - 2 * V0 - V1) * per_H
        q3 = ((V0 + V1) - 2 * (X1 - X0) * per_H) * per_H * per_H
        P0 = k_m * X0 + c_m * V0
        P1 = k_m * V0 + 2 * c_m * q2
        P2 = k_m * q2 + 3 * c_m * q3
        P3 = k_m * q3
        slope = (d1 - d0) * per_H
        t = 0.0
        attempts = 0

        if is_given:
            y = d0
            w = slope
            # Nothing moves a pad that has come to rest below its carriage, as long as the load
            # stays, or bristles are straight.
            if moved < REST and X0 == X1 and V0 == V1 == 0.0 and (d0 == d1 or s == 0.0):
                t = H
                y = d1
                steps += 1

        while t < H:
            attempts += 1
            if attempts > max_steps:
                stats[FAILED_SAMPLE] = i + 1
                return

            h = max(h, MIN_STEP_RATIO * H)
            # Step size: end exactly on the sample; two equal steps avoid a tiny last one. Usually a
            # step is a whole sample: its length then comes from a branch, which a processor
            # foresees, not from the error before it.
            is_last = t + h >= H * (1 - 1e-9)
            if is_last and t == 0.0:
                step = H
                per_step = per_H
            else:
                if is_last:
                    step = H - t
                elif t + 2 * h > H:
                    step = 0.5 * (H - t)
                else:
                    step = h

                per_step = 1 / step

            # Drive, right-hand side and Jacobian at the start of the step.
            pull = P0 + t * (P1 + t * (P2 + t * P3))
            dv, ds, dw, J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, J_wy, J_ww = linearise(
                curve, sigma, mount, normal, pull, d0 + slope * t, x, v, s, y, w
            )

            # Elimination in E = e - J with e = 1/(gamma h).
            e = per_step / GAMMA
            per_e = GAMMA * step
            e_w = e - J_ww
            e_s = e - J_ss
            row_x = -k_m * per_e
            pivot_y = 1 / (e * e_w - J_wy)
            pivot_s = 1 / e_s
            pivot_v = e_s / ((e - J_vv - row_x) * e_s - J_vs * J_sv)
            row_s = J_vs * pivot_s
            back_s = J_sv * pivot_s

            # Time derivatives of the drive, times the step.
            tv = step * (P1 + t * (2 * P2 + 3 * P3 * t))
            tw = step * normal[0] * slope

            # Stage 1. Each stage solves E u = right-hand side: for y and w, then for v, from which
            # x and s follow. Only ds/dt is not linear, so the sums are written such that they do
            # not wait for it.
            uy1 = (e_w * w + dw + D1 * tw) * pivot_y
            uw1 = e * uy1 - w
            r_s = J_sy * uy1
            r = row_x * v + dv + D1 * tv + J_vy * uy1 + row_s * r_s
            uv1 = r * pivot_v + row_s * pivot_v * ds
            ux1 = (v + uv1) * per_e
            us1 = (ds + r_s) * pivot_s + back_s * uv1

            # Stage 2.
            ts = t + ALPHA2 * step
            ye = y + A21 * uy1
            we = w + A21 * uw1
            c1 = C21 * per_step
            ry = we + c1 * uy1
            uy2 = (
                e_w * ry + (c1 * uw1 + D2 * tw) + normal_rate(normal, d0 + slope * ts, ye, we)
            ) * pivot_y
            uw2 = e * uy2 - ry
            load = ye if ye > 0.0 else 0.0
            scale = 1 / math.sqrt(load + n0)
            weight = load * per_m
            xe = x + A21 * ux1
            ve = v + A21 * uv1
            se = s + A21 * us1
            ds = bristle_rate(curve, sigma, load, scale, ve, se)
            rx = ve + (c1 * ux1)
            r_s = J_sy * uy2 + c1 * us1
            r = P0 + ts * (P1 + ts * (P2 + ts * P3)) + D2 * tv + J_vy * uy2 + c1 * uv1
            r += (
                row_x * rx
                + row_s * r_s
                - k_m * xe
                - (c_m + weight * s2) * ve
                - weight * scale * s0 * se
            )
            uv2 = r * pivot_v + (row_s - weight * scale * s1) * pivot_v * ds
            ux2 = (rx + uv2) * per_e
            us2 = (ds + r_s) * pivot_s + back_s * uv2

            # Stage 3.
            ts = t + ALPHA3 * step
            ye = y + A31 * uy1 + A32 * uy2
            we = w + A31 * uw1 + A32 * uw2
            c1 = C31 * per_step
            c2 = C32 * per_step
            ry = we + c1 * uy1 + c2 * uy2
            dw = normal_rate(normal, d0 + slope * ts, ye, we)
            uy3 = (e_w * ry + (c1 * uw1 + c2 * uw2 + D3 * tw) + dw) * pivot_y
            uw3 = e * uy3 - ry
            load = ye if ye > 0.0 else 0.0
            scale = 1 / math.sqrt(load + n0)
            weight = load * per_m
            xe = x + A31 * ux1 + A32 * ux2
            ve = v + A31 * uv1 + A32 * uv2
            se = s + A31 * us1 + A32 * us2
            ds = bristle_rate(curve, sigma, load, scale, ve, se)
            bent = (row_s - weight * scale * s1) * pivot_v * ds
            stage_pull = P0 + ts * (P1 + ts * (P2 + ts * P3))
            stage_pull -= k_m * xe + (c_m + weight * s2) * ve + weight * scale * s0 * se
            rx = ve + (c1 * ux1 + c2 * ux2)
            r_s = J_sy * uy3 + c1 * us1 + c2 * us2
            r = stage_pull + D3 * tv + J_vy * uy3 + c1 * uv1 + c2 * uv2 + row_x * rx + row_s * r_s
            uv3 = r * pivot_v + bent
            ux3 = (rx + uv3) * per_e
            us3 = (ds + r_s) * pivot_s + back_s * uv3

            # Stage 4, with the right-hand side of stage 3.
            c1 = C41 * per_step
            c2 = C42 * per_step
            c3 = C43 * per_step
            ry = we + c1 * uy1 + c2 * uy2 + c3 * uy3
            uy4 = (e_w * ry + (c1 * uw1 + c2 * uw2 + c3 * uw3 + D4 * tw) + dw) * pivot_y
            uw4 = e * uy4 - ry
            rx = ve + (c1 * ux1 + c2 * ux2 + c3 * ux3)
            r_s = J_sy * uy4 + c1 * us1 + c2 * us2 + c3 * us3
            r = (
                stage_pull
                + D4 * tv
                + J_vy * uy4
                + c1 * uv1
                + c2 * uv2
                + c3 * uv3
                + row_x * rx
                + row_s * r_s
            )
            uv4 = r * pivot_v + bent
            ux4 = (rx + uv4) * per_e
            us4 = (ds + r_s) * pivot_s + back_s * uv4

            # Error: the largest of the five, each as a force relative to the tolerance. The step
            # follows the fourth root of the error, because the estimate has order 3. NaN of any
            # state reaches x, the first argument: then the maximum is NaN, which counts as too
            # large.
            error = max(
                abs(E1 * ux1 + E2 * ux2 + E4 * ux4) * weight_x,
                abs(E1 * uv1 + E2 * uv2 + E4 * uv4) * weight_v,
                abs(E1 * us1 + E2 * us2 + E4 * us4) * weight_s,
                abs(E1 * uy1 + E2 * uy2 + E4 * uy4) * weight_y,
                abs(E1 * uw1 + E2 * uw2 + E4 * uw4) * weight_w,
            )
            factor = 6.0 if error <= 1e-6 else 0.9 / math.sqrt(math.sqrt(error))

            if factor > 6.0:
                factor = 6.0
            elif factor > 0.15:
                factor = factor
            else:
                factor = 0.15

            if error <= 1.0 or step <= MIN_STEP_RATIO * H:
                dx = B1 * ux1 + B2 * ux2 + B3 * ux3 + B4 * ux4
                dv = B1 * uv1 + B2 * uv2 + B3 * uv3 + B4 * uv4
                ds = B1 * us1 + B2 * us2 + B3 * us3 + B4 * us4
                moved = abs(dx) * weight_x + abs(dv) * weight_v + abs(ds) * weight_s
                moved *= REST_S * per_step
                x += dx
                v += dv
                s += ds
                y += B1 * uy1 + B2 * uy2 + B3 * uy3 + B4 * uy4
                w += B1 * uw1 + B2 * uw2 + B3 * uw3 + B4 * uw4
                steps += 1
                t = H if is_last else t + step
                # A step that a sample cut short is no reason to give up a longer one.
                h = max(h, step * factor) if is_last and factor > 1.0 else step * factor
                if h > 64 * H:
                    h = 64 * H
            else:
                rejected += 1
                h = step * factor

        xs[i + 1] = x
        vs_out[i + 1] = v
        ss[i + 1] = s
        ys[i + 1] = y

    carried[POSITION] = x
    carried[VELOCITY] = v
    carried[BRISTLE] = s
    carried[COMPRESSION] = y
    carried[RATE] = w
    carried[STEP] = h
    carried[MOVED] = moved
    stats[ACCEPTED] = steps
    stats[REJECTED] = rejected


run = CompiledLoop(
    _drag_loop,
    stribeck_fraction,
    bristle_rate,
    normal_rate,
    linearise,
    samples="Xs",
    plain_us=7.0,
)
"""Fills x, v, s and y at the samples, and the statistics; carries the state to the next chunk."""
