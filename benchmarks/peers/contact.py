"""Work-precision of the contact: a pad dragged to and fro under a changing load, by fingertip and
by its peers.

Peers get right-hand sides and Jacobians of their own, compiled by numba for scipy's, and in C for
the others. They restart at the drive's few corners (fingertip steps from sample to sample), and
return their dense output at the samples. Only the integration is timed, for every solver.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from benchmarks.peers.native import NativeSolver, NativeSolvers
from benchmarks.peers.options import SOLVE_IVP
from benchmarks.peers.scipy_solvers import Segment, System, scipy_version, solve_with_scipy
from benchmarks.peers.work_precision import Job, Outcome, WorkPrecision
from fingertip import __version__
from fingertip.design import Design
from fingertip.foundation.jit import compile_for_process
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Backing, Pad
from fingertip.sim.contact.dragged_pad import Mount, NormalContact, integrate
from fingertip.sim.contact.friction import LOAD_SCALE_N, Friction

RATE_HZ = 2000.0
LEVELS_N = (1e-5, 5e-6, 2.5e-6)
"""Errors at which solvers are compared [N]."""
TARGETS = {
    "CVODE": 8.0,
    "RADAU5": 1.0,
    "RADAU": 1.0,
    "Rodas5P": 1.0,
}
OURS = "fingertip"
_FRICTION = Friction(0.6, 0.48)
_LOAD_N = 0.8
# Corners of the piecewise linear drive: time [s] and stage velocity [m/s]; time [s] and load [N].
_VELOCITY = (
    (0.0, 0.0),
    (0.2, 0.0),
    (0.24, 0.04),
    (1.0, 0.04),
    (1.04, 0.0),
    (1.3, 0.0),
    (1.36, -0.06),
    (1.9, -0.06),
    (1.96, 0.0),
    (2.2, 0.0),
    (2.21, 0.004),
    (4.2, 0.004),
    (4.25, 0.0),
    (5.0, 0.0),
)
_LOADS = (
    (0.0, 0.8),
    (0.5, 0.8),
    (0.6, 1.2),
    (1.5, 1.2),
    (1.6, 0.5),
    (3.0, 0.5),
    (3.1, 0.9),
    (5.0, 0.9),
)


def make_input(seconds: float) -> tuple[Array, Array, Array, Array]:
    """Time [s], stage position [m] and velocity [m/s], load [N] at the samples: exact for
    fingertip's interpolation.
    """
    t = np.arange(round(seconds * RATE_HZ) + 1) / RATE_HZ
    velocity = np.interp(t, [x for x, _ in _VELOCITY], [y for _, y in _VELOCITY])
    load = np.interp(t, [x for x, _ in _LOADS], [y for _, y in _LOADS])
    position = np.concatenate(([0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2) / RATE_HZ))

    return t, position, velocity, load


@dataclass(frozen=True)
class ContactProblem:
    """Drive, pad and mount of the problem."""

    time_s: Array
    carriage_m: Array
    carriage_m_s: Array
    load_n: Array
    mount: Mount
    normal: NormalContact

    @classmethod
    def over(cls, seconds: float) -> ContactProblem:
        """Problem over some seconds, with the pad of the default design."""
        pad = Pad.from_design(Design())
        k = pad.tangential_stiffness_n_per_m(_LOAD_N)
        mount = Mount(
            pad.backing.mass_kg, k, 2 * Backing.damping_ratio * math.sqrt(k * pad.backing.mass_kg)
        )

        return cls(
            *make_input(seconds),
            mount,
            NormalContact(pad.resonance_hz(_LOAD_N), Backing.damping_ratio),
        )

    def forces_n(self, position_m: Array, normal_n: Array) -> Array:
        """Force of the mount's spring, then normal force [N]: what errors are measured on."""
        return np.concatenate(
            (self.mount.stiffness_n_per_m * (self.carriage_m - position_m), normal_n)
        )

    @property
    def start(self) -> Array:
        """States x, v, s, y and w at time 0."""
        return np.array([0.0, 0.0, 0.0, self.load_n[0], 0.0])

    @property
    def absolute(self) -> Array:
        """Absolute tolerances of the states for an error of about 1
        N, through the stiffnesses as in fingertip.
        """
        m = self.mount.mass_kg
        k = self.mount.stiffness_n_per_m
        return np.array([1 / k, 1 / math.sqrt(k * m), 1 / _FRICTION.sigma0, 1.0, 600.0])

    @property
    def corners(self) -> list[int]:
        """Samples at which the drive has a corner, the first and the last sample included."""
        end = self.time_s[-1]
        inner = {round(x * RATE_HZ) for x, _ in (*_VELOCITY, *_LOADS) if x < end}
        return sorted(inner | {len(self.time_s) - 1})

    def drives(self) -> Array:
        """Begin [s], carriage [m, m/s, m/s2] and load [N, N/s] of each segment."""
        i = np.array(self.corners[:-1])
        V = self.carriage_m_s
        load = self.load_n
        rates = ((V[i + 1] - V[i]) * RATE_HZ, (load[i + 1] - load[i]) * RATE_HZ)

        return np.stack(
            (self.time_s[i], self.carriage_m[i], V[i], rates[0], load[i], rates[1]), axis=1
        )

    def run_fingertip(self, tolerance_n: float) -> Outcome:
        """Forces by fingertip [N]."""
        columns = self.carriage_m, self.carriage_m_s, self.load_n
        start = time.process_time()
        run = integrate(_FRICTION, self.mount, self.normal, 1 / RATE_HZ, *columns, tolerance_n)
        cpu_s = time.process_time() - start

        return Outcome(self.forces_n(run.position_m, run.force_n), cpu_s, run.evaluations)

    def run_scipy(self, system: System, method: str, tolerance: float) -> Outcome:
        """Forces by scipy [N]."""
        drives = self.drives()
        segments = [
            Segment(self.time_s[a : b + 1], (drive,))
            for (a, b), drive in zip(pairwise(self.corners), drives, strict=True)
        ]
        start = time.process_time()
        found, calls = solve_with_scipy(
            method,
            system=system,
            segments=segments,
            start=self.start,
            relative=tolerance,
            absolute=tolerance * self.absolute,
        )
        cpu_s = time.process_time() - start

        return Outcome(self.forces_n(found[0], np.maximum(found[3], 0.0)), cpu_s, calls)

    def run_native(
        self, solver: NativeSolver, tolerance: float, option: int | None = None
    ) -> Outcome:
        """Forces by a solver in C or Fortran [N]."""
        f = _FRICTION
        mount = self.mount
        omega = 2 * math.pi * self.normal.resonance_hz
        surface = [
            f.mu_c,
            f.mu_s - f.mu_c,
            f.stribeck_m_s,
            f.sigma0,
            f.sigma1,
            f.sigma2,
            LOAD_SCALE_N,
        ]
        normal = [omega * omega, 2 * self.normal.damping_ratio * omega]
        parameters = np.array(
            [*surface, mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m, *normal]
        )
        states, cpu_s, calls = solver.solve(
            "contact",
            parameters,
            self.drives(),
            0,
            np.array(self.corners[1:]),
            RATE_HZ,
            self.start,
            tolerance,
            tolerance * self.absolute,
            option=option,
        )

        return Outcome(self.forces_n(states[:, 0], np.maximum(states[:, 3], 0.0)), cpu_s, calls)


