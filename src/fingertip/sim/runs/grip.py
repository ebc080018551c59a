"""Grip law of the article's closed loop (III.C): hold, tighten on slip, discard what comes while
the forces grow.

The controller sees what a real one would see (`Observation`): sampled voltages and the fingers'
closing. Each finger has a detector, and the design's board converts its voltage back to a force. A
detection is suppressed while the forces grow fast, "assuming that, when the forces are growing,
slippage occurrence cannot happen" (IV.A). This suppresses contacts, and the vibration of the hand's
own motors while they close. A detection that is not suppressed makes every finger close further, by
what its pad needs to press harder by a fixed ratio. Then the law ignores detections until motors
and detectors have settled.

`GripLaw` is the law alone. The library for controllers has the same in C
(`firmware/c/slip_grip.c`): every number has the same bits, so times are whole microseconds.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.sim.runs.manipulation_plan import Observation
from fingertip.sim.signal.finger_curve import FingerCurve
from fingertip.slip.detectors.registry import find_detector_type, make_detector, select_inputs

LONGEST_STEP_S = 0.02
"""Time of a step that counts at most for the speed of a command [s]: a late step makes no jump."""
HISTORY = 16
"""Moments that are kept over the window of growth, at least a fifteenth of it apart."""


@dataclass(frozen=True)
class GripSettings:
    """Settings of the grip law.

    Times and ratios were chosen on the tuning seeds of `fingertip.lab.campaign.campaign`.
    """

    detector: str = "fast"
    threshold_scale: float = 1.0
    """Factor of the detector's threshold."""
    max_growth_n_s: float = 8.0
    """Growth of a finger's force above which detections are suppressed [N/s]: more than vibration
    appears to cause.
    """
    growth_window_s: float = 0.1
    max_closing_m_s: float = 0.005
    """Closing speed above which detections are suppressed [m/s]: the force grows with it, the motor
    vibrates.
    """
    suppression_s: float = 0.1
    """Time for which detections remain suppressed after growth or closing [s]: detectors have a
    memory.
    """
    force_ratio: float = 1.6
    """Factor by which every finger's force is increased at a detection."""
    refractory_s: float = 0.06
    """Time after an increase in which no other one follows [s]: until then the motors have begun to
    move.
    """
    max_force_n: float = 10.0
    """Force up to which detections tighten, as the pad's law predicts it and as it is measured [N].
    """
    max_command_m_s: float = 1.0
    """Speed at which a command grows [m/s]: a limit for motors that would jump.
    A soft hand's increase takes 7 mm.
    """
    max_added_m: float = 0.05
    """Closing that is added at most [m]: a finger that touches nothing, or whose motor stands
    still, would go on.
    """
    watchdog_s: float = 0.25
    """Time without a step after which nothing is known [s]: detections are suppressed as after
    growth.
    """


@dataclass(frozen=True)
class GripDecision:
    time_s: float
    detected: bool
    """True if any finger's detector was ON in the period."""
    suppressed: bool
    """True if a detection was, or would have been, suppressed."""
    tightened: bool
    """True if the fingers were commanded to close further."""


def _whole_us(seconds: float) -> int:
    return round(1e6 * seconds)


