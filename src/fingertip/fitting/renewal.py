"""Design of an earlier version, written anew: it begins from the nearest bundled design and keeps
the sizes that pass.

Skin, hand, interface, board, detector, printer and loads are those of the old file as far as the
rules allow, tried in halves down to single parameters. The bone behind them and the mold are those
of the bundled design, and its free lengths are fitted where a size of the old file needs it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.catalogues.file_kinds import DESIGN, find_file, list_bundled_files, read_file
from fingertip.design.design import Design
from fingertip.design.design_file import flatten, load_tables
from fingertip.design.fit import LEAST_LOADS, fit_lengths
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import load_retired, parse_tables
from fingertip.design.rules.ruleset import RuleChecker
from fingertip.design.search import RULES, cheapest_first
from fingertip.fitting.fitting import lower_loads
from fingertip.fitting.new_design import NewDesign
from fingertip.foundation.errors import DesignError, Issue, gather
from fingertip.foundation.progress import ShareText

_MADE_ANEW = (
    "mold.",
    "bone.base_",
    "bone.channel_",
    "bone.collar_",
    "bone.groove_",
    "bone.palmar_",
    "bone.platform_",
    "bone.rim_",
    "bone.wall_",
    "sensor.clearance_",
    "sensor.wire_",
    "skin.bonded",
    "skin.bump_",
)
"""Beginnings of parameters that are those of the bundled design:
its bone and its mold are other ones.
"""
_NEEDED = ("bone.interface", "sensor.model")
"""Parameters without which the new design is another thing."""
LEFT_OUT: tuple[tuple[str, ...], ...] = (
    (),
    (
        "bone.",
        "skin.crown_",
        "skin.semi_axis_palmar_",
        "skin.thickness_",
        "skin.pulp_",
        "sensor.distance_",
    ),
    ("bone.", "skin.", "sensor.distance_"),
    ("bone.", "skin.", "sensor.distance_", "strength."),
    ("bone.", "skin.", "sensor.distance_", "strength.", "hand."),
)
"""Beginnings of sizes that become those of the bundled design where a
check fails with them, tried in this order.
"""
_OLD_DEFAULTS = {
    "bone.post_width_mm": 8.4,
    "bone.post_height_mm": 7.2,
    "bone.post_length_mm": 8.0,
    "bone.foot_radius_mm": 1.5,
    "bone.cross_bolt_diameter_mm": 2.2,
    "skin.semi_axis_dorsal_mm": 7.0,
}
"""Sizes that an old file may leave out, where its default was another."""
_NOT_SIZES = ("silicone", "printer", "strength", "mold")
"""Tables of which an old file gives what it holds, and no defaults."""
_FITTED = ("sensor", "bone", "hand", "skin")
"""Tables whose sizes are worth a fit of the lengths that nobody measures."""
_SHORT = {"fsr400": "fsr400_short", "fsr402": "fsr402_short"}
"""Sensor -> that which takes its place where its tail was folded."""


@dataclass(frozen=True)
class Renewal:
    made: NewDesign
    old: Mapping[str, Any]
    """Parameter of the old design -> value, those that went included."""

    @property
    def changed(self) -> dict[str, tuple[Any, Any]]:
        """Parameter -> value in the old and in the new design, where they differ."""
        known = {
            name: was for name, was in self.old.items() if name not in (*load_retired(), "name")
        }
        return {
            name: (was, now)
            for name, was in known.items()
            if (now := self.made.design.value(name)) != was
        }

    @property
    def retired(self) -> list[str]:
        return [name for name in self.old if name in load_retired()]


def renew_design(
    name: str,
    file: str | Path,
    changes: Sequence[str] = (),
    left_out: tuple[str, ...] = (),
    progress: Callable[[str], None] = lambda message: None,
) -> Renewal:
    """Write a design file with the sizes of an old one, but for some of `LEFT_OUT`; `changes` are
    made to the new one.

    Raises DesignError.
    """
    stated = dict(flatten(read_file(find_file(file, DESIGN), DESIGN)))
    defaults = {
        path: field.default
        for path, field in PARAMETERS.items()
        if path.partition(".")[0] not in _NOT_SIZES
    }
    old = defaults | (_OLD_DEFAULTS if stated.keys() & load_retired().keys() else {}) | stated
    kept = {path: value for path, value in old.items() if path not in load_retired()} | {
        "name": name
    }
    if old.get("sensor.tail") == "folded":
        kept["sensor.model"] = _SHORT.get(old["sensor.model"], old["sensor.model"])

    wanted = parse_tables(DesignTables, load_tables([], kept).tables)
    base = min(list_bundled_files(DESIGN), key=lambda one: _measure_distance(wanted, one))
    tables = parse_tables(DesignTables, load_tables([base], changes).tables | {"name": name})
    fixed = tuple(path for path, _ in flatten(load_tables([], changes).tables))
    without = (*_MADE_ANEW, *fixed, *left_out)
    sizes = {
        path: wanted.value(path) for path in kept if path in _NEEDED or not path.startswith(without)
    }
    left = -1  # sizes that need another one first are tried again after it

    while left != len(
        rest := [(path, value) for path, value in sizes.items() if tables.value(path) != value]
    ):
        left = len(rest)
        tables = _adopt(tables, rest)

    tables = _fit(tables, sizes, fixed, progress)
    lighter = lower_loads(tables, [load for load in LEAST_LOADS if load not in fixed])
    return Renewal(NewDesign(Design(**lighter.tables.model_dump()), base, lighter.moves), stated)


def _measure_distance(wanted: DesignTables, base: str) -> tuple[bool, bool, float]:
    other = DesignTables(**load_tables([base], []).tables)
    differ = (
        wanted.value(path) != other.value(path) for path in ("bone.interface", "sensor.model")
    )
    return (*differ, abs(wanted.skin.width_mm - other.skin.width_mm))


def _adopt(tables: DesignTables, sizes: Sequence[tuple[str, Any]]) -> DesignTables:
    trial = tables.with_values(dict(sizes))
    if not any(True for _ in RuleChecker(trial).find_broken(cheapest_first(RULES))):
        return trial
    if len(sizes) < 2:
        return tables

    middle = len(sizes) // 2
    return _adopt(_adopt(tables, sizes[:middle]), sizes[middle:])


def _fit(
    tables: DesignTables,
    sizes: Mapping[str, Any],
    fixed: Sequence[str],
    progress: Callable[[str], None],
) -> DesignTables:
    """Fit the free lengths to sizes that the rules refuse with those of the bundled design.

    Raises DesignError.
    """
    rest = {
        path
        for path, value in sizes.items()
        if tables.value(path) != value and path.startswith(_FITTED)
    }
    needed = {path for path in rest if path in _NEEDED}
    issues: list[Issue] = []

    for some, kept in ((rest, {*sizes}), (needed, needed)):
        if not some:
            break

        trial = tables.with_values({path: sizes[path] for path in some})
        with gather(issues):
            return fit_lengths(
                trial,
                (*kept, *fixed),
                tables,
                progress=lambda share: progress(ShareText("fitting lengths", share)),
            ).tables

    if needed:
        raise DesignError(dict.fromkeys(issues))

    return tables
