"""Parameters of a design and outputs of a sweep that went, in groups, and what to do with lines that name them."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from pathlib import Path

from fingertip.foundation.errors import Issue
from fingertip.foundation.tables import read_rows

_FEW = 2
"""Number of groups up to which lines are soon mended by hand."""


@functools.cache
def load_retired() -> Mapping[str, str]:
    """Load what to do with each name that went."""
    rows = read_rows(Path(__file__).with_suffix(".csv"))
    return {name: row["instead"] for row in rows for name in row["names"].split()}


def describe_retired(names: Iterable[str]) -> list[Issue]:
    """Return one issue for each group of names that went, and for many the command that removes them."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(load_retired()[name], []).append(name)
    issues = [Issue(", ".join(group), instead) for instead, group in groups.items()]
    if len(groups) > _FEW:
        issues.append(Issue("design", "`fingertip new NAME --from FILE` writes such a design anew, with its sizes."))
    return issues
