"""Parameters of a design with what they shape, and checks of its parts.

Each check links to the parameters that set it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from fingertip.cad.parts import shapes_of_parameters
from fingertip.cad.verification.verify import list_causes
from fingertip.design import Design
from fingertip.design.design_file import Parameter, format_value, list_parameters
from fingertip.documents.finger_sheets import draw_hand_sizes
from fingertip.page.html import Markup, button, code, element, embed, fold, join, quantity, table
from fingertip.page.model_section import label_item

_EFFECTS = {
    "silicone": ("quantities and times of casting", "casting"),
    "printer": ("compensation and checks of the printed parts", "checks"),
    "strength": ("safety factors of the bone", "checks"),
    "force_curve": ("forces and voltages", "trial"),
    "board": ("component values of the board", "board"),
    "detector": ("detection of slip", "trial"),
}
"""Table of parameters -> what it decides beside shapes, and the section that shows it."""


def render_parameters(design: Design) -> Markup:
    """Render all parameters by their tables.

    The name of one that shapes parts is a button that highlights them.
    """
    moved = shapes_of_parameters(design)
    tables = group_parameters()
    parts = [
        element(
            "p",
            "Press the name of a parameter to see in the 3D view what it shapes: every part whose "
            "shape reads it; the "
            "browser's way back leads here again. "
            "Change one in the design file, or with ",
            element("code", "--set TABLE.KEY=VALUE"),
            ".",
        )
    ]

    for name, parameters in tables.items():
        changed = sum(design.value(parameter.path) != parameter.default for parameter in parameters)
        note = f", {changed} changed" if changed else ""
        title = (
            f"{name or 'design'}: {len(parameters)} "
            f"parameter{'s' if len(parameters) > 1 else ''}{note}"
        )
        rows = [_render_row(design, parameter, moved) for parameter in parameters]
        body = table(
            ("parameter", "value", "bounds"), rows, f"parameters of [{name}]" if name else "name"
        )

        if name == "hand" and design.dimensions.joint:
            picture = embed(draw_hand_sizes(design), "image/svg+xml")
            image = element(
                "img",
                src=picture,
                alt="Where to put the calipers for each size of the hand's joint",
            )
            body = join((element("figure", image, class_="paper"), body))

        parts.append(fold(title, body))

    return join(parts)


def group_parameters() -> dict[str, list[Parameter]]:
    """Group the parameters by their tables; the table "" holds those that stand in none."""
    tables: dict[str, list[Parameter]] = {}
    for parameter in list_parameters():
        tables.setdefault(parameter.path.rpartition(".")[0], []).append(parameter)

    return tables


def _render_row(
    design: Design, parameter: Parameter, moved: Mapping[str, tuple[str, ...]]
) -> tuple[str, str, str]:
    path = parameter.path
    value = design.value(path)
    items = moved.get(path, ())
    if items:
        name = button(
            code(path),
            class_="code",
            data_moves=" ".join(items),
            aria_pressed="false",
            id=f"p-{path}",
        )
    else:
        name = element("span", code(path), class_="code", id=f"p-{path}", tabindex="-1")

    cell = element("span", f"{format_value(value)} {parameter.unit}".rstrip(), class_="num")
    if value != parameter.default:
        default = element("small", f"default {format_value(parameter.default)}")
        cell = join((cell, element("br"), default))

    description = element("div", parameter.description)
    return join((name, description, _describe_effect(path, items))), cell, parameter.bounds


def _describe_effect(path: str, items: tuple[str, ...]) -> Markup:
    """Describe what a parameter decides, with a link to the section that shows it."""
    if items:
        return element(
            "small", "Shapes ", ", ".join(dict.fromkeys(label_item(item) for item in items)), "."
        )

    effect = _EFFECTS.get(path.partition(".")[0])
    if effect:
        return element("small", "Decides ", element("a", effect[0], href=f"#{effect[1]}"), ".")

    return element(
        "small", "Shapes no part of this design: a limit, or a choice that it does not use."
    )


@dataclass(frozen=True)
class ReportedCheck:
    """Check as report.json states it, of the values that a page shows."""

    name: str
    value: float
    limit: float
    unit: str
    relation: str
    passed: bool

    @classmethod
    def read(cls, entry: Mapping[str, Any]) -> ReportedCheck:
        return cls(**{field.name: entry[field.name] for field in fields(cls)})


_CLOSEST = 8
"""Number of checks that are listed as the closest to their limits."""
EVERY_FILE = (
    "Every file was read back and measured. A check that fails names the parameters to change."
)
"""Sentences on the checks of a build."""


def tell_verdict(
    checks: Sequence[ReportedCheck], passed: str = "of the parts passed"
) -> tuple[str, str]:
    """Return a verdict on the checks and its kind; `passed` ends the sentence."""
    failed = sum(not check.passed for check in checks)
    if failed:
        return f"✗ {failed} of {len(checks)} checks failed: do not print these parts", "failed"

    return f"✓ All {len(checks)} checks {passed}", "passed"


def render_verdict(checks: Sequence[ReportedCheck], passed: str = "of the parts passed") -> Markup:
    text, kind = tell_verdict(checks, passed)
    return element("p", text, class_=f"verdict {kind}")


def render_checks(checks: Sequence[ReportedCheck], basis: str = EVERY_FILE) -> Markup:
    """Render all checks: failed ones, then those closest to their limits, then all."""
    failed = [check for check in checks if not check.passed]
    parts = [element("p", basis)]
    if failed:
        parts += [element("h3", "Failed"), _tabulate(failed, "failed checks")]

    closest = _find_closest(checks)
    if closest:
        parts.append(
            fold(
                "The checks closest to their limits",
                _tabulate(closest, "checks closest to their limits"),
            )
        )

    groups: dict[str, list[ReportedCheck]] = {}
    for check in checks:
        groups.setdefault(check.name.split(".")[0], []).append(check)

    for subject, group in groups.items():
        passed = sum(check.passed for check in group)
        summary = f"{subject.replace('_', ' ')}: {passed} of {len(group)} passed"
        parts.append(fold(summary, _tabulate(group, f"checks of {subject}")))

    return join(parts)


def _find_closest(checks: Sequence[ReportedCheck]) -> list[ReportedCheck]:
    """Find the passed checks with the least margin, relative to their limits.

    Counts and exact values have none.
    """
    margins = [
        (abs(check.value - check.limit) / abs(check.limit), check)
        for check in checks
        if check.passed
        and check.relation != "exactly"
        and check.limit
        and check.value != check.limit
        and list_causes(check.name)
    ]
    return [check for _, check in sorted(margins, key=lambda pair: pair[0])[:_CLOSEST]]


def _tabulate(checks: Sequence[ReportedCheck], caption: str) -> Markup:
    rows = []
    for check in checks:
        passed = element("span", "✓", class_="passed", title="passed")
        if not check.passed:
            passed = element("span", "✗ FAILED", class_="failed")

        name = element("span", code(check.name), class_="code")
        value = quantity(check.value, check.unit)
        limit = quantity(check.limit, check.unit, check.relation)
        rows.append((name, value, limit, passed, link_parameters(list_causes(check.name))))

    return table(("check", "value", "must be", "passed", "set by"), rows, caption)


def link_parameters(paths: Iterable[str]) -> Markup:
    """Build links to parameters, with commas between them."""
    links = (element("a", code(path), href=f"#p-{path}", class_="code") for path in paths)
    return Markup(", ".join(links))
