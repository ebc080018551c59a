"""New design: a bundled one, fitted to what is given, as a file of wishes and measurements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fingertip.catalogues.electronics import SENSORS, explain_sensor
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design.design import Design
from fingertip.design.design_file import load_tables, merge
from fingertip.design.design_text import write_design
from fingertip.design.fit import LEAST_LOADS, Move
from fingertip.design.geometry import DesignTables
from fingertip.design.hand_sizes import complete_hand, find_hand
from fingertip.design.parameters.declaration import parse_tables, suggest_name
from fingertip.fitting.fitting import fit_tables
from fingertip.foundation.errors import DesignError, Issue, gather, raise_issues
from fingertip.foundation.tables import read_toml

_SENSORS = (*SENSORS, "custom")
_PLACE = "sensor.distance_from_tip_mm"


@dataclass(frozen=True)
class NewDesign:
    """New design, the text of its file, and what it begins from."""

    design: Design
    base: str
    moves: tuple[Move, ...] = ()
    """Differences from the bundled design, beside what is given."""
    guessed: tuple[str, ...] = ()
    """Parameters of the hand that nobody measured."""

    @property
    def text(self) -> str:
        heading = (
            f"Design of a fingertip, begun from the bundled design {self.base}.",
            "A comment holds the meaning of a parameter and, in brackets, its unit and bounds.",
        )
        lowered = (move.name for move in self.moves if move.name in LEAST_LOADS)
        return write_design(self.design, heading, (*self.guessed, *lowered), with_others=True)


@dataclass(frozen=True)
class Start:
    """Design before its fit: a bundled one with what is given."""

    tables: DesignTables
    base: str
    before: DesignTables
    given: tuple[str, ...]
    """Parameters that stay as they are."""
    guessed: tuple[str, ...]
    """Parameters of the hand that nobody measured."""


def write_new_design(
    name: str,
    sensor: str | None = None,
    preset: str | None = None,
    hand: str | Path | None = None,
    changes: Sequence[str] = (),
    progress: Callable[[str], None] = lambda message: None,
) -> NewDesign:
    """Begin a design with a bundled one, and fit it to what is given.

    A preset has a joint, and so has a design for a hand. Raises DesignError or TomlFileError.
    """
    refuse_words(name, sensor, preset)
    return fit_start(
        start_design(
            name,
            sensor=sensor,
            preset=preset,
            hand=hand,
            changes=changes,
        ),
        progress,
    )


def refuse_words(name: str, sensor: str | None, preset: str | None) -> None:
    """Refuse a name that no design may have, and an unknown sensor or preset.

    Raises DesignError.
    """
    issues: list[Issue] = []
    with gather(issues):
        parse_tables(DesignTables, {"name": name})

    for field, word, known in (("sensor", sensor, _SENSORS), ("preset", preset, PRESETS)):
        if word is not None and word not in known:
            reason = explain_sensor(word) if field == "sensor" else ""
            problem = f"is not known; {suggest_name(word, known)}"
            if reason:
                problem = f"is not in the catalogue; {reason}."

            issues.append(Issue(field, f"{word!r} {problem}"))

    raise_issues(DesignError, issues)


def start_design(
    name: str,
    sensor: str | None,
    preset: str | None,
    hand: str | Path | None,
    changes: Sequence[str],
) -> Start:
    """Begin with the preset, or with the sensor's bundled design without preset and hand."""
    # A custom sensor begins as an FSR 400.
    catalogued = SENSORS.get(sensor or "fsr400", SENSORS["fsr400"])
    has_joint = preset is not None or hand is not None
    base = (preset or "adult_finger") if has_joint else catalogued.bundled_design
    own = [f"sensor.model={sensor}"] if sensor else []
    for change in catalogued.changes:
        # Lengths of the bundled design of the sensor do not fit a joint; those of its bump do.
        if not has_joint or change.startswith("skin.bump_"):
            own.append(change)

    before = parse_tables(DesignTables, load_tables([base], own).tables)
    tables = before.model_dump() | {"name": name}
    changed = load_tables((), changes)
    guessed: tuple[str, ...] = ()

    if hand is not None:
        measured = read_toml(find_hand(hand)).get("hand", {})
        merge(measured, changed.tables.get("hand", {}))
        values, guessed = complete_hand(measured, before.hand)
        tables["hand"] |= values

    merge(tables, changed.tables)
    begun = parse_tables(DesignTables, tables)
    longer_mm = begun.skin.length_mm - before.skin.length_mm

    # In a longer skin the sensor stays at its place from the collar, which would else touch a plate
    # before the pad does.
    if longer_mm > 0.0 and _PLACE not in changed.changed:
        place_mm = round(before.sensor.distance_from_tip_mm + longer_mm, 2)
        begun = begun.with_values({_PLACE: place_mm})

    return Start(
        tables=begun,
        base=base,
        before=before,
        given=changed.changed,
        guessed=guessed,
    )


def fit_start(start: Start, progress: Callable[[str], None]) -> NewDesign:
    """Fit what follows from what is given.

    Loads that are not given become those that the bone bears. Raises DesignError.
    """
    tables = start.tables
    given = start.given
    if tables == start.before.with_values({"name": tables.name}):
        return NewDesign(Design(**tables.model_dump()), start.base, (), start.guessed)

    provisional = (*start.guessed, *LEAST_LOADS)
    design = fit_tables(
        tables.model_dump(),
        before=start.before.model_dump(),
        changed=given,
        progress=progress,
        provisional=provisional,
    )
    moves = {move.name: move for move in design.moves}
    was = start.before.value(_PLACE)
    place = design.value(_PLACE)

    if _PLACE not in given and place != was:
        reason = moves[_PLACE].reason if _PLACE in moves else "skin.length_mm is longer"
        moves[_PLACE] = Move(_PLACE, was, place, reason)

    return NewDesign(
        design, start.base, tuple(moves[name] for name in sorted(moves)), start.guessed
    )
