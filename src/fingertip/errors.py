"""Errors that name the field, its value, the bound it violates and a remedy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Issue:
    """One problem with the input."""

    field: str
    """Location of the problem: a parameter such as `skin.width_mm`, a file, an option or a CSV column."""
    message: str
    """The problem in one sentence: value, bound and remedy."""

    def __str__(self) -> str:
        return f"{self.field}: {self.message}" if self.field else self.message


class FingertipError(Exception):
    """Base class of every error that is raised on purpose. It carries all issues found, not only the first."""

    def __init__(self, issues: Issue | str | Iterable[Issue]) -> None:
        if isinstance(issues, str):
            issues = Issue("", issues)
        self.issues: tuple[Issue, ...] = (issues,) if isinstance(issues, Issue) else tuple(issues)
        super().__init__("\n".join(str(issue) for issue in self.issues))


class TomlFileError(FingertipError):
    """A TOML file cannot be read, or is of another kind than expected."""


class DesignError(FingertipError):
    """A design file, or a change to a design, cannot be used."""


class GeometryError(FingertipError):
    """A part cannot be built, checked or written."""


class BoardError(FingertipError):
    """The values of the board cannot be computed, or its files cannot be written."""


class TraceError(FingertipError):
    """A recorded or simulated trace cannot be read or made."""


class SweepError(FingertipError):
    """A sweep file, or the folder of a sweep, cannot be used."""


class OutputError(FingertipError):
    """A result cannot be written."""


class StudioError(FingertipError):
    """The studio cannot be served."""


class MissingLibraryError(FingertipError):
    """A library of the system, or an optional package, is needed and is not installed."""
