"""The article's closed loop (III.C, figures 16 and 17): a grip that grows when slip is claimed, and only then.

The controller is handed what a real one would be (`fingertip.sim.Seen`): sampled voltages and the fingers' closing. On
each finger runs a detector, and the voltage is read back as a force by the design's bridge. A claim of slip is
discarded while the forces grow fast, "assuming that, when the forces are growing, slippage occurrence cannot happen"
(IV.A): so are contacts, and the shaking of the hand's own motors as they close. What is left makes every finger close
further, by what its pad needs to press that much harder; then the grip rests until motors and detectors have settled.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.sim import Seen
from fingertip.sim.contact.pad import Pad
from fingertip.sim.electronics.board_output import bridge_v
from fingertip.slip import DETECTORS, make

_TABLE_N = np.concatenate((np.linspace(0.0, 2.0, 401), np.linspace(2.05, 20.0, 360)))


@dataclass(frozen=True)
class GripSettings:
    """The grip law. Times and ratios were chosen on the tuning seeds of `fingertip.campaign.plan`."""

    detector: str = "fast"
    grows_n_s: float = 8.0
    """Growth of a finger's force that discards claims [N/s]: above what vibration feigns."""
    growth_s: float = 0.1
    """Over which the growth is taken [s]."""
    closes_m_s: float = 0.005
    """Closing of a finger that discards claims [m/s]: the force grows with it, or is about to, and its motor shakes."""
    calm_s: float = 0.1
    """For how long after either claims are still discarded [s]: detectors remember."""
    firmer: float = 1.6
    """Factor on every finger's force at a claim that is believed."""
    rest_s: float = 0.06
    """Until the motors have begun to follow, no other claim is believed [s]."""
    max_n: float = 10.0
    """No finger is told to press harder than this."""


@dataclass(frozen=True)
class Look:
    """What the grip made of one period."""

    time_s: float
    claimed: bool
    """Whether any finger's detector was ON in it."""
    discarded: bool
    """Whether a claim was, or would have been, discarded."""
    gripped: bool
    """Whether the fingers were told to close further."""


class Grip:
    """The controller with its state: one for one manipulation."""

    def __init__(self, design: Design, settings: GripSettings, fingers: int) -> None:
        self.settings = settings
        self.looks: list[Look] = []
        self._pad = Pad.of(design)
        self._detectors = [make(settings.detector, design) for _ in range(fingers)]
        self._reads = DETECTORS[settings.detector].reads
        volts = bridge_v(design, _TABLE_N)
        self._volts, self._forces = volts[::-1], _TABLE_N[::-1]  # voltage falls with force
        self._history: deque[tuple[float, Array]] = deque()
        self._grew_s = -math.inf
        self._gripped_s = -math.inf
        self._further = np.zeros(fingers)

    def step(self, seen: Seen) -> Array:
        """The planned closing, and what was added to it."""
        s, now = self.settings, seen.time_s
        samples: Array | None = getattr(seen, self._reads)
        assert samples is not None, f"the scene's outputs do not name {self._reads}"
        claimed = self._claimed(samples)
        force = np.array([float(np.interp(v.mean(), self._volts, self._forces)) for v in seen.voltage_v])
        self._history.append((now, np.array([force, seen.closing_m])))
        while self._history[0][0] < now - s.growth_s - 1e-9:
            self._history.popleft()
        then, before = self._history[0]
        grown, closed = (np.array([force, seen.closing_m]) - before) / max(now - then, 1e-9)
        if float(np.max(grown)) > s.grows_n_s or float(np.max(closed)) > s.closes_m_s:
            self._grew_s = now
        resting = now < self._gripped_s + s.rest_s
        discarded = now <= self._grew_s + s.calm_s
        gripped = claimed and not discarded and not resting
        if gripped:
            self._gripped_s = now
            self._further += [self._yield_m(f) for f in force]
        self.looks.append(Look(now, claimed, discarded, gripped))
        return np.asarray(seen.planned_m + self._further)

    def _yield_m(self, force_n: float) -> float:
        """How much further a finger closes to press that much harder [m]."""
        minimum = max(force_n, 0.1)
        return self._pad.depth_m(min(minimum * self.settings.firmer, self.settings.max_n)) - self._pad.depth_m(minimum)

    def _claimed(self, samples: Array) -> bool:
        """Whether any finger's detector was ON at any of the new samples."""
        # all of them, though one may be enough: each must see every sample
        claims = [bool(one.process(row).on.any()) for one, row in zip(self._detectors, samples, strict=True)]
        return any(claims)
