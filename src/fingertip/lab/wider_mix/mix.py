"""The whole wider mix: every kind of signal, with seeds of its own, and what a detector makes of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.evaluate import needs_board
from fingertip.lab.campaign.plan import NEGATIVE_SCENES, REPORTED_SEPARATELY, nominal_duration_s
from fingertip.lab.campaign.run import quantile_s
from fingertip.lab.wider_mix import bursts, scenes
from fingertip.lab.wider_mix.bursts import LabelledSignal, Outcome, assess
from fingertip.sim import SceneFile
from fingertip.sim.article import article_trials
from fingertip.sim.signal.converter import SimulatedBoardDetector
from fingertip.slip import make_detector
from fingertip.slip.detectors.registry import select_inputs

SLIP = "slip"
"""Kind of the article's trials."""
CAMPAIGN = "without slip: "
"""Begin of the kinds of the campaign's scenes without slip; the cause follows."""
SLIDE_STRENGTHS_V = (0.002, 0.004, 0.008, 0.016)
"""RMS values of the long slides [V]."""
BURSTS_V = (0.006, 0.025)
"""Range of the bursts' RMS values [V]."""
_CONTACT_S = 1.7
"""Time after which a grasp of the scene "drift" has been held for 1 s [s]."""


@dataclass(frozen=True)
class MixSize:
    """Numbers of signals."""

    trials: int = 240
    minutes: float = 30.0
    """Duration of the campaign's scenes without slip [min]."""
    events: int = 100
    """Number of changes of grip; of fast closings; of taps; of controller's steps, about; of bursts of either kind."""
    noisy: int = 48
    """Trials in each condition of `fingertip.lab.wider_mix.scenes.NOISES`."""

    @classmethod
    def for_trials(cls, trials: int) -> MixSize:
        """Size beside a campaign of so many trials, which holds the trials and the scenes without slip itself."""
        return cls(0, 0.0, max(4, trials), max(4, 2 * trials // 5))


def generate_mix(design: Design, size: MixSize, first_seed: int) -> Iterator[LabelledSignal]:
    """Generate the signals one after the other."""
    seed = first_seed

    def next_seed() -> int:
        nonlocal seed
        seed += 1
        return seed - 1

    trials = [scene for scene, _ in article_trials()]
    with compiled():
        for i in range(size.trials):
            yield scenes.simulate_scene(design, trials[i % len(trials)], next_seed(), SLIP)
        for cause, (scene, share) in NEGATIVE_SCENES.items():
            for _ in range(math.ceil(60 * size.minutes * share / nominal_duration_s(cause))):
                yield scenes.simulate_scene(design, scene, next_seed(), CAMPAIGN + cause)
        for _ in range(size.events):
            yield scenes.grip_change(design, next_seed())
        for _ in range(size.events):
            yield scenes.fast_closing(design, next_seed())
        for _ in range(math.ceil(size.events / 3)):
            yield scenes.taps(design, next_seed())
        for _ in range(math.ceil(size.events / 7)):
            yield from scenes.grip_steps(design, next_seed())
        for _ in range(math.ceil(size.events / 7)):
            yield from scenes.manipulation(design, next_seed())
        for _ in range(size.events):
            yield bursts.abrupt_burst(design, next_seed(), *BURSTS_V)
        for _ in range(math.ceil(size.events / 2)):
            yield bursts.low_burst(design, next_seed(), *BURSTS_V)
        for i in range(math.ceil(size.events / 2)):
            yield bursts.long_slide(design, next_seed(), SLIDE_STRENGTHS_V[i % len(SLIDE_STRENGTHS_V)])
        for _ in range(math.ceil(size.events / 3)):
            yield bursts.ringing_knock(design, next_seed())
        yield from _noisy(design, size, trials, next_seed)


def _noisy(design: Design, size: MixSize, trials: Sequence[SceneFile], next_seed: object) -> Iterator[LabelledSignal]:
    assert callable(next_seed)
    held = NEGATIVE_SCENES["drift"][0]
    for name in scenes.NOISES:
        for i in range(size.noisy):
            yield scenes.in_noise(design, trials[i * len(trials) // size.noisy], next_seed(), name)
        for _ in range(math.ceil(size.noisy / 6)):
            yield scenes.in_noise(design, held, next_seed(), name)
    hand = SceneFile(**(held.model_dump() | {"noise": {"hand_v": 5e-4}}))
    for _ in range(math.ceil(size.noisy / 3)):
        yield scenes.simulate_scene(design, hand, next_seed(), "vibration with the grasp", _CONTACT_S)
    coarse = {"converter": {"bits": 10, "high_v": 5.0}}
    for i in range(math.ceil(size.noisy / 4)):
        for scene in (trials[(8 * i) % len(trials)], held):
            yield scenes.in_condition(design, scene, next_seed(), "10 bits", coarse)


def run_detector(name: str, design: Design, signals: Iterable[LabelledSignal]) -> list[Outcome]:
    """Run a detector over signals; it assumes the design's noise, whatever they have.

    A detector of the board's envelope reads the design's board, simulated on the sampled voltage.
    """
    outcomes = []
    with compiled():
        for signal in signals:
            if needs_board(name):
                board = SimulatedBoardDetector(design)
                outcomes.append(assess(signal, board.process(signal.voltage_v).on, board.memory_s))
                continue
            detector = make_detector(name, design)
            outcomes.append(assess(signal, detector.process(*select_inputs(signal, name)).on, detector.memory_s))
    return outcomes


@dataclass(frozen=True)
class MixSummary:
    """Pooled outcomes of one kind of signal."""

    outcomes: tuple[Outcome, ...]

    @property
    def slides(self) -> int:
        """Number of slips."""
        return sum(outcome.slides for outcome in self.outcomes)

    @property
    def found_share(self) -> float:
        """Share of the slips that were found."""
        return sum(len(outcome.delays_s) for outcome in self.outcomes) / self.slides if self.slides else math.nan

    def delay_s(self, fraction: float) -> float:
        """Delay from gross slip by which a fraction of all slips was found [s]; infinite if fewer were."""
        return quantile_s([d for outcome in self.outcomes for d in outcome.delays_s], self.slides, fraction)

    def motion_delay_s(self, fraction: float) -> float:
        """Delay from the start of the motion by which a fraction of all slips was found [s]."""
        return quantile_s([d for outcome in self.outcomes for d in outcome.motion_delays_s], self.slides, fraction)

    @property
    def worst_s(self) -> float:
        """Longest delay from gross slip of a slip that was found [s]."""
        return max((d for outcome in self.outcomes for d in outcome.delays_s), default=math.nan)

    def count_later_than(self, delay_s: float) -> int:
        """Count the slips that were found later than this after gross slip [s]."""
        return sum(d > delay_s for outcome in self.outcomes for d in outcome.delays_s)

    @property
    def on_share(self) -> float:
        """Smallest share of any slip that is ON."""
        return min((share for outcome in self.outcomes for share in outcome.on_shares), default=math.nan)

    @property
    def minutes(self) -> float:
        """Duration in which alarms count [min]."""
        return sum(outcome.minutes for outcome in self.outcomes)

    @property
    def alarms(self) -> int:
        """Number of alarms."""
        return sum(outcome.alarms for outcome in self.outcomes)

    @property
    def alarms_per_minute(self) -> float:
        """Rate of alarms [1/min]."""
        return self.alarms / self.minutes if self.minutes else 0.0

    @property
    def most_alarms_per_minute(self) -> float:
        """Upper end of the interval of that rate [1/min]."""
        return poisson_interval(self.alarms)[1] / self.minutes

    @property
    def events(self) -> int:
        """Number of events that are not slip."""
        return sum(outcome.events for outcome in self.outcomes)

    @property
    def disturbed_share(self) -> float:
        """Share of these events that caused an alarm."""
        return sum(outcome.disturbed for outcome in self.outcomes) / self.events if self.events else math.nan

    def median_by_strength_s(self, groups: int = 4) -> list[float]:
        """Median delay of each group of slips, from the weakest to the strongest [s]."""
        ranked = sorted((o.strength_v, o.delays_s[0] if o.delays_s else math.inf) for o in self.outcomes if o.slides)
        parts = np.array_split(np.array([delay for _, delay in ranked]), groups)
        return [float(np.median(part)) for part in parts if len(part)]


def summarise(outcomes: Iterable[Outcome]) -> dict[str, MixSummary]:
    """Pool outcomes by kind, all trials and scenes whose alarms are limited also under "campaign"."""
    groups: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.kind, []).append(outcome)
    limited = [SLIP, *(CAMPAIGN + cause for cause in NEGATIVE_SCENES if cause not in REPORTED_SEPARATELY)]
    groups["campaign"] = [outcome for kind in limited for outcome in groups.get(kind, [])]
    groups["unstated noise"] = [outcome for kind in scenes.NOISES for outcome in groups.get(kind, [])]
    return {kind: MixSummary(tuple(group)) for kind, group in groups.items()}
