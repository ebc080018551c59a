"""Set of fingers: a file that names a hand and its fingers, each by a design and its changes of it.

Fingers of equal parameters share their parts and one mold, and are of one form: a set is a list of
distinct designs too. The force curve of a sensor changes no part: fingers that differ in it alone
are of one form.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from fingertip.catalogues.electronics import NAMES, split_finger
from fingertip.catalogues.file_kinds import DESIGN, SET, find_file, identify_kind, read_file
from fingertip.design.design import Design
from fingertip.design.design_file import (
    LoadedTables,
    flatten,
    list_changes,
    load_tables,
    resolve_names,
)
from fingertip.design.hand_sizes import find_hand
from fingertip.design.parameters.declaration import parse_tables, suggest_name
from fingertip.design.parameters.sensor_and_skin import ForceCurve
from fingertip.foundation.errors import (
    DesignError,
    Issue,
    gather,
    join_words,
    quote_value,
    raise_issues,
)
from fingertip.foundation.input_files import is_safe_name

T = TypeVar("T")


class SetFile(BaseModel):
    """Contents of a set file."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        title="fingertip set",
    )

    name: str = Field(
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$",
        description="Name of the set and its output folder.",
    )
    side: Literal["left", "right"] = Field(
        "right", description="Side of the hand; fingertips of both are alike."
    )
    hand: str = Field(
        "",
        description="File with the joint of the hand, or a bundled hand; empty for the designs' "
        "own.",
    )
    fingers: dict[str, dict[str, Any]] = Field(
        description="Finger (thumb, index, middle, ring, little): design, a bundled name or a "
        "file beside this one, "
        "and parameters that differ from it, such as skin.width_mm."
    )


@dataclass(frozen=True)
class Form:
    """Design of one or several fingers of a set, which share one mold."""

    design: Design
    fingers: tuple[str, ...]

    @property
    def count(self) -> int:
        return len(self.fingers)

    def name_values(self, text: str) -> str:
        """Write values in a text, such as bone.wall_mm=2, for each finger, as a set takes them."""
        by_finger = " ".join(rf"\g<1>fingers.{name}.\g<2>" for name in self.fingers)
        return re.sub(r"(--set )?\b(\w+\.\w+=\S*\w)", by_finger, text)


@dataclass(frozen=True)
class FingerSet:
    """Fingers of one hand, by their distinct designs."""

    name: str
    side: str
    forms: tuple[Form, ...]
    """Distinct designs, in the order of their first fingers; no two have one name."""
    calibrated: Mapping[str, Design] = dataclasses.field(default_factory=dict)
    """Designs of the fingers whose sensor has another force curve than the design of their form."""

    @property
    def fingers(self) -> tuple[tuple[str, Form], ...]:
        """Fingers from the thumb on, each with its form."""
        forms: dict[str, Form] = {}
        for form in self.forms:
            forms |= dict.fromkeys(form.fingers, form)

        return tuple((finger, forms[finger]) for finger in NAMES if finger in forms)

    @property
    def designs(self) -> dict[str, Design]:
        """Design of each finger, with the force curve of its own sensor."""
        return {finger: self.calibrated.get(finger, form.design) for finger, form in self.fingers}

    @property
    def board_design(self) -> Design | None:
        """Design of one board for all fingers; None if their boards differ or cannot share one.

        The board prints the name of a finger at each place, so a place may have no finger.
        """
        first = self.forms[0].design
        last = NAMES.index(self.fingers[-1][0])
        if len(self.fingers) < 2 or any(form.design.board != first.board for form in self.forms):
            return None

        board = first.board.model_copy(update={"channels": last + 1})
        try:
            return Design(**first.model_dump() | {"name": self.name, "board": board.model_dump()})
        except DesignError:  # another variant than that of the board for several fingers
            return None

    def identity(self) -> dict[str, Any]:
        """Return all parameters, for the hash in a manifest."""
        forms = [{"fingers": form.fingers, "design": form.design.identity()} for form in self.forms]
        curves = {
            finger: design.force_curve.model_dump(mode="json")
            for finger, design in self.calibrated.items()
        }
        identity = {"name": self.name, "side": self.side, "forms": forms}
        return identity | {"calibrated": curves} if curves else identity


