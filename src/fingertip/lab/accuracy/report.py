"""Text, data, picture and tables of what `fingertip.lab.accuracy.measure` measures."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from fingertip.foundation import display
from fingertip.lab.accuracy.extremes import FamilyResult, Range
from fingertip.lab.accuracy.measure import REFERENCE, Accuracy, StepError

SIGNALS = {"force_n": "force [N]", "tactile_v": "tactile voltage [V]", "envelope_v": "envelope [V]"}
FILES = "accuracy.txt", "accuracy.json", "accuracy.png", "extremes.md"
EXTREMES = "family", "against: bound", "tried", "held", "refused", "of inside", "wrong", "worst", "its case", "CPU"
"""Header of the table of extreme cases; "of inside" is the share of those inside the bounds that is refused."""


def as_files(found: Accuracy) -> dict[str, bytes]:
    """Return file name -> content. Raises MissingLibraryError."""
    data = json.dumps(as_data(found), indent=1, allow_nan=False) + "\n"
    contents = f"{as_text(found)}\n".encode(), data.encode(), plot_steps(found.steps), _page(found.extremes).encode()
    return dict(zip(FILES, contents, strict=True))


def as_text(found: Accuracy) -> str:
    wrong = sum(len(one.wrong) for one in found.extremes)
    return "\n".join(
        [
            f"{found.design.name}: largest errors of a trial and of a grasp, against steps / {REFERENCE}",
            *_table(
                ("run", "step [us]", *map(SIGNALS.get, found.steps[0].errors), "CPU [s]", "x real time"),
                map(_list_step, found.steps),
            ),
            f"scipy's LSODA integrates the contact at the onset of slip: it differs by {found.scipy_n:.1e} N",
            "",
            "what each stage of the trial contributes:",
            *_table(
                ("stage", "kind", "[N]", "[V]"),
                ((one.stage, one.kind, _short(one.error_n), _short(one.error_v)) for one in found.budget),
            ),
            "",
            f"extreme cases: {f'{wrong} are WRONG' if wrong else 'none is wrong'}",
            *_table(EXTREMES, map(_list_outcomes, found.extremes)),
            *(line for one in found.extremes for line in _describe_cases(one) if line.startswith("WRONG")),
        ]
    )


def _list_step(one: StepError) -> list[str]:
    errors = (f"{error:.1e}" for error in one.errors.values())
    return [one.run, f"{1e6 * one.step_s:g}", *errors, f"{one.cpu_s:.2f}", f"{one.real_time_ratio:.0f}"]


def _list_outcomes(one: FamilyResult) -> list[object]:
    tried, refused, wrong, worst = len(one.cases), len(one.refused), len(one.wrong), one.worst
    counts = tried, tried - refused - wrong, refused, f"{one.refused_inside:.1%}", wrong
    cpu_s = sum(case.cpu_s for case in one.cases)
    return [one.family.name, one.family.against, *counts, f"{worst.deviation:.2g}", worst.draw.number, f"{cpu_s:.0f} s"]


def _describe_cases(one: FamilyResult) -> Iterator[str]:
    """Yield the worst held case, why cases were refused, and those that are wrong."""
    name, worst = one.family.name, one.worst.draw
    yield f"{name}, worst held case {worst.number}: {worst.describe()}"
    for reason, count in sorted(Counter(case.refused_by for case in one.refused).items()):
        yield f"{name}: {count} refused by {reason}"
    for case in one.wrong:
        yield f"WRONG {name}, case {case.draw.number}: {case.deviation:.3g} of the bound; {case.draw.describe()}"


def as_data(found: Accuracy) -> dict[str, Any]:
    return {
        "design": found.design.name,
        "passed": found.is_passed,
        "steps": [asdict(one) for one in found.steps],
        "difference_from_scipy_n": found.scipy_n,
        "budget": [asdict(one) for one in found.budget],
        "extremes": {
            one.family.name: dict(zip(EXTREMES[1:], _list_outcomes(one)[1:], strict=True))
            | {"cases": [*_describe_cases(one)]}
            for one in found.extremes
        },
    }


def _page(extremes: Sequence[FamilyResult]) -> str:
    """Return the tables of docs/accuracy.md: outcomes, and the ranges of what was drawn."""
    ranges = []
    for one in extremes:
        ends = {name: pair for case in one.cases for name, pair in case.draw.ranges.items()}
        texts = (f"{name} {_span(inside)} ({_span(beyond)})" for name, (inside, beyond) in ends.items())
        ranges.append((one.family.name, "; ".join(texts)))
    tables = (
        _table(EXTREMES, map(_list_outcomes, extremes)),
        _table(("family", "inside the documented bounds (beyond)"), ranges),
    )
    return "\n".join([*tables[0], "", *tables[1]]) + "\n"


def _span(ends: Range) -> str:
    low, high = ends
    return f"{low:.4g}" if high < 1.001 * low else f"{low:g} to {high:g}"


def _short(value: float | None) -> str:
    return "-" if value is None else f"{value:.1e}"


def _table(header: Sequence[object], rows: Iterable[Sequence[object]]) -> list[str]:
    return [f"| {' | '.join(map(str, row))} |" for row in (header, ["---"] * len(header), *rows)]


def plot_steps(steps: Sequence[StepError]) -> bytes:
    """Plot each signal's largest error over the CPU time, one point for each step; returns a PNG."""
    names = list(steps[0].errors)
    figure = display.new_figure(4 * len(names), 4)
    for axes, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        for run, colour, marker in zip(dict.fromkeys(one.run for one in steps), display.SERIES, "os", strict=False):
            points = [one for one in steps if one.run == run]
            cpu_ms, errors = [1e3 * one.cpu_s for one in points], [one.errors[name] for one in points]
            axes.loglog(cpu_ms, errors, color=colour, marker=marker, label=run)
            for one, *at in zip(points, cpu_ms, errors, strict=True):
                axes.annotate(f"{1e6 * one.step_s:g} us", at, (4, 4), textcoords="offset points", fontsize=8)
        axes.set(xlabel="CPU time [ms]", ylabel="largest error", title=SIGNALS[name])
        axes.legend(frameon=False, fontsize=8)
        display.style_axes(axes, "both")
    return display.to_png(figure)
