"""Pose and mount of a scene's finger: how it lies on the object, what a seed draws of that, and
what holds it.

Each kind of mount has its figures with their source. A scene selects one, and may replace any of
its figures.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal

from fingertip.design.parameters import ParameterTable, choice, quantity
from fingertip.foundation.errors import Issue, TraceError
from fingertip.pad.layer import bring, is_possible
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import REFERENCE_POSE, Backing
from fingertip.pad.touch import ObjectShape, Pose
from fingertip.sim.signal.parameters import assumption

_STEPS = 10
"""Steps in which a pose that cannot be is moved towards one that can."""
_GOAL = {"tilt_deg": REFERENCE_POSE.tilt_deg, "roll_deg": 0.0, "place_mm": 0.0}
"""Pose towards which it is moved: that of the article's trials."""


class ScenePose(ParameterTable):
    """Pose of the finger on the object: what part of the force reaches the sensor depends on it."""

    tilt_deg: float = assumption(
        REFERENCE_POSE.tilt_deg,
        "deg",
        (-10, 30),
        "Tilt, tip down; 0: the pad's straight part lies flat.",
    )
    tilt_spread_deg: float = quantity(
        0.0, "deg", (0, 20), "Half width of the range of tilts that the seed draws."
    )
    roll_deg: float = quantity(0.0, "deg", (-20, 20), "Roll about the axis of the finger.")
    roll_spread_deg: float = quantity(
        0.0, "deg", (0, 20), "Half width of the range of rolls that the seed draws."
    )
    object: ObjectShape = choice(
        "plate", "Object under the pad; a cylinder or an edge lies across the finger."
    )
    radius_mm: float = quantity(20.0, "mm", (1, 500), "Radius of a cylinder or a sphere.")
    place_mm: float = quantity(
        0.0, "mm", (-15, 15), "Distance from the sensor, distal, at which it stands."
    )

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
                new = {
                    name: round((1 - share) * getattr(self, name) + share * goal, 1)
                    for name, goal in _GOAL.items()
                }
                if is_possible(form, self.model_copy(update=new)._turned(0.0, 0.0)):
                    changes = [
                        f"pose.{name}={value:g}"
                        for name, value in new.items()
                        if value != getattr(self, name)
                    ]
                    yield Issue(
                        issue.field, f"{issue.message.split(';')[0]}; set {' and '.join(changes)}."
                    )
                    return

            yield issue

    def draw(self, form: PadForm, seed: int) -> Pose:
        """Draw a pose; the part of the way from the middle is shortened until the pose can be."""
        rng = random.Random(f"{seed}:pose")
        tilt, roll = (
            spread * (2.0 * rng.random() - 1.0)
            for spread in (self.tilt_spread_deg, self.roll_spread_deg)
        )
        poses = (self._turned(share * tilt, share * roll) for share in (1.0, 0.8, 0.6, 0.4, 0.2))

        return next((pose for pose in poses if is_possible(form, pose)), self._turned(0.0, 0.0))

    def _turned(self, tilt_deg: float, roll_deg: float) -> Pose:
        """Return the pose at angles from the middle.

        Drawn angles are whole, so that a campaign meets few poses.
        """
        tilt = self.tilt_deg + tilt_deg
        roll = self.roll_deg + roll_deg
        is_round = self.object in ("cylinder", "sphere")
        is_plate = self.object == "plate"

        return Pose(
            tilt_deg=float(round(tilt)) if self.tilt_spread_deg else tilt,
            roll_deg=float(round(roll)) if self.roll_spread_deg else roll,
            object=self.object,
            radius_mm=self.radius_mm if is_round else 0.0,
            place_mm=0.0 if is_plate else self.place_mm,
        )


GRASP_POSE = ScenePose(tilt_deg=5.0, tilt_spread_deg=10.0, roll_spread_deg=10.0)
"""Poses in which a grasp meets its object.
Assumption: the range in which the pad of fsr400 feels.
"""
MOUNTS: Mapping[str, Backing] = {
    # Mass: assumption. Stiffness: article, III.C.
    "robot_arm": Backing(),
    # Assumptions: a finger of 30 g whose tendon gives 1 mm under 1 N. No published figure was
    # found.
    "prosthetic_hand": Backing(mass_kg=0.03, stiffness_n_per_m=1000.0),
    # A. Z. Hajian, R. D. Howe, J. Biomech. Eng. 119, 1997: some grams on 100 to 1000 N/m, both by
    # order of magnitude only (unverified). The damping is the largest that a scene allows: a finger
    # is close to critically damped.
    "human_hand": Backing(mass_kg=0.006, stiffness_n_per_m=500.0, damping_ratio=0.8),
    # Assumptions: finger and clamp on a stiff load cell.
    "bench": Backing(mass_kg=0.05, stiffness_n_per_m=50_000.0),
}
"""Kind -> what holds the finger."""


class MountTable(ParameterTable):
    """Mount of the finger; 0 keeps the figure of its kind."""

    kind: Literal["robot_arm", "prosthetic_hand", "human_hand", "bench"] = choice(
        "robot_arm",
        "robot_arm: as in the article's trials; prosthetic_hand, human_hand, or bench: a clamped "
        "finger.",
    )
    mass_kg: float = quantity(0.0, "kg", (0, 2), "Mass that moves with the finger.")
    stiffness_n_per_m: float = quantity(0.0, "N/m", (0, 100_000), "Stiffness behind this mass.")
    damping_ratio: float = quantity(0.0, "", (0, 0.8), "Damping ratio of this mass on the pad.")

    @property
    def backing(self) -> Backing:
        changed = {name: value for name, value in self if name != "kind" and value}
        return replace(MOUNTS[self.kind], **changed)

    def find_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each figure too small to be computed in seconds and exactly, with the name of its
        parameter.
        """
        for name, least, unit in (("mass_kg", 1e-4, "kg"), ("stiffness_n_per_m", 10.0, "N/m")):
            value = getattr(self, name)
            if 0.0 < value < least:
                message = (
                    f"{value:g} {unit} is too small to compute; at least {least:g} {unit}, "
                    "or 0 for mount.kind's."
                )
                yield Issue(f"mount.{name}", message), {f"mount.{name}"}
