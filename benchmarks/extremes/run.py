"""Runs the families of extreme cases, and writes what was found as a table."""

from __future__ import annotations

import json
import math
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.extremes import board, bodies, contact, grasp
from benchmarks.extremes.draw import Draw, Family, Range
from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.foundation.workers import call_each

FAMILIES = (
    Family("contact, fixed steps", "steps / 16: 10 % of the forces (beyond: 25 %)", 0.57, contact.fixed_steps),
    Family(
        "contact, error control",
        "tolerance / 100: 100 tolerances (bouncing: 10 % of the load)",
        0.25,
        contact.error_control,
    ),
    Family("object in a hand", "parts / 16: 10 % of the forces (beyond: 25 %)", 0.03, grasp.grasp),
    Family("board", "tolerance / 10000: 10 tolerances and 5 % of the peak", 0.1, board.board),
    Family("geometry", "all checks of the parts", 0.0003, bodies.geometry),
    Family("pad", "scaling, monotony, inverse: 5e-3", 0.009, bodies.pad),
)
FILES = "extremes.txt", "extremes.json"
MAX_BLOCK = 8
"""Largest number of cases that one process tries in a row."""
MAX_REFUSED = 0.02
"""Largest share of the cases inside the documented bounds that may be refused."""
HEADER = "| family | against: bound | tried | held | refused | of inside | wrong | worst | its case | CPU |"
BEGIN, END = "<!-- extremes: begin -->", "<!-- extremes: end -->"
"""Lines between which `--report` replaces the table of an existing file."""


@dataclass(frozen=True)
class Case:
    draw: Draw
    deviation: float
    """Largest deviation in relation to the bound; NaN if an exception was raised, or the case refused."""
    refused_by: str
    cpu_s: float


def try_cases(family: int, numbers: Sequence[int]) -> list[Case]:
    """Try some cases of a family, one after the other."""
    cases = []
    for number in numbers:
        draw, begin, deviation, refused_by = Draw(FAMILIES[family].name, number), time.process_time(), math.nan, ""
        try:
            deviation = FAMILIES[family].deviate(draw)
        except FingertipError as error:
            refused_by = error.issues[0].field
        except Exception as error:
            draw.values["raised"] = repr(error)
        cases.append(Case(draw, deviation, refused_by, time.process_time() - begin))
    return cases


@dataclass
class Count:
    family: Family
    tried: int = 0
    inside: int = 0
    inside_refused: int = 0
    wrong: list[str] = field(default_factory=list)
    worst: float = 0.0
    worst_case: int = 0
    worst_values: str = ""
    reasons: Counter[str] = field(default_factory=Counter)
    ranges: dict[str, tuple[Range, Range]] = field(default_factory=dict)
    cpu_s: float = 0.0

    def add(self, case: Case) -> None:
        draw, values = case.draw, case.draw.describe()
        self.cpu_s += case.cpu_s
        self.tried += 1
        self.inside += draw.is_inside
        self.ranges |= draw.ranges
        if case.refused_by:
            self.reasons[case.refused_by] += 1
            self.inside_refused += draw.is_inside
        elif not case.deviation <= 1.0:
            self.wrong.append(f"{draw.family}, case {draw.number}: {case.deviation:.3g} of the bound; {values}")
        elif case.deviation >= self.worst:
            self.worst, self.worst_case, self.worst_values = case.deviation, draw.number, values

    @property
    def inside_share(self) -> float:
        return self.inside_refused / max(self.inside, 1)

    @property
    def outcomes(self) -> tuple[int, int, int]:
        """Numbers of cases held, refused and wrong."""
        refused, wrong = self.reasons.total(), len(self.wrong)
        return self.tried - refused - wrong, refused, wrong


def run(cases: int, progress: ReportProgress | None) -> Found:
    """Try so many cases of all families together, at least two of each, in blocks. Raises MissingLibraryError."""
    extras.require("fingertip bench extremes", "scipy", "numba")
    counts = [Count(family) for family in FAMILIES]
    sizes = [max(2, round(cases * family.weight)) for family in FAMILIES]
    # All families advance together, so that the time left is a fair estimate.
    lengths = [max(1, min(MAX_BLOCK, size // 64)) for size in sizes]
    plan = sorted((at / sizes[i], i, at) for i, length in enumerate(lengths) for at in range(0, sizes[i], length))
    work = Work("bench extremes", {"cases": 1.0}, progress)
    work.begin("cases")
    blocks = (partial(try_cases, i, range(at, min(at + lengths[i], sizes[i]))) for _, i, at in plan)
    for done, ((_, i, _), found) in enumerate(zip(plan, call_each(blocks), strict=True)):
        for case in found:
            counts[i].add(case)
        work.advance((done + 1) / len(plan))
    return Found(tuple(counts))


@dataclass(frozen=True)
class Found:
    counts: tuple[Count, ...]

    @property
    def is_passed(self) -> bool:
        return not any(count.wrong or count.inside_share > MAX_REFUSED for count in self.counts)

    @property
    def table(self) -> str:
        lines = [HEADER, "| " + " | ".join(["---"] * (HEADER.count("|") - 1)) + " |"]
        for c in self.counts:
            held, refused, wrong = c.outcomes
            row = c.family.name, c.family.against, c.tried, held, refused, f"{c.inside_share:.1%}", wrong
            lines.append(f"| {' | '.join(map(str, row))} | {c.worst:.2g} | {c.worst_case} | {c.cpu_s:.0f} s |")
        lines += ["", "| family | inside the documented bounds (beyond) |", "| --- | --- |"]
        for c in self.counts:
            ranges = (f"{name} {_describe(ends[0])} ({_describe(ends[1])})" for name, ends in c.ranges.items())
            lines.append(f"| {c.family.name} | {'; '.join(ranges)} |")
        return "\n".join(lines)

    def as_text(self) -> str:
        lines = [f"{c.family.name}, worst held case {c.worst_case}: {c.worst_values}" for c in self.counts]
        lines += [f"{c.family.name}: {n} refused by {why}" for c in self.counts for why, n in sorted(c.reasons.items())]
        lines += [f"WRONG {line}" for c in self.counts for line in c.wrong]
        return "\n".join([self.table, "", *lines])

    def encode(self) -> list[bytes]:
        """Encode what was found as `FILES`."""
        return [self.as_text().encode(), json.dumps(self.as_data(), indent=1).encode()]

    def as_data(self) -> dict[str, Any]:
        return {c.family.name: {k: v for k, v in vars(c).items() if k != "family"} for c in self.counts}


def _describe(ends: Range) -> str:
    low, high = ends
    return f"{low:.4g}" if high < 1.001 * low else f"{low:g} to {high:g}"


def replace_table(file: Path, found: Found) -> bytes:
    """Return a file's text with the table between its marks, or the table alone where there are none."""
    text = file.read_text("utf-8") if file.is_file() else ""
    block = f"{BEGIN}\n\n{found.table}\n\n{END}"
    before, _, rest = text.partition(BEGIN)
    return (before + block + rest.partition(END)[2] if END in rest else f"{block}\n").encode()
