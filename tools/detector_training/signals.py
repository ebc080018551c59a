"""Signals to train on: slips and what is not slip, each in noise that the design states or does
not.

Half of them come from the article's board and converter. The others come from a board for a
controller, which samples the filtered signal too; a part of these lacks it, as on a board where it
is not wired.

All seeds lie below those of a validation and of `benchmarks/slip_robustness.py`, so nothing
reported was trained on.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from benchmarks.slip import mix_signals
from benchmarks.slip.mix import EXCLUDED_FROM_TRAINING, UNSTEADY, Draw
from benchmarks.slip.mix_signals import LabelledSignal
from fingertip.design import Design
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign.campaign import NEGATIVE_SCENES, nominal_duration_s
from fingertip.sim.contact.surface_files import SurfaceTable
from fingertip.sim.runs.pose import GRASP_POSE
from fingertip.sim.runs.scene_and_manipulation_files import DIRECTIONS, SceneFile
from fingertip.sim.simulation import article_trials
from tools.detector_training.disturbances import SLOW_SLIDES, generate_disturbances

FIRST_SEED = 200_000
"""First seed of training."""
MANIPULATIONS_FROM = 400_000
"""First seed of the manipulations."""
DISTURBANCES_FROM = 300_000
"""First seed of the signals that are drawn as voltages, from generators of their own."""
REPEAT_SEEDS = 15_000
"""Seeds that each fit of the same recipe has for itself."""
UNDECIDABLE = ("motor", "cable")
"""Causes that are not trained on: within 20 ms one force axis does not distinguish them
from slip.
"""


ARTICLE = Design(
    board={"variant": "article", "supply_v": 5.0},
    detector={
        "noise_v": 4e-4,
        "adc_bits": 16,
        "adc_range_v": 10.0,
        "adc_polarity": "bipolar",
    },
)
CONTROLLER = Design(
    board={"variant": "precision", "supply_v": 3.3},
    detector={
        "noise_v": 4e-4,
        "adc_bits": 12,
        "adc_range_v": 3.3,
        "adc_polarity": "unipolar",
    },
)
DESIGNS = (ARTICLE, CONTROLLER)
UNWIRED_SHARE = 0.2
"""Share of the controller's signals without the filtered signal."""
SLOW_SHARE = 0.6
SLOW_HZ = (1.5, 28.0)
SLOW_FACTOR = (0.5, 10.0)
SLOW_END_S = 0.02
"""Share of the slips with slow friction, its band [Hz], its strength relative to the slip's
vibration, and the time in which it begins and ends [s]. Real slides carry 4 to 10 times as much
force at 3 to 28 Hz as at 40 to 90 Hz.
"""
WEAK_SHARE = 0.35
WEAK_FELT_UM = (0.25, 1.2)
AVERAGING_SHARE = 0.1
"""Share of the trials whose pad or surface vibrates less than the article's, the vibration felt in
them [um], and the share of trials whose pad averages the surface over its patch.
"""
VIBRATION_HZ = 30.0, 250.0
"""Band in which a slip's vibration is measured [Hz]."""


@dataclass(frozen=True)
class TrainingSignal:
    """Signal and the design that a detector of it assumes."""

    signal: LabelledSignal
    design: Design


def draw_condition(rng: np.random.Generator, design: Design) -> dict[str, Any]:
    """Draw noise and converter: what the design states in a third of the cases."""
    kind = rng.random()
    if kind < 0.36:
        return {}
    if kind < 0.6:
        return {"factor": math.exp(rng.uniform(math.log(0.5), math.log(5)))}
    if kind < 0.67:
        return {"noise": {"pink_v": float(rng.uniform(1e-4, 4e-4))}}
    if kind < 0.73:
        return {
            "noise": {
                "hum_v": float(rng.uniform(1e-4, 1e-3)),
                "hum_hz": float(rng.choice([50.0, 60.0])),
            }
        }
    if kind < 0.8:
        return {"converter": {"bits": 12, "high_v": 5.0}} if design is ARTICLE else _TEN_BITS
    if kind < 0.84:
        return {"converter": {"bits": 10, "high_v": 5.0}} if design is ARTICLE else _TEN_BITS
    if kind < 0.95:
        return {"background_v": float(rng.uniform(1e-4, 5e-4))}

    return {"noise": {"hand_v": float(rng.uniform(1e-4, 6e-4))}}


