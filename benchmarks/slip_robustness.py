"""Detectors on the wider mix: slips, what a hand and its controller do, unstated noise, bursts nobody simulated.

    python benchmarks/slip_robustness.py [--detector fast] [--seeds 5000000 6000000 7000000 8000000] [--trials 240]

All seeds are held out: no detector was trained or tuned on them. Each row states the limits of the project; voltages
refer to the article's bridge and converter (4.41 V open, 0.4 mV of noise, 16 bits of plus and minus 10 V).
"""

from __future__ import annotations

import argparse

from fingertip.campaign.plan import HELD_OUT_FROM
from fingertip.campaign.wider_mix.mix import MixSize, MixSummary, generate_mix, run_detector, summarise
from fingertip.campaign.wider_mix.scenes import NOISES
from fingertip.design import Design

SEEDS = tuple(HELD_OUT_FROM + 1_000_000 * i + 500_000 for i in range(4))
ARTICLE = {
    "board": {"variant": "article", "supply": "split"},
    "detector": {"noise_v": 4e-4, "adc_bits": 16, "adc_range_v": 10.0, "adc_polarity": "bipolar"},
}


def main() -> None:
    """Print one line for each kind of signal."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--detector", default="fast")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--trials", type=int, default=MixSize.trials)
    parser.add_argument("--minutes", type=float, default=MixSize.minutes)
    parser.add_argument("--events", type=int, default=MixSize.events)
    parser.add_argument("--noisy", type=int, default=MixSize.noisy)
    arguments = parser.parse_args()
    size = MixSize(arguments.trials, arguments.minutes, arguments.events, arguments.noisy)
    design = Design(**ARTICLE)
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
            f"worst {1000 * summary.worst_s:.1f} ms"
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
