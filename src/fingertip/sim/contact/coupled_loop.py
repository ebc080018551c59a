"""Loop of `fingertip.sim.contact.coupled`: RODAS on five states, with every linear system solved in closed form.

RODAS is a linearly implicit Runge-Kutta (Rosenbrock) method of order 4 with an embedded method of order 3. It is
L-stable and has six stages (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., 1996, section
IV.10, and their code RODAS, doi:10.1007/978-3-642-05221-7). One factorised matrix
``E = 1/(gamma h) - J`` serves all six solves:

    E u_i = f(t + alpha_i h, y + sum_j a_ij u_j) + sum_j c_ij u_j / h + d_i h df/dt
    y_new = y + sum_j a_5j u_j + u_5 + u_6, and u_6 estimates the error.

On very stiff problems the order falls to 1 or 2; tests/sim/test_rodas.py records by how much. The loop is written
out without arrays, because numba and plain Python must both execute it fast and with the same bits.
"""

from __future__ import annotations

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

RELAX_BELOW_N = 1e-3
"""Load below which the relaxation of the bristles fades in [N], so that the right-hand side stays continuous."""
MIN_STEP_RATIO = 1e-12
"""Shortest step as a fraction of the time between samples. Such a step is accepted whatever its error."""
ACCEPTED, REJECTED, FAILED_SAMPLE = range(3)
"""Indices of the statistics: accepted steps, rejected steps, and the sample at which the loop gave up, or 0."""


def rates(
    curve: tuple[float, float, float, float],
    sigma: tuple[float, float, float, float],
    mount: tuple[float, float, float],
    normal: tuple[float, float, float],
    X: float,
    V: float,
    d: float,
    x: float,
    v: float,
    z: float,
    y: float,
    w: float,
) -> tuple[float, float, float]:
    """Return the right-hand sides dv/dt, dz/dt and dw/dt (equations in `fingertip.sim.contact.coupled`)."""
    mu_c, drop, vs, elastic = curve
    s0, s1, s2, relax_per_s = sigma
    m, k, c = mount
    omega, zeta, rho = normal
    load = y if y > 0.0 else 0.0
    ratio = v / vs
    g = mu_c + drop / (1 + ratio * ratio)
    # alpha(v, z) of Dupont et al. 2002: 0 while bristles bend elastically or straighten up, 1 in full sliding.
    alpha = 1.0
    if elastic > 0.0:
        if v * z <= 0.0:
            alpha = 0.0
        else:
            fraction = (s0 * abs(z) - elastic * mu_c) / (g - elastic * mu_c)
            alpha = 0.0 if fraction <= 0.0 else 1.0 if fraction >= 1.0 else fraction * fraction * (3 - 2 * fraction)
    # LuGre friction, and relaxation of bristles that hardly touch.
    dz = v - alpha * s0 * abs(v) * z / g
    if load < RELAX_BELOW_N:
        dz -= relax_per_s * (1 - load / RELAX_BELOW_N) * z
    dv = (k * (X - x) + c * (V - v) - load * (s0 * z + s1 * dz + s2 * v)) / m
    # Normal direction: contact resonance while touching, the softer and slower hand in flight.
    if y > 0.0:
        return dv, dz, omega * (omega * (d - y) - 2 * zeta * w)
    return dv, dz, omega * (omega * (d - rho * y) - 2 * zeta * rho**0.5 * w)


