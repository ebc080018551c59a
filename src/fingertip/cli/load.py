"""Loading of the design that a command is given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from fingertip.design import Design

Progress: TypeAlias = Callable[[str], None]
"""Callback that reports progress text."""


def load_design(
    file: Path | None, changes: Sequence[str] | None, progress: Progress | None = None
) -> tuple[Design, dict[str, Any]]:
    """Load the design of a file, or the default design, with changes.

    Parameters
    ----------
    file
        Design file, or name of a bundled design; None for the default design.
    changes
        Changes, such as "mold.draft_deg=2".
    progress
        Callback that prints a note about a file without any parameter.

    Returns
    -------
    tuple
        The design, and the tables that file and changes set, without the defaults.

    Raises
    ------
    DesignError
        If the file cannot be read, is not valid TOML or is of another kind, or if the design is refused.
    """
    from fingertip.design import Design
    from fingertip.design.load import load_tables

    loaded = load_tables([file] if file else [], changes or ())
    if file and not loaded.before and progress:
        progress(f"{file} sets no parameter: this is the default design, fsr400")
    return Design.from_tables(loaded.tables, loaded.before, loaded.changed), loaded.tables
