"""Pose of a scene: how the finger lies on the object, what a seed draws of it, and poses that cannot be."""

from __future__ import annotations

import random
from collections.abc import Iterator

from fingertip.design.parameters import ParameterTable, choice, quantity
from fingertip.foundation.errors import Issue, TraceError
from fingertip.pad.form import PadForm
from fingertip.pad.layer import bring, is_possible
from fingertip.pad.pose import ObjectShape, Pose
from fingertip.pad.response import REFERENCE_POSE
from fingertip.sim.signal.parameters import assumption

_STEPS = 10
"""Steps in which a pose that cannot be is moved towards one that can."""
_GOAL = {"tilt_deg": REFERENCE_POSE.tilt_deg, "roll_deg": 0.0, "place_mm": 0.0}
"""Pose towards which it is moved: that of the article's trials."""


class ScenePose(ParameterTable):
    """Pose of the finger on the object: what part of the force reaches the sensor depends on it."""

    tilt_deg: float = assumption(
        REFERENCE_POSE.tilt_deg, "deg", (-10, 30), "Tilt, tip down; 0: the pad's straight part lies flat."
    )
    tilt_spread_deg: float = quantity(0.0, "deg", (0, 20), "Half width of the range of tilts that the seed draws.")
    roll_deg: float = quantity(0.0, "deg", (-20, 20), "Roll about the axis of the finger.")
    roll_spread_deg: float = quantity(0.0, "deg", (0, 20), "Half width of the range of rolls that the seed draws.")
    object: ObjectShape = choice("plate", "Object under the pad; a cylinder or an edge lies across the finger.")
    radius_mm: float = quantity(20.0, "mm", (1, 500), "Radius of a cylinder or a sphere.")
    place_mm: float = quantity(0.0, "mm", (-15, 15), "Distance from the sensor, distal, at which it stands.")

    def find_issues(self, form: PadForm) -> Iterator[Issue]:
        """Yield why the middle of the poses cannot be, with values nearer to the goal that can."""
        if is_possible(form, self._turned(0.0, 0.0)):
            return
        try:
            bring(form, self._turned(0.0, 0.0))
        except TraceError as error:
            (issue,) = error.issues
            for step in range(1, _STEPS + 1):
                share = step / _STEPS
                new = {name: round((1 - share) * getattr(self, name) + share * goal, 1) for name, goal in _GOAL.items()}
                if is_possible(form, self.model_copy(update=new)._turned(0.0, 0.0)):
                    changes = [f"pose.{name}={value:g}" for name, value in new.items() if value != getattr(self, name)]
                    yield Issue(issue.field, f"{issue.message.split(';')[0]}; set {' and '.join(changes)}.")
                    return
            yield issue

    def draw(self, form: PadForm, seed: int) -> Pose:
        """Draw a pose; the part of the way from the middle is shortened until the pose can be."""
        rng = random.Random(f"{seed}:pose")
        tilt, roll = (spread * (2.0 * rng.random() - 1.0) for spread in (self.tilt_spread_deg, self.roll_spread_deg))
        poses = (self._turned(share * tilt, share * roll) for share in (1.0, 0.8, 0.6, 0.4, 0.2))
        return next((pose for pose in poses if is_possible(form, pose)), self._turned(0.0, 0.0))

    def _turned(self, tilt_deg: float, roll_deg: float) -> Pose:
        """Return the pose at angles from the middle; drawn angles are whole, so that a campaign meets few poses."""
        tilt, roll = self.tilt_deg + tilt_deg, self.roll_deg + roll_deg
        is_round, is_plate = self.object in ("cylinder", "sphere"), self.object == "plate"
        return Pose(
            float(round(tilt)) if self.tilt_spread_deg else tilt, float(round(roll)) if self.roll_spread_deg else roll,
            self.object, self.radius_mm if is_round else 0.0, 0.0 if is_plate else self.place_mm,
        )  # fmt: skip


GRASP_POSE = ScenePose(tilt_deg=5.0, tilt_spread_deg=10.0, roll_spread_deg=10.0)
"""Poses in which a grasp meets its object. Assumption: the range in which the pad of fsr400 feels."""
