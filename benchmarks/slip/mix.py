"""Wider mix of signals beside a campaign, with seeds of its own, and what a detector makes of it.

Scenes of hands that are not steady follow published figures. Bands of tremor: G. G. Sutton, K.
Sykes, J. Physiol. 191, 1967. Force variation of able fingers: H. S. Baweja et al., Exp. Brain Res.
197, 2009, most of it below 4 Hz. Play of servos: makers and users state 0.25 degrees (brushless) to
1 degree (hobby), which at a finger of 30 mm on the 90 N/m of the article's hand are 12 to 47 mN.
Steps of a walker: J. K. Urbanek et al., 2018. All other ranges are assumptions.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from benchmarks.slip import mix_signals
from benchmarks.slip.mix_signals import REACTION_S, LabelledSignal
from fingertip.design import Design
from fingertip.foundation.numerics import poisson_interval
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.campaign import NEGATIVE_SCENES
from fingertip.lab.campaign.run import quantile_s, separate_events
from fingertip.sim.runs.pose import GRASP_POSE, ScenePose
from fingertip.sim.runs.scene_and_manipulation_files import DIRECTIONS, SceneFile
from fingertip.sim.signal.converter import SimulatedBoardDetector
from fingertip.sim.simulation import article_trials
from fingertip.slip.detectors.registry import find_detector_type, make_detector, select_inputs
from fingertip.slip.traces.truth import intervals

EARLY_S = 0.005
"""Time before gross slip from which a detection counts as one of
this slip [s]: the pad creeps already.
"""
SLIDE_STRENGTHS_V = (0.002, 0.004, 0.008, 0.016)
BURSTS_V = (0.006, 0.025)
_CONTACT_S = 1.7
"""Time after which a grasp of the scene "drift" has been held for 1 s [s]."""


_HOLD = {"mode": "grasp", "min_force_n": 0.5, "max_force_n": 2.0}


def _uniform(rng: np.random.Generator, low: float, high: float, digits: int = 6) -> float:
    return round(float(rng.uniform(low, high)), digits)


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return round(math.exp(rng.uniform(math.log(low), math.log(high))), 6)


def _draw_tremor(
    rng: np.random.Generator, share: tuple[float, float], slow_share: tuple[float, float]
) -> SceneFile:
    tremor = {
        "share": _log_uniform(rng, *share),
        "frequency_hz": _uniform(rng, 8.0, 12.0),
        "voluntary_share": _uniform(rng, *slow_share),
        "voluntary_hz": _uniform(rng, 0.5, 2.5),
    }
    return SceneFile(
        scene="tremor",
        pose=GRASP_POSE,
        hold={**_HOLD, "min_s": 4.0},
        tremor=tremor,
    )


_draw_stump = partial(_draw_tremor, share=(0.01, 0.05), slow_share=(0.05, 0.15))


def _draw_servo(
    rng: np.random.Generator, step_n: tuple[float, float], rise_s: tuple[float, float]
) -> SceneFile:
    servo = {"step_n": _log_uniform(rng, *step_n), "rise_s": _uniform(rng, *rise_s)}
    servo["interval_s"] = _uniform(rng, 0.2, 1.0)
    return SceneFile(
        scene="servo_steps",
        pose=GRASP_POSE,
        hold={**_HOLD, "min_s": 3.0},
        servo=servo,
    )


def _draw_set_down(rng: np.random.Generator) -> SceneFile:
    change = {"by_n": -_uniform(rng, 0.2, 0.8), "rise_s": _uniform(rng, 0.005, 0.02)}
    return SceneFile(
        scene="set_down",
        pose=GRASP_POSE,
        hold={**_HOLD, "min_force_n": 1.0},
        load_change=change,
    )


def _draw_walk(rng: np.random.Generator) -> SceneFile:
    tap = {"force_n": _log_uniform(rng, 0.05, 0.5), "rise_s": _uniform(rng, 0.02, 0.06), "count": 6}
    tap["interval_s"] = _uniform(rng, 0.5, 0.7)
    tremor = {
        "voluntary_share": _uniform(rng, 0.02, 0.1),
        "voluntary_hz": round(1 / tap["interval_s"], 3),
    }
    return SceneFile(
        scene="walking",
        pose=GRASP_POSE,
        hold=_HOLD,
        tap=tap,
        tremor=tremor,
    )


def _draw_edge(rng: np.random.Generator) -> SceneFile:
    pose = ScenePose(tilt_deg=5.0, object="edge", place_mm=_uniform(rng, 0.0, 3.0, 1))
    scene = _draw_stump(rng)
    return scene.model_copy(update={"scene": "edge_contact", "pose": pose})


def _draw_slip_after_ramp(rng: np.random.Generator) -> SceneFile:
    rise_s = _log_uniform(rng, 0.02, 0.2)
    sign = 1.0 if rng.random() < 0.5 else -1.0
    change = {
        "by_n": sign * _uniform(rng, 0.2, 0.7),
        "rise_s": rise_s,
        "at_s": round(1.0 - rise_s, 6),
    }
    hold = {**_HOLD, "min_force_n": 1.0}
    slide = _draw_slide(rng, 0.02)

    return SceneFile(
        scene="slip_after_ramp",
        pose=GRASP_POSE,
        hold=hold,
        load_change=change,
        slide=slide,
    )


def _draw_pauses(rng: np.random.Generator) -> SceneFile:
    slide = _draw_slide(rng, 0.04) | {
        "moves": int(rng.integers(2, 6)),
        "pause_s": _uniform(rng, 0.1, 0.5),
    }
    return SceneFile(
        scene="slips_with_pauses",
        pose=GRASP_POSE,
        hold=_HOLD,
        slide=slide,
    )


def _draw_slide(rng: np.random.Generator, distance_m: float) -> dict[str, Any]:
    towards = tuple(DIRECTIONS)[int(rng.integers(len(DIRECTIONS)))]
    return {"distance_m": distance_m, "speed_m_s": _uniform(rng, 0.03, 0.08), "towards": towards}


def _draw_grip_change(rng: np.random.Generator) -> SceneFile:
    """Change of a grasp's force by 1 N, up or down."""
    grows = bool(rng.random() < 0.5)
    hold = {
        "mode": "grasp",
        "min_force_n": 0.5 if grows else 1.3,
        "max_force_n": 1.5 if grows else 2.5,
    }
    change = {"by_n": 1.0 if grows else -1.0, "rise_s": float(rng.uniform(0.02, 0.15))}

    return SceneFile(
        scene="grip_change",
        pose=GRASP_POSE,
        hold=hold,
        load_change=change,
    )


