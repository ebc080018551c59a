"""Text and data of the errors and extreme cases of `fingertip
accuracy`, and of its budget of errors.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any, TypeAlias

from fingertip.lab.accuracy.budget import KINDS, MODEL_ERRORS, Curve
from fingertip.lab.accuracy.extremes import FAMILIES, FamilyResult
from fingertip.lab.accuracy.measure import REFERENCE, Accuracy
from fingertip.lab.report.results import to_number

SIGNALS = {"force_n": "force [N]", "tactile_v": "tactile voltage [V]", "envelope_v": "envelope [V]"}
FILES = "accuracy.txt", "accuracy.json"
EXTREMES = (
    "family",
    "against: bound",
    "tried",
    "held",
    "refused",
    "of inside",
    "wrong",
    "worst",
    "its case",
    "CPU",
)
"""Header of the table of extreme cases; "of inside" is the share of
those inside the bounds that is refused.
"""
Groups: TypeAlias = Mapping[str, str]
"""Output of sweeps -> its group."""
BUDGET = (
    "output",
    "value",
    "with",
    "settings (* in use)",
    "error at each",
    "CPU [s] at each",
    "95 % in use",
    "model",
)


def as_files(found: Accuracy) -> dict[str, bytes]:
    """Return file name -> content."""
    text = "\n".join(
        [as_text(found), "", *(line for one in found.extremes for line in _describe_cases(one))]
    )
    data = json.dumps(as_data(found), indent=1, allow_nan=False)
    return dict(zip(FILES, (f"{text}\n".encode(), f"{data}\n".encode()), strict=True))


def as_text(found: Accuracy) -> str:
    wrong = [
        line for one in found.extremes for line in _describe_cases(one) if line.startswith("WRONG")
    ]
    lines = [
        f"{found.design.name}: largest errors of a trial and of a grasp, against steps / "
        f"{REFERENCE}",
        *as_table(
            (
                "run",
                "step [us]",
                *map(SIGNALS.get, found.steps[0].errors),
                "CPU [s]",
                "x real time",
            ),
            (
                [
                    one.run,
                    f"{1e6 * one.step_s:g}",
                    *map("{:.1e}".format, one.errors.values()),
                    f"{one.cpu_s:.2f}",
                    f"{one.real_time_ratio:.0f}",
                ]
                for one in found.steps
            ),
        ),
        "",
        f"extreme cases: {f'{len(wrong)} are WRONG' if wrong else 'none is wrong'}",
        *as_table(EXTREMES, map(_count_outcomes, found.extremes)),
        *wrong,
    ]
    return "\n".join(lines)


def _count_outcomes(one: FamilyResult) -> list[object]:
    held = [case for case in one.cases if case.is_held]
    worst = max(held, key=lambda case: case.deviation, default=one.cases[0])
    counts = (
        len(one.cases),
        len(held),
        len(one.refused),
        f"{one.refused_inside:.1%}",
        len(one.wrong),
    )
    cpu_s = sum(case.cpu_s for case in one.cases)

    return [
        one.name,
        FAMILIES[one.name][0],
        *counts,
        f"{worst.deviation:.2g}",
        worst.draw.number,
        f"{cpu_s:.0f} s",
    ]


def _describe_cases(one: FamilyResult) -> Iterator[str]:
    """Yield why cases were refused, and those that are wrong."""
    for reason, count in sorted(Counter(case.refused_by for case in one.refused).items()):
        yield f"{one.name}: {count} refused by {reason}"

    for case in one.wrong:
        yield (
            f"WRONG {one.name}, case {case.draw.number}: {case.deviation:.3g} of the bound; "
            f"{case.draw.describe()}"
        )


def as_data(found: Accuracy) -> dict[str, Any]:
    extremes = {
        one.name: dict(zip(EXTREMES[1:], _count_outcomes(one)[1:], strict=True))
        for one in found.extremes
    }
    return {
        "design": found.design.name,
        "steps": [asdict(one) for one in found.steps],
        "extremes": extremes,
    }


def as_table(header: Sequence[object], rows: Iterable[Sequence[object]]) -> list[str]:
    return [f"| {' | '.join(map(str, row))} |" for row in (header, ["---"] * len(header), *rows)]


def budget_data(name: str, curves: Sequence[Curve], groups: Groups) -> dict[str, Any]:
    found = []
    for curve in curves:
        errors = {output: [*map(to_number, each)] for output, each in curve.errors.items()}
        spans = {
            output: [[*map(to_number, span)] for span in each]
            for output, each in curve.intervals.items()
        }
        values = {output: to_number(value) for output, value in curve.values.items()}
        found.append(asdict(curve) | {"values": values, "errors": errors, "intervals": spans})

    return {
        "design": name,
        "model_errors": MODEL_ERRORS,
        "kinds": list_kinds(curves, groups),
        "curves": found,
    }


def budget_text(name: str, curves: Sequence[Curve], groups: Groups) -> str:
    """Return one table, a line for each output and what it is
    computed with, and the kinds of all other outputs.
    """
    kinds = list_kinds(curves, groups).items()
    return "\n".join(
        [
            f"{name}: errors of named outputs at three settings; of samples, half of the 95 % "
            "interval",
            *as_table(BUDGET, (row for curve in curves for row in _list_curve(curve))),
            "All other outputs of sweeps:",
            *(f"- {kind}: {', '.join(names)}" for kind, names in kinds if names),
        ]
    )


def _list_curve(curve: Curve) -> Iterator[list[object]]:
    settings = " / ".join(
        f"{s:g}{'*' if i == curve.used else ''}" for i, s in enumerate(curve.settings)
    )
    cpu_s = " / ".join(f"{one:.2g}" for one in curve.cpu_s)
    for output, errors in curve.errors.items():
        low, high = (
            curve.intervals[output][curve.used]
            if output in curve.intervals
            else (math.nan, math.nan)
        )
        yield [
            output,
            f"{curve.values[output]:.4g}",
            curve.source,
            settings,
            " / ".join(f"{error:.1e}" if error else "0" for error in errors),
            cpu_s,
            "-" if math.isnan(low) else f"{low:.4g} to {high:.4g}",
            MODEL_ERRORS.get(output, "-"),
        ]


def list_kinds(curves: Sequence[Curve], groups: Groups) -> dict[str, list[str]]:
    """List the outputs of sweeps that no curve holds, by kind."""
    held = {name for curve in curves for name in curve.errors}
    kinds = {name: kind for kind, names in KINDS.items() for name in names}
    found: dict[str, list[str]] = {kind: [] for kind in KINDS}

    for name, group in groups.items():
        if name not in held:
            found[kinds.get(name) or kinds[group]].append(name)

    return found
