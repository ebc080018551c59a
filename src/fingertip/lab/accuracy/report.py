"""Text and data of what `fingertip.lab.accuracy.measure` measures."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from fingertip.lab.accuracy.extremes import FAMILIES, FamilyResult
from fingertip.lab.accuracy.measure import REFERENCE, Accuracy

SIGNALS = {"force_n": "force [N]", "tactile_v": "tactile voltage [V]", "envelope_v": "envelope [V]"}
FILES = "accuracy.txt", "accuracy.json"
EXTREMES = "family", "against: bound", "tried", "held", "refused", "of inside", "wrong", "worst", "its case", "CPU"
"""Header of the table of extreme cases; "of inside" is the share of those inside the bounds that is refused."""


def as_files(found: Accuracy) -> dict[str, bytes]:
    """Return file name -> content."""
    text = "\n".join([as_text(found), "", *(line for one in found.extremes for line in _describe_cases(one))])
    data = json.dumps(as_data(found), indent=1, allow_nan=False)
    return dict(zip(FILES, (f"{text}\n".encode(), f"{data}\n".encode()), strict=True))


def as_text(found: Accuracy) -> str:
    wrong = [line for one in found.extremes for line in _describe_cases(one) if line.startswith("WRONG")]
    lines = [
        f"{found.design.name}: largest errors of a trial and of a grasp, against steps / {REFERENCE}",
        *as_table(("run", "step [us]", *map(SIGNALS.get, found.steps[0].errors), "CPU [s]", "x real time"),
                ([one.run, f"{1e6 * one.step_s:g}", *map("{:.1e}".format, one.errors.values()), f"{one.cpu_s:.2f}",
                  f"{one.real_time_ratio:.0f}"] for one in found.steps)),
        "",
        f"extreme cases: {f'{len(wrong)} are WRONG' if wrong else 'none is wrong'}",
        *as_table(EXTREMES, map(_count_outcomes, found.extremes)),
        *wrong,
    ]  # fmt: skip
    return "\n".join(lines)


def _count_outcomes(one: FamilyResult) -> list[object]:
    held = [case for case in one.cases if case.is_held]
    worst = max(held, key=lambda case: case.deviation, default=one.cases[0])
    counts = len(one.cases), len(held), len(one.refused), f"{one.refused_inside:.1%}", len(one.wrong)
    cpu_s = sum(case.cpu_s for case in one.cases)
    return [one.name, FAMILIES[one.name][0], *counts, f"{worst.deviation:.2g}", worst.draw.number, f"{cpu_s:.0f} s"]


def _describe_cases(one: FamilyResult) -> Iterator[str]:
    """Yield why cases were refused, and those that are wrong."""
    for reason, count in sorted(Counter(case.refused_by for case in one.refused).items()):
        yield f"{one.name}: {count} refused by {reason}"
    for case in one.wrong:
        yield f"WRONG {one.name}, case {case.draw.number}: {case.deviation:.3g} of the bound; {case.draw.describe()}"


def as_data(found: Accuracy) -> dict[str, Any]:
    extremes = {one.name: dict(zip(EXTREMES[1:], _count_outcomes(one)[1:], strict=True)) for one in found.extremes}
    return {"design": found.design.name, "steps": [asdict(one) for one in found.steps], "extremes": extremes}


def as_table(header: Sequence[object], rows: Iterable[Sequence[object]]) -> list[str]:
    return [f"| {' | '.join(map(str, row))} |" for row in (header, ["---"] * len(header), *rows)]
