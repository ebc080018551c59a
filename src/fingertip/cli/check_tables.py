"""Tables of checks, and what to do about one that failed, for terminals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fingertip.catalogues.electronics import split_finger
from fingertip.cli.console import Console

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design

_HEADINGS = ("check", "value", "", "limit", "unit", "")
_NUMBERS = (1, 3)
"""Columns that are aligned to the right."""


def format_checks(
    label: str, checks: Sequence[Check], verbose: bool, causes: Mapping[str, str] | None = None
) -> str:
    """Format a verdict, then the failed checks, or all, with what to do about failures.

    `causes` says what to do by the name of a check; without it, that follows from the parameters
    behind the check.
    """
    from fingertip.cad.verification.check import count_checks

    verdict = f"{label}: {count_checks(checks)}"
    listed_checks = [check for check in checks if verbose or not check.passed]
    if not listed_checks:
        return verdict

    rows = [_HEADINGS, *map(_format_row, listed_checks)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [_align(row, widths) for row in rows]

    remedies = [
        f"  {check.name}: {causes[check.name] if causes else describe_cause(check)}"
        for check in listed_checks
        if not check.passed
    ]

    return "\n".join([verdict, *lines, *remedies])


def _format_row(check: Check) -> tuple[str, ...]:
    from fingertip.foundation.files import round_for_output

    verdict = "ok" if check.passed else "FAILED"
    value = f"{round_for_output(check.value):.5g}"
    if check.is_beyond:
        return (check.name, f">{value}", "", "", check.unit, verdict)

    return (check.name, value, check.sign, f"{check.limit:.5g}", check.unit, verdict)


def _align(row: Sequence[str], widths: Sequence[int]) -> str:
    cells = (f"{text:{'>' if i in _NUMBERS else ''}{widths[i]}}" for i, text in enumerate(row))
    return " ".join(cells).rstrip()


def describe_cause(check: Check, with_remedy: bool = True) -> str:
    """Describe what to change for a failed check: settings that pass, or its parameters."""
    remedy = f"it passes with --set {check.remedy}; or " if check.remedy and with_remedy else ""
    if check.change:
        return f"{remedy}change {', '.join(check.change)}"

    return f"{remedy}this is a bug in {check.source}"


def offer_fit(
    design: Design, checks: Iterable[Check], changes: Iterable[str], console: Console
) -> dict[str, Any]:
    """Return what --fit would move, as data, if it mends all failed checks."""
    from fingertip.fitting.fitting import find_mend

    if console.fits or not any(check.change for check in checks if not check.passed):
        return {}

    changed = [split_finger(change.partition("=")[0].strip())[1] for change in changes]
    moved = find_mend(design, changed)
    return {"fit_moves": list(moved)} if moved else {}
