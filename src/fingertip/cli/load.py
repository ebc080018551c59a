"""Loading of the design that a command is given."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingertip.design import Design


def load_design(file: Path | None, changes: Sequence[str] | None) -> tuple[Design, dict[str, Any]]:
    """Load the design of a file, or the default design, with changes.

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
    return Design.from_tables(loaded.tables, loaded.before, loaded.changed), loaded.tables
