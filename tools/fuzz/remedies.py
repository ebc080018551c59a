"""Remedies that a refusal prints, read back as the changes a user would type in."""

from __future__ import annotations

import re
from collections.abc import Iterable

from fingertip.foundation.errors import Issue

_NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?"
_BOUND = re.compile(rf"(?:at least |at most |between |choose )?({_NUMBER})")
_LAST_BOUND = re.compile(rf", and (?:at least|at most) ({_NUMBER})")
_EXAMPLE = re.compile(rf", such as ({_NUMBER})")
_ASSIGNMENT = re.compile(r"([a-z_]+\.[a-z0-9_]+)=([^\s,]+?)(?=[,.]?(?:\s|$))")


FIT = "--fit"


def read_remedy(issue: Issue) -> dict[str, str]:
    """Values that a message asks for, by field, or the option --fit;
    its alternatives ("or ...") are left out.
    """
    _, mark, remedy = issue.message.rpartition("; ")
    remedy = remedy.partition(", or ")[0] if mark else ""
    if FIT in remedy:
        return {FIT: ""}

    values = dict(_ASSIGNMENT.findall(remedy))
    bound = _BOUND.match(remedy)
    if bound:
        last = _LAST_BOUND.search(remedy)
        values[issue.field] = last[1] if last else bound[1]

    example = _EXAMPLE.search(remedy)
    if example:
        values[issue.field] = example[1]

    return values


def read_alternatives(issue: Issue) -> list[str]:
    """Alternatives of a message, as changes."""
    return re.findall(r", or ([a-z_]+\.[a-z0-9_]+=[^\s,]+?)(?=[,.]?(?:\s|$))", issue.message)


def as_changes(issues: Iterable[Issue]) -> list[str]:
    """All remedies of a refusal, as changes; without the option --fit."""
    return [
        f"{name}={value}"
        for issue in issues
        for name, value in read_remedy(issue).items()
        if name != FIT
    ]
