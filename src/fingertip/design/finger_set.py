"""Set of fingers: a file that names a hand and its fingers, each by a design and what it changes in
it.

Fingers of equal parameters share their parts and one mold, so a set is also a list of distinct
designs. The force curve of a sensor changes no part: fingers that differ in it alone are of one
form.
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
    design: Design
    fingers: tuple[str, ...]

    @property
    def count(self) -> int:
        return len(self.fingers)

    def name_values(self, text: str) -> str:
        """Write the values in a text, such as bone.wall_mm=2, as
        the set takes them: one for each finger.
        """
        each = " ".join(rf"\g<1>fingers.{name}.\g<2>" for name in self.fingers)
        return re.sub(r"(--set )?\b(\w+\.\w+=\S*\w)", each, text)


@dataclass(frozen=True)
class FingerSet:
    name: str
    side: str
    forms: tuple[Form, ...]
    """Distinct designs, in the order of their first fingers; no two have one name."""
    calibrated: Mapping[str, Design] = dataclasses.field(default_factory=dict)
    """Designs of the fingers whose sensor has another force curve than the design of their form."""

    @property
    def fingers(self) -> tuple[tuple[str, Form], ...]:
        """Fingers from the thumb on, each with its form."""
        found = {finger: form for form in self.forms for finger in form.fingers}
        return tuple((finger, found[finger]) for finger in NAMES if finger in found)

    @property
    def designs(self) -> dict[str, Design]:
        """Design of each finger, with the force curve of its own sensor."""
        return {finger: self.calibrated.get(finger, form.design) for finger, form in self.fingers}

    @property
    def board_design(self) -> Design | None:
        """Design of one board for all fingers; None if their boards differ or cannot be put on one.

        Each finger has the place that the board prints its name at, so a place before it may have
        no finger.
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
        return {"name": self.name, "side": self.side, "forms": forms} | (
            {"calibrated": curves} if curves else {}
        )


def is_set(given: str | Path) -> bool:
    """Tell whether a path or a bundled name is that of a set.

    Raises TomlFileError if it is that of nothing.
    """
    return identify_kind(find_file(given, DESIGN, SET)) is SET


def load_set(file: str | Path, changes: Sequence[str] = ()) -> FingerSet:
    """Load a set. Raises DesignError, with all faults.

    Changes such as "board.cutoff_hz=80" are made in all fingers, "fingers.thumb.skin.width_mm=22"
    in one.
    """
    return build_set(
        *read_set(
            file,
            changes,
            lambda one: Design.from_tables(one.tables, one.before, one.changed, one.provisional),
        )
    )


def read_set(
    file: str | Path,
    changes: Sequence[str],
    read: Callable[[LoadedTables], T],
    below: Path | None = None,
) -> tuple[str, str, dict[str, T]]:
    """Read name and side of a set, and of each finger what `read` makes of its tables.

    Raises DesignError.

    A set that another file names is read `below` its folder (see `read_input`).
    """
    path = find_file(file, SET)
    contents = parse_tables(SetFile, read_file(path, SET, below))
    load_tables((), changes)  # what is wrong with them is said once, not for each finger
    issues: list[Issue] = []

    for change in changes:
        finger = split_finger(change)[0]
        if finger and finger not in contents.fingers:
            remedy = suggest_name(finger, list(contents.fingers))
            issues.append(Issue(f"--set {change}", f"the set has no finger {finger}; {remedy}"))

    if not contents.fingers:
        issues.append(
            Issue(
                "fingers",
                "is empty; give a table such as [fingers.index] with design = 'adult_finger'.",
            )
        )

    for name in contents.fingers:
        if name not in NAMES:
            issues.append(
                Issue(f"fingers.{name}", f"is no finger; choose from {', '.join(NAMES)}.")
            )

    hand: dict[str, Any] = {}
    with gather(issues):
        given = contents.hand
        if given:
            beside = _find_beside(path, "hand", given)
            hand = read_file(
                beside or find_hand(given), DESIGN, below=path.parent if beside else None
            )

    fingers: dict[str, T] = {}
    found: dict[Issue, list[str]] = {}
    for name in (name for name in NAMES if name in contents.fingers):
        of_finger: list[Issue] = []
        with gather(of_finger):
            own = [change for finger, change in map(split_finger, changes) if finger in ("", name)]
            fingers[name] = read(_load_finger(path, contents.fingers[name], hand, own))

        for issue in of_finger:
            found.setdefault(issue, []).append(name)

    for issue, names in found.items():  # what is wrong in several fingers is said once
        issues.append(Issue(f"fingers.{', '.join(names)}: {issue.field}", issue.message))

    raise_issues(DesignError, issues)
    return contents.name, contents.side, fingers


