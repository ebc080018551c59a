"""Numbers of a design that know their names and how they are computed, and names of the solids that are made of them.

A copy of the design holds such numbers in place of plain ones. Its parts are the same, bit by bit, and each number in
their trees can be written as it was computed, such as `-flat_depth + channel_depth`. A number that no arithmetic
yields, but a function of the math module or a search, is written as a number.
"""

from __future__ import annotations

import operator
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from types import FrameType
from typing import Any

from fingertip.design import Design
from fingertip.design.geometry.dimensions import Dimensions
from fingertip.design.geometry.mold_layout import MoldLayout
from fingertip.design.geometry.solids import Solid
from fingertip.design.parameters import PARAMETERS

_CONSTANT = 3
"""Most decimals of a constant of the program. A number with more was computed from others, and would not follow."""
_MAX_LENGTH = 90
"""Longest expression that says more than its value [characters]."""
_NEARBY = 1e-6
"""Relative difference of the parameters by which definitions are confirmed."""
_SUM, _PRODUCT, _ATOM = range(3)
"""Ranks of expressions: the higher one binds more tightly."""


def _operators(sign: str, rank: int, compute: Callable[[float, float], float]) -> tuple[Any, Any]:
    """Return the methods of an operator for a named number on its left, and on its right."""

    def combine(left: Any, right: Any) -> Any:
        if not isinstance(left, float | int) or not isinstance(right, float | int):
            return NotImplemented
        value, is_right = compute(float(left), float(right)), isinstance(left, Named)
        named, constant = (left, right) if is_right else (right, left)
        if not isinstance(constant, Named):
            if constant == (0.0 if rank == _SUM else 1.0) and (is_right or sign in "+*"):
                return named
            if sign == "-" and constant == 0.0:
                return -named
            if constant == 0.0 or round(constant, _CONSTANT) != constant:
                return value
        # The right side of an operator needs brackets around others of its rank: a - (b + c).
        text = f"{_operand(left, rank)} {sign} {_operand(right, rank + 1)}"
        return Named(value, text, rank) if len(text) <= _MAX_LENGTH else value

    return combine, lambda right, left: combine(left, right)


class Named(float):
    """Number with the expression that yields it."""

    def __new__(cls, value: float, text: str, rank: int = _ATOM) -> Named:
        made = super().__new__(cls, value)
        made.text, made.rank = text, rank
        return made

    text: str
    rank: int
    __add__, __radd__ = _operators("+", _SUM, operator.add)
    __sub__, __rsub__ = _operators("-", _SUM, operator.sub)
    __mul__, __rmul__ = _operators("*", _PRODUCT, operator.mul)
    __truediv__, __rtruediv__ = _operators("/", _PRODUCT, operator.truediv)

    def __neg__(self) -> Named:
        return Named(-float(self), f"-{_operand(self, _PRODUCT)}", _PRODUCT)


def literal(value: Any) -> str:
    """Write numbers, texts and tuples of them as Python does, and named numbers as they were computed."""
    if isinstance(value, Named):
        return value.text
    if isinstance(value, tuple):
        return f"({', '.join(map(literal, value))}{',' * (len(value) == 1)})"
    return f'"{value}"' if isinstance(value, str) else repr(float(value))


def _operand(value: float, rank: int) -> str:
    return f"({value.text})" if isinstance(value, Named) and value.rank < rank else literal(value)


@dataclass(frozen=True)
class Definition:
    """Named number: its value, the expression that yields it, and what it is."""

    value: float
    text: str
    description: str


class Names:
    """Names of a design's numbers, in an order in which each is defined before it is used.

    The `design` of it is a copy with named numbers: its parameters, and the lengths that are derived from them.
    """

    def __init__(self, design: Design) -> None:
        self.definitions: dict[str, Definition] = {}
        self._read: dict[tuple[str, str], None] = {}
        values = {
            path: self._name(path.replace(".", "_"), design.value(path), declared.description or "")
            for path, declared in PARAMETERS.items()
        }
        self.design = design.with_values(values)
        self.design.__dict__["dimensions"] = self._derive(Dimensions, self.design)
        self.design.__dict__["mold_layout"] = self._derive(MoldLayout, self.design, self.design.dimensions)

    def confirmed(self, design: Design) -> dict[str, Definition]:
        """Return the definitions, those that do not hold for a design with slightly other parameters as numbers."""
        numbers = ((path, design.value(path)) for path in PARAMETERS)
        nearby = {path: x * (1.0 + i * _NEARBY) for i, (path, x) in enumerate(numbers, 1) if isinstance(x, float)}
        other = Names(design.with_values(nearby))
        for source, key in self._read:
            getattr(getattr(other.design, source), key)
        return {
            name: defined if defined.text == getattr(other.definitions.get(name), "text", None)
            else replace(defined, text=literal(defined.value))
            for name, defined in self.definitions.items()
        }  # fmt: skip

    def _name(self, name: str, value: Any, description: str = "") -> Any:
        """Name a number, or those of a data class, unless it is another number under its own name."""
        if is_dataclass(value) and not isinstance(value, type):
            named = {each.name: self._name(f"{name}_{each.name}", getattr(value, each.name)) for each in fields(value)}
            return replace(value, **named)
        if not isinstance(value, float) or (isinstance(value, Named) and value.text in self.definitions):
            return value
        definition = Definition(float(value), literal(value), description)
        while self.definitions.setdefault(name, definition).text != definition.text:
            name += "_"
        return Named(definition.value, name)

    def _derive(self, kind: Any, *arguments: Any) -> Any:
        """Make lengths that are derived from parameters, and name each when it is read."""
        source = "dimensions" if kind is Dimensions else "mold_layout"

        def read(derived: Any, key: str) -> Any:
            value = kind.__getattribute__(derived, key)
            if key.startswith("_") or callable(value):
                return value
            self._read[source, key] = None
            value = self._name(key, value, getattr(getattr(kind, key, None), "__doc__", None) or "")
            if key in derived.__dict__:  # a property that keeps its value
                derived.__dict__[key] = value
            return value

        return type(kind.__name__, (kind,), {"__getattribute__": read})(*arguments)


_SHAPES = ("fingertip.cad.shapes.", "fingertip.design.interfaces.", "fingertip.design.geometry.foot")
"""Modules that make solids, whose variables and functions name them."""


def build_with_names(build: Callable[[Design], Solid], design: Design) -> tuple[Solid, dict[Solid, str]]:
    """Build a part, and name each solid by the variable that holds it, or the function that returns it."""
    variables, functions = dict[Solid, str](), dict[Solid, str]()

    def watch(frame: FrameType, event: str, result: Any) -> None:
        if event != "return" or not frame.f_globals.get("__name__", "").startswith(_SHAPES):
            return
        for name, value in frame.f_locals.items():
            if isinstance(value, Solid):
                variables.setdefault(value, name)
        name = frame.f_code.co_name.strip("_")
        for value in result if isinstance(result, tuple) else (result,):
            if isinstance(value, Solid) and name.isidentifier():
                functions.setdefault(value, name)

    before = sys.getprofile()
    sys.setprofile(watch)
    try:
        solid = build(design)
    finally:
        sys.setprofile(before)
    return solid, functions | variables
