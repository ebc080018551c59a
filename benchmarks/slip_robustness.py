"""Detectors on the wider mix: slips, what a hand and its controller do, unstated noise, bursts
nobody simulated.

    python benchmarks/slip_robustness.py [--design article] [--detector fast] [--seeds 5500000
        6500000] [--trials 240]

All seeds are held out: no detector was trained or tuned on them. The design `article` has the
article's bridge and converter (4.41 V open, 0.4 mV of noise, 16 bits of plus and minus 10 V), to
which the project's limits refer. The default design `fsr400` is read by a 12-bit converter of 3.3
V, with the board's filtered signal beside the voltage.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from benchmarks.slip.mix import MixSize, MixSummary, Outcome, generate_mix, run_detector, summarise
from benchmarks.slip.mix_signals import NOISES, LabelledSignal, simulate_scene
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.campaign import (
    HELD_OUT_FROM,
    NEGATIVE_SCENES,
    REPORTED_SEPARATELY,
    nominal_duration_s,
)
from fingertip.sim.simulation import article_trials

WORST_GOAL_S = 0.045
"""Goal for the longest delay from gross slip [s]."""
POINTS = {"incipient": "incipient", "on": "fast"}
"""Operating point of the detector `fast` -> detector that is ON at it."""
SLIP = "slip"
"""Kind of the article's trials."""
WITHOUT_SLIP = "without slip: "
"""Begin of the kinds of the campaign's scenes without slip; the cause follows."""
SEEDS = tuple(HELD_OUT_FROM + 1_000_000 * i + 500_000 for i in range(8))


def main() -> None:
    """Print one line for each kind of signal."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--design", default="article", help="design file or bundled name")
    parser.add_argument("--detector", default="fast")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--trials", type=int, default=240)
    parser.add_argument(
        "--minutes", type=float, default=30.0, help="duration of the scenes without slip"
    )
    parser.add_argument("--events", type=int, default=MixSize.events)
    parser.add_argument("--noisy", type=int, default=MixSize.noisy)
    parser.add_argument("--json", action="store_true", help="print data in place of lines")
    arguments = parser.parse_args()
    size = MixSize(arguments.events, arguments.noisy)
    design = Design.load(arguments.design)
    found: dict[str, list[Outcome]] = {}

    for seed in arguments.seeds:
        signals = generate_all(
            design,
            trials=arguments.trials,
            minutes=arguments.minutes,
            size=size,
            first_seed=seed,
        )
        if arguments.detector == "fast":
            judged = run_both_points(design, signals)
        else:
            judged = {"on": run_detector(arguments.detector, design, signals)}

        for point, outcomes in judged.items():
            found.setdefault(point, []).extend(outcomes)

    if arguments.json:
        data = {
            point: {kind: summary.as_data() for kind, summary in pool(outcomes).items()}
            for point, outcomes in found.items()
        }
        print(json.dumps(data, indent=1, allow_nan=False))
        return

    for point, outcomes in found.items():
        print(f"{arguments.design}, {arguments.detector}, {point}")
        for kind, summary in pool(outcomes).items():
            print(f"{kind:32} {describe(kind, summary)}")


def run_both_points(design: Design, signals: Iterable[LabelledSignal]) -> dict[str, list[Outcome]]:
    """Run the detector `fast` over signals at both of its
    operating points, of which a divider has one.
    """
    kept = list(signals)
    points = POINTS if design.board.has_filter else {"on": "fast"}
    return {point: run_detector(name, design, kept) for point, name in points.items()}


def generate_all(
    design: Design,
    trials: int,
    minutes: float,
    size: MixSize,
    first_seed: int,
) -> Iterator[LabelledSignal]:
    """Generate trials, the campaign's scenes without slip for some minutes, then the wider mix."""
    seeds = itertools.count(first_seed)
    scenes = [scene for scene, _ in article_trials()]

    with compiled():
        for i in range(trials):
            yield simulate_scene(design, scenes[i % len(scenes)], next(seeds), SLIP)

        for i in range(trials):
            scene = scenes[i % len(scenes)]
            towards = ("base", "side")[i % 2]
            turned = scene.model_copy(
                update={"slide": scene.slide.model_copy(update={"towards": towards})}
            )
            yield simulate_scene(design, turned, next(seeds), f"{SLIP} towards the {towards}")

        for cause, (scene, share) in NEGATIVE_SCENES.items():
            for _ in range(math.ceil(60 * minutes * share / nominal_duration_s(cause))):
                yield simulate_scene(design, scene, next(seeds), WITHOUT_SLIP + cause)

    yield from generate_mix(design, size, next(seeds))


def pool(outcomes: Sequence[Outcome]) -> dict[str, MixSummary]:
    """Pool outcomes by kind, all trials and scenes whose alarms are limited also under
    "campaign".
    """
    limited = [
        SLIP,
        *(WITHOUT_SLIP + cause for cause in NEGATIVE_SCENES if cause not in REPORTED_SEPARATELY),
    ]
    found = summarise(outcomes)
    noisy = {kind: found.pop(kind) for kind in ("unstated noise",) if kind in found}

    return (
        found
        | {"campaign": MixSummary(tuple(one for one in outcomes if one.kind in limited))}
        | noisy
    )


def describe(kind: str, summary: MixSummary) -> str:
    """Describe the outcomes of one kind: what its limits apply to."""
    parts = []
    if summary.slides:
        parts.append(
            f"found {100 * summary.found_share:5.1f} % of {summary.slides:4}; "
            f"median {1000 * summary.delay_s(0.5):.1f}, "
            f"p90 {1000 * summary.delay_s(0.9):.1f} / {1000 * summary.motion_delay_s(0.9):.1f}, "
            f"worst {1000 * summary.worst_s:.1f} ms, {count_late(summary)} above "
            f"{1000 * WORST_GOAL_S:g} ms"
        )
    if kind.startswith("burst"):
        parts.append(
            "medians " + " ".join(f"{1000 * m:.1f}" for m in median_by_strength_s(summary)) + " ms"
        )

    if kind == "long slide":
        shares = [share for outcome in summary.outcomes for share in outcome.on_shares]
        parts.append(
            f"ON {sum(shares) / len(shares):.4f}, at least {summary.smallest_on_share:.3f}"
        )

    if summary.events:
        parts.append(f"{100 * summary.disturbed_share:.1f} % of {summary.events} events")

    alarms = f"{summary.alarms} alarms in {summary.minutes:.1f} min"
    if summary.alarms:
        alarms += f", {summary.alarms_per_minute:.2f}"

    parts.append(
        f"{alarms}, at most {poisson_interval(summary.alarms)[1] / summary.minutes:.3f} / min"
    )
    if kind in NOISES or kind == "vibration with the grasp":
        silent = sum(outcome.false_on_share for outcome in summary.outcomes) / len(summary.outcomes)
        parts.append(f"ON without slip {100 * silent:.2f} %")

    return "; ".join(parts)


def count_late(summary: MixSummary) -> int:
    """Count the slips that were found later than `WORST_GOAL_S` after gross slip."""
    return sum(d > WORST_GOAL_S for outcome in summary.outcomes for d in outcome.delays_s)


def median_by_strength_s(summary: MixSummary, groups: int = 4) -> list[float]:
    """Median delay of each group of slips, from the weakest to the strongest [s]."""
    ranked = sorted(
        (o.strength_v, o.delays_s[0] if o.delays_s else math.inf)
        for o in summary.outcomes
        if o.slides
    )
    parts = np.array_split(np.array([delay for _, delay in ranked]), groups)
    return [float(np.median(part)) for part in parts if len(part)]


if __name__ == "__main__":
    main()