def _draw_fast_closing(rng: np.random.Generator) -> SceneFile:
    hold = {**_HOLD, "close_s": float(rng.uniform(0.05, 0.15)), "release": False}
    return SceneFile(scene="fast_closing", pose=GRASP_POSE, hold=hold)


def _draw_taps(rng: np.random.Generator) -> SceneFile:
    tap = {
        "force_n": float(rng.uniform(0.3, 2.0)),
        "rise_s": float(rng.uniform(0.002, 0.01)),
        "count": 3,
    }
    return SceneFile(
        scene="taps",
        pose=GRASP_POSE,
        hold=_HOLD,
        tap=tap,
    )


EVENTS: Mapping[str, tuple[Callable[[np.random.Generator], SceneFile], int]] = {
    "grip change": (_draw_grip_change, 1),
    "fast closing": (_draw_fast_closing, 1),
    "tap": (_draw_taps, 3),
}
"""Kind -> function that draws a scene of it, and the number of its events."""
UNSTEADY: Mapping[str, Callable[[np.random.Generator], SceneFile]] = {
    "tremor of an able hand": partial(_draw_tremor, share=(0.002, 0.02), slow_share=(0.015, 0.075)),
    "tremor of a stump": _draw_stump,
    "steps of a hobby servo": partial(_draw_servo, step_n=(0.015, 0.05), rise_s=(0.01, 0.03)),
    "steps of a brushless servo": partial(_draw_servo, step_n=(0.003, 0.015), rise_s=(0.003, 0.01)),
    "setting down": _draw_set_down,
    "walking": _draw_walk,
    "unstable contact": _draw_edge,
    "slip after a ramp": _draw_slip_after_ramp,
    "slips with pauses": _draw_pauses,
}
"""Kind -> function that draws a scene of it."""
EXCLUDED_FROM_TRAINING = ("steps of a hobby servo", "steps of a brushless servo", "setting down")
"""Kinds that the detector `fast` was not fitted to: each of their
steps looks like the start of a slip.
"""


@dataclass(frozen=True)
class MixSize:
    events: int = 100
    """Number of changes of grip; of fast closings; of taps; of
    controller's steps, about; of bursts of either kind.
    """
    noisy: int = 48
    """Trials in each condition of `benchmarks.slip.mix_signals.NOISES`."""


def generate_mix(design: Design, size: MixSize, first_seed: int) -> Iterator[LabelledSignal]:
    """Draw and simulate all signals of the mix; a hand gives one for each finger."""
    seeds = itertools.count(first_seed)
    for found in call_each(
        itertools.chain(_plan_events(design, size.events, seeds), _plan_noisy(design, size, seeds))
    ):
        yield from [found] if isinstance(found, LabelledSignal) else found


Draw: TypeAlias = "partial[Any]"
"""Call that gives a signal, or those of several fingers."""


