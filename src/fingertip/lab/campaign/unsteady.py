"""Random scenes of hands that are not steady, for training and for the report: each function draws one kind.

Bands of tremor: G. G. Sutton, K. Sykes, J. Physiol. 191, 1967 (a peak at 8 to 10 Hz). Force variation of able fingers:
H. S. Baweja et al., Exp. Brain Res. 197, 2009 (4.5 +- 3.1 % of the force); most of it lies below 4 Hz. Play of servos:
makers and users state 0.25 degrees (brushless) to 1 degree (hobby), which at a finger of 30 mm on the 90 N/m of the
article's hand are 12 to 47 mN. A walker makes 1.7 steps a second (J. K. Urbanek et al., 2018). All other ranges are
assumptions: nothing was found on stumps, on the duration of a servo's step, on setting down, and on the blow of a step
at the hand.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from fingertip.sim import SceneFile
from fingertip.sim.runs.files import DIRECTIONS
from fingertip.sim.runs.pose import GRASP_POSE, ScenePose

_HOLD = {"mode": "grasp", "min_force_n": 0.5, "max_force_n": 2.0}


def _uniform(rng: np.random.Generator, low: float, high: float, digits: int = 6) -> float:
    return round(float(rng.uniform(low, high)), digits)


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return round(math.exp(rng.uniform(math.log(low), math.log(high))), 6)


def _draw_tremor(rng: np.random.Generator, share: tuple[float, float], slow_share: tuple[float, float]) -> SceneFile:
    tremor = {
        "share": _log_uniform(rng, *share),
        "frequency_hz": _uniform(rng, 8.0, 12.0),
        "voluntary_share": _uniform(rng, *slow_share),
        "voluntary_hz": _uniform(rng, 0.5, 2.5),
    }
    return SceneFile(scene="tremor", pose=GRASP_POSE, hold={**_HOLD, "min_s": 4.0}, tremor=tremor)


_draw_stump = partial(_draw_tremor, share=(0.01, 0.05), slow_share=(0.05, 0.15))


def _draw_servo(rng: np.random.Generator, step_n: tuple[float, float], rise_s: tuple[float, float]) -> SceneFile:
    servo = {
        "step_n": _log_uniform(rng, *step_n), "rise_s": _uniform(rng, *rise_s), "interval_s": _uniform(rng, 0.2, 1.0),
    }  # fmt: skip
    return SceneFile(scene="servo_steps", pose=GRASP_POSE, hold={**_HOLD, "min_s": 3.0}, servo=servo)


def _draw_set_down(rng: np.random.Generator) -> SceneFile:
    change = {"by_n": -_uniform(rng, 0.2, 0.8), "rise_s": _uniform(rng, 0.005, 0.02)}
    return SceneFile(scene="set_down", pose=GRASP_POSE, hold={**_HOLD, "min_force_n": 1.0}, load_change=change)


def _draw_walk(rng: np.random.Generator) -> SceneFile:
    tap = {
        "force_n": _log_uniform(rng, 0.05, 0.5), "rise_s": _uniform(rng, 0.02, 0.06), "count": 6,
        "interval_s": _uniform(rng, 0.5, 0.7),
    }  # fmt: skip
    tremor = {"voluntary_share": _uniform(rng, 0.02, 0.1), "voluntary_hz": round(1 / tap["interval_s"], 3)}
    return SceneFile(scene="walking", pose=GRASP_POSE, hold=_HOLD, tap=tap, tremor=tremor)


def _draw_edge(rng: np.random.Generator) -> SceneFile:
    pose = ScenePose(tilt_deg=5.0, object="edge", place_mm=_uniform(rng, 0.0, 3.0, 1))
    scene = _draw_stump(rng)
    return scene.model_copy(update={"scene": "edge_contact", "pose": pose})


def _draw_slip_after_ramp(rng: np.random.Generator) -> SceneFile:
    rise_s = _log_uniform(rng, 0.02, 0.2)
    sign = 1.0 if rng.random() < 0.5 else -1.0
    change = {"by_n": sign * _uniform(rng, 0.2, 0.7), "rise_s": rise_s, "at_s": round(1.0 - rise_s, 6)}
    hold, slide = {**_HOLD, "min_force_n": 1.0}, _draw_slide(rng, 0.02)
    return SceneFile(scene="slip_after_ramp", pose=GRASP_POSE, hold=hold, load_change=change, slide=slide)


def _draw_pauses(rng: np.random.Generator) -> SceneFile:
    slide = _draw_slide(rng, 0.04) | {"moves": int(rng.integers(2, 6)), "pause_s": _uniform(rng, 0.1, 0.5)}
    return SceneFile(scene="slips_with_pauses", pose=GRASP_POSE, hold=_HOLD, slide=slide)


def _draw_slide(rng: np.random.Generator, distance_m: float) -> dict[str, Any]:
    towards = tuple(DIRECTIONS)[int(rng.integers(len(DIRECTIONS)))]
    return {"distance_m": distance_m, "speed_m_s": _uniform(rng, 0.03, 0.08), "towards": towards}


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
"""Kinds that the detector `fast` was not fitted to: each of their steps looks like the start of a slip."""
