"""Work-precision of the contact: a pad dragged to and fro under a changing load, by fingertip and by scipy.

scipy gets compiled right sides and Jacobians of its own, is restarted at the drive's few corners (fingertip steps
from sample to sample), and returns its dense output at the samples.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.jit import compile_for_process
from fingertip.sim.bench.work_precision import WorkPrecision
from fingertip.sim.contact.coupled import NormalContact, integrate
from fingertip.sim.contact.friction import LOAD_SCALE_N, Friction
from fingertip.sim.contact.pad import DAMPING_RATIO, Pad
from fingertip.sim.contact.tangential import Mount

RATE_HZ = 2000.0
TARGET_N = 5e-6
OURS = "fingertip (RODAS)"
_FRICTION = Friction(0.6, 0.48)
_LOAD_N = 0.8
# Corners of the piecewise linear drive: time [s] and stage velocity [m/s]; time [s] and load [N].
_VELOCITY = ((0.0, 0.0), (0.2, 0.0), (0.24, 0.04), (1.0, 0.04), (1.04, 0.0), (1.3, 0.0), (1.36, -0.06), (1.9, -0.06),
             (1.96, 0.0), (2.2, 0.0), (2.21, 0.004), (4.2, 0.004), (4.25, 0.0), (5.0, 0.0))  # fmt: skip
_LOADS = ((0.0, 0.8), (0.5, 0.8), (0.6, 1.2), (1.5, 1.2), (1.6, 0.5), (3.0, 0.5), (3.1, 0.9), (5.0, 0.9))


def make_input(seconds: float) -> tuple[Array, Array, Array, Array]:
    """Time [s], stage position [m] and velocity [m/s], load [N] at the samples: exact for fingertip's interpolation."""
    t = np.arange(round(seconds * RATE_HZ) + 1) / RATE_HZ
    velocity = np.interp(t, [x for x, _ in _VELOCITY], [y for _, y in _VELOCITY])
    load = np.interp(t, [x for x, _ in _LOADS], [y for _, y in _LOADS])
    position = np.concatenate(([0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2) / RATE_HZ))
    return t, position, velocity, load


def measure_contact(seconds: float, methods: tuple[str, ...] = ("LSODA", "Radau", "BDF")) -> WorkPrecision:
    """Measure all solvers on the same problem."""
    pad = Pad.from_design(Design())
    k = pad.tangential_stiffness_n_per_m(_LOAD_N)
    mount = Mount(pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * pad.mass_kg))
    press = NormalContact(pad.resonance_hz(_LOAD_N), DAMPING_RATIO)
    diagram = WorkPrecision(f"contact, {seconds:g} s to and fro", "N", TARGET_N, {"scipy LSODA": 15.0})
    start = time.process_time()
    t, X, V, load = make_input(seconds)
    diagram.input_s = time.process_time() - start

    def as_forces(position: Array, normal: Array) -> Array:
        return np.concatenate((k * (X - position), normal))

    def run_ours(tolerance: float) -> Array:
        run = integrate(_FRICTION, mount, press, 1 / RATE_HZ, X, V, load, tolerance)
        return as_forces(run.position_m, run.force_n)

    rates, jacobian = _scipy_equations(mount, press)
    knots = sorted({x for x, _ in (*_VELOCITY, *_LOADS) if x < seconds} | {seconds})

    def run_scipy(method: str, tolerance: float) -> Array:
        from scipy.integrate import solve_ivp

        state, place = np.array([0.0, 0.0, 0.0, load[0], 0.0]), 0
        out = np.zeros((5, len(t)))
        # Absolute tolerances by component: the same force error as fingertip's, through the same stiffnesses.
        scale = np.array([1 / k, 1 / math.sqrt(k * mount.mass_kg), 1 / _FRICTION.sigma0, 1.0, 600.0])
        for begin, end in pairwise(knots):
            last = round(end * RATE_HZ)
            i = round(begin * RATE_HZ)
            drive = (begin, X[i], V[i], (V[i + 1] - V[i]) * RATE_HZ, load[i], (load[i + 1] - load[i]) * RATE_HZ)
            part = solve_ivp(
                rates, (begin, end), state, method, t[place : last + 1].clip(begin, end),
                args=(np.array(drive),), rtol=tolerance, atol=tolerance * scale, jac=jacobian,
            )  # fmt: skip
            if not part.success:
                raise ArithmeticError(part.message)
            out[:, place : last + 1] = part.y
            state, place = part.y[:, -1], last
        return as_forces(out[0], np.maximum(out[3], 0.0))

    run_ours(1e-3)  # compiles
    reference = run_ours(1e-12)
    diagram.reference_difference = float(np.abs(run_scipy("Radau", 1e-11) - reference).max())
    for exponent in range(-3, -10, -1):
        diagram.measure(OURS, f"1e{exponent} N", lambda e=exponent: run_ours(10.0**e), reference)  # type: ignore[misc]
    for method in methods:
        for exponent in (-3, -4, -5, -6, -7, -8, -9):
            run: Callable[[], Array] = lambda m=method, e=exponent: run_scipy(m, 10.0**e)  # type: ignore[misc]  # noqa: E731
            diagram.measure(f"scipy {method}", f"rtol 1e{exponent}", run, reference)
    diagram.omissions.append("ngspice: has no model of friction")
    return diagram


