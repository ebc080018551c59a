"""Statements of the article, a row each, and where this project stands with them.

`rows.csv` beside this module lists them; the page beside the article shows those that are not met.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from fingertip.foundation.tables import load_table, read_rows

State = Literal["met", "other number", "another way", "missing", "not applicable"]
STATES: tuple[State, ...] = get_args(State)


@dataclass(frozen=True)
class Row:
    """One statement of the article."""

    row: int
    section: str
    statement: str
    state: State
    shown_by: str
    """Test (`FILE::TEST`), page or file of a design; empty where the project has none."""
    reason: str
    """Sentence on what is here instead, and why; empty if met. A figure of the article's
    protocol stands in braces: `{objects held}`.
    """

    @property
    def is_met(self) -> bool:
        return self.state == "met"


def load_rows() -> tuple[Row, ...]:
    """Load all rows. Raises ValueError where a row does not fit its columns."""
    return load_table(Row, read_rows(Path(__file__).with_name("rows.csv")))


def fill_reason(row: Row, protocol: Sequence[Mapping[str, Any]]) -> str:
    """Fill in the figures of the page's table of the protocol, those of all devices in turn.

    Raises KeyError for a figure that the table does not have.
    """
    return row.reason.format_map(
        {each["figure"]: ", ".join(each["ours"].values()) for each in protocol}
    )
