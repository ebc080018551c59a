"""Detector `fast` on signals that were drawn apart from it: every kind at both operating points.

    python -m benchmarks.slip_held_out [--boards S A] [--share 1.0] [--seed 1] [--report FILE.md]
        [--json]

`benchmarks/held_out_signals.py` draws the signals, from published work and from assumptions,
without knowledge of the detector and its training. They were frozen before any detector had run on
them (`HASH`): a change of them is another judge. Board S is the default, with the filtered signal;
A is the article's; D is a divider, which is given the tactile voltage of S alone. Slips count as
found from 5 ms before their onset; an alarm counts from the start of an event until 0.2 s after its
end. Brackets hold 95 % intervals: of a share by Clopper and Pearson, of alarms by Poisson's law, of
a quantile by the order of the delays.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import held_out_signals
from benchmarks.slip.mix import MixSummary
from benchmarks.slip.mix_signals import LabelledSignal, Slide
from benchmarks.slip_robustness import run_both_points
from fingertip.design import Design
from fingertip.foundation.numerics import poisson_interval
from fingertip.slip.traces.truth import Interval

HASH = "9371229ee4c0b150df7c10b6b293174df17830ae7076f6cf56f54430193bb584"
"""SHA-256 of the generators when they judged first."""
DESIGNS = {
    "S": Design.load("fsr400"),
    "A": Design.load("article"),
    "D": Design.load("fsr400", changes=["board.variant=divider"]),
}


def main() -> None:
    """Print one line for each kind of signal, board and operating point."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--boards", nargs="+", default=list(DESIGNS), choices=list(DESIGNS))
    parser.add_argument("--rows", nargs="+", default=list(held_out_signals.ROWS))
    parser.add_argument(
        "--share", type=float, default=1.0, help="share of the recordings of a whole run"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--report", type=Path, help="file for the table, in Markdown")
    parser.add_argument("--json", action="store_true", help="print data in place of lines")
    arguments = parser.parse_args()
    present = hashlib.sha256(Path(held_out_signals.__file__).read_bytes()).hexdigest()

    if present != HASH:
        print(
            f"The generators are not those that judged the fit: their hash is {present}.",
            file=sys.stderr,
        )

    data: dict[str, Any] = {}
    lines = [
        "| signal | board | point | slips found | median, p90, worst, ms | ON | alarms |",
        "| --- " * 7 + "|",
    ]
    for row in arguments.rows:
        for board in arguments.boards:
            count = math.ceil(arguments.share * held_out_signals.default_count(row))
            outcomes = run_both_points(DESIGNS[board], draw(row, board, arguments.seed, count))
            summaries = {point: MixSummary(tuple(found)) for point, found in outcomes.items()}
            data.setdefault(row, {})[board] = {
                point: summary.as_data() for point, summary in summaries.items()
            }
            lines += [describe(row, board, point, summary) for point, summary in summaries.items()]
            if not arguments.json:
                print(*lines[-len(outcomes) :], sep="\n", flush=True)

    if arguments.json:
        print(json.dumps(data, indent=1, allow_nan=False))
    if arguments.report:
        arguments.report.write_text("\n".join(lines) + "\n", encoding="utf-8")


def draw(row: str, board: str, seed: int, count: int) -> Iterator[LabelledSignal]:
    """Draw the recordings of one kind."""
    for recording in held_out_signals.generate(row, "S" if board == "D" else board, seed, count):
        yield LabelledSignal(
            kind=row,
            rate_hz=held_out_signals.RATE_HZ,
            voltage_v=recording.tactile_v,
            slides=tuple(Slide(*slip) for slip in recording.slips),
            events=tuple(Interval(*event) for event in recording.events),
            alarms_from_s=recording.quiet_from_s,
            filtered_v=None if board == "D" else recording.filtered_v,
        )


def describe(row: str, board: str, point: str, summary: MixSummary) -> str:
    """Describe the outcomes of one kind as a row of a table."""
    found = delays = on = ""
    if summary.slides:
        count = sum(len(outcome.delays_s) for outcome in summary.outcomes)
        found = f"{count} of {summary.slides} {share_interval(count, summary.slides)}"
        ranked = sorted(delay for outcome in summary.outcomes for delay in outcome.delays_s)
        ranked += [math.inf] * (summary.slides - len(ranked))
        delays = ", ".join(quantile(ranked, fraction) for fraction in (0.5, 0.9))
        delays += f", {1000 * summary.worst_s:.1f}"
        shares = [share for outcome in summary.outcomes for share in outcome.on_shares]
        on = f"{np.mean(shares):.3f}, least {min(shares):.2f}"

    low, high = (bound / summary.minutes for bound in poisson_interval(summary.alarms))
    alarms = f"{summary.alarms} in {summary.minutes:.0f} min [{low:.2g}, {high:.2g}]/min"
    if summary.events:
        disturbed = sum(outcome.disturbed for outcome in summary.outcomes)
        alarms += (
            f"; {disturbed} of {summary.events} events {share_interval(disturbed, summary.events)}"
        )

    silent = np.mean([outcome.false_on_share for outcome in summary.outcomes])
    return (
        f"| {row} | {board} | {point} | {found} | {delays} | {on} | {alarms}; ON without slip "
        f"{silent:.4f} |"
    )


def quantile(ranked_s: Sequence[float], fraction: float) -> str:
    """Write a quantile of sorted delays with the order statistics
    that hold it in 95 % of all draws [ms].
    """
    count = len(ranked_s)
    spread = 1.96 * math.sqrt(len(ranked_s) * fraction * (1 - fraction))
    places = (fraction * count, fraction * count - spread, fraction * count + spread)
    middle, low, high = (1000 * ranked_s[min(count - 1, max(0, int(place)))] for place in places)

    return f"{middle:.1f} [{low:.1f}, {high:.1f}]"


def share_interval(count: int, total: int) -> str:
    """Write the interval of a share, by Clopper and Pearson [%]."""
    from scipy.stats import beta

    low = float(beta.ppf(0.025, count, total - count + 1)) if count else 0.0
    high = float(beta.ppf(0.975, count + 1, total - count)) if count < total else 1.0

    return f"[{100 * low:.1f}, {100 * high:.1f}] %"


if __name__ == "__main__":
    main()