_TEN_BITS: dict[str, Any] = {"converter": {"bits": 10, "high_v": 3.3}}


def generate(
    trials: int, events: int, disturbances: int, repeat: int = 0
) -> Iterator[TrainingSignal]:
    """Simulate the training mix.

    Parameters
    ----------
    trials
        Number of trials with slip for each design; the scenes without slip last 12 s for each.
    events
        Number of changes of grip; other events are in proportion.
    disturbances
        Number to which the shares of `tools.detector_training.disturbances.KINDS` refer.
    repeat
        Number of the fit, 0 to 2: the same recipe with other seeds.
    """
    for number, design in enumerate(DESIGNS):
        later = number * 50_000 + repeat * REPEAT_SEEDS
        rng = np.random.default_rng((FIRST_SEED + repeat, number, 1))
        for signal in generate_for(design, FIRST_SEED + later, trials, events):
            signal = add_slow_friction(design, signal, rng)
            if signal.filtered_v is not None and rng.random() < UNWIRED_SHARE:
                signal = replace(signal, filtered_v=None)

            yield TrainingSignal(signal, design)

        for signal, sampled in generate_disturbances(
            design, DISTURBANCES_FROM + later, disturbances, UNWIRED_SHARE
        ):
            is_slow = signal.kind == SLOW_SLIDES
            yield TrainingSignal(
                signal if is_slow else add_slow_friction(sampled, signal, rng), sampled
            )


def add_slow_friction(
    design: Design, signal: LabelledSignal, rng: np.random.Generator
) -> LabelledSignal:
    """Add slow changes of friction to a share of the slips in a
    sampled signal, as real slides have them.
    """
    rate_hz = signal.rate_hz
    slow_v = np.zeros(len(signal.voltage_v))

    for slide in signal.slides:
        first = round(slide.onset_s * rate_hz)
        end = min(round(slide.end_s * rate_hz), len(slow_v))
        if rng.random() >= SLOW_SHARE or end - first < rate_hz / SLOW_HZ[0]:
            continue

        spectrum = np.fft.rfft(signal.voltage_v[first:end])
        frequency_hz = np.fft.rfftfreq(end - first, 1 / rate_hz)
        spectrum[(frequency_hz < VIBRATION_HZ[0]) | (frequency_hz > VIBRATION_HZ[1])] = 0.0
        rms_v = float(np.std(np.fft.irfft(spectrum, end - first)))
        factor = math.exp(rng.uniform(math.log(SLOW_FACTOR[0]), math.log(SLOW_FACTOR[1])))
        t = np.arange(end - first) / rate_hz
        fade = np.minimum(np.minimum(t, t[-1] - t) / SLOW_END_S, 1.0)
        slow_v[first:end] += (
            factor * rms_v * fade * mix_signals.draw_band_noise(rng, end - first, rate_hz, *SLOW_HZ)
        )

    if not slow_v.any():
        return signal

    step_v = design.detector.adc_step_v
    filtered_v = mix_signals.filter_as_board(design, slow_v)
    if signal.filtered_v is None or filtered_v is None:
        filtered = signal.filtered_v
    else:
        filtered = np.round((signal.filtered_v + filtered_v) / step_v) * step_v

    voltage_v = np.round((signal.voltage_v + slow_v) / step_v) * step_v
    return replace(signal, voltage_v=voltage_v, filtered_v=filtered)


def generate_for(design: Design, seed: int, trials: int, events: int) -> Iterator[LabelledSignal]:
    """Simulate the mix for one design, from a first seed on."""
    hands_from = MANIPULATIONS_FROM + seed - FIRST_SEED
    draws = itertools.chain(
        _plan_draws(design, seed, trials, events), _plan_manipulations(design, hands_from, events)
    )
    for found in call_each(draws):
        yield from [found] if isinstance(found, LabelledSignal) else found