def _coupled_loop(
    curve: tuple[float, float, float, float],
    sigma: tuple[float, float, float, float],
    mount: tuple[float, float, float],
    normal: tuple[float, float, float],
    weights: tuple[float, float, float, float, float],
    max_steps: int,
    H: float,
    Xs: Sequence[float],
    Vs: Sequence[float],
    ds: Sequence[float],
    xs: MutableSequence[float],
    vs_out: MutableSequence[float],
    zs: MutableSequence[float],
    ys: MutableSequence[float],
    stats: MutableSequence[float],
) -> None:
    """Integrate the contact by RODAS with adaptive steps."""
    # Parameters: mu_c, drop = mu_s - mu_c, Stribeck velocity vs; bristle coefficients s0, s1, s2 and their rate of
    # relaxation; mass m, stiffness k and damping c of the mount; normal resonance omega, its damping zeta, and the
    # ratio rho of the hand's stiffness to the contact's.
    mu_c, drop, vs, elastic = curve
    s0, s1, s2, relax_per_s = sigma
    m, k, c = mount
    omega, zeta, rho = normal
    weight_x, weight_v, weight_z, weight_y, weight_w = weights

    # State: x, v, z of the pad and y, w of the contact, in balance with the first sample.
    x, v, z, y, w = Xs[0], 0.0, 0.0, ds[0], 0.0
    if y < 0.0:
        y = y / rho
    xs[0], ys[0] = x, y
    h = H
    steps = rejected = 0
    for i in range(len(Xs) - 1):
        X0, V0, X1, V1, d0, d1 = Xs[i], Vs[i], Xs[i + 1], Vs[i + 1], ds[i], ds[i + 1]
        # Drive between the samples: cubic Hermite polynomial X = X0 + t (V0 + t (q2 + t q3)), and a linear force d.
        q2 = (3 * (X1 - X0) / H - 2 * V0 - V1) / H
        q3 = ((V0 + V1) - 2 * (X1 - X0) / H) / (H * H)
        slope = (d1 - d0) / H
        t, attempts = 0.0, 0
        while t < H:
            attempts += 1
            if attempts > max_steps:
                stats[FAILED_SAMPLE] = i + 1
                return
            # Step size: end exactly on the sample. Two equal steps avoid a tiny last one.
            is_last = t + h >= H * (1 - 1e-9)
            step = H - t if is_last else 0.5 * (H - t) if t + 2 * h > H else h

            # Drive and right-hand side at the start of the step.
            V = V0 + t * (2 * q2 + 3 * q3 * t)
            X = X0 + t * (V0 + t * (q2 + t * q3))
            d = d0 + slope * t
            dv, dz, dw = rates(curve, sigma, mount, normal, X, V, d, x, v, z, y, w)

            # Stribeck curve g(v) and its derivative dg; elasto-plastic factor alpha(v, z) and its two derivatives.
            load = y if y > 0.0 else 0.0
            ratio = v / vs
            denominator = 1 + ratio * ratio
            g = mu_c + drop / denominator
            dg = -2 * drop * ratio / (vs * denominator * denominator)
            speed, sign = abs(v), 1.0 if v >= 0.0 else -1.0
            alpha, alpha_v, alpha_z = 1.0, 0.0, 0.0
            if elastic > 0.0:
                alpha = 0.0
                if v * z > 0.0:
                    width = g - elastic * mu_c
                    fraction = (s0 * abs(z) - elastic * mu_c) / width
                    if fraction >= 1.0:
                        alpha = 1.0
                    elif fraction > 0.0:
                        alpha = fraction * fraction * (3 - 2 * fraction)
                        rise = 6 * fraction * (1 - fraction)
                        alpha_z = rise * (s0 if z > 0.0 else -s0) / width
                        alpha_v = -rise * fraction * dg / width

            # Jacobian: J_zv is the derivative of dz/dt by v, and so on. The only entries of the rows of x and y are 1.
            J_zv = 1 - s0 * z * (alpha * (sign - speed * dg / g) + alpha_v * speed) / g
            J_zz = -s0 * speed * (alpha + alpha_z * z) / g
            J_zy = 0.0
            if load < RELAX_BELOW_N:
                J_zz -= relax_per_s * (1 - load / RELAX_BELOW_N)
                J_zy = relax_per_s * z / RELAX_BELOW_N if y > 0.0 else 0.0
            mu = s0 * z + s1 * dz + s2 * v
            J_vx = -k / m
            J_vv = -(c + load * (s1 * J_zv + s2)) / m
            J_vz = -load * (s0 + s1 * J_zz) / m
            J_vy = -(mu + load * s1 * J_zy) / m if y > 0.0 else 0.0
            J_wy = -omega * omega if y > 0.0 else -omega * omega * rho
            J_ww = -2 * zeta * omega if y > 0.0 else -2 * zeta * omega * rho**0.5

            # Pivots of E = e - J with e = 1/(gamma h). The blocks (y, w) and (x, v, z) are solved one after the other:
            # y and w do not depend on the others.
            e = 4 / step
            pivot_y = 1 / (e * (e - J_ww) - J_wy)
            pivot_z = 1 / (e - J_zz)
            pivot_v = 1 / (e - J_vv - J_vx / e - J_vz * J_zv * pivot_z)

            # Time derivatives of the drive, times the step.
            tv = step * (k * V + c * (2 * q2 + 6 * q3 * t)) / m
            tw = step * omega * omega * slope

            # Stage 1. Each stage solves E u = right-hand side, for y and w first, then v, then x and z.
            r = dw + D1 * tw
            uy1 = ((e - J_ww) * w + r) * pivot_y
            uw1 = e * uy1 - w
            rz = dz + J_zy * uy1
            uv1 = (dv + D1 * tv + J_vy * uy1 + J_vx * v / e + J_vz * rz * pivot_z) * pivot_v
            ux1 = (v + uv1) / e
            uz1 = (rz + J_zv * uv1) * pivot_z

            # Stage 2.
            ts = t + ALPHA2 * step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe, ve, ze, ye, we = x + A21 * ux1, v + A21 * uv1, z + A21 * uz1, y + A21 * uy1, w + A21 * uw1
            dv, dz, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, ze, ye, we)
            c1 = C21 / step
            rx, ry, r = ve + c1 * ux1, we + c1 * uy1, dw + c1 * uw1 + D2 * tw
            uy2 = ((e - J_ww) * ry + r) * pivot_y
            uw2 = e * uy2 - ry
            rz = dz + c1 * uz1 + J_zy * uy2
            uv2 = (dv + c1 * uv1 + D2 * tv + J_vy * uy2 + J_vx * rx / e + J_vz * rz * pivot_z) * pivot_v
            ux2 = (rx + uv2) / e
            uz2 = (rz + J_zv * uv2) * pivot_z

            # Stage 3.
            ts = t + ALPHA3 * step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe, ve, ze = x + A31 * ux1 + A32 * ux2, v + A31 * uv1 + A32 * uv2, z + A31 * uz1 + A32 * uz2
            ye, we = y + A31 * uy1 + A32 * uy2, w + A31 * uw1 + A32 * uw2
            dv, dz, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, ze, ye, we)
            c1, c2 = C31 / step, C32 / step
            rx, ry = ve + c1 * ux1 + c2 * ux2, we + c1 * uy1 + c2 * uy2
            r = dw + c1 * uw1 + c2 * uw2 + D3 * tw
            uy3 = ((e - J_ww) * ry + r) * pivot_y
            uw3 = e * uy3 - ry
            rz = dz + c1 * uz1 + c2 * uz2 + J_zy * uy3
            uv3 = (dv + c1 * uv1 + c2 * uv2 + D3 * tv + J_vy * uy3 + J_vx * rx / e + J_vz * rz * pivot_z) * pivot_v
            ux3 = (rx + uv3) / e
            uz3 = (rz + J_zv * uv3) * pivot_z

            # Stage 4.
            ts = t + ALPHA4 * step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe = x + A41 * ux1 + A42 * ux2 + A43 * ux3
            ve = v + A41 * uv1 + A42 * uv2 + A43 * uv3
            ze = z + A41 * uz1 + A42 * uz2 + A43 * uz3
            ye = y + A41 * uy1 + A42 * uy2 + A43 * uy3
            we = w + A41 * uw1 + A42 * uw2 + A43 * uw3
            dv, dz, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, ze, ye, we)
            c1, c2, c3 = C41 / step, C42 / step, C43 / step
            rx, ry = ve + c1 * ux1 + c2 * ux2 + c3 * ux3, we + c1 * uy1 + c2 * uy2 + c3 * uy3
            r = dw + c1 * uw1 + c2 * uw2 + c3 * uw3 + D4 * tw
            uy4 = ((e - J_ww) * ry + r) * pivot_y
            uw4 = e * uy4 - ry
            rz = dz + c1 * uz1 + c2 * uz2 + c3 * uz3 + J_zy * uy4
            uv4 = (
                dv + c1 * uv1 + c2 * uv2 + c3 * uv3 + D4 * tv + J_vy * uy4 + J_vx * rx / e + J_vz * rz * pivot_z
            ) * pivot_v
            ux4 = (rx + uv4) / e
            uz4 = (rz + J_zv * uv4) * pivot_z

            # Stage 5.
            ts = t + step
            X, V, d = X0 + ts * (V0 + ts * (q2 + ts * q3)), V0 + ts * (2 * q2 + 3 * q3 * ts), d0 + slope * ts
            xe = x + A51 * ux1 + A52 * ux2 + A53 * ux3 + A54 * ux4
            ve = v + A51 * uv1 + A52 * uv2 + A53 * uv3 + A54 * uv4
            ze = z + A51 * uz1 + A52 * uz2 + A53 * uz3 + A54 * uz4
            ye = y + A51 * uy1 + A52 * uy2 + A53 * uy3 + A54 * uy4
            we = w + A51 * uw1 + A52 * uw2 + A53 * uw3 + A54 * uw4
            dv, dz, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, ze, ye, we)
            c1, c2, c3, c4 = C51 / step, C52 / step, C53 / step, C54 / step
            rx, ry = ve + c1 * ux1 + c2 * ux2 + c3 * ux3 + c4 * ux4, we + c1 * uy1 + c2 * uy2 + c3 * uy3 + c4 * uy4
            r = dw + c1 * uw1 + c2 * uw2 + c3 * uw3 + c4 * uw4
            uy5 = ((e - J_ww) * ry + r) * pivot_y
            uw5 = e * uy5 - ry
            rz = dz + c1 * uz1 + c2 * uz2 + c3 * uz3 + c4 * uz4 + J_zy * uy5
            r = dv + c1 * uv1 + c2 * uv2 + c3 * uv3 + c4 * uv4
            uv5 = (r + J_vy * uy5 + J_vx * rx / e + J_vz * rz * pivot_z) * pivot_v
            ux5 = (rx + uv5) / e
            uz5 = (rz + J_zv * uv5) * pivot_z

            # Stage 6, at the end of the step: its state is the embedded solution of order 3.
            xe, ve, ze, ye, we = xe + ux5, ve + uv5, ze + uz5, ye + uy5, we + uw5
            dv, dz, dw = rates(curve, sigma, mount, normal, X, V, d, xe, ve, ze, ye, we)
            c1, c2, c3, c4, c5 = C61 / step, C62 / step, C63 / step, C64 / step, C65 / step
            rx = ve + c1 * ux1 + c2 * ux2 + c3 * ux3 + c4 * ux4 + c5 * ux5
            ry = we + c1 * uy1 + c2 * uy2 + c3 * uy3 + c4 * uy4 + c5 * uy5
            r = dw + c1 * uw1 + c2 * uw2 + c3 * uw3 + c4 * uw4 + c5 * uw5
            uy6 = ((e - J_ww) * ry + r) * pivot_y
            uw6 = e * uy6 - ry
            rz = dz + c1 * uz1 + c2 * uz2 + c3 * uz3 + c4 * uz4 + c5 * uz5 + J_zy * uy6
            r = dv + c1 * uv1 + c2 * uv2 + c3 * uv3 + c4 * uv4 + c5 * uv5
            uv6 = (r + J_vy * uy6 + J_vx * rx / e + J_vz * rz * pivot_z) * pivot_v
            ux6 = (rx + uv6) / e
            uz6 = (rz + J_zv * uv6) * pivot_z

            # Error: the largest of the five, each as a force relative to the tolerance. The step follows the fourth
            # root of the error, because the estimate has order 3. NaN counts as too large.
            error = max(
                abs(ux6) * weight_x, abs(uv6) * weight_v, abs(uz6) * weight_z, abs(uy6) * weight_y, abs(uw6) * weight_w
            )
            factor = 0.9 / error**0.25 if error > 1e-6 else 6.0
            factor = 6.0 if factor > 6.0 else factor if factor > 0.15 else 0.15
            if error <= 1.0 or step <= MIN_STEP_RATIO * H:
                x, v, z, y, w = xe + ux6, ve + uv6, ze + uz6, ye + uy6, we + uw6
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
        zs[i + 1] = z
        ys[i + 1] = y
    stats[ACCEPTED], stats[REJECTED] = steps, rejected


run = CompiledLoop(_coupled_loop, rates, outputs=5, samples="Xs", plain_us=12.0)
"""Fills x, v, z and y at the samples, and the statistics."""
