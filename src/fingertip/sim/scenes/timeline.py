"""When everything in a scene happens, and the two motions that follow: the hand's force, the stage's way.

Only sums, products, square and cube roots are used, so that every processor gives the same bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.contact.pad import Pad
from fingertip.sim.scenes.scene import APPROACH_M, LIFT_M, LIFT_S, Ramp
from fingertip.sim.scenes.scene_file import SceneFile

OPEN_S = 0.3
"""An open grasp is recorded for this long before it closes. Assumption."""


@dataclass(frozen=True)
class Timeline:
    """A scene's moments [s] and ramps."""

    scene: SceneFile
    force_n: float
    """Holding force on this finger."""
    held_s: float
    """When that force is reached."""
    release_s: float
    duration_s: float
    slide: Ramp | None
    approach: Ramp | None
    lift: Ramp | None

    def load_n(self, pad: Pad, time_s: Array) -> Array:
        """Quasi-static normal force [N]."""
        hold, change = self.scene.hold, self.scene.load_change
        if self.approach:
            depth = self.approach.position_m(time_s) - APPROACH_M
            load = pad.force_n(depth - self.lift.position_m(time_s) if self.lift else depth)
        else:
            load = self.force_n * rise((time_s - OPEN_S) / hold.close_s)
            if hold.release:
                load = load - self.force_n * rise((time_s - self.release_s) / hold.close_s)
        if change.by_n:
            # As a share of the force, so that it ends with the contact.
            load = load * (1 + change.by_n / self.force_n * rise((time_s - self.held_s - change.at_s) / change.rise_s))
        return np.maximum(load, 0.0)


def rise(x: Array) -> Array:
    """From 0 at 0 to 1 at 1, flat at both ends: ``x^2 (3 - 2 x)``."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3 - 2 * x)


def plan(scene: SceneFile, pad: Pad, force_n: float) -> Timeline:
    """The moments of a scene whose holding force on this finger is `force_n` [N]."""
    hold, slide = scene.hold, scene.slide
    approach = None
    held = OPEN_S + hold.close_s
    if hold.mode == "press":
        # Down as fast as up (assumption; the article gives the lift's time only).
        approach = Ramp.at(0.0, APPROACH_M + pad.depth_m(force_n), Ramp.within(0.0, LIFT_M, LIFT_S).peak_m_s)
        held = approach.end_s
    way = Ramp.at(held + hold.wait_s, slide.distance_m, slide.speed_m_s, slide.acceleration_m_s2)
    sliding = way if slide.distance_m else None
    busy = max(held + hold.min_s, sliding.end_s if sliding else held, held + _events_s(scene))
    release = busy + hold.wait_s
    lift = Ramp.within(release, LIFT_M, LIFT_S) if hold.release and approach else None
    end = lift.end_s if lift else release + (hold.close_s if hold.release else 0.0)
    return Timeline(scene, force_n, held, release, end + hold.after_s, sliding, approach, lift)


def _events_s(scene: SceneFile) -> float:
    """How long after the force is reached the last event ends [s]."""
    change, tap, motor, cable = scene.load_change, scene.tap, scene.motor, scene.cable
    ends = [0.0]
    if change.by_n:
        ends.append(change.at_s + change.rise_s)
    if tap.force_n:
        ends.append(tap.at_s + (tap.count - 1) * tap.interval_s + 2 * tap.rise_s)
    if motor.force_n:
        ends.append(motor.at_s + motor.duration_s)
    if cable.step_v or cable.hum_v:
        ends.append(cable.at_s + cable.duration_s)
    return max(ends)
