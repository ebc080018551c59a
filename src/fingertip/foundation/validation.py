"""Checks of input: types of arguments, and for every integrator values within bounds that are finite."""

from __future__ import annotations

import contextlib
import functools
import inspect
import math
from collections.abc import Callable, Iterable, Iterator
from types import UnionType
from typing import Any, TypeVar, cast, get_args, get_origin

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import ArgumentError, Issue, TraceError, join_words, quote_value
from fingertip.foundation.numerics import Array

F = TypeVar("F", bound=Callable[..., Any])
_KINDS = {
    "NoneType": "None", "Callable": "a function", "Iterable": "a list", "Sequence": "a list", "Collection": "a list",
    "Mapping": "a dict", "str": "a text", "Path": "a path", "int": "a whole number", "float": "a number",
    "bool": "True or False", "Design": 'a Design, such as Design.load("fsr400")',
    "SceneFile": 'a SceneFile, such as SceneFile.load("sliding_finger")', "Grid": "a Grid, such as Grid(16)",
    "ManipulationFile": 'a ManipulationFile, such as ManipulationFile.load("real_manipulation")',
}  # fmt: skip
"""Name of a type -> how a message asks for a value of it."""


def find_not_positive(field: str, values: Array | float, unit: str, example: str) -> list[Issue]:
    """Report the first of one or many values that is not a finite number above 0."""
    row = np.ravel(np.asarray(values, dtype=np.float64))
    return _refuse_first(field, row, row > 0.0, unit, f"give a finite number above 0, such as {example} {unit}")


def find_negative(field: str, values: Array | float, unit: str) -> list[Issue]:
    """Report the first of one or many values that is not a finite number of at least 0."""
    row = np.ravel(np.asarray(values, dtype=np.float64))
    return _refuse_first(field, row, row >= 0.0, unit, "give a finite number of at least 0")


def _refuse_first(field: str, row: Array, valid: NDArray[np.bool_], unit: str, remedy: str) -> list[Issue]:
    return [
        Issue(field, f"{f'{row[i]:g} {unit}'.rstrip()}{f' at index {i}' if row.size > 1 else ''} is refused; {remedy}.")
        for i in np.flatnonzero(~(valid & np.isfinite(row))).tolist()[:1]
    ]


def find_not_finite(field: str, values: Array) -> Iterator[Issue]:
    """Report the first sample that is not finite."""
    if (bad := np.flatnonzero(~np.isfinite(values))).size:
        more = f" (and {bad.size - 1} more after it)" if bad.size > 1 else ""
        yield Issue(field, f"{values[bad[0]]} at sample {bad[0]}{more} is not a finite number; give the true value.")


def find_column_issues(**arrays: Array) -> Iterator[Issue]:
    """Report columns that are not finite, with the first such sample, and columns of unequal length."""
    length = len(next(iter(arrays.values())))
    for name, values in arrays.items():
        if values.shape != (length,) or length < 1:
            yield Issue(name, f"shape is {values.shape}; must be ({max(length, 1)},); give one value per sample.")
        else:
            yield from find_not_finite(name, values)


def checked(function: F) -> F:
    """Refuse arguments of other types than a function, or the constructor of a class, declares.

    Lists are taken for tuples, and scalars of numpy for numbers. Types that are imported for type checkers only, and
    protocols, are not checked. Raises ArgumentError.
    """
    if isinstance(function, type):
        function.__init__ = checked(function.__init__)  # type: ignore[misc]
        return function
    signature, hints = inspect.signature(function), dict[str, Any]()
    for name, parameter in signature.parameters.items():
        with contextlib.suppress(NameError, TypeError):
            hint = eval(parameter.annotation, inspect.unwrap(function).__globals__)
            if not isinstance(hint, str):  # a type alias that numpy is not loaded for
                hints[name] = tuple[hint, ...] if parameter.kind is parameter.VAR_POSITIONAL else hint  # type: ignore[valid-type]

    @functools.wraps(function)
    def call(*values: Any, **named: Any) -> Any:
        bound = signature.bind(*values, **named)
        given = bound.arguments
        given |= {name: _fit(name, given[name], hint) for name, hint in hints.items() if name in given}
        return function(*bound.args, **bound.kwargs)

    return cast("F", call)


def _fit(field: str, value: Any, hint: Any) -> Any:
    """Return a value as a type hint declares it."""
    if isinstance(value, np.generic | np.ndarray) and not value.ndim:
        value = value.tolist()
    kinds = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    for kind in kinds:
        plain = get_origin(kind) or kind
        if plain is tuple and type(value) is list:
            value = tuple(value)
        if plain is Any or getattr(plain, "_is_protocol", False) or (plain is float and isinstance(value, int)):
            return value
        if isinstance(value, plain):
            if plain is Callable or type(value) not in (list, tuple) or not get_args(kind):
                return value
            return type(value)(_fit(f"{field}[{i}]", each, get_args(kind)[0]) for i, each in enumerate(value))
    names = [getattr(kind, "__name__", str(kind)) for kind in reversed(kinds)]
    wanted = join_words([_KINDS.get(name, f"a {name}") for name in names], "or")
    message = f"is {quote_value(value)}, of type {type(value).__name__}; give {wanted}."
    raise ArgumentError(Issue(field, message))


def round_down(value: float) -> float:
    """Round a positive number down to three digits, so that the remedy of an error passes when it is typed back in."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / unit * (1 + 1e-12)) * unit:.3g}")


def round_up(value: float) -> float:
    """Round a positive number up to three digits, so that the remedy of an error passes when it is typed back in."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.ceil(value / unit * (1 - 1e-12)) * unit:.3g}")


def raise_issues(issues: Iterable[Issue]) -> None:
    """Raise all issues as one error, if there are any. Raises TraceError."""
    if found := list(issues):
        raise TraceError(found)
