"""Errors are sentences: which field, which value, which bound, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with what the user gave.

    `field` is where (`skin.width_mm`, a file, a CSV column); `sentence` says it whole: value, bound and remedy.
    """

    field: str
    sentence: str

    def __str__(self) -> str:
        return f"{self.field}: {self.sentence}" if self.field else self.sentence


class FingertipError(Exception):
    """Base of every error raised on purpose. Carries all faults found, never only the first."""

    def __init__(self, faults: Fault | str | Iterable[Fault]) -> None:
        if isinstance(faults, str):
            faults = Fault("", faults)
        self.faults: tuple[Fault, ...] = (faults,) if isinstance(faults, Fault) else tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


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