class GripLaw:
    """The law for some fingers, each with the curve of its sensor and pad, and its state."""

    def __init__(self, settings: GripSettings, curves: Sequence[FingerCurve]) -> None:
        self.settings = settings
        self.curves = tuple(curves)
        self.added_m = np.zeros(len(self.curves))
        """Closing that detections have added so far to what the hand plans [m]."""
        self._target_m = np.zeros(len(self.curves))
        self._history: deque[tuple[int, list[float], list[float]]] = deque(maxlen=HISTORY)
        self._last_us: int | None = None
        self._since_growth_us = self._since_tightening_us = math.inf

    def release(self) -> None:
        """Take back what was added, no faster than commands grow."""
        self._target_m = np.zeros(len(self._target_m))

    def step(
        self,
        now_us: int,
        detected: bool,
        volts: Sequence[float],
        closing_m: Sequence[float],
        usable: Sequence[bool] | None = None,
    ) -> tuple[bool, bool]:
        """Advance to a time [us].

        Return whether detections are suppressed, and whether the fingers tighten.

        A finger that is not usable, as with a broken wire, neither grows nor tightens. Units:
        `volts` [V], the mean tactile voltage of each finger since the last step; `closing_m` [m].
        """
        s = self.settings
        dt_us = 0 if self._last_us is None else now_us - self._last_us
        self._last_us = now_us
        is_late = dt_us > _whole_us(s.watchdog_s)
        if is_late:
            self._history.clear()

        self._since_growth_us += dt_us
        self._since_tightening_us += dt_us
        is_usable = [True] * len(volts) if usable is None else usable
        force = [curve.force_n(v) for curve, v in zip(self.curves, volts, strict=True)]
        window_us = _whole_us(s.growth_window_s)
        while self._history and now_us - self._history[0][0] > window_us:
            self._history.popleft()

        if not self._history or now_us - self._history[-1][0] >= window_us // (HISTORY - 1):
            self._history.append((now_us, force, list(closing_m)))

        then_us, force_then, closing_then = self._history[0]
        elapsed_s = 1e-6 * max(now_us - then_us, 1)
        is_growing = any(
            ok
            and (
                (f - f0) / elapsed_s > s.max_growth_n_s or (c - c0) / elapsed_s > s.max_closing_m_s
            )
            for ok, f, f0, c, c0 in zip(
                is_usable, force, force_then, closing_m, closing_then, strict=True
            )
        )
        if is_growing or is_late:
            self._since_growth_us = 0

        suppressed = self._since_growth_us <= _whole_us(s.suppression_s)
        is_refractory = self._since_tightening_us < _whole_us(s.refractory_s)
        tightened = detected and not suppressed and not is_refractory

        if tightened:
            self._since_tightening_us = 0
            further_m = [
                curve.further_m(f, s.force_ratio, s.max_force_n) if ok else 0.0
                for curve, ok, f in zip(self.curves, is_usable, force, strict=True)
            ]
            self._target_m = np.minimum(self._target_m + further_m, s.max_added_m)

        # In a hand that is stiffer than assumed the measured force comes to its limit first: go no
        # further.
        is_full = np.array(force) >= s.max_force_n
        self._target_m = np.where(is_full, np.minimum(self._target_m, self.added_m), self._target_m)
        max_step_m = (
            0.0 if is_late else s.max_command_m_s * (1e-6 * min(dt_us, _whole_us(LONGEST_STEP_S)))
        )
        self.added_m = np.clip(self._target_m, self.added_m - max_step_m, self.added_m + max_step_m)

        return suppressed, tightened


class GripController:
    """Hand with a detector for each finger, and the law."""

    def __init__(self, design: Design, settings: GripSettings, fingers: int) -> None:
        self.settings = settings
        self.decisions: list[GripDecision] = []
        self._detectors = [
            make_detector(settings.detector, design, threshold_scale=settings.threshold_scale)
            for _ in range(fingers)
        ]
        self.law = GripLaw(settings, [FingerCurve.from_design(design)] * fingers)

    def step(self, observation: Observation) -> Array:
        """Return the commanded closing [m]: the planned closing, and what detections have added to
        it.
        """
        kind = self.settings.detector
        now = observation.time_s
        samples = select_inputs(observation, kind)
        assert samples, (
            f"the scene's outputs do not include {find_detector_type(kind).input_column}"
        )
        # Every detector must process every sample, even if the first one is already ON.
        on = [
            bool(detector.process(*rows).on.any())
            for detector, *rows in zip(self._detectors, *samples, strict=True)
        ]
        volts = [float(v.mean()) for v in observation.voltage_v]
        suppressed, tightened = self.law.step(
            _whole_us(now), any(on), volts, observation.closing_m.tolist()
        )
        self.decisions.append(GripDecision(now, any(on), suppressed, tightened))

        return np.asarray(observation.planned_m + self.law.added_m)
