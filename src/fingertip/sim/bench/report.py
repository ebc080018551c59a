"""All measurements of the simulation as one object, and as words."""

from __future__ import annotations

from dataclasses import asdict
from importlib.util import find_spec
from typing import Any

from fingertip.errors import Issue, MissingLibraryError
from fingertip.sim.bench.measure import Diagram


def require() -> None:
    """Raise unless what the measurements compare with is installed.

    Raises
    ------
    MissingLibraryError
        Naming the packages.
    """
    missing = [name for name in ("scipy", "numba") if find_spec(name) is None]
    if missing:
        names = " and ".join(missing)
        raise MissingLibraryError(
            Issue("fingertip bench", f"needs {names}; install with `pip install {' '.join(missing)}`.")
        )


def ratios(diagram: Diagram) -> dict[str, float | None]:
    """CPU time of each other solver over ours, at an error within the target; None where there is no such point."""
    solvers = list(dict.fromkeys(point.solver for point in diagram.points))
    return {solver: diagram.against(solvers[0], solver) for solver in solvers[1:]}


def as_data(diagram: Diagram) -> dict[str, Any]:
    """A diagram for JSON."""
    return asdict(diagram) | {"times_ours": ratios(diagram)}


def as_text(diagram: Diagram) -> list[str]:
    """A diagram for people."""
    unit = diagram.unit
    lines = [f"{diagram.problem}: references agree to {diagram.agreement:.1e} {unit}"]
    lines += [f"  {p.solver:28}{p.setting:28}{p.error:10.1e} {unit}{1e3 * p.cpu_s:12.2f} ms" for p in diagram.points]
    for solver, ratio in ratios(diagram).items():
        said = f"{ratio:.0f} times our CPU time" if ratio else "no point to compare"
        if solver in diagram.goals:
            said += f" (goal {diagram.goals[solver]:g})"
        lines.append(f"  {solver}: {said} at an error of {diagram.target:g} {unit} or less, ours no larger")
    lines.append("  omissions:")
    return lines + [f"    {line}" for line in diagram.omissions]
