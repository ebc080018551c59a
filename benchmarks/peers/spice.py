"""ngspice on the benchmark's board: deck, run and result.

ngspice evaluates its source itself. Its CPU time is that of a run that writes no result, less that
of a run of the same deck that stops after one step: reading the deck and starting the program do
not count.
"""

from __future__ import annotations

import resource
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingertip.foundation.files import temporary_folder
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.analog_circuit import AnalogBoard

_DECK = """slip filter
{source}
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
{write}
quit
.endc
.end
"""


_WRITE = "wrdata out v(o2) v(env)"


@dataclass(frozen=True)
class Spice:
    """ngspice, on one board and one source."""

    program: Path
    board: AnalogBoard
    source: str
    """Lines of the deck that drive the net `in`."""
    step_s: float
    end_s: float

    def simulate(self, reltol: float, longest_s: float) -> tuple[Array, Array, Array]:
        """Return time [s], filtered voltage and envelope [V] at ngspice's own time points."""
        with temporary_folder() as folder:
            self._run(
                folder,
                end_s=self.end_s,
                reltol=reltol,
                longest_s=longest_s,
                write=_WRITE,
            )
            t, filtered, envelope = read_points(folder)

        return t, filtered, envelope

    def measure_cpu_s(self, reltol: float, longest_s: float) -> float:
        """Measure the CPU time of the integration [s]."""
        with temporary_folder() as folder:
            return self._run(
                folder,
                end_s=self.end_s,
                reltol=reltol,
                longest_s=longest_s,
                write="",
            ) - self._start_up_s(folder)

    def measure_start_up_s(self) -> float:
        """Measure the CPU time of the program's start and of reading the deck [s]."""
        with temporary_folder() as folder:
            return self._start_up_s(folder)

    def _start_up_s(self, folder: Path) -> float:
        return min(
            self._run(
                folder,
                end_s=self.step_s,
                reltol=1e-3,
                longest_s=self.step_s,
                write="",
            )
            for _ in range(3)
        )

    def _run(
        self,
        folder: Path,
        end_s: float,
        reltol: float,
        longest_s: float,
        write: str,
    ) -> float:
        deck = _DECK.format(
            source=self.source,
            gain=gain(self.board),
            diode=self.board.diode,
            reltol=reltol,
            step=self.step_s,
            end=end_s,
            longest=longest_s,
            write=write,
            **self.board.components,
        )
        (folder / "slip.cir").write_text(deck)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [self.program, "-b", "slip.cir"], cwd=folder, check=True, capture_output=True
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)

        return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def sampled_source(step_s: float, voltage_v: Array) -> str:
    """Source that joins samples by straight lines."""
    pairs = [f"{i * step_s:.9g} {v:.17g}" for i, v in enumerate(voltage_v.tolist())]
    points = "\n".join("+ " + " ".join(pairs[i : i + 4]) for i in range(0, len(pairs), 4))
    return f"V1 in 0 PWL(\n{points}\n+ )"


def burst_source(
    constant_v: float,
    amplitude_v: float,
    frequency_hz: float,
    begin_s: float,
    end_s: float,
) -> str:
    """Burst of a sine on a constant: two native sources in series, of which the second cancels the
    first at the end.

    Begin and end are zeros of the sine.
    """
    return (
        f"V1 in mid SIN({constant_v!r} {amplitude_v!r} {frequency_hz!r} {begin_s!r})\n"
        f"V2 mid 0 SIN(0 {-amplitude_v!r} {frequency_hz!r} {end_s!r})"
    )


def find_program() -> Path | None:
    """Path of ngspice; None where it is not installed."""
    found = shutil.which("ngspice")
    return Path(found) if found else None


def read_version(program: Path) -> str:
    """Version of ngspice, such as "ngspice-39"."""
    done = subprocess.run([program, "--version"], capture_output=True, text=True)
    words = [word for word in done.stdout.split() if word.startswith("ngspice-")]
    return words[0] if words else "ngspice"


def read_points(folder: Path) -> tuple[Array, Array, Array]:
    """Read time [s], filtered voltage and envelope [V] of a run."""
    out = np.loadtxt(folder / "out.data" if (folder / "out.data").exists() else folder / "out")
    return out[:, 0], out[:, 1], out[:, 2]


def gain(board: AnalogBoard) -> float:
    """Gain of the first stage, G = 1 + R5 / R4."""
    return 1 + float(board.components["R5"] / board.components["R4"])
