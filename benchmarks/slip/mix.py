"""Wider mix of signals beside a campaign, with seeds of its own.

Scenes of hands that are not steady follow published figures. Bands of tremor: G. G. Sutton, K.
Sykes, J. Physiol. 191, 1967. Force variation of able fingers: H. S. Baweja et al., Exp. Brain Res.
197, 2009, most of it below 4 Hz. Play of servos: makers and users state 0.25 degrees (brushless) to
1 degree (hobby), which at a finger of 30 mm on the 90 N/m of the article's hand are 12 to 47 mN.
Steps of a walker: J. K. Urbanek et al., 2018. All other ranges are assumptions.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from benchmarks.slip import mix_signals
from benchmarks.slip.mix_signals import LabelledSignal
from fingertip.design import Design
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.campaign import NEGATIVE_SCENES
from fingertip.sim.runs.pose import GRASP_POSE, ScenePose
from fingertip.sim.runs.scene_and_manipulation_files import DIRECTIONS, SceneFile
from fingertip.sim.simulation import article_trials

BURSTS_V = 0.006, 0.025
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


@dataclass(frozen=True)
class MixSize:
    events: int = 100
    """Number of changes of grip, of fast closings, of taps, and of bursts."""
    noisy: int = 48
    """Trials in each condition of `benchmarks.slip.mix_signals.NOISES`."""


def generate_mix(design: Design, size: MixSize, first_seed: int) -> Iterator[LabelledSignal]:
    """Draw and simulate all signals of the mix."""
    seeds = itertools.count(first_seed)
    plans = (_plan_events(design, size.events, seeds), _plan_noisy(design, size, seeds))
    yield from call_each(itertools.chain.from_iterable(plans))


Draw: TypeAlias = "partial[LabelledSignal]"
"""Call that gives a signal."""


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

    for seed in itertools.islice(seeds, events):
        yield partial(mix_signals.abrupt_burst, design, seed, *BURSTS_V)

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