def _plan_events(design: Design, events: int, seeds: Iterator[int]) -> Iterator[Draw]:
    for kind, (draw_scene, share) in EVENTS.items():
        for seed in itertools.islice(seeds, math.ceil(events / share)):
            yield partial(
                mix_signals.simulate_scene,
                design,
                draw_scene(np.random.default_rng(seed)),
                seed,
                kind,
            )

    for draw, share, options in (
        (mix_signals.grip_steps, 7, ()),
        (mix_signals.manipulation, 7, ()),
        (mix_signals.abrupt_burst, 1, BURSTS_V),
        (mix_signals.low_burst, 2, BURSTS_V),
    ):
        yield from (
            partial(draw, design, next(seeds), *options) for _ in range(math.ceil(events / share))
        )

    for i in range(math.ceil(events / 2)):
        yield partial(
            mix_signals.long_slide,
            design,
            next(seeds),
            SLIDE_STRENGTHS_V[i % len(SLIDE_STRENGTHS_V)],
        )

    yield from (
        partial(mix_signals.ringing_knock, design, next(seeds))
        for _ in range(math.ceil(events / 3))
    )
    for kind, draw_scene in UNSTEADY.items():
        for seed in itertools.islice(seeds, math.ceil(events / 8)):
            scene = draw_scene(np.random.default_rng(seed))
            yield partial(mix_signals.simulate_scene, design, scene, seed, kind, 1.0)


