"""Rules of the form: whether its design passes, and with which values of the parameter in hand it would.

These answers come at once, beside whatever the worker makes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fingertip.design import Design
from fingertip.design.bands import Band, describe_bands, find_bands
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.refusal import as_typed, is_number
from fingertip.foundation.errors import DesignError, Issue
from fingertip.studio.answers import describe_issues, read_design
from fingertip.studio.worker import StillWanted

_BANDS_KEPT = 256
"""Number of bands that are kept: somebody who slides asks for the same ones again and again."""


class BandFinder:
    """Finder of the bands of a form's parameters, which keeps what it found."""

    def __init__(self, opened: Design) -> None:
        self.opened = opened
        self._found: dict[tuple[DesignTables, str], tuple[Band, ...]] = {}

    def find(self, tables: Mapping[str, Any], path: str, still_wanted: StillWanted) -> tuple[Band, ...]:
        """Find the bands of a parameter; none for one that is no number, or beside others that are not valid."""
        if path not in PARAMETERS or not is_number(path):
            return ()
        table, _, key = path.partition(".")
        try:
            present = tables[table][key]
            others = DesignTables(**{**tables, table: {**tables[table], key: self.opened.value(path)}})
        except (ValidationError, LookupError, TypeError):
            return ()
        if (others, path) not in self._found:
            is_valid = isinstance(present, int | float) and find_bounds(PARAMETERS[path]).contain(present)
            tried = [as_typed(path, present)] if is_valid else []
            bands = find_bands(others, path, tried, still_wanted)
            if len(self._found) >= _BANDS_KEPT:
                self._found.clear()
            self._found[others, path] = bands
        return self._found[others, path]


def answer_bands(finder: BandFinder, tables: Mapping[str, Any], path: str, still_wanted: StillWanted) -> dict[str, Any]:
    bands = finder.find(tables, path, still_wanted)
    return {"bands": bands, "said": describe_bands(path, bands) if bands else ""}


def answer_rules(finder: BandFinder, tables: Mapping[str, Any], path: str, still_wanted: StillWanted) -> dict[str, Any]:
    """Say whether the form's design passes, and if not with which value of the parameter in hand it would.

    Raises
    ------
    DesignError
        If no value of that parameter helps: its issues say what does.
    """
    try:
        Design.without_remedies(**tables)
    except DesignError as error:
        found = answer_bands(finder, tables, path, still_wanted)
        if not found["bands"]:
            read_design(tables, finder.opened)
        told = " ".join(issue.message if issue.field == path else str(issue) for issue in error.issues)
        refused = Issue(path, f"{told} With the other parameters as they are, {found['said']} pass.")
        table, _, key = path.partition(".")
        passing = _find_nearest(tables[table][key], finder.opened.value(path), found["bands"])
        return found | {"issues": describe_issues(DesignError(refused)), "passing": passing}
    return {}


def _find_nearest(present: object, opened: float, bands: Sequence[Band]) -> float:
    """Find the passing value that is nearest to the present one, or to the opened one if that is no number."""
    wanted = present if isinstance(present, int | float) and math.isfinite(present) else opened
    ends = [end for band in bands for end in band]
    return min([*ends, *(opened for low, high in bands if low <= opened <= high)], key=lambda end: abs(end - wanted))
