"""New set of fingers from the width and length of each.

Fingers of equal size are of one form, and all turn on one joint.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fingertip.catalogues.electronics import NAMES
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design.design import Design
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters.declaration import parse_tables, suggest_name
from fingertip.design.proportions import load_proportions
from fingertip.fitting import new_design
from fingertip.foundation.errors import (
    DesignError,
    Issue,
    gather,
    join_words,
    quote_value,
    raise_issues,
)
from fingertip.foundation.progress import Work

Size = tuple[float, float]
"""Width and length of the skin [mm]."""
Starts = Mapping[tuple[str, ...], new_design.Start]
"""Fingers of one size -> their design before its fit."""
_SIZE = ("skin.width_mm", "skin.length_mm")
_SIZE_REMEDY = re.compile(
    r"(skin\.(?:width|length)_mm)(?:=|: .*; at (?:least|most) )(\d+(?:\.\d+)?)"
)
_EXAMPLE = "--finger index=18x25"


@dataclass(frozen=True)
class NewForm:
    """New design of the fingers of one size."""

    fingers: tuple[str, ...]
    design: new_design.NewDesign

    @property
    def file(self) -> str:
        """Bundled design, or file that is to be written beside the set."""
        return f"{self.design.design.name}.toml" if self.is_own else self.design.base

    @property
    def is_own(self) -> bool:
        """True if the design differs from the bundled one in more than its name."""
        bundled = Design.load(self.design.base)
        return self.design.design != bundled.model_copy(update={"name": self.design.design.name})


def read_sizes(texts: Sequence[str]) -> dict[str, Size]:
    """Read sizes such as "index=18x25", from the thumb on. Raises DesignError with all faults."""
    sizes: dict[str, Size] = {}
    issues: list[Issue] = []

    for text in texts:
        name, _, size = text.partition("=")
        field = f"--finger {text}"
        match = re.fullmatch(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)", size)

        if name not in NAMES:
            issues.append(
                Issue(field, f"{quote_value(name)} is no finger; {suggest_name(name, NAMES)}")
            )
        elif name in sizes:
            issues.append(Issue(field, "is given twice; give each finger once."))

        if not match:
            issues.append(
                Issue(
                    field, f"states no width and length of the skin in mm; write it as {_EXAMPLE}."
                )
            )
            continue

        width_mm = float(match[1])
        length_mm = float(match[2])
        sizes[name] = (width_mm, length_mm)

        with gather(issues, f"{field}: "):
            parse_tables(DesignTables, {"skin": {"width_mm": width_mm, "length_mm": length_mm}})
            if width_mm > length_mm:
                remedy = f"the width comes first: --finger {name}={match[2]}x{match[1]}"
                issues.append(Issue(field, f"is wider than long; {remedy}."))

    raise_issues(DesignError, issues)
    return {name: sizes[name] for name in NAMES if name in sizes}


def start_set(
    name: str,
    texts: Sequence[str],
    sensor: str | None,
    preset: str | None,
    hand: str | Path | None,
    changes: Sequence[str],
) -> Starts:
    """Begin a design for each size, in the order of their first fingers.

    Raises DesignError with all faults.
    """
    issues: list[Issue] = []
    sizes: dict[str, Size] = {}
    with gather(issues):
        new_design.refuse_words(name, sensor, preset)

    with gather(issues):
        sizes = read_sizes(texts)

    for change in changes:
        if change.partition("=")[0].strip() in _SIZE:
            issues.append(
                Issue(
                    f"--set {change}", "is one size for all fingers; --finger gives each its own."
                )
            )

    raise_issues(DesignError, issues)
    groups: dict[tuple[str, Size], list[str]] = {}
    for finger, size in sizes.items():
        base = _choose_preset(finger, sizes, preset)
        groups.setdefault((base, size), []).append(finger)

    starts: dict[tuple[str, ...], new_design.Start] = {}
    for (base, size), fingers in groups.items():
        own = [*changes, *(f"{field}={value!r}" for field, value in zip(_SIZE, size, strict=True))]
        with gather(issues):
            starts[tuple(fingers)] = new_design.start_design(
                f"{name}_{fingers[0]}",
                sensor=sensor,
                preset=base,
                hand=hand,
                changes=own,
            )

    raise_issues(DesignError, dict.fromkeys(issues))  # an issue of several fingers is given once
    return starts


def fit_set(
    starts: Starts, progress: Callable[[str], None], issues: list[Issue]
) -> tuple[NewForm, ...]:
    """Fit the designs of a set, and add the issues of all fingers to `issues`.

    No fit moves a size of the hand, so all fingers turn on one joint; a thumb has a joint of its
    own if no hand is given.
    """
    forms: list[NewForm] = []
    work = Work("fitting", {join_words(fingers): 1.0 for fingers in starts}, progress)

    for fingers, start in starts.items():
        names = join_words(fingers)
        own_issues: list[Issue] = []
        with_fixed_hand = replace(start, given=(*start.given, *start.guessed))
        with gather(own_issues):
            design = new_design.fit_start(with_fixed_hand, work.within(names))
            forms.append(NewForm(fingers, design))

        size = dict(_SIZE_REMEDY.findall("\n".join(issue.typed for issue in own_issues)))
        if size:
            typed = "x".join(size.get(field, f"{start.tables.value(field):g}") for field in _SIZE)
            remedy = " ".join(f"--finger {finger}={typed}" for finger in fingers)
            field = own_issues[0].field
            problem = own_issues[0].message.partition("; ")[0]
            own_issues[0] = Issue(field, f"{problem}; it passes with {remedy}.")

        issues += (Issue(f"{names}: {issue.field}", issue.message) for issue in own_issues)

    return tuple(forms)


def _choose_preset(finger: str, sizes: Mapping[str, Size], preset: str | None) -> str:
    """Choose the preset of a finger by the age of `preset`, or by the widths of all fingers."""
    if preset:
        return _name_preset(_read_age(preset), finger)

    proven = load_proportions()

    def measure_difference(age: str) -> float:
        difference_mm = 0.0
        for name, (width_mm, _) in sizes.items():
            difference_mm += abs(width_mm - proven[_name_preset(age, name)]["skin"]["width_mm"])

        return difference_mm

    nearest = min(map(_read_age, PRESETS), key=measure_difference)
    return _name_preset(nearest, finger)


def _read_age(preset: str) -> str:
    return preset.partition("_")[0]


def _name_preset(age: str, finger: str) -> str:
    return f"{age}_{'thumb' if finger == 'thumb' else 'finger'}"


def write_set_file(name: str, forms: Sequence[NewForm]) -> str:
    """Write the file of a set, with its fingers from the thumb on."""
    heading = (
        "# Set of fingers for `fingertip make`. Each has a design: a file beside this one, "
        "or a bundled one."
    )
    lines = [heading, f'name = "{name}"', 'side = "right"  # or left; fingertips of both are alike']

    for finger in NAMES:
        for form in forms:
            if finger in form.fingers:
                skin = form.design.design.skin
                size = f"  # skin {skin.width_mm:g} mm wide, {skin.length_mm:g} mm long"
                lines += ["", f"[fingers.{finger}]", f'design = "{form.file}"{size}']

    return "\n".join([*lines, ""])