def _plan_noisy(design: Design, size: MixSize, seeds: Iterator[int]) -> Iterator[Draw]:
    trials = [scene for scene, _ in article_trials()]
    held = NEGATIVE_SCENES["drift"][0]
    for name, condition in mix_signals.NOISES.items():
        slides = [trials[i * len(trials) // size.noisy] for i in range(size.noisy)]
        for scene in (*slides, *[held] * math.ceil(size.noisy / 6)):
            yield partial(mix_signals.in_condition, design, scene, next(seeds), name, condition)

    hand = SceneFile(**(held.model_dump() | {"noise": {"hand_v": 5e-4}}))
    for _ in range(math.ceil(size.noisy / 3)):
        yield partial(
            mix_signals.simulate_scene,
            design,
            hand,
            next(seeds),
            "vibration with the grasp",
            _CONTACT_S,
        )

    coarse = {"converter": {"bits": 10, "high_v": 5.0}}
    for i in range(math.ceil(size.noisy / 4)):
        for scene in (trials[(8 * i) % len(trials)], held):
            yield partial(mix_signals.in_condition, design, scene, next(seeds), "10 bits", coarse)


@dataclass(frozen=True)
class Outcome:
    kind: str
    strength_v: float
    minutes: float
    slides: int
    delays_s: tuple[float, ...]
    """Delays of the slips that were found, from gross slip [s]."""
    motion_delays_s: tuple[float, ...]
    on_shares: tuple[float, ...]
    """Share of each slip, from its onset to its end, that is ON."""
    alarms: int
    alarms_s: tuple[float, ...]
    events: int
    disturbed: int
    """Number of events that caused an alarm."""
    false_on_share: float
    """Share of the time without slip that is ON, where alarms count."""


def assess(signal: LabelledSignal, on: NDArray[np.bool_], memory_s: float) -> Outcome:
    """Compare the flags of a detector with what is known about a signal.

    A slip is found if the detector turns ON between its onset, less `EARLY_S`, and its end. An
    alarm is a transition to ON outside the slips, their creep, and the detector's memory after
    them. Alarms closer together than `fingertip.lab.campaign.run.SAME_EVENT_S` count once.
    """
    time_s = np.arange(len(on)) / signal.rate_hz
    found = intervals(time_s, on)
    delays = []
    motion_delays = []
    shares = []
    is_slip = np.zeros(len(on), dtype=bool)

    for slide in signal.slides:
        inside = [i for i in found if slide.onset_s - EARLY_S <= i.onset_s < slide.end_s]
        if inside:
            delays.append(max(0.0, inside[0].onset_s - slide.onset_s))
            motion_delays.append(max(0.0, inside[0].onset_s - slide.motion_s))

        during = (time_s >= slide.onset_s) & (time_s < slide.end_s)
        shares.append(float(np.mean(on[during])) if during.any() else 0.0)
        is_slip |= (time_s >= slide.motion_s) & (time_s < slide.end_s + memory_s)

    alarms = separate_events(
        i
        for i in found
        if i.onset_s >= signal.alarms_from_s
        and not any(s.onset_s - EARLY_S <= i.onset_s < s.end_s + memory_s for s in signal.slides)
    )
    # Right before a slip, an alarm that the event causes and the detection of the slip cannot be
    # told apart.
    events = [
        event
        for event in signal.events
        if not any(
            event.onset_s < s.end_s and s.motion_s < event.end_s + REACTION_S for s in signal.slides
        )
    ]
    disturbed = sum(
        any(event.onset_s <= i.onset_s < event.end_s + REACTION_S for i in found)
        for event in events
    )
    counted = ~is_slip & (time_s >= signal.alarms_from_s)

    return Outcome(
        kind=signal.kind,
        strength_v=signal.strength_v,
        minutes=signal.duration_s / 60,
        slides=len(signal.slides),
        delays_s=tuple(delays),
        motion_delays_s=tuple(motion_delays),
        on_shares=tuple(shares),
        alarms=len(alarms),
        alarms_s=tuple(alarm.onset_s for alarm in alarms),
        events=len(events),
        disturbed=disturbed,
        false_on_share=float(np.mean(on[counted])) if counted.any() else 0.0,
    )


def run_detector(name: str, design: Design, signals: Iterable[LabelledSignal]) -> list[Outcome]:
    """Run a detector, or the design's simulated board ahead of one
    that reads it, with the design's noise.
    """
    outcomes = []
    takes_envelope = find_detector_type(name).takes_envelope

    for signal in signals:
        detector = SimulatedBoardDetector(design) if takes_envelope else make_detector(name, design)
        inputs = (signal.voltage_v,) if takes_envelope else select_inputs(signal, name)
        outcomes.append(assess(signal, detector.process(*inputs).on, detector.memory_s))

    return outcomes


@dataclass(frozen=True)
class MixSummary:
    """Pooled outcomes of one kind of signal."""

    outcomes: tuple[Outcome, ...]

    @property
    def slides(self) -> int:
        return sum(outcome.slides for outcome in self.outcomes)

    @property
    def found_share(self) -> float:
        return (
            sum(len(outcome.delays_s) for outcome in self.outcomes) / self.slides
            if self.slides
            else math.nan
        )

    def delay_s(self, fraction: float) -> float:
        return quantile_s(
            [d for outcome in self.outcomes for d in outcome.delays_s], self.slides, fraction
        )

    def motion_delay_s(self, fraction: float) -> float:
        return quantile_s(
            [d for outcome in self.outcomes for d in outcome.motion_delays_s], self.slides, fraction
        )

    @property
    def worst_s(self) -> float:
        """Longest delay from gross slip of a slip that was found [s]; infinite if none was."""
        return max((d for outcome in self.outcomes for d in outcome.delays_s), default=math.inf)

    @property
    def smallest_on_share(self) -> float:
        """Smallest share of any slip that is ON."""
        return min(
            (share for outcome in self.outcomes for share in outcome.on_shares), default=math.nan
        )

    @property
    def minutes(self) -> float:
        """Duration in which alarms count [min]."""
        return sum(outcome.minutes for outcome in self.outcomes)

    @property
    def alarms(self) -> int:
        return sum(outcome.alarms for outcome in self.outcomes)

    @property
    def alarms_per_minute(self) -> float:
        return self.alarms / self.minutes if self.minutes else 0.0

    @property
    def events(self) -> int:
        return sum(outcome.events for outcome in self.outcomes)

    @property
    def disturbed_share(self) -> float:
        return (
            sum(outcome.disturbed for outcome in self.outcomes) / self.events
            if self.events
            else math.nan
        )

    def as_data(self) -> dict[str, float | None]:
        """Convert it to plain data for JSON; None for what these signals do not show."""
        shares = [share for outcome in self.outcomes for share in outcome.on_shares]
        found = {
            "slips": self.slides,
            "found": sum(len(outcome.delays_s) for outcome in self.outcomes),
            "median_ms": 1000 * self.delay_s(0.5) if self.slides else math.nan,
            "p90_ms": 1000 * self.delay_s(0.9) if self.slides else math.nan,
            "worst_ms": 1000 * self.worst_s,
            "p90_from_motion_ms": 1000 * self.motion_delay_s(0.9) if self.slides else math.nan,
            "on_share": sum(shares) / len(shares) if shares else math.nan,
            "least_on_share": self.smallest_on_share,
            "events": self.events,
            "disturbed": sum(outcome.disturbed for outcome in self.outcomes),
            "alarms": self.alarms,
            "minutes": self.minutes,
            "most_alarms_per_minute": poisson_interval(self.alarms)[1] / self.minutes
            if self.minutes
            else math.nan,
        }
        return {name: value if math.isfinite(value) else None for name, value in found.items()}


def summarise(outcomes: Iterable[Outcome]) -> dict[str, MixSummary]:
    """Pool outcomes by kind, and those in all conditions of
    `benchmarks.slip.mix_signals.NOISES` together.
    """
    groups: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.kind, []).append(outcome)

    groups["unstated noise"] = [
        outcome for kind in mix_signals.NOISES for outcome in groups.get(kind, [])
    ]
    return {kind: MixSummary(tuple(group)) for kind, group in groups.items() if group}
