"""Text and data of the budget of errors that `fingertip.lab.accuracy.budget` measures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any, TypeAlias

from fingertip.lab.accuracy.budget import KINDS, MODEL_ERRORS, Curve
from fingertip.lab.accuracy.report import as_table
from fingertip.lab.report.results import to_number

Groups: TypeAlias = Mapping[str, str]
"""Output of sweeps -> its group."""
HEADER = "output", "value", "with", "settings (* in use)", "error at each", "CPU [s] at each", "95 % in use", "model"


def as_data(name: str, curves: Sequence[Curve], groups: Groups) -> dict[str, Any]:
    found = []
    for curve in curves:
        errors = {output: [*map(to_number, each)] for output, each in curve.errors.items()}
        spans = {output: [[*map(to_number, span)] for span in each] for output, each in curve.intervals.items()}
        values = {output: to_number(value) for output, value in curve.values.items()}
        found.append(asdict(curve) | {"values": values, "errors": errors, "intervals": spans})
    return {"design": name, "model_errors": MODEL_ERRORS, "kinds": list_kinds(curves, groups), "curves": found}


def as_text(name: str, curves: Sequence[Curve], groups: Groups) -> str:
    """Return one table, a line for each output and what it is computed with, and the kinds of all other outputs."""
    kinds = list_kinds(curves, groups).items()
    return "\n".join([
        f"{name}: errors of named outputs at three settings; of samples, half of the 95 % interval",
        *as_table(HEADER, (row for curve in curves for row in _list_rows(curve))),
        "All other outputs of sweeps:",
        *(f"- {kind}: {', '.join(names)}" for kind, names in kinds if names),
    ])  # fmt: skip


def _list_rows(curve: Curve) -> Iterator[list[object]]:
    settings = " / ".join(f"{s:g}{'*' if i == curve.used else ''}" for i, s in enumerate(curve.settings))
    cpu_s = " / ".join(f"{one:.2g}" for one in curve.cpu_s)
    for output, errors in curve.errors.items():
        low, high = curve.intervals[output][curve.used] if output in curve.intervals else (math.nan, math.nan)
        yield [
            output, f"{curve.values[output]:.4g}", curve.source, settings,
            " / ".join(f"{error:.1e}" if error else "0" for error in errors), cpu_s,
            "-" if math.isnan(low) else f"{low:.4g} to {high:.4g}", MODEL_ERRORS.get(output, "-"),
        ]  # fmt: skip


def list_kinds(curves: Sequence[Curve], groups: Groups) -> dict[str, list[str]]:
    """List the outputs of sweeps that no curve holds, by kind."""
    held = {name for curve in curves for name in curve.errors}
    kinds = {name: kind for kind, names in KINDS.items() for name in names}
    found: dict[str, list[str]] = {kind: [] for kind in KINDS}
    for name, group in groups.items():
        if name not in held:
            found[kinds.get(name) or kinds[group]].append(name)
    return found