def _scipy_equations(mount: Mount, press: NormalContact) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Right side and Jacobian for scipy, independent of fingertip's; compiled too where numba is installed."""
    f = _FRICTION
    n0 = LOAD_SCALE_N
    mu_c, drop, vs, s0, s1, s2 = f.mu_c, f.mu_s - f.mu_c, f.stribeck_m_s, f.sigma0, f.sigma1, f.sigma2
    m, k, c = mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m
    w2, damp = (2 * math.pi * press.resonance_hz) ** 2, 4 * math.pi * press.resonance_hz * press.damping_ratio

    def rates(t: float, s: Array, drive: Array) -> Array:
        x, v, bristles, y, w = s
        T = t - drive[0]
        X, V = drive[1] + T * (drive[2] + T * drive[3] / 2), drive[2] + T * drive[3]
        g = mu_c + drop / (1 + (v / vs) ** 2)
        scale = 1 / math.sqrt(y + n0)
        z = scale * bristles
        rate = y * scale * (v - s0 * abs(v) * z / g)
        out = np.empty(5)
        out[0] = v
        out[1] = (k * (X - x) + c * (V - v) - y * (s0 * z + s1 * scale * rate + s2 * v)) / m
        out[2] = rate
        out[3] = w
        out[4] = w2 * (drive[4] + T * drive[5] - y) - damp * w
        return out

    def jacobian(t: float, s: Array, drive: Array) -> Array:
        v, bristles, y = s[1], s[2], s[3]
        scale = 1 / math.sqrt(y + n0)
        z, flow = scale * bristles, y * scale
        scale_y = -(scale**3) / 2
        b = 1 + (v / vs) ** 2
        g = mu_c + drop / b
        dg = -2 * drop * v / (vs * vs * b * b)
        a = -s0 * abs(v) / g
        bends = v + a * z
        bends_v = 1 - s0 * z * ((1.0 if v >= 0 else -1.0) - abs(v) * dg / g) / g
        rate = flow * bends
        rate_v, rate_s = flow * bends_v, flow * scale * a
        rate_y = (scale + y * scale_y) * bends + flow * a * scale_y * bristles
        mu = s0 * z + s1 * scale * rate + s2 * v
        mu_y = s0 * scale_y * bristles + s1 * (scale_y * rate + scale * rate_y)
        out = np.zeros((5, 5))
        out[0, 1] = 1.0
        out[1, 0] = -k / m
        out[1, 1] = -(c + y * (s1 * scale * rate_v + s2)) / m
        out[1, 2] = -y * scale * (s0 + s1 * rate_s) / m
        out[1, 3] = -(mu + y * mu_y) / m
        out[2, 1] = rate_v
        out[2, 2] = rate_s
        out[2, 3] = rate_y
        out[3, 4] = 1.0
        out[4, 3] = -w2
        out[4, 4] = -damp
        return out

    return compile_for_process(rates), compile_for_process(jacobian)
