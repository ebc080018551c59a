"""Renewal of a design of an earlier version: the new one begins from the nearest bundled one, and
takes the old sizes that pass.

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
    "skin.made",
    "skin.bump_",
)
"""Beginnings of the parameters that stay those of the bundled design: bone and mold are new."""
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
"""Beginnings of sizes that are left to the bundled design if a check fails with the old ones.
They are tried in this order.
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
"""Tables of which only stated values are taken from an old file, no defaults."""
_FITTED = ("sensor", "bone", "hand", "skin")
"""Tables whose sizes are worth a fit of the lengths that nobody measures."""
_SHORT = {"fsr400": "fsr400_short", "fsr402": "fsr402_short"}
"""Sensor -> the one with a short tail that replaces it if its tail was folded."""


@dataclass(frozen=True)
class Renewal:
    """New design that replaces one of an earlier version."""

    made: NewDesign
    old: Mapping[str, Any]
    """Parameter of the old design -> value, retired ones included."""

    @property
    def changed(self) -> dict[str, tuple[Any, Any]]:
        """Parameter -> value in the old and in the new design, where they differ."""
        changed = {}
        for name, before in self.old.items():
            if name not in (*load_retired(), "name"):
                after = self.made.design.value(name)
                if after != before:
                    changed[name] = (before, after)

        return changed

    @property
    def retired(self) -> list[str]:
        """Parameters of the old design that no longer exist."""
        return [name for name in self.old if name in load_retired()]


def renew_design(
    name: str,
    file: str | Path,
    changes: Sequence[str] = (),
    left_out: tuple[str, ...] = (),
    progress: Callable[[str], None] = lambda message: None,
) -> Renewal:
    """Design a finger with the sizes of an old design file.

    `changes` are made to the new design, and sizes that begin as `left_out` are those of the
    bundled design. Raises DesignError.
    """
    stated = dict(flatten(read_file(find_file(file, DESIGN), DESIGN)))
    old_values = _complete_old(stated) | {"name": name}
    old = parse_tables(DesignTables, load_tables([], old_values).tables)
    base = min(list_bundled_files(DESIGN), key=lambda bundled: _measure_distance(old, bundled))

    tables = parse_tables(DesignTables, load_tables([base], changes).tables | {"name": name})
    fixed = tuple(path for path, _ in flatten(load_tables([], changes).tables))
    if old.bone.interface != "post" and "skin.made" not in fixed:
        tables = tables.with_values({"skin.made": "cast"})  # no other bone hangs in a holder

    not_taken = (*_MADE_ANEW, *fixed, *left_out)
    sizes = {
        path: old.value(path)
        for path in old_values
        if path in _NEEDED or not path.startswith(not_taken)
    }
    tables = _fit(_adopt_all(tables, sizes), sizes, fixed, progress)
    lowered = lower_loads(tables, [load for load in LEAST_LOADS if load not in fixed])
    return Renewal(NewDesign(Design(**lowered.tables.model_dump()), base, lowered.moves), stated)


def _complete_old(stated: Mapping[str, Any]) -> dict[str, Any]:
    """Complete the values of an old file by the defaults of its time, but for retired ones."""
    defaults = {
        path: field.default
        for path, field in PARAMETERS.items()
        if path.partition(".")[0] not in _NOT_SIZES
    }
    if stated.keys() & load_retired().keys():
        defaults |= _OLD_DEFAULTS

    values = defaults | {**stated}
    if values.get("sensor.tail") == "folded":
        model = values["sensor.model"]
        values["sensor.model"] = _SHORT.get(model, model)

    return {path: value for path, value in values.items() if path not in load_retired()}


def _measure_distance(old: DesignTables, base: str) -> tuple[bool, bool, float]:
    """Measure how far a bundled design is from an old one: by interface, sensor, then width."""
    bundled = DesignTables(**load_tables([base], []).tables)
    return (
        old.bone.interface != bundled.bone.interface,
        old.sensor.model != bundled.sensor.model,
        abs(old.skin.width_mm - bundled.skin.width_mm),
    )


def _adopt_all(tables: DesignTables, sizes: Mapping[str, Any]) -> DesignTables:
    """Adopt sizes as far as rules allow; one that needs another first is tried after it."""
    left = -1
    rest = list(sizes.items())
    while left != len(rest):
        left = len(rest)
        tables = _adopt(tables, rest)
        rest = [(path, value) for path, value in sizes.items() if tables.value(path) != value]

    return tables


def _adopt(tables: DesignTables, sizes: Sequence[tuple[str, Any]]) -> DesignTables:
    """Adopt all sizes if the design passes with them, or else those of each half that pass."""
    trial = tables.with_values(dict(sizes))
    broken = RuleChecker(trial).find_broken(cheapest_first(RULES))
    if next(broken, None) is None:
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

    for to_adopt, given in ((rest, {*sizes}), (needed, needed)):
        if not to_adopt:
            break

        trial = tables.with_values({path: sizes[path] for path in to_adopt})
        with gather(issues):
            return fit_lengths(
                trial,
                (*given, *fixed),
                tables,
                progress=lambda share: progress(ShareText("fitting lengths", share)),
            ).tables

    if needed:
        raise DesignError(dict.fromkeys(issues))

    return tables
