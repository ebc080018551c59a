"""Work-precision of the board: a burst of vibration through filter, diode and envelope, in three simulators.

Every solver joins the samples by straight lines. scipy gets compiled right sides and Jacobians, with the diode and its
series resistance solved by the same function as here, and must not step over a sample. ngspice reads the samples as a
piecewise linear source and evaluates it itself. Writing its deck and reading its result are not counted.
"""

from __future__ import annotations

import math
import resource
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.jit import compile_for_process
from fingertip.sim.bench.work_precision import WorkPrecision
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.envelope_loop import wright_omega
from fingertip.sim.signal.filter_board import simulate_board

STEP_S = 1 / 2000
TARGET_V = 5e-4
OURS = "fingertip (exact + SDIRK4)"
_SPICE_SETTINGS = ((1e-2, 5e-4), (1e-3, 5e-4), (1e-4, 1e-4), (1e-5, 5e-5), (1e-6, 2e-5))
# Relative tolerance, and longest step [s].
_DECK = """slip filter, sampled input
V1 in 0 PWL(
{points}
+ )
C1 in p {C1!r}
R1 p 0 {R1!r}
E1 o1 0 p 0 {gain!r}
C2 o1 m {C2!r}
C3 m n {C3!r}
R2 m o2 {R2!r}
R3 n 0 {R3!r}
E2 o2 0 n 0 1
D1 o2 env dd
RL env 0 {R6!r}
CL env 0 {C4!r}
.model dd D(IS={diode.saturation_a!r} N={diode.emission!r} RS={diode.series_ohm!r})
.options reltol={reltol!r} gmin=1e-18
.temp 27
.control
set wr_singlescale
option numdgt=10
tran {step!r} {end!r} 0 {longest!r}
wrdata out v(o2) v(env)
quit
.endc
.end
"""


def make_input(seconds: float) -> Array:
    """Tactile voltage at the samples [V]: 90 Hz of 20 mV during two fifths of the time, on 4 V."""
    t = np.arange(round(seconds / STEP_S) + 1) * STEP_S
    during = (t > 0.2 * seconds) & (t < 0.6 * seconds)
    return 4.0 + np.where(during, 0.02 * np.sin(2 * math.pi * 90 * t), 0.0)


def measure_board(seconds: float, methods: tuple[str, ...] = ("LSODA", "Radau", "BDF")) -> WorkPrecision:
    """Measure all solvers on the same problem."""
    board = AnalogBoard.from_design(Design())
    diagram = WorkPrecision(
        f"board, {seconds:g} s with a burst of {0.4 * seconds:g} s",
        "V",
        TARGET_V,
        {"scipy LSODA": 20.0, "ngspice": 50.0},
    )
    start = time.process_time()
    voltage = make_input(seconds)
    diagram.input_s = time.process_time() - start
    rates, jacobian = _scipy_equations(board)
    t = np.arange(len(voltage)) * STEP_S
    start_state = np.array([voltage[0], 0.0, 0.0, 0.0])

    def run_ours(tolerance: float) -> Array:
        return simulate_board(board, STEP_S, voltage, tolerance).envelope_v

    def run_scipy(method: str, tolerance: float) -> Array:
        from scipy.integrate import solve_ivp

        solution = solve_ivp(
            rates, (0.0, t[-1]), start_state, method, t, args=(voltage,), rtol=tolerance, atol=tolerance * 0.1,
            max_step=STEP_S, jac=jacobian,
        )  # fmt: skip
        if not solution.success:
            raise ArithmeticError(solution.message)
        return np.asarray(solution.y[3])

    def run_restarted(tolerance: float) -> Array:
        """LSODA restarted at every sample, where the input has a corner: the independent reference."""
        from scipy.integrate import solve_ivp

        state, out = start_state, [0.0]
        for i in range(len(voltage) - 1):
            solution = solve_ivp(rates, (t[i], t[i + 1]), state, "LSODA", args=(voltage,), rtol=tolerance, atol=1e-14,
                                 jac=jacobian)  # fmt: skip
            state = solution.y[:, -1]
            out.append(float(state[3]))
        return np.array(out)

    run_ours(1e-3)  # compiles
    reference = run_ours(1e-12)
    diagram.reference_difference = float(np.abs(run_restarted(1e-12) - reference).max())
    for exponent in range(-2, -8, -1):
        diagram.measure(OURS, f"1e{exponent} V", lambda e=exponent: run_ours(10.0**e), reference)  # type: ignore[misc]
    for method in methods:
        for exponent in (-2, -3, -4, -5, -6) if method == "LSODA" else (-2, -4, -6):
            run: Callable[[], Array] = lambda m=method, e=exponent: run_scipy(m, 10.0**e)  # type: ignore[misc]  # noqa: E731
            diagram.measure(f"scipy {method}", f"rtol 1e{exponent}", run, reference)
    _measure_ngspice(diagram, board, voltage, reference)
    return diagram