def _plan_draws(design: Design, first_seed: int, trials: int, events: int) -> Iterator[Draw]:
    rng = np.random.default_rng(first_seed)
    seeds = itertools.count(first_seed)
    for kind, scene in _plan(rng, trials, events):
        yield partial(
            mix_signals.in_condition, design, scene, next(seeds), kind, draw_condition(rng, design)
        )

    for _ in range(events // 5):
        yield partial(mix_signals.grip_steps, design, next(seeds))

    for _ in range(events):
        yield partial(
            mix_signals.abrupt_burst, design, next(seeds), 0.002, 0.03, float(rng.uniform(0.1, 0.6))
        )

    for _ in range(events // 4):
        yield partial(
            mix_signals.low_burst, design, next(seeds), 0.002, 0.03, float(rng.uniform(0.2, 0.6))
        )

    for _ in range(events // 20):
        yield partial(mix_signals.long_slide, design, next(seeds), float(rng.uniform(0.002, 0.02)))

    for _ in range(events // 2):
        yield partial(mix_signals.ringing_knock, design, next(seeds))


def _plan_manipulations(design: Design, seed: int, events: int) -> Iterator[Draw]:
    """Plan hands that take over a weight; every third object is hit by a pin."""
    for i in range(events // 6):
        speed_m_s, max_margin = (0.08, 1.3) if i % 3 == 2 else (0.0, 2.0)
        yield partial(mix_signals.manipulation, design, seed + i, speed_m_s, max_margin)


def _plan(rng: np.random.Generator, trials: int, events: int) -> Iterator[tuple[str, SceneFile]]:
    slips = [scene for scene, _ in article_trials()]
    for i in range(trials):
        scene = slips[(7 * i) % len(slips)]  # 7 and the number of trials have no common factor
        # In every direction: no detector may lean on the sign of the shear.
        towards = str(rng.choice(list(DIRECTIONS)))
        scene = scene.model_copy(
            update={"slide": scene.slide.model_copy(update={"towards": towards})}
        )

        if rng.random() < 0.35:
            slide = scene.slide.model_copy(
                update={"acceleration_m_s2": float(rng.uniform(0.5, 8.0))}
            )
            scene = scene.model_copy(update={"slide": slide})

        if rng.random() < 0.5:
            scene = scene.model_copy(update={"pose": GRASP_POSE})

        pad = rng.random()
        if pad < WEAK_SHARE:
            surface = SurfaceTable(
                felt_um=math.exp(rng.uniform(math.log(WEAK_FELT_UM[0]), math.log(WEAK_FELT_UM[1])))
            )
            scene = scene.model_copy(update={"surface": surface})
        elif pad < WEAK_SHARE + AVERAGING_SHARE:
            contact = scene.contact.model_copy(update={"patch_average": True})
            scene = scene.model_copy(update={"contact": contact})

        yield "slip", scene

    for cause, (scene, share) in NEGATIVE_SCENES.items():
        if cause not in UNDECIDABLE:
            for _ in range(math.ceil(12 * trials * share / nominal_duration_s(cause))):
                yield cause, scene

    for _ in range(events):
        grows = bool(rng.random() < 0.5)
        hold = {
            "mode": "grasp",
            "min_force_n": 0.5 if grows else 1.3,
            "max_force_n": 1.5 if grows else 2.5,
        }
        by_n = float(rng.uniform(0.2, 1.5)) if grows else -float(rng.uniform(0.2, 1.2))
        rise_s = math.exp(rng.uniform(math.log(0.015), math.log(0.2)))
        yield (
            "grip change",
            SceneFile(
                scene="grip_change",
                pose=GRASP_POSE,
                hold=hold,
                load_change={"by_n": by_n, "rise_s": rise_s},
            ),
        )

    for _ in range(events // 2):
        hold = {
            "mode": "grasp",
            "min_force_n": 0.3,
            "max_force_n": 2.5,
            "close_s": float(rng.uniform(0.04, 0.25)),
            "release": bool(rng.random() < 0.5),
        }
        yield "fast closing", SceneFile(scene="fast_closing", pose=GRASP_POSE, hold=hold)

    for _ in range(events // 3):
        tap = {
            "force_n": math.exp(rng.uniform(math.log(0.2), math.log(3.0))),
            "rise_s": float(rng.uniform(0.002, 0.01)),
            "count": 3,
        }
        hold = {"mode": "grasp", "min_force_n": 0.5, "max_force_n": 2.0}
        yield (
            "tap",
            SceneFile(
                scene="taps",
                pose=GRASP_POSE,
                hold=hold,
                tap=tap,
            ),
        )

    for kind, draw in UNSTEADY.items():
        if kind not in EXCLUDED_FROM_TRAINING:
            yield from ((kind, draw(rng)) for _ in range(events // 10))
