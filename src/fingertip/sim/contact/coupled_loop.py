"""Loop of `fingertip.sim.contact.coupled`: RODAS on five states, with every linear system solved in closed form.

RODAS is a linearly implicit Runge-Kutta (Rosenbrock) method of order 4 with an embedded method of order 3. It is
L-stable and has six stages (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., 1996, section
IV.10, and their code RODAS, doi:10.1007/978-3-642-05221-7). One factorised matrix
``E = 1/(gamma h) - J`` serves all six solves:

    E u_i = f(t + alpha_i h, y + sum_j a_ij u_j) + sum_j c_ij u_j / h + d_i h df/dt
    y_new = y + sum_j a_5j u_j + u_5 + u_6, and u_6 estimates the error.

It is solved block by block, because y and w do not depend on the other states: y and w first, then v, from which x and
s follow.

On very stiff problems the order falls to 1 or 2; tests/sim/test_rodas.py records by how much. The loop is written
out without arrays, because numba and plain Python must both execute it fast and with the same bits.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence

from fingertip.jit import CompiledLoop

GAMMA = 0.25
ALPHA = (0.0, 0.386, 0.21, 0.63, 1.0, 1.0)
"""Times of the stages, as fractions of the step."""
D = (0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0)
"""Coefficients of the time derivative."""
_LAST = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950)
A = (
    (1.544,),
    (0.9466785280815826, 0.2557011698983284),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817),
    _LAST,
)
"""Coefficients a_ij of stages 2 to 5. Stage 6 has those of stage 5, and 1 for u_5."""
C = (
    (-5.6688,),
    (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
    (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
)
"""Coefficients c_ij of stages 2 to 6."""

_, ALPHA2, ALPHA3, ALPHA4, _, _ = ALPHA
D1, D2, D3, D4, _, _ = D
(A21,), (A31, A32), (A41, A42, A43), (A51, A52, A53, A54) = A
(C21,), (C31, C32), (C41, C42, C43), (C51, C52, C53, C54), (C61, C62, C63, C64, C65) = C

MIN_STEP_RATIO = 1e-12
"""Shortest step as a fraction of the time between samples. Such a step is accepted whatever its error."""
WHOLE_STEP_ERROR = 0.9**4
"""Error of a step, relative to the tolerance, up to which the next one may be as long."""
POSITION, VELOCITY, BRISTLE, COMPRESSION, RATE, STEP = range(6)
"""Indices of what a chunk carries to the next one: the states x, v, s, y and w, and the length of the next step [s]."""
ACCEPTED, REJECTED, FAILED_SAMPLE = range(3)
"""Indices of the statistics: accepted steps, rejected steps, and the sample at which the loop gave up, or 0."""


def rates(
    curve: tuple[float, float, float, float],
    sigma: tuple[float, float, float, float, float],
    mount: tuple[float, float, float],
    normal: tuple[float, float, float],
    X: float,
    V: float,
    d: float,
    x: float,
    v: float,
    s: float,
    y: float,
    w: float,
) -> tuple[float, float, float]:
    """Return the right-hand sides dv/dt, ds/dt and dw/dt (equations in `fingertip.sim.contact.coupled`)."""
    mu_c, drop, per_vs, elastic = curve
    s0, s1, s2, relax_per_s, n0 = sigma
    per_m, k, c = mount
    omega, zeta, rho = normal
    load = y if y > 0.0 else 0.0
    scale = 1 / math.sqrt(load + n0)
    z = scale * s
    # Stribeck curve: per_g = 1 / g(v).
    ratio = v * per_vs
    bottom = 1 + ratio * ratio
    per_g = bottom / (mu_c * bottom + drop)
    # alpha(v, z) of Dupont et al. 2002: 0 while bristles bend elastically or straighten up, 1 in full sliding.
    alpha = 1.0
    if elastic > 0.0:
        if v * s <= 0.0:
            alpha = 0.0
        else:
            fraction = (s0 * abs(z) - elastic * mu_c) / (1 / per_g - elastic * mu_c)
            alpha = 0.0 if fraction <= 0.0 else 1.0 if fraction >= 1.0 else fraction * fraction * (3 - 2 * fraction)
    # Bending by the motion, and relaxation of bristles that hardly touch or are bent beyond breakaway.
    ds = load * scale * (v - alpha * s0 * abs(v) * z * per_g)
    dv = (k * (X - x) + c * (V - v) - load * (s0 * z + s1 * scale * ds + s2 * v)) * per_m
    if load < n0:
        ds -= relax_per_s * (1 - load / n0) * s
    stretch = s0 * abs(z) / (mu_c + drop)
    if stretch > 1.0:
        ds -= relax_per_s * (stretch - 1) * s
    # Normal direction: contact resonance while touching, the softer and slower hand in flight.
    if y > 0.0:
        return dv, ds, omega * (omega * (d - y) - 2 * zeta * w)
    return dv, ds, omega * (omega * (d - rho * y) - 2 * zeta * math.sqrt(rho) * w)


def linearise(
    curve: tuple[float, float, float, float],
    sigma: tuple[float, float, float, float, float],
    mount: tuple[float, float, float],
    normal: tuple[float, float, float],
    X: float,
    V: float,
    d: float,
    x: float,
    v: float,
    s: float,
    y: float,
    w: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """Return `rates` and the entries of the Jacobian that vary: J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, J_wy and J_ww.

    J_sv is the derivative of ds/dt by v, and so on. J_vx is -k / m, the only entries of the rows of x and y are 1, and
    all others are 0. At y = 0 and at v = 0, where the right-hand side has corners, the derivatives are those of one
    side.
    """
    mu_c, drop, per_vs, elastic = curve
    s0, s1, s2, relax_per_s, n0 = sigma
    per_m, k, c = mount
    omega, zeta, rho = normal
    load = y if y > 0.0 else 0.0
    scale = 1 / math.sqrt(load + n0)
    z = scale * s
    ratio = v * per_vs
    bottom = 1 + ratio * ratio
    top = mu_c * bottom + drop
    per_g = bottom / top
    # Derivatives: of g by v, divided by g; of alpha by v and z.
    dg_g = -2 * drop * ratio * per_vs / (bottom * top)
    speed, sign = abs(v), 1.0 if v >= 0.0 else -1.0
    alpha, alpha_v, alpha_z = 1.0, 0.0, 0.0
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

    # Bending rate L = v - alpha sigma0 |v| z / g of the bristles and its derivatives by v and z; ds/dt = N c L - r s.
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
    mu = s0 * z + s1 * scale * ds + s2 * v
    dv = (k * (X - x) + c * (V - v) - load * mu) * per_m
    J_vv = -(c + load * (s1 * scale * J_sv + s2)) * per_m
    J_vs = -flow * (s0 + s1 * J_ss) * per_m
    J_vy = 0.0
    if y > 0.0:
        J_vy = -(mu + load * (scale_y * (s0 * s + s1 * ds) + s1 * scale * J_sy)) * per_m

    # Relaxation of bristles that hardly touch or are bent beyond breakaway. It is no part of the damping sigma1.
    if load < n0:
        relax = relax_per_s * (1 - load / n0)
        ds -= relax * s
        J_ss -= relax
        if y > 0.0:
            J_sy += relax_per_s / n0 * s
    stretch = s0 * abs(z) / (mu_c + drop)
    if stretch > 1.0:
        ds -= relax_per_s * (stretch - 1) * s
        J_ss -= relax_per_s * (2 * stretch - 1)
        if y > 0.0:
            J_sy -= relax_per_s * stretch * scale_y / scale * s
    if y > 0.0:
        dw = omega * (omega * (d - y) - 2 * zeta * w)
        return dv, ds, dw, J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, -omega * omega, -2 * zeta * omega
    damping = 2 * zeta * math.sqrt(rho)
    dw = omega * (omega * (d - rho * y) - damping * w)
    return dv, ds, dw, J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, -omega * omega * rho, -damping * omega


def _coupled_loop(
    curve: tuple[float, float, float, float],
    sigma: tuple[float, float, float, float, float],
    mount: tuple[float, float, float],
    normal: tuple[float, float, float],
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
    """Integrate the contact over a chunk by RODAS with adaptive steps."""
    # Parameters: mu_c, mu_s - mu_c, inverse of the Stribeck velocity, and elastic fraction; bristle coefficients sigma,
    # their rate of relaxation, and the load N0; inverse mass, stiffness k and damping c of the mount; normal resonance
    # omega, its damping, and the ratio of the hand's stiffness to the contact's.
    per_m, k, c = mount
    omega = normal[0]
    weight_x, weight_v, weight_s, weight_y, weight_w = weights
    J_vx = -k * per_m
    per_H = 1 / H

    x, v, s, y, w = carried[POSITION], carried[VELOCITY], carried[BRISTLE], carried[COMPRESSION], carried[RATE]
    h = carried[STEP]
    xs[0], vs_out[0], ss[0], ys[0] = x, v, s, y
    steps = rejected = 0
    for i in range(len(Xs) - 1):
        X0, V0, X1, V1, d0, d1 = Xs[i], Vs[i], Xs[i + 1], Vs[i + 1], forces[i], forces[i + 1]
        # Drive between the samples: cubic Hermite polynomial X = X0 + t (V0 + t (q2 + t q3)), and a linear force d.
        q2 = (3 * (X1 - X0) * per_H - 2 * V0 - V1) * per_H
        q3 = ((V0 + V1) - 2 * (X1 - X0) * per_H) * per_H * per_H
        slope = (d1 - d0) * per_H
        t, attempts = 0.0, 0
        while t < H:
            attempts += 1
            if attempts > max_steps:
                stats[FAILED_SAMPLE] = i + 1
                return
            # Step size: end exactly on the sample. Two equal steps avoid a tiny last one.
            is_last = t + h >= H * (1 - 1e-9)
            step = H - t if is_last else 0.5 * (H - t) if t + 2 * h > H else h

            # Drive, right-hand side and Jacobian at the start of the step.
            V = V0 + t * (2 * q2 + 3 * q3 * t)
            X = X0 + t * (V0 + t * (q2 + t * q3))
            d = d0 + slope * t
            dv, ds, dw, J_vv, J_vs, J_vy, J_sv, J_ss, J_sy, J_wy, J_ww = linearise(
                curve, sigma, mount, normal, X, V, d, x, v, s, y, w
            )

            # Elimination in E = e - J with e = 1/(gamma h).
            per_step = 1 / step
            e, per_e = 4 * per_step, 0.25 * step
            e_w = e - J_ww
            pivot_y = 1 / (e * e_w - J_wy)
            pivot_s = 1 / (e - J_ss)
            row_x, row_s = J_vx * per_e, J_vs * pivot_s
            pivot_v = 1 / (e - J_vv - row_x - row_s * J_sv)

            # Time derivatives of the drive, times the step.
            tv = step * (k * V + c * (2 * q2 + 6 * q3 * t)) * per_m
            tw = step * omega * omega * slope

            # Stage 1. Each stage solves E u = right-hand side, for y and w first, then v, then x and s.
            r = dw + D1 * tw
            uy1 = (e_w * w + r) * pivot_y
            uw1 = e * uy1 - w
            rs = ds + J_sy * uy1
            uv1 = (dv + D1 * tv + J_vy * uy1 + row_x * v + row_s * rs) * pivot_v
            ux1 = (v + uv1) * per_e
            us1 = (rs + J_sv * uv1) * pivot_s

            # Stage 2.
            ts = t + ALPHA2 * step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe, ve, se, ye, we = x + A21 * ux1, v + A21 * uv1, s + A21 * us1, y + A21 * uy1, w + A21 * uw1
            dv, ds, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, se, ye, we)
            c1 = C21 * per_step
            rx, ry, r = ve + c1 * ux1, we + c1 * uy1, dw + c1 * uw1 + D2 * tw
            uy2 = (e_w * ry + r) * pivot_y
            uw2 = e * uy2 - ry
            rs = ds + c1 * us1 + J_sy * uy2
            uv2 = (dv + c1 * uv1 + D2 * tv + J_vy * uy2 + row_x * rx + row_s * rs) * pivot_v
            ux2 = (rx + uv2) * per_e
            us2 = (rs + J_sv * uv2) * pivot_s

            # Stage 3.
            ts = t + ALPHA3 * step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe, ve, se = x + A31 * ux1 + A32 * ux2, v + A31 * uv1 + A32 * uv2, s + A31 * us1 + A32 * us2
            ye, we = y + A31 * uy1 + A32 * uy2, w + A31 * uw1 + A32 * uw2
            dv, ds, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, se, ye, we)
            c1, c2 = C31 * per_step, C32 * per_step
            rx, ry = ve + c1 * ux1 + c2 * ux2, we + c1 * uy1 + c2 * uy2
            r = dw + c1 * uw1 + c2 * uw2 + D3 * tw
            uy3 = (e_w * ry + r) * pivot_y
            uw3 = e * uy3 - ry
            rs = ds + c1 * us1 + c2 * us2 + J_sy * uy3
            uv3 = (dv + c1 * uv1 + c2 * uv2 + D3 * tv + J_vy * uy3 + row_x * rx + row_s * rs) * pivot_v
            ux3 = (rx + uv3) * per_e
            us3 = (rs + J_sv * uv3) * pivot_s

            # Stage 4.
            ts = t + ALPHA4 * step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe = x + A41 * ux1 + A42 * ux2 + A43 * ux3
            ve = v + A41 * uv1 + A42 * uv2 + A43 * uv3
            se = s + A41 * us1 + A42 * us2 + A43 * us3
            ye = y + A41 * uy1 + A42 * uy2 + A43 * uy3
            we = w + A41 * uw1 + A42 * uw2 + A43 * uw3
            dv, ds, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, se, ye, we)
            c1, c2, c3 = C41 * per_step, C42 * per_step, C43 * per_step
            rx, ry = ve + c1 * ux1 + c2 * ux2 + c3 * ux3, we + c1 * uy1 + c2 * uy2 + c3 * uy3
            r = dw + c1 * uw1 + c2 * uw2 + c3 * uw3 + D4 * tw
            uy4 = (e_w * ry + r) * pivot_y
            uw4 = e * uy4 - ry
            rs = ds + c1 * us1 + c2 * us2 + c3 * us3 + J_sy * uy4
            r = dv + c1 * uv1 + c2 * uv2 + c3 * uv3 + D4 * tv
            uv4 = (r + J_vy * uy4 + row_x * rx + row_s * rs) * pivot_v
            ux4 = (rx + uv4) * per_e
            us4 = (rs + J_sv * uv4) * pivot_s

            # Stage 5.
            ts = t + step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe = x + A51 * ux1 + A52 * ux2 + A53 * ux3 + A54 * ux4
            ve = v + A51 * uv1 + A52 * uv2 + A53 * uv3 + A54 * uv4
            se = s + A51 * us1 + A52 * us2 + A53 * us3 + A54 * us4
            ye = y + A51 * uy1 + A52 * uy2 + A53 * uy3 + A54 * uy4
            we = w + A51 * uw1 + A52 * uw2 + A53 * uw3 + A54 * uw4
            dv, ds, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, se, ye, we)
            c1, c2, c3, c4 = C51 * per_step, C52 * per_step, C53 * per_step, C54 * per_step
            rx, ry = ve + c1 * ux1 + c2 * ux2 + c3 * ux3 + c4 * ux4, we + c1 * uy1 + c2 * uy2 + c3 * uy3 + c4 * uy4
            r = dw + c1 * uw1 + c2 * uw2 + c3 * uw3 + c4 * uw4
            uy5 = (e_w * ry + r) * pivot_y
            uw5 = e * uy5 - ry
            rs = ds + c1 * us1 + c2 * us2 + c3 * us3 + c4 * us4 + J_sy * uy5
            r = dv + c1 * uv1 + c2 * uv2 + c3 * uv3 + c4 * uv4
            uv5 = (r + J_vy * uy5 + row_x * rx + row_s * rs) * pivot_v
            ux5 = (rx + uv5) * per_e
            us5 = (rs + J_sv * uv5) * pivot_s

            # Stage 6, at the end of the step: its state is the embedded solution of order 3.
            xe, ve, se, ye, we = xe + ux5, ve + uv5, se + us5, ye + uy5, we + uw5
            dv, ds, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, se, ye, we)
            c1, c2, c3, c4, c5 = C61 * per_step, C62 * per_step, C63 * per_step, C64 * per_step, C65 * per_step
            rx = ve + c1 * ux1 + c2 * ux2 + c3 * ux3 + c4 * ux4 + c5 * ux5
            ry = we + c1 * uy1 + c2 * uy2 + c3 * uy3 + c4 * uy4 + c5 * uy5
            r = dw + c1 * uw1 + c2 * uw2 + c3 * uw3 + c4 * uw4 + c5 * uw5
            uy6 = (e_w * ry + r) * pivot_y
            uw6 = e * uy6 - ry
            rs = ds + c1 * us1 + c2 * us2 + c3 * us3 + c4 * us4 + c5 * us5 + J_sy * uy6
            r = dv + c1 * uv1 + c2 * uv2 + c3 * uv3 + c4 * uv4 + c5 * uv5
            uv6 = (r + J_vy * uy6 + row_x * rx + row_s * rs) * pivot_v
            ux6 = (rx + uv6) * per_e
            us6 = (rs + J_sv * uv6) * pivot_s

            # Error: the largest of the five, each as a force relative to the tolerance. The step follows the fourth
            # root of the error, because the estimate has order 3. NaN counts as too large. No step is longer than a
            # sample, so a step over a whole sample with a small error leaves nothing to compute.
            error = max(
                abs(ux6) * weight_x, abs(uv6) * weight_v, abs(us6) * weight_s, abs(uy6) * weight_y, abs(uw6) * weight_w
            )
            is_accepted = error <= 1.0 or step <= MIN_STEP_RATIO * H
            if is_accepted:
                x, v, s, y, w = xe + ux6, ve + uv6, se + us6, ye + uy6, we + uw6
                steps += 1
            else:
                rejected += 1
            if is_last and t == 0.0 and error <= WHOLE_STEP_ERROR:
                h = H
            else:
                factor = 6.0 if error <= 1e-6 else 0.9 / math.sqrt(math.sqrt(error))
                factor = 6.0 if factor > 6.0 else factor if factor > 0.15 else 0.15
                # A step that a sample cut short is no reason to give up a longer one.
                h = max(h, step * factor) if is_accepted and is_last and factor > 1.0 else step * factor
                if h > H:
                    h = H
            if is_accepted:
                t = H if is_last else t + step
        xs[i + 1] = x
        vs_out[i + 1] = v
        ss[i + 1] = s
        ys[i + 1] = y
    carried[POSITION], carried[VELOCITY], carried[BRISTLE], carried[COMPRESSION], carried[RATE] = x, v, s, y, w
    carried[STEP] = h
    stats[ACCEPTED], stats[REJECTED] = steps, rejected


run = CompiledLoop(_coupled_loop, rates, linearise, outputs=6, samples="Xs", plain_us=14.0)
"""Fills x, v, s and y at the samples, and the statistics; carries the state to the next chunk."""
