"""What `fingertip check` finds in one design, folder or mesh: as
data, as text, and for the reports of CI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.cli.check_reports import Finding
    from fingertip.design import Design
    from fingertip.design.finger_set import FingerSet
    from fingertip.foundation.errors import Issue


@dataclass(frozen=True)
class Given:
    """Design or set that the command was given, with its file."""

    file: Path
    design: Design | FingerSet


@dataclass(frozen=True)
class Found:
    """What was found in one design, folder or mesh."""

    label: str
    data: Mapping[str, Any]
    text: str
    cases: tuple[Check | Issue, ...] = ()
    """Cases of a JUnit report: checks, or issues that each are an error."""
    findings: tuple[Finding, ...] = ()
    """Failed checks and differences, with their place."""

    @property
    def passed(self) -> bool:
        """Return whether nothing was wrong."""
        return bool(self.data["passed"])
