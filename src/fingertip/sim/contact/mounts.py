"""Mounts of a finger: the mass that moves with it, on the stiffness of a robot arm, a hand or a bench.

Each kind has its figures with their source. A scene selects one, and may replace any of its figures.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal

from fingertip.design.parameters import ParameterTable, choice, quantity
from fingertip.foundation.errors import Issue
from fingertip.pad.response import Backing

MOUNTS: Mapping[str, Backing] = {
    # Mass: assumption. Stiffness: article, III.C.
    "robot_arm": Backing(),
    # Assumptions: a finger of 30 g whose tendon gives 1 mm under 1 N. No published figure was found.
    "prosthetic_hand": Backing(mass_kg=0.03, stiffness_n_per_m=1000.0),
    # A. Z. Hajian, R. D. Howe, J. Biomech. Eng. 119, 1997: some grams on 100 to 1000 N/m, both by order of magnitude
    # only (unverified). The damping is the largest that a scene allows: a finger is close to critically damped.
    "human_hand": Backing(mass_kg=0.006, stiffness_n_per_m=500.0, damping_ratio=0.8),
    # Assumptions: finger and clamp on a stiff load cell.
    "bench": Backing(mass_kg=0.05, stiffness_n_per_m=50_000.0),
}
"""Kind -> what holds the finger."""


class MountTable(ParameterTable):
    """Mount of the finger; 0 keeps the figure of its kind."""

    kind: Literal["robot_arm", "prosthetic_hand", "human_hand", "bench"] = choice(
        "robot_arm", "robot_arm: as in the article's trials; prosthetic_hand, human_hand, or bench: a clamped finger."
    )
    mass_kg: float = quantity(0.0, "kg", (0, 2), "Mass that moves with the finger.")
    stiffness_n_per_m: float = quantity(0.0, "N/m", (0, 100_000), "Stiffness behind this mass.")
    damping_ratio: float = quantity(0.0, "", (0, 0.8), "Damping ratio of this mass on the pad.")

    @property
    def backing(self) -> Backing:
        changed = {name: value for name, value in self if name != "kind" and value}
        return replace(MOUNTS[self.kind], **changed)

    def find_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each figure too small to be computed in seconds and exactly, with the name of its parameter."""
        for name, least, unit in (("mass_kg", 1e-4, "kg"), ("stiffness_n_per_m", 10.0, "N/m")):
            if 0.0 < (value := getattr(self, name)) < least:
                message = f"{value:g} {unit} is too small to compute; at least {least:g} {unit}, or 0 for mount.kind's."
                yield Issue(f"mount.{name}", message), {f"mount.{name}"}