def measure_contact(
    seconds: float,
    peers: tuple[str, ...],
    native: NativeSolvers,
    advance: Callable[[float], None] = lambda _: None,
) -> WorkPrecision:
    """Measure fingertip and its peers on the same problem. Units: `seconds` [s]."""
    problem = ContactProblem.over(seconds)
    system = _scipy_equations(problem.mount, problem.normal)
    diagram = WorkPrecision(f"contact, {seconds:g} s to and fro", "N", LEVELS_N)
    diagram.solvers[OURS] = (
        f"{__version__}, a Rosenbrock method of order 4, compiled loop; each sample ends a step"
    )
    diagram.targets |= {
        name: TARGETS[name] for name in TARGETS if name.removeprefix("scipy ") in peers
    }
    problem.run_fingertip(1e-3)  # compiles
    reference = problem.run_fingertip(1e-12).result
    other = problem.run_scipy(system, "Radau", 1e-11).result
    diagram.reference_difference = float(np.abs(other - reference).max())
    jobs = [
        Job(OURS, f"tolerance 1e{e} N", partial(problem.run_fingertip, 10.0**e))
        for e in range(-3, -10, -1)
    ]
    jobs += _peer_jobs(diagram, problem, system, peers, native)
    diagram.measure(jobs, reference, advance)
    if "ngspice" in peers:
        diagram.omissions.append("ngspice: has no model of friction")

    return diagram


