"""Work-precision of the board: a burst of vibration through filter, diode and envelope, by us, scipy and ngspice.

The samples are joined by straight lines, for everyone. scipy gets compiled right sides and Jacobians, with the diode
and its series resistance solved by the same function as ours, and may not step over a sample. ngspice reads the
samples as a piecewise linear source and evaluates it itself; writing its deck and reading its result are not counted.
"""

from __future__ import annotations

import math
import resource
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.jit import compile_for_process
from fingertip.sim.bench import ngspice
from fingertip.sim.bench.measure import Diagram
from fingertip.sim.electronics.analog import respond
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.electronics.envelope_loop import omega

STEP_S = 1 / 2000
TARGET_V = 5e-4
OURS = "fingertip (exact + SDIRK4)"
_SPICE = ((1e-2, 5e-4), (1e-3, 5e-4), (1e-4, 1e-4), (1e-5, 5e-5), (1e-6, 2e-5))


def problem(seconds: float) -> Array:
    """Tactile voltage at the samples [V]: 90 Hz of 20 mV, two fifths of the time, on 4 V."""
    t = np.arange(round(seconds / STEP_S) + 1) * STEP_S
    during = (t > 0.2 * seconds) & (t < 0.6 * seconds)
    return 4.0 + np.where(during, 0.02 * np.sin(2 * math.pi * 90 * t), 0.0)


def diagram(seconds: float, solvers: tuple[str, ...] = ("LSODA", "Radau", "BDF")) -> Diagram:
    """Measure all solvers on the same problem."""
    board = Analog.of(Design())
    found = Diagram(
        f"board, {seconds:g} s with a burst of {0.4 * seconds:g} s",
        "V",
        TARGET_V,
        {"scipy LSODA": 20.0, "ngspice": 50.0},
    )
    start = time.process_time()
    voltage = problem(seconds)
    found.input_s = time.process_time() - start
    rates, jacobian = _theirs(board)
    t = np.arange(len(voltage)) * STEP_S
    start_state = np.array([voltage[0], 0.0, 0.0, 0.0])

    def ours(tolerance: float) -> Array:
        return respond(board, STEP_S, voltage, tolerance).envelope_v

    def theirs(method: str, tolerance: float) -> Array:
        from scipy.integrate import solve_ivp

        part = solve_ivp(
            rates, (0.0, t[-1]), start_state, method, t, args=(voltage,), rtol=tolerance, atol=tolerance * 0.1,
            max_step=STEP_S, jac=jacobian,
        )  # fmt: skip
        if not part.success:
            raise ArithmeticError(part.message)
        return np.asarray(part.y[3])

    def restarted(tolerance: float) -> Array:
        """LSODA begun anew at every sample, where the input bends: the reference that is not ours."""
        from scipy.integrate import solve_ivp

        state, out = start_state, [0.0]
        for i in range(len(voltage) - 1):
            part = solve_ivp(rates, (t[i], t[i + 1]), state, "LSODA", args=(voltage,), rtol=tolerance, atol=1e-14,
                             jac=jacobian)  # fmt: skip
            state = part.y[:, -1]
            out.append(float(state[3]))
        return np.array(out)

    ours(1e-3)
    reference = ours(1e-12)
    found.agreement = float(np.abs(restarted(1e-12) - reference).max())
    for exponent in range(-2, -8, -1):
        found.add(OURS, f"1e{exponent} V", lambda e=exponent: ours(10.0**e), reference)  # type: ignore[misc]
    for solver in solvers:
        for exponent in (-2, -3, -4, -5, -6) if solver == "LSODA" else (-2, -4, -6):
            run: Callable[[], Array] = lambda s=solver, e=exponent: theirs(s, 10.0**e)  # type: ignore[misc]  # noqa: E731
            found.add(f"scipy {solver}", f"rtol 1e{exponent}", run, reference)
    _ngspice(found, board, voltage, reference)
    return found


def _ngspice(found: Diagram, board: Analog, voltage: Array, reference: Array) -> None:
    program = shutil.which("ngspice")
    if not program:
        found.omissions.append("ngspice: is not installed here")
        return
    for reltol, longest in _SPICE:
        with tempfile.TemporaryDirectory() as folder:
            ngspice.write_deck(Path(folder), board, STEP_S, voltage, reltol, longest)
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            setting = f"reltol {reltol:g}, step {longest:g} s"
            try:
                ngspice.run_deck(Path(program), Path(folder))
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                _, envelope = ngspice.read_result(Path(folder), STEP_S, len(voltage))
            except Exception as error:
                found.omissions.append(f"ngspice, {setting}: failed ({type(error).__name__}: {str(error)[:80]})")
                continue
            cpu = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
            found.judge("ngspice", setting, cpu, envelope, reference)


def _theirs(board: Analog) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Right side and Jacobian for scipy."""
    b, d = board, board.diode
    G, t1, t3 = b.gain, b.r1_ohm * b.c1_f, b.r3_ohm * b.c3_f
    r2, r3, c2, r, c = b.r2_ohm, b.r3_ohm, b.c2_f, b.r_lp_ohm, b.c_lp_f
    nvt, saturation, series = d.emission * d.thermal_v, d.saturation_a, d.series_ohm
    rho = series / nvt
    shift = math.log(rho * saturation) + rho * saturation
    wright = compile_for_process(omega)

    def rates(t: float, s: Array, voltage: Array) -> Array:
        place = min(int(t / STEP_S), len(voltage) - 2)
        u = voltage[place] + (voltage[place + 1] - voltage[place]) * (t / STEP_S - place)
        p = u - s[0]
        n = G * p - s[1] - s[2]
        current = wright(shift + (n - s[3]) / nvt) / rho - saturation
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
        w = wright(shift + (n - s[3]) / nvt)
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