def is_set(source: str | Path) -> bool:
    """Tell whether a path or a bundled name is that of a set.

    Raises TomlFileError if there is no such file.
    """
    return identify_kind(find_file(source, DESIGN, SET)) is SET


def load_set(file: str | Path, changes: Sequence[str] = ()) -> FingerSet:
    """Load a set. Raises DesignError, with all faults.

    A change such as "board.cutoff_hz=80" is made in all fingers, and
    "fingers.thumb.skin.width_mm=22" in one.
    """

    def build(loaded: LoadedTables) -> Design:
        return Design.from_tables(loaded.tables, loaded.before, loaded.changed, loaded.provisional)

    return build_set(*read_set(file, changes, build))


def read_set(
    file: str | Path,
    changes: Sequence[str],
    read: Callable[[LoadedTables], T],
    below: Path | None = None,
) -> tuple[str, str, dict[str, T]]:
    """Read name and side of a set, and what `read` returns for the tables of each finger.

    A set that another file names is read `below` its folder (see `read_input`). Raises DesignError.
    """
    path = find_file(file, SET)
    contents = parse_tables(SetFile, read_file(path, SET, below))
    load_tables((), changes)  # reports invalid changes once, not for each finger
    issues = list(_find_name_issues(contents, changes))

    hand: dict[str, Any] = {}
    with gather(issues):
        if contents.hand:
            hand = _load_hand(path, contents.hand)

    fingers: dict[str, T] = {}
    names_by_issue: dict[Issue, list[str]] = {}
    for name in NAMES:
        if name not in contents.fingers:
            continue

        issues_of_finger: list[Issue] = []
        with gather(issues_of_finger):
            own = [change for finger, change in map(split_finger, changes) if finger in ("", name)]
            fingers[name] = read(_load_finger(path, contents.fingers[name], hand, own))

        for issue in issues_of_finger:
            names_by_issue.setdefault(issue, []).append(name)

    # An issue of several fingers is reported once.
    for issue, names in names_by_issue.items():
        issues.append(Issue(f"fingers.{', '.join(names)}: {issue.field}", issue.message))

    raise_issues(DesignError, issues)
    return contents.name, contents.side, fingers


def _find_name_issues(contents: SetFile, changes: Sequence[str]) -> Iterator[Issue]:
    """Report fingers that do not exist, in the set or in the changes."""
    for change in changes:
        finger = split_finger(change)[0]
        if finger and finger not in contents.fingers:
            remedy = suggest_name(finger, list(contents.fingers))
            yield Issue(f"--set {change}", f"the set has no finger {finger}; {remedy}")

    if not contents.fingers:
        example = "a table such as [fingers.index] with design = 'adult_finger'"
        yield Issue("fingers", f"is empty; give {example}.")

    for name in contents.fingers:
        if name not in NAMES:
            yield Issue(f"fingers.{name}", f"is no finger; choose from {', '.join(NAMES)}.")


def _load_hand(path: Path, name: str) -> dict[str, Any]:
    """Load the hand that a set names, from a file beside it or among the bundled ones."""
    beside = _find_beside(path, "hand", name)
    if beside:
        return read_file(beside, DESIGN, below=path.parent)

    return read_file(find_hand(name), DESIGN)


def build_set(name: str, side: str, designs: Mapping[str, Design]) -> FingerSet:
    """Build a set of the designs of its fingers.

    Raises DesignError if they do not share a hand's joint.
    """
    raise_issues(DesignError, _find_differences(designs))
    forms = tuple(_name_forms(designs))
    calibrated = {}
    for form in forms:
        for finger in form.fingers:
            if designs[finger].force_curve != form.design.force_curve:
                calibrated[finger] = designs[finger]

    in_order = {finger: calibrated[finger] for finger in designs if finger in calibrated}
    return FingerSet(name, side, forms, in_order)


