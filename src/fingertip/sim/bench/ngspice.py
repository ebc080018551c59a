"""The article's filter and envelope in ngspice, driven by sampled voltages: the board's other solver."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.electronics.circuit import Analog

_DECK = """slip filter, sampled input
V1 in 0 PWL(
{points}
+ )
C1 in p {b.c1_f!r}
R1 p 0 {b.r1_ohm!r}
E1 o1 0 p 0 {gain!r}
C2 o1 m {b.c2_f!r}
C3 m n {b.c3_f!r}
R2 m o2 {b.r2_ohm!r}
R3 n 0 {b.r3_ohm!r}
E2 o2 0 n 0 1
D1 o2 env dd
RL env 0 {b.r_lp_ohm!r}
CL env 0 {b.c_lp_f!r}
.model dd D(IS={b.diode.saturation_a!r} N={b.diode.emission!r} RS={b.diode.series_ohm!r})
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


def write_deck(folder: Path, board: Analog, step_s: float, voltage_v: Array, reltol: float, longest_s: float) -> None:
    """The deck `slip.cir`; amplifiers are ideal, as in `fingertip.sim.electronics.circuit` without rails."""
    pairs = [f"{i * step_s:.9g} {v:.17g}" for i, v in enumerate(voltage_v.tolist())]
    points = "\n".join("+ " + " ".join(pairs[i : i + 4]) for i in range(0, len(pairs), 4))
    deck = _DECK.format(
        points=points, b=board, gain=board.gain, reltol=reltol, step=step_s, end=(len(pairs) - 1) * step_s,
        longest=longest_s,
    )  # fmt: skip
    (folder / "slip.cir").write_text(deck)


def run_deck(program: Path, folder: Path) -> None:
    """Run it; raises CalledProcessError if ngspice fails."""
    subprocess.run([program, "-b", "slip.cir"], cwd=folder, check=True, capture_output=True)


def read_result(folder: Path, step_s: float, samples: int) -> tuple[Array, Array]:
    """Filtered and enveloped voltage at the samples, where ngspice has a point of its own (its source bends there)."""
    out = np.loadtxt(folder / "out.data" if (folder / "out.data").exists() else folder / "out")
    time = np.arange(samples) * step_s
    return np.interp(time, out[:, 0], out[:, 1]), np.interp(time, out[:, 0], out[:, 2])


def run_ngspice(
    program: Path, folder: Path, board: Analog, step_s: float, voltage_v: Array, reltol: float, longest_s: float
) -> tuple[Array, Array]:
    """All three."""
    write_deck(folder, board, step_s, voltage_v, reltol, longest_s)
    run_deck(program, folder)
    return read_result(folder, step_s, len(voltage_v))
