"""Fit of a finger: derived parameters move until all rules pass and the bone holds its loads."""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from fingertip.cad.verification.verify import check as check_design
from fingertip.design import Design
from fingertip.design.design_file import Changes, load_tables, merge
from fingertip.design.fit import LEAST_LOADS, Fit, Move, find_fit, fit_lengths
from fingertip.design.geometry import DesignTables
from fingertip.design.refusal import explain_invalid, read_valid
from fingertip.fitting.checks import HOLDS, assess
from fingertip.foundation.errors import DesignError
from fingertip.foundation.progress import ShareText

_FEW = 200
"""Number of single rules that are checked for an offer, which takes no longer than the checks."""


def fit_design(
    design: Design,
    changes: Changes = (),
    progress: Callable[[str], None] = lambda message: None,
) -> Design:
    """Change a design, and move what follows until every rule passes and the bone holds its loads.

    What is changed stays, measurements too. A design that passes with the changes stays as it is.
    `moves` of the result lists what moved:

    >>> thinner = fit_design(Design.load("adult_finger"), {"skin.thickness_palmar_mm": 2.7})
    >>> thinner.skin.thickness_palmar_mm, len(thinner.moves) > 0
    (2.7, True)

    Parameters
    ----------
    design
        The design before the changes.
    changes
        Changes as those of `Design.load`.
    progress
        Called with the share of the search that is done.

    Raises
    ------
    DesignError
        If no such design is found. It names what has to change.
    """
    loaded = load_tables((), changes)
    tables = design.model_dump()
    merge(tables, loaded.tables)

    return fit_tables(
        tables,
        before=design.model_dump(),
        changed=loaded.changed,
        progress=progress,
        provisional=design.provisional,
    )


def fit_tables(
    tables: Mapping[str, Any],
    before: Mapping[str, Any] | None = None,
    changed: Sequence[str] = (),
    progress: Callable[[str], None] = lambda message: None,
    provisional: Sequence[str] = (),
) -> Design:
    """Make a design of tables as `Design.from_tables` does, and move what follows from the changes.

    Raises DesignError.
    """
    try:
        begun = DesignTables(**tables)
    except ValidationError as error:
        raise DesignError(explain_invalid(tables, error, changed)) from None

    fit = fit_finger(
        begun,
        changed,
        before=read_valid(before),
        progress=lambda share: progress(ShareText("fitting", share)),
        provisional=provisional,
    )
    return Design.from_tables(
        fit.tables.model_dump(),
        before=before,
        changed=changed,
        provisional=provisional,
        moves=fit.moves,
    )


def fit_finger(
    tables: DesignTables,
    given: Collection[str] = (),
    before: DesignTables | None = None,
    progress: Callable[[float], None] = lambda share: None,
    provisional: Collection[str] = (),
) -> Fit:
    """Fit a design as `fit_lengths` does, until its bone also bears the loads that it states.

    Guessed sizes of the hand that are `provisional` move too, and provisional loads become those
    that the bone bears. Raises DesignError.
    """
    least_loads = {
        load: least
        for load, least in LEAST_LOADS.items()
        if load in provisional and load not in given
    }
    guessed = [name for name in provisional if name not in LEAST_LOADS]
    fit = functools.partial(
        fit_lengths,
        given=given,
        before=before,
        holds=HOLDS,
        progress=progress,
        guessed=guessed,
    )

    try:
        fitted = fit(tables)
    except DesignError:
        if not least_loads:
            raise

        fitted = fit(tables.with_values(least_loads))

    stated_loads = {load: tables.value(load) for load in least_loads}
    lowered = lower_loads(fitted.tables.with_values(stated_loads), least_loads)
    return Fit(lowered.tables, (*fitted.moves, *lowered.moves))


def lower_loads(tables: DesignTables, loads: Collection[str]) -> Fit:
    """Lower some loads to what the bone bears. Raises GeometryError."""
    borne = assess(tables).lighter_loads if loads else {}
    moves = [
        Move(load, tables.value(load), borne[load], "the bone holds no more")
        for load in loads
        if load in borne
    ]
    return Fit(tables.with_values({move.name: move.after for move in moves}), tuple(moves))


def find_mend(design: Design, given: Collection[str]) -> Sequence[str]:
    """List what a fit moves in a design that fails checks.

    The list is empty if the fit does not pass all checks, or would take too long.
    """
    fit, _ = find_fit(design, given, holds=HOLDS, checks=_FEW, is_early=True)
    if not fit:
        return []

    checks = check_design(Design.model_construct(None, **dict(fit.tables))).checks
    passes = all(check.passed for check in checks)
    return [move.name for move in fit.moves] if passes else []