def _peer_jobs(
    diagram: WorkPrecision,
    problem: ContactProblem,
    system: System,
    peers: tuple[str, ...],
    native: NativeSolvers,
) -> Iterator[Job]:
    """Jobs of the peers; writes their versions and settings, or
    why they are missing, into the diagram.
    """
    settings = (
        "analytic Jacobian, restarted at the drive's corners, rtol as stated, atol: rtol as a force"
    )
    for method in (*SOLVE_IVP, "odeint"):
        if method not in peers:
            continue

        kind = "odeint" if method == "odeint" else f"solve_ivp({method})"
        name = f"scipy {method}"
        diagram.solvers[name] = (
            f"scipy {scipy_version()}, {kind}, equations compiled by numba, {settings}"
        )
        exponents = {"odeint": np.arange(-6.0, -10.1, -0.5), "LSODA": np.arange(-6.0, -9.1, -0.5)}

        for e in exponents.get(method, np.arange(-5.0, -9.1, -1.0)):
            run = partial(problem.run_scipy, system, method, 10.0**e)
            yield Job(name, f"rtol {10.0**e:.1e}", run)

    diagram.leave_out(native.missing)
    for name, solver in native.found.items():
        diagram.solvers[name] = f"{solver.description}, equations in C, {settings}"
        for e in np.arange(-5.0, -12.1, -0.5):
            yield Job(name, f"rtol {10.0**e:.1e}", partial(problem.run_native, solver, 10.0**e))


def _scipy_equations(mount: Mount, press: NormalContact) -> System:
    """Right side and Jacobian for scipy, independent of
    fingertip's; compiled too where numba is installed.
    """
    f = _FRICTION
    n0 = LOAD_SCALE_N
    drop = f.mu_s - f.mu_c
    mu_c = f.mu_c
    vs = f.stribeck_m_s
    s0 = f.sigma0
    s1 = f.sigma1
    s2 = f.sigma2
    m = mount.mass_kg
    k = mount.stiffness_n_per_m
    c = mount.damping_n_s_per_m
    w2 = (2 * math.pi * press.resonance_hz) ** 2
    damp = 4 * math.pi * press.resonance_hz * press.damping_ratio

    def rates(t: float, s: Array, drive: Array) -> Array:
        x, v, bristles, y, w = s
        T = t - drive[0]
        X = drive[1] + T * (drive[2] + T * drive[3] / 2)
        V = drive[2] + T * drive[3]
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
        v = s[1]
        bristles = s[2]
        y = s[3]
        scale = 1 / math.sqrt(y + n0)
        z = scale * bristles
        flow = y * scale
        scale_y = -(scale**3) / 2
        b = 1 + (v / vs) ** 2
        g = mu_c + drop / b
        dg = -2 * drop * v / (vs * vs * b * b)
        a = -s0 * abs(v) / g
        bends = v + a * z
        bends_v = 1 - s0 * z * ((1.0 if v >= 0 else -1.0) - abs(v) * dg / g) / g
        rate = flow * bends
        rate_v = flow * bends_v
        rate_s = flow * scale * a
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

    return System(compile_for_process(rates), compile_for_process(jacobian))
