"""Detector `fast` on signals that were drawn apart from it: every kind at both operating points.

    python -m benchmarks.slip_held_out [--boards S A] [--share 1.0] [--seed 1] [--report FILE.md]
        [--json]

`benchmarks/held_out_signals.py` draws the signals, from published work and from assumptions,
without knowledge of the detector and its training. They were frozen before any detector had run on
them (`HASH`): a change of them is another judge. Board S is the default, with the filtered signal;
A is the article's; D is a divider, which is given the tactile voltage of S alone. The rules are
those of `benchmarks.slip.scores`. Brackets hold 95 % intervals.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks import held_out_signals
from benchmarks.slip.own_sets import Generated
from benchmarks.slip.recordings import Recording
from benchmarks.slip.scores import Tally, share_interval
from benchmarks.slip_robustness import run_both_points
from fingertip.design import Design
from fingertip.foundation.jit import compiled

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
    options = parser.parse_args()
    present = hashlib.sha256(Path(held_out_signals.__file__).read_bytes()).hexdigest()
    if present != HASH:
        message = f"The generators are not those that judged the fit: their hash is {present}."
        print(message, file=sys.stderr)

    lines = ["| signal | board | point | slips found | median, p90, ms | ON | alarms |"]
    lines.append("| --- " * 7 + "|")
    data: dict[str, Any] = {}
    for row in options.rows:
        for board in options.boards:
            found = run_both_points(draw(row, board, options.seed, options.share))
            data.setdefault(row, {})[board] = {p: tally.as_data() for p, tally in found.items()}
            new = [describe(row, board, point, tally) for point, tally in found.items()]
            lines += new
            if not options.json:
                print(*new, sep="\n", flush=True)

    if options.json:
        print(json.dumps(data, indent=1, allow_nan=False))
    if options.report:
        options.report.write_text("\n".join(lines) + "\n", encoding="utf-8")


def draw(row: str, board: str, seed: int, share: float) -> Iterator[Recording]:
    """Draw the recordings of one kind."""
    design = DESIGNS[board]
    with compiled():
        for one in Generated(row, "S" if board == "D" else board, seed, share).read():
            signal = replace(one.signal, filtered_v=None) if board == "D" else one.signal
            yield replace(one, signal=signal, design=design)


def describe(row: str, board: str, point: str, tally: Tally) -> str:
    """Describe what was found in one kind as a row of a table."""
    found = delays = on = ""
    if tally.slips:
        count = len(tally.delays_s)
        found = f"{count} of {tally.slips} {_write_interval(count, tally.slips)}"
        late_ms = [tally.quantile_ms(fraction) for fraction in (0.5, 0.9)]
        delays = ", ".join(f"{d:.1f}" if math.isfinite(d) else "-" for d in late_ms)
        on = f"{tally.on_share:.3f}, least {min(tally.on_shares):.2f}"

    low, high = tally.alarm_interval
    alarms = f"{tally.counted} in {tally.minutes:.0f} min [{low:.2g}, {high:.2g}]/min"
    if tally.events:
        interval = _write_interval(tally.taken, tally.events)
        alarms += f"; {tally.taken} of {tally.events} events {interval}"

    return f"| {row} | {board} | {point} | {found} | {delays} | {on} | {alarms} |"


def _write_interval(count: int, total: int) -> str:
    low, high = share_interval(count, total)
    return f"[{100 * low:.1f}, {100 * high:.1f}] %"


if __name__ == "__main__":
    main()
