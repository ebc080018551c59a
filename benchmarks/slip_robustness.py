"""Detectors on the wider mix: slips, what a hand and its controller do, unstated noise, bursts nobody simulated.

    python benchmarks/slip_robustness.py [--design article] [--detector fast] [--seeds 5500000 6500000] [--trials 240]

All seeds are held out: no detector was trained or tuned on them. The design `article` has the article's bridge and
converter (4.41 V open, 0.4 mV of noise, 16 bits of plus and minus 10 V), to which the project's limits refer. The
default design `fsr400` is read by a 12-bit converter of 3.3 V, with the board's filtered signal beside the voltage.
"""

from __future__ import annotations

import argparse

from fingertip.design import Design
from fingertip.lab.campaign.plan import HELD_OUT_FROM
from fingertip.lab.wider_mix.mix import MixSize, MixSummary, generate_mix, run_detector, summarise
from fingertip.lab.wider_mix.scenes import NOISES

WORST_GOAL_S = 0.045
"""Goal for the longest delay from gross slip [s]."""
SEEDS = tuple(HELD_OUT_FROM + 1_000_000 * i + 500_000 for i in range(8))


def main() -> None:
    """Print one line for each kind of signal."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--design", default="article", help="design file or bundled name")
    parser.add_argument("--detector", default="fast")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--trials", type=int, default=MixSize.trials)
    parser.add_argument("--minutes", type=float, default=MixSize.minutes)
    parser.add_argument("--events", type=int, default=MixSize.events)
    parser.add_argument("--noisy", type=int, default=MixSize.noisy)
    arguments = parser.parse_args()
    size = MixSize(arguments.trials, arguments.minutes, arguments.events, arguments.noisy)
    design = Design.load(arguments.design)
    outcomes = [
        outcome
        for seed in arguments.seeds
        for outcome in run_detector(arguments.detector, design, generate_mix(design, size, seed))
    ]
    for kind, summary in summarise(outcomes).items():
        print(f"{kind:32} {describe(kind, summary)}")


def describe(kind: str, summary: MixSummary) -> str:
    """Describe the outcomes of one kind: what its limits apply to."""
    parts = []
    if summary.slides:
        parts.append(
            f"found {100 * summary.found_share:5.1f} % of {summary.slides:4}; "
            f"median {1000 * summary.delay_s(0.5):.1f}, "
            f"p90 {1000 * summary.delay_s(0.9):.1f} / {1000 * summary.motion_delay_s(0.9):.1f}, "
            f"worst {1000 * summary.worst_s:.1f} ms, {summary.count_later_than(WORST_GOAL_S)} above "
            f"{1000 * WORST_GOAL_S:g} ms"
        )
    if kind.startswith("burst"):
        parts.append("medians " + " ".join(f"{1000 * m:.1f}" for m in summary.median_by_strength_s()) + " ms")
    if kind == "long slide":
        shares = [share for outcome in summary.outcomes for share in outcome.on_shares]
        parts.append(f"ON {sum(shares) / len(shares):.4f}, at least {summary.on_share:.3f}")
    if summary.events:
        parts.append(f"{100 * summary.disturbed_share:.1f} % of {summary.events} events")
    alarms = f"{summary.alarms} alarms in {summary.minutes:.1f} min"
    if summary.alarms:
        alarms += f", {summary.alarms_per_minute:.2f}"
    parts.append(f"{alarms}, at most {summary.most_alarms_per_minute:.3f} / min")
    if kind in NOISES or kind == "vibration with the grasp":
        silent = sum(outcome.false_on_share for outcome in summary.outcomes) / len(summary.outcomes)
        parts.append(f"ON without slip {100 * silent:.2f} %")
    return "; ".join(parts)


if __name__ == "__main__":
    main()
