"""Errors are sentences: which field, which value, which bound, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Issue:
    """One thing that is wrong with what the user gave.

    `field` is where (`skin.width_mm`, a file, a CSV column); `sentence` says it whole: value, bound and remedy.
    """

    field: str
    message: str

    def __str__(self) -> str:
        return f"{self.field}: {self.message}" if self.field else self.message


class FingertipError(Exception):
    """Base of every error raised on purpose. Carries all issues found, never only the first."""

    def __init__(self, issues: Issue | str | Iterable[Issue]) -> None:
        if isinstance(issues, str):
            issues = Issue("", issues)
        self.issues: tuple[Issue, ...] = (issues,) if isinstance(issues, Issue) else tuple(issues)
        super().__init__("\n".join(str(issue) for issue in self.issues))


class DesignError(FingertipError):
    """A design file, or a value set over it, cannot be used."""


class GeometryError(FingertipError):
    """A part could not be built, written or proven."""


class BoardError(FingertipError):
    """The board's values cannot be computed or its files not written."""


class TraceError(FingertipError):
    """A recorded or simulated trace cannot be read."""


class SweepError(FingertipError):
    """A sweep file, or the folder of a sweep, cannot be used."""


class OutputError(FingertipError):
    """A result could not be written."""


class MissingLibraryError(FingertipError):
    """A library of the system, or an optional package, is needed for what was asked and is not there."""
