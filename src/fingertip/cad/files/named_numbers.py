"""Numbers that remember how they were computed, as terms: of names, of arithmetic, and of calls."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

NOTED: list[Term] = []
"""Comparisons of such numbers, as they came out."""


class Term:
    """Expression: an operation (a sign, "name", "constant",
    "call", "item", "tuple"...) and its operands.
    """

    def __init__(self, operation: str, *operands: Any, length: int = 0) -> None:
        self.operation = operation
        self.operands = operands
        self.length = length
        inner = (each.atoms for each in operands if isinstance(each, Term))
        self.atoms: set[str] = {operands[0]} if operation == "name" else set().union(*inner)
        self._key = hash(
            (operation, *(each if isinstance(each, Term) else repr(each) for each in operands))
        )

    def __hash__(self) -> int:
        return self._key

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Term) and self._key == other._key


def term_of(value: Any) -> Term:
    """Return the term of a value: of a sequence that a call returned, that call."""
    if isinstance(value, Named):
        return value.term
    if not isinstance(value, tuple | list):
        return value if isinstance(value, Term) else Term("constant", value)

    terms = [term_of(each) for each in value]
    whole = terms[0].operands[0] if terms and terms[0].operation == "item" else None
    if (
        whole
        and whole.length == len(terms)
        and all(t == Term("item", whole, i) for i, t in enumerate(terms))
    ):
        return whole  # type: ignore[no-any-return]

    return Term("tuple", *terms)


def _operators(
    sign: str, compute: Callable[[float, float], float], neutral: float | None
) -> tuple[Any, Any]:
    """Return the methods of an operator for a named number on its left, and on its right."""

    def combine(left: Any, right: Any) -> Any:
        if not isinstance(left, float | int) or not isinstance(right, float | int):
            return NotImplemented
        if not isinstance(right, Named) and (right == neutral or (right == 0.0 and sign == "*")):
            return left if right == neutral else 0.0

        if not isinstance(left, Named) and (left == 0.0 or (left == neutral and sign in "+*")):
            if left == neutral and sign != "-":
                return right
            if sign == "-":
                return -right

            return 0.0

        if not isinstance(left, Named) and left == -1.0 and sign == "*":
            return -right

        return Named(compute(float(left), float(right)), Term(sign, term_of(left), term_of(right)))

    return combine, lambda right, left: combine(left, right)


def _comparison(sign: str, opposite: str, compute: Callable[[float, float], bool]) -> Any:
    def compare(left: Any, right: Any) -> Any:
        if not isinstance(right, float | int):
            return NotImplemented

        outcome = compute(float(left), float(right))
        NOTED.append(Term(sign if outcome else opposite, term_of(left), term_of(right)))
        return outcome

    return compare


class Named(float):
    """Number with the term that yields it."""

    def __new__(cls, value: float, term: Term) -> Named:
        made = super().__new__(cls, value)
        made.term = term
        return made

    term: Term
    __hash__ = float.__hash__
    __add__, __radd__ = _operators("+", operator.add, 0.0)
    __sub__, __rsub__ = _operators("-", operator.sub, 0.0)
    __mul__, __rmul__ = _operators("*", operator.mul, 1.0)
    __truediv__, __rtruediv__ = _operators("/", operator.truediv, 1.0)
    __pow__, __rpow__ = _operators("**", operator.pow, None)
    __lt__ = _comparison("<", ">=", operator.lt)
    __ge__ = _comparison(">=", "<", operator.ge)
    __gt__ = _comparison(">", "<=", operator.gt)
    __le__ = _comparison("<=", ">", operator.le)
    __eq__ = _comparison("==", "!=", operator.eq)
    __ne__ = _comparison("!=", "==", operator.ne)

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    def __neg__(self) -> Named:
        if self.term.operation == "negative":
            return Named(-float(self), self.term.operands[0])

        return Named(-float(self), Term("negative", self.term))

    def __abs__(self) -> Named:
        return self if self >= 0.0 else -self


def is_named(value: Any) -> bool:
    return isinstance(value, Named) or (
        isinstance(value, tuple | list) and any(map(is_named, value))
    )


def plain(value: Any) -> Any:
    if isinstance(value, tuple | list):
        return _rebuild(value, map(plain, value))

    return float(value) if isinstance(value, Named) else value


def wrap(value: Any, term: Term) -> Any:
    """Name a number, or all numbers of a sequence, by a term that yields it."""
    if isinstance(value, tuple | list):
        whole = Term(term.operation, *term.operands, length=len(value))
        return _rebuild(value, (wrap(each, Term("item", whole, i)) for i, each in enumerate(value)))

    return Named(float(value), term) if isinstance(value, float | int) else value


def _rebuild(value: Any, items: Any) -> Any:
    return type(value)(*items) if hasattr(value, "_fields") else type(value)(items)