def _measure_ngspice(diagram: WorkPrecision, board: AnalogBoard, voltage: Array, reference: Array) -> None:
    program = shutil.which("ngspice")
    if not program:
        diagram.omissions.append("ngspice: is not installed")
        return
    for reltol, longest in _SPICE_SETTINGS:
        with tempfile.TemporaryDirectory() as folder:
            write_deck(Path(folder), board, STEP_S, voltage, reltol, longest)
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            setting = f"reltol {reltol:g}, step {longest:g} s"
            try:
                run_deck(Path(program), Path(folder))
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                _, envelope = read_result(Path(folder), STEP_S, len(voltage))
            except Exception as error:
                diagram.omissions.append(f"ngspice, {setting}: failed ({type(error).__name__}: {str(error)[:80]})")
                continue
            cpu = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
            diagram.add_result("ngspice", setting, cpu, envelope, reference)


def write_deck(
    folder: Path, board: AnalogBoard, step_s: float, voltage_v: Array, reltol: float, longest_s: float
) -> None:
    """Write the deck `slip.cir` for ngspice. Its amplifiers are ideal, like those of an `AnalogBoard` without rails."""
    pairs = [f"{i * step_s:.9g} {v:.17g}" for i, v in enumerate(voltage_v.tolist())]
    points = "\n".join("+ " + " ".join(pairs[i : i + 4]) for i in range(0, len(pairs), 4))
    deck = _DECK.format(
        points=points, gain=_gain(board), diode=board.diode, reltol=reltol, step=step_s,
        end=(len(pairs) - 1) * step_s, longest=longest_s, **board.components,
    )  # fmt: skip
    (folder / "slip.cir").write_text(deck)


def run_deck(program: Path, folder: Path) -> None:
    """Run ngspice on the deck; raises CalledProcessError if it fails."""
    subprocess.run([program, "-b", "slip.cir"], cwd=folder, check=True, capture_output=True)


def read_result(folder: Path, step_s: float, samples: int) -> tuple[Array, Array]:
    """Read filtered voltage and envelope at the samples; ngspice has time points there, at its source's corners."""
    out = np.loadtxt(folder / "out.data" if (folder / "out.data").exists() else folder / "out")
    time = np.arange(samples) * step_s
    return np.interp(time, out[:, 0], out[:, 1]), np.interp(time, out[:, 0], out[:, 2])


def _gain(board: AnalogBoard) -> float:
    """Gain of the first stage, G = 1 + R5 / R4."""
    return 1 + float(board.components["R5"] / board.components["R4"])


def _scipy_equations(board: AnalogBoard) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Right side and Jacobian for scipy."""
    d, (_, r2, r3, _, _, r, _, c2, _, c) = board.diode, (float(v) for v in board.components.values())
    G, t1, t3 = _gain(board), board.components["R1"] * board.components["C1"], r3 * board.components["C3"]
    nvt, saturation, series = d.emission * d.thermal_v, d.saturation_a, d.series_ohm
    rho = series / nvt
    shift = math.log(rho * saturation) + rho * saturation
    omega = compile_for_process(wright_omega)

    def rates(t: float, s: Array, voltage: Array) -> Array:
        place = min(int(t / STEP_S), len(voltage) - 2)
        u = voltage[place] + (voltage[place + 1] - voltage[place]) * (t / STEP_S - place)
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
        place = min(int(t / STEP_S), len(voltage) - 2)
        u = voltage[place] + (voltage[place + 1] - voltage[place]) * (t / STEP_S - place)
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

    return compile_for_process(rates), compile_for_process(jacobian)