def set_to_toml(fingers: FingerSet, heading: str) -> str:
    """Write a set as a file that needs no other one.

    Each finger is the default design with what differs from it.
    """
    lines = [f"# {line}" for line in heading.splitlines()]
    lines += _list_values({"name": fingers.name, "side": fingers.side})

    for finger, design in fingers.designs.items():
        own = {"design": DESIGN.example, "name": design.name} | design.with_bare_names().changes()
        lines += ["", f"[fingers.{finger}]", *_list_values(own)]

    return "\n".join(lines) + "\n"


def _list_values(values: Mapping[str, Any]) -> Iterator[str]:
    return (change.replace("=", " = ", 1) for change in list_changes(values))


def _find_beside(path: Path, field: str, name: str) -> Path | None:
    """Find a file beside a set; None if there is none of this name.

    Raises DesignError for a path: the set may come from a stranger.
    """
    if not is_safe_name(name):
        problem = f"{quote_value(name)} is no name of a file beside the set, or of a bundled one"
        raise DesignError(Issue(field, f"{problem}; put the file there."))

    file = path.parent / name
    return file if file.is_file() else None


def _load_finger(
    path: Path, table: Mapping[str, Any], hand: Mapping[str, Any], changes: Sequence[str]
) -> LoadedTables:
    """Load the design that a finger names, with its hand, its own values and the changes."""
    base = table.get("design")
    if not isinstance(base, str):
        raise DesignError(
            Issue("design", "is missing; name a design, such as design = 'adult_finger'.")
        )

    beside = _find_beside(path, "design", base)
    own = {name: value for name, value in table.items() if name != "design"}
    resolve_names(own, path.parent)
    values = (*flatten(hand), *flatten(own))  # a finger may differ from the hand in one value
    typed = [*list_changes(dict(values)), *changes]

    return load_tables([beside or base], typed, below=path.parent if beside else None)


def _find_differences(designs: Mapping[str, Design]) -> Iterator[Issue]:
    """Report what the fingers of a hand must share: interface and, but for the thumb, the joint."""
    shared: tuple[tuple[str, str, Callable[[Design], object]], ...] = (
        ("bone.interface", "interface", lambda design: design.bone.interface),
        (
            "hand",
            "joint of the hand",
            lambda design: design.hand if design.dimensions.joint else None,
        ),
    )
    for field, what, read in shared:
        groups: dict[object, list[str]] = {}
        for finger, design in designs.items():
            if field != "hand" or finger != "thumb":
                groups.setdefault(read(design), []).append(finger)

        if len(groups) > 1:
            groups_text = " / ".join(map(join_words, groups.values()))
            remedy = f"give {field} the same value in all of them, or make a set of each"
            yield Issue(field, f"is not the same {what} for {groups_text}; {remedy}.")


def _name_forms(designs: Mapping[str, Design]) -> Iterator[Form]:
    """Group fingers of equal parts.

    If two forms have one name, the names of their first fingers are added. Where the sensors of a
    form differ, its design has the typical one.
    """
    groups: dict[str, list[str]] = {}
    for finger, design in designs.items():
        parts = repr(design.model_dump() | {"name": "", "force_curve": None})
        groups.setdefault(parts, []).append(finger)

    names = [designs[fingers[0]].name for fingers in groups.values()]
    for fingers in groups.values():
        design = designs[fingers[0]]
        if any(designs[finger].force_curve != design.force_curve for finger in fingers):
            design = design.with_values({"force_curve": ForceCurve()})
        if names.count(design.name) > 1:
            # Cut so that a long name keeps its finger, and no two forms have one folder.
            design = design.model_copy(update={"name": f"{design.name[:33]}_{fingers[0]}"})

        yield Form(design, tuple(fingers))
