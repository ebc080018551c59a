"""Detector `fast` on the wider mix: slips, what a hand does, unstated noise, bursts.

    python -m benchmarks.slip_robustness [--design article] [--seeds 5500000 6500000]
        [--trials 240] [--json]

All seeds are held out: no detector was trained or tuned on them. The design `article` has the
article's bridge and converter (4.41 V open, 0.4 mV of noise, 16 bits of plus and minus 10 V). The
default design `fsr400` is read by a 12-bit converter of 3.3 V, with the board's filtered signal
beside the voltage.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
from collections.abc import Iterable, Iterator

from benchmarks.slip.baselines import detect
from benchmarks.slip.mix import MixSize, generate_mix
from benchmarks.slip.mix_signals import LabelledSignal, simulate_scene
from benchmarks.slip.recordings import Recording
from benchmarks.slip.scores import Tally, assess
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, NEGATIVE_SCENES, nominal_duration_s
from fingertip.sim.simulation import article_trials

SLIP = "slip"
"""Kind of the article's trials."""
WITHOUT_SLIP = "without slip: "
"""Begin of the kinds of the campaign's scenes without slip; the cause follows."""
SEEDS = tuple(HELD_OUT_FROM + 1_000_000 * i + 500_000 for i in range(8))


def main() -> None:
    """Print one line for each kind of signal and flag."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--design", default="article", help="design file or bundled name")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--trials", type=int, default=240)
    parser.add_argument(
        "--minutes", type=float, default=30.0, help="duration of the scenes without slip"
    )
    parser.add_argument("--events", type=int, default=MixSize.events)
    parser.add_argument("--noisy", type=int, default=MixSize.noisy)
    parser.add_argument("--json", action="store_true", help="print data in place of lines")
    options = parser.parse_args()
    size = MixSize(options.events, options.noisy)
    design = Design.load(options.design)
    found = dict[str, dict[str, Tally]]()

    for seed in options.seeds:
        signals = generate_all(
            design, trials=options.trials, minutes=options.minutes, size=size, first_seed=seed
        )
        judge(design, signals, found)

    if options.json:
        data = {
            point: {kind: tally.as_data() for kind, tally in kinds.items()}
            for point, kinds in found.items()
        }
        print(json.dumps(data, indent=1, allow_nan=False))
        return

    for point, kinds in found.items():
        print(f"{options.design}, {point}")
        for kind, tally in kinds.items():
            print(f"{kind:32} {describe(tally)}")


def generate_all(
    design: Design, *, trials: int, minutes: float, size: MixSize, first_seed: int
) -> Iterator[LabelledSignal]:
    """Generate trials, the campaign's scenes without slip for some minutes, then the wider mix."""
    seeds = itertools.count(first_seed)
    scenes = [scene for scene, _ in article_trials()]

    with compiled():
        for i in range(trials):
            scene = scenes[i % len(scenes)]
            towards = ("tip", "base", "side")[i % 3]
            slide = scene.slide.model_copy(update={"towards": towards})
            turned = scene.model_copy(update={"slide": slide})
            yield simulate_scene(design, turned, next(seeds), SLIP)

        for cause, (scene, share) in NEGATIVE_SCENES.items():
            for _ in range(math.ceil(60 * minutes * share / nominal_duration_s(cause))):
                yield simulate_scene(design, scene, next(seeds), WITHOUT_SLIP + cause)

        yield from generate_mix(design, size, next(seeds))


def judge(
    design: Design, signals: Iterable[LabelledSignal], found: dict[str, dict[str, Tally]]
) -> None:
    """Add what both flags find in signals, by flag and kind."""
    with compiled():
        for signal in signals:
            recording = Recording(signal, (), design=design)
            output = detect(design, recording, 1.0)
            for point, on in (("incipient", output.incipient), ("on", output.on)):
                tally = found.setdefault(point, {}).setdefault(signal.kind, Tally())
                tally.add(assess(recording, on))


def describe(tally: Tally) -> str:
    """Describe what was found in one kind of signal."""
    parts = []
    if tally.slips:
        parts.append(
            f"found {100 * tally.found_share:5.1f} % of {tally.slips:4}; "
            f"median {tally.quantile_ms(0.5):.1f}, p90 {tally.quantile_ms(0.9):.1f} ms, "
            f"ON {tally.on_share:.3f}, at least {min(tally.on_shares):.3f}"
        )
    if tally.events:
        parts.append(f"{100 * tally.taken_share:.1f} % of {tally.events} events")

    most = poisson_interval(tally.counted)[1] / max(tally.minutes, 1e-9)
    parts.append(f"{tally.counted} alarms in {tally.minutes:.1f} min, at most {most:.3f} / min")
    return "; ".join(parts)


if __name__ == "__main__":
    main()
