"""Text and data of `fingertip accuracy`: errors, extreme cases, and budget of errors."""

from __future__ import annotations

import itertools
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any, TypeAlias

from fingertip.lab.accuracy.budget import KINDS, MODEL_ERRORS, Curve
from fingertip.lab.accuracy.extremes import FAMILIES, FamilyResult
from fingertip.lab.accuracy.measure import REFERENCE, Accuracy, StepError
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
"""Header of the table of extreme cases.

"of inside" is the refused share of the cases inside the bounds.
"""
Groups: TypeAlias = Mapping[str, str]
"""Output of sweeps -> its group."""
_BUDGET = (
    "output",
    "value",
    "with",
    "settings (* in use)",
    "error at each",
    "CPU [s] at each",
    "95 % in use",
    "model",
)


def as_files(accuracy: Accuracy) -> dict[str, bytes]:
    """Return file name -> content."""
    lines = [as_text(accuracy), ""]
    for family in accuracy.extremes:
        lines += _list_refusals(family)
        lines += _list_wrong_cases(family)

    data = json.dumps(as_data(accuracy), indent=1, allow_nan=False)
    text = "\n".join(lines)
    return dict(zip(FILES, (f"{text}\n".encode(), f"{data}\n".encode()), strict=True))


def as_text(accuracy: Accuracy) -> str:
    """Return the table of errors by time step, and that of extreme cases."""
    wrong = list(itertools.chain.from_iterable(map(_list_wrong_cases, accuracy.extremes)))
    verdict = f"{len(wrong)} are WRONG" if wrong else "none is wrong"
    signals = map(SIGNALS.get, accuracy.steps[0].errors)
    header = ("run", "step [us]", *signals, "CPU [s]", "x real time")

    return "\n".join(
        [
            f"{accuracy.design.name}: largest errors of a trial and of a grasp, against steps / "
            f"{REFERENCE}",
            *_as_table(header, map(_list_step_error, accuracy.steps)),
            "",
            f"extreme cases: {verdict}",
            *_as_table(EXTREMES, map(_count_outcomes, accuracy.extremes)),
            *wrong,
        ]
    )


def _list_step_error(step: StepError) -> list[object]:
    """Return the cells of one time step."""
    return [
        step.run,
        f"{1e6 * step.step_s:g}",
        *map("{:.1e}".format, step.errors.values()),
        f"{step.cpu_s:.2f}",
        f"{step.real_time_ratio:.0f}",
    ]


def _count_outcomes(family: FamilyResult) -> list[object]:
    """Return the cells of one family of extreme cases."""
    within_bound = [case for case in family.cases if case.is_held]
    worst = max(within_bound, key=lambda case: case.deviation, default=family.cases[0])
    cpu_s = sum(case.cpu_s for case in family.cases)

    return [
        family.name,
        FAMILIES[family.name][0],
        len(family.cases),
        len(within_bound),
        len(family.refused),
        f"{family.refused_inside:.1%}",
        len(family.wrong),
        f"{worst.deviation:.2g}",
        worst.draw.number,
        f"{cpu_s:.0f} s",
    ]


def _list_refusals(family: FamilyResult) -> Iterator[str]:
    """Yield why cases were refused, and how many."""
    for reason, count in sorted(Counter(case.refused_by for case in family.refused).items()):
        yield f"{family.name}: {count} refused by {reason}"


def _list_wrong_cases(family: FamilyResult) -> Iterator[str]:
    for case in family.wrong:
        yield (
            f"WRONG {family.name}, case {case.draw.number}: {case.deviation:.3g} of the bound; "
            f"{case.draw.describe()}"
        )


def as_data(accuracy: Accuracy) -> dict[str, Any]:
    """Return the content of accuracy.json."""
    extremes = {
        family.name: dict(zip(EXTREMES[1:], _count_outcomes(family)[1:], strict=True))
        for family in accuracy.extremes
    }
    return {
        "design": accuracy.design.name,
        "steps": [asdict(step) for step in accuracy.steps],
        "extremes": extremes,
    }


def _as_table(header: Sequence[object], rows: Iterable[Sequence[object]]) -> list[str]:
    """Return the lines of a table in Markdown."""
    return [f"| {' | '.join(map(str, row))} |" for row in (header, ["---"] * len(header), *rows)]


def budget_data(name: str, curves: Sequence[Curve], groups: Groups) -> dict[str, Any]:
    """Return the budget of a design, a name, for JSON."""
    return {
        "design": name,
        "model_errors": MODEL_ERRORS,
        "kinds": list_kinds(curves, groups),
        "curves": [_curve_data(curve) for curve in curves],
    }


def _curve_data(curve: Curve) -> dict[str, Any]:
    values = {output: to_number(value) for output, value in curve.values.items()}
    errors = {output: [*map(to_number, by_setting)] for output, by_setting in curve.errors.items()}
    intervals = {
        output: [[*map(to_number, interval)] for interval in by_setting]
        for output, by_setting in curve.intervals.items()
    }
    return asdict(curve) | {"values": values, "errors": errors, "intervals": intervals}


def budget_text(name: str, curves: Sequence[Curve], groups: Groups) -> str:
    """Return a table with a line for each output of a curve, and the kinds of all other outputs."""
    rows = itertools.chain.from_iterable(map(_list_curve, curves))
    kinds = list_kinds(curves, groups).items()
    return "\n".join(
        [
            f"{name}: errors of named outputs at three settings; of samples, half of the 95 % "
            "interval",
            *_as_table(_BUDGET, rows),
            "All other outputs of sweeps:",
            *(f"- {kind}: {', '.join(names)}" for kind, names in kinds if names),
        ]
    )


def _list_curve(curve: Curve) -> Iterator[list[object]]:
    """Yield the cells of each output of a curve."""
    settings = " / ".join(
        f"{setting:g}{'*' if i == curve.used else ''}" for i, setting in enumerate(curve.settings)
    )
    cpu_s = " / ".join(f"{seconds:.2g}" for seconds in curve.cpu_s)

    for output, errors in curve.errors.items():
        interval = "-"
        if output in curve.intervals:
            low, high = curve.intervals[output][curve.used]
            interval = "-" if math.isnan(low) else f"{low:.4g} to {high:.4g}"

        yield [
            output,
            f"{curve.values[output]:.4g}",
            curve.source,
            settings,
            " / ".join(f"{error:.1e}" if error else "0" for error in errors),
            cpu_s,
            interval,
            MODEL_ERRORS.get(output, "-"),
        ]


def list_kinds(curves: Sequence[Curve], groups: Groups) -> dict[str, list[str]]:
    """List the outputs of sweeps that no curve names, by kind."""
    named = set().union(*(curve.errors for curve in curves))
    kinds = {name: kind for kind, names in KINDS.items() for name in names}
    names_by_kind: dict[str, list[str]] = {kind: [] for kind in KINDS}

    for name, group in groups.items():
        if name not in named:
            names_by_kind[kinds.get(name) or kinds[group]].append(name)

    return names_by_kind
