"""Step of the procedure: what to do, and which picture shows it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Step:
    """Step of the casting sheet."""

    picture: str
    """Name of the scene in `fingertip.view.steps` that shows the step."""
    text: str
