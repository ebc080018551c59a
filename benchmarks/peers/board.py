"""Work-precision of the board: a burst of vibration through filter, diode and envelope, by
fingertip and its peers.

The input is a simulated tactile voltage: samples that straight lines join. Peers get right-hand
sides and Jacobians of their own, compiled by numba for scipy's, and in C for the others, with the
same function for the diode and its series resistance. Their steps are no longer than a sample, or
end at every sample; both ways are measured, and the better one counts. ngspice reads the samples as
a piecewise linear source.

The same burst is also given as a sine, to the solvers in C and to ngspice, whose native source it
is. Their errors are then those against the exact response to that sine, so that each solver's error
is that of its integration alone. What the straight lines change in the response is stated beside.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from benchmarks.peers import spice
from benchmarks.peers.native import NATIVE, NativeSolver, NativeSolvers
from benchmarks.peers.options import SOLVE_IVP
from benchmarks.peers.scipy_solvers import Segment, System, scipy_version, solve_with_scipy
from benchmarks.peers.spice import Spice, gain
from benchmarks.peers.work_precision import Job, Outcome, WorkPrecision
from fingertip import __version__
from fingertip.design import Design
from fingertip.foundation.jit import compile_for_process
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.envelope_loop import wright_omega
from fingertip.sim.signal.filter_board import simulate_board

STEP_S = 1 / 2000
LEVELS_V = (5e-4, 1e-4, 2e-5)
"""Errors at which solvers are compared [V]."""
TARGETS = {
    "scipy odeint": 25.0,
    "CVODE": 10.0,
    "CVODE, sine": 8.0,
    "ngspice, sine": 60.0,
}
OURS = "fingertip"
MIN_SECONDS = 0.5
"""Shortest length of the problem [s], with a burst of 0.2 s."""
CONSTANT_V = 4.0
AMPLITUDE_V = 0.02
FREQUENCY_HZ = 90.0
_SPICE_SETTINGS = (
    (1e-2, 5e-4),
    (1e-3, 2e-4),
    (1e-3, 1e-4),
    (1e-4, 1e-4),
    (1e-4, 5e-5),
    (1e-5, 5e-5),
    (1e-5, 2e-5),
    (1e-6, 2e-5),
    (1e-6, 1e-5),
    (1e-6, 5e-6),
)
# Relative tolerance, and longest step [s].


@dataclass(frozen=True)
class BoardProblem:
    """Board and input of the problem."""

    board: AnalogBoard
    seconds: float

    @property
    def burst_s(self) -> tuple[float, float]:
        """Begin and end of the burst [s], some two fifths of the time:
        tenths, each a zero of the sine and a sample.
        """
        return round(2 * self.seconds) / 10, round(6 * self.seconds) / 10

    @property
    def time_s(self) -> Array:
        """Samples [s]."""
        return np.asarray(np.arange(round(self.seconds / STEP_S) + 1) * STEP_S, dtype=np.float64)

    @property
    def voltage_v(self) -> Array:
        """Tactile voltage at the samples [V]: 90 Hz of 20 mV during the burst, on 4 V."""
        t = self.time_s
        begin, end = self.burst_s
        sine = AMPLITUDE_V * np.sin(2 * math.pi * FREQUENCY_HZ * t)

        return np.asarray(
            CONSTANT_V + np.where((t > begin) & (t < end), sine, 0.0), dtype=np.float64
        )

    @property
    def start(self) -> Array:
        """States at time 0: voltages of C1, C2 and C3, and the envelope."""
        return np.array([CONSTANT_V, 0.0, 0.0, 0.0])

    def run_fingertip(self, tolerance_v: float) -> Outcome:
        """Envelope by fingertip [V]; preparing the exact steps counts,
        the circuit's equations are given as to all.
        """
        voltage = self.voltage_v
        start = time.process_time()
        found = simulate_board(self.board, STEP_S, voltage, tolerance_v)

        # The diode's current is evaluated in each of the five stages; all else is a closed form.
        return Outcome(found.envelope_v, time.process_time() - start, 5 * found.implicit)

    def run_scipy(
        self,
        system: System,
        method: str,
        stops: bool,
        tolerance: float,
    ) -> Outcome:
        """Envelope by scipy [V]; steps end at every sample, or are no longer than a sample."""
        t = self.time_s
        segments = [Segment(t, (self.voltage_v,))]
        longest = None if stops else STEP_S
        absolute = np.full(4, 0.1 * tolerance)
        start = time.process_time()
        found, calls = solve_with_scipy(
            method,
            system=system,
            segments=segments,
            start=self.start,
            relative=tolerance,
            absolute=absolute,
            longest_s=longest,
            stops_s=t[1:] if stops else None,
        )

        return Outcome(found[3], time.process_time() - start, calls)

    def run_restarted(self, system: System, tolerance: float) -> Array:
        """Envelope by LSODA [V], restarted at every sample: the independent reference."""
        t = self.time_s
        segments = [Segment(t[i : i + 2], (self.voltage_v,)) for i in range(len(t) - 1)]
        found, _ = solve_with_scipy(
            "LSODA",
            system=system,
            segments=segments,
            start=self.start,
            relative=tolerance,
            absolute=np.full(4, 1e-14),
        )

        return np.asarray(found[3], dtype=np.float64)

    def run_exact_sine(
        self,
        system: System,
        method: str,
        tolerance: float,
        time_s: Array,
    ) -> Array:
        """Envelope at sorted times [V] for the sine itself, restarted where it begins and ends."""
        corners = [0.0, *self.burst_s, time_s[-1]]
        amplitudes = (0.0, AMPLITUDE_V, 0.0)
        wanted = np.unique(np.concatenate((time_s, corners)))
        segments = [
            Segment(wanted[(wanted >= a) & (wanted <= b)], (np.array([amplitude]),))
            for (a, b), amplitude in zip(pairwise(corners), amplitudes, strict=True)
        ]
        found, _ = solve_with_scipy(
            method,
            system=system,
            segments=segments,
            start=self.start,
            relative=tolerance,
            absolute=np.full(4, 0.1 * tolerance),
        )

        return np.asarray(found[3][np.searchsorted(wanted, time_s)], dtype=np.float64)

    def run_native(
        self,
        solver: NativeSolver,
        way: str,
        reference: Array | None,
        tolerance: float,
    ) -> Outcome:
        """Envelope in C or Fortran [V], in one of the ways "step <=
        sample", "stops at samples" and "sine".
        """
        board = self.board
        count = len(self.time_s)
        d = board.diode
        c = {name: float(value) for name, value in board.components.items()}
        parameters = np.array(
            [
                gain(board),
                c["R1"] * c["C1"],
                c["R3"] * c["C3"],
                c["R2"],
                c["R3"],
                c["C2"],
                d.emission * d.thermal_v,
                d.saturation_a,
                d.series_ohm,
                c["R6"],
                c["C4"],
            ]
        )
        last = np.array([count - 1])

        if way == "stops at samples":
            last = np.arange(1, count)
        elif way == "sine":
            last = np.array([*(round(time / STEP_S) for time in self.burst_s), count - 1])

        is_sine = way == "sine"
        drive = np.array([CONSTANT_V, AMPLITUDE_V, FREQUENCY_HZ]) if is_sine else self.voltage_v
        states, cpu_s, calls = solver.solve(
            "board",
            parameters,
            drive,
            0 if is_sine else count,
            last,
            1 / STEP_S,
            self.start,
            tolerance,
            np.full(4, 0.1 * tolerance),
            restart=is_sine,
            longest_s=STEP_S if way == "step <= sample" else 0.0,
        )
        return Outcome(states[:, 3], cpu_s, calls, reference)

    def run_spice(
        self,
        simulator: Spice,
        system: System | None,
        reltol: float,
        longest_s: float,
    ) -> Outcome:
        """Envelope by ngspice [V]: at the samples, or, for the sine, at its own time points."""
        t, _, envelope = simulator.simulate(reltol, longest_s)
        cpu_s = simulator.measure_cpu_s(reltol, longest_s)
        if system is None:
            return Outcome(np.interp(self.time_s, t, envelope), cpu_s)

        return Outcome(envelope, cpu_s, reference=self.run_exact_sine(system, "LSODA", 1e-11, t))


def measure_board(
    seconds: float,
    peers: tuple[str, ...],
    native: NativeSolvers,
    advance: Callable[[float], None] = lambda _: None,
) -> WorkPrecision:
    """Measure fingertip and its peers on the same problem. Units: `seconds` [s]."""
    seconds = max(seconds, MIN_SECONDS)
    problem = BoardProblem(AnalogBoard.from_design(Design.load("article"), "ideal"), seconds)
    system = _scipy_equations(problem.board)
    begin, end = problem.burst_s
    diagram = WorkPrecision(
        f"board, {seconds:g} s with a burst of {end - begin:.3g} s", "V", LEVELS_V
    )
    diagram.solvers[OURS] = (
        f"{__version__}, exact linear steps and SDIRK4, compiled loop, samples joined by lines"
    )
    diagram.targets |= {
        name: TARGETS[name] for name in TARGETS if name.removesuffix(", sine") in native.found
    }
    problem.run_fingertip(1e-3)  # compiles
    reference = problem.run_fingertip(1e-12).result
    diagram.reference_difference = float(
        np.abs(problem.run_restarted(system, 1e-12) - reference).max()
    )
    jobs = [
        Job(OURS, f"tolerance {tolerance:.0e} V", partial(problem.run_fingertip, tolerance))
        for tolerance in (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6)
    ]
    jobs += _scipy_jobs(diagram, problem, system, peers)

    if {*NATIVE, "ngspice"} & set(peers):
        t = problem.time_s
        sine = problem.run_exact_sine(system, "LSODA", 1e-12, t)
        difference = float(np.abs(problem.run_exact_sine(system, "Radau", 1e-10, t) - sine).max())
        diagram.reference_difference = max(diagram.reference_difference, difference)
        lines = float(np.abs(sine - reference).max())
        diagram.notes.append(
            f"straight lines instead of the sine change the envelope by up to {lines:.1e} V; "
            "errors for the sine are "
            "those against the response to the sine"
        )
        jobs += _native_jobs(diagram, problem, native, sine)
        jobs += _spice_jobs(diagram, problem, system, peers)

    diagram.measure(jobs, reference, advance)
    return diagram


def _scipy_jobs(
    diagram: WorkPrecision, problem: BoardProblem, system: System, peers: tuple[str, ...]
) -> Iterator[Job]:
    for method in (*SOLVE_IVP, "odeint"):
        if method not in peers:
            continue

        name = f"scipy {method}"
        both = method == "odeint"
        kind = "odeint" if both else f"solve_ivp({method})"
        diagram.solvers[name] = (
            f"scipy {scipy_version()}, {kind}, equations compiled by numba, analytic Jacobian, "
            "rtol as stated, "
            f"atol: rtol x 0.1 V, steps {'as stated' if both else 'no longer than a sample'}"
        )
        if both:
            diagram.targets[name] = TARGETS[name]

        exponents = (
            np.arange(-2.0, -7.1, -0.5)
            if both or method == "LSODA"
            else np.arange(-2.0, -6.1, -2.0)
        )
        for stops in (False, True) if both else (False,):
            way = ("stops at samples" if stops else "step <= sample") if both else ""
            for e in exponents:
                setting = f"rtol {10.0**e:.1e} {way}".rstrip()
                yield Job(name, setting, partial(problem.run_scipy, system, method, stops, 10.0**e))


def _native_jobs(
    diagram: WorkPrecision, problem: BoardProblem, native: NativeSolvers, sine: Array
) -> Iterator[Job]:
    diagram.leave_out(native.missing)
    for name, solver in native.found.items():
        settings = (
            f"{solver.description}, equations in C, analytic Jacobian, rtol as stated, "
            "atol: rtol x 0.1 V"
        )
        diagram.solvers[name] = f"{settings}, samples joined by lines, steps as stated"
        diagram.solvers[f"{name}, sine"] = (
            f"{settings}, input: the sine, restarted where it begins and ends"
        )
        # Coarser, CVODE runs away.
        exponents = np.arange(-3.0 if name == "CVODE" else -1.0, -8.1, -0.5)

        for way in ("step <= sample", "stops at samples"):
            for e in exponents:
                yield Job(
                    name,
                    f"rtol {10.0**e:.1e} {way}",
                    partial(problem.run_native, solver, way, None, 10.0**e),
                )

        for e in exponents:
            run = partial(problem.run_native, solver, "sine", sine, 10.0**e)
            yield Job(f"{name}, sine", f"rtol {10.0**e:.1e}", run)


def _spice_jobs(
    diagram: WorkPrecision, problem: BoardProblem, system: System, peers: tuple[str, ...]
) -> Iterator[Job]:
    if "ngspice" not in peers:
        return

    names = "ngspice", "ngspice, sine"
    diagram.targets[names[1]] = TARGETS[names[1]]
    program = spice.find_program()

    if program is None:
        for name in names:
            diagram.solvers[name] = "NOT MEASURED"

        diagram.omissions.append(
            "ngspice: NOT MEASURED: it is not installed; install Debian's package ngspice, or "
            "leave it out of --solvers"
        )
        return

    version = (
        f"{spice.read_version(program)}, trapezoidal rule, reltol and longest step as "
        "stated, gmin 1e-18 S"
    )
    diagram.solvers[names[0]] = f"{version}, input: PWL source"
    diagram.solvers[names[1]] = f"{version}, input: two SIN sources in series"
    sampled = Spice(
        program=program,
        board=problem.board,
        source=spice.sampled_source(STEP_S, problem.voltage_v),
        step_s=STEP_S,
        end_s=problem.seconds,
    )
    burst = spice.burst_source(CONSTANT_V, AMPLITUDE_V, FREQUENCY_HZ, *problem.burst_s)

    for name, simulator, exact in (
        (names[0], sampled, None),
        (names[1], replace(sampled, source=burst), system),
    ):
        for reltol, longest in _SPICE_SETTINGS:
            setting = f"reltol {reltol:g}, step {longest:g} s"
            yield Job(name, setting, partial(problem.run_spice, simulator, exact, reltol, longest))


def _scipy_equations(board: AnalogBoard) -> System:
    """Right-hand side and Jacobian for scipy; their argument holds the
    samples, or the amplitude of the burst alone.
    """
    d = board.diode
    (_, r2, r3, _, _, r, _, c2, _, c) = (float(v) for v in board.components.values())
    G = gain(board)
    t1 = board.components["R1"] * board.components["C1"]
    t3 = r3 * board.components["C3"]
    nvt = d.emission * d.thermal_v
    saturation = d.saturation_a
    series = d.series_ohm
    rho = series / nvt
    shift = math.log(rho * saturation) + rho * saturation
    omega = compile_for_process(wright_omega)

    def read_input(t: float, voltage: Array) -> Any:
        if len(voltage) == 1:  # the amplitude of the burst at this time
            return CONSTANT_V + voltage[0] * math.sin(2 * math.pi * FREQUENCY_HZ * t)

        place = min(int(t / STEP_S), len(voltage) - 2)
        return voltage[place] + (voltage[place + 1] - voltage[place]) * (t / STEP_S - place)

    input_v = compile_for_process(read_input)

    def rates(t: float, s: Array, voltage: Array) -> Array:
        u = input_v(t, voltage)
        p = u - s[0]
        n = G * p - s[1] - s[2]
        current = omega(shift + (n - s[3]) / nvt) / rho - saturation
        out = np.empty(4)
        out[0] = p / t1
        out[1] = (n / r3 + s[2] / r2) / c2
        out[2] = n / t3
        out[3] = (current - s[3] / r) / c

        return out

    def jacobian(t: float, s: Array, voltage: Array) -> Array:
        u = input_v(t, voltage)
        n = G * (u - s[0]) - s[1] - s[2]
        w = omega(shift + (n - s[3]) / nvt)
        slope = w / (1 + w) / series
        out = np.zeros((4, 4))
        out[0, 0] = -1 / t1
        out[1, 0] = -G / r3 / c2
        out[1, 1] = -1 / r3 / c2
        out[1, 2] = (1 / r2 - 1 / r3) / c2
        out[2, 0] = -G / t3
        out[2, 1] = -1 / t3
        out[2, 2] = -1 / t3
        out[3, 0] = -G * slope / c
        out[3, 1] = -slope / c
        out[3, 2] = -slope / c
        out[3, 3] = -(slope + 1 / r) / c

        return out

    return System(compile_for_process(rates), compile_for_process(jacobian))
