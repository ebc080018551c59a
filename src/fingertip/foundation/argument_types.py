"""Types of arguments: functions that refuse others by the argument's name."""

from __future__ import annotations

import contextlib
import functools
import inspect
from collections.abc import Callable
from types import UnionType
from typing import Any, TypeVar, cast, get_args, get_origin

from fingertip.foundation.errors import ArgumentError, Issue, join_words, quote_value

F = TypeVar("F", bound=Callable[..., Any])
_KINDS = {
    "NoneType": "None", "Callable": "a function", "Iterable": "a list", "Sequence": "a list", "Collection": "a list",
    "Mapping": "a dict", "str": "a text", "Path": "a path", "int": "a whole number", "float": "a number",
    "bool": "True or False", "Design": 'a Design, such as Design.load("fsr400")',
    "SceneFile": 'a SceneFile, such as SceneFile.load("sliding_finger")', "Grid": "a Grid, such as Grid(16)",
    "ManipulationFile": 'a ManipulationFile, such as ManipulationFile.load("real_manipulation")',
}  # fmt: skip
"""Name of a type -> how a message asks for a value of it."""


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
    if getattr(value, "ndim", None) == 0:  # a scalar of numpy, which a refusal need not load
        value = value.tolist()
    kinds = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    for kind in kinds:
        plain = get_origin(kind) or kind
        if plain is tuple and type(value) is list:
            value = tuple(value)
        if plain is Any or (plain is float and isinstance(value, int)):
            return value
        try:
            fits = isinstance(value, plain)
        except TypeError:  # a protocol
            return value
        if fits:
            if plain is Callable or type(value) not in (list, tuple) or not get_args(kind):
                return value
            return type(value)(_fit(f"{field}[{i}]", each, get_args(kind)[0]) for i, each in enumerate(value))
    names = [getattr(kind, "__name__", str(kind)) for kind in reversed(kinds)]
    wanted = join_words([_KINDS.get(name, f"a {name}") for name in names], "or")
    message = f"is {quote_value(value)}, of type {type(value).__name__}; give {wanted}."
    raise ArgumentError(Issue(field, message))
