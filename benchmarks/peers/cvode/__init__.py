"""CVODE of SUNDIALS on the benchmark's problems: C sources, compiled where they run, and called through ctypes.

A. C. Hindmarsh et al., ACM TOMS 31(3), 2005, doi:10.1145/1089014.1089020.
"""

from __future__ import annotations

import ctypes
import resource
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.foundation.files import TemporaryFolder
from fingertip.foundation.numerics import Array

_FLAGS = ("-O3", "-march=native", "-shared", "-fPIC", "-std=c11", "-D_POSIX_C_SOURCE=199309L")
_LIBRARIES = (
    "-lsundials_cvode", "-lsundials_nvecserial", "-lsundials_sunmatrixdense", "-lsundials_sunlinsoldense",
)  # fmt: skip
_CORE = "-lsundials_core"
"""Library that SUNDIALS has from version 7 on."""


class CvodeMissingError(Exception):
    """CVODE cannot be used: no C compiler, no SUNDIALS, or sources that do not compile."""


class CvodeFailedError(Exception):
    """CVODE gave up."""


@dataclass(frozen=True)
class CvodeLibrary:
    """Compiled functions of both problems."""

    contact: ctypes.CDLL
    board: ctypes.CDLL
    version: str
    """Version of SUNDIALS."""
    compiler: str
    """First line of the compiler's version."""
    compilation_s: float
    """CPU time of the compilation [s]."""

    def solve_contact(
        self, parameters: Array, drives: Array, last: Array, rate_hz: float, start: Array, relative: float,
        absolute: Array,
    ) -> tuple[Array, Array, float]:  # fmt: skip
        """Return position [m] and compression [N] at the samples, and the CPU time of the integration [s].

        Raises CvodeFailedError.
        """
        ends = np.ascontiguousarray(last, dtype=np.intc)
        position_m, compression_n = np.zeros(last[-1] + 1), np.zeros(last[-1] + 1)
        cpu_s = ctypes.c_double()
        failed = self.contact.solve_contact(
            _pointer(parameters), _pointer(drives), ends.ctypes, len(ends), ctypes.c_double(rate_hz), _pointer(start),
            ctypes.c_double(relative), _pointer(absolute), _pointer(position_m), _pointer(compression_n),
            ctypes.byref(cpu_s),
        )  # fmt: skip
        _raise_if(failed)
        return position_m, compression_n, cpu_s.value

    def solve_board(
        self, parameters: Array, voltage_v: Array | None, source: Array, last: Array, restart: bool, longest_s: float,
        rate_hz: float, start: Array, relative: float, absolute: Array,
    ) -> tuple[Array, float]:  # fmt: skip
        """Return the envelope at the samples [V], and the CPU time of the integration [s]. Raises CvodeFailedError."""
        ends = np.ascontiguousarray(last, dtype=np.intc)
        envelope_v, cpu_s = np.zeros(last[-1] + 1), ctypes.c_double()
        failed = self.board.solve_board(
            _pointer(parameters), None if voltage_v is None else _pointer(voltage_v), _pointer(source), ends.ctypes,
            len(ends), int(restart), ctypes.c_double(longest_s), ctypes.c_double(rate_hz), _pointer(start),
            ctypes.c_double(relative), _pointer(absolute), _pointer(envelope_v), ctypes.byref(cpu_s),
        )  # fmt: skip
        _raise_if(failed)
        return envelope_v, cpu_s.value


@contextmanager
def compile_cvode(compiler: str = "cc") -> Iterator[CvodeLibrary]:
    """Compile the C sources into a temporary folder and load them. Raises CvodeMissingError."""
    program = shutil.which(compiler)
    if not program:
        raise CvodeMissingError(f"no C compiler ({compiler}); install one, such as Debian's package gcc")
    with TemporaryFolder() as folder, as_file(files(__name__)) as sources:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        for name in ("contact", "board"):
            _compile(program, sources / f"{name}.c", folder / f"{name}.so")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        first_line = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.partition("\n")[0]
        contact, board = (ctypes.CDLL(str(folder / f"{name}.so")) for name in ("contact", "board"))
        version = ctypes.create_string_buffer(80)
        contact.SUNDIALSGetVersion(version, 80)
        yield CvodeLibrary(
            contact, board, version.value.decode(), first_line,
            after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
        )  # fmt: skip


def _compile(program: str, source: Path, target: Path) -> None:
    done: Any = None
    for libraries in (_LIBRARIES, (*_LIBRARIES, _CORE)):
        done = subprocess.run(
            [program, *_FLAGS, "-Wl,--no-undefined", "-o", str(target), str(source), *libraries, "-lm"],
            capture_output=True, text=True,
        )  # fmt: skip
        if done.returncode == 0:
            return
    lines = [line for line in done.stderr.splitlines() if "error" in line or "cannot find" in line]
    reason = " ".join((lines or ["the compiler failed"])[0].split())[:160]
    raise CvodeMissingError(f"{source.name} does not compile ({reason}); install SUNDIALS 6, Debian's libsundials-dev")


def _pointer(values: Array) -> Any:
    """Pointer to a contiguous array of doubles."""
    if values.dtype != np.float64 or not values.flags.c_contiguous:
        raise TypeError("CVODE takes contiguous arrays of doubles")
    return values.ctypes


def _raise_if(failed: int) -> None:
    if failed:
        raise CvodeFailedError(f"CVODE's error {failed}")
