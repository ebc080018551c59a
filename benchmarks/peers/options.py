"""Options of `python -m benchmarks.peers`, the libraries that it needs, and its files.

Imports no solver.
"""

from __future__ import annotations

from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue

SOLVE_IVP = ("LSODA", "Radau", "BDF")
"""Methods of scipy's `solve_ivp`."""
PEERS = (*SOLVE_IVP, "odeint", "CVODE", "RADAU5", "RADAU", "Rodas5P", "ngspice")
"""Names of `python -m benchmarks.peers --solvers`."""
FILES = ("work_precision.png", "trial_accuracy.png", "work_precision.json", "work_precision.txt")
"""Files that the command writes."""


def read_options(solvers: str, seconds: float, boards: int) -> tuple[str, ...]:
    """Read names of peers, separated by commas, and check the sizes. Raises FingertipError."""
    names = tuple(dict.fromkeys(name.strip() for name in solvers.split(",") if name.strip()))
    known = ", ".join(PEERS)
    issues = [
        Issue("--solvers", f"{name!r} is not known; choose among {known}.")
        for name in names
        if name not in PEERS
    ]

    if not names:
        issues.append(
            Issue("--solvers", f"{solvers!r} names no solver; give at least one of {known}.")
        )
    if not 1.0 <= seconds <= 60.0:
        issues.append(Issue("--seconds", f"{seconds:g} s is out of bounds; choose 1 to 60 s."))
    if not 1 <= boards <= 1_000_000:
        issues.append(Issue("--boards", f"{boards} is out of bounds; choose 1 to 1000000."))
    if issues:
        raise FingertipError(issues)

    return names


def require_libraries() -> None:
    """Raise unless the libraries that the benchmark compares with and draws with are installed.

    Raises MissingLibraryError.
    """
    extras.require("python -m benchmarks.peers", "scipy", "numba", "matplotlib")
