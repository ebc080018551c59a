"""Runs the families of extreme cases, and writes what was found as a table."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

from benchmarks.extremes import board, bodies, contact
from benchmarks.extremes.draw import Draw, Family, Range
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.jit import compiled
from fingertip.foundation.progress import ReportProgress, Work

FAMILIES = (
    Family("contact, fixed steps", "steps / 16, 10 % of the forces", 0.6, lambda draw: contact.fixed_steps(draw)),
    Family("contact, error control", "tolerance / 100, 100 tolerances", 0.25, lambda draw: contact.error_control(draw)),
    Family("board", "tolerance / 10000, 10 tolerances + 5 % of the peak", 0.1, lambda draw: board.board(draw)),
    Family("filling", "mass, and a closed form, 1e-6", 0.02, lambda draw: bodies.filling(draw)),
    Family("geometry", "all checks of the parts", 0.001, lambda draw: bodies.geometry(draw)),
    Family("pad", "scaling, monotony, inverse, 1e-3", 0.009, lambda draw: bodies.pad(draw)),
    Family("play of the bone", "scipy's HiGHS, 1e-6", 0.02, lambda draw: bodies.play(draw)),
)
MAX_REFUSED = 0.02
"""Largest share of the cases inside the documented bounds that may be refused."""
HEADER = (
    "| family | against | tried | held | refused | inside bounds refused | wrong | worst / bound | its case | CPU |"
)
BEGIN, END = "<!-- extremes: begin -->", "<!-- extremes: end -->"
"""Lines between which `--report` replaces the table of an existing file."""


@dataclass
class Count:
    """What became of the cases of one family."""

    family: Family
    tried: int = 0
    held: int = 0
    refused: int = 0
    inside: int = 0
    inside_refused: int = 0
    wrong: list[str] = field(default_factory=list)
    worst: float = 0.0
    worst_case: int = 0
    worst_values: str = ""
    reasons: dict[str, int] = field(default_factory=dict)
    ranges: dict[str, tuple[Range, Range]] = field(default_factory=dict)
    cpu_s: float = 0.0

    def try_case(self, number: int) -> None:
        draw, begin = Draw(self.family.name, number), time.process_time()
        try:
            deviation: float | None = self.family.deviate(draw)
        except FingertipError as error:
            deviation = None
            reason = error.issues[0].field
            self.reasons[reason] = self.reasons.get(reason, 0) + 1
        except Exception as error:  # noqa: BLE001
            deviation = float("nan")
            draw.values["raised"] = repr(error)
        self.cpu_s += time.process_time() - begin
        self.tried += 1
        self.inside += draw.is_inside
        self.ranges |= draw.ranges
        if deviation is None:
            self.refused += 1
            self.inside_refused += draw.is_inside
        elif not deviation <= 1.0:
            self.wrong.append(f"{self.family.name}, case {number}: {deviation:.3g} of the bound; {draw.describe()}")
        else:
            self.held += 1
            if deviation >= self.worst:
                self.worst, self.worst_case, self.worst_values = deviation, number, draw.describe()

    @property
    def inside_share(self) -> float:
        return self.inside_refused / max(self.inside, 1)


def run(cases: int, progress: ReportProgress | None) -> list[Count]:
    """Try so many cases of all families together, at least two of each."""
    counts = [Count(family) for family in FAMILIES]
    sizes = [max(2, round(cases * family.weight)) for family in FAMILIES]
    # All families advance together, so that the time left is a fair estimate.
    plan = sorted((number / size, i, number) for i, size in enumerate(sizes) for number in range(size))
    work = Work("bench extremes", {"cases": 1.0}, progress)
    work.begin("cases")
    with compiled():
        for done, (_, i, number) in enumerate(plan):
            counts[i].try_case(number)
            work.advance((done + 1) / len(plan))
    return counts


def is_passed(counts: list[Count]) -> bool:
    return not any(count.wrong or count.inside_share > MAX_REFUSED for count in counts)


def as_markdown(counts: list[Count]) -> str:
    lines = [HEADER, "| " + " | ".join(["---"] * (HEADER.count("|") - 1)) + " |"]
    for c in counts:
        lines.append(
            f"| {c.family.name} | {c.family.against} | {c.tried} | {c.held} | {c.refused} | {c.inside_share:.1%} | "
            f"{len(c.wrong)} | {c.worst:.2g} | {c.worst_case} | {c.cpu_s:.0f} s |"
        )
    lines += ["", "| family | quantity | inside the bounds | beyond |", "| --- | --- | --- | --- |"]
    for c in counts:
        for name, (inside, beyond) in c.ranges.items():
            spans = (f"{low:.4g}" if high < 1.001 * low else f"{low:g} to {high:g}" for low, high in (inside, beyond))
            lines.append(f"| {c.family.name} | {name} | {' | '.join(spans)} |")
    return "\n".join(lines)


def as_text(counts: list[Count]) -> str:
    """Return the table, then every wrong case and the reasons of refusals."""
    wrong = [line for count in counts for line in count.wrong]
    reasons = [f"{c.family.name} refused by {reason}: {n}" for c in counts for reason, n in sorted(c.reasons.items())]
    worst = [f"{c.family.name}, worst held case {c.worst_case}: {c.worst_values}" for c in counts]
    return "\n".join([as_markdown(counts), "", *worst, *reasons, *(f"WRONG {line}" for line in wrong)])


def as_data(counts: list[Count]) -> dict[str, Any]:
    return {
        c.family.name: {key: value for key, value in asdict(c).items() if key != "family"}
        | {"against": c.family.against}
        for c in counts
    }


def replace_table(text: str, table: str) -> str:
    """Replace what stands between the marks of a file; a text without marks becomes the table alone."""
    block = f"{BEGIN}\n{table}\n{END}"
    if BEGIN not in text or END not in text:
        return block + "\n"
    return text[: text.index(BEGIN)] + block + text[text.index(END) + len(END) :]