def build_set(name: str, side: str, designs: Mapping[str, Design]) -> FingerSet:
    """Build a set of the designs of its fingers.

    Raises DesignError if they do not share a hand's joint.
    """
    raise_issues(DesignError, _find_differences(designs))
    forms = tuple(_name_forms(designs))
    bases = {finger: form.design for form in forms for finger in form.fingers}
    calibrated = {
        finger: each
        for finger, each in designs.items()
        if each.force_curve != bases[finger].force_curve
    }

    return FingerSet(name, side, forms, calibrated)


def set_to_toml(fingers: FingerSet, heading: str) -> str:
    """Write a set as a file that needs no other: each finger as the
    default design with what differs from it.
    """
    lines = [f"# {line}" for line in heading.splitlines()]
    lines += _list_values({"name": fingers.name, "side": fingers.side})

    for finger, design in fingers.designs.items():
        own = {"design": DESIGN.example, "name": design.name} | design.with_bare_names().changes()
        lines += ["", f"[fingers.{finger}]", *_list_values(own)]

    return "\n".join(lines) + "\n"


def _list_values(values: Mapping[str, Any]) -> Iterator[str]:
    return (change.replace("=", " = ", 1) for change in list_changes(values))


def _find_beside(path: Path, field: str, given: str) -> Path | None:
    """Find a file beside a set, which may come from a stranger; None if the name is a
    bundled one.
    """
    if not is_safe_name(given):
        problem = f"{quote_value(given)} is no name of a file beside the set, or of a bundled one"
        raise DesignError(Issue(field, f"{problem}; put the file there."))

    return path.parent / given if (path.parent / given).is_file() else None


def _load_finger(
    path: Path, table: Mapping[str, Any], hand: Mapping[str, Any], changes: Sequence[str]
) -> LoadedTables:
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
        for finger in (finger for finger in designs if field != "hand" or finger != "thumb"):
            groups.setdefault(read(designs[finger]), []).append(finger)

        if len(groups) > 1:
            groups_text = " / ".join(map(join_words, groups.values()))
            remedy = f"give {field} the same value in all of them, or make a set of each"
            yield Issue(field, f"is not the same {what} for {groups_text}; {remedy}.")


def _name_forms(designs: Mapping[str, Design]) -> Iterator[Form]:
    """Group fingers of equal parts; a form whose name another one has takes its first finger's
    besides.

    Where the sensors of a form differ, its design has the typical one.
    """
    groups: dict[str, list[str]] = {}
    for finger, design in designs.items():
        groups.setdefault(repr(design.model_dump() | {"name": "", "force_curve": None}), []).append(
            finger
        )

    names = [designs[fingers[0]].name for fingers in groups.values()]
    for fingers in groups.values():
        design = designs[fingers[0]]
        if any(designs[finger].force_curve != design.force_curve for finger in fingers):
            design = design.with_values({"force_curve": ForceCurve()})
        if names.count(design.name) > 1:
            # Cut so that a long name keeps its finger, and no two forms have one folder.
            design = design.model_copy(update={"name": f"{design.name[:33]}_{fingers[0]}"})

        yield Form(design, tuple(fingers))
