"""Outputs that a sweep can compute for a point, and the groups in which they are computed.

All outputs of a group come from one computation. A group is computed only if the sweep asks for one
of its outputs, and again only if a table that it reads has changed. This module imports nothing
heavy; the computations themselves are in `fingertip.sweep.compute`.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fingertip.catalogues.electronics import split_finger
from fingertip.design.parameters.declaration import describe_retired, load_retired, suggest_name
from fingertip.foundation.errors import Issue
from fingertip.foundation.tables import load_table, read_rows

FINGER = frozenset({"sensor", "custom_sensor", "bone", "hand", "skin"})
CLOSED_MOLD = FINGER | {"mold"}
MOLD = CLOSED_MOLD | {"printer"}
"""Tables that define the mold around the cavity, whose walls are as thick as the printer needs, and
the play in it.
"""
PARTS = MOLD | {"name", "strength", "silicone"}
"""Tables that the checks of the printed parts read: the mold halves carry the design's name, and
the printer's scale and limits, the loads and the silicone decide on the checks.
"""
PAD = MOLD | {"silicone", "force_curve"}
"""Tables that the pad depends on.
How a skin that is made apart fits depends on mold and printer.
"""
SIMULATION = PAD | {"board", "detector"}


@dataclass(frozen=True)
class OutputGroup:
    """Outputs that one computation gives together."""

    name: str
    reads: frozenset[str]
    """Tables of the design that the outputs can depend on; `scene` stands for the scene."""
    cost: int
    """Rank by computing time. Axes that expensive groups read vary slowest."""
    ignores: frozenset[str] = frozenset()
    """Parameters of those tables, dotted, that the outputs do not depend on."""

    def depends_on(self, parameter: str) -> bool:
        """Return whether the outputs can change with a parameter, dotted."""
        finger, path = split_finger(parameter)
        # Any parameter of one finger may part it from its form, which then takes a mold of its own.
        return bool(finger) or (path.partition(".")[0] in self.reads and path not in self.ignores)


GROUPS = {
    group.name: group
    for group in (
        OutputGroup("lengths", MOLD, 0),
        OutputGroup("board", frozenset({"board", "detector", "sensor", "custom_sensor"}), 1),
        OutputGroup("controller", frozenset({"detector"}), 1),
        OutputGroup("acceptance", SIMULATION, 1),
        OutputGroup("noise", frozenset({"board", "detector"}), 1),
        OutputGroup("pad", PAD, 1),
        OutputGroup("circuit", frozenset({"board", "detector", "sensor", "custom_sensor"}), 1),
        OutputGroup("detection", SIMULATION | {"scene"}, 2),
        OutputGroup("skin", CLOSED_MOLD, 4),
        OutputGroup("bone", CLOSED_MOLD, 4),
        OutputGroup("mold", MOLD | {"name"}, 4),
        OutputGroup("strength", CLOSED_MOLD | {"strength"}, 4),
        OutputGroup("core", MOLD | {"name", "silicone", "strength"}, 5),
        OutputGroup("walls", MOLD, 5),
        OutputGroup("printing", MOLD | {"name"}, 5),
        OutputGroup("casting", MOLD | {"name", "silicone"}, 5),
        OutputGroup("checks", PARTS, 6),
        OutputGroup("set", PARTS, 6),
        OutputGroup("set_checks", PARTS, 7),
    )
}
"""Group name -> group, from the cheapest to the most expensive."""
SET_GROUPS = ("set", "set_checks")
"""Groups of outputs of a whole set; the others are of one finger."""

TRACES = OutputGroup(
    "traces",
    SIMULATION | {"scene"},
    3,
    frozenset({"detector.window_samples", "detector.threshold_v"}),
)
"""Simulated trials, which points share that differ in the detector's window or threshold only."""


@dataclass(frozen=True)
class SweepOutput:
    """Number that a sweep can compute for a point."""

    name: str
    """Name with the unit."""
    group: str
    description: str


@functools.cache
def load_outputs() -> dict[str, SweepOutput]:
    """Load all outputs: name -> output, in the order of `outputs.csv`."""
    rows = read_rows(Path(__file__).with_name("outputs.csv"))
    return {output.name: output for output in load_table(SweepOutput, rows)}


def find_groups(outputs: Iterable[str]) -> tuple[OutputGroup, ...]:
    """Find the groups that give these outputs, each once, cheapest first."""
    names = {load_outputs()[name].group for name in outputs}
    return tuple(group for group in GROUPS.values() if group.name in names)


def check_outputs(names: Sequence[str], is_set: bool) -> list[Issue]:
    """Find outputs that are unknown or listed twice, and else those that cannot be computed for a
    set, or a finger.
    """
    retired = [name for name in dict.fromkeys(names) if name in load_retired()]
    issues = [Issue("outputs", issue.typed) for issue in describe_retired(retired)]

    for name in dict.fromkeys(names):
        if name in retired:
            continue

        if name not in load_outputs():
            suggestion = suggest_name(name.lower(), tuple(load_outputs()))
            remedy = (
                suggestion
                if suggestion.startswith("did you mean")
                else "see fingertip sweep --outputs."
            )
            issues.append(Issue("outputs", f"{name!r} is not an output; {remedy}"))
        elif names.count(name) > 1:
            issues.append(
                Issue("outputs", f"{name!r} is listed {names.count(name)} times; list it once.")
            )

    if issues:
        return issues

    misplaced = [name for name in names if (load_outputs()[name].group in SET_GROUPS) != is_set]
    subject = "one finger"
    subject_given = "a set"
    remedy = 'a design, such as design = "adult_finger"'

    if not is_set:
        subject = "a set"
        subject_given = "one finger"
        remedy = 'a set, such as design = "adult_hand"'

    text = f"{', '.join(misplaced)} can be computed for {subject}, but design is {subject_given}"
    issue = Issue("outputs", f"{text}; leave out what cannot be computed, or name {remedy}.")
    return [issue] if misplaced else []
