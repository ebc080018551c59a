"""Solvers in C and Fortran on the benchmark's problems: compiled where they run, and called through
ctypes.

CVODE: A. C. Hindmarsh et al., ACM TOMS 31(3), 2005, doi:10.1145/1089014.1089020. RADAU and Rodas5P:
see their headers.
"""

from __future__ import annotations

import ctypes
import resource
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.foundation.files import temporary_folder
from fingertip.foundation.numerics import Array

_FLAGS = (
    "-O3",
    "-march=native",
    "-shared",
    "-fPIC",
    "-std=c11",
    "-D_POSIX_C_SOURCE=199309L",
    "-Wl,--no-undefined",
)
_SUNDIALS = (
    "-lsundials_cvode",
    "-lsundials_nvecserial",
    "-lsundials_sunmatrixdense",
    "-lsundials_sunlinsoldense",
)


class SolverFailedError(Exception):
    """A solver gave up."""


@dataclass(frozen=True)
class _Source:
    """Compilation of a solver."""

    header: str
    describe: str
    libraries: tuple[tuple[str, ...], ...] = ((),)
    """Libraries to try, one after another."""
    remedy: str = ""
    option: int = 0


_RADAU = "E. Hairer's and G. Wanner's RADAU in Fortran"
_INSTALL_RADAU = "run `sh .ci/install-radau` as root on Debian"
_SOURCES = {
    "CVODE": _Source(
        "cvode.h",
        "SUNDIALS {version}, BDF with Newton and a dense matrix",
        (_SUNDIALS, (*_SUNDIALS, "-lsundials_core")),  # the second from version 7 on
        "install SUNDIALS 6, Debian's libsundials-dev",
    ),
    "RADAU5": _Source(
        header="radau.h",
        describe=f"{_RADAU}, kept at order 5",
        libraries=(("-lradau",),),
        remedy=_INSTALL_RADAU,
        option=3,
    ),
    "RADAU": _Source("radau.h", f"{_RADAU}, order 5 to 13", (("-lradau",),), _INSTALL_RADAU),
    "Rodas5P": _Source("rodas5p.h", "G. Steinebach's coefficients, in C"),
}
NATIVE = tuple(_SOURCES)
"""Names of the solvers."""


class _Run(ctypes.Structure):
    """The struct Run of solver.h."""

    _fields_ = (
        ("last", ctypes.c_void_p),
        ("corners", ctypes.c_int),
        ("restart", ctypes.c_int),
        ("option", ctypes.c_int),
        ("rate_hz", ctypes.c_double),
        ("longest_s", ctypes.c_double),
        ("start", ctypes.c_void_p),
        ("relative", ctypes.c_double),
        ("absolute", ctypes.c_void_p),
    )


@dataclass(frozen=True)
class NativeSolver:
    """A solver that is compiled for both problems."""

    name: str
    description: str
    programs: Mapping[str, ctypes.CDLL]
    """Problem, "contact" or "board" -> its functions."""
    option: int

    def solve(
        self,
        problem: str,
        parameters: Array,
        drive: Array,
        samples: int,
        last: Array,
        rate_hz: float,
        start: Array,
        relative: float,
        absolute: Array,
        *,
        restart: bool = True,
        longest_s: float = 0.0,
        option: int | None = None,
    ) -> tuple[Array, float, int]:
        """Return the states at the samples, one row each; CPU time [s] and evaluations of the
        integration.

        `last` are the samples at which the input has a corner. `samples` is the number of samples
        in `drive`, where it holds samples. Raises SolverFailedError.
        """
        ends = np.ascontiguousarray(last, dtype=np.intc)
        states = np.zeros((last[-1] + 1, len(start)))
        cost = np.zeros(2)
        run = _Run(
            ends.ctypes.data,
            len(ends),
            int(restart),
            self.option if option is None else option,
            rate_hz,
            longest_s,
            _pointer(start),
            relative,
            _pointer(absolute),
        )
        failed = self.programs[problem].solve(
            ctypes.c_void_p(_pointer(parameters)),
            ctypes.c_void_p(_pointer(drive)),
            samples,
            ctypes.byref(run),
            ctypes.c_void_p(_pointer(states)),
            ctypes.c_void_p(_pointer(cost)),
        )
        if failed:
            raise SolverFailedError(f"{self.name}'s error {failed}")

        return states, float(cost[0]), int(cost[1])


@dataclass(frozen=True)
class NativeSolvers:
    """The solvers that were asked for."""

    found: Mapping[str, NativeSolver] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    """Solver -> why it cannot be measured."""
    compilation_s: Mapping[str, float] = field(default_factory=dict)
    """CPU time of the compilation of both problems [s]."""


@contextmanager
def compile_solvers(names: Iterable[str], compiler: str = "cc") -> Iterator[NativeSolvers]:
    """Compile solvers into a temporary folder and load them."""
    wanted = [name for name in NATIVE if name in names]
    program = shutil.which(compiler)

    if not program:
        reason = f"no C compiler ({compiler}); install one, such as Debian's package gcc"
        yield NativeSolvers(missing=dict.fromkeys(wanted, reason))
        return

    version = subprocess.run(
        [program, "--version"], capture_output=True, text=True
    ).stdout.partition("\n")[0]
    found = {}
    missing = {}
    compilation_s = {}

    with temporary_folder() as folder, as_file(files(__name__)) as sources:
        for name in wanted:
            source = _SOURCES[name]
            before = _children_cpu_s()
            targets = {problem: folder / f"{problem}_{name}.so" for problem in ("contact", "board")}
            reasons = [
                _compile(program, sources / f"{problem}.c", source, targets[problem])
                for problem in targets
            ]

            if any(reasons):
                missing[name] = str(next(filter(None, reasons)))
                continue

            compilation_s[name] = _children_cpu_s() - before
            programs = {problem: ctypes.CDLL(str(target)) for problem, target in targets.items()}
            found[name] = NativeSolver(
                name, f"{_describe(source, programs)} ({version})", programs, source.option
            )

        yield NativeSolvers(found, missing, compilation_s)


def _compile(program: str, file: Path, source: _Source, target: Path) -> str | None:
    """Compile one problem for one solver; return why it failed."""
    done: Any = None
    for libraries in source.libraries:
        done = subprocess.run(
            [
                program,
                *_FLAGS,
                f'-DSOLVER="{source.header}"',
                "-o",
                str(target),
                str(file),
                *libraries,
                "-lm",
            ],
            capture_output=True,
            text=True,
        )
        if done.returncode == 0:
            return None

    lines = [line for line in done.stderr.splitlines() if "error" in line or "cannot find" in line]
    reason = " ".join((lines or ["the compiler failed"])[0].split())[:160]
    return f"{file.name} does not compile with {source.header} ({reason}); {source.remedy}"


def _describe(source: _Source, programs: Mapping[str, ctypes.CDLL]) -> str:
    if "{version}" not in source.describe:
        return source.describe

    version = ctypes.create_string_buffer(80)
    programs["contact"].read_version(version, 80)
    return source.describe.format(version=version.value.decode())


def _children_cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _pointer(values: Array) -> int:
    """Address of a contiguous array of doubles."""
    if values.dtype != np.float64 or not values.flags.c_contiguous:
        raise TypeError("native solvers take contiguous arrays of doubles")

    return int(values.ctypes.data)
